//! Applied loads: pseudo-forces from virtual power, potential energy, power.

use appell_spec::Code;
use appell_spec::expr::{Expr as Spec, Response};
use appell_spec::mechanism::{Connection, GROUND, LoadId, LoadKind, Mechanism, Spring};

use super::algebra::Algebra;
use super::expressions::{DivisionByZero, Setting};
use super::finding::{Finding, Item, Outcome, defined, division_by_zero, unless_any};
use super::frames::FrameVector;
use super::kinematics::Kinematics;
use super::motions::motions;
use crate::symbolic::vector::Vec3;
use crate::symbolic::{Expr, Graph, Rational, Substitution, SymbolId};

/// A scalar force with its power-conjugate velocity.
#[derive(Debug, Clone, Copy)]
struct Work {
    force: Expr,
    velocity: Expr,
    /// Whether the potential of the load accounts for it.
    is_conservative: bool,
}

impl Work {
    fn new(force: Expr, velocity: Expr, is_conservative: bool) -> Self {
        Self {
            force,
            velocity,
            is_conservative,
        }
    }
}

/// A load as pairs of forces and conjugate velocities.
#[derive(Debug, Clone, Default)]
pub struct AppliedLoad {
    work: Vec<Work>,
    /// Its expressions that depend on reactions: symbols and values.
    pub of_reactions: Vec<(Expr, Expr)>,
    /// Its force as expressions may refer to it.
    pub acts: Acts,
    /// Potential energy, for loads that have one.
    pub potential: Option<Expr>,
}

/// The force of a load as expressions refer to it.
#[derive(Debug, Clone, Copy, Default)]
pub enum Acts {
    /// Distributed over the bodies.
    #[default]
    Spread,
    /// A force or a torque.
    Vector(FrameVector),
    /// A tension, or a generalised force.
    Scalar(Expr),
}

impl Acts {
    fn parts(&mut self) -> &mut [Expr] {
        match self {
            Self::Spread => &mut [],
            Self::Vector(force) => &mut force.v,
            Self::Scalar(force) => std::slice::from_mut(force),
        }
    }
}

impl AppliedLoad {
    /// Whether one of the forces depends on one of the symbols.
    pub fn depends_on(&self, graph: &Graph, symbols: &[SymbolId]) -> bool {
        self.work.iter().any(|w| graph.mentions(w.force, symbols))
    }

    /// Forces with their power-conjugate velocities.
    pub fn work(&self) -> impl Iterator<Item = (Expr, Expr)> {
        self.work.iter().map(|w| (w.force, w.velocity))
    }

    /// Power of the load.
    pub fn power(&self, graph: &mut Graph) -> Expr {
        power(graph, self.work.iter())
    }

    /// Power of the part without a potential.
    pub fn power_without_potential(&self, graph: &mut Graph) -> Expr {
        power(graph, self.work.iter().filter(|w| !w.is_conservative))
    }
}

/// Replaces subexpressions of all forces, velocities and potentials.
pub fn replace(
    loads: &mut [AppliedLoad],
    graph: &mut Graph,
    replacement: &mut Substitution,
) -> Outcome<()> {
    for (index, load) in loads.iter_mut().enumerate() {
        replace_in(load, graph, replacement, LoadId::new(index))?;
    }
    Ok(())
}

fn replace_in(
    load: &mut AppliedLoad,
    graph: &mut Graph,
    replacement: &mut Substitution,
    index: LoadId,
) -> Outcome<()> {
    let work = load.work.iter_mut();
    let parts = work.flat_map(|work| [&mut work.force, &mut work.velocity]);
    let of_reactions = load.of_reactions.iter_mut().map(|(_, value)| value);
    let parts = parts.chain(&mut load.potential).chain(of_reactions);
    let parts = parts.chain(load.acts.parts());
    for part in parts {
        *part = defined(replacement.apply(graph, *part), Item::Load(index))?;
    }
    Ok(())
}

/// Π: virtual power of all loads, one force per direction.
pub fn generalized_forces(
    algebra: &mut Algebra,
    loads: &[AppliedLoad],
    directions: &[Expr],
) -> Vec<Expr> {
    directions
        .iter()
        .map(|&direction| {
            let mut parts = Vec::new();
            for work in loads.iter().flat_map(|load| &load.work) {
                let partial = algebra.derivative(work.velocity, direction);
                parts.push(algebra.graph.mul(work.force, partial));
            }
            let force = algebra.graph.sum(&parts);
            algebra.shortest(force)
        })
        .collect()
}

