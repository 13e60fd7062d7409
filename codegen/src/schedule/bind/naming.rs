//! Chooses the names of values: of the derivation or the result, of a hint, of the operation or of the consumer.

use super::{Binding, Built};
use crate::schedule::dag::{Id, Name};
use crate::schedule::monomial::Monomial;
use crate::schedule::piece::{Piece, describe};
use crate::schedule::signs::keeps_its_name;

impl Binding<'_> {
    /// Name from the derivation, or of the result.
    pub(super) fn given_name(&self, id: Id) -> Option<String> {
        let label = self.outline.labels[id.index()].as_ref();
        let derived = self.derived_name(id);
        let derived = derived.map(|name| &self.function.graph.definition(name.definition).name);
        derived.or(label.map(|label| &label.0)).cloned()
    }

    /// Name from the derivation; the name of a result takes precedence over one made up by
    /// differentiation.
    pub(super) fn derived_name(&self, id: Id) -> Option<Name> {
        let label = self.outline.labels[id.index()].as_ref();
        self.dag.names[id.index()].filter(|name| !name.automatic || label.is_none())
    }

    /// Whether the name of a node denotes minus the node; `None` without a name.
    pub(super) fn sign_of_name(&self, id: Id) -> Option<bool> {
        let label = self.outline.labels[id.index()].as_ref();
        let derived = self.derived_name(id).map(|name| name.negative);
        derived.or(label.map(|label| label.1))
    }

    /// Binds a value to its most informative name. `negative` says that the piece is minus the
    /// node.
    pub(super) fn named(&mut self, id: Id, piece: Piece, negative: bool) -> Built {
        let sign = self.sign_of_name(id);
        let given = self
            .given_name(id)
            .filter(|_| !self.tells_itself(id, &piece));
        let (piece, negative) = match given {
            Some(name) if sign == Some(negative) => (self.define(&name, piece), negative),
            Some(name) if self.takes_its_sign(id) => {
                let opposite = piece.opposite(&mut self.tape);
                (self.define(&name, opposite), !negative)
            }
            // A value of the opposite sign is named after its own operation.
            _ => {
                let hint = self.hint(id, negative);
                (self.define_by_making(id, piece, hint), negative)
            }
        };
        Built { piece, negative }
    }

    /// Whether a shared value is better named after its factors than after one of its uses.
    pub(super) fn tells_itself(&self, id: Id, piece: &Piece) -> bool {
        const FEW: usize = 3;
        self.outline.is_entry(id)
            && self.derived_name(id).is_none_or(|name| name.automatic)
            && self.outline.feeds_others(id)
            && Monomial::of(piece.value, &self.tape, &self.products).is_some_and(|product| {
                // A hint may add a name but not replace one.
                let hinted = product.values().any(|value| self.hinted.contains(&value));
                !hinted
                    && product.length() <= FEW
                    && product.name(&self.tape, &self.arguments).is_some()
            })
    }

    /// Whether a value computed with the opposite sign is negated to keep its name.
    pub(super) fn takes_its_sign(&self, id: Id) -> bool {
        self.dag.names[id.index()].is_some()
            || keeps_its_name(self.dag, id)
            || !self.outline.is_shared(id)
    }

    /// The name of a hint, or one made of the cofactors; `negative` says that minus the node is
    /// bound.
    pub(super) fn hint(&self, id: Id, negative: bool) -> Option<String> {
        let hint = self.hints[id.index()].and_then(|(number, opposite)| {
            let hint = &self.program.hints[number];
            if opposite == negative {
                Some(hint.name.clone())
            } else {
                hint.opposite.clone()
            }
        });
        hint.or_else(|| self.by_factors(id, negative))
    }

    /// `consumer_part_2`
    pub(super) fn fallback(&mut self, id: Id, word: &str) -> String {
        let feed = self.outline.feeds[id.index()];
        let consumer = feed
            .and_then(|feed| self.given_name(feed))
            .unwrap_or_else(|| "result".to_owned());
        let count = &mut self.parts[feed.unwrap_or(id).index()];
        *count += 1;
        format!("{consumer}_{word}_{count}")
    }

    /// Binds a value to a name made from its operation.
    pub(super) fn define_by_making(&mut self, id: Id, piece: Piece, hint: Option<String>) -> Piece {
        let described = describe(piece.value, &self.tape, &self.products, &self.arguments);
        let product = described
            .is_some()
            .then(|| Monomial::of(piece.value, &self.tape, &self.products));
        let hinted = described.is_none() && hint.is_some();
        let name = described
            .or(hint)
            .unwrap_or_else(|| self.fallback(id, "part"));
        let piece = self.define(&name, piece);
        if hinted {
            self.hinted.insert(piece.value);
        }
        if let Some(product) = product.flatten() {
            self.products.insert(piece.value, product);
        }
        piece
    }
}
