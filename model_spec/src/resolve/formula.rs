//! Expressions outside a spec that use its names: inputs on a command line, feedback laws.

use num_traits::Zero;

use crate::ast::{ExprAst, ExprAstKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Expr, Span};
use crate::parse;
use crate::units::Dimension;

use super::Resolver;
use super::dimensions::Dim;
use super::place::Place;

/// What an expression outside a spec may depend on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// Parameters only.
    Constant,
    /// Parameters, signals and time.
    Schedule,
    /// Parameters, signals, time and the state.
    Law,
}

/// An expression and where it stands.
#[derive(Debug, Clone)]
pub struct Snippet<'a> {
    /// The text around it, for the places of findings.
    pub document: &'a str,
    /// The expression.
    pub text: &'a str,
    /// Where it stands in the document, quotes included.
    pub whole: Span,
}

impl<'a> Snippet<'a> {
    /// An expression without anything around it.
    pub fn alone(text: &'a str) -> Self {
        Self {
            document: text,
            text,
            whole: 0..text.len(),
        }
    }
}

/// Reads an expression with the names of a spec, which [`crate::load`] accepts.
///
/// A number without a unit is one in SI and takes whatever dimension fits; without such numbers
/// the dimension must be `wanted`, where that is known. The places of the findings are places in
/// the snippet's document.
pub fn formula(
    spec: &str,
    snippet: &Snippet<'_>,
    what: &'static str,
    scope: Scope,
    wanted: Option<Dimension>,
) -> Result<Expr, Vec<Diagnostic>> {
    let ast = parse::expression_in(snippet.document, snippet.text, snippet.whole.clone())
        .map_err(|finding| vec![finding])?;
    let (tree, _) = parse::parse(spec);
    let mut resolver = Resolver::new(&tree, spec);
    resolver.parameters();
    let coordinates = resolver.coordinates();
    resolver.inputs();
    resolver.signals();
    resolver.announce("pseudo_velocities");
    resolver.announce("outputs");
    resolver.pseudo_velocities(&coordinates);
    resolver.findings.clear();

    let place = match scope {
        Scope::Constant => Place::constant(what),
        Scope::Schedule => Place::scheduled(what),
        Scope::Law => Place::law(what),
    };
    let expr = resolver.expression(&ast, &place, wanted.map_or(Dim::Unknown, Dim::Known));
    let mut findings = resolver.findings;
    if has_bare_number(&ast) {
        findings.retain(|finding| finding.code != Code::UnitMismatch);
    }
    if findings.is_empty() {
        Ok(expr)
    } else {
        Err(findings)
    }
}

/// Whether a number stands without a unit; zero fits everywhere.
fn has_bare_number(ast: &ExprAst) -> bool {
    match &ast.kind {
        ExprAstKind::Number(value, unit) => unit.is_none() && !value.is_zero(),
        ExprAstKind::Name(_) | ExprAstKind::Rate(_) | ExprAstKind::Broken => false,
        ExprAstKind::Negate(a) => has_bare_number(a),
        ExprAstKind::Binary(_, a, b) => has_bare_number(a) || has_bare_number(b),
        ExprAstKind::Call(_, arguments) => arguments.iter().any(has_bare_number),
        ExprAstKind::Choice {
            compared, branches, ..
        } => compared.iter().chain(branches.iter()).any(has_bare_number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEC: &str = "\
[parameters]
R = { value = 0.3, unit = 'm' }
[coordinates]
x = { unit = 'm' }
[inputs]
u = { unit = 'N' }
[pseudo_velocities]
v = { value = 'dot(x)', unit = 'm/s' }
";

    fn read(text: &str, scope: Scope) -> Result<Expr, String> {
        let force = crate::units::parse("N").map(|unit| unit.dimension).ok();
        formula(SPEC, &Snippet::alone(text), "an input", scope, force).map_err(|findings| {
            findings
                .iter()
                .map(|f| f.message.clone())
                .collect::<Vec<_>>()
                .join("; ")
        })
    }

    #[test]
    fn numbers_without_unit_take_any_dimension() {
        assert!(read("5*sin(2*t) - 3*x - v", Scope::Law).is_ok());
        assert!(read("5[N]", Scope::Constant).is_ok());
    }

    #[test]
    fn units_and_names_are_checked() {
        assert_eq!(
            read("R", Scope::Law),
            Err("an input must have the unit `N`, found a length".to_owned())
        );
        assert!(read("2*y", Scope::Law).is_err());
        assert!(read("2*u", Scope::Law).is_err());
        assert!(read("2*x", Scope::Schedule).is_err());
        assert!(read("2*t", Scope::Constant).is_err());
        assert!(read("2*", Scope::Constant).is_err());
        assert!(read("", Scope::Constant).is_err());
    }
}
