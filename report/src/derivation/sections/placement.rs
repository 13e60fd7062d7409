//! Frames as chains of rotations, points, bodies.

use appell_spec::mechanism::{FrameId, GROUND, Inertia, Turn};

use super::super::lexicon::AXES;
use super::super::{Block, Chain, Letter, Math, Row, Section, Span, Writer};
use super::phrases::{equality, headed, math, sentence, table, words};
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
    let frames = mechanism.frames.iter().skip(1);
    let frames = frames.filter(|frame| !frame.about.is_empty());
    let frames = frames.map(|frame| Row {
        cells: vec![name(&frame.name), vec![words(&frame.about)]],
        line: frame.line,
    });
    blocks.extend(table("Frames", frames.collect()));
    blocks.extend(table("Points", points(w)));
    blocks.extend(table("Bodies", bodies(w)));
    headed("Frames, points, bodies", blocks)
}

fn name(name: &str) -> Vec<Span> {
    vec![math(Math::Words(name.to_owned()))]
}

/// An expression of the spec, which the derivation has already lowered.
pub(super) fn lowered(w: &mut Writer<'_>, expr: &appell_spec::expr::Expr) -> Expr {
    try_lowered(w, expr).unwrap_or(Graph::ZERO)
}

/// An expression of the spec, if it does not divide by zero.
pub(super) fn try_lowered(w: &mut Writer<'_>, expr: &appell_spec::expr::Expr) -> Option<Expr> {
    let derivation = &mut *w.derivation;
    let graph = &mut derivation.algebra.graph;
    derivation.symbols.lower(graph, expr).ok()
}

fn chain(w: &mut Writer<'_>, leaf: FrameId) -> Block {
    let mechanism = w.mechanism;
    let mut path = w.derivation.kinematics.frames.ancestors(leaf);
    path.reverse();
    let mut links = Vec::with_capacity(path.len());
    for &frame in &path[1..] {
        let mut label = Vec::new();
        let frame = &mechanism.frames[frame];
        for (k, turn) in frame.turns.iter().enumerate() {
            if k > 0 {
                label.push(words(", "));
            }
            let angle = lowered(w, &turn.angle);
            label.push(math(w.set(angle)));
            label.push(words(&format!(" about {}", axis(turn))));
        }
        for (k, id) in frame.quaternion.iter().flatten().enumerate() {
            label.push(words(if k > 0 { ", " } else { "quaternion " }));
            let coordinate = w.derivation.symbols.coordinates[id.index()];
            label.push(math(w.set(coordinate)));
        }
        links.push((label, frame.name.clone()));
    }
    Block::Chain(Chain {
        start: mechanism.frames[GROUND].name.clone(),
        links,
    })
}

fn axis(turn: &Turn) -> String {
    let sign = if turn.negative { "−" } else { "" };
    format!("{sign}{}", AXES[turn.axis.index()])
}

/// The letters of two points, adjacent.
pub(super) fn from_to(from: &str, to: &str) -> String {
    let are_single = [from, to].iter().all(|name| name.chars().count() == 1);
    format!("{from}{}{to}", if are_single { "" } else { "," })
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
        let what = vec![equality(Math::Letter(left), right)];
        rows.push(Row {
            cells: vec![what, vec![words(&point.about)]],
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
        rows.push(Row {
            cells: vec![name(&body.name), what, vec![words(&body.about)]],
            line: body.line,
        });
    }
    rows
}

/// An inertia tensor, short where it is diagonal.
fn tensor(w: &mut Writer<'_>, inertia: &Inertia) -> Math {
    let entries = inertia.matrix.iter().flatten();
    let entries: Vec<Expr> = entries.map(|entry| lowered(w, entry)).collect();
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
