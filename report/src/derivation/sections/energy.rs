//! The acceleration energy and its derivatives.

use super::super::display::Equation;
use super::super::writer::Writer;
use super::super::{About, Block, Section, Span};
use super::super::{Letter, Math};
use super::phrases::{headed, listed, math, with, words};
use appell_codegen::mechanics::gibbs_appell::gibbs_form;
use appell_codegen::mechanics::motion::independent_blocks;
use appell_codegen::symbolic::{Expr, Graph, Rational};
use appell_spec::mechanism::BodyId;

/// A matrix wider than this shows letters, and its entries follow as equations.
const WIDEST_MATRIX: usize = 82;

/// S, body by body.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let letter = |name: &str| Math::Letter(Letter::plain(name));
    let bold = |name: &str| Math::Letter(Letter::bold(name));
    let half = || Math::Ratio("1".to_owned(), "2".to_owned());
    let dot = || Math::Sign("·");
    let translation = Math::Row(vec![half(), letter("m"), bold("a"), dot(), bold("a")]);
    let rotation = Math::Row(vec![
        half(),
        bold("α"),
        dot(),
        Math::Row(vec![bold("J"), bold("α")]),
    ]);
    let spin = Math::Row(vec![bold("ω"), Math::Sign("×"), bold("J"), bold("ω")]);
    let gyroscopic = Math::Row(vec![bold("α"), dot(), Math::Brackets(Box::new(spin))]);
    let whole = Math::sum(vec![
        (false, translation),
        (false, rotation),
        (false, gyroscopic),
    ]);
    let definition = Math::Row(vec![
        letter("S"),
        Math::Sign("="),
        Math::Sign("Σ"),
        Math::Brackets(Box::new(whole)),
    ]);
    let mut blocks = vec![Block::Sentence(vec![
        words("The sum runs over the bodies: "),
        math(definition),
        words(". Terms without accelerations are omitted; the derivatives do not contain them."),
    ])];
    let mut equations = Vec::new();
    for (index, body) in w.derivation.bodies.clone().into_iter().enumerate() {
        let s = energy_of(w, &body);
        let right = w.by_acceleration(s);
        let left = Letter::plain("S").below(&body.name);
        let about = About::Body(BodyId::new(index));
        equations.push(Equation::new(Math::Letter(left), right).about(about));
    }
    blocks.extend(with(w, "", equations));
    headed("Acceleration energy S", blocks)
}

/// `½ ω̇ᵀ M ω̇ + bᵀ ω̇` of one body.
fn energy_of(
    w: &mut Writer<'_>,
    body: &appell_codegen::mechanics::gibbs_appell::BodyMotion,
) -> Expr {
    let accelerations = w.derivation.symbols.accelerations.clone();
    let form = gibbs_form(
        &mut w.derivation.algebra,
        std::slice::from_ref(body),
        accelerations.len(),
    );
    let graph = w.graph();
    let mut parts = Vec::new();
    for (i, &first) in accelerations.iter().enumerate() {
        for (j, &second) in accelerations.iter().enumerate() {
            let part = graph.product(&[form.mass_matrix[i][j], first, second]);
            parts.push(graph.scale(&Rational::new(1, 2), part));
        }
        parts.push(graph.mul(form.bias[i], first));
    }
    graph.sum(&parts)
}

/// ∂S/∂ω̇ = M ω̇ + b.
pub(super) fn derivatives(w: &mut Writer<'_>) -> Section {
    let matrix = w.derivation.gibbs.mass_matrix.clone();
    let mut blocks = matrix_blocks(w, &matrix);
    blocks.push(Block::Sentence(couplings(w, &matrix)));
    let mut equations = Vec::new();
    for (i, bias) in w.derivation.gibbs.bias.clone().into_iter().enumerate() {
        let right = w.explicit(bias);
        equations.push(Equation::new(numbered("b", i), right).about(About::Inertia(i, i)));
    }
    blocks.extend(with(
        w,
        "The bias b is the part without accelerations:",
        equations,
    ));
    let heading = Math::Row(vec![
        Math::fraction(
            Math::Letter(Letter::plain("S").before('∂')),
            Math::Letter(Letter::bold("ω").dot().before('∂')),
        ),
        Math::Sign("="),
        Math::Letter(Letter::bold("M")),
        Math::Letter(Letter::bold("ω").dot()),
        Math::Sign("+"),
        Math::Letter(Letter::bold("b")),
    ]);
    Section {
        heading: vec![words("Mass matrix and bias: "), math(heading)],
        blocks,
    }
}

fn matrix_blocks(w: &mut Writer<'_>, matrix: &[Vec<Expr>]) -> Vec<Block> {
    let entries: Vec<Vec<Math>> = matrix
        .iter()
        .map(|row| {
            row.iter()
                .map(|&entry| {
                    if entry == Graph::ZERO {
                        Math::zero()
                    } else {
                        w.explicit(entry)
                    }
                })
                .collect()
        })
        .collect();
    let width: usize = (0..matrix.len())
        .map(|k| entries.iter().map(|row| row[k].width()).max().unwrap_or(0) + 3)
        .sum();
    let left = Math::Letter(Letter::bold("M"));
    if width <= WIDEST_MATRIX {
        let whole = Equation::new(left, Math::Matrix(entries)).about(About::Bodies);
        return with(w, "", vec![whole]);
    }
    let mut equations = Vec::new();
    let mut pattern = entries.clone();
    for (i, row) in entries.into_iter().enumerate() {
        for (j, entry) in row.into_iter().enumerate() {
            if entry.width() <= 3 {
                continue;
            }
            let (first, second) = (i.min(j), i.max(j));
            let place = if matrix.len() > 9 {
                format!("{},{}", first + 1, second + 1)
            } else {
                format!("{}{}", first + 1, second + 1)
            };
            let letter = Math::Letter(Letter::plain("M").below(&place));
            pattern[i][j] = letter.clone();
            if j >= i {
                equations.push(Equation::new(letter, entry).about(About::Inertia(i, j)));
            }
        }
    }
    let mut blocks = w.definitions();
    let whole = Equation::new(left, Math::Matrix(pattern)).about(About::Bodies);
    blocks.push(Block::Equations(vec![whole]));
    blocks.push(Block::Equations(equations));
    blocks
}

/// Which accelerations the mass matrix couples.
fn couplings(w: &mut Writer<'_>, matrix: &[Vec<Expr>]) -> Vec<Span> {
    let blocks = independent_blocks(matrix);
    let mut text = vec![words("M is symmetric and positive definite. ")];
    if blocks.len() == 1 {
        if matrix.len() > 1 {
            text.push(words("It couples all accelerations."));
        }
        return text;
    }
    let groups: Vec<Vec<Span>> = blocks
        .iter()
        .map(|block| {
            let letters = block
                .iter()
                .map(|&k| vec![math(Math::Letter(w.speed(k).dot()))])
                .collect();
            listed(letters)
        })
        .collect();
    text.push(words(&format!(
        "It consists of {} independent blocks: ",
        groups.len()
    )));
    for (k, group) in groups.into_iter().enumerate() {
        if k > 0 {
            text.push(words("; "));
        }
        text.extend(group);
    }
    text.push(words("."));
    text
}

/// `b₁`, `Π₂`: a quantity of one pseudo-velocity.
pub(super) fn numbered(name: &str, index: usize) -> Math {
    Math::Letter(Letter::plain(name).below(&(index + 1).to_string()))
}
