//! Canonical construction: every function here returns the unique node of a normal form.

use super::node::{Expr, Factor, Function, Node, Relation, Term};
use super::{Graph, Rational};

impl Graph {
    /// An exact number.
    pub fn number(&mut self, value: Rational) -> Expr {
        self.intern(Node::Number(value))
    }

    /// An integer.
    pub fn integer(&mut self, value: i64) -> Expr {
        self.number(value.into())
    }

    /// `numerator / denominator`.
    pub fn fraction(&mut self, numerator: i64, denominator: i64) -> Expr {
        self.number(Rational::new(numerator, denominator))
    }

    /// `a + b`
    pub fn add(&mut self, a: Expr, b: Expr) -> Expr {
        if a == Self::ZERO {
            return b;
        }
        if b == Self::ZERO {
            return a;
        }
        self.sum(&[a, b])
    }

    /// `a - b`
    pub fn sub(&mut self, a: Expr, b: Expr) -> Expr {
        let minus_b = self.neg(b);
        self.add(a, minus_b)
    }

    /// `-a`
    pub fn neg(&mut self, a: Expr) -> Expr {
        self.scale(&Rational::MINUS_ONE, a)
    }

    /// `factor · a`
    pub fn scale(&mut self, factor: &Rational, a: Expr) -> Expr {
        if factor.is_one() {
            return a;
        }
        let mut terms = Terms::default();
        terms.add(self, factor, a);
        terms.into_expr(self)
    }

    /// Sum of any number of expressions.
    pub fn sum(&mut self, parts: &[Expr]) -> Expr {
        let mut terms = Terms::default();
        for &part in parts {
            terms.add(self, &Rational::ONE, part);
        }
        terms.into_expr(self)
    }

    /// `Σ coefficient · expr`
    pub fn linear_combination(&mut self, parts: &[(Rational, Expr)]) -> Expr {
        let mut terms = Terms::default();
        for (coefficient, expr) in parts {
            terms.add(self, coefficient, *expr);
        }
        terms.into_expr(self)
    }

    /// `a · b`
    pub fn mul(&mut self, a: Expr, b: Expr) -> Expr {
        if a == Self::ONE {
            return b;
        }
        if b == Self::ONE {
            return a;
        }
        self.product(&[a, b])
    }

    /// `a / b`; `b` must not be the number 0.
    pub fn div(&mut self, a: Expr, b: Expr) -> Expr {
        let reciprocal = self.pow(b, -1);
        self.mul(a, reciprocal)
    }

    /// Product of any number of expressions.
    pub fn product(&mut self, parts: &[Expr]) -> Expr {
        let mut factors = Factors::new();
        for &part in parts {
            factors.multiply(self, part, 1);
        }
        factors.into_expr(self)
    }

    /// `base^exponent`; the number 0 must not have a negative exponent.
    pub fn pow(&mut self, base: Expr, exponent: i32) -> Expr {
        if exponent == i32::MIN {
            // `i32::MIN` cannot be negated.
            let almost = self.pow(base, exponent + 1);
            return self.div(almost, base);
        }
        let mut factors = Factors::new();
        factors.multiply(self, base, exponent);
        factors.into_expr(self)
    }

    /// `a²`
    pub fn square(&mut self, a: Expr) -> Expr {
        self.pow(a, 2)
    }

    /// Sine.
    pub fn sin(&mut self, a: Expr) -> Expr {
        self.function(Function::Sin, a)
    }

    /// Cosine.
    pub fn cos(&mut self, a: Expr) -> Expr {
        self.function(Function::Cos, a)
    }

    /// Tangent, as the quotient of sine and cosine, which share one evaluation.
    pub fn tan(&mut self, a: Expr) -> Expr {
        let (sin, cos) = (self.sin(a), self.cos(a));
        self.div(sin, cos)
    }

    /// Square root.
    pub fn sqrt(&mut self, a: Expr) -> Expr {
        self.function(Function::Sqrt, a)
    }

    /// A function of one argument. The sign is moved out of odd functions and dropped in even ones.
    pub fn function(&mut self, function: Function, argument: Expr) -> Expr {
        use Function::{Abs, Asin, Atan, Cos, Cosh, Exp, Ln, Sign, Sin, Sinh, Sqrt, Tanh};
        let odd = matches!(function, Sin | Asin | Atan | Sinh | Tanh | Sign);
        let even = matches!(function, Cos | Cosh | Abs);
        if (odd || even) && self.leads_with_minus(argument) {
            let positive = self.neg(argument);
            let value = self.function(function, positive);
            return if odd { self.neg(value) } else { value };
        }
        if matches!(function, Sin | Cos)
            && let Some([cos, sin]) = self.cos_sin_of_inverse(argument)
        {
            return if function == Cos { cos } else { sin };
        }
        if let Some(number) = self.as_number(argument) {
            let exact = match function {
                _ if number.is_zero() && odd => Some(Rational::ZERO),
                Cos | Cosh | Exp if number.is_zero() => Some(Rational::ONE),
                Ln if number.is_one() => Some(Rational::ZERO),
                Abs => Some(number.abs()),
                Sign => Some(Rational::ONE),
                Sqrt => exact_square_root(number),
                _ => None,
            };
            if let Some(exact) = exact {
                return self.number(exact);
            }
        }
        self.intern(Node::Function(function, argument))
    }

