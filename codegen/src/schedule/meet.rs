//! Products that are equal once they are written out meet: `m·(h·l)` and `(m·h)·l`, which different
//! passes put together.

use rustc_hash::FxHashMap;

use super::dag::{Dag, Id, Item, Op};

/// Longer products are left alone.
const LONGEST: usize = 16;

/// Replaces every product by the shortest one that has the same factors. Tells whether any met.
pub(super) fn meet(dag: &mut Dag, order: &[Id]) -> bool {
    let mut any = false;
    let mut written_out: Vec<Option<Vec<Item>>> = vec![None; dag.len()];
    let mut known: FxHashMap<Vec<Item>, Id> = FxHashMap::default();
    for &id in order {
        let Op::Product(factors) = dag.op(id) else {
            continue;
        };
        let length = factors.len();
        let mut flat = Vec::with_capacity(LONGEST);
        for factor in factors {
            match &written_out[factor.id.index()] {
                Some(inner) => flat.extend(inner.iter().map(|part| part.flipped_if(factor.flip))),
                None => flat.push(*factor),
            }
        }
        // Numbers would have to be multiplied, and reciprocals cancelled, to be compared.
        let numbers = flat.iter().filter(|part| dag.as_number(part.id).is_some());
        if flat.len() > LONGEST || numbers.count() > 1 {
            continue;
        }
        flat.sort_unstable();
        match known.get(&flat) {
            Some(&first) => {
                let Op::Product(other) = dag.op(first) else {
                    continue;
                };
                if length < other.len() {
                    let shorter = dag.op(id).clone();
                    dag.replace(first, shorter);
                }
                dag.replace(id, Op::Product(vec![Item::plain(first)]));
                any = true;
            }
            None => {
                known.insert(flat.clone(), id);
            }
        }
        written_out[id.index()] = Some(flat);
    }
    any
}
