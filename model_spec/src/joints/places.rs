//! Replaces all positions in a syntax tree.

use crate::ast::{ExprAst, ExprAstKind, ItemAst, Spanned, ValueAst};
use crate::expr::Span;

/// Maps every position of an item.
pub(super) fn relocate(item: &mut ItemAst, to: &dyn Fn(&Span) -> Span) {
    item.name.span = to(&item.name.span);
    for entry in &mut item.entries {
        entry.span = to(&entry.span);
        value(&mut entry.value, to);
    }
}

fn value(value: &mut ValueAst, to: &dyn Fn(&Span) -> Span) {
    match value {
        ValueAst::Text(_)
        | ValueAst::Word(_)
        | ValueAst::Flag(_)
        | ValueAst::Number(_)
        | ValueAst::Unit(_) => {}
        ValueAst::Numbers(numbers) => spans(numbers, to),
        ValueAst::Names(names) => spans(names, to),
        ValueAst::Expression(one) => expression(one, to),
        ValueAst::Components(all) => all.iter_mut().for_each(|one| expression(one, to)),
        ValueAst::Matrix(rows) => rows
            .iter_mut()
            .flatten()
            .for_each(|one| expression(one, to)),
        ValueAst::Tables(tables) => tables.iter_mut().for_each(|table| relocate(table, to)),
        ValueAst::Table(table) => relocate(table, to),
    }
}

fn spans<T>(all: &mut [Spanned<T>], to: &dyn Fn(&Span) -> Span) {
    for one in all {
        one.span = to(&one.span);
    }
}

fn expression(of: &mut ExprAst, to: &dyn Fn(&Span) -> Span) {
    of.span = to(&of.span);
    match &mut of.kind {
        ExprAstKind::Number(..) | ExprAstKind::Name(_) | ExprAstKind::Broken => {}
        ExprAstKind::Rate(name) => name.span = to(&name.span),
        ExprAstKind::Named(_, names) => spans(names, to),
        ExprAstKind::Negate(a) => expression(a, to),
        ExprAstKind::Binary(_, a, b) => {
            expression(a, to);
            expression(b, to);
        }
        ExprAstKind::Call(_, arguments) => arguments.iter_mut().for_each(|a| expression(a, to)),
        ExprAstKind::Choice {
            compared, branches, ..
        } => {
            for part in compared.iter_mut().chain(branches.iter_mut()) {
                expression(part, to);
            }
        }
    }
}