    /// `atan2(y, x)`
    pub fn atan2(&mut self, y: Expr, x: Expr) -> Expr {
        self.intern(Node::Atan2(y, x))
    }

    /// `base^exponent` for an exponent that is not an integer number.
    pub fn power(&mut self, base: Expr, exponent: Expr) -> Expr {
        if let Some(number) = self.as_number(exponent) {
            if let Some(n) = number
                .as_integer()
                .and_then(|n| fitting(i32::try_from(n).ok()))
            {
                return self.pow(base, n);
            }
            if *number == Rational::new(1, 2) {
                return self.sqrt(base);
            }
        }
        self.intern(Node::Power(base, exponent))
    }

    /// `then` where `left relation right`, else `otherwise`.
    pub fn choice(&mut self, relation: Relation, compared: [Expr; 2], branches: [Expr; 2]) -> Expr {
        if branches[0] == branches[1] {
            return branches[0];
        }
        if let (Some(left), Some(right)) =
            (self.as_number(compared[0]), self.as_number(compared[1]))
        {
            let holds = match relation {
                Relation::Less => left < right,
                Relation::LessOrEqual => left <= right,
            };
            return branches[usize::from(!holds)];
        }
        self.intern(Node::Choice {
            relation,
            compared,
            branches,
        })
    }

    /// Whether the first coefficient of the canonical form is negative.
    pub fn leads_with_minus(&self, expr: Expr) -> bool {
        match self.node(expr) {
            Node::Number(n) => n.is_negative(),
            Node::Sum(terms) => terms[0].coefficient.is_negative(),
            _ => false,
        }
    }

    /// `expr = coefficient · rest`, where `rest` has no numeric factor and a positive leading coefficient.
    /// The content of a sum goes into the coefficient.
    pub fn split_coefficient(&mut self, expr: Expr) -> (Rational, Expr) {
        match self.node(expr) {
            Node::Number(n) => (n.clone(), Self::ONE),
            Node::Sum(terms) if terms.len() == 1 => (terms[0].coefficient.clone(), terms[0].expr),
            Node::Sum(terms) => {
                let mut content = Rational::content(terms.iter().map(|t| &t.coefficient));
                if terms[0].coefficient.is_negative() {
                    content = -&content;
                }
                if content.is_one() {
                    (content, expr)
                } else {
                    (content.clone(), self.scale(&content.recip(), expr))
                }
            }
            _ => (Rational::ONE, expr),
        }
    }
}

/// The root of a perfect square.
fn exact_square_root(number: &Rational) -> Option<Rational> {
    let (n, d) = number.as_small().filter(|&(n, _)| n >= 0)?;
    let root = |k: i64| Some(k.isqrt()).filter(|r| r * r == k);
    Some(Rational::new(root(n)?, root(d)?))
}

/// A sum under construction: sorting combines like terms.
#[derive(Default)]
struct Terms {
    terms: Vec<Term>,
}

impl Terms {
    fn add(&mut self, graph: &Graph, factor: &Rational, expr: Expr) {
        match graph.node(expr) {
            Node::Number(n) => self.collect(Graph::ONE, &(factor * n)),
            Node::Sum(terms) => {
                for term in terms {
                    self.collect(term.expr, &(factor * &term.coefficient));
                }
            }
            _ => self.collect(expr, factor),
        }
    }

    fn collect(&mut self, expr: Expr, coefficient: &Rational) {
        self.terms.push(Term {
            expr,
            coefficient: coefficient.clone(),
        });
    }

    fn sorted(mut self) -> Vec<Term> {
        self.terms.sort_unstable_by_key(|t| t.expr);
        self.terms.dedup_by(|next, first| {
            let like = next.expr == first.expr;
            if like {
                first.coefficient = &first.coefficient + &next.coefficient;
            }
            like
        });
        self.terms.retain(|t| !t.coefficient.is_zero());
        self.terms
    }

    fn into_expr(self, graph: &mut Graph) -> Expr {
        let mut terms = self.sorted();
        while let Some(shorter) = pythagoras(graph, &terms) {
            terms = shorter;
        }
        match terms.as_slice() {
            [] => Graph::ZERO,
            [Term { expr, coefficient }] if *expr == Graph::ONE => {
                graph.number(coefficient.clone())
            }
            [Term { expr, coefficient }] if coefficient.is_one() => *expr,
            _ => graph.intern(Node::Sum(terms.into())),
        }
    }
}

