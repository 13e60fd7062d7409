//! Figures and pages: how they look, and that what they say is true.

mod figure;
mod headline;
mod linearisation;
mod page;
mod support;
mod text;
