//! Figures and pages: how they look, and that what they say is true.

mod figure;
mod linearisation;
mod page;
mod support;