/// One application of `sin² + cos² = 1` that shortens a sum: `k s²X + k c²X = kX`, or `kX - k s²X = k c²X`,
/// and the same with sine and cosine exchanged.
fn pythagoras(graph: &mut Graph, terms: &[Term]) -> Option<Vec<Term>> {
    for (i, term) in terms.iter().enumerate() {
        let Node::Product(factors) = graph.node(term.expr) else {
            continue;
        };
        let squares: Vec<(Expr, Function, Expr)> = factors
            .iter()
            .filter(|f| f.exponent >= 2)
            .filter_map(|f| match graph.node(f.base) {
                Node::Function(kind @ (Function::Sin | Function::Cos), angle) => {
                    Some((f.base, *kind, *angle))
                }
                _ => None,
            })
            .collect();
        for (square, kind, angle) in squares {
            let cofunction = if kind == Function::Sin {
                Function::Cos
            } else {
                Function::Sin
            };
            let partner_base = graph.function(cofunction, angle);
            let rest = {
                let inverse_square = graph.pow(square, -2);
                graph.mul(term.expr, inverse_square)
            };
            let partner = {
                let partner_square = graph.square(partner_base);
                graph.mul(rest, partner_square)
            };
            let find = |expr: Expr| terms.binary_search_by_key(&expr, |t| t.expr).ok();
            let (other, replacement, coefficient) = if let Some(j) = find(partner)
                && terms[j].coefficient == term.coefficient
            {
                (j, rest, term.coefficient.clone())
            } else if let Some(j) = find(rest)
                && terms[j].coefficient == -&term.coefficient
            {
                (j, partner, -&term.coefficient)
            } else {
                continue;
            };
            let mut sum = Terms::default();
            for (k, t) in terms.iter().enumerate() {
                if k != i && k != other {
                    sum.add(graph, &t.coefficient, t.expr);
                }
            }
            sum.add(graph, &coefficient, replacement);
            return Some(sum.sorted());
        }
    }
    None
}

/// An exponent that can be negated.
fn fitting(exponent: Option<i32>) -> Option<i32> {
    exponent.filter(|&e| e != i32::MIN)
}

/// A product under construction: powers of the same base are combined.
struct Factors {
    coefficient: Rational,
    factors: Vec<Factor>,
}

impl Factors {
    fn new() -> Self {
        Self {
            coefficient: Rational::ONE,
            factors: Vec::new(),
        }
    }

    /// Multiplies by `expr^exponent`.
    fn multiply(&mut self, graph: &mut Graph, expr: Expr, exponent: i32) {
        let (coefficient, rest) = graph.split_coefficient(expr);
        if let Some(power) = coefficient.checked_pow(exponent) {
            self.coefficient = &self.coefficient * &power;
        } else {
            // A number too long to multiply out remains a separate factor.
            let number = graph.number(coefficient);
            self.factors.push(Factor {
                base: number,
                exponent,
            });
        }
        if rest == Graph::ONE || self.coefficient.is_zero() {
            return;
        }
        let raised = |f: &Factor| {
            let exponent = fitting(f.exponent.checked_mul(exponent))?;
            Some(Factor {
                base: f.base,
                exponent,
            })
        };
        let powers: Option<Vec<Factor>> = match graph.node(rest) {
            Node::Product(factors) => factors.iter().map(raised).collect(),
            _ => None,
        };
        match powers {
            Some(powers) => self.factors.extend(powers),
            // Not a product, or one whose powers are too high to expand: a separate factor.
            None => self.factors.push(Factor {
                base: rest,
                exponent,
            }),
        }
    }

    /// Combines powers of the same base unless the exponent overflows.
    fn merge(&mut self) {
        self.factors.sort_unstable_by_key(|f| f.base);
        self.factors.dedup_by(|next, first| {
            let sum = fitting(first.exponent.checked_add(next.exponent));
            let meet = sum.filter(|_| next.base == first.base);
            first.exponent = meet.unwrap_or(first.exponent);
            meet.is_some()
        });
        self.factors.retain(|f| f.exponent != 0);
    }

    fn into_expr(mut self, graph: &mut Graph) -> Expr {
        if self.coefficient.is_zero() {
            return Graph::ZERO;
        }
        self.merge();
        // √x to an even power is a power of x, which may combine with other powers of x or be a root itself.
        loop {
            let roots: Vec<(Expr, i32)> = self
                .factors
                .iter_mut()
                .filter(|f| f.exponent.abs() >= 2)
                .filter_map(|f| match graph.node(f.base) {
                    Node::Function(Function::Sqrt, x) => {
                        let whole = f.exponent / 2;
                        f.exponent %= 2;
                        Some((*x, whole))
                    }
                    _ => None,
                })
                .collect();
            if roots.is_empty() {
                break;
            }
            for (x, exponent) in roots {
                self.multiply(graph, x, exponent);
            }
            self.merge();
        }
        let factors = self.factors;
        let product = match factors.as_slice() {
            [] => Graph::ONE,
            [Factor { base, exponent: 1 }] => *base,
            _ => graph.intern(Node::Product(factors.into())),
        };
        graph.scale(&self.coefficient, product)
    }
}
