//! Orders the live operations, calls early.
//!
//! All vector registers are clobbered at a call. Operands of calls are therefore computed first, so that few
//! values are live across calls. A result is stored at its definition, which ends its live range. The order
//! does not affect the results.

use super::line::{Action, Call, Id, Line, Node};

/// Straight-line code with these values, calls and results.
pub(super) fn order(nodes: Vec<Node>, calls: Vec<Call>, mut stores: Vec<Action>) -> Line {
    let stored = |action: &Action| match action {
        Action::Store(id, ..) => *id,
        Action::Compute(_) | Action::Call(_) => Id(0),
    };
    stores.sort_by_key(stored);
    let (needed, called) = needed(&nodes, &calls, stores.iter().map(stored));

    let mut actions = Vec::with_capacity(nodes.len() + stores.len());
    let mut stores = stores.into_iter().peekable();
    // Leaves that are results are stored last.
    let mut at_the_end = Vec::new();
    let mut stores_of: Vec<(Id, Action)> = Vec::new();
    for store in stores.by_ref() {
        if nodes[stored(&store).index()].is_leaf() {
            at_the_end.push(store);
        } else {
            stores_of.push((stored(&store), store));
        }
    }
    for for_calls in [true, false] {
        let mut called_last = None;
        for (index, &node) in nodes.iter().enumerate() {
            if !needed[index] || called[index] != for_calls || node.is_leaf() {
                continue;
            }
            let id = Id(u32::try_from(index).unwrap_or(u32::MAX));
            match node {
                Node::Result(call, _) if called_last == Some(call) => {}
                Node::Result(call, _) => {
                    called_last = Some(call);
                    actions.push(Action::Call(call));
                }
                _ => actions.push(Action::Compute(id)),
            }
            let first = stores_of.partition_point(|(other, _)| *other < id);
            let of = stores_of[first..]
                .iter()
                .take_while(|(other, _)| *other == id);
            actions.extend(of.map(|(_, store)| *store));
        }
    }
    actions.extend(at_the_end);
    Line {
        nodes,
        calls,
        actions,
    }
}

/// The live values, and those that calls use or define.
fn needed(
    nodes: &[Node],
    calls: &[Call],
    results: impl Iterator<Item = Id>,
) -> (Vec<bool>, Vec<bool>) {
    let mut needed = vec![false; nodes.len()];
    let mut called = vec![false; nodes.len()];
    for id in results {
        needed[id.index()] = true;
    }
    for index in (0..nodes.len()).rev() {
        if !needed[index] {
            continue;
        }
        for operand in nodes[index].operands() {
            needed[operand.index()] = true;
            called[operand.index()] |= called[index];
        }
        if let Node::Result(call, _) = nodes[index] {
            let Call { given, results, .. } = &calls[call as usize];
            for id in given.iter().chain(results) {
                needed[id.index()] = true;
                called[id.index()] = true;
            }
        }
    }
    (needed, called)
}
