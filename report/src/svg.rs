//! Elements of SVG, as text. Attributes and texts are escaped; lengths have one decimal.

use std::fmt::{Display, Write as _};

use appell_codegen::symbolic::print::mathml::escaped;

/// An element: its name and attributes.
#[derive(Debug, Clone)]
#[must_use]
pub struct Element {
    name: &'static str,
    /// `<name` and the attributes so far.
    start: String,
}

impl Element {
    /// Without attributes.
    pub fn new(name: &'static str) -> Self {
        Self {
            name,
            start: format!("<{name}"),
        }
    }

    /// With another attribute.
    pub fn with(mut self, attribute: &str, value: impl Display) -> Self {
        let value = escaped(&value.to_string());
        // Writing to a string cannot fail.
        let _ = write!(self.start, " {attribute}=\"{value}\"");
        self
    }

    /// With lengths, in pixels.
    pub fn lengths<const N: usize>(mut self, attributes: [(&str, f64); N]) -> Self {
        for (attribute, length) in attributes {
            let _ = write!(self.start, " {attribute}=\"{length:.1}\"");
        }
        self
    }

    /// Its start tag.
    pub fn open(self) -> String {
        self.start + ">"
    }

    /// The element without content.
    pub fn empty(self) -> String {
        self.start + "/>"
    }

    /// The element around a text.
    pub fn text(self, content: &str) -> String {
        format!("{}>{}</{}>", self.start, escaped(content), self.name)
    }

    /// The element with a tooltip, which may be empty.
    pub fn titled(self, about: &str) -> String {
        if about.is_empty() {
            return self.empty();
        }
        let title = Element::new("title").text(about);
        format!("{}>{title}</{}>", self.start, self.name)
    }
}

/// A path with a class.
pub fn path(class: &str, line: &str) -> Element {
    Element::new("path").with("class", class).with("d", line)
}

/// Anchor of a text.
pub fn text([x, y]: [f64; 2]) -> Element {
    Element::new("text").lengths([("x", x), ("y", y)])
}

/// Size of a title, as the styles have it, and the smallest one in pixels.
const TITLE_SIZE: f64 = 15.0;
const SMALLEST_TITLE: f64 = 10.0;

/// A title within its width: a long one in smaller letters; a longer one truncated, with the whole title as a
/// tooltip.
pub fn title(place: [f64; 2], room: f64, content: &str) -> String {
    /// The font may be bold.
    const BOLD: f64 = 1.1;
    let width = BOLD * width(content, TITLE_SIZE);
    let text = text(place).with("class", "title");
    if width <= room {
        return text.text(content);
    }
    let size = (TITLE_SIZE * room / width).max(SMALLEST_TITLE);
    let text = text.with("style", format_args!("font-size:{size:.1}px"));
    shortened(text, content, size, room / BOLD)
}

/// A text within its width: truncated if longer, with the whole text as a tooltip.
pub fn shortened(element: Element, content: &str, size: f64, room: f64) -> String {
    if width(content, size) <= room {
        return element.text(content);
    }
    let mut shown = String::new();
    let rest = room - width("…", size);
    for letter in content.chars() {
        shown.push(letter);
        if width(&shown, size) > rest {
            shown.pop();
            break;
        }
    }
    let whole = Element::new("title").text(content);
    let shown = escaped(shown.trim_end());
    format!("{}>{whole}{shown}…</{}>", element.start, element.name)
}

/// About the width of a text in pixels, in a wide font.
pub fn width(text: &str, size: f64) -> f64 {
    let ems = text.chars().map(|letter| match letter {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '!' | '|' | '\'' | ' ' => 0.35,
        't' | 'f' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' => 0.42,
        'm' | 'w' | 'M' | 'W' | '@' | '%' | '—' | '\u{1100}'.. => 1.0,
        'A'..='Z' => 0.75,
        ' '..='~' => 0.64,
        // Writing systems with wide letters.
        _ => 0.7,
    });
    ems.sum::<f64>() * size
}

/// Corners as a path.
pub fn polyline(corners: impl IntoIterator<Item = [f64; 2]>) -> String {
    let mut line = String::new();
    for [x, y] in corners {
        let command = if line.is_empty() { 'M' } else { 'L' };
        let _ = write!(line, "{command}{x:.1} {y:.1}");
    }
    line
}

/// Elements, a line each.
#[derive(Debug, Clone)]
pub struct Document(String);

impl Document {
    /// An empty document with these styles.
    pub fn new([width, height]: [f64; 2], styles: &[&str]) -> Self {
        let start = Element::new("svg")
            .with("xmlns", "http://www.w3.org/2000/svg")
            .with("viewBox", format_args!("0 0 {width} {height:.0}"))
            .with("width", width)
            .with("height", format_args!("{height:.0}"));
        let mut document = Self(start.open());
        document.put("");
        document.put(&format!("<style>\n{}</style>", styles.concat()));
        let paper = Element::new("rect").with("class", "paper");
        document.put(&paper.with("width", "100%").with("height", "100%").empty());
        document
    }

    /// A picture in a page, which has the style.
    pub fn styled_by_page([width, height]: [f64; 2], class: &str) -> Self {
        let start = Element::new("svg")
            .with("viewBox", format_args!("0 0 {width} {height}"))
            .with("width", width)
            .with("height", height)
            .with("role", "img")
            .with("class", class);
        Self(start.open() + "\n")
    }

    /// Another element.
    pub fn put(&mut self, element: &str) {
        self.0.push_str(element);
        self.0.push('\n');
    }

    /// The document as text.
    pub fn finish(self) -> String {
        self.0 + "</svg>\n"
    }
}
