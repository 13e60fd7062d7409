//! The difference of two texts by lines, in the unified form that `diff -u` writes.

use std::fmt::Write as _;

/// Equal lines around a difference.
const CONTEXT: usize = 3;

/// The difference of two texts; nothing if they are the same. Lines that are only in the first begin with `-`, those that
/// are only in the second with `+`.
///
/// ```
/// use appell::difference::unified;
///
/// let told = unified("a.xml", "b.xml", "one\ntwo\nthree\n", "one\n2\nthree\n");
/// assert_eq!(told, "--- a.xml\n+++ b.xml\n@@ -1,3 +1,3 @@\n one\n-two\n+2\n three\n");
/// assert_eq!(unified("a.xml", "b.xml", "same", "same"), "");
/// ```
pub fn unified(before_name: &str, after_name: &str, before: &str, after: &str) -> String {
    let [old, new] = [before, after].map(|text| text.split_inclusive('\n').collect::<Vec<_>>());
    let changes = changes(&old, &new);
    if changes.is_empty() {
        return String::new();
    }
    let mut text = format!("--- {before_name}\n+++ {after_name}\n");
    let near = |a: &Change, b: &Change| b.old[0] - a.old[1] <= 2 * CONTEXT;
    for hunk in changes.chunk_by(near) {
        let (first, last) = (&hunk[0], &hunk[hunk.len() - 1]);
        let lead = first.old[0].min(CONTEXT);
        let trail = (old.len() - last.old[1]).min(CONTEXT);
        let range = |from: usize, to: usize| {
            let (from, count) = (from - lead, to + trail - (from - lead));
            format!("{},{count}", from + usize::from(count > 0))
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "@@ -{} +{} @@",
            range(first.old[0], last.old[1]),
            range(first.new[0], last.new[1])
        );
        let mut at = first.old[0] - lead;
        for change in hunk {
            write_lines(&mut text, ' ', &old[at..change.old[0]]);
            write_lines(&mut text, '-', &old[change.old[0]..change.old[1]]);
            write_lines(&mut text, '+', &new[change.new[0]..change.new[1]]);
            at = change.old[1];
        }
        write_lines(&mut text, ' ', &old[at..at + trail]);
    }
    text
}

fn write_lines(text: &mut String, mark: char, lines: &[&str]) {
    for line in lines {
        text.push(mark);
        text.push_str(line);
        if !line.ends_with('\n') {
            text.push_str("\n\\ No newline at end of file\n");
        }
    }
}

/// Lines that are replaced by others: each from, to.
struct Change {
    old: [usize; 2],
    new: [usize; 2],
}

/// A shortest sequence of changes.
fn changes(old: &[&str], new: &[&str]) -> Vec<Change> {
    let mut ends = [0, 0];
    let mut changes = Vec::new();
    let matched = matched(old, new).into_iter();
    for [a, b] in matched.chain([[old.len(), new.len()]]) {
        if [a, b] != ends {
            changes.push(Change {
                old: [ends[0], a],
                new: [ends[1], b],
            });
        }
        ends = [a + 1, b + 1];
    }
    changes
}

/// Equal lines of both texts, as many as possible (E. W. Myers, *An O(ND) Difference Algorithm and Its Variations*,
/// Algorithmica 1, 1986).
fn matched(old: &[&str], new: &[&str]) -> Vec<[usize; 2]> {
    let most = old.len() + new.len();
    // How far the paths with so many changes reach in the old text, by their diagonal: old line − new line, plus `most`.
    let mut reach = vec![0; 2 * most + 2];
    let mut history = Vec::new();
    for changes in 0..=most {
        history.push(reach[most - changes..=most + changes + 1].to_vec());
        for diagonal in (most - changes..=most + changes).step_by(2) {
            let is_added = diagonal == most - changes
                || diagonal != most + changes && reach[diagonal - 1] < reach[diagonal + 1];
            let mut a: usize = if is_added {
                reach[diagonal + 1]
            } else {
                reach[diagonal - 1] + 1
            };
            while a < old.len() && old.get(a) == new.get(a + most - diagonal) {
                a += 1;
            }
            reach[diagonal] = a;
            if a >= old.len() && a + most >= new.len() + diagonal {
                return walked(&history, most, [old.len(), new.len()]);
            }
        }
    }
    Vec::new()
}

/// The equal lines on the path to the ends of both texts.
fn walked(history: &[Vec<usize>], most: usize, ends: [usize; 2]) -> Vec<[usize; 2]> {
    let [mut a, mut b] = ends;
    let mut matched = Vec::new();
    for (changes, reach) in history.iter().enumerate().rev() {
        let at = |diagonal: usize| reach[diagonal + changes - most];
        let diagonal = a + most - b;
        let is_added = diagonal == most - changes
            || diagonal != most + changes && at(diagonal - 1) < at(diagonal + 1);
        let before = if is_added { diagonal + 1 } else { diagonal - 1 };
        let (from_a, from_b) = if changes == 0 {
            (0, 0)
        } else {
            (at(before), at(before) + most - before)
        };
        while a > from_a && b > from_b {
            (a, b) = (a - 1, b - 1);
            matched.push([a, b]);
        }
        (a, b) = (from_a, from_b);
    }
    matched.reverse();
    matched
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distant_differences_have_hunks_of_their_own() {
        let lines = |changed: &[(usize, &str)]| -> String {
            let line = |k: usize| {
                let other = changed.iter().find(|(own, _)| *own == k);
                other.map_or_else(|| format!("line {k}\n"), |(_, text)| (*text).to_owned())
            };
            (0..30).map(line).collect()
        };
        let told = unified("a", "b", &lines(&[]), &lines(&[(1, ""), (20, "x\ny\n")]));
        let expected = "\
--- a
+++ b
@@ -1,5 +1,4 @@
 line 0
-line 1
 line 2
 line 3
 line 4
@@ -18,7 +17,8 @@
 line 17
 line 18
 line 19
-line 20
+x
+y
 line 21
 line 22
 line 23
";
        assert_eq!(told, expected);
    }

    #[test]
    fn applying_the_difference_gives_the_other_text() {
        for (before, after) in [
            ("", "a\n"),
            ("a\n", ""),
            ("a", "a\n"),
            ("a\nb\nc\nd\n", "b\nc\nx\nd\ne\n"),
            ("c\na\nb\nc\na\nb\n", "a\nc\nb\na\nb\na\n"),
        ] {
            let told = unified("a", "b", before, after);
            // The end of a text without a newline.
            let told = told.replace("\n\\ No newline at end of file\n", "\0\n");
            let of = |marks: [char; 2]| -> String {
                let lines = told.split_inclusive('\n').skip(2);
                let own = lines.filter(|line| line.starts_with(marks));
                own.map(|line| &line[1..])
                    .collect::<String>()
                    .replace("\0\n", "")
            };
            assert_eq!((&*of([' ', '-']), &*of([' ', '+'])), (before, after));
        }
    }
}
