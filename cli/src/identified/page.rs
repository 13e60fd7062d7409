//! The result as a self-contained HTML page.

use std::fmt::Write as _;

use appell_gap::data::DataSet;
use appell_gap::identify::Answer;

use super::{Part, figure, parts};
use crate::recording;

/// The self-contained HTML page.
pub(crate) fn page(set: &DataSet, answer: &Answer) -> String {
    let mut body = String::new();
    for (place, part) in parts(set, answer).iter().enumerate() {
        // Writing to a string cannot fail.
        let _ = writeln!(body, "<h2>{}</h2>", escaped(&part.heading));
        body += &table(part);
        if !part.note.is_empty() {
            let _ = writeln!(body, "<p>{}</p>", escaped(&part.note));
        }
        if place == 0 && !answer.traces.is_empty() {
            let _ = writeln!(body, "<h2>Held-out runs</h2>");
            let _ = writeln!(body, "{}", figure(set, answer).to_svg());
        }
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{name}: parameters</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <h1>{name}: parameters from recordings</h1>\n{body}\
         <h2>Recordings</h2>\n<pre>{recordings}</pre>\n</body>\n</html>\n",
        name = escaped(&set.mechanism.name),
        recordings = escaped(&recording::text(set)),
    )
}

fn table(part: &Part) -> String {
    let mut text = "<div class=\"wide\"><table>\n".to_owned();
    for (place, row) in part.rows.iter().enumerate() {
        let tag = if place == 0 { "th" } else { "td" };
        text += "<tr>";
        for (column, cell) in row.iter().enumerate() {
            let class = if part.numbers.contains(&column) {
                " class=\"number\""
            } else {
                ""
            };
            let heat = match cell.parse::<f64>() {
                Ok(value) if part.is_heat && place > 0 => heat(value),
                _ => String::new(),
            };
            let cell = escaped(cell);
            let _ = write!(text, "<{tag}{class}{heat}>{cell}</{tag}>");
        }
        text += "</tr>\n";
    }
    text + "</table></div>\n"
}

/// The colour of a number between -1 and 1.
fn heat(value: f64) -> String {
    let colour = if value < 0.0 { "#d1602b" } else { "#2f6fb3" };
    let part = 70.0 * value.abs().min(1.0);
    format!(" style=\"background: color-mix(in srgb, {colour} {part:.0}%, transparent)\"")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// Light and dark, as the figure inside.
const STYLE: &str = "\
:root { color-scheme: light dark; }
body { font-family: system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem;
  background: light-dark(#fdfdfb, #16181c); color: light-dark(#1c1c1a, #e6e6e6); }
h2 { font-size: 1.05rem; margin: 2rem 0 0.6rem; }
.wide, pre { overflow-x: auto; }
pre, table { font-size: 0.85rem; line-height: 1.4; }
table { border-collapse: collapse; }
th, td { padding: 0.15rem 0.6rem; text-align: left; white-space: nowrap;
  border-bottom: 1px solid light-dark(#e4e4de, #33363c); }
th { font-weight: 600; }
.number { text-align: right; font-variant-numeric: tabular-nums; }
svg { max-width: 100%; height: auto; }
";
