//! Letters of symbols and of named intermediate quantities.

use appell_spec::mechanism::{CoordinateId, Mechanism};
use rustc_hash::{FxHashMap, FxHashSet};

use super::Letter;
use appell_codegen::mechanics::Derivation;
use appell_codegen::symbolic::print::{Spelled, Vocabulary};
use appell_codegen::symbolic::{Expr, Graph, Node};

/// Position of a symbol in a product: `m R r ω₁ sin θ`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    /// Parameters and the circle constant.
    Constant = 1,
    /// Coordinates, signals, time.
    Position,
    Input,
    /// Pseudo-velocities and generalised velocities.
    Velocity,
    /// Pseudo-accelerations, after named quantities.
    Acceleration = 6,
}

/// Letters of a derivation.
#[derive(Debug, Clone)]
pub(super) struct Lexicon {
    symbols: FxHashMap<Expr, (Letter, Rank)>,
    named: FxHashMap<String, Letter>,
    /// Names that are not expanded in explicit formulas: accelerations and pivots.
    kept: FxHashSet<String>,
}

/// Axes of a frame.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

impl Lexicon {
    /// The letters of all names of the derivation.
    pub(super) fn new(mechanism: &Mechanism, derivation: &Derivation) -> Self {
        let s = &derivation.symbols;
        let mut symbols = FxHashMap::default();
        let mut letter = |expr: Expr, letter: Letter, rank: Rank| {
            symbols.insert(expr, (letter, rank));
        };
        for (&expr, p) in s.parameters.iter().zip(&mechanism.parameters) {
            letter(expr, Letter::of(&p.label.name), Rank::Constant);
        }
        let coordinates = s.coordinates.iter().zip(&s.rates);
        for ((&expr, &rate), q) in coordinates.zip(&mechanism.coordinates) {
            letter(expr, Letter::of(&q.label.name), Rank::Position);
            letter(rate, Letter::of(&q.label.name).dot(), Rank::Velocity);
        }
        let speeds = s.speeds.iter().zip(&s.accelerations);
        for ((&expr, &change), w) in speeds.zip(&mechanism.pseudo_velocities) {
            letter(expr, Letter::of(&w.label.name), Rank::Velocity);
            letter(change, Letter::of(&w.label.name).dot(), Rank::Acceleration);
        }
        for (&expr, u) in s.inputs.iter().zip(&mechanism.inputs) {
            letter(expr, Letter::of(&u.label.name), Rank::Input);
        }
        for (orders, signal) in s.signals.iter().zip(&mechanism.signals) {
            let mut written = Letter::of(&signal.label.name);
            for &expr in orders {
                letter(expr, written.clone(), Rank::Position);
                written = written.dot();
            }
        }
        letter(s.time, Letter::plain("t"), Rank::Position);
        letter(s.pi, Letter::plain("π"), Rank::Constant);
        let mut lexicon = Self {
            symbols,
            named: FxHashMap::default(),
            kept: FxHashSet::default(),
        };
        lexicon.name_intermediates(mechanism);
        if derivation.algebra.in_letters {
            lexicon.keep_dependent(mechanism, derivation);
        }
        lexicon
    }

    /// Generalised velocities that are quotients, with their partial derivatives and accelerations.
    fn keep_dependent(&mut self, mechanism: &Mechanism, derivation: &Derivation) {
        for &q in &derivation.dependent.system.coordinates {
            let q = &mechanism.coordinates[CoordinateId::new(q)].label.name;
            let rate = Letter::of(q).dot();
            for w in &mechanism.pseudo_velocities {
                self.kept.insert(format!("d_{q}_dot_d_{}", w.label.name));
            }
            self.keep(format!("a0_{q}"), rate.clone().dot().above("0"));
            self.keep(format!("{q}_dot"), rate);
        }
    }

    fn name_intermediates(&mut self, mechanism: &Mechanism) {
        let mut name = |name: String, letter: Letter| {
            self.named.insert(name, letter);
        };
        let bias = |base: &str| Letter::plain(base).above("0");
        for axis in AXES {
            for point in &mechanism.points {
                let letter = bias("a").below(&point.name).below(axis);
                name(format!("a0_{}_{axis}", point.name), letter);
            }
            for frame in &mechanism.frames {
                let letter = Letter::plain("Ω").below(&frame.name).below(axis);
                name(format!("w_{}_{axis}", frame.name), letter);
            }
            for body in &mechanism.bodies {
                let letter = bias("h").dot().below(&body.name).below(axis);
                name(format!("h0_{}_{axis}", body.name), letter);
            }
        }
        for body in &mechanism.bodies {
            let letter = Letter::plain("S").below(&body.name);
            name(format!("s_{}", body.name), letter);
        }
        for q in &mechanism.coordinates {
            let q = &q.label.name;
            name(format!("{q}_dot"), Letter::of(q).dot());
        }
        for (i, w) in mechanism.pseudo_velocities.iter().enumerate() {
            let (name, number) = (&w.label.name, (i + 1).to_string());
            self.keep(format!("{name}_dot"), Letter::of(name).dot());
            self.keep(format!("pivot_{name}"), Letter::plain("D").below(&number));
            for (j, other) in mechanism.pseudo_velocities.iter().enumerate() {
                let (other, place) = (&other.label.name, format!("{number},{}", j + 1));
                for (prefix, base) in [("l", "L"), ("m", "N")] {
                    let letter = Letter::plain(base).below(&place);
                    self.keep(format!("{prefix}_{name}_{other}"), letter);
                }
            }
        }
    }

    fn keep(&mut self, name: String, letter: Letter) {
        self.kept.insert(name.clone());
        self.named.insert(name, letter);
    }

    /// Whether explicit formulas keep a name instead of its definition.
    pub(super) fn keeps(&self, name: &str) -> bool {
        self.kept.contains(name)
    }
}

impl Vocabulary for Lexicon {
    fn letter(&self, graph: &Graph, expr: Expr) -> Letter {
        let known = match graph.node(expr) {
            Node::Named(id) => self.named.get(&graph.definition(*id).name),
            _ => self.symbols.get(&expr).map(|row| &row.0),
        };
        known
            .cloned()
            .unwrap_or_else(|| Spelled.letter(graph, expr))
    }

    fn place(&self, _graph: &Graph, symbol: Expr) -> u8 {
        self.symbols
            .get(&symbol)
            .map_or(Rank::Velocity, |row| row.1) as u8
    }
}
