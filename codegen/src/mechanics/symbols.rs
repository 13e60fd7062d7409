//! The symbols of a mechanism.

use appell_spec::expr::{Motion as MotionQuantity, Quantity, Response};
use appell_spec::mechanism::{Axis, ConstraintKind, FrameId, LoadId, Mechanism, PointId, SpeedId};
use rustc_hash::FxHashMap;

use crate::symbolic::{Expr, Graph, SymbolId};

/// One symbol per named quantity, and those of its derivatives that the equations need.
#[derive(Debug, Clone)]
pub struct Symbols {
    /// Parameters.
    pub parameters: Vec<Expr>,
    /// Coordinates q.
    pub coordinates: Vec<Expr>,
    /// Generalised velocities q̇ as unknowns.
    pub rates: Vec<Expr>,
    /// Pseudo-velocities ω.
    pub speeds: Vec<Expr>,
    /// Pseudo-accelerations ω̇ as unknowns.
    pub accelerations: Vec<Expr>,
    /// Inputs.
    pub inputs: Vec<Expr>,
    /// Signals with their first and second derivatives.
    pub signals: Vec<[Expr; 3]>,
    /// Kinematic quantities of points and frames in loads and outputs, until their values are substituted.
    pub motions: Vec<(MotionQuantity, Expr)>,
    /// Accelerations and forces in these, likewise.
    pub responses: Vec<(Response, Expr)>,
    /// The symbols of both.
    named: FxHashMap<Quantity, Expr>,
    /// Expressions of loads that depend on reactions, by load and index, treated as inputs.
    of_reactions: FxHashMap<(LoadId, usize), Expr>,
    /// Time.
    pub time: Expr,
    /// The circle constant.
    pub pi: Expr,
    /// Weights of an adjoint, while it is derived.
    pub weights: Vec<Expr>,
}

impl Symbols {
    /// Creates the symbols; parameters first, so that canonical products start with them.
    pub fn new(graph: &mut Graph, mechanism: &Mechanism) -> Self {
        let mut all = |names: &mut dyn Iterator<Item = String>| -> Vec<Expr> {
            names.map(|name| graph.symbol(&name)).collect()
        };
        let parameters = all(&mut mechanism.parameters.iter().map(|p| p.label.name.clone()));
        let coordinates = all(&mut mechanism.coordinates.iter().map(|c| c.label.name.clone()));
        let speeds = all(&mut mechanism
            .pseudo_velocities
            .iter()
            .map(|w| w.label.name.clone()));
        let inputs = all(&mut mechanism.inputs.iter().map(|u| u.label.name.clone()));
        let rates = all(&mut mechanism
            .coordinates
            .iter()
            .map(|c| format!("{}_dot", c.label.name)));
        let accelerations = all(&mut mechanism
            .pseudo_velocities
            .iter()
            .map(|w| format!("{}_dot", w.label.name)));
        let signals = mechanism
            .signals
            .iter()
            .map(|s| {
                ["", "_dot", "_ddot"]
                    .map(|suffix| graph.symbol(&format!("{}{suffix}", s.label.name)))
            })
            .collect();
        let time = graph.symbol("t");
        let pi = graph.symbol("pi");
        let mut symbols = Self {
            parameters,
            coordinates,
            rates,
            speeds,
            accelerations,
            inputs,
            signals,
            motions: Vec::new(),
            responses: Vec::new(),
            named: FxHashMap::default(),
            of_reactions: FxHashMap::default(),
            time,
            pi,
            weights: Vec::new(),
        };
        symbols.name_quantities(graph, mechanism);
        symbols.of_reactions = of_reactions(graph, mechanism);
        symbols
    }

    /// A symbol for each kinematic quantity and force; names in a spec have no parentheses.
    fn name_quantities(&mut self, graph: &mut Graph, mechanism: &Mechanism) {
        let mut see = |quantity| self.see(graph, mechanism, quantity);
        for load in &mechanism.loads {
            for expr in load.kind.expressions() {
                expr.visit(&mut see);
            }
        }
        for constraint in &mechanism.constraints {
            match &constraint.kind {
                ConstraintKind::Position { zero, .. } | ConstraintKind::Velocity { zero, .. } => {
                    zero.visit(&mut see);
                }
                ConstraintKind::Rolling { .. } | ConstraintKind::FixedVelocity { .. } => {}
            }
        }
        for speed in &mechanism.pseudo_velocities {
            speed.definition.visit(&mut see);
        }
        for output in &mechanism.outputs {
            output.value.visit(&mut see);
        }
    }

