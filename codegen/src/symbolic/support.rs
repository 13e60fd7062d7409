//! Interned sets of symbols on which expressions depend. Equal sets are stored once, so that a set is an
//! index and unions are memoised.

use rustc_hash::FxHashMap;

use super::node::SymbolId;

/// A set of symbols, by its index.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Support(u32);

/// All sets of symbols of a graph; the first is empty.
#[derive(Debug, Clone)]
pub(super) struct Supports {
    /// One bit per symbol, without trailing zeros.
    sets: Vec<Box<[u64]>>,
    places: FxHashMap<Box<[u64]>, Support>,
    unions: FxHashMap<(Support, Support), Support>,
}

impl Default for Supports {
    fn default() -> Self {
        let mut supports = Self {
            sets: Vec::new(),
            places: FxHashMap::default(),
            unions: FxHashMap::default(),
        };
        supports.keep(Vec::new());
        supports
    }
}

impl Supports {
    /// The set of one symbol.
    pub(super) fn of(&mut self, symbol: SymbolId) -> Support {
        let (word, bit) = place(symbol);
        let mut bits = vec![0; word + 1];
        bits[word] = bit;
        self.keep(bits)
    }

    /// The union of two sets.
    pub(super) fn union(&mut self, a: Support, b: Support) -> Support {
        let (a, b) = (a.min(b), a.max(b));
        if a == b || a == Support::default() {
            return b;
        }
        if let Some(&known) = self.unions.get(&(a, b)) {
            return known;
        }
        let (mut long, mut short) = (self.bits(a), self.bits(b));
        if long.len() < short.len() {
            std::mem::swap(&mut long, &mut short);
        }
        let mut bits = long.to_vec();
        for (word, other) in bits.iter_mut().zip(short) {
            *word |= other;
        }
        let union = self.keep(bits);
        self.unions.insert((a, b), union);
        union
    }

    /// Whether a set contains a symbol.
    pub(super) fn holds(&self, set: Support, symbol: SymbolId) -> bool {
        let (word, bit) = place(symbol);
        self.bits(set).get(word).is_some_and(|word| word & bit != 0)
    }

    /// Whether a set is a superset of another.
    pub(super) fn contains(&self, set: Support, other: Support) -> bool {
        let (bits, others) = (self.bits(set), self.bits(other));
        others.len() <= bits.len()
            && others
                .iter()
                .zip(bits)
                .all(|(other, word)| word & other == *other)
    }

    fn bits(&self, set: Support) -> &[u64] {
        &self.sets[set.0 as usize]
    }

    fn keep(&mut self, bits: Vec<u64>) -> Support {
        let bits = bits.into_boxed_slice();
        if let Some(&known) = self.places.get(&bits) {
            return known;
        }
        let place = u32::try_from(self.sets.len()).expect("fewer than 2^32 sets fit in memory");
        self.sets.push(bits.clone());
        self.places.insert(bits, Support(place));
        Support(place)
    }
}

/// Word and bit index of a symbol.
fn place(SymbolId(symbol): SymbolId) -> (usize, u64) {
    (symbol as usize / 64, 1 << (symbol % 64))
}
