//! Glossary of the names of a derivation, for readers of emitted functions.

use appell_spec::mechanism::{ConstraintKind, FrameId, Mechanism};
use appell_spec::units::Unit;

use super::constraints::Constraints;
use super::gibbs_appell::BodyMotion;
use super::kinematics::Kinematics;
use super::letters;
use super::motion::{Block, Motion};
use super::row::Row;
use crate::program::{Group, Names, Term};

/// Names of intermediate quantities in the solution of Appell's equations and its derivatives.
pub fn of_solution(mechanism: &Mechanism, motion: &Motion) -> Vec<Term> {
    let mut terms = Vec::new();
    let any = |kind: fn(&Block) -> bool| motion.blocks.iter().any(kind);
    let (alone, together) = (
        any(|block| matches!(block, Block::Eliminated(_))),
        any(|block| matches!(block, Block::Factorized(_))),
    );
    terms.push(term(
        "rhs",
        if alone {
            "`Π − b` after elimination, times the common denominator in `pivot`."
        } else {
            "`Π − b`."
        },
    ));
    if alone {
        terms.extend(divided(mechanism));
        terms.push(term(
            "pivot",
            "what divides `rhs`: `ω̇ = rhs/pivot`, plus terms that need no division.",
        ));
        terms.push(term(
            "rhs_over_pivot",
            "`rhs/pivot` where `ω̇` has further terms.",
        ));
    }
    let (lower, forward) = (letters::lower(mechanism), letters::forward(mechanism));
    if together {
        let (mass, diagonal) = (letters::mass(mechanism), letters::diagonal(mechanism));
        let factors = format!("`{mass} = {lower} {diagonal} {lower}ᵀ`");
        let unit = format!("the factor of {factors}, unit triangular in the order of elimination.");
        let beside = format!("the diagonal of {factors}, and `{lower} {diagonal}` beside it.");
        terms.extend([
            term(mass, "entries of the mass matrix."),
            term(lower, &unit),
            term(diagonal, &beside),
            term(forward, &format!("what solves `{lower} {forward} = rhs`.")),
        ]);
    }
    let rho = match (alone, together) {
        (true, false) => "`rho = rhs − pivot ω̇`, ω̇ less its further terms,",
        (false, _) => "`rho = rhs − M ω̇`",
        (true, true) => "`rho = rhs − pivot ω̇`, ω̇ less its further terms, or `rhs − M ω̇`,",
    };
    terms.extend([
        term("d_rhs", "derivatives of `rhs`."),
        term("d_pivot", "derivatives of `pivot`."),
        term("d_rho", &format!("derivatives of {rho} with ω̇ held.")),
        term("d_z", &format!("what solves `{lower} d_z = d_rho`.")),
    ]);
    terms
}

/// Names of right-hand sides that are already divided by a parameter.
fn divided(mechanism: &Mechanism) -> impl Iterator<Item = Term> {
    mechanism.pseudo_velocities.iter().flat_map(|speed| {
        let speed = &speed.label.name;
        mechanism.parameters.iter().map(move |parameter| {
            let parameter = &parameter.label.name;
            Term {
                symbol: format!("rhs_{speed}_over_{parameter}"),
                names: Names::Alone,
                meaning: format!("already divided by `{parameter}`."),
            }
        })
    })
}

/// Names of the motions of frames and bodies.
pub fn of_motions(
    mechanism: &Mechanism,
    kinematics: &Kinematics,
    bodies: &[BodyMotion],
) -> Vec<Term> {
    let frame = |id: FrameId| &mechanism.frames[id].name;
    let mut terms = Vec::new();
    for (id, known) in mechanism.frames.entries() {
        let along = frame(kinematics.frames.angular_velocity(id).frame);
        let meaning = format!("angular velocity of `{}`, along `{along}`.", known.name);
        terms.push(vector("w", &known.name, meaning));
    }
    for body in bodies {
        let (point, along) = (&body.centre.point, frame(body.centre.velocity.frame));
        terms.push(vector(
            "v",
            point,
            format!("velocity of `{point}`, along `{along}`."),
        ));
        terms.push(vector(
            "a0",
            point,
            format!("acceleration of `{point}` where ω̇ = 0, along `{along}`."),
        ));
        if let Some(rotation) = &body.rotation {
            let (name, along) = (&body.name, frame(rotation.velocity.frame));
            let meaning =
                format!("rate of the angular momentum of `{name}` where ω̇ = 0, along `{along}`.");
            terms.push(vector("h0", name, meaning));
        }
    }
    terms
}

/// Headings for the motions of frames and bodies, named as in [`of_motions`].
pub fn groups_of_motions(mechanism: &Mechanism, bodies: &[BodyMotion]) -> Vec<Group> {
    let frames = mechanism.frames.iter();
    let mut groups = vec![Group {
        title: "Angular velocities.".to_owned(),
        names: frames.map(|frame| axes("w", &frame.name)).collect(),
    }];
    groups.extend(bodies.iter().map(|body| {
        let mut names = vec![
            axes("v", &body.centre.point),
            axes("a0", &body.centre.point),
        ];
        names.extend(body.rotation.iter().map(|_| axes("h0", &body.name)));
        Group {
            title: format!("Motion of `{}` with ω̇ = 0.", body.name),
            names,
        }
    }));
    groups
}

