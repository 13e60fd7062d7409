//! Which lines of the spec the equations of a page depend on.
//!
//! A section states the subject of an equation; letters refer to quantities, and to the equations that define
//! them.

use std::collections::BTreeSet;
use std::iter::successors;

use appell_codegen::mechanics::motion::Block;
use appell_codegen::mechanics::row::Row;
use appell_codegen::mechanics::{Derivation, contributions};
use appell_codegen::symbolic::print::{Letter, Math};
use appell_codegen::symbolic::{Expr, Graph};
use appell_spec::mechanism::Mechanism;
use rustc_hash::{FxHashMap, FxHashSet};

use super::{About, Block as PageBlock, Equation, Page};

/// Assigns to every equation the lines of the spec that it depends on; `page` is that of the derivation.
pub fn locate(page: &mut Page, mechanism: &Mechanism, derivation: &mut Derivation) {
    let sources = Sources {
        loads: contributions::of_loads(derivation),
        bodies: contributions::of_bodies(derivation),
        letters: letters(mechanism),
        mechanism,
        derivation,
    };
    let own: Vec<Own> = page.equations().map(|e| sources.of(e)).collect();
    let closed = closed(&own).into_iter();
    let blocks = (page.sections.iter_mut()).flat_map(|section| &mut section.blocks);
    let equations = blocks.filter_map(|block| match block {
        PageBlock::Equations(equations) => Some(equations),
        _ => None,
    });
    for (equation, lines) in equations.flatten().zip(closed) {
        equation.lines = lines.into_iter().collect();
    }
}

/// Letters of quantities with the lines of their definitions.
fn letters(mechanism: &Mechanism) -> FxHashMap<Letter, usize> {
    let parameters = mechanism.parameters.iter().map(|p| &p.label);
    let inputs = mechanism.inputs.iter().map(|u| &u.label);
    let moving = (mechanism.coordinates.iter().map(|q| &q.label))
        .chain(mechanism.pseudo_velocities.iter().map(|w| &w.label))
        .chain(mechanism.signals.iter().map(|s| &s.label));
    let all = parameters.chain(inputs).map(|label| (label, 0));
    let mut letters = FxHashMap::default();
    for (label, dots) in all.chain(moving.map(|label| (label, 2))) {
        let mut letter = Letter::of(&label.name);
        for _ in 0..dots {
            letters.insert(letter.clone(), label.line);
            letter = letter.dot();
        }
        letters.insert(letter, label.line);
    }
    letters
}

/// The dependencies of one equation by itself.
struct Own {
    defines: Option<Letter>,
    letters: FxHashSet<Letter>,
    lines: BTreeSet<usize>,
}

struct Sources<'a> {
    mechanism: &'a Mechanism,
    derivation: &'a Derivation,
    /// By load and pseudo-velocity.
    loads: Vec<Vec<bool>>,
    /// By body and pseudo-velocity.
    bodies: Vec<Vec<bool>>,
    letters: FxHashMap<Letter, usize>,
}

