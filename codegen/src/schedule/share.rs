//! Finds parts of sums and products that occur more than once: `m·R` inside `m·R·x` and `m·R·y`,
//! `a + b` inside `a + b + c` and `d - a - b`.
//!
//! The pair of parts with the most occurrences gets a node of its own, again and again until no
//! pair occurs twice (Breuer, "Generation of optimal code for expressions via factorization",
//! Communications of the ACM 12(6), 1969). Longer common parts arise pair by pair.

use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use super::dag::{Dag, Id, Item, Op};
use super::search::Preference;

/// Where to look for common parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Within {
    /// Common terms, up to a common sign.
    Sums,
    /// Common factors.
    Products,
}

/// Longer sums and products are left alone: pairs grow with the square of the length.
const LONGEST: usize = 64;

/// Shares the common parts of all sums, or of all products.
pub(super) fn share(dag: &mut Dag, within: Within, preference: Preference, least: u32) {
    let mut sharing = Sharing {
        within,
        preference,
        least,
        owners: Vec::new(),
        lists: Vec::new(),
        pairs: FxHashMap::default(),
        queue: BinaryHeap::new(),
    };
    for id in dag.order() {
        match (within, dag.op(id)) {
            (Within::Sums, Op::Sum(items)) | (Within::Products, Op::Product(items))
                if (2..=LONGEST).contains(&items.len()) =>
            {
                sharing.owners.push(id);
                sharing.lists.push(items.clone());
            }
            _ => {}
        }
    }
    for list in 0..sharing.lists.len() {
        sharing.count(list);
    }
    while let Some(pair) = sharing.most_frequent() {
        sharing.extract(dag, pair);
    }
    for (id, items) in sharing.owners.into_iter().zip(sharing.lists) {
        let op = match within {
            Within::Sums => Op::Sum(items),
            Within::Products => Op::Product(items),
        };
        if *dag.op(id) != op {
            dag.replace(id, op);
        }
    }
}

type Pair = [Item; 2];

/// Where a pair occurs.
#[derive(Default)]
struct Occurrences {
    count: u32,
    /// Lists that held the pair when it was counted; some may have lost it since.
    lists: Vec<usize>,
}

struct Sharing {
    within: Within,
    preference: Preference,
    /// Pairs that occur less often are left alone.
    least: u32,
    owners: Vec<Id>,
    lists: Vec<Vec<Item>>,
    pairs: FxHashMap<Pair, Occurrences>,
    /// Pairs by count; a pair enters again whenever its count grows.
    queue: BinaryHeap<(u32, (u64, u64), Pair)>,
}

impl Sharing {
    /// The pair as it is looked up, and whether both of its terms changed sign for that.
    fn normal(&self, a: Item, b: Item) -> (Pair, bool) {
        let flip = self.within == Within::Sums && a.flip;
        ([a.flipped_if(flip), b.flipped_if(flip)], flip)
    }

    /// Calls `visit` with every pair of a list and how often it fits in.
    fn for_each_pair(&self, list: usize, mut visit: impl FnMut(Pair, u32)) {
        let runs: Vec<(Item, u32)> = self.lists[list]
            .chunk_by(|a, b| a == b)
            .map(|run| (run[0], u32::try_from(run.len()).unwrap_or(u32::MAX)))
            .collect();
        for (i, &(a, count_a)) in runs.iter().enumerate() {
            if count_a >= 2 {
                visit([a, a], count_a / 2);
            }
            for &(b, count_b) in &runs[i + 1..] {
                visit(self.normal(a, b).0, count_a.min(count_b));
            }
        }
    }

    /// Counts the pairs of a list.
    fn count(&mut self, list: usize) {
        let mut found = Vec::new();
        self.for_each_pair(list, |pair, count| found.push((pair, count)));
        for (pair, count) in found {
            let occurrences = self.pairs.entry(pair).or_default();
            occurrences.count += count;
            occurrences.lists.push(list);
            if occurrences.count >= self.least {
                let rank = (self.preference.rank(pair[0]), self.preference.rank(pair[1]));
                self.queue.push((occurrences.count, rank, pair));
            }
        }
    }

    /// Takes the pairs of a list, which is about to change, out of the counts.
    fn discount(&mut self, list: usize) {
        let mut found = Vec::new();
        self.for_each_pair(list, |pair, count| found.push((pair, count)));
        for (pair, count) in found {
            if let Some(occurrences) = self.pairs.get_mut(&pair) {
                occurrences.count -= count;
            }
        }
    }

    fn most_frequent(&mut self) -> Option<Pair> {
        while let Some((count, rank, pair)) = self.queue.pop() {
            let now = self
                .pairs
                .get(&pair)
                .map_or(0, |occurrences| occurrences.count);
            if now == count {
                return Some(pair);
            }
            if now >= self.least {
                // Counts only sink between two entries.
                self.queue.push((now, rank, pair));
            }
        }
        None
    }

    /// Gives the pair a node, and replaces it in all lists.
    fn extract(&mut self, dag: &mut Dag, pair: Pair) {
        let node = match self.within {
            Within::Sums => dag.sum(pair.to_vec()),
            Within::Products => dag.product(pair.to_vec()),
        };
        let Some(occurrences) = self.pairs.remove(&pair) else {
            return;
        };
        let mut lists = occurrences.lists;
        lists.sort_unstable();
        lists.dedup();
        for list in lists {
            if self.owners[list] == node.id {
                continue;
            }
            let (items, replaced) = self.replaced(list, pair, node);
            if replaced {
                self.discount(list);
                self.lists[list] = items;
                self.count(list);
            }
        }
        // What is left of the pair, in the node itself, is not worth another node.
        self.pairs.remove(&pair);
    }

    /// A list with all occurrences of `pair` replaced, and whether there were any.
    fn replaced(&self, list: usize, pair: Pair, node: Item) -> (Vec<Item>, bool) {
        let mut items = self.lists[list].clone();
        let mut replaced = false;
        loop {
            let find = |wanted: Item| items.iter().position(|&item| item == wanted);
            let flips: &[bool] = if self.within == Within::Sums {
                &[false, true]
            } else {
                &[false]
            };
            let found = flips.iter().find_map(|&flip| {
                let first = find(pair[0].flipped_if(flip))?;
                let second = if pair[0] == pair[1] {
                    Some(first + 1).filter(|&next| items.get(next) == items.get(first))
                } else {
                    find(pair[1].flipped_if(flip))
                };
                Some((flip, first, second?))
            });
            let Some((flip, first, second)) = found else {
                break;
            };
            items.remove(first.max(second));
            items.remove(first.min(second));
            let new = node.flipped_if(flip);
            let place = items.partition_point(|&item| item < new);
            items.insert(place, new);
            replaced = true;
        }
        (items, replaced)
    }
}