/// Headings for the solution, unknown by unknown.
pub fn groups_of_solution(mechanism: &Mechanism, motion: &Motion) -> Vec<Group> {
    let speeds = mechanism.pseudo_velocities.iter();
    let speeds: Vec<&str> = speeds.map(|w| w.label.name.as_str()).collect();
    let [mass, lower, diagonal, forward] = [
        letters::mass,
        letters::lower,
        letters::diagonal,
        letters::forward,
    ]
    .map(|letter| letter(mechanism));
    let alone = |symbol: &str, speed: usize| (format!("{symbol}_{}", speeds[speed]), Names::Alone);
    let solved = |speed: usize| (format!("{}_dot", speeds[speed]), Names::Alone);
    let mut groups = Vec::new();
    for block in &motion.blocks {
        match block {
            Block::Eliminated(equations) => groups.extend(equations.iter().map(|equation| {
                let speed = equation.speed;
                Group {
                    title: format!("Unknown `{}_dot`.", speeds[speed]),
                    names: vec![
                        alone("pivot", speed),
                        (format!("rhs_{}", speeds[speed]), Names::Any),
                        alone("rhs_over_pivot", speed),
                        solved(speed),
                    ],
                }
            })),
            Block::Factorized(block) => {
                for (place, &speed) in block.speeds.iter().enumerate() {
                    let mut names = vec![
                        alone(diagonal, speed),
                        alone("rhs", speed),
                        alone(forward, speed),
                    ];
                    for &later in &block.speeds[place + 1..] {
                        let pair = format!("{}_{}", speeds[later], speeds[speed]);
                        names.extend(
                            [lower, diagonal].map(|s| (format!("{s}_{pair}"), Names::Alone)),
                        );
                    }
                    for &other in &block.speeds[place..] {
                        let mut pair = [speeds[speed], speeds[other]];
                        let place = |name| speeds.iter().position(|&other| other == name);
                        pair.sort_by_key(|name| place(*name));
                        names.push((format!("{mass}_{}_{}", pair[0], pair[1]), Names::Alone));
                    }
                    groups.push(Group {
                        title: format!("Elimination of `{}_dot`.", speeds[speed]),
                        names,
                    });
                }
                groups.extend(block.speeds.iter().rev().map(|&speed| Group {
                    title: format!("Unknown `{}_dot`.", speeds[speed]),
                    names: vec![solved(speed)],
                }));
            }
        }
    }
    groups
}

fn axes(letter: &str, of: &str) -> (String, Names) {
    (format!("{letter}_{of}"), Names::Axes)
}

/// Names of the constraint rows that geometry does not embed, with their units.
pub fn of_rows(mechanism: &Mechanism, constraints: &Constraints) -> Vec<Term> {
    each_constraint(constraints, |row| !row.is_embedded())
        .map(|row| {
            let name = &mechanism.constraints[row.constraint].name;
            let unit = unit_of_row(&mechanism.constraints[row.constraint].kind);
            let meaning = format!("what constraint `{name}` demands to be zero, in `{unit}`.");
            term(&format!("residual_{name}"), &meaning)
        })
        .collect()
}

/// Names of the multipliers, reactions without a point.
pub fn of_multipliers(mechanism: &Mechanism, constraints: &Constraints) -> Vec<Term> {
    let without_point = |row: &Row| {
        let kind = &mechanism.constraints[row.constraint].kind;
        matches!(
            kind,
            ConstraintKind::Velocity { .. } | ConstraintKind::Position { .. }
        )
    };
    each_constraint(constraints, without_point)
        .filter_map(|row| {
            let constraint = &mechanism.constraints[row.constraint];
            let unit = unit_of_row(&constraint.kind);
            let name = &constraint.name;
            let meaning = format!(
                "the multiplier of constraint `{name}`, in the x component, in W per `{unit}`."
            );
            let place = &constraints.reactions[constraints.reported(row)?].name;
            Some(vector(letters::reaction(mechanism), place, meaning))
        })
        .collect()
}

/// The first row of each constraint with such rows.
fn each_constraint(
    constraints: &Constraints,
    such: impl Fn(&Row) -> bool,
) -> impl Iterator<Item = &Row> {
    let mut told = Vec::new();
    constraints.rows.iter().filter(move |row| {
        let first = such(row) && !told.contains(&row.constraint);
        told.push(row.constraint);
        first
    })
}

/// Unit of a constraint's equations at velocity level.
fn unit_of_row(kind: &ConstraintKind) -> String {
    let dimension = kind.rate_dimension();
    dimension.map_or_else(String::new, |dimension| Unit::si(dimension).text)
}

/// Weights of the adjoints.
pub fn of_weights() -> Vec<Term> {
    vec![term(
        "adjoint",
        "a derivative of the weighted sum with respect to an intermediate value.",
    )]
}

fn term(symbol: &str, meaning: &str) -> Term {
    Term {
        symbol: symbol.to_owned(),
        names: Names::Any,
        meaning: meaning.to_owned(),
    }
}

fn vector(letter: &str, of: &str, meaning: String) -> Term {
    Term {
        symbol: format!("{letter}_{of}"),
        names: Names::Axes,
        meaning,
    }
}
