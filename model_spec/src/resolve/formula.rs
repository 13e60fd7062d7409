//! Expressions outside a spec that use its names: inputs on a command line, feedback laws.

use num_rational::BigRational;
use num_traits::{One, Zero};

use crate::ast::{ExprAst, ExprAstKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Expr, Function, Span};
use crate::joints;
use crate::parse;
use crate::units::{Dimension, Unit};

use super::dimensions::Dim;
use super::place::Place;
use super::resolver::Resolver;

/// The quantities on which an expression outside a spec may depend.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// Parameters only.
    Constant,
    /// Parameters, signals and time.
    Schedule,
    /// Parameters, signals, time and the state.
    Law,
    /// Parameters, the state and the rates of the coordinates.
    Motion,
    /// Parameters, signals, time, the state and the inputs.
    Equation,
}

/// An expression and its position.
#[derive(Debug, Clone)]
pub struct Snippet<'a> {
    /// The text around it, for the positions of findings.
    pub document: &'a str,
    /// The expression.
    pub text: &'a str,
    /// Its position in the document, quotes included.
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

/// Reads the value of a quantity, with the names of a spec that [`crate::load`] accepts; the
/// result is in SI.
///
/// - A value of plain numbers, such as `20`, `2*10` or `5*sin(2*t)`, is in the quantity's unit.
/// - Names, and numbers with a unit, carry dimensions, which are checked: `5[m/s]/R`.
/// - Gains: if time or the state may occur and no number has a unit, plain numbers can be combined with
///   names, as in `-3*x - v`, and a function of names alone, as in `sin(t)`, is a plain number.
///   All values are then in SI and dimensions are not checked. A
///   quantity that is not declared in SI cannot be given in this form, as it would be ambiguous.
///
/// The positions of the findings refer to the snippet's document.
pub fn formula(
    spec: &str,
    snippet: &Snippet<'_>,
    what: &'static str,
    scope: Scope,
    unit: &Unit,
) -> Result<Expr, Vec<Diagnostic>> {
    let ast = parse::expression_in(snippet.document, snippet.text, snippet.whole.clone())
        .map_err(|finding| vec![finding])?;
    let (tree, _) = parse::parse(spec);
    let tree = joints::expand(&tree, spec).map_or(tree, |expansion| expansion.ast);
    let mut resolver = Resolver::new(&tree, spec);
    resolver.parameters();
    let coordinates = resolver.coordinates();
    resolver.inputs();
    resolver.signals();
    resolver.announce("pseudo_velocities");
    resolver.announce("outputs");
    resolver.announce_definitions();
    resolver.pseudo_velocities(&coordinates);
    resolver.findings.clear();

    let place = match scope {
        Scope::Constant => Place::constant(what),
        Scope::Schedule => Place::scheduled(what),
        Scope::Law => Place::law(what),
        Scope::Motion => Place::motion(what),
        Scope::Equation => Place::equation(what),
    };
    let plain = is_plain(&ast);
    let numbers = any(&ast, &is_bare_number);
    let gains = scope != Scope::Constant && (numbers || plain) && !any(&ast, &has_unit);
    let ast = if plain { times(ast, unit) } else { ast };
    let typed = resolver.elaborate(&ast, &place);
    resolver.expect(&typed, Dim::Known(unit.dimension), &place);
    let found = typed.dim.known();
    let expr = typed.expr;
    resolver.settle();
    let mut findings = resolver.findings;
    if gains && (plain || unit.is_si()) {
        findings.retain(|finding| finding.code != Code::UnitMismatch);
    }
    if findings.is_empty() {
        return Ok(expr);
    }
    let help = match found {
        _ if numbers => "write units after the numbers, as in `5[m/s]`".to_owned(),
        Some(found) if found != unit.dimension && !unit.text.is_empty() => {
            names_alone(snippet.text.trim(), unit, found, scope)
        }
        _ => return Err(findings),
    };
    for finding in &mut findings {
        if finding.code == Code::UnitMismatch && finding.help.is_none() {
            finding.help = Some(help.clone());
        }
    }
    Err(findings)
}

/// The correction to suggest if the names have a different unit.
fn names_alone(text: &str, unit: &Unit, found: Dimension, scope: Scope) -> String {
    let is_name = text.chars().all(|c| c.is_alphanumeric() || c == '_');
    let text = if is_name {
        text.to_owned()
    } else {
        format!("({text})")
    };
    let own = Unit::si(found).text;
    let own = if own.contains(['*', '/']) {
        format!("({own})")
    } else {
        own
    };
    let factor = match (unit.text.as_str(), own.as_str()) {
        (unit, "1") => unit.to_owned(),
        (unit, own) => format!("{unit}/{own}"),
    };
    let with_unit = format!("write `1[{factor}]*{text}`");
    if scope == Scope::Constant || !unit.is_si() {
        return with_unit;
    }
    format!("{with_unit}, or `1*{text}`: with a plain number, all values are in SI")
}

/// Whether a value is a plain number for arguments of any dimension.
fn is_plain(ast: &ExprAst) -> bool {
    match &ast.kind {
        ExprAstKind::Number(_, unit) => unit.is_none(),
        ExprAstKind::Name(name) => name == "pi",
        ExprAstKind::Rate(_) | ExprAstKind::Named(..) | ExprAstKind::Broken => false,
        ExprAstKind::Negate(a) => is_plain(a),
        ExprAstKind::Binary(_, a, b) => is_plain(a) && is_plain(b),
        ExprAstKind::Call(function, arguments) => match function {
            Function::Sin
            | Function::Cos
            | Function::Tan
            | Function::Sinh
            | Function::Cosh
            | Function::Tanh
            | Function::Exp
            | Function::Ln
            | Function::Sign
            | Function::SmoothSign => true,
            // Angles are in radians, like names that measure one.
            Function::Asin | Function::Acos | Function::Atan | Function::Atan2 => false,
            _ => arguments.iter().all(is_plain),
        },
        ExprAstKind::Choice { branches, .. } => branches.iter().all(is_plain),
    }
}

