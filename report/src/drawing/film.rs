//! A motion in space: the data of an animation.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use appell_runtime::Trajectory;
use appell_runtime::model::{At, Model};
use appell_spec::mechanism::{
    BodyId, Components, FrameId, GROUND, LoadId, LoadKind, Mechanism, ORIGIN, PointId,
};
use serde::Serialize;

use super::link::{self, Link};
use super::scene::{Placement, Scene, frames, points, set};
use super::shapes::{Solid, solids};
use super::space::{Matrix, Vector, add, dot, length};
use super::view::View;
use appell_codegen::mechanics::algebra::Algebra;
use appell_codegen::mechanics::expressions::Setting;
use appell_codegen::mechanics::finding::{Item, Outcome, division_by_zero};
use appell_codegen::mechanics::frames::FrameVector;
use appell_codegen::mechanics::kinematics::{Effort, Kinematics};
use appell_codegen::mechanics::loads::{Acts, applied_loads};
use appell_codegen::mechanics::symbols::{Symbols, ids};
use appell_codegen::symbolic::vector::Vec3;
use appell_codegen::symbolic::{Evaluation, Expr, Graph, SymbolId};

/// Least semi-axis of an ellipsoid relative to the largest, so that rods are visible.
const THINNEST: f64 = 0.06;

/// Positions, rotations and forces over the rows of a motion, in the ground and in SI; NaN where
/// not finite.
pub struct Film {
    /// Directions: to the right in the first view, up in it, along the floor, vertical.
    pub view: [[f64; 3]; 4],
    /// The axis of the ground normal to the plane of motion, if the motion is planar.
    pub flat_across: Option<usize>,
    /// Points at which constraints hold bodies, where these roll or slide.
    pub contacts: Vec<PointId>,
    /// Lines between points.
    pub links: Vec<Link>,
    /// By frame: the point at which its axes are drawn.
    pub seats: Vec<Option<PointId>>,
    /// Bodies with a shape.
    pub shapes: Vec<(BodyId, Shape)>,
    /// The forces shown by arrows.
    pub forces: Vec<Force>,
    /// Row by row, three numbers a point.
    pub positions: Vec<f64>,
    /// Row by row, a quaternion x, y, z, w a frame.
    pub turns: Vec<f64>,
    /// Row by row, three numbers an arrow.
    pub arrows: Vec<f64>,
}

/// The shape of a body, in its frame and from its centre.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Shape {
    /// A disc.
    Wheel {
        /// Its centre.
        hub: [f64; 3],
        /// Unit vector along its axis.
        axis: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// A ball.
    Ball {
        /// Its radius.
        radius: f64,
    },
    /// The image of the unit ball under a linear map.
    Ellipsoid {
        /// The map, row by row.
        map: [[f64; 3]; 3],
    },
}

/// A force that an arrow shows.
#[derive(Clone, Copy)]
pub struct Force {
    /// Its origin.
    pub kind: ForceKind,
    /// Its point of application.
    pub at: PointId,
}

/// Origin of a force.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ForceKind {
    /// A constraint.
    Reaction,
    /// A load of the spec.
    Load,
    /// Gravity.
    Weight,
}

/// Positions and forces of a mechanism as expressions: derived once, evaluated for every motion.
pub struct FilmMaker {
    pub(crate) mechanism: Mechanism,
    graph: Graph,
    symbols: Symbols,
    placement: Placement,
    flat_across: Option<usize>,
    applied: Vec<(Force, Vec3)>,
}

impl FilmMaker {
    /// Derives the expressions.
    pub fn new(mechanism: &Mechanism) -> Outcome<Self> {
        let mut graph = Graph::new();
        let symbols = Symbols::new(&mut graph, mechanism);
        let mut algebra = Algebra::new(graph, mechanism, &symbols);
        let free = Setting::free(mechanism, &symbols);
        let kinematics = Kinematics::new(&mut algebra, free, &[], Effort::Plain)?;
        let placement = Placement::new(&mut algebra, free, &kinematics)?;
        let flat_across = placement.flat_across(&mut algebra);
        let applied = applied(&mut algebra, free, &kinematics)?;
        Ok(Self {
            mechanism: mechanism.clone(),
            graph: algebra.graph,
            symbols,
            placement,
            flat_across,
            applied,
        })
    }

