//! Masses, inertias and friction at the nominal parameter values.

use crate::axis::Axis;
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::expr::{Expr, Quantity};
use crate::mechanism::{Body, Constraint, ConstraintKind, Inertia, Mechanism, Parameter};

use super::resolver::Resolver;

/// Rounding of a moment, relative to the largest: a thin disc lies exactly on the edge.
const ROUNDING: f64 = 1e-9;

impl Resolver<'_> {
    /// Reports physically impossible masses, inertias and coefficients of friction.
    pub(super) fn physical(&mut self, mechanism: &Mechanism) {
        let parameters = &mechanism.parameters;
        // Invalid values are placeholders, which cause no further findings.
        if self.ast.broken || self.findings.iter().any(|f| f.severity == Severity::Error) {
            return;
        }
        for body in &mechanism.bodies {
            self.physical_mass(body, parameters);
            if let Some(inertia) = &body.inertia {
                self.physical_inertia(body, inertia, parameters);
            }
        }
        for constraint in &mechanism.constraints {
            self.physical_friction(constraint, parameters);
        }
    }

    /// A coefficient that varies with the configuration has no nominal value.
    fn physical_friction(&mut self, constraint: &Constraint, parameters: &[Parameter]) {
        if let ConstraintKind::Rolling {
            friction: Some(friction),
            ..
        } = &constraint.kind
            && value(friction, parameters) < 0.0
        {
            let message = format!("the friction of `{}` is negative", constraint.name);
            let help = "a coefficient of friction is the ratio of the largest tangential force to the normal force";
            let finding = Diagnostic::error(Code::NotPhysical, message);
            self.tell(
                finding
                    .at(friction.span.clone(), "with the values of this spec")
                    .help(help),
            );
        }
    }

    fn physical_mass(&mut self, body: &Body, parameters: &[Parameter]) {
        let mass = body.sign() * value(&body.mass, parameters);
        let diagnostic = if !mass.is_finite() {
            not_finite("mass", body, &body.mass)
        } else if mass < 0.0 {
            Diagnostic::error(
                Code::NotPhysical,
                format!("the mass of `{}` is negative: {mass} kg", body.name),
            )
            .at(body.mass.span.clone(), "with the values of this spec")
        } else {
            return;
        };
        self.tell(diagnostic);
    }

    fn physical_inertia(&mut self, body: &Body, inertia: &Inertia, parameters: &[Parameter]) {
        let entries = inertia.matrix.each_ref();
        let of = |e: &Expr| body.sign() * value(e, parameters);
        let matrix = entries.map(|row| row.each_ref().map(of));
        for (row, values) in entries.iter().zip(&matrix) {
            for (entry, value) in row.iter().zip(values) {
                if !value.is_finite() {
                    self.tell(not_finite("inertia", body, entry));
                    return;
                }
            }
        }
        // A body without mass may have a partial inertia, such as that of a rotor about its axle only.
        let is_share = value(&body.mass, parameters) == 0.0;
        let is_right = if is_share {
            has_no_negative_moment(&matrix)
        } else {
            is_physical(&matrix)
        };
        if !is_right {
            let (reason, help) = impossible(&matrix);
            let message = format!("no body can have the inertia of `{}`: {reason}", body.name);
            let is_negative = (0..3).any(|i| matrix[i][i] < 0.0);
            let told = if is_negative {
                Diagnostic::error(Code::NotPhysical, message)
            } else {
                Diagnostic::warning(Code::NotPhysical, message)
            };
            self.tell(
                told.at(inertia.span.clone(), "with the values of this spec")
                    .help(help),
            );
        }
    }
}

/// Why no mass distribution has such a tensor, and a hint on the probable mistake.
fn impossible(inertia: &[[f64; 3]; 3]) -> (String, &'static str) {
    let moments = [inertia[0][0], inertia[1][1], inertia[2][2]];
    let total: f64 = moments.iter().sum();
    for (axis, moment) in Axis::LETTERS.iter().zip(moments) {
        if moment < 0.0 {
            let reason = format!(
                "the moment about {axis} is negative, {} kg*m^2",
                rounded(moment)
            );
            return (
                reason,
                "a moment of inertia is an integral of squared distances; check the sign",
            );
        }
        let others = total - moment;
        if moment - others > ROUNDING * total {
            let reason = format!(
                "the moment about {axis}, {} kg*m^2, exceeds the sum of the other two, {} kg*m^2",
                rounded(moment),
                rounded(others)
            );
            let help = "each moment is at most the sum of the other two, with equality for a thin disc \
                        or rod";
            return (reason, help);
        }
    }
    (
        "its products are too large for its moments".to_owned(),
        "each principal moment is positive and at most the sum of the other two",
    )
}

