//! Files that all use each other.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

type Uses = BTreeMap<String, BTreeMap<String, String>>;

/// Two files that know each other may be one idea on two pages.
const MOST_FILES: usize = 2;

pub(super) fn longer_than_two(uses: &Uses) -> Vec<String> {
    let files: BTreeSet<&String> = uses.keys().collect();
    let reached: BTreeMap<&String, BTreeSet<&String>> = files
        .iter()
        .map(|&file| (file, reached(uses, file, &files)))
        .collect();
    let mut told = BTreeSet::new();
    let mut cycles = Vec::new();
    for &file in &files {
        let mutual = |&&other: &&&String| other == file || reached[other].contains(file);
        let set: BTreeSet<&String> = reached[file].iter().filter(mutual).copied().collect();
        if set.len() > MOST_FILES && told.insert(set.clone()) {
            let shortest = way_round(uses, &set);
            cycles.push(format!("{} files, as in\n{shortest}", set.len()));
        }
    }
    cycles
}

fn reached<'a>(
    uses: &'a Uses,
    from: &'a String,
    files: &BTreeSet<&'a String>,
) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut open = vec![from];
    while let Some(file) = open.pop() {
        for other in uses[file].keys().filter(|other| files.contains(other)) {
            if reached.insert(other) {
                open.push(other);
            }
        }
    }
    reached
}

/// The shortest way that visits more than two of these files and ends where it starts.
fn way_round(uses: &Uses, set: &BTreeSet<&String>) -> String {
    let mut shortest: Option<Vec<&String>> = None;
    for &from in set {
        for &to in set {
            let (there, back) = (way(uses, set, from, to), way(uses, set, to, from));
            let round: Vec<&String> = there.into_iter().chain(back.into_iter().skip(1)).collect();
            let files: BTreeSet<&&String> = round.iter().collect();
            if files.len() > MOST_FILES
                && shortest
                    .as_ref()
                    .is_none_or(|best| round.len() < best.len())
            {
                shortest = Some(round);
            }
        }
    }
    let round = shortest.unwrap_or_default();
    let step =
        |pair: &[&String]| format!("  {} → {} → {}", pair[0], uses[pair[0]][pair[1]], pair[1]);
    round.windows(2).map(step).collect::<Vec<_>>().join("\n")
}

/// The shortest way between two files of a set.
fn way<'a>(
    uses: &'a Uses,
    set: &BTreeSet<&'a String>,
    from: &'a String,
    to: &'a String,
) -> Vec<&'a String> {
    let mut before: BTreeMap<&String, &String> = BTreeMap::new();
    let mut open = VecDeque::from([from]);
    while let Some(file) = open.pop_front() {
        for other in uses[file].keys().filter(|other| set.contains(other)) {
            if other != from && !before.contains_key(other) {
                before.insert(other, file);
                open.push_back(other);
            }
        }
    }
    let mut way = vec![to];
    while let Some(&previous) = way.last().and_then(|file| before.get(*file)) {
        way.push(previous);
    }
    way.reverse();
    way
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uses(edges: &[(&str, &str)]) -> Uses {
        let mut uses = Uses::new();
        for (from, to) in edges {
            uses.entry((*to).to_owned()).or_default();
            let used = uses.entry((*from).to_owned()).or_default();
            used.insert((*to).to_owned(), "Item".to_owned());
        }
        uses
    }

    #[test]
    fn two_files_may_use_each_other_and_three_may_not() {
        let two = uses(&[("a", "b"), ("b", "a"), ("b", "c")]);
        assert!(longer_than_two(&two).is_empty());
        let three = uses(&[("a", "b"), ("b", "a"), ("b", "c"), ("c", "b")]);
        let told = longer_than_two(&three);
        assert_eq!(told.len(), 1, "{told:?}");
        assert!(told[0].contains("b → Item → c"), "{told:?}");
    }
}