    /// Follows a motion along some of its rows. `model` is that of the motion.
    pub fn film(&self, model: &dyn Model, motion: &Trajectory, rows: &[usize]) -> Film {
        let Self {
            mechanism,
            graph,
            placement,
            applied,
            ..
        } = self;
        let reactions = reactions(mechanism, model);
        let arrows: Vec<Expr> = applied.iter().flat_map(|(_, force)| *force).collect();
        let all = [placement.point_exprs(), placement.frame_exprs(), &arrows].concat();
        let mut evaluation = Evaluation::new(graph, &all);
        let mut values = Values::new(graph, &self.symbols, &all, model, motion);
        let view = View::of(mechanism, self.flat_across);
        let mut film = Film {
            view: [view.right, view.up, view.floor[0], view.vertical],
            flat_across: self.flat_across,
            contacts: contacts(mechanism),
            links: link::links(mechanism).collect(),
            seats: (mechanism.frames.ids())
                .map(|frame| link::seat(mechanism, frame))
                .collect(),
            shapes: Vec::new(),
            forces: Vec::new(),
            positions: Vec::new(),
            turns: Vec::new(),
            arrows: Vec::new(),
        };
        let mut forces = vec![0.0; 3 * model.info().reactions.len()];
        for (count, &row) in rows.iter().enumerate() {
            let at = values.at(row);
            let values = &values.of_symbols;
            if count == 0 {
                let scene = Scene::at(placement, graph, values, self.flat_across);
                film.shapes = shapes(mechanism, &scene);
            }
            evaluation.compute(values);
            let of =
                |exprs: &[Expr]| -> Vec<f64> { exprs.iter().map(|&e| evaluation.of(e)).collect() };
            for place in &points(&of(placement.point_exprs())) {
                film.positions.extend(place.unwrap_or([f64::NAN; 3]));
            }
            for axes in &frames(&of(placement.frame_exprs())) {
                film.turns.extend(axes.map_or([f64::NAN; 4], quaternion));
            }
            let forces = motion.reactions(row).unwrap_or_else(|| {
                model.constraint_forces(at, &mut forces);
                &forces
            });
            for (index, _) in &reactions {
                film.arrows.extend(&forces[3 * index..][..3]);
            }
            for (_, force) in applied {
                film.arrows.extend(of(force));
            }
        }
        let named = reactions.into_iter().map(|(_, force)| force);
        film.forces = named
            .chain(applied.iter().map(|(force, _)| *force))
            .collect();
        film
    }
}

/// Points at which constraints hold bodies.
fn contacts(mechanism: &Mechanism) -> Vec<PointId> {
    let held = mechanism.constraints.iter().filter_map(link::held);
    let held: BTreeSet<PointId> = held.map(|(_, point)| point).collect();
    held.into_iter().collect()
}

/// Constraint forces on points, with their indices in the model.
fn reactions(mechanism: &Mechanism, model: &dyn Model) -> Vec<(usize, Force)> {
    let reactions = model.info().reactions.iter().enumerate();
    // The reaction of a constraint without a point is not a force in space.
    let on_point = reactions.filter(|(_, reaction)| reaction.on_point);
    let found = on_point.filter_map(|(index, reaction)| {
        let at = mechanism.points.find(|point| reaction.name == point.name)?;
        let force = Force {
            kind: ForceKind::Reaction,
            at,
        };
        Some((index, force))
    });
    found.collect()
}

