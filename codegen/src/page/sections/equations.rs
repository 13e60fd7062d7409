//! Appell's equations, the accelerations that solve them, and the energies that check them.

use super::super::display::Equation;
use super::super::writer::Writer;
use super::super::{Block, Section};
use super::super::{Letter, Math};
use super::solution::{System, force_less_bias};
use super::{constraints, math, sentence, with, words};
use crate::mechanics::gibbs_appell::kinetic_energy;
use crate::mechanics::motion::independent_blocks;
use crate::symbolic::{Expr, Graph, Node};

/// Longer accelerations, on average in a block, are not written out.
const LONGEST_READING: usize = 180;

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
        equations.push(Equation::new(left, right));
    }
    let one = Math::Row(vec![
        Math::partial(Letter::plain("S"), Letter::plain("ω").dot().below("i")),
        Math::Sign("="),
        Math::Letter(Letter::plain("Π").below("i")),
    ]);
    let blocks = with(w, "", equations);
    Section {
        heading: vec![words("Appell's equations "), math(one)],
        blocks,
    }
}

/// ω̇ and q̇.
pub(super) fn motion(w: &mut Writer<'_>) -> Section {
    let matrix = w.derivation.gibbs.mass_matrix.clone();
    let mut open: Vec<(usize, Expr, Expr)> = Vec::new();
    let mut equations = Vec::new();
    let mut left_out = false;
    for block in independent_blocks(&matrix) {
        let derived: Vec<_> = block.iter().map(|&k| unnamed(w, k)).collect();
        let shortest = match quotients(w, &block) {
            Some(quotients) if reading_length(w, &quotients) < reading_length(w, &derived) => {
                quotients
            }
            _ => derived,
        };
        if reading_length(w, &shortest) <= LONGEST_READING * block.len() {
            open.extend(shortest);
            continue;
        }
        let letters: Vec<Math> = (0..matrix.len())
            .map(|k| Math::Letter(w.speed(k).dot()))
            .collect();
        let unknown = |k: usize| letters[k].clone();
        let system = System {
            matrix: &matrix,
            unknown: &unknown,
            right: &force_less_bias,
        };
        let in_letters = system.solved(&block);
        left_out |= in_letters.is_empty();
        equations.extend(in_letters);
    }
    let order = reading_order(w, &open);
    for &place in &order {
        let letter = w.speed(open[place].0).dot();
        w.define(letter);
    }
    for place in order {
        let (k, _, value) = open[place];
        let left = Math::Letter(w.speed(k).dot());
        let right = w.explicit(value);
        equations.push(Equation::new(left, right));
    }
    // Those that are solved in letters are shown as well.
    for k in 0..matrix.len() {
        let letter = w.speed(k).dot();
        w.define(letter);
    }
    let mut blocks = with(
        w,
        "Appell's equations, solved for the accelerations:",
        equations,
    );
    if left_out {
        blocks.push(sentence(
            "Larger blocks are factorised when the equations are evaluated.",
        ));
    }
    let rates = constraints::rates(w);
    blocks.extend(with(
        w,
        "The coordinates follow the pseudo-velocities:",
        rates,
    ));
    super::section("Equations of motion", blocks)
}

/// A speed, its acceleration, and the value behind the name.
fn unnamed(w: &mut Writer<'_>, k: usize) -> (usize, Expr, Expr) {
    let acceleration = w.derivation.motion.accelerations[k];
    let value = match *w.graph().node(acceleration) {
        Node::Named(id) => w.graph().definition(id).value,
        _ => acceleration,
    };
    (k, acceleration, value)
}

/// Accelerations of two coupled speeds by Cramer's rule, written out; a common factor of numerator
/// and denominator cancels.
fn quotients(w: &mut Writer<'_>, block: &[usize]) -> Option<Vec<(usize, Expr, Expr)>> {
    let &[i, j] = block else { return None };
    let m = w.derivation.gibbs.mass_matrix.clone();
    let right = |w: &mut Writer<'_>, k: usize| {
        let less_bias = w.derivation.gibbs.bias[k];
        let force = w.derivation.forces[k];
        let value = w.graph().sub(force, less_bias);
        w.written_out(value)
    };
    let (r_i, r_j) = (right(w, i)?, right(w, j)?);
    let determinant = difference(w, [m[i][i], m[j][j]], [m[i][j], m[i][j]])?;
    let mut values = Vec::with_capacity(2);
    for (own, diagonal, right, other) in [(i, m[j][j], r_i, r_j), (j, m[i][i], r_j, r_i)] {
        let numerator = difference(w, [diagonal, right], [m[i][j], other])?;
        let value = w.graph().div(numerator, determinant);
        values.push((own, w.derivation.motion.accelerations[own], value));
    }
    Some(values)
}

