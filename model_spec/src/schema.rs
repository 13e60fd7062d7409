//! The editor schema.