/// Point forces and weights of the spec, as expressions of ground-frame components. Forces that depend on reactions
/// are omitted and have no arrow.
fn applied(
    algebra: &mut Algebra,
    setting: Setting<'_>,
    kinematics: &Kinematics,
) -> Outcome<Vec<(Force, Vec3)>> {
    let (mechanism, symbols) = (setting.mechanism, setting.symbols);
    let names_nothing = symbols.motions.is_empty() && symbols.responses.is_empty();
    let acting = if names_nothing {
        Vec::new()
    } else {
        applied_loads(algebra, setting, kinematics)?
    };
    let graph = &mut algebra.graph;
    let in_ground = |graph: &mut Graph, index: LoadId, frame: FrameId, vector: &Components| {
        if let Some(Acts::Vector(force)) = acting.get(index.index()).map(|load| load.acts) {
            return Ok(kinematics.frames.express(graph, force, GROUND));
        }
        let v = setting.lower_all(graph, vector)?;
        let v = FrameVector::new(frame, v);
        Ok(kinematics.frames.express(graph, v, GROUND))
    };
    let mut all = Vec::new();
    for (index, load) in mechanism.loads.entries() {
        let divides = |_| vec![division_by_zero(Item::Load(index))];
        let force = |kind, at| Force { kind, at };
        match &load.kind {
            LoadKind::Gravity { down, acceleration } => {
                let g = setting.lower(graph, acceleration).map_err(divides)?;
                let down = down.map(|c| graph.integer(c.into()));
                for body in &mechanism.bodies {
                    let mass = setting.lower(graph, &body.mass).map_err(divides)?;
                    let weight = graph.mul(mass, g);
                    let force = force(ForceKind::Weight, body.centre);
                    all.push((force, graph.scale3(weight, down)));
                }
            }
            LoadKind::Force {
                on,
                reaction_on,
                frame,
                vector,
                ..
            } => {
                let vector = in_ground(graph, index, *frame, vector).map_err(divides)?;
                all.push((force(ForceKind::Load, *on), vector));
                if let Some(other) = reaction_on.filter(|&other| other != ORIGIN) {
                    let opposite = vector.map(|c| graph.neg(c));
                    all.push((force(ForceKind::Load, other), opposite));
                }
            }
            // Without an arrow: torques, and forces shown by a line between two points.
            LoadKind::Torque { .. }
            | LoadKind::SpringDamper { .. }
            | LoadKind::Generalized { .. } => {}
        }
    }
    Ok(all)
}

/// Shapes in the frames of their bodies, where they are constant.
fn shapes(mechanism: &Mechanism, scene: &Scene) -> Vec<(BodyId, Shape)> {
    let size = reach(scene);
    let shape = |(id, solid): (BodyId, Solid)| {
        let body = &mechanism.bodies[id];
        let (axes, centre) = (scene.frames[body.frame?]?, scene.points[body.centre]?);
        let inside = |v: Vector| axes.map(|axis| dot(axis, v));
        let shape = match solid {
            Solid::Wheel { hub, axis, radius } => Shape::Wheel {
                hub: inside(add(hub, -1.0, centre)),
                axis: inside(axis),
                radius: length(radius),
            },
            Solid::Ball { radius, .. } => Shape::Ball { radius },
            Solid::Ellipsoid { square, .. } => {
                let square = axes.map(|axis| inside(square.map(|row| dot(row, axis))));
                let largest = (square[0][0] + square[1][1] + square[2][2]).sqrt();
                // A shape that would hide the rest is omitted.
                if size > 0.0 && largest > size {
                    return None;
                }
                let map = factor(square, THINNEST * largest)?;
                Shape::Ellipsoid { map }
            }
        };
        Some((id, shape))
    };
    solids(mechanism, scene).filter_map(shape).collect()
}

/// The largest distance of two points along an axis of the ground.
fn reach(scene: &Scene) -> f64 {
    let along = |axis: usize| {
        let places = || scene.points.iter().flatten().map(|place| place[axis]);
        places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
    };
    [0, 1, 2].map(along).into_iter().fold(0.0, f64::max)
}

/// A Cholesky factor of a square that is at least `thinnest` in every direction.
fn factor(square: Matrix, thinnest: f64) -> Option<Matrix> {
    let mut lower = [[0.0_f64; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = square[i][j] - known;
            lower[i][j] = if i == j {
                (rest + thinnest * thinnest).sqrt()
            } else {
                rest / lower[j][j]
            };
        }
    }
    let finite = lower.iter().flatten().all(|entry| entry.is_finite());
    finite.then_some(lower)
}

/// The unit quaternion x, y, z, w of the rotation from the axes of the ground to these.
fn quaternion(axes: Matrix) -> [f64; 4] {
    // Division by the largest of the four components.
    let [x, y, z] = axes;
    let squares = [
        1.0 + x[0] - y[1] - z[2],
        1.0 - x[0] + y[1] - z[2],
        1.0 - x[0] - y[1] + z[2],
        1.0 + x[0] + y[1] + z[2],
    ];
    let sums = [
        [squares[0], x[1] + y[0], x[2] + z[0], y[2] - z[1]],
        [x[1] + y[0], squares[1], y[2] + z[1], z[0] - x[2]],
        [x[2] + z[0], y[2] + z[1], squares[2], x[1] - y[0]],
        [y[2] - z[1], z[0] - x[2], x[1] - y[0], squares[3]],
    ];
    let largest = (0..4).max_by(|&i, &j| squares[i].total_cmp(&squares[j]));
    let row = sums[largest.unwrap_or(3)];
    let length = row.iter().map(|c| c * c).sum::<f64>().sqrt();
    row.map(|c| c / length)
}

