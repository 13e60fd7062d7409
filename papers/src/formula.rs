//! Formulas as papers print them, in the grammar of specs, with powers as `^` or `**`.

use std::collections::BTreeMap;

use appell_codegen::symbolic::{self, Expr, Graph, Rational};
use appell_spec::ast::{ExprAst, ExprAstKind};
use appell_spec::expr::{BinaryOp, Function};
use appell_spec::parse::expression_in;

/// Meanings of the names of a formula.
#[derive(Debug, Clone, Default)]
pub struct Scope(BTreeMap<String, Expr>);

impl Scope {
    /// Defines a name.
    pub fn define(&mut self, name: &str, value: Expr) {
        self.0.insert(name.to_owned(), value);
    }

    /// The expression of a name.
    pub fn get(&self, name: &str) -> Option<Expr> {
        self.0.get(name).copied()
    }
}

/// The expression of a formula.
///
/// # Panics
///
/// If the formula is invalid or a name is undefined.
pub fn formula(graph: &mut Graph, scope: &Scope, text: &str) -> Expr {
    let text = text.replace("**", "^");
    let tree = expression_in(&text, &text, 0..text.len());
    let tree = tree.unwrap_or_else(|finding| panic!("{} in `{text}`", finding.message));
    build(graph, scope, &tree)
}

fn build(graph: &mut Graph, scope: &Scope, tree: &ExprAst) -> Expr {
    match &tree.kind {
        ExprAstKind::Number(value, None) => graph.number(Rational::from_big(value.clone())),
        ExprAstKind::Name(name) => {
            let value = scope.get(name);
            value.unwrap_or_else(|| panic!("no name `{name}`"))
        }
        ExprAstKind::Negate(inner) => {
            let inner = build(graph, scope, inner);
            graph.neg(inner)
        }
        ExprAstKind::Binary(op, a, b) => {
            let [a, b] = [a, b].map(|side| build(graph, scope, side));
            match op {
                BinaryOp::Add => graph.add(a, b),
                BinaryOp::Subtract => graph.sub(a, b),
                BinaryOp::Multiply => graph.mul(a, b),
                BinaryOp::Divide => graph.div(a, b),
                BinaryOp::Power => graph.power(a, b),
            }
        }
        ExprAstKind::Call(function, arguments) => {
            let argument = build(graph, scope, &arguments[0]);
            match function {
                Function::Sin => graph.sin(argument),
                Function::Cos => graph.cos(argument),
                Function::Tan => graph.tan(argument),
                Function::Sqrt => graph.function(symbolic::Function::Sqrt, argument),
                other => panic!("papers do not use `{}`", other.name()),
            }
        }
        other => panic!("{other:?} is not part of a formula"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_binds_weaker_than_a_power_and_stronger_than_a_product() {
        let mut graph = Graph::new();
        let x = graph.symbol("x");
        let mut scope = Scope::default();
        scope.define("x", x);
        let a = formula(&mut graph, &scope, "-x**2*3 + 0.5");
        let b = formula(&mut graph, &scope, "1/2 - (3*x^2)");
        assert_eq!(a, b);
    }
}