/// All loads of a mechanism, for given velocities. Expressions that depend on reactions are symbols until
/// [`settle`].
pub fn applied_loads(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    kinematics: &Kinematics,
) -> Outcome<Vec<AppliedLoad>> {
    let mechanism = setting.mechanism;
    let mut loads = Vec::with_capacity(mechanism.loads.len());
    let mut findings = Vec::new();
    for (index, load) in mechanism.loads.entries() {
        let context = Context {
            setting,
            kinematics,
            load: index,
        };
        match context.load(algebra, &load.kind) {
            Ok(applied) => loads.push(applied),
            Err(DivisionByZero) => findings.push(undefined(index, &load.kind)),
        }
    }
    unless_any(findings)?;
    let mut told = motions(algebra, setting.symbols, kinematics);
    replace(&mut loads, &mut algebra.graph, &mut told)?;
    name_each_other(algebra, setting, kinematics, &mut loads)?;
    Ok(loads)
}

/// Substitutes forces of loads that other loads refer to.
fn name_each_other(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    kinematics: &Kinematics,
    loads: &mut [AppliedLoad],
) -> Outcome<()> {
    let symbols = setting.symbols;
    let is_force = |(response, _): &&(Response, Expr)| matches!(response, Response::Force(..));
    if !symbols.responses.iter().any(|named| is_force(&named)) {
        return Ok(());
    }
    let graph = &mut algebra.graph;
    let mut told = Substitution::default();
    for index in setting.mechanism.loads_after_what_they_name() {
        replace_in(&mut loads[index.index()], graph, &mut told, index)?;
        let mut own = symbols.responses.clone();
        own.retain(|(response, _)| matches!(response, Response::Force(load, _) if *load == index));
        for (symbol, value) in forces(graph, kinematics, loads, &own) {
            told.replace(graph, symbol, value);
        }
    }
    Ok(())
}

/// Values for the symbols of forces of loads; other symbols are omitted.
pub fn forces(
    graph: &mut Graph,
    kinematics: &Kinematics,
    loads: &[AppliedLoad],
    wanted: &[(Response, Expr)],
) -> Vec<(Expr, Expr)> {
    let mut values = Vec::new();
    for &(response, symbol) in wanted {
        let Response::Force(load, along) = response else {
            continue;
        };
        let value = match (loads[load.index()].acts, along) {
            (Acts::Vector(force), Some((axis, frame))) => {
                kinematics.frames.express(graph, force, frame)[axis.index()]
            }
            (Acts::Scalar(force), None) => force,
            // Rejected when the spec is checked.
            _ => Graph::ZERO,
        };
        values.push((symbol, value));
    }
    values
}

/// Substitutes values for the expressions that depend on reactions, including the `known` ones; no-op if there
/// are none. A symbol of [`AppliedLoad::of_reactions`] among the latter is kept.
pub fn settle(
    loads: &mut [AppliedLoad],
    graph: &mut Graph,
    mechanism: &Mechanism,
    reactions: &[(Expr, Expr)],
) -> Outcome<()> {
    let mut known = Substitution::of_parts(graph, reactions);
    for index in mechanism.loads_after_what_they_name() {
        let load = &mut loads[index.index()];
        if load.of_reactions.is_empty() {
            continue;
        }
        for (symbol, value) in load.of_reactions.clone() {
            if reactions.iter().any(|&(known, _)| known == symbol) {
                continue;
            }
            let value = match reactions {
                [] => Some(Graph::ZERO),
                _ => known.apply(graph, value),
            };
            let value = defined(value, Item::Load(index))?;
            known.replace(graph, symbol, value);
        }
        replace_in(load, graph, &mut known, index)?;
        load.work.retain(|work| work.force != Graph::ZERO);
    }
    Ok(())
}

/// A load that divides by zero: a connection of zero length, or an expression.
fn undefined(index: LoadId, kind: &LoadKind) -> Finding {
    let item = Item::Load(index);
    match kind.between() {
        None | Some(Connection::Along(_)) => division_by_zero(item),
        Some(Connection::Points(..)) => Finding {
            code: Code::VanishingLength,
            message: "the two points always coincide: the load has no direction".to_owned(),
            item,
            help: "connect two points that can move apart".to_owned(),
        },
    }
}

struct Context<'a> {
    setting: Setting<'a>,
    kinematics: &'a Kinematics,
    load: LoadId,
}

type Lowered<T> = Result<T, DivisionByZero>;

