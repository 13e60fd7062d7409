//! The symbols of a mechanism.

use appell_spec::expr::{Motion as MotionQuantity, Quantity};
use appell_spec::mechanism::{Axis, FrameId, Mechanism, PointId};

use crate::symbolic::{Expr, Graph, SymbolId};

/// One symbol per named quantity, and those of their derivatives that the equations need.
#[derive(Debug, Clone)]
pub struct Symbols {
    /// Parameters.
    pub parameters: Vec<Expr>,
    /// Coordinates q.
    pub coordinates: Vec<Expr>,
    /// Generalised velocities q̇ while they are unknowns.
    pub rates: Vec<Expr>,
    /// Pseudo-velocities ω.
    pub speeds: Vec<Expr>,
    /// Pseudo-accelerations ω̇ while they are unknowns.
    pub accelerations: Vec<Expr>,
    /// Inputs.
    pub inputs: Vec<Expr>,
    /// Signals with their first and second derivatives.
    pub signals: Vec<[Expr; 3]>,
    /// Kinematic quantities of points and frames that loads and outputs name, until their places take
    /// what they are.
    pub motions: Vec<(MotionQuantity, Expr)>,
    /// Time.
    pub time: Expr,
    /// The circle constant.
    pub pi: Expr,
    /// Weights of the adjoint of the rates, once it is asked for.
    pub weights: Vec<Expr>,
    /// Weights of the adjoint of the outputs, once it is asked for.
    pub output_weights: Vec<Expr>,
}

impl Symbols {
    /// Makes the symbols; parameters first, so that canonical products start with them.
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
        Self {
            parameters,
            coordinates,
            rates,
            speeds,
            accelerations,
            inputs,
            signals,
            motions: motions(graph, mechanism),
            time,
            pi,
            weights: Vec::new(),
            output_weights: Vec::new(),
        }
    }
}

/// A symbol for each kinematic quantity; no name of a spec has parentheses.
fn motions(graph: &mut Graph, mechanism: &Mechanism) -> Vec<(MotionQuantity, Expr)> {
    let mut motions: Vec<(MotionQuantity, Expr)> = Vec::new();
    let mut see = |quantity| {
        if let Quantity::Motion(motion) = quantity
            && motions.iter().all(|(own, _)| *own != motion)
        {
            let symbol = graph.symbol(&shown(mechanism, motion));
            motions.push((motion, symbol));
        }
    };
    for load in &mechanism.loads {
        for expr in load.kind.expressions() {
            expr.visit(&mut see);
        }
    }
    for output in &mechanism.outputs {
        output.value.visit(&mut see);
    }
    motions
}

/// As it is written in a spec.
fn shown(mechanism: &Mechanism, motion: MotionQuantity) -> String {
    let axis = |axis: Axis| ["x", "y", "z"][axis.index()];
    let frame = |frame: FrameId| &mechanism.frames[frame].name;
    let point = |point: PointId| &mechanism.points[point].name;
    match motion {
        MotionQuantity::Position(p, a, f) => {
            format!("position({}, {}, {})", point(p), axis(a), frame(f))
        }
        MotionQuantity::Velocity(p, a, f) => {
            format!("velocity({}, {}, {})", point(p), axis(a), frame(f))
        }
        MotionQuantity::Speed(p) => format!("speed({})", point(p)),
        MotionQuantity::AngularVelocity(of, a, f) => {
            format!("angular_velocity({}, {}, {})", frame(of), axis(a), frame(f))
        }
    }
}

/// The symbols behind a list of expressions that are symbols.
pub fn ids(graph: &Graph, symbols: &[Expr]) -> Vec<SymbolId> {
    symbols.iter().filter_map(|&s| graph.as_symbol(s)).collect()
}
