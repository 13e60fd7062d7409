//! The acceleration energy and its derivatives.

use super::super::{About, Block, Equation, Letter, Math, Section, Span, Writer};
use super::phrases::{formula, headed, listed, math, with, with_formulas, words};
use appell_codegen::mechanics::gibbs_appell::{BodyMotion, gibbs_form};
use appell_codegen::mechanics::motion::independent_blocks;
use appell_codegen::symbolic::{Expr, Graph, Rational};

/// A matrix wider than this shows letters, and its entries follow as equations.
const WIDEST_MATRIX: usize = 82;

/// S, body by body.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let whole = ["½ m *a · *a", "½ *α · { *J *α }", "*α · ( *ω × *J *ω )"];
    let whole = whole.map(|term| (false, formula(term))).to_vec();
    let definition = Math::Row(vec![
        Math::Letter(Letter::plain("S")),
        Math::Sign("="),
        Math::Sign("Σ"),
        Math::Brackets(Box::new(Math::sum(whole))),
    ]);
    let mut blocks = vec![with_formulas(
        "The sum runs over the bodies: {}. Terms without accelerations are omitted; the derivatives do not contain \
         them.",
        [definition],
    )];
    let mut equations = Vec::new();
    let bodies = w.derivation.bodies.clone();
    for (id, body) in w.mechanism.bodies.ids().zip(bodies) {
        let s = energy_of(w, &body);
        let right = w.by_acceleration(s);
        let left = Letter::plain("S").below(&body.name);
        equations.push(Equation::new(Math::Letter(left), right).about(About::Body(id)));
    }
    blocks.extend(with(w, "", equations));
    headed("Acceleration energy S", blocks)
}

/// `½ ω̇ᵀ M ω̇ + bᵀ ω̇` of one body.
fn energy_of(w: &mut Writer<'_>, body: &BodyMotion) -> Expr {
    let accelerations = w.derivation.symbols.accelerations.clone();
    let bodies = std::slice::from_ref(body);
    let form = gibbs_form(&mut w.derivation.algebra, bodies, accelerations.len());
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
    let heading = math(formula("∂S/∂*ω' = *M *ω' + *b"));
    Section {
        heading: vec![words("Mass matrix and bias: "), heading],
        blocks,
    }
}

fn matrix_blocks(w: &mut Writer<'_>, matrix: &[Vec<Expr>]) -> Vec<Block> {
    let mut shown = |&entry: &Expr| match entry {
        Graph::ZERO => Math::zero(),
        entry => w.explicit(entry),
    };
    let rows = matrix.iter();
    let entries: Vec<Vec<Math>> = rows
        .map(|row| row.iter().map(&mut shown).collect())
        .collect();
    let widest = |column: usize| entries.iter().map(|row| row[column].width()).max();
    let width: usize = (0..matrix.len()).map(|k| widest(k).unwrap_or(0) + 3).sum();
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
            let (first, second) = (i.min(j) + 1, i.max(j) + 1);
            let comma = if matrix.len() > 9 { "," } else { "" };
            let place = format!("{first}{comma}{second}");
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
    text.push(words(&format!(
        "It consists of {} independent blocks: ",
        blocks.len()
    )));
    for (k, block) in blocks.iter().enumerate() {
        if k > 0 {
            text.push(words("; "));
        }
        let letter = |&k: &usize| vec![math(Math::Letter(w.speed(k).dot()))];
        text.extend(listed(block.iter().map(letter).collect()));
    }
    text.push(words("."));
    text
}

/// `b₁`, `Π₂`: a quantity of one pseudo-velocity.
pub(super) fn numbered(name: &str, index: usize) -> Math {
    Math::Letter(Letter::plain(name).below(&(index + 1).to_string()))
}
