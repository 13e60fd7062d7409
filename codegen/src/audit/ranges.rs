//! Ranges of angles with which the rates have an explicit formula instead of a pivoted solve.

use appell_spec::Code;
use appell_spec::mechanism::{Coordinate, CoordinateId, Mechanism};

use super::bench::{Audit, Bench};
use crate::mechanics::finding::{Finding, Item, listed};

/// Ranges that exclude poles, in radians: about zero for a tilt, between poles for a polar angle.
const BETWEEN_POLES: [[f64; 2]; 3] = [[-1.5, 1.5], [0.05, 3.1], [-3.1, -0.05]];

/// A proposed range.
#[derive(Debug, Clone)]
pub(super) struct Proposal {
    pub(super) coordinate: CoordinateId,
    range: [f64; 2],
    /// Whether another finding reports it.
    pub(super) is_told: bool,
    /// Coordinates whose rates would still need a pivoted solve.
    open: Vec<usize>,
}

impl Proposal {
    /// The range in the syntax of a spec.
    pub(super) fn written(&self, mechanism: &Mechanism) -> String {
        let Coordinate { label, initial, .. } = &mechanism.coordinates[self.coordinate];
        let scale = label.unit.scale;
        let ends = self.range.map(|end| {
            if label.unit.is_si() {
                end
            } else {
                (end / scale).round()
            }
        });
        let start = if contains(self.range, *initial) {
            ""
        } else {
            " and an initial value inside it"
        };
        format!(
            "`range = [{}, {}]`{start} for `{}`",
            ends[0], ends[1], label.name
        )
    }
}

/// Ranges for angles without one, each of which reduces the number of pivoted rates. Position constraints
/// determine their own ranges.
pub(super) fn proposals(bench: &mut Bench) -> Vec<Proposal> {
    let derivation = bench.derivation;
    if !derivation.positions.names.is_empty() {
        return Vec::new();
    }
    let mut left = derivation.velocities.solved_numerically.len();
    let mut mechanism = bench.mechanism.clone();
    let mut proposals = Vec::new();
    let matrix = &derivation.dependent.system.matrix;
    let coordinates = bench.mechanism.coordinates.entries();
    let symbols = derivation.symbols.coordinates.iter();
    for ((id, q), &symbol) in coordinates.zip(symbols) {
        let graph = &bench.algebra.graph;
        let Some(symbol) = graph.as_symbol(symbol) else {
            continue;
        };
        let occurs = matrix.iter().any(|&c| graph.mentions(c, &[symbol]));
        if left == 0 || !occurs || q.range.is_some() || !q.label.unit.is_angle() {
            continue;
        }
        let mut ranges = BETWEEN_POLES;
        ranges.sort_by_key(|&range| !contains(range, q.initial));
        for range in ranges {
            mechanism.coordinates[id].range = Some(range);
            if let Some(open) = bench.pivoted(&mechanism)
                && open.len() < left
            {
                left = open.len();
                proposals.push(Proposal {
                    coordinate: id,
                    range,
                    is_told: false,
                    open,
                });
                break;
            }
            mechanism.coordinates[id].range = None;
        }
    }
    proposals
}

/// One note per range that no other finding reports.
pub(super) fn audit(bench: &mut Bench, told: &mut Audit) {
    let mechanism = bench.mechanism;
    let names = |q: &usize| &*mechanism.coordinates[CoordinateId::new(*q)].label.name;
    let solved = &bench.derivation.velocities.solved_numerically;
    let rates = listed(solved.iter().map(names));
    for proposal in bench.proposals.iter().filter(|p| !p.is_told) {
        let name = &mechanism.coordinates[proposal.coordinate].label.name;
        told.notes.push(Finding {
            code: Code::SingularPseudoVelocities,
            message: format!(
                "`{name}` has no `range`: the rates of {rates} are solved with pivoting, and are \
                 undefined where nothing determines them"
            ),
            item: Item::Coordinate(proposal.coordinate),
            help: format!(
                "write {}: formulas then give {}; no action is needed if the motion \
                 passes its ends",
                proposal.written(mechanism),
                if proposal.open.is_empty() {
                    "the rates".to_owned()
                } else {
                    let open = listed(proposal.open.iter().map(names));
                    format!("the rates but those of {open}, which need pivoting still")
                }
            ),
        });
    }
}

fn contains([low, high]: [f64; 2], value: f64) -> bool {
    low <= value && value <= high
}
