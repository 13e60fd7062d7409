//! Texts of a spec within Markdown, escaped so that they appear verbatim.

use appell_spec::visible;

/// Characters that begin emphasis, a link, an image, an entity or a tag within a line.
const MARKS: &str = "\\`*_[]<>&#|~!$";

/// A sentence, on one line.
pub(crate) fn prose(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    let line = words.join(" ");
    let line = visible(&line);
    let mut escaped = String::with_capacity(line.len());
    let mut letters = line.chars().peekable();
    // A line with such a start is a list, a heading or a rule.
    let mut begins = true;
    while let Some(letter) = letters.next() {
        let is_address = letter == ':' && letters.peek() == Some(&'/');
        if is_address || MARKS.contains(letter) || begins && "-+=.)".contains(letter) {
            escaped.push('\\');
        }
        begins &= letter.is_ascii_digit();
        escaped.push(letter);
    }
    escaped
}

/// A text within a line, as code.
pub(crate) fn code(text: &str) -> String {
    let text = visible(text);
    let fence = "`".repeat(longest_run(&text) + 1);
    if fence.len() == 1 {
        return format!("`{text}`");
    }
    // Markdown strips one blank on either side.
    format!("{fence} {text} {fence}")
}

/// Lines of a spec, as code.
pub(crate) fn block(lines: &[String]) -> String {
    let text = lines.join("\n");
    let text = visible(&text);
    let fence = "`".repeat(longest_run(&text).max(2) + 1);
    format!("{fence}toml\n{text}\n{fence}")
}

/// Longest run of backticks.
fn longest_run(text: &str) -> usize {
    let runs = text.split(|letter| letter != '`').map(str::len);
    runs.max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_has_no_marks() {
        for (text, escaped) in [
            ("half of a*b*c", r"half of a\*b\*c"),
            ("[x](http://y.test)\n# z", r"\[x\](http\://y.test) \# z"),
            (
                "<img src=x> ![i](y) &lt;",
                r"\<img src=x\> \!\[i\](y) \&lt;",
            ),
            ("12. of a list", r"12\. of a list"),
            ("- rule", r"\- rule"),
            ("from 0.5 to 1 (m)", "from 0.5 to 1 (m)"),
            ("a\u{202e}b", r"a\\u{202e}b"),
        ] {
            assert_eq!(prose(text), escaped);
        }
    }

    #[test]
    fn code_ends_at_its_own_fence() {
        assert_eq!(code("k"), "`k`");
        assert_eq!(code("a``b"), "``` a``b ```");
        let lines = ["about = 'x", "```", "[evil](x)'"].map(str::to_owned);
        assert_eq!(block(&lines), "````toml\nabout = 'x\n```\n[evil](x)'\n````");
    }
}