fn not_finite(what: &str, body: &Body, entry: &Expr) -> Diagnostic {
    Diagnostic::error(
        Code::NotFinite,
        format!("the {what} of `{}` is not finite", body.name),
    )
    .at(entry.span.clone(), "with the values of this spec")
}

/// Four digits are enough for a computed value.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// Whether a tensor belongs to some distribution of mass: its second moments, `tr(I)/2 - I`, form
/// a matrix without negative eigenvalue.
fn is_physical(inertia: &[[f64; 3]; 3]) -> bool {
    let half_trace = (inertia[0][0] + inertia[1][1] + inertia[2][2]) / 2.0;
    let mut moments = inertia.map(|row| row.map(|entry| -entry));
    for i in 0..3 {
        moments[i][i] += half_trace;
    }
    half_trace >= 0.0 && is_semidefinite(&moments, half_trace)
}

/// Whether the moments about all axes are nonnegative.
fn has_no_negative_moment(inertia: &[[f64; 3]; 3]) -> bool {
    let trace = inertia[0][0] + inertia[1][1] + inertia[2][2];
    trace >= 0.0 && is_semidefinite(inertia, trace)
}

/// Whether a symmetric matrix has no negative eigenvalue, by its principal minors. Rounding is relative to
/// `size`, so that the test is invariant under scaling; for size zero all entries are zero.
fn is_semidefinite(matrix: &[[f64; 3]; 3], size: f64) -> bool {
    if size == 0.0 {
        return matrix.iter().flatten().all(|entry| *entry == 0.0);
    }
    let s = matrix.map(|row| row.map(|entry| entry / size));
    let minor = |i: usize, j: usize| s[i][i] * s[j][j] - s[i][j] * s[j][i];
    let determinant = s[0][0] * minor(1, 2) - s[0][1] * (s[1][0] * s[2][2] - s[1][2] * s[2][0])
        + s[0][2] * (s[1][0] * s[2][1] - s[1][1] * s[2][0]);
    let minors = [
        s[0][0],
        s[1][1],
        s[2][2],
        minor(0, 1),
        minor(0, 2),
        minor(1, 2),
        determinant,
    ];
    minors.iter().all(|m| *m >= -ROUNDING)
}

/// The value of a constant expression; `NaN` where it has none.
pub(super) fn value(expr: &Expr, parameters: &[Parameter]) -> f64 {
    expr.value(&|quantity| match quantity {
        Quantity::Parameter(id) => parameters.get(id.index()).map_or(f64::NAN, |p| p.value),
        _ => f64::NAN,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagonal(moments: [f64; 3]) -> [[f64; 3]; 3] {
        let mut matrix = [[0.0; 3]; 3];
        for i in 0..3 {
            matrix[i][i] = moments[i];
        }
        matrix
    }

    #[test]
    fn discs_rods_and_points_are_bodies_and_a_lone_moment_is_not() {
        for moments in [
            [1.0, 2.0, 1.0],
            [0.1, 0.3, 0.2],
            [1.0, 1.0, 0.0],
            [0.0, 0.0, 0.0],
        ] {
            assert!(is_physical(&diagonal(moments)), "{moments:?}");
        }
        for moments in [
            [0.0, 1.0, 0.0],
            [1.0, 2.1, 1.0],
            [-1.0, 1.0, 1.0],
            [-1.0, -1.0, -1.0],
        ] {
            assert!(!is_physical(&diagonal(moments)), "{moments:?}");
        }
    }

    #[test]
    fn products_of_inertia_count() {
        let mut matrix = diagonal([1.0, 1.0, 1.0]);
        for (product, expected) in [(0.4, true), (0.6, false)] {
            matrix[0][1] = product;
            matrix[1][0] = product;
            assert_eq!(is_physical(&matrix), expected, "{product}");
        }
    }
}
