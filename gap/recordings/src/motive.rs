//! The header of CSV files that `OptiTrack` Motive exports: bodies and markers over several lines.
//!
//! ```text
//! Format Version,1.23,Take Name,ride,…,Length Units,Meters,Coordinate Space,Global
//!
//! ,Type,Rigid Body,Rigid Body,…
//! ,Name,wheel,wheel,…
//! ,ID,…
//! ,,Rotation,Position,…
//! Frame,Time (Seconds),X,X,…
//! ```
//!
//! Its columns are called `wheel.Rotation.X`, `wheel.Position.X`, and `t`.

use std::io::BufRead;

use crate::DataError;
use crate::csv::{Lines, texts};

/// Most lines of a header.
const MOST_LINES: usize = 16;

/// Whether a first line is one of Motive.
pub(crate) fn begins(line: &str) -> bool {
    line.starts_with("Format Version")
}

/// The names of the columns; the lines are left at the last one of the header.
pub(crate) fn header<R: BufRead>(
    lines: &mut Lines<R>,
    separator: char,
) -> Result<Vec<String>, DataError> {
    let (mut names, mut above) = (Vec::new(), Vec::new());
    for _ in 0..MOST_LINES {
        if !lines.next()? {
            break;
        }
        let row = texts(&lines.text, separator);
        let first = |i: usize| row.get(i).map_or("", String::as_str);
        if first(0).starts_with("Frame") {
            let part = |list: &[String], i: usize| list.get(i).cloned().unwrap_or_default();
            let name = |i: usize| match i {
                0 => "Frame".to_owned(),
                1 => "t".to_owned(),
                _ => {
                    let parts = [part(&names, i), part(&above, i), part(&row, i)];
                    let parts: Vec<String> =
                        parts.into_iter().filter(|part| !part.is_empty()).collect();
                    parts.join(".")
                }
            };
            return Ok((0..row.len()).map(name).collect());
        }
        if first(1) == "Name" {
            names = row;
        } else {
            above = row;
        }
    }
    let message = "the header of OptiTrack Motive has no line that begins with `Frame`";
    Err(DataError::whole(lines.place(), message))
}
