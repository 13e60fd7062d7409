//! "Did you mean": the closest of a list of words, and its text in messages.

use crate::visible::visible_line;

/// Longest part of a word that a message repeats, in characters.
const MAX_SHOWN: usize = 80;
/// Longest word worth comparing.
const MAX_LENGTH: usize = 64;

/// The candidate of which `word` is probably a misspelling, if any.
pub fn closest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if word.len() > MAX_LENGTH {
        return None;
    }
    let allowed = match word.chars().count() {
        0..=1 => 0,
        2..=4 => 1,
        5..=8 => 2,
        _ => 3,
    };
    candidates
        .into_iter()
        .filter(|c| *c != word)
        .filter(|c| c.len() <= MAX_LENGTH && c.len().abs_diff(word.len()) <= allowed)
        .map(|c| (distance(word, c), c))
        .filter(|(d, c)| *d <= allowed || c.eq_ignore_ascii_case(word))
        // The first of equally close ones, so that the answer is deterministic.
        .min_by_key(|(d, _)| *d)
        .map(|(_, c)| c)
}

/// The help for an unknown word: the candidate that was probably meant, or else the answer of
/// `otherwise`.
pub fn did_you_mean<'a>(
    word: &str,
    candidates: impl IntoIterator<Item = &'a str>,
    otherwise: impl FnOnce() -> String,
) -> String {
    closest(word, candidates).map_or_else(otherwise, meant)
}

/// The help text that names the probable intention.
pub(crate) fn meant(similar: &str) -> String {
    format!("did you mean `{similar}`?")
}

/// Words one after the other.
pub(crate) fn list<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    words.into_iter().collect::<Vec<_>>().join(", ")
}

/// A user's word, shortened for a message, on one line.
pub fn shown(word: &str) -> String {
    let first: String = word.chars().take(MAX_SHOWN).collect();
    visible_line(&first).into_owned()
}

/// Edit distance with insertions, deletions, replacements and swaps of neighbours.
fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    let mut before: Vec<usize> = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let change = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (last[j - 1] + change).min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_recognised_and_a_stranger_is_not() {
        let words = ["theta", "theta_dot", "psi"];
        assert_eq!(closest("thet", words), Some("theta"));
        assert_eq!(closest("teta", words), Some("theta"));
        assert_eq!(closest("htea", words), None);
        assert_eq!(closest("spi", words), Some("psi"));
        assert_eq!(closest("gravity", words), None);
        assert_eq!(closest("r", ["R"]), Some("R"));
        assert_eq!(closest("t", ["t"]), None);
    }
}