/// Values of the symbols along a motion.
struct Values<'m> {
    model: &'m dyn Model,
    motion: &'m Trajectory,
    time: Vec<SymbolId>,
    states: Vec<SymbolId>,
    inputs: Vec<SymbolId>,
    /// Empty where no value depends on them.
    rates: Vec<SymbolId>,
    of_symbols: Vec<f64>,
}

impl<'m> Values<'m> {
    /// Of the symbols in these expressions.
    fn new(
        graph: &Graph,
        symbols: &Symbols,
        exprs: &[Expr],
        model: &'m dyn Model,
        motion: &'m Trajectory,
    ) -> Self {
        let tabulated = (model.info().signal_inputs.iter())
            .map(|&(signal, order)| symbols.signals[signal][usize::from(order)]);
        let inputs: Vec<_> = symbols.inputs.iter().copied().chain(tabulated).collect();
        let states = [symbols.speeds.as_slice(), &symbols.coordinates].concat();
        let rates = [symbols.accelerations.as_slice(), &symbols.rates].concat();
        let mut rates = ids(graph, &rates);
        if !exprs.iter().any(|&expr| graph.mentions(expr, &rates)) {
            rates.clear();
        }
        let mut values = Self {
            model,
            motion,
            time: ids(graph, &[symbols.time]),
            states: ids(graph, &states),
            inputs: ids(graph, &inputs),
            rates,
            of_symbols: vec![f64::NAN; graph.symbol_count()],
        };
        let of_symbols = &mut values.of_symbols;
        let parameters = ids(graph, &symbols.parameters);
        set(of_symbols, &parameters, motion.parameters());
        set(of_symbols, &ids(graph, &[symbols.pi]), &[PI]);
        values
    }

    /// Advances to a row of the motion.
    fn at(&mut self, row: usize) -> At<'m> {
        let motion = self.motion;
        let at = At {
            t: motion.times()[row],
            x: motion.state(row),
            u: motion.inputs(row),
            p: motion.parameters(),
        };
        let mut rates = vec![0.0; at.x.len()];
        if !self.rates.is_empty() {
            self.model.rates(at, &mut rates);
        }
        for (symbols, numbers) in [
            (&self.time, &[at.t][..]),
            (&self.states, at.x),
            (&self.inputs, at.u),
            (&self.rates, &rates),
        ] {
            set(&mut self.of_symbols, symbols, numbers);
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::super::space::cross;
    use super::*;

    const ROUNDING: f64 = 1e-14;

    /// Axes turned about z, then about the new x, then about the new z.
    fn turned([a, b, c]: [f64; 3]) -> Matrix {
        let [(sa, ca), (sb, cb), (sc, cc)] = [a, b, c].map(f64::sin_cos);
        let x = [ca * cc - sa * cb * sc, sa * cc + ca * cb * sc, sb * sc];
        let z = [sa * sb, -ca * sb, cb];
        [x, cross(z, x), z]
    }

    #[test]
    fn a_quaternion_turns_the_axes_of_the_ground_to_those_of_the_frame() {
        for angles in [
            [0.0; 3],
            [3.0, 0.1, -0.2],
            [0.3, 3.1, 0.2],
            [-2.0, 1.5, 2.9],
        ] {
            let axes = turned(angles);
            let [x, y, z, w] = quaternion(axes);
            for (k, wanted) in axes.into_iter().enumerate() {
                let mut v = [0.0; 3];
                v[k] = 1.0;
                // v + 2 u × (u × v + w v)
                let u = [x, y, z];
                let inner = add(cross(u, v), w, v);
                let found = add(v, 2.0, cross(u, inner));
                let off = length(add(found, -1.0, wanted));
                assert!(off < ROUNDING, "{angles:?}: off by {off}");
            }
        }
    }

    #[test]
    fn the_factor_of_a_flat_ellipsoid_is_as_thin_as_allowed() {
        let square = [[4.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0; 3]];
        let lower = factor(square, 0.1).expect("a factor");
        for i in 0..3 {
            for j in 0..3 {
                let wanted = square[i][j] + if i == j { 0.01 } else { 0.0 };
                assert!((dot(lower[i], lower[j]) - wanted).abs() < ROUNDING);
            }
        }
    }
}
