//! Coordinates, parameters and bodies that are used but have no effect.

use appell_spec::Code;

use super::bench::{Audit, Bench};
use super::work::silent_loads;
use crate::mechanics::finding::{Finding, Item};
use crate::mechanics::loads::{applied_loads, settle};
use crate::mechanics::motions::motions;
use crate::symbolic::vector;
use crate::symbolic::{Expr, Graph};

pub(super) fn audit(bench: &mut Bench, told: &mut Audit) {
    coordinates(bench, told);
    parameters(bench, told);
    bodies(bench, told);
}

/// Coordinates that affect neither the position nor the motion of anything relevant.
fn coordinates(bench: &mut Bench, told: &mut Audit) {
    let Some(moved) = moved(bench) else {
        return;
    };
    let symbols = &bench.derivation.symbols;
    let equations = bench.equations();
    for (q, coordinate) in bench.mechanism.coordinates.entries() {
        // Two rows with the same rate couple other coordinates through it.
        let rows = bench.derivation.constraints.rows.iter();
        let ties = rows.filter(|row| row.is_active() && row.coefficients[q.index()] != Graph::ZERO);
        if ties.count() > 1 {
            continue;
        }
        let own_rate = bench.derivation.velocities.rates[q.index()];
        let others: Vec<Expr> = equations
            .iter()
            .copied()
            .filter(|&e| e != own_rate)
            .collect();
        if bench.are_independent_of(&moved, symbols.rates[q.index()])
            && bench.are_independent_of(&moved, symbols.coordinates[q.index()])
            && bench.are_independent_of(&others, symbols.coordinates[q.index()])
        {
            let name = &coordinate.label.name;
            told.warnings.push(Finding {
                code: Code::NoEffect,
                message: format!(
                    "the coordinate `{name}` has no effect: it moves no body and appears in no \
                     load and no output"
                ),
                item: Item::Coordinate(q),
                help: format!(
                    "use `{name}` in the frame or point that it should move, make it an \
                     output, or remove it together with its constraint"
                ),
            });
        }
    }
}

/// The motion in terms of q and q̇: velocities of the bodies, powers of the loads, outputs.
fn moved(bench: &mut Bench) -> Option<Vec<Expr>> {
    let setting = bench.free();
    let (mechanism, symbols) = (setting.mechanism, setting.symbols);
    let algebra = &mut bench.algebra;
    let free = &bench.unconstrained;
    let mut moved = Vec::new();
    for body in &mechanism.bodies {
        moved.extend(free.velocity(body.centre).v);
        if let Some(frame) = body.frame {
            moved.extend(free.frames.angular_velocity(frame).v);
        }
    }
    let mut loads = applied_loads(algebra, setting, free).ok()?;
    let responses = symbols.responses.iter();
    let as_they_are: Vec<(Expr, Expr)> = responses.map(|&(_, symbol)| (symbol, symbol)).collect();
    settle(&mut loads, &mut algebra.graph, mechanism, &as_they_are).ok()?;
    for load in loads {
        moved.push(load.power(&mut algebra.graph));
    }
    let mut told = motions(algebra, symbols, free);
    for output in &mechanism.outputs {
        let value = setting.lower(&mut algebra.graph, &output.value).ok()?;
        moved.push(told.apply(&mut algebra.graph, value)?);
    }
    moved.retain(|&e| e != Graph::ZERO);
    Some(moved)
}

/// Parameters that cancel in all equations.
fn parameters(bench: &mut Bench, told: &mut Audit) {
    let equations = bench.equations();
    // Parameters of loads without work are reported with the load.
    let silent = silent_loads(bench);
    for (p, parameter) in bench.mechanism.parameters.entries() {
        let symbol = bench.derivation.symbols.parameters[p.index()];
        let graph = &bench.algebra.graph;
        let loads = &bench.derivation.loads;
        let is_told = graph.as_symbol(symbol).is_some_and(|id| {
            let mut silent = silent.iter();
            silent.any(|&load| loads[load.index()].depends_on(graph, &[id]))
        });
        if !is_told && bench.are_independent_of(&equations, symbol) {
            let name = &parameter.label.name;
            told.notes.push(Finding {
                code: Code::NoEffect,
                message: format!(
                    "`{name}` cancels: neither the motion nor an output depends on it"
                ),
                item: Item::Parameter(p),
                help: "no action is needed; a reaction may depend on it".to_owned(),
            });
        }
    }
}

/// Bodies that cannot move.
fn bodies(bench: &Bench, told: &mut Audit) {
    let bodies = bench.mechanism.bodies.entries();
    for ((id, body), motion) in bodies.zip(&bench.derivation.bodies) {
        let turns = motion
            .rotation
            .as_ref()
            .is_some_and(|r| r.velocity.v != vector::ZERO);
        if motion.centre.velocity.v == vector::ZERO && !turns {
            told.notes.push(Finding {
                code: Code::NoEffect,
                message: format!("`{}` never moves: its mass has no effect", body.name),
                item: Item::Body(id),
                help: "let its centre or its frame depend on a coordinate, or remove it".to_owned(),
            });
        }
    }
}
