//! Lines, panels and figures of the book.

use appell_report::figure::{Figure, Panel, Series};

/// A line with a name in the legend.
pub(crate) fn line(label: &str, x: Vec<f64>, y: Vec<f64>) -> Series {
    let label = label.to_owned();
    Series { label, x, y }
}

/// Lines with the unit of their vertical axis.
pub(crate) fn panel(unit: &str, series: Vec<Series>) -> Panel {
    let unit = unit.to_owned();
    Panel { unit, series }
}

/// Panels over a common axis.
pub(crate) fn figure(title: &str, x_label: &str, panels: Vec<Panel>) -> Figure {
    Figure {
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        panels,
        marks: Vec::new(),
        equal_axes: false,
    }
}

/// Paths in a plane, in m, with one scale.
pub(crate) fn paths(title: &str, x_label: &str, series: Vec<Series>) -> Figure {
    Figure {
        equal_axes: true,
        ..figure(title, x_label, vec![panel("m", series)])
    }
}
