//! Frames as chains of rotations, points, bodies.

use appell_spec::mechanism::{Axis, FrameId, GROUND, Inertia, Turn};

use super::super::writer::Writer;
use super::super::{Block, Chain, Row, Section, Table};
use super::super::{Letter, Math};
use super::phrases::{equality, headed, math, sentence, words};
use appell_codegen::mechanics::expressions::Lowering;
use appell_codegen::symbolic::{Expr, Graph};

/// Frames, points, bodies.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mechanism = w.mechanism;
    let mut blocks = vec![sentence(
        "O is the origin of the ground. Each frame is the preceding one, rotated about one of its \
         axes. The components of a vector are followed by their frame.",
    )];
    for leaf in mechanism.frames.ids().skip(1) {
        if !mechanism.frames.iter().any(|f| f.parent == Some(leaf)) {
            blocks.push(chain(w, leaf));
        }
    }
    let frames = mechanism
        .frames
        .iter()
        .skip(1)
        .filter(|f| !f.about.is_empty());
    let rows: Vec<_> = frames
        .map(|f| {
            let cells = vec![
                vec![math(Math::Words(f.name.clone()))],
                vec![words(&f.about)],
            ];
            Row {
                cells,
                line: f.line,
            }
        })
        .collect();
    table(&mut blocks, "Frames", rows);
    let points = points(w);
    table(&mut blocks, "Points", points);
    let bodies = bodies(w);
    table(&mut blocks, "Bodies", bodies);
    headed("Frames, points, bodies", blocks)
}

fn table(blocks: &mut Vec<Block>, title: &str, rows: Vec<Row>) {
    if !rows.is_empty() {
        blocks.push(Block::Table(Table {
            title: title.to_owned(),
            rows,
        }));
    }
}

/// An expression of the spec, which the derivation has already lowered.
pub(super) fn lowered(w: &mut Writer<'_>, expr: &appell_spec::expr::Expr) -> Expr {
    let derivation = &mut *w.derivation;
    let lowering = Lowering {
        symbols: &derivation.symbols,
        rates: &derivation.symbols.rates,
    };
    lowering
        .lower(&mut derivation.algebra.graph, expr)
        .unwrap_or(Graph::ZERO)
}

fn chain(w: &mut Writer<'_>, leaf: FrameId) -> Block {
    let mechanism = w.mechanism;
    let mut path = w.derivation.kinematics.frames.ancestors(leaf);
    path.reverse();
    let mut links = Vec::with_capacity(path.len());
    for &frame in &path[1..] {
        let mut label = Vec::new();
        for (k, turn) in mechanism.frames[frame].turns.iter().enumerate() {
            if k > 0 {
                label.push(words(", "));
            }
            let angle = lowered(w, &turn.angle);
            label.push(math(w.set(angle)));
            label.push(words(&format!(" about {}", axis(turn))));
        }
        for (k, id) in mechanism.frames[frame]
            .quaternion
            .iter()
            .flatten()
            .enumerate()
        {
            label.push(words(if k > 0 { ", " } else { "quaternion " }));
            let coordinate = w.derivation.symbols.coordinates[id.index()];
            label.push(math(w.set(coordinate)));
        }
        links.push((label, mechanism.frames[frame].name.clone()));
    }
    Block::Chain(Chain {
        start: mechanism.frames[GROUND].name.clone(),
        links,
    })
}

fn axis(turn: &Turn) -> String {
    let letter = match turn.axis {
        Axis::X => "x",
        Axis::Y => "y",
        Axis::Z => "z",
    };
    format!("{}{letter}", if turn.negative { "−" } else { "" })
}

/// The letters of two points, adjacent.
pub(super) fn from_to(from: &str, to: &str) -> String {
    let single = |name: &str| name.chars().count() == 1;
    if single(from) && single(to) {
        format!("{from}{to}")
    } else {
        format!("{from},{to}")
    }
}

fn points(w: &mut Writer<'_>) -> Vec<Row> {
    let mechanism = w.mechanism;
    let mut rows = Vec::new();
    for (id, point) in mechanism.points.entries() {
        let Some(from) = point.from else { continue };
        let components = point.at.iter().map(|c| lowered(w, c)).collect::<Vec<_>>();
        let components = components.into_iter().map(|c| w.set(c)).collect();
        let frame = Some(w.frame(point.frame));
        let left = Letter::bold("r").below(&from_to(&w.point(from), &w.point(id)));
        let right = Math::Vector {
            components,
            frame,
            column: false,
        };
        let cells = vec![
            vec![equality(Math::Letter(left), right)],
            vec![words(&point.about)],
        ];
        rows.push(Row {
            cells,
            line: point.line,
        });
    }
    rows
}

fn bodies(w: &mut Writer<'_>) -> Vec<Row> {
    let mechanism = w.mechanism;
    let mut rows = Vec::new();
    for body in &mechanism.bodies {
        let mass = lowered(w, &body.mass);
        let mut what = vec![words("mass "), math(w.set(mass))];
        what.push(words(&format!(" at {}", w.point(body.centre))));
        if let Some(inertia) = &body.inertia {
            what.push(words(", "));
            let tensor = tensor(w, inertia);
            let left = Math::Letter(Letter::bold("J").below(&body.name));
            what.push(equality(left, tensor));
        }
        let cells = vec![
            vec![math(Math::Words(body.name.clone()))],
            what,
            vec![words(&body.about)],
        ];
        rows.push(Row {
            cells,
            line: body.line,
        });
    }
    rows
}

/// An inertia tensor, short where it is diagonal.
fn tensor(w: &mut Writer<'_>, inertia: &Inertia) -> Math {
    let mut entries = Vec::with_capacity(9);
    for entry in inertia.matrix.iter().flatten() {
        entries.push(lowered(w, entry));
    }
    let frame = Math::Words(w.frame(inertia.frame));
    let is_diagonal = (0..9).all(|k| k % 4 == 0 || entries[k] == Graph::ZERO);
    if is_diagonal {
        let components = [0, 4, 8].map(|k| w.set(entries[k])).into();
        let diagonal = Math::Vector {
            components,
            frame: None,
            column: false,
        };
        return Math::Row(vec![Math::Call("diag", 1, Box::new(diagonal)), frame]);
    }
    let rows = entries
        .chunks(3)
        .map(|row| row.iter().map(|&e| w.set(e)).collect())
        .collect();
    Math::Row(vec![Math::Matrix(rows), frame])
}
