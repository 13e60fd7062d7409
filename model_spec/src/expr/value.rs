//! Values of expressions.

use num_traits::ToPrimitive;

use super::{BinaryOp, Expr, ExprKind, Function, Quantity, Relation};

impl Expr {
    /// The value in SI, given the value of each quantity by `known`; `NaN` if one is unknown.
    pub fn value(&self, known: &dyn Fn(Quantity) -> f64) -> f64 {
        let of = |expr: &Self| expr.value(known);
        match &self.kind {
            ExprKind::Number(number) => number.to_f64().unwrap_or(f64::NAN),
            ExprKind::Quantity(Quantity::Pi) => std::f64::consts::PI,
            ExprKind::Quantity(quantity) => known(*quantity),
            ExprKind::Negate(a) => -of(a),
            ExprKind::Binary(op, a, b) => {
                let (a, b) = (of(a), of(b));
                match op {
                    BinaryOp::Add => a + b,
                    BinaryOp::Subtract => a - b,
                    BinaryOp::Multiply => a * b,
                    BinaryOp::Divide => a / b,
                    BinaryOp::Power => a.powf(b),
                }
            }
            ExprKind::Call(function, arguments) => {
                let values: Vec<f64> = arguments.iter().map(of).collect();
                call(*function, &values)
            }
            ExprKind::Choice {
                relation,
                compared,
                branches,
            } => {
                let [a, b] = compared.each_ref().map(of);
                let holds = match relation {
                    Relation::Less => a < b,
                    Relation::LessOrEqual => a <= b,
                    Relation::Greater => a > b,
                    Relation::GreaterOrEqual => a >= b,
                };
                of(&branches[usize::from(!holds)])
            }
        }
    }
}

fn call(function: Function, values: &[f64]) -> f64 {
    let smooth_abs = |a: f64, w: f64| a.hypot(w);
    // Deviation of a smoothed corner from the sharp one, (√(d² + w²) − |d|) / 2.
    let rounding = |d: f64, w: f64| w * w / (2.0 * (d.abs() + d.hypot(w)));
    match (function, values) {
        (Function::Sin, [a]) => a.sin(),
        (Function::Cos, [a]) => a.cos(),
        (Function::Tan, [a]) => a.tan(),
        (Function::Asin, [a]) => a.asin(),
        (Function::Acos, [a]) => a.acos(),
        (Function::Atan, [a]) => a.atan(),
        (Function::Sinh, [a]) => a.sinh(),
        (Function::Cosh, [a]) => a.cosh(),
        (Function::Tanh, [a]) => a.tanh(),
        (Function::Exp, [a]) => a.exp(),
        (Function::Ln, [a]) => a.ln(),
        (Function::Sqrt, [a]) => a.sqrt(),
        (Function::Abs, [a]) => a.abs(),
        (Function::Sign, [a]) => f64::from(i8::from(*a > 0.0) - i8::from(*a < 0.0)),
        (Function::Atan2, [a, b]) => a.atan2(*b),
        (Function::Hypot, [a, b]) => a.hypot(*b),
        (Function::Min, [a, b]) => a.min(*b),
        (Function::Max, [a, b]) => a.max(*b),
        (Function::SmoothAbs, [a, w]) => smooth_abs(*a, *w),
        (Function::SmoothSign, [a, w]) => (a / w).tanh(),
        (Function::SmoothMin, [a, b, w]) => a.min(*b) - rounding(a - b, *w),
        (Function::SmoothMax, [a, b, w]) => a.max(*b) + rounding(a - b, *w),
        _ => f64::NAN,
    }
}
