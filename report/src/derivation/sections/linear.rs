//! Jacobians of the motion; the linear equations about a steady motion, and their characteristic polynomial.

use appell_codegen::linearisation::{Characteristic, Linearisation};
use appell_codegen::symbolic::{Expr, Graph};

use super::super::{Block, Equation, Letter, Math, Section, Span, Writer};
use super::equations::raised;
use super::phrases::{formula, headed, listed, math, sentence, with, with_formulas, words};

/// Largest number of columns of a matrix that is shown as a whole.
const MOST_COLUMNS: usize = 10;
/// Longer coefficients of the characteristic polynomial are written in the entries of A.
const LONGEST_COEFFICIENT: usize = 320;

/// Essential and ignorable states, and the conditions of the steady motion.
pub(super) fn steady(w: &mut Writer<'_>, linear: &Linearisation) -> Section {
    let (essential, ignorable) = linear.states.split_at(linear.essential);
    let mut states = vec![words("The motion depends on the essential states ")];
    states.extend(letters(w, essential));
    if !ignorable.is_empty() {
        states.push(words("; "));
        states.extend(letters(w, ignorable));
    }
    states.push(words(match ignorable.len() {
        0 => ".",
        1 => " is ignorable: they do not depend on it.",
        _ => " are ignorable: they do not depend on them.",
    }));
    let mut blocks = vec![Block::Sentence(states)];
    let values = told(w, linear).into_iter().filter_map(|symbol| {
        let mut known = linear.steady.values.iter();
        let &(_, value) = known.find(|known| known.0 == symbol)?;
        Some(Equation::new(w.symbol(symbol), w.explicit(value)))
    });
    let values = values.collect();
    blocks.extend(with(w, "Along the motion", values));
    let mut conditions = Vec::new();
    for &rate in linear.rates.iter().filter(|&&rate| rate != Graph::ZERO) {
        let (over, _) = w.graph().split_fraction(rate);
        let (_, over) = w.graph().split_coefficient(over);
        conditions.push(Equation::new(w.explicit(over), Math::zero()));
    }
    if conditions.is_empty() {
        blocks.push(sentence("It is steady."));
    }
    blocks.extend(with(w, "It is steady where", conditions));
    headed("Steady motion", blocks)
}

/// Quantities whose values are stated, in order, without the zero rates of constant coordinates.
fn told(w: &Writer<'_>, linear: &Linearisation) -> Vec<Expr> {
    let symbols = &w.derivation.symbols;
    let (essential, _) = linear.states.split_at(linear.essential);
    let rates = symbols.coordinates.iter().zip(&symbols.rates);
    let rates = rates.filter(|(coordinate, _)| !essential.contains(coordinate));
    let rates: Vec<Expr> = rates.map(|(_, &rate)| rate).collect();
    [linear.states.as_slice(), &rates, &linear.inputs].concat()
}

/// `a, b and c`
fn letters(w: &mut Writer<'_>, symbols: &[Expr]) -> Vec<Span> {
    listed(symbols.iter().map(|&s| vec![math(w.symbol(s))]).collect())
}

/// A and B, entry by entry.
pub(super) fn equations(w: &mut Writer<'_>, linear: &Linearisation) -> Section {
    let mut blocks = vec![rule(w, linear)];
    for (name, rows) in [("A", &linear.a), ("B", &linear.b)] {
        let columns = rows.first().map_or(0, Vec::len);
        if columns == 0 {
            continue;
        }
        let mut equations = Vec::new();
        // A single column needs no display.
        let whole = (2..=MOST_COLUMNS).contains(&columns) && rows.len() <= MOST_COLUMNS;
        let mut cells = Vec::with_capacity(rows.len());
        for (i, row) in rows.iter().enumerate() {
            let mut line = Vec::with_capacity(columns);
            for (j, &entry) in row.iter().enumerate() {
                let cell = Math::Letter(numbered(name, &[i, j]));
                if entry == Graph::ZERO || whole && w.graph().as_number(entry).is_some() {
                    line.push(w.set(entry));
                    continue;
                }
                let right = w.explicit(entry);
                equations.push(Equation::new(cell.clone(), right));
                line.push(cell);
            }
            cells.push(line);
        }
        if whole {
            let matrix = Equation::new(Math::Letter(Letter::bold(name)), Math::Matrix(cells));
            blocks.push(Block::Equations(vec![matrix]));
        }
        let lead = if whole {
            "with"
        } else {
            "Entries not listed are zero."
        };
        blocks.extend(with(w, lead, equations));
    }
    headed("Linear equations about the steady motion", blocks)
}

/// `δẋ = A δx + B δu`, with definitions of x and u.
fn rule(w: &mut Writer<'_>, linear: &Linearisation) -> Block {
    let rate = Math::Letter(Letter::bold("x").dot().before('δ'));
    let mut right = vec![(false, formula("*A δ*x"))];
    if !linear.inputs.is_empty() {
        right.push((false, formula("*B δ*u")));
    }
    let equation = Math::Row(vec![rate, Math::Sign("="), Math::sum(right)]);
    let mut text = vec![
        words("Small deviations δ from the motion obey "),
        math(equation),
        words(" with the states "),
    ];
    text.extend(letters(w, &linear.states));
    if !linear.inputs.is_empty() {
        let plural = if linear.inputs.len() == 1 { "" } else { "s" };
        text.push(words(&format!(" and the input{plural} ")));
        text.extend(letters(w, &linear.inputs));
    }
    text.push(words(", in this order."));
    if !w.derivation.positions.dependent.is_empty() {
        text.push(words(
            " Dependent coordinates of position constraints are treated as free here.",
        ));
    }
    Block::Sentence(text)
}

