//! Filters, likelihoods and smoothers against formulas.

mod attitude;
mod base_parameters;
mod likelihood;
mod oscillator;
mod smoothing;