/// `a b - c d`, multiplied out, with what its terms share before them.
fn difference(w: &mut Writer<'_>, [a, b]: [Expr; 2], [c, d]: [Expr; 2]) -> Option<Expr> {
    let graph = w.graph();
    let (first, second) = (graph.mul(a, b), graph.mul(c, d));
    let difference = graph.sub(first, second);
    let expanded = w.written_out(difference)?;
    Some(w.graph().take_out_common_factors(expanded)).filter(|&e| e != Graph::ZERO)
}

/// How much there is to read in the accelerations of a block and in what they are divided by.
fn reading_length(w: &mut Writer<'_>, accelerations: &[(usize, Expr, Expr)]) -> usize {
    let own: Vec<Expr> = accelerations.iter().map(|a| a.1).collect();
    let values: Vec<Expr> = accelerations.iter().map(|a| a.2).collect();
    let parts = w.graph().in_order(&values);
    let mut length = 0;
    for part in parts {
        if let Node::Named(id) = *w.graph().node(part)
            && !own.contains(&part)
            && w.is_kept(part)
        {
            let pivot = w.graph().definition(id).value;
            length += w.try_explicit(pivot).width();
        }
    }
    values.into_iter().fold(length, |length, value| {
        length + w.try_explicit(value).width()
    })
}

/// Accelerations that others are expressed by come first.
fn reading_order(w: &mut Writer<'_>, open: &[(usize, Expr, Expr)]) -> Vec<usize> {
    let mut order: Vec<usize> = Vec::with_capacity(open.len());
    let used: Vec<Vec<usize>> = open
        .iter()
        .map(|&(k, own, value)| {
            let parts = w.graph().in_order(&[value]);
            open.iter()
                .filter(|o| o.0 != k && o.1 != own && parts.contains(&o.1))
                .map(|o| o.0)
                .collect()
        })
        .collect();
    while order.len() < open.len() {
        let next = (0..open.len())
            .find(|k| !order.contains(k) && used[*k].iter().all(|u| order.contains(u)))
            .or_else(|| (0..open.len()).find(|k| !order.contains(k)));
        order.extend(next);
    }
    order
}

/// T, V and the power of the other loads.
pub(super) fn energies(w: &mut Writer<'_>) -> Section {
    let mut kinetic = Vec::new();
    for body in w.derivation.bodies.clone() {
        kinetic.push(kinetic_energy(&mut w.derivation.algebra, &body));
    }
    let kinetic = w.graph().sum(&kinetic);
    let mut equations = vec![Equation::new(
        Math::Letter(Letter::plain("T")),
        w.explicit(kinetic),
    )];
    let loads = w.derivation.loads.clone();
    let potential: Vec<Expr> = loads.iter().filter_map(|load| load.potential).collect();
    let potential = w.graph().sum(&potential);
    equations.push(Equation::new(
        Math::Letter(Letter::plain("V")),
        w.explicit(potential),
    ));
    let power: Vec<Expr> = loads
        .iter()
        .filter(|load| load.potential.is_none())
        .map(|load| load.power(w.graph()))
        .collect();
    let power = w.graph().sum(&power);
    equations.push(Equation::new(
        Math::Letter(Letter::plain("P")),
        w.explicit(power),
    ));
    let mut text = vec![words(
        "Kinetic energy T, potential energy V, power P of the loads without potential.",
    )];
    let steady = w.derivation.symbols.signals.is_empty();
    if steady {
        let rate = Math::Row(vec![
            Math::Letter(Letter::plain("T").dot()),
            Math::Sign("+"),
            Math::Letter(Letter::plain("V").dot()),
            Math::Sign("="),
            Math::Letter(Letter::plain("P")),
        ]);
        text.extend([
            words(" A check of every solution: "),
            math(rate),
            words("."),
        ]);
    }
    let mut blocks = vec![Block::Sentence(text)];
    blocks.extend(with(w, "", equations));
    super::section("Energies", blocks)
}
