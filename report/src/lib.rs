//! What people look at: figures, drawings and pages.
//!
//! - [`figure`]: plots as SVG;
//! - [`derivation`]: the derivation as text, LaTeX or HTML;
//! - [`drawing`]: the mechanism at its initial state as SVG; places and forces along a motion.

pub mod derivation;
pub mod drawing;
pub mod figure;
