//! Appell's equations, the accelerations that solve them, and the energies that check them.

use super::super::letters::Letter;
use super::super::math::{Equation, Math};
use super::super::writer::Writer;
use super::super::{Block, Section};
use super::solution::{System, force_less_bias};
use super::{constraints, math, sentence, with, words};
use crate::mechanics::gibbs_appell::kinetic_energy;
use crate::mechanics::motion::independent_blocks;
use crate::symbolic::{Expr, Graph, Node};

/// A longer acceleration is not written out.
const LONGEST_READING: usize = 240;
/// Nor one with a longer denominator.
const LONGEST_PIVOT: usize = 100;

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
    Section { heading: vec![words("Appell's equations "), math(one)], blocks }
}

/// ω̇ and q̇.
pub(super) fn motion(w: &mut Writer<'_>) -> Section {
    let matrix = w.derivation.gibbs.mass_matrix.clone();
    let mut open: Vec<(usize, Expr, Expr)> = Vec::new();
    let mut equations = Vec::new();
    let mut left_out = false;
    for block in independent_blocks(&matrix) {
        let accelerations: Vec<_> = block.iter().map(|&k| unnamed(w, k)).collect();
        if is_readable(w, &accelerations) {
            open.extend(accelerations);
        } else {
            let letters: Vec<Math> = (0..matrix.len()).map(|k| Math::Letter(w.speed(k).dot())).collect();
            let unknown = |k: usize| letters[k].clone();
            let system = System { matrix: &matrix, unknown: &unknown, right: &force_less_bias };
            let in_letters = system.solved(&block);
            left_out |= in_letters.is_empty();
            equations.extend(in_letters);
        }
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
    let mut blocks = with(w, "Appell's equations, solved for the accelerations:", equations);
    if left_out {
        blocks.push(sentence("Larger blocks are factorised when the equations are evaluated."));
    }
    let rates = constraints::rates(w);
    blocks.extend(with(w, "The coordinates follow the pseudo-velocities:", rates));
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

/// Whether the accelerations of a block, and the pivots they are divided by, are short when they are
/// written out.
fn is_readable(w: &mut Writer<'_>, accelerations: &[(usize, Expr, Expr)]) -> bool {
    let own: Vec<Expr> = accelerations.iter().map(|a| a.1).collect();
    accelerations.iter().all(|&(_, _, value)| {
        let parts = w.graph().in_order(&[value]);
        let named = |graph: &Graph, e: Expr| match *graph.node(e) {
            Node::Named(id) if !own.contains(&e) => Some(graph.definition(id).value),
            _ => None,
        };
        let pivots: Vec<Expr> = parts.iter().filter_map(|&e| named(w.graph(), e)).collect();
        w.try_explicit(value).width() <= LONGEST_READING
            && pivots.into_iter().all(|pivot| w.try_explicit(pivot).width() <= LONGEST_PIVOT)
    })
}

/// Accelerations that others are expressed by come first.
fn reading_order(w: &mut Writer<'_>, open: &[(usize, Expr, Expr)]) -> Vec<usize> {
    let mut order: Vec<usize> = Vec::with_capacity(open.len());
    let used: Vec<Vec<usize>> = open
        .iter()
        .map(|&(k, own, value)| {
            let parts = w.graph().in_order(&[value]);
            open.iter().filter(|o| o.0 != k && o.1 != own && parts.contains(&o.1)).map(|o| o.0).collect()
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
    let mut equations = vec![Equation::new(Math::Letter(Letter::plain("T")), w.explicit(kinetic))];
    let loads = w.derivation.loads.clone();
    let potential: Vec<Expr> = loads.iter().filter_map(|load| load.potential).collect();
    let potential = w.graph().sum(&potential);
    equations.push(Equation::new(Math::Letter(Letter::plain("V")), w.explicit(potential)));
    let power: Vec<Expr> =
        loads.iter().filter(|load| load.potential.is_none()).map(|load| load.power(w.graph())).collect();
    let power = w.graph().sum(&power);
    equations.push(Equation::new(Math::Letter(Letter::plain("P")), w.explicit(power)));
    let mut text = vec![words("Kinetic energy T, potential energy V, power P of the loads without potential.")];
    let steady = w.derivation.symbols.signals.is_empty();
    if steady {
        let rate = Math::Row(vec![
            Math::Letter(Letter::plain("T").dot()),
            Math::Sign("+"),
            Math::Letter(Letter::plain("V").dot()),
            Math::Sign("="),
            Math::Letter(Letter::plain("P")),
        ]);
        text.extend([words(" A check of every solution: "), math(rate), words(".")]);
    }
    let mut blocks = vec![Block::Sentence(text)];
    blocks.extend(with(w, "", equations));
    super::section("Energies", blocks)
}
