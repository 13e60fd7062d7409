//! Gibbs-Appell derivation and code generation.
