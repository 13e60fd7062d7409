//! Filters, likelihoods and smoothers against formulas.

mod attitude;
mod likelihood;
mod oscillator;
mod regression;
mod smoothing;