    fn see(&mut self, graph: &mut Graph, mechanism: &Mechanism, quantity: Quantity) {
        if self.named.contains_key(&quantity) {
            return;
        }
        match quantity {
            Quantity::Motion(motion) => {
                let symbol = graph.symbol(&shown(mechanism, motion));
                self.motions.push((motion, symbol));
                self.named.insert(quantity, symbol);
            }
            Quantity::Response(response) => {
                let symbol = graph.symbol(&answer(mechanism, response));
                self.responses.push((response, symbol));
                self.named.insert(quantity, symbol);
            }
            _ => {}
        }
    }
}

/// The quantity in the syntax of a spec.
fn shown(mechanism: &Mechanism, motion: MotionQuantity) -> String {
    let point = |point: PointId| &mechanism.points[point].name;
    match motion {
        MotionQuantity::Position(p, a, f) => {
            format!("position({}, {})", point(p), along(mechanism, a, f))
        }
        MotionQuantity::Velocity(p, a, f) => {
            format!("velocity({}, {})", point(p), along(mechanism, a, f))
        }
        MotionQuantity::Speed(p) => format!("speed({})", point(p)),
        MotionQuantity::AngularVelocity(of, a, f) => {
            let of = &mechanism.frames[of].name;
            format!("angular_velocity({of}, {})", along(mechanism, a, f))
        }
    }
}

/// The quantity in the syntax of a spec.
pub(super) fn answer(mechanism: &Mechanism, response: Response) -> String {
    let component = |direction: Option<(Axis, FrameId)>| {
        direction.map_or_else(String::new, |(a, f)| {
            format!(", {}", along(mechanism, a, f))
        })
    };
    match response {
        Response::Acceleration(p, a, f) => {
            let point = &mechanism.points[p].name;
            format!("acceleration({point}, {})", along(mechanism, a, f))
        }
        Response::AngularAcceleration(of, a, f) => {
            let of = &mechanism.frames[of].name;
            format!("angular_acceleration({of}, {})", along(mechanism, a, f))
        }
        Response::Reaction(c, direction) => {
            let name = &mechanism.constraints[c].name;
            format!("reaction({name}{})", component(direction))
        }
        Response::NormalForce(c) => format!("normal_force({})", mechanism.constraints[c].name),
        Response::DriveForce(speed) => {
            format!(
                "drive_force({})",
                mechanism.pseudo_velocities[speed].label.name
            )
        }
        Response::Force(load, direction) => {
            let name = &mechanism.loads[load].name;
            format!("force({name}{})", component(direction))
        }
    }
}

fn along(mechanism: &Mechanism, axis: Axis, frame: FrameId) -> String {
    let axis = ["x", "y", "z"][axis.index()];
    format!("{axis}, {}", mechanism.frames[frame].name)
}

/// A symbol for each expression of a load that depends on reactions, directly or through another load's force.
fn of_reactions(graph: &mut Graph, mechanism: &Mechanism) -> FxHashMap<(LoadId, usize), Expr> {
    let mut all: FxHashMap<(LoadId, usize), Expr> = FxHashMap::default();
    let mut reacts = vec![false; mechanism.loads.len()];
    for load in mechanism.loads_after_what_they_name() {
        let item = &mechanism.loads[load];
        for (place, expr) in item.kind.expressions().into_iter().enumerate() {
            let mut depends = false;
            expr.visit(&mut |quantity| {
                depends |= match quantity {
                    Quantity::Response(Response::Reaction(..) | Response::NormalForce(_)) => true,
                    Quantity::Response(Response::Force(other, _)) => reacts[other.index()],
                    _ => false,
                };
            });
            if depends {
                reacts[load.index()] = true;
                all.insert(
                    (load, place),
                    graph.symbol(&format!("{}_{place}", item.name)),
                );
            }
        }
    }
    all
}

impl Symbols {
    /// The symbol of an expression of a load, numbered as in `LoadKind::expressions`, that depends on
    /// reactions.
    pub fn of_reactions(&self, load: LoadId, place: usize) -> Option<Expr> {
        self.of_reactions.get(&(load, place)).copied()
    }

    /// The symbol of a kinematic quantity or a force in a load or an output.
    pub fn named(&self, quantity: Quantity) -> Option<Expr> {
        self.named.get(&quantity).copied()
    }
}

/// Name of a pseudo-velocity, by its index.
pub(super) fn speed_name(mechanism: &Mechanism, speed: usize) -> &str {
    &mechanism.pseudo_velocities[SpeedId::new(speed)].label.name
}

/// The ids of expressions that are symbols.
pub fn ids(graph: &Graph, symbols: &[Expr]) -> Vec<SymbolId> {
    symbols.iter().filter_map(|&s| graph.as_symbol(s)).collect()
}