/// Zero fits everywhere.
fn is_bare_number(ast: &ExprAst) -> bool {
    matches!(&ast.kind, ExprAstKind::Number(value, None) if !value.is_zero())
}

fn has_unit(ast: &ExprAst) -> bool {
    matches!(ast.kind, ExprAstKind::Number(_, Some(_)))
}

/// Whether an expression contains a part of some kind.
fn any(ast: &ExprAst, is: &impl Fn(&ExprAst) -> bool) -> bool {
    is(ast) || ast.parts().into_iter().any(|part| any(part, is))
}

/// A number of a unit.
fn times(number: ExprAst, unit: &Unit) -> ExprAst {
    let span = number.span.clone();
    let one = ExprAstKind::Number(BigRational::one(), Some(Box::new(unit.clone())));
    let one = ExprAst {
        kind: one,
        span: span.clone(),
    };
    ExprAst {
        kind: ExprAstKind::Binary(BinaryOp::Multiply, Box::new(number), Box::new(one)),
        span,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEC: &str = "\
[parameters]
R = { value = 0.3, unit = 'm' }
alpha = { value = 3, unit = 'deg' }
[coordinates]
x = { unit = 'm' }
[inputs]
u = { unit = 'N' }
[pseudo_velocities]
v = { value = 'dot(x)', unit = 'm/s' }
";

    fn read(text: &str, scope: Scope, unit: &str) -> Result<Expr, String> {
        let unit = crate::units::parse(unit).expect("a unit");
        let snippet = Snippet::alone(text);
        formula(SPEC, &snippet, "an input", scope, &unit).map_err(|findings| {
            let messages = findings.iter().map(|finding| finding.message.clone());
            messages.collect::<Vec<_>>().join("; ")
        })
    }

    fn accepts(text: &str, scope: Scope, unit: &str) {
        if let Err(message) = read(text, scope, unit) {
            panic!("{text}: {message}");
        }
    }

    fn refuses(text: &str, scope: Scope, unit: &str) {
        assert!(read(text, scope, unit).is_err(), "{text}");
    }

    #[test]
    fn plain_numbers_fit_every_quantity() {
        for text in ["20", "2*10", "-pi/6", "sqrt(2)", "min(1, 2)", "0"] {
            for unit in ["deg", "kN", "1"] {
                accepts(text, Scope::Constant, unit);
            }
        }
        for text in [
            "5*sin(2*t)",
            "if(t < 2, 5, -5)",
            "exp(-t)*2",
            "sin(t)",
            "-cos(t)*exp(-t)",
        ] {
            accepts(text, Scope::Schedule, "kN");
        }
    }

    #[test]
    fn quantities_are_checked_also_beside_numbers() {
        accepts("5[N]", Scope::Constant, "kN");
        accepts("2*R", Scope::Constant, "cm");
        accepts("5[m/s]/R", Scope::Constant, "rad/s");
        accepts("2*alpha", Scope::Constant, "deg");
        accepts("5[N]*sin(2[rad/s]*t)", Scope::Law, "N");
        accepts("if(t < 2[s], 5, -5)", Scope::Law, "kN");
        for text in ["5/R", "R + 1", "2*alpha", "2*5[kg]", "sin(2*R)*1[m]"] {
            refuses(text, Scope::Constant, "m");
        }
        refuses("20 + 1[deg]", Scope::Constant, "m");
        refuses("5[N]*sin(2*t)", Scope::Law, "N");
        refuses("5 + 1[N]", Scope::Law, "N");
        assert_eq!(
            read("R", Scope::Law, "N"),
            Err("an input must have the unit `N`, found a length".to_owned())
        );
    }

    #[test]
    fn a_name_of_another_unit_is_told_with_what_to_write() {
        let unit = crate::units::parse("N").expect("a unit");
        for (text, written) in [
            ("t", "1[N/s]*t"),
            ("-x", "1[N/m]*(-x)"),
            ("x", "1*x"),
            ("x + R", "1*(x + R)"),
        ] {
            let snippet = Snippet::alone(text);
            let findings = formula(SPEC, &snippet, "an input", Scope::Law, &unit);
            let findings = findings.err().unwrap_or_default();
            let help = findings.first().and_then(|finding| finding.help.clone());
            assert!(
                help.unwrap_or_default().contains(&format!("`{written}`")),
                "{text}: {findings:?}"
            );
            accepts(written, Scope::Law, "N");
        }
    }

    #[test]
    fn gains_are_in_si_and_need_a_quantity_in_si() {
        for text in ["5*sin(2*t) - 3*x - v", "2*R"] {
            accepts(text, Scope::Law, "N");
            refuses(text, Scope::Law, "kN");
            refuses(text, Scope::Constant, "N");
        }
    }

    #[test]
    fn a_motion_is_given_in_states_and_rates() {
        accepts("-2*dot(x) + v", Scope::Motion, "m/s");
        refuses("dot(x)", Scope::Law, "m/s");
        refuses("x*t", Scope::Motion, "m*s");
        refuses("dot(x)", Scope::Motion, "m");
    }

    #[test]
    fn names_are_those_of_the_scope() {
        refuses("2*y", Scope::Law, "N");
        refuses("2*u", Scope::Law, "N");
        refuses("2*x", Scope::Schedule, "N");
        refuses("2*t", Scope::Constant, "N");
        refuses("2*", Scope::Constant, "N");
        refuses("", Scope::Constant, "N");
    }
}