/// The polynomial whose zeros are the eigenvalues of the essential states.
pub(super) fn characteristic(w: &mut Writer<'_>, polynomial: &Characteristic) -> Section {
    let left = Math::Letter(Letter::plain("χ"));
    let mut equations = vec![Equation::new(left, factored(polynomial))];
    for (k, &value) in polynomial.coefficients.iter().enumerate().skip(1) {
        if value == Graph::ZERO {
            continue;
        }
        let letter = Math::Letter(numbered("χ", &[k - 1]));
        let in_entries = w.set(polynomial.in_entries[k]);
        let explicit = w.try_explicit(value);
        if in_entries != explicit {
            equations.push(Equation::new(letter.clone(), in_entries));
        }
        if explicit.width() <= LONGEST_COEFFICIENT {
            equations.push(Equation::new(letter, explicit));
        }
    }
    let lead = format!(
        "Of the first {} rows and columns of A, those of the essential states:",
        polynomial.degree
    );
    let blocks = with(w, &lead, equations);
    headed("Characteristic polynomial", blocks)
}

/// `λᶻ (λⁿ⁻ᶻ + c₁ λⁿ⁻ᶻ⁻¹ + …)`, without vanishing coefficients.
fn factored(polynomial: &Characteristic) -> Math {
    let zeros = polynomial.zeros();
    let degree = polynomial.degree - zeros;
    let mut terms = Vec::new();
    for (k, &value) in polynomial.coefficients.iter().enumerate().take(degree + 1) {
        if value == Graph::ZERO {
            continue;
        }
        let coefficient = (k > 0).then(|| Math::Letter(numbered("χ", &[k - 1])));
        let factors: Vec<Math> = coefficient.into_iter().chain(power(degree - k)).collect();
        let term = if factors.is_empty() {
            Math::integer(1)
        } else {
            Math::product(factors)
        };
        terms.push((false, term));
    }
    let factors = power(zeros).into_iter().chain([Math::sum(terms)]);
    Math::product(factors.collect())
}

/// A power of λ other than 1.
fn power(exponent: usize) -> Option<Math> {
    let letter = Math::Letter(Letter::plain("λ"));
    match exponent {
        0 => None,
        1 => Some(letter),
        _ => Some(raised(letter, exponent)),
    }
}

/// A letter with numbers below, from 1.
fn numbered(name: &str, indices: &[usize]) -> Letter {
    let letter = Letter::plain(name);
    let indices = indices.iter().map(|index| (index + 1).to_string());
    indices.fold(letter, |letter, index| letter.below(&index))
}

/// The derivatives of the residual ρ, those of ω̇ that follow, and those of q̇.
pub(super) fn jacobians(w: &mut Writer<'_>) -> Section {
    let mut blocks = vec![residual_rule()];
    let symbols = w.derivation.symbols.clone();
    let signals: Vec<Expr> = symbols.signals.iter().flatten().copied().collect();
    let lists = [
        (
            "With respect to the state, for A:",
            [symbols.speeds.clone(), symbols.coordinates.clone()].concat(),
        ),
        (
            "With respect to the inputs, for B:",
            [symbols.inputs.clone(), signals].concat(),
        ),
        (
            "With respect to the parameters, for P:",
            symbols.parameters.clone(),
        ),
    ];
    let mut rows = residual(w);
    let rates = w.derivation.velocities.rates.clone();
    rows.extend((symbols.rates.iter().zip(rates)).map(|(&rate, value)| (w.letter(rate), value)));
    for (lead, variables) in lists {
        let mut equations = Vec::new();
        for (letter, value) in &rows {
            for &variable in &variables {
                let entry = w.derivation.algebra.derivative(*value, variable);
                let entry = w.derivation.algebra.shortest(entry);
                if entry != Graph::ZERO {
                    let by = w.letter(variable);
                    let right = w.explicit(entry);
                    equations.push(Equation::new(Math::partial(letter.clone(), by), right));
                }
            }
        }
        blocks.extend(with(w, lead, equations));
    }
    headed("Jacobians", blocks)
}

/// The differentiated residual, and the equations of the derivatives.
fn residual_rule() -> Block {
    let bold = |name: &str| Math::Letter(Letter::bold(name));
    let terms = vec![
        (false, bold("Π")),
        (true, bold("b")),
        (true, formula("*M *ω'")),
    ];
    let residual = Math::Row(vec![bold("ρ"), Math::Sign("="), Math::sum(terms)]);
    with_formulas(
        "By Appell's equations {} vanishes. Differentiation with respect to a state, an input or a parameter z \
         gives {}, where ρ is differentiated at constant accelerations. It is solved like the equations of motion. \
         Entries not listed are zero.",
        [residual, formula("*M ∂*ω'/∂z = ∂*ρ/∂z")],
    )
}

/// ρ = Π - b - M ω̇, with letters for the accelerations.
fn residual(w: &mut Writer<'_>) -> Vec<(Letter, Expr)> {
    let accelerations = w.derivation.symbols.accelerations.clone();
    let gibbs = w.derivation.gibbs.clone();
    let forces = w.derivation.forces.clone();
    let mut rows = Vec::with_capacity(forces.len());
    for (i, (&force, &bias)) in forces.iter().zip(&gibbs.bias).enumerate() {
        let graph = w.graph();
        let mut parts = vec![force, graph.neg(bias)];
        for (&entry, &acceleration) in gibbs.mass_matrix[i].iter().zip(&accelerations) {
            let inertial = graph.mul(entry, acceleration);
            parts.push(graph.neg(inertial));
        }
        rows.push((
            Letter::plain("ρ").below(&(i + 1).to_string()),
            graph.sum(&parts),
        ));
    }
    rows
}
