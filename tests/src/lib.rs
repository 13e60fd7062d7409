//! Tests of the whole of appell.
