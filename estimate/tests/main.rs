//! Filters, likelihoods and smoothers against formulas.

mod likelihood;
mod oscillator;
mod regression;
mod smoothing;
