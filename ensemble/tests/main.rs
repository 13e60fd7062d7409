//! Ensembles of cases that need no mechanics.
