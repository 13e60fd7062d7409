//! Ranges of expressions over declared ranges of symbols.
//!
//! Every operation rounds outwards, so the true value lies in the interval. Beside the interval each
//! expression carries whether it can be zero: a product of positive numbers stays positive where its
//! lower bound underflows, and `exp` never vanishes though its infimum is 0.

use super::{Expr, Function, Graph, Node, Relation, SymbolId};

/// All numbers from `lo` to `hi`; the bounds may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub lo: f64,
    /// Upper bound.
    pub hi: f64,
}

/// An interval, and whether the value can be zero.
#[derive(Debug, Clone, Copy)]
struct Range {
    interval: Interval,
    nonzero: bool,
}

/// Ranges on one graph, remembered by expression. The graph may grow between the questions.
#[derive(Debug)]
pub struct Intervals {
    symbols: Vec<Interval>,
    known: Vec<Option<Range>>,
    stack: Vec<Expr>,
}

impl Intervals {
    /// Ranges that follow from those of symbols, each `(symbol, lowest, highest)`. A symbol without a
    /// range can be any number.
    pub fn new(g: &Graph, ranges: Vec<(SymbolId, f64, f64)>) -> Self {
        let mut symbols = vec![Interval::ALL; g.symbol_count()];
        for (symbol, lo, hi) in ranges {
            // A range that is no range says nothing.
            if let Some(place) = symbols.get_mut(symbol.0 as usize)
                && lo <= hi
            {
                *place = Interval { lo, hi };
            }
        }
        Self {
            symbols,
            known: Vec::new(),
            stack: Vec::new(),
        }
    }

    /// An interval that holds every value of `e`.
    pub fn of(&mut self, g: &Graph, e: Expr) -> Interval {
        self.range(g, e).interval
    }

    /// Whether `e` is provably different from zero everywhere it is defined.
    pub fn cannot_vanish(&mut self, g: &Graph, e: Expr) -> bool {
        self.range(g, e).nonzero
    }

    fn range(&mut self, g: &Graph, root: Expr) -> Range {
        if self.known.len() < g.len() {
            self.known.resize(g.len(), None);
        }
        let mut stack = std::mem::take(&mut self.stack);
        stack.push(root);
        while let Some(&expr) = stack.last() {
            let index = expr.0 as usize;
            if self.known[index].is_none() {
                let height = stack.len();
                // The unknowns of a system are anything; its entries do not matter.
                if !matches!(g.node(expr), Node::Solution { .. }) {
                    g.for_each_part(expr, |part| {
                        if self.known[part.0 as usize].is_none() {
                            stack.push(part);
                        }
                    });
                }
                if stack.len() > height {
                    continue;
                }
                self.known[index] = Some(self.step(g, expr));
            }
            stack.pop();
        }
        self.stack = stack;
        self.at(root)
    }

    fn at(&self, expr: Expr) -> Range {
        self.known[expr.0 as usize].unwrap_or(Range::ANY)
    }

    /// The range of a node whose parts are known.
    fn step(&self, g: &Graph, expr: Expr) -> Range {
        match g.node(expr) {
            Node::Number(n) => Range::number(n.to_f64(), n.is_zero()),
            Node::Symbol(symbol) => Range::of(
                self.symbols
                    .get(symbol.0 as usize)
                    .copied()
                    .unwrap_or(Interval::ALL),
            ),
            Node::Named(id) => self.at(g.definition(*id).value),
            Node::Sum(terms) => {
                let mut sum = Range::number(0.0, true);
                for term in terms {
                    let c = &term.coefficient;
                    let scaled = Range::number(c.to_f64(), false).times(self.at(term.expr));
                    sum = sum.plus(scaled);
                }
                sum
            }
            Node::Product(factors) => factors.iter().fold(Range::number(1.0, false), |p, f| {
                p.times(self.at(f.base).power(f.exponent))
            }),
            // cos(arctan x) = 1/√(1 + x²), which the ends of the interval of an arctangent do not tell.
            Node::Function(Function::Cos, x) if is_arctangent(g, *x) => Range {
                interval: Interval { lo: 0.0, hi: 1.0 },
                nonzero: true,
            },
            Node::Function(function, x) => self.at(*x).function(*function),
            Node::Atan2(..) => Range::of(Interval {
                lo: -PI_UP,
                hi: PI_UP,
            }),
            Node::Power(base, exponent) => self.at(*base).real_power(self.at(*exponent)),
            Node::Choice {
                relation,
                compared,
                branches,
            } => {
                let [left, right] = compared.map(|e| self.at(e).interval);
                let [then, otherwise] = branches.map(|e| self.at(e));
                let (always, never) = match relation {
                    Relation::Less => (left.hi < right.lo, left.lo >= right.hi),
                    Relation::LessOrEqual => (left.hi <= right.lo, left.lo > right.hi),
                };
                if always {
                    then
                } else if never {
                    otherwise
                } else {
                    Range {
                        interval: Interval {
                            lo: then.interval.lo.min(otherwise.interval.lo),
                            hi: then.interval.hi.max(otherwise.interval.hi),
                        },
                        nonzero: then.nonzero && otherwise.nonzero,
                    }
                }
            }
            Node::Solution { .. } => Range::ANY,
        }
    }
}

