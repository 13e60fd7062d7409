//! Appell's equations, their solution for the accelerations, and the energies that check them.

use appell_codegen::mechanics;
use appell_codegen::mechanics::gibbs_appell::kinetic_energy;
use appell_codegen::symbolic::{Expr, Graph, Node};

use super::super::{About, Block, Equation, Letter, Math, Section, Writer};
use super::energy::numbered;
use super::phrases::{formula, headed, listed, math, sentence, with, words};

/// Longer accelerations, on average in a block, are not written out.
const LONGEST_READING: usize = 180;

/// Whether the solved equations are short enough to be written out, so that the page does not refer
/// to M and b.
pub(super) fn are_written_out(w: &mut Writer<'_>) -> bool {
    let mut blocks = w.derivation.motion.blocks.clone().into_iter();
    blocks.all(|block| values_to_read(w, &block).is_some())
}

/// M ω̇ + b = Π, row by row.
pub(super) fn appell(w: &mut Writer<'_>) -> Section {
    let accelerations = w.derivation.symbols.accelerations.clone();
    let gibbs = w.derivation.gibbs.clone();
    let mut equations = Vec::new();
    for (i, bias) in gibbs.bias.iter().enumerate() {
        let mut parts = vec![*bias];
        for (&entry, &acceleration) in gibbs.mass_matrix[i].iter().zip(&accelerations) {
            parts.push(w.graph().mul(entry, acceleration));
        }
        let left = w.graph().sum(&parts);
        let left = w.expanded(left);
        let right = w.explicit(w.derivation.forces[i]);
        equations.push(Equation::new(left, right).about(About::Motion(i)));
    }
    let lead = "Prescribed rates replace the equations of their pseudo-velocities: drives supply the required \
                forces.";
    let is_free = w.derivation.given.is_empty();
    let blocks = with(w, if is_free { "" } else { lead }, equations);
    let general = math(formula("∂S/∂ω'_i = Π_i"));
    Section {
        heading: vec![words("Appell's equations "), general],
        blocks,
    }
}

/// ω̇, as the derivation solved for it.
pub(super) fn motion(w: &mut Writer<'_>) -> Section {
    let speeds = 0..w.derivation.symbols.speeds.len();
    let letters: Vec<Letter> = speeds.map(|k| w.speed(k).dot()).collect();
    for letter in &letters {
        w.define(letter.clone());
    }
    let acceleration = |k: usize| Math::Letter(letters[k].clone());
    let mut equations = Vec::new();
    let mut large = Vec::new();
    let mut lead = "Appell's equations, solved for the accelerations:";
    for block in w.derivation.motion.blocks.clone() {
        if let Some(values) = values_to_read(w, &block) {
            for (k, value) in values {
                let right = w.explicit(value);
                equations.push(Equation::new(acceleration(k), right).about(About::Motion(k)));
            }
            continue;
        }
        let elimination = Elimination::of(&block);
        let solved = elimination.in_letters(acceleration);
        if solved.is_empty() {
            large.push(elimination.order);
        } else if solved.len() > 1 {
            lead = "Appell's equations, solved for the accelerations with M = L D Lᵀ and L z = Π − b, \
                    in the order of elimination:";
        }
        equations.extend(solved);
    }
    let mut blocks = with(w, lead, equations);
    for order in large {
        let order = order.iter().map(|&k| vec![math(acceleration(k))]);
        let mut text = vec![words(
            "M is factorised numerically at each evaluation, in the order ",
        )];
        text.extend(listed(order.collect()));
        text.push(words("."));
        blocks.push(Block::Sentence(text));
    }
    blocks.push(sentence(
        "Together with the generalised velocities they are the equations of motion.",
    ));
    headed("Equations of motion", blocks)
}

