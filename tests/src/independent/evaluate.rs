//! Spec expressions on any scalar.

use appell_runtime::Real;
use appell_spec::expr::{BinaryOp, Expr, ExprKind, Function, Quantity, Relation};

use super::Setting;

/// What the names of an expression stand for.
#[derive(Debug, Clone)]
pub struct Values<T> {
    /// Parameters.
    pub parameters: Vec<T>,
    /// Coordinates.
    pub coordinates: Vec<T>,
    /// Generalised velocities.
    pub rates: Vec<T>,
    /// Pseudo-velocities.
    pub speeds: Vec<T>,
    /// Inputs.
    pub inputs: Vec<T>,
    /// Signals.
    pub signals: Vec<T>,
    /// Time.
    pub time: T,
}

impl<T: Real> Values<T> {
    /// Values in a setting, with coordinates, generalised velocities and the time passed since the
    /// setting's as given.
    pub fn new(setting: &Setting<'_>, coordinates: Vec<T>, rates: Vec<T>, passed: T) -> Self {
        let lift = |values: &[f64]| values.iter().map(|&v| T::constant(v)).collect();
        let signals = setting.signals.iter().map(|s| {
            let [value, first, second] = s.map(T::constant);
            value + passed * (first + T::constant(0.5) * second * passed)
        });
        Self {
            parameters: lift(setting.parameters),
            coordinates,
            rates,
            speeds: lift(setting.speeds),
            inputs: lift(setting.inputs),
            signals: signals.collect(),
            time: T::constant(setting.t) + passed,
        }
    }

    /// The value of an expression.
    pub fn of(&self, expr: &Expr) -> T {
        match &expr.kind {
            ExprKind::Number(value) => T::constant(to_f64(value)),
            ExprKind::Quantity(quantity) => match *quantity {
                Quantity::Parameter(i) => self.parameters[i],
                Quantity::Coordinate(i) => self.coordinates[i],
                Quantity::Rate(i) => self.rates[i],
                Quantity::PseudoVelocity(i) => self.speeds[i],
                Quantity::Input(i) => self.inputs[i],
                Quantity::Signal(i) => self.signals[i],
                Quantity::Time => self.time,
                Quantity::Pi => T::constant(std::f64::consts::PI),
            },
            ExprKind::Negate(a) => -self.of(a),
            ExprKind::Binary(op, a, b) => match op {
                BinaryOp::Add => self.of(a) + self.of(b),
                BinaryOp::Subtract => self.of(a) - self.of(b),
                BinaryOp::Multiply => self.of(a) * self.of(b),
                BinaryOp::Divide => self.of(a) / self.of(b),
                BinaryOp::Power => self.power(a, b),
            },
            ExprKind::Call(function, arguments) => {
                let arguments: Vec<T> = arguments.iter().map(|a| self.of(a)).collect();
                call(*function, &arguments)
            }
            ExprKind::Choice {
                relation,
                compared,
                branches,
            } => {
                let [left, right] = [self.of(&compared[0]), self.of(&compared[1])];
                let [then, otherwise] = [self.of(&branches[0]), self.of(&branches[1])];
                match relation {
                    Relation::Less => T::if_less(left, right, then, otherwise),
                    Relation::LessOrEqual => T::if_less_or_equal(left, right, then, otherwise),
                    Relation::Greater => T::if_less(right, left, then, otherwise),
                    Relation::GreaterOrEqual => T::if_less_or_equal(right, left, then, otherwise),
                }
            }
        }
    }

    /// Three components.
    pub fn of3(&self, components: &[Expr; 3]) -> [T; 3] {
        [
            self.of(&components[0]),
            self.of(&components[1]),
            self.of(&components[2]),
        ]
    }

    fn power(&self, base: &Expr, exponent: &Expr) -> T {
        let base = self.of(base);
        match whole(exponent) {
            Some(n) => {
                let mut power = T::constant(1.0);
                for _ in 0..n.unsigned_abs() {
                    power = power * base;
                }
                if n < 0 {
                    T::constant(1.0) / power
                } else {
                    power
                }
            }
            None => base.powf(self.of(exponent)),
        }
    }
}

/// An exponent that is a small whole number.
fn whole(exponent: &Expr) -> Option<i32> {
    match &exponent.kind {
        ExprKind::Number(value) if value.is_integer() => value.to_string().parse().ok(),
        ExprKind::Negate(a) => whole(a).map(|n| -n),
        _ => None,
    }
}

/// The nearest double to a quotient of whole numbers.
fn to_f64(value: &num_rational::BigRational) -> f64 {
    use num_traits::ToPrimitive;
    value.to_f64().unwrap_or(f64::NAN)
}

fn call<T: Real>(function: Function, arguments: &[T]) -> T {
    use Function as F;
    let a = arguments[0];
    let half = T::constant(0.5);
    let hypot = |a: T, b: T| (a * a + b * b).sqrt();
    match function {
        F::Sin => a.sin(),
        F::Cos => a.cos(),
        F::Tan => a.tan(),
        F::Asin => a.asin(),
        F::Acos => a.acos(),
        F::Atan => a.atan(),
        F::Sinh => a.sinh(),
        F::Cosh => a.cosh(),
        F::Tanh => a.tanh(),
        F::Exp => a.exp(),
        F::Ln => a.ln(),
        F::Sqrt => a.sqrt(),
        F::Abs => a.abs(),
        F::Sign => a.sign(),
        F::Atan2 => a.atan2(arguments[1]),
        F::Hypot | F::SmoothAbs => hypot(a, arguments[1]),
        F::Min => T::if_less(a, arguments[1], a, arguments[1]),
        F::Max => T::if_less(a, arguments[1], arguments[1], a),
        F::SmoothSign => (a / arguments[1]).tanh(),
        F::SmoothMin => half * (a + arguments[1] - hypot(a - arguments[1], arguments[2])),
        F::SmoothMax => half * (a + arguments[1] + hypot(a - arguments[1], arguments[2])),
    }
}
