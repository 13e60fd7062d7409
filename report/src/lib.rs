//! Figures, drawings and pages.
//!
//! - [`figure`]: plots as SVG;
//! - [`drawing`]: the mechanism at its initial state as SVG; positions and forces along a motion;
//! - [`svg`]: their elements;
//! - [`derivation`]: the derivation as text, LaTeX or HTML;
//! - [`mod@film`]: the page with the animated mechanism;
//! - [`ensemble`]: the statistics of a study, as text and as a page;
//! - [`gap`], [`identification`], [`recording`]: results from recordings, as text and pages;
//! - [`page_shell`]: the document around all pages;
//! - [`text`]: tables as text, readable numbers.

pub mod derivation;
pub mod drawing;
pub mod ensemble;
pub mod figure;
pub mod film;
pub mod gap;
pub mod identification;
pub mod page_shell;
pub mod recording;
pub mod svg;
pub mod text;
