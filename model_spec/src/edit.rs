//! Writing parameter values back.
