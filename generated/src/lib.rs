//! Mechanisms shipped with appell, generated from their specs.
