//! Replaces names by their definitions.

use rustc_hash::FxHashSet;

use super::print::visible;
use super::{Expr, Graph, Node, Substitution};

/// Replaces names by their definitions, memoised.
#[derive(Debug, Default)]
pub struct Dissolved {
    definitions: Substitution,
    known: FxHashSet<Expr>,
}

impl Dissolved {
    /// `expr` with its names replaced by their definitions, except for the names that `keeps` accepts. `None`
    /// if this divides by the number zero.
    pub fn of(
        &mut self,
        graph: &mut Graph,
        expr: Expr,
        keeps: impl Fn(&str) -> bool,
    ) -> Option<Expr> {
        let mut stack: Vec<(Expr, bool)> = opaque_parts(graph, expr);
        while let Some((part, parts_done)) = stack.pop() {
            if self.known.contains(&part) {
                continue;
            }
            let value = match *graph.node(part) {
                Node::Named(id) => Some(graph.definition(id)).filter(|d| !keeps(&d.name)),
                _ => None,
            }
            .map(|definition| definition.value);
            let value = match value {
                Some(value) if !parts_done => {
                    stack.push((part, true));
                    stack.extend(opaque_parts(graph, value));
                    continue;
                }
                Some(value) => self.definitions.apply(graph, value).unwrap_or(part),
                None => part,
            };
            self.definitions.replace(graph, part, value);
            self.known.insert(part);
        }
        self.definitions.apply(graph, expr)
    }
}

/// Names and unknowns of linear systems in an expression, not yet processed.
fn opaque_parts(graph: &Graph, expr: Expr) -> Vec<(Expr, bool)> {
    let opaque = |&part: &Expr| matches!(graph.node(part), Node::Named(_) | Node::Solution { .. });
    let parts = visible(graph, expr).into_iter();
    parts.filter(opaque).map(|part| (part, false)).collect()
}