impl Context<'_> {
    /// Lowers a load, with symbols for the expressions that depend on reactions.
    fn load(&self, algebra: &mut Algebra, kind: &LoadKind) -> Lowered<AppliedLoad> {
        let mut applied = self.apply(algebra, kind)?;
        for (place, expr) in kind.expressions().into_iter().enumerate() {
            if let Some(symbol) = self.setting.symbols.of_reactions(self.load, place) {
                let value = self.setting.lower(&mut algebra.graph, expr)?;
                applied.of_reactions.push((symbol, value));
            }
        }
        Ok(applied)
    }

    /// The value of an expression, numbered as in [`LoadKind::expressions`], or its symbol.
    fn part(&self, algebra: &mut Algebra, place: usize, expr: &Spec) -> Lowered<Expr> {
        let symbol = self.setting.symbols.of_reactions(self.load, place);
        symbol.map_or_else(|| self.setting.lower(&mut algebra.graph, expr), Ok)
    }

    fn vector(&self, algebra: &mut Algebra, vector: &[Spec; 3]) -> Lowered<Vec3> {
        let mut values = [Graph::ZERO; 3];
        for (place, (value, expr)) in values.iter_mut().zip(vector).enumerate() {
            *value = self.part(algebra, place, expr)?;
        }
        Ok(values)
    }

    fn apply(&self, algebra: &mut Algebra, kind: &LoadKind) -> Lowered<AppliedLoad> {
        match kind {
            LoadKind::Gravity { down, acceleration } => self.gravity(algebra, *down, acceleration),
            LoadKind::Force {
                on,
                body,
                reaction_on,
                frame,
                vector,
            } => {
                let force = FrameVector::new(*frame, self.vector(algebra, vector)?);
                let graph = &mut algebra.graph;
                let mut v = (self.kinematics).material_velocity(graph, *body, *on, *frame);
                if let Some(other) = reaction_on {
                    let reacting = self.kinematics.velocity_in(graph, *other, *frame);
                    v = graph.sub3(v, reacting);
                }
                Ok(working(algebra, force, v))
            }
            LoadKind::Torque {
                on,
                reaction_on,
                frame,
                vector,
            } => {
                let torque = FrameVector::new(*frame, self.vector(algebra, vector)?);
                let graph = &mut algebra.graph;
                let mut w = self.kinematics.turning_in(graph, *on, *frame);
                if let Some(other) = reaction_on {
                    let reacting = self.kinematics.turning_in(graph, *other, *frame);
                    w = graph.sub3(w, reacting);
                }
                Ok(working(algebra, torque, w))
            }
            LoadKind::SpringDamper {
                between,
                spring,
                damping,
            } => self.spring_damper(algebra, between, spring.as_ref(), damping.as_ref()),
            LoadKind::Generalized { velocity, force } => {
                let force = self.part(algebra, 1, force)?;
                let velocity = self.setting.lower(&mut algebra.graph, velocity)?;
                Ok(AppliedLoad {
                    work: vec![Work::new(force, velocity, false)],
                    acts: Acts::Scalar(force),
                    ..AppliedLoad::default()
                })
            }
        }
    }

    /// The weight of every body; its potential is relative to the origin of the ground.
    fn gravity(&self, algebra: &mut Algebra, down: [i8; 3], g: &Spec) -> Lowered<AppliedLoad> {
        let g = self.setting.lower(&mut algebra.graph, g)?;
        let down = down.map(|c| algebra.graph.integer(c.into()));
        let (mut work, mut heights) = (Vec::new(), Vec::new());
        for body in &self.setting.mechanism.bodies {
            let mass = self.setting.lower(&mut algebra.graph, &body.mass)?;
            let weight = algebra.graph.mul(mass, g);
            let v = self.kinematics.velocity(body.centre);
            let (frames, down_here) = (&self.kinematics.frames, FrameVector::new(GROUND, down));
            let direction = frames.express(&mut algebra.graph, down_here, v.frame);
            let force = algebra.graph.scale3(weight, direction);
            work.extend(pairs(force, v.v, true));
            let position = (self.kinematics).position(&mut algebra.graph, body.centre);
            let fallen = algebra.graph.dot(down, position);
            let energy = algebra.graph.mul(weight, fallen);
            heights.push(algebra.graph.neg(energy));
        }
        let potential = algebra.graph.sum(&heights);
        Ok(AppliedLoad {
            work,
            potential: Some(algebra.shortest(potential)),
            ..AppliedLoad::default()
        })
    }

    /// A tension that grows with the displacement and its rate; the potential is that of the spring.
    fn spring_damper(
        &self,
        algebra: &mut Algebra,
        between: &Connection,
        spring: Option<&Spring>,
        damping: Option<&Spec>,
    ) -> Lowered<AppliedLoad> {
        let (length, rate) = self.extension(algebra, between)?;
        let (mut tensions, mut work, mut potential) = (Vec::new(), Vec::new(), None);
        if let Some(Spring { stiffness, relaxed }) = spring {
            let k = self.setting.lower(&mut algebra.graph, stiffness)?;
            let relaxed = self.setting.lower(&mut algebra.graph, relaxed)?;
            let extension = algebra.graph.sub(length, relaxed);
            let tension = algebra.graph.mul(k, extension);
            tensions.push(tension);
            work.extend(resisting(algebra, tension, &rate, true));
            let square = algebra.graph.square(extension);
            let twice = algebra.graph.mul(k, square);
            potential = Some(algebra.graph.scale(&Rational::new(1, 2), twice));
        }
        if let Some(damping) = damping {
            // The last of its expressions.
            let place = if spring.is_some() { 2 } else { 0 };
            let c = self.part(algebra, place, damping)?;
            let speed = power(&mut algebra.graph, rate.iter());
            let tension = algebra.graph.mul(c, speed);
            tensions.push(tension);
            work.extend(resisting(algebra, tension, &rate, false));
        }
        Ok(AppliedLoad {
            work,
            acts: Acts::Scalar(algebra.graph.sum(&tensions)),
            potential,
            ..AppliedLoad::default()
        })
    }

    /// Displacement of a connection, and the force-velocity pairs whose power is its rate.
    fn extension(&self, algebra: &mut Algebra, between: &Connection) -> Lowered<(Expr, Vec<Work>)> {
        match between {
            Connection::Along(displacement) => {
                let displacement = self.setting.lower(&mut algebra.graph, displacement)?;
                let rate = self.setting.rate(algebra, displacement);
                Ok((displacement, vec![Work::new(Graph::ONE, rate, false)]))
            }
            &Connection::Points(a, b) => {
                let graph = &mut algebra.graph;
                let d = self.kinematics.between(graph, a, b, GROUND);
                let d = FrameVector::new(GROUND, d);
                let d = self.kinematics.frames.simplest(algebra, d);
                let square = algebra.graph.dot(d.v, d.v);
                let square = algebra.shortest(square);
                if square == Graph::ZERO {
                    return Err(DivisionByZero);
                }
                let length = algebra.graph.sqrt(square);
                let graph = &mut algebra.graph;
                let ends = [a, b];
                let [v_a, v_b] = ends.map(|end| self.kinematics.velocity_in(graph, end, d.frame));
                let v = graph.sub3(v_b, v_a);
                let inverse = graph.pow(length, -1);
                let direction = graph.scale3(inverse, d.v);
                Ok((length, pairs(direction, v, false)))
            }
        }
    }
}

