//! Common-subexpression elimination in sums and products: `m·R` inside `m·R·x` and `m·R·y`, `a + b`
//! inside `a + b + c` and `d - a - b`.
//!
//! The most frequent pair of operands gets a node of its own, repeatedly until no pair occurs twice
//! (Breuer, "Generation of optimal code for expressions via factorization", Communications of the
//! ACM 12(6), 1969). Longer common subexpressions are built pair by pair.

use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

use super::dag::{Dag, Id, Item, Op};
use super::preference::Preference;

/// Where common subexpressions are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Within {
    /// Common terms, up to a common sign.
    Sums,
    /// Common factors.
    Products,
}

impl Within {
    /// The operands of a node that is searched.
    fn items(self, dag: &Dag, id: Id) -> Option<&Vec<Item>> {
        match (self, dag.op(id)) {
            (Self::Sums, Op::Sum(items)) | (Self::Products, Op::Product(items)) => Some(items),
            _ => None,
        }
    }
}

/// Longer sums and products are skipped: the number of pairs is quadratic in the length.
const LONGEST: usize = 64;

/// Eliminates subexpressions common to at least `least` sums or products. Returns whether there
/// were any.
pub(super) fn share(
    dag: &mut Dag,
    order: &[Id],
    within: Within,
    preference: Preference,
    least: u32,
) -> bool {
    let mut any = false;
    let mut sharing = Sharing {
        within,
        preference,
        least: least.max(2),
        owners: Vec::new(),
        lists: Vec::new(),
        holders: vec![Vec::new(); dag.len()],
        counts: FxHashMap::default(),
        queue: BinaryHeap::new(),
    };
    for &id in order {
        let items = within.items(dag, id);
        if let Some(items) = items.filter(|items| (2..=LONGEST).contains(&items.len())) {
            sharing.add_list(id, items);
        }
    }
    sharing.count_all();
    while let Some(pair) = sharing.most_frequent() {
        sharing.extract(dag, pair);
        any = true;
    }
    for (id, items) in sharing.owners.into_iter().zip(sharing.lists) {
        if within.items(dag, id) != Some(&items) {
            let op = match within {
                Within::Sums => Op::Sum(items),
                Within::Products => Op::Product(items),
            };
            dag.replace(id, op);
        }
    }
    any
}

type Pair = (Item, Item);

struct Sharing {
    within: Within,
    preference: Preference,
    /// Pairs that occur less often are skipped.
    least: u32,
    owners: Vec<Id>,
    lists: Vec<Vec<Item>>,
    /// By node, the lists that contain it, and some that contained it once.
    holders: Vec<Vec<usize>>,
    /// Occurrences of the pairs that are frequent enough. The count of a pair never grows: a
    /// rewriting removes operands from a list and adds only a new node.
    counts: FxHashMap<Pair, u32>,
    queue: BinaryHeap<(u32, (u64, u64), Pair)>,
}

impl Sharing {
    fn add_list(&mut self, owner: Id, items: &[Item]) {
        let mut last = None;
        for item in items {
            if last != Some(item.id) {
                self.holders[item.id.index()].push(self.lists.len());
            }
            last = Some(item.id);
        }
        self.owners.push(owner);
        self.lists.push(items.to_vec());
    }

    /// The canonical form of a pair; both signs may be flipped.
    fn normal(&self, a: Item, b: Item) -> Pair {
        let flip = self.within == Within::Sums && a.flip;
        (a.flipped_if(flip), b.flipped_if(flip))
    }

    /// Calls `visit` with every pair of a list, with multiplicity.
    fn for_each_pair(&self, list: &[Item], mut visit: impl FnMut(Pair)) {
        let mut i = 0;
        while i < list.len() {
            let run = list[i..]
                .iter()
                .take_while(|&&item| item == list[i])
                .count();
            for _ in 0..run / 2 {
                visit((list[i], list[i]));
            }
            let mut j = i + run;
            while j < list.len() {
                let other = list[j..]
                    .iter()
                    .take_while(|&&item| item == list[j])
                    .count();
                for _ in 0..run.min(other) {
                    visit(self.normal(list[i], list[j]));
                }
                j += other;
            }
            i += run;
        }
    }