/// Accelerations of a block in the order of their solution, if they are short enough to read.
/// Results of Cramer's rule are always shown, as nothing was eliminated.
fn values_to_read(
    w: &mut Writer<'_>,
    block: &mechanics::motion::Block,
) -> Option<Vec<(usize, Expr)>> {
    let mechanics::motion::Block::Eliminated(equations) = block else {
        return None;
    };
    let by_cramer = equations.len() > 1 && equations.iter().all(|e| e.couplings.is_empty());
    let mut values = Vec::with_capacity(equations.len());
    let mut length = 0;
    for equation in equations {
        let value = behind(w, w.derivation.motion.accelerations[equation.speed]);
        let pivot = behind(w, equation.pivot);
        length += w.try_explicit(value).width() + w.try_explicit(pivot).width();
        values.push((equation.speed, value));
    }
    (by_cramer || length <= LONGEST_READING * values.len()).then_some(values)
}

/// The definition of a name.
fn behind(w: &mut Writer<'_>, expr: Expr) -> Expr {
    match *w.graph().node(expr) {
        Node::Named(id) => w.graph().definition(id).value,
        _ => expr,
    }
}

/// T, V and the power of the other loads.
pub(super) fn energies(w: &mut Writer<'_>) -> Section {
    let mut equations = Vec::new();
    let mut state = |w: &mut Writer<'_>, letter: &str, parts: &[Expr], about| {
        let sum = w.graph().sum(parts);
        let left = Math::Letter(Letter::plain(letter));
        equations.push(Equation::new(left, w.explicit(sum)).about(about));
    };
    let bodies = w.derivation.bodies.clone();
    let kinetic: Vec<Expr> = (bodies.iter())
        .map(|body| kinetic_energy(&mut w.derivation.algebra, body))
        .collect();
    state(w, "T", &kinetic, About::Bodies);
    let loads = w.derivation.loads.clone();
    let potential: Vec<Expr> = loads.iter().filter_map(|load| load.potential).collect();
    state(w, "V", &potential, About::Loads);
    let mut power: Vec<Expr> = (loads.iter())
        .map(|load| load.power_without_potential(w.graph()))
        .collect();
    let accelerations = w.derivation.symbols.accelerations.clone();
    let prescribed = w.derivation.prescribed_power(&accelerations);
    let prescribed = prescribed.unwrap_or(Graph::ZERO);
    power.push(prescribed);
    state(w, "P", &power, About::Loads);
    let drives = if prescribed == Graph::ZERO {
        ""
    } else {
        " and of what keeps up the prescribed motion"
    };
    let mut text = vec![words(&format!(
        "Kinetic energy T, potential energy V, power P of the non-conservative loads{drives}."
    ))];
    if w.derivation.symbols.signals.is_empty() {
        let rate = math(formula("T' + V' = P"));
        text.extend([words(" Every solution satisfies "), rate, words(".")]);
    }
    let mut blocks = vec![Block::Sentence(text)];
    blocks.extend(with(w, "", equations));
    headed("Energies", blocks)
}

/// The elimination of larger blocks is not written entry by entry.
const LARGEST_BLOCK: usize = 5;

/// The elimination: speeds in order, and the non-zero entries of L.
pub(super) struct Elimination {
    /// Speeds in the order of elimination.
    pub(super) order: Vec<usize>,
    /// Columns of L with an entry, for each row.
    couplings: Vec<Vec<usize>>,
}

impl Elimination {
    pub(super) fn of(block: &mechanics::motion::Block) -> Self {
        match block {
            mechanics::motion::Block::Eliminated(equations) => {
                // The last equation was eliminated first.
                let columns = || equations.iter().rev();
                let order: Vec<usize> = columns().map(|e| e.speed).collect();
                let row = |(place, speed): (usize, &usize)| {
                    let couples = |column: usize| {
                        let equation = columns().nth(column);
                        equation.is_some_and(|e| e.couplings.iter().any(|c| c.0 == *speed))
                    };
                    (0..place).filter(|&column| couples(column)).collect()
                };
                let couplings = order.iter().enumerate().map(row).collect();
                Self { order, couplings }
            }
            mechanics::motion::Block::Factorized(block) => {
                let order = block.speeds.clone();
                let row = |row| (0..row).filter(|&c| block.couples(row, c)).collect();
                let couplings = (0..order.len()).map(row).collect();
                Self { order, couplings }
            }
        }
    }

