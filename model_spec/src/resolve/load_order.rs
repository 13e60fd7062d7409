//! The order in which loads are resolved: each after those whose forces it uses.

use crate::ast::{ExprAst, ExprAstKind, ItemAst, Spanned};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Word;

use super::resolver::Resolver;

/// Indices into a list of loads in dependency order; loads in cycles are reported and come last.
pub(super) fn ordered(resolver: &mut Resolver<'_>, items: &[&ItemAst]) -> Vec<usize> {
    let named: Vec<Vec<(usize, &Spanned<String>)>> = items
        .iter()
        .map(|item| {
            let mut names = Vec::new();
            for entry in &item.entries {
                for ast in entry.value.expressions() {
                    forces(ast, &mut names);
                }
            }
            // A missing load is reported when the name is resolved.
            let place_of = |name: &str| resolver.loads.get(name).copied();
            let mut known: Vec<_> = names
                .into_iter()
                .filter_map(|name| Some((place_of(&name.value)?, name)))
                .collect();
            // Without duplicates, as an expression may name a load many times.
            known.sort_by_key(|(place, _)| *place);
            known.dedup_by_key(|(place, _)| *place);
            known
        })
        .collect();
    let mut order: Vec<usize> = Vec::with_capacity(items.len());
    let mut waiting: Vec<usize> = (0..items.len()).collect();
    let mut done = vec![false; items.len()];
    loop {
        let before = order.len();
        waiting.retain(|&place| {
            let ready = named[place].iter().all(|(other, _)| done[*other]);
            if ready {
                order.push(place);
                done[place] = true;
            }
            !ready
        });
        if order.len() == before {
            break;
        }
    }
    if let Some(&first) = waiting.first() {
        circle(resolver, items, &named, &done, first);
    }
    order.extend(waiting);
    order
}

/// The loads whose forces an expression uses.
fn forces<'a>(ast: &'a ExprAst, names: &mut Vec<&'a Spanned<String>>) {
    if let ExprAstKind::Named(Word::Force, own) = &ast.kind {
        names.extend(own.first());
    }
    for part in ast.parts() {
        forces(part, names);
    }
}

/// Reports one cycle among the remaining loads.
fn circle(
    resolver: &mut Resolver<'_>,
    items: &[&ItemAst],
    named: &[Vec<(usize, &Spanned<String>)>],
    done: &[bool],
    first: usize,
) {
    let mut path = vec![first];
    let mut steps: Vec<&Spanned<String>> = Vec::new();
    let mut place = first;
    // Every remaining load depends on a remaining one.
    while let Some(&(next, name)) = named[place].iter().find(|(own, _)| !done[*own]) {
        steps.push(name);
        if let Some(start) = path.iter().position(|&own| own == next) {
            let mut words: Vec<String> = path[start..]
                .iter()
                .map(|&own| format!("`{}`", items[own].name.value))
                .collect();
            words.push(format!("`{}`", items[next].name.value));
            let mut diagnostic = Diagnostic::error(
                Code::ReferenceCycle,
                format!(
                    "the forces of loads depend on each other: {}",
                    words.join(" on ")
                ),
            )
            .help("write one of them without the force of another, or let it follow the motion");
            for name in steps[start..].iter().take(4) {
                diagnostic = diagnostic.at(name.span.clone(), "");
            }
            resolver.tell(diagnostic);
            return;
        }
        path.push(next);
        place = next;
    }
}