    fn count_all(&mut self) {
        let mut pairs = Vec::new();
        for list in &self.lists {
            self.for_each_pair(list, |pair| pairs.push(pair));
        }
        self.enter(pairs);
    }

    /// Registers new pairs, one per occurrence.
    fn enter(&mut self, mut pairs: Vec<Pair>) {
        pairs.sort_unstable();
        for same in pairs.chunk_by(|a, b| a == b) {
            let count = u32::try_from(same.len()).unwrap_or(u32::MAX);
            if count >= self.least {
                self.counts.insert(same[0], count);
                self.queue.push((count, self.rank(same[0]), same[0]));
            }
        }
    }

    fn rank(&self, pair: Pair) -> (u64, u64) {
        (self.preference.rank(pair.0), self.preference.rank(pair.1))
    }

    fn most_frequent(&mut self) -> Option<Pair> {
        while let Some((count, rank, pair)) = self.queue.pop() {
            let now = self.counts.get(&pair).copied().unwrap_or(0);
            if now == count {
                return Some(pair);
            }
            if now >= self.least {
                self.queue.push((now, rank, pair));
            }
        }
        None
    }

    /// Creates a node for the pair, and replaces it in all lists.
    fn extract(&mut self, dag: &mut Dag, pair: Pair) {
        self.counts.remove(&pair);
        let node = match self.within {
            Within::Sums => dag.sum(vec![pair.0, pair.1]),
            Within::Products => dag.product(vec![pair.0, pair.1]),
        };
        if self.holders.len() < dag.len() {
            self.holders.resize(dag.len(), Vec::new());
        }
        let mut new_pairs = Vec::new();
        for list in self.holders[pair.0.id.index()].clone() {
            if self.owners[list] == node.id {
                continue;
            }
            let Some(items) = self.replaced(&self.lists[list], pair, node) else {
                continue;
            };
            let old = std::mem::take(&mut self.lists[list]);
            let mut gone = Vec::new();
            self.for_each_pair(&old, |pair| gone.push(pair));
            for pair in gone {
                if let Some(count) = self.counts.get_mut(&pair) {
                    *count = count.saturating_sub(1);
                }
            }
            let mut kept = Vec::new();
            self.for_each_pair(&items, |pair| kept.push(pair));
            for pair in kept {
                if let Some(count) = self.counts.get_mut(&pair) {
                    *count += 1;
                } else if pair.0.id == node.id || pair.1.id == node.id {
                    new_pairs.push(pair);
                }
            }
            self.lists[list] = items;
            self.holders[node.id.index()].push(list);
        }
        self.enter(new_pairs);
    }

    /// A list with all occurrences of `pair` replaced. `None` if there are none.
    fn replaced(&self, list: &[Item], pair: Pair, node: Item) -> Option<Vec<Item>> {
        let flips: &[bool] = if self.within == Within::Sums {
            &[false, true]
        } else {
            &[false]
        };
        let mut items: Option<Vec<Item>> = None;
        loop {
            let now = items.as_deref().unwrap_or(list);
            let find = |wanted: Item| now.iter().position(|&item| item == wanted);
            let found = flips.iter().find_map(|&flip| {
                let first = find(pair.0.flipped_if(flip))?;
                let second = if pair.0 == pair.1 {
                    Some(first + 1).filter(|&next| now.get(next) == now.get(first))
                } else {
                    find(pair.1.flipped_if(flip))
                };
                Some((flip, first, second?))
            });
            let Some((flip, first, second)) = found else {
                return items;
            };
            let items = items.get_or_insert_with(|| list.to_vec());
            items.remove(first.max(second));
            items.remove(first.min(second));
            let new = node.flipped_if(flip);
            let place = items.partition_point(|&item| item < new);
            items.insert(place, new);
        }
    }
}