    /// `M = L D Lᵀ`, entry by entry, and the accelerations; `None` for large blocks.
    pub(super) fn in_letters(&self, acceleration: impl Fn(usize) -> Math) -> Vec<Equation> {
        match *self.order {
            [k] => {
                let value = Math::fraction(force_less_bias(k), entry("M", k, k));
                vec![Equation::new(acceleration(k), value).about(About::Motion(k))]
            }
            _ if self.order.len() > LARGEST_BLOCK => Vec::new(),
            _ => {
                let mut equations = Vec::new();
                for row in 0..self.order.len() {
                    self.factorize(row, &mut equations);
                }
                for column in (0..self.order.len()).rev() {
                    equations.push(self.substituted_back(column, &acceleration));
                }
                equations
            }
        }
    }

    /// A row of L, its pivot, and the reduced right-hand side.
    fn factorize(&self, row: usize, equations: &mut Vec<Equation>) {
        let k = self.order[row];
        let (mut pivot, mut reduced) = (
            vec![(false, entry("M", k, k))],
            vec![(false, force_less_bias(k))],
        );
        for &column in &self.couplings[row] {
            let p = self.order[column];
            let shared = |q: &&usize| **q < column && self.couplings[column].contains(q);
            let mut terms = vec![(false, entry("M", k, p))];
            for &q in self.couplings[row].iter().filter(shared) {
                let q = self.order[q];
                let change = vec![entry("L", k, q), entry("L", p, q), numbered("D", q)];
                terms.push((true, Math::product(change)));
            }
            let coupling = entry("L", k, p);
            let value = Math::fraction(Math::sum(terms), numbered("D", p));
            equations.push(Equation::new(coupling.clone(), value).about(About::Inertia(k, p)));
            let change = Math::product(vec![raised(coupling.clone(), 2), numbered("D", p)]);
            pivot.push((true, change));
            reduced.push((true, Math::product(vec![coupling, numbered("z", p)])));
        }
        let pivot = Equation::new(numbered("D", k), Math::sum(pivot));
        equations.push(pivot.about(About::Inertia(k, k)));
        let reduced = Equation::new(numbered("z", k), Math::sum(reduced));
        equations.push(reduced.about(About::Motion(k)));
    }

    /// The acceleration of a column, from those of later rows.
    fn substituted_back(&self, column: usize, acceleration: impl Fn(usize) -> Math) -> Equation {
        let k = self.order[column];
        let uncoupled = Math::fraction(numbered("z", k), numbered("D", k));
        let mut terms = vec![(false, uncoupled)];
        for row in (column + 1..self.order.len()).filter(|&r| self.couplings[r].contains(&column)) {
            let known = self.order[row];
            let term = vec![entry("L", known, k), acceleration(known)];
            terms.push((true, Math::product(term)));
        }
        Equation::new(acceleration(k), Math::sum(terms)).about(About::Motion(k))
    }
}

/// `M₁₂`, with the smaller index first in a symmetric matrix.
fn entry(name: &str, i: usize, j: usize) -> Math {
    let (i, j) = if name == "M" {
        (i.min(j) + 1, i.max(j) + 1)
    } else {
        (i + 1, j + 1)
    };
    let comma = if i.max(j) > 9 { "," } else { "" };
    Math::Letter(Letter::plain(name).below(&format!("{i}{comma}{j}")))
}

/// `Π - b`
fn force_less_bias(k: usize) -> Math {
    Math::Sum(vec![(false, numbered("Π", k)), (true, numbered("b", k))])
}

pub(super) fn raised(base: Math, exponent: usize) -> Math {
    Math::Power(Box::new(base), Box::new(Math::integer(exponent)))
}