impl Sources<'_> {
    fn of(&self, equation: &Equation) -> Own {
        let mut letters = FxHashSet::default();
        for side in [&equation.left, &equation.right] {
            side.clone().for_each_letter(&mut |letter| {
                letters.insert(letter.clone());
            });
        }
        let mut lines = BTreeSet::new();
        if let Some(about) = equation.about {
            self.subject(about, &mut lines);
        }
        // In any order: the lines are sorted.
        #[expect(clippy::iter_over_hash_type, reason = "the lines are sorted")]
        for letter in &letters {
            lines.extend(self.letters.get(letter));
        }
        // The ground and predefined names have no line.
        lines.remove(&0);
        let defines = match &equation.left {
            Math::Letter(letter) => Some(letter.clone()),
            _ => None,
        };
        Own {
            defines,
            letters,
            lines,
        }
    }

    fn subject(&self, about: About, lines: &mut BTreeSet<usize>) {
        let mechanism = self.mechanism;
        match about {
            About::Body(body) => {
                let body = &mechanism.bodies[body];
                lines.insert(body.line);
                self.subject(About::Point(body.centre), lines);
                if let Some(frame) = body.frame {
                    self.subject(About::Frame(frame), lines);
                }
            }
            // A point with its chain of reference points, a frame with its chain of parent frames.
            About::Point(point) => {
                for point in successors(Some(point), |&point| mechanism.points[point].from) {
                    let point = &mechanism.points[point];
                    lines.insert(point.line);
                    self.subject(About::Frame(point.frame), lines);
                }
            }
            About::Frame(frame) => {
                let frames = successors(Some(frame), |&frame| mechanism.frames[frame].parent);
                lines.extend(frames.map(|frame| mechanism.frames[frame].line));
            }
            About::Constraint(constraint) => {
                lines.insert(mechanism.constraints[constraint].line);
            }
            About::Rate(coordinate) => {
                lines.insert(mechanism.coordinates[coordinate].label.line);
                let rows = self.derivation.constraints.rows.iter();
                let restricts = |row: &&Row| row.coefficients[coordinate.index()] != Graph::ZERO;
                for row in rows.filter(|row| row.is_active()).filter(restricts) {
                    self.subject(About::Constraint(row.constraint), lines);
                }
            }
            About::Load(load) => {
                let load = &mechanism.loads[load];
                lines.insert(load.line);
                for point in load.kind.points() {
                    self.subject(About::Point(point), lines);
                }
            }
            About::Inertia(i, j) => {
                let bodies = mechanism.bodies.ids().zip(&self.bodies);
                for (body, _) in bodies.filter(|(_, moves)| moves[i] && moves[j]) {
                    self.subject(About::Body(body), lines);
                }
                let gibbs = &self.derivation.gibbs;
                let parts = [gibbs.mass_matrix[i][j], gibbs.bias[i], gibbs.bias[j]];
                self.symbols_in(&parts, lines);
            }
            About::Force(i) => {
                let loads = mechanism.loads.ids().zip(&self.loads);
                for (load, _) in loads.filter(|(_, enters)| enters[i]) {
                    self.subject(About::Load(load), lines);
                }
                self.symbols_in(&[self.derivation.forces[i]], lines);
            }
            About::Motion(i) => {
                for j in self.solved_with(i) {
                    self.subject(About::Inertia(j, j), lines);
                    self.subject(About::Force(j), lines);
                }
            }
            About::Bodies => {
                for body in mechanism.bodies.ids() {
                    self.subject(About::Body(body), lines);
                }
            }
            About::Loads => {
                for load in mechanism.loads.ids() {
                    self.subject(About::Load(load), lines);
                }
            }
        }
    }

    /// The pseudo-velocities whose accelerations are solved together with one.
    fn solved_with(&self, speed: usize) -> Vec<usize> {
        let blocks = self.derivation.motion.blocks.iter();
        let mut speeds = blocks.map(|block| match block {
            Block::Eliminated(equations) => equations.iter().map(|e| e.speed).collect(),
            Block::Factorized(block) => block.speeds.clone(),
        });
        speeds
            .find(|speeds: &Vec<usize>| speeds.contains(&speed))
            .unwrap_or_default()
    }

    /// The quantities whose symbols occur in expressions.
    fn symbols_in(&self, all: &[Expr], lines: &mut BTreeSet<usize>) {
        let graph = &self.derivation.algebra.graph;
        let symbols = &self.derivation.symbols;
        let mechanism = self.mechanism;
        let quantities = (mechanism.parameters.iter().map(|p| p.label.line))
            .zip(&symbols.parameters)
            .chain((mechanism.coordinates.iter().map(|q| q.label.line)).zip(&symbols.coordinates))
            .chain((mechanism.pseudo_velocities.iter().map(|w| w.label.line)).zip(&symbols.speeds))
            .chain((mechanism.inputs.iter().map(|u| u.label.line)).zip(&symbols.inputs));
        let occurs = |&symbol: &Expr| {
            let id = graph.as_symbol(symbol);
            id.is_some_and(|id| all.iter().any(|&expr| graph.mentions(expr, &[id])))
        };
        let occurring = quantities.filter(|(_, symbol)| occurs(symbol));
        lines.extend(occurring.map(|(line, _)| line));
    }
}

/// The lines of each equation, with those of the equations that define its letters.
fn closed(own: &[Own]) -> Vec<BTreeSet<usize>> {
    let definitions: FxHashMap<&Letter, usize> = (own.iter().enumerate())
        .filter_map(|(at, equation)| Some((equation.defines.as_ref()?, at)))
        .collect();
    let all = |start: usize| {
        let mut seen = FxHashSet::from_iter([start]);
        let mut open = vec![start];
        let mut lines = BTreeSet::new();
        while let Some(at) = open.pop() {
            lines.extend(&own[at].lines);
            let letters = own[at].letters.iter();
            let defined = letters.filter_map(|letter| definitions.get(letter).copied());
            open.extend(defined.filter(|at| seen.insert(*at)));
        }
        lines
    };
    (0..own.len()).map(all).collect()
}
