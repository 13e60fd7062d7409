//! What people look at: figures, drawings and pages.
//!
//! - [`figure`]: plots as SVG;
//! - [`drawing`]: the mechanism at its initial state as SVG; places and forces along a motion;
//! - [`svg`]: their elements;
//! - [`derivation`]: the derivation as text, LaTeX or HTML;
//! - [`mod@film`]: the page with the moving mechanism;
//! - [`gap`], [`identification`], [`recording`]: what recordings tell, as text and pages;
//! - [`page_shell`]: what all pages are wrapped in;
//! - [`text`]: columns of text, numbers for people.

pub mod derivation;
pub mod drawing;
pub mod figure;
pub mod film;
pub mod gap;
pub mod identification;
pub mod page_shell;
pub mod recording;
pub mod svg;
pub mod text;
