//! Untrusted text in generated text: sentences of a spec, names of files, words of a report.
//!
//! A character is written if it is known to be harmless: a letter, a digit, a mark or a visible sign. Any other one,
//! such as a control character, one that changes the writing direction or one without a glyph, has no
//! effect. Emitters of a language additionally escape its special characters.

/// Replacement of a character that must not be written.
const REPLACED: char = '\u{fffd}';

/// Pairs that open or close comments, or begin a trigraph, in some language.
const PAIRS: [[char; 2]; 3] = [['*', '/'], ['/', '*'], ['?', '?']];

/// A text on one line of visible characters, for markup and strings whose emitter escapes special characters.
pub fn one_line(text: &str) -> String {
    text.chars().map(seen).collect()
}

/// A text inside a comment, a documentation string or a string of any language that code is emitted in: on one line,
/// with single spaces, without backslashes and without delimiters of comments.
pub fn sentence(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    let mut last = ' ';
    for c in text.chars().map(seen) {
        let c = if c == '\\' { '/' } else { c };
        if c == ' ' && last == ' ' {
            continue;
        }
        if PAIRS.contains(&[last, c]) {
            written.push(' ');
        }
        written.push(c);
        last = c;
    }
    written.truncate(written.trim_end().len());
    written
}

/// A text as a string of TOML, whose value is that of [`one_line`].
pub fn toml_string(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars().map(seen) {
        if matches!(c, '"' | '\\') {
            quoted.push('\\');
        }
        quoted.push(c);
    }
    quoted.push('"');
    quoted
}

/// Whether a text of several lines can be written unchanged.
pub fn is_seen(text: &str) -> bool {
    text.chars().all(|c| c == '\n' || seen(c) == c)
}

/// The character, a space for white space, or the replacement character.
fn seen(c: char) -> char {
    if c == ' ' || c.is_ascii_graphic() {
        return c;
    }
    if c.is_control() || (c.is_whitespace() && !matches!(c, '\u{2028}' | '\u{2029}')) {
        return ' ';
    }
    // The standard library knows which characters have a glyph. A mark combines with a letter before it.
    let mut escaped = ['a', c].iter().collect::<String>();
    escaped = escaped.escape_debug().collect();
    if escaped.chars().eq(['a', c]) {
        c
    } else {
        REPLACED
    }
}

#[cfg(test)]
mod tests {
    use super::{is_seen, one_line, sentence, toml_string};

    #[test]
    fn nothing_ends_a_comment() {
        for (text, written) in [
            (r"t *\ int x; /\*", "t * / int x; // *"),
            ("a */ b /* c", "a * / b / * c"),
            ("a **// b", "a ** // b"),
            (r"*\*\*", "* / * / *"),
            ("what??/", "what? ?/"),
            ("????/", "? ? ? ?/"),
            ("ends with \\", "ends with /"),
            ("two\r\nlines\u{85}\u{2028}x", "two lines \u{fffd}x"),
            ("    indented", "indented"),
        ] {
            assert_eq!(sentence(text), written);
        }
    }

    #[test]
    fn what_is_seen_stays() {
        let text = "ω̇ = ½ e ω, 5 % of 3 °C - „größer“ ≤ x₁² √2 θ̈ 車輪 d'Alembert \"q\" https://a.b/c?d=1#e";
        assert_eq!(one_line(text), text);
        assert_eq!(sentence(text), text);
        assert!(is_seen(text) && is_seen("a\nb") && !is_seen("a\rb") && !is_seen("\u{202e}"));
    }

    #[test]
    fn what_is_not_seen_is_replaced() {
        let hidden = "\u{61c}\u{200b}\u{200e}\u{202e}\u{2066}\u{2028}\u{feff}\u{e000}\u{e0001}\u{ffff}\u{ad}";
        assert!(one_line(hidden).chars().all(|c| c == '\u{fffd}'));
        assert_eq!(one_line("\0\t\u{1b}\u{a0}\n"), "     ");
    }

    #[test]
    fn a_string_of_toml_is_read_again() {
        let text = "a \"b\" \\ \u{8} ' \r\n # \u{7f}";
        let table: toml_edit::DocumentMut =
            format!("a = {}", toml_string(text)).parse().expect("TOML");
        assert_eq!(table["a"].as_str(), Some(one_line(text).as_str()));
    }
}