fn is_arctangent(g: &Graph, expr: Expr) -> bool {
    match g.node(expr) {
        Node::Function(Function::Atan, _) => true,
        Node::Named(id) => is_arctangent(g, g.definition(*id).value),
        _ => false,
    }
}

/// The double above π.
const PI_UP: f64 = 3.141_592_653_589_793_6;
/// The double above π/2.
const HALF_PI_UP: f64 = 1.570_796_326_794_896_8;

impl Interval {
    /// The whole line.
    pub const ALL: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    /// Whether `x` lies in it.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// Wider by one rounding on each side. An undefined bound is no bound.
    fn widened(self) -> Self {
        let lo = if self.lo.is_nan() {
            f64::NEG_INFINITY
        } else {
            self.lo.next_down()
        };
        let hi = if self.hi.is_nan() {
            f64::INFINITY
        } else {
            self.hi.next_up()
        };
        Self { lo, hi }
    }

    /// Wider by the errors of the elementary functions in a mathematical library.
    fn loosened(self) -> Self {
        let margin = |x: f64| x.abs() * 4.0 * f64::EPSILON + f64::MIN_POSITIVE;
        Self {
            lo: self.lo - margin(self.lo),
            hi: self.hi + margin(self.hi),
        }
        .widened()
    }

    fn meet(self, lo: f64, hi: f64) -> Self {
        Self {
            lo: self.lo.max(lo),
            hi: self.hi.min(hi),
        }
    }

    /// Image under an increasing function.
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            lo: f(self.lo),
            hi: f(self.hi),
        }
        .loosened()
    }
}

impl Range {
    const ANY: Self = Self {
        interval: Interval::ALL,
        nonzero: false,
    };

    fn of(interval: Interval) -> Self {
        Self {
            interval,
            nonzero: interval.lo > 0.0 || interval.hi < 0.0,
        }
    }

    fn number(value: f64, is_zero: bool) -> Self {
        let exact = value.fract() == 0.0 && value.abs() < 9e15;
        let interval = Interval {
            lo: value,
            hi: value,
        };
        let interval = if exact { interval } else { interval.widened() };
        Self {
            interval,
            nonzero: !is_zero,
        }
    }

    fn is_nonnegative(self) -> bool {
        self.interval.lo >= 0.0
    }

    fn is_nonpositive(self) -> bool {
        self.interval.hi <= 0.0
    }

    fn negated(self) -> Self {
        Self {
            interval: Interval {
                lo: -self.interval.hi,
                hi: -self.interval.lo,
            },
            ..self
        }
    }

    fn plus(self, other: Self) -> Self {
        let (a, b) = (self.interval, other.interval);
        let mut interval = Interval {
            lo: a.lo + b.lo,
            hi: a.hi + b.hi,
        };
        // Adding nothing rounds nothing.
        let zero = Interval { lo: 0.0, hi: 0.0 };
        if a != zero && b != zero {
            interval = interval.widened();
        }
        let mut same_sign = false;
        if self.is_nonnegative() && other.is_nonnegative() {
            interval = interval.meet(0.0, f64::INFINITY);
            same_sign = true;
        } else if self.is_nonpositive() && other.is_nonpositive() {
            interval = interval.meet(f64::NEG_INFINITY, 0.0);
            same_sign = true;
        }
        let nonzero = same_sign && (self.nonzero || other.nonzero);
        Self {
            interval,
            nonzero: nonzero || Self::of(interval).nonzero,
        }
    }