fn power<'a>(graph: &mut Graph, work: impl Iterator<Item = &'a Work>) -> Expr {
    let parts: Vec<Expr> = work.map(|w| graph.mul(w.force, w.velocity)).collect();
    graph.sum(&parts)
}

fn pairs(force: Vec3, velocity: Vec3, is_conservative: bool) -> Vec<Work> {
    let both = force.into_iter().zip(velocity);
    both.map(|(force, velocity)| Work::new(force, velocity, is_conservative))
        .collect()
}

/// The load of a force or a torque, with a velocity in the components of the same frame.
fn working(algebra: &mut Algebra, force: FrameVector, velocity: Vec3) -> AppliedLoad {
    let mut work = pairs(force.v, velocity, false);
    work.retain(|w| w.force != Graph::ZERO);
    for w in &mut work {
        w.velocity = algebra.shortest(w.velocity);
    }
    AppliedLoad {
        work,
        acts: Acts::Vector(force),
        ..AppliedLoad::default()
    }
}

/// A tension works against the growth of the length.
fn resisting(
    algebra: &mut Algebra,
    tension: Expr,
    extension: &[Work],
    is_conservative: bool,
) -> Vec<Work> {
    let graph = &mut algebra.graph;
    let pull = graph.neg(tension);
    let along = extension.iter();
    along
        .map(|w| Work::new(graph.mul(pull, w.force), w.velocity, is_conservative))
        .collect()
}
