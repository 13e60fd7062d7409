//! XML, with every text escaped.

use std::fmt::Write as _;

use appell_spec::foreign::one_line;

/// An element with its attributes and the elements inside.
#[derive(Debug, Clone)]
pub(super) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    inside: Vec<Element>,
}

impl Element {
    pub(super) fn new(name: &'static str) -> Self {
        Self {
            name,
            attributes: Vec::new(),
            inside: Vec::new(),
        }
    }

    /// Adds an attribute.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a number or a text is given as it stands"
    )]
    pub(super) fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.attributes.push((name, value.to_string()));
        self
    }

    /// Adds an attribute, if it has a value.
    pub(super) fn maybe(self, name: &'static str, value: Option<impl ToString>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// Adds child elements.
    pub(super) fn holding(mut self, inside: impl IntoIterator<Item = Self>) -> Self {
        self.inside.extend(inside);
        self
    }

    /// A document.
    pub(super) fn document(&self) -> String {
        let mut text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
        self.write(&mut text, 0);
        text
    }

    // Documents are a few levels deep.
    fn write(&self, to: &mut String, level: usize) {
        let indent = "  ".repeat(level);
        let _ = write!(to, "{indent}<{}", self.name);
        for (name, value) in &self.attributes {
            let _ = write!(to, " {name}=\"{}\"", escaped(value));
        }
        if self.inside.is_empty() {
            to.push_str("/>\n");
            return;
        }
        to.push_str(">\n");
        for element in &self.inside {
            element.write(to, level + 1);
        }
        let _ = writeln!(to, "{indent}</{}>", self.name);
    }
}

/// A text as the value of an attribute.
fn escaped(text: &str) -> String {
    let mut safe = String::new();
    for c in one_line(text).chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&apos;"),
            c => safe.push(c),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::Element;

    #[test]
    fn no_text_leaves_its_attribute() {
        let hostile = "\"/><script>&'\u{0}\u{ffff}\n";
        let text = Element::new("a").with("b", hostile).document();
        let (_, element) = text.split_once('\n').expect("a declaration");
        assert_eq!(
            element,
            "<a b=\"&quot;/&gt;&lt;script&gt;&amp;&apos; \u{fffd} \"/>\n"
        );
    }
}