    fn times(self, other: Self) -> Self {
        let (a, b) = (self.interval, other.interval);
        // A bound of infinity stands for large numbers, and those times zero are zero.
        let mul = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
        let corners = [
            mul(a.lo, b.lo),
            mul(a.lo, b.hi),
            mul(a.hi, b.lo),
            mul(a.hi, b.hi),
        ];
        let mut interval = Interval {
            lo: corners.iter().copied().fold(f64::INFINITY, f64::min),
            hi: corners.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        };
        let one = Interval { lo: 1.0, hi: 1.0 };
        if a != one && b != one {
            interval = interval.widened();
        }
        let alike = (self.is_nonnegative() && other.is_nonnegative())
            || (self.is_nonpositive() && other.is_nonpositive());
        let opposite = (self.is_nonnegative() && other.is_nonpositive())
            || (self.is_nonpositive() && other.is_nonnegative());
        if alike {
            interval = interval.meet(0.0, f64::INFINITY);
        }
        if opposite {
            interval = interval.meet(f64::NEG_INFINITY, 0.0);
        }
        Self {
            interval,
            nonzero: self.nonzero && other.nonzero,
        }
    }

    fn reciprocal(self) -> Self {
        let Interval { lo, hi } = self.interval;
        let interval = if lo >= 0.0 {
            Interval {
                lo: 1.0 / hi,
                hi: 1.0 / lo.abs(),
            }
            .widened()
            .meet(0.0, f64::INFINITY)
        } else if hi <= 0.0 {
            // -0.0 would send the bound to the other infinity.
            Interval {
                lo: -1.0 / hi.abs(),
                hi: 1.0 / lo,
            }
            .widened()
            .meet(f64::NEG_INFINITY, 0.0)
        } else {
            Interval::ALL
        };
        Self {
            interval,
            nonzero: true,
        }
    }

    fn power(self, exponent: i32) -> Self {
        if exponent < 0 {
            return self.power(-exponent).reciprocal();
        }
        if exponent == 1 {
            return self;
        }
        let Interval { lo, hi } = self.interval;
        // The error of the power grows with the exponent.
        let margin = 1.0 + f64::from(exponent) * f64::EPSILON;
        let outwards = |x: f64, up: bool| {
            let y = x.powi(exponent);
            if (y > 0.0) == up {
                y * margin
            } else {
                y / margin
            }
        };
        let interval = if exponent % 2 == 1 {
            Interval {
                lo: outwards(lo, false),
                hi: outwards(hi, true),
            }
        } else {
            let far = lo.abs().max(hi.abs());
            let near = if lo <= 0.0 && hi >= 0.0 {
                0.0
            } else {
                lo.abs().min(hi.abs())
            };
            Interval {
                lo: outwards(near, false),
                hi: outwards(far, true),
            }
        };
        let mut interval = interval.widened();
        if exponent % 2 == 0 || lo >= 0.0 {
            interval = interval.meet(0.0, f64::INFINITY);
        } else if hi <= 0.0 {
            interval = interval.meet(f64::NEG_INFINITY, 0.0);
        }
        Self {
            interval,
            nonzero: self.nonzero,
        }
    }

    /// `a^b`. The exponent may be an integer by chance, so a negative base has a power.
    fn real_power(self, exponent: Self) -> Self {
        let base = self.interval;
        if base.lo < 0.0 {
            return Self {
                interval: Interval::ALL,
                nonzero: self.nonzero,
            };
        }
        let e = exponent.interval;
        let corners = [
            base.lo.powf(e.lo),
            base.lo.powf(e.hi),
            base.hi.powf(e.lo),
            base.hi.powf(e.hi),
        ];
        let mut interval = Interval {
            lo: 0.0,
            hi: f64::INFINITY,
        };
        if corners.iter().all(|c| c.is_finite()) && base.lo > 0.0 {
            // Monotonic in each argument: the extremes are at corners.
            interval = Interval {
                lo: corners.iter().copied().fold(f64::INFINITY, f64::min),
                hi: corners.iter().copied().fold(0.0, f64::max),
            }
            .loosened()
            .meet(0.0, f64::INFINITY);
        }
        Self {
            interval,
            nonzero: self.nonzero,
        }
    }

