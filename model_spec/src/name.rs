//! Validity of names.

use crate::limits::MAX_NAME;

/// The rule in words.
pub const RULE: &str = "a letter, then letters, digits and `_`, at most 64 in all";

/// Whether a name may be defined.
pub fn is_valid(name: &str) -> bool {
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
        && name.len() <= MAX_NAME
}

/// The rule as a regular expression.
pub(crate) fn pattern() -> String {
    format!("^[A-Za-z][A-Za-z0-9_]{{0,{}}}$", MAX_NAME - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_says_the_limit() {
        assert!(RULE.contains(&MAX_NAME.to_string()));
        assert!(is_valid(&"n".repeat(MAX_NAME)) && !is_valid(&"n".repeat(MAX_NAME + 1)));
    }
}
