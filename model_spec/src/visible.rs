//! Characters that hide or reorder text, or control a terminal.

use std::borrow::Cow;
use std::fmt::Write as _;

/// Control characters other than line feed and tab, and marks that hide or reorder text.
pub(crate) fn is_hidden(c: char) -> bool {
    if matches!(c, ' '..='~' | '\n' | '\t') {
        // The fast path for nearly all characters.
        return false;
    }
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// A text that is safe to show on a terminal: hidden characters are escaped as in Rust, `\u{1b}`. Line feeds and
/// tabs are kept.
///
/// ```
/// use appell_spec::visible;
///
/// assert_eq!(visible("rod\u{202e}\u{1b}[2J\n"), "rod\\u{202e}\\u{1b}[2J\n");
/// ```
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, is_hidden)
}

/// A text on one line, for a name within a message.
pub(crate) fn visible_line(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_hidden(c) || matches!(c, '\n' | '\t'))
}

fn escaped(text: &str, hides: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&hides) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if hides(c) {
            // A string takes every text.
            let _ = write!(shown, "{}", c.escape_unicode());
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}