    fn function(self, function: Function) -> Self {
        let x = self.interval;
        let always = |interval: Interval| Self {
            interval,
            nonzero: true,
        };
        let as_argument = |interval: Interval| Self {
            interval,
            nonzero: self.nonzero,
        };
        match function {
            Function::Sin => self.circular(HALF_PI_UP),
            Function::Cos => self.circular(0.0),
            Function::Asin => as_argument(
                x.meet(-1.0, 1.0)
                    .map(f64::asin)
                    .signed_as(x)
                    .meet(-HALF_PI_UP, HALF_PI_UP),
            ),
            Function::Acos => {
                let Interval { lo, hi } = x.meet(-1.0, 1.0);
                Self::of(
                    Interval {
                        lo: hi.acos(),
                        hi: lo.acos(),
                    }
                    .loosened()
                    .meet(0.0, PI_UP),
                )
            }
            Function::Atan => {
                as_argument(x.map(f64::atan).signed_as(x).meet(-HALF_PI_UP, HALF_PI_UP))
            }
            Function::Sinh => as_argument(x.map(f64::sinh).signed_as(x)),
            Function::Tanh => as_argument(x.map(f64::tanh).signed_as(x).meet(-1.0, 1.0)),
            Function::Cosh => {
                let Interval { lo, hi } = self.magnitude();
                always(
                    Interval {
                        lo: lo.cosh(),
                        hi: hi.cosh(),
                    }
                    .loosened()
                    .meet(1.0, f64::INFINITY),
                )
            }
            Function::Exp => always(x.map(f64::exp).meet(0.0, f64::INFINITY)),
            Function::Ln => Self::of(x.meet(0.0, f64::INFINITY).map(f64::ln)),
            Function::Sqrt => as_argument(
                x.meet(0.0, f64::INFINITY)
                    .map(f64::sqrt)
                    .meet(0.0, f64::INFINITY),
            ),
            Function::Abs => as_argument(self.magnitude()),
            Function::Sign => {
                let lo = if x.lo > 0.0 || (x.lo >= 0.0 && self.nonzero) {
                    1.0
                } else if x.lo >= 0.0 {
                    0.0
                } else {
                    -1.0
                };
                let hi = if x.hi < 0.0 || (x.hi <= 0.0 && self.nonzero) {
                    -1.0
                } else if x.hi <= 0.0 {
                    0.0
                } else {
                    1.0
                };
                as_argument(Interval { lo, hi })
            }
        }
    }

    /// Range of the absolute value.
    fn magnitude(self) -> Interval {
        let Interval { lo, hi } = self.interval;
        if lo >= 0.0 {
            self.interval
        } else if hi <= 0.0 {
            self.negated().interval
        } else {
            Interval {
                lo: 0.0,
                hi: hi.max(-lo),
            }
        }
    }

    /// Range of `cos(x - peak)`.
    fn circular(self, peak: f64) -> Self {
        use std::f64::consts::PI;
        /// Angles beyond this are not reduced: their sine can be anything.
        const FAR: f64 = 1e6;
        /// Generous against the rounding of the reduction below [`FAR`].
        const SLACK: f64 = 1e-8;
        let Interval { lo, hi } = self.interval;
        if !(lo >= -FAR && hi <= FAR) {
            return Self::of(Interval { lo: -1.0, hi: 1.0 });
        }
        let (start, end) = ((lo - peak) / (2.0 * PI), (hi - peak) / (2.0 * PI));
        let passes =
            |offset: f64| (end - offset + SLACK).floor() >= (start - offset - SLACK).ceil();
        let ends = [(lo - peak).cos(), (hi - peak).cos()];
        let top = if passes(0.0) {
            1.0
        } else {
            ends[0].max(ends[1]) + SLACK * SLACK
        };
        let bottom = if passes(0.5) {
            -1.0
        } else {
            ends[0].min(ends[1]) - SLACK * SLACK
        };
        // The shift by the peak is exact to a few units in the last place of the angle.
        let blur = (lo.abs().max(hi.abs()) + 4.0) * f64::EPSILON;
        Self::of(
            Interval {
                lo: bottom - blur,
                hi: top + blur,
            }
            .meet(-1.0, 1.0),
        )
    }
}

impl Interval {
    /// Odd increasing functions keep the sign of their argument.
    fn signed_as(self, argument: Self) -> Self {
        let lo = if argument.lo >= 0.0 {
            self.lo.max(0.0)
        } else {
            self.lo
        };
        let hi = if argument.hi <= 0.0 {
            self.hi.min(0.0)
        } else {
            self.hi
        };
        Self { lo, hi }
    }
}
