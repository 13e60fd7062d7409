//! Equations whose content are numbers: circles, critical values, ranks, poles.

use crate::steering::OUTPUTS;
use appell_analysis::control::controllability::{Controllability, output_rank};
use appell_analysis::{Branch, Change, Kind, Special, circle};
use appell_spectra::spectrum::characteristic_polynomial;

use super::figure_5::place_in_spinning;
use super::manoeuvres::Path;
use super::tables::{POLE, placed, steered, straight};
use crate::book::claim::{Claim, Section, Statement, digits};
use crate::book::computation;
use crate::book::steady_motions::{GRAVITY, Mechanism, RADIUS, SLIDER_MASS, WHEEL_MASS, values};
use appell::Error;

/// Changes of stability by a real eigenvalue.
fn is_critical(special: &Special) -> bool {
    special.kind == Kind::Critical(Change::RealZero)
}

/// A tilt at which the turning wheel has two critical yaw rates, in degrees.
const TILT: f64 = 10.0;

/// The numbers.
pub(super) fn section() -> Result<Section, Error> {
    let mut claims = Vec::new();
    circles(&mut claims)?;
    wheel(&mut claims)?;
    unicycle(&mut claims)?;
    reach(&mut claims)?;
    references(&mut claims);
    Ok(Section {
        title: "Numbers behind equations".to_owned(),
        about: "Critical values come from the general tracer, which knows no formula: it follows the \
                steady motions and finds where a real eigenvalue passes through zero. The published \
                formula is evaluated with the numbers of table I beside it."
            .to_owned(),
        claims,
        pictures: Vec::new(),
    })
}

/// (11), (12): a turning motion draws circles.
fn circles(claims: &mut Vec<Claim>) -> Result<(), Error> {
    let command = "appell steady rolling_wheel --fix theta=10deg --fix psi_dot=2";
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let (tilt, turn) = (TILT.to_radians(), 2.0);
    let problem = wheel.problem(&[("theta", tilt), ("psi_dot", turn)])?;
    let motion = problem.solve().map_err(computation)?;
    let spin = wheel.value("phi_dot", &motion.point)?;
    for (place, text, names, wanted) in [
        (
            "(11)",
            "ρ_G = |φ̇/ψ̇ + sin ϑ| R",
            ["x_G", "y_G"],
            spin / turn + tilt.sin(),
        ),
        ("(12)", "ρ_P = |φ̇/ψ̇| R", ["x_P", "y_P"], spin / turn),
    ] {
        let [x, y] = names.map(|name| wheel.term(name));
        let path = circle(wheel.0, &motion.point, [x?, y?]);
        let published = format!("{text}, here at ϑ = 10°, ψ̇ = 2 rad/s, in m");
        let pair = [wanted.abs() * RADIUS, path.radius];
        claims.push(
            Statement {
                place,
                published: &published,
                command,
            }
            .number(pair, 10),
        );
    }
    Ok(())
}

/// (22) to (31): critical rates of the wheel.
fn wheel(claims: &mut Vec<Claim>) -> Result<(), Error> {
    let wheel = Mechanism::shipped("rolling_wheel")?;
    let tilt = TILT.to_radians();
    let turning = wheel.branches(&[("theta", tilt)], "psi_dot", [0.5, 12.0])?;
    let rates = values(&turning, is_critical);
    let (s, c) = (tilt.sin().powi(2), tilt.cos());
    let root = (76.0 * s * s - 96.0 * s + 9.0).sqrt();
    for (index, sign) in [(0, 1.0), (1, -1.0)] {
        let square = (3.0 - 6.0 * c * c + sign * root) / ((2.0 * s - 3.0) * c);
        let wanted = (2.0 * GRAVITY / (5.0 * RADIUS) * square).sqrt();
        let published = format!("critical yaw rate {}, here at ϑ = 10°, in rad/s", index + 1);
        let ours = rates.get(index).copied().unwrap_or(f64::NAN);
        let command = "appell stability rolling_wheel --fix theta=10deg --along psi_dot=0.5..12";
        claims.push(
            Statement {
                place: "(22)",
                published: &published,
                command,
            }
            .number([wanted, ours], 12),
        );
    }
    upright_wheel(claims, wheel)
}

/// The first critical value on branches; NaN without one.
fn first_critical(branches: &[Branch]) -> f64 {
    let critical = values(branches, is_critical);
    critical.first().copied().unwrap_or(f64::NAN)
}

/// (27), (31): straight rolling and spinning of the wheel.
fn upright_wheel(claims: &mut Vec<Claim>, wheel: Mechanism) -> Result<(), Error> {
    let upright = [("psi_dot", 0.0), ("theta", 0.0)];
    let rolling = wheel.branches(&upright, "phi_dot", [0.5, 10.0])?;
    let statement = Statement {
        place: "(27)",
        published: "φ̇_crit = √(g/(3R)), in rad/s",
        command: "appell stability rolling_wheel --fix psi_dot=0 --fix theta=0 --along phi_dot=0.5..10",
    };
    let wanted = (GRAVITY / (3.0 * RADIUS)).sqrt();
    claims.push(statement.number([wanted, first_critical(&rolling)], 12));

    let rolling = wheel.branches(&upright, "speed", [0.1, 3.0])?;
    let statement = Statement {
        place: "after (27)",
        published: "the critical velocity φ̇_crit R, in m/s",
        command: "appell stability rolling_wheel --fix psi_dot=0 --fix theta=0 --along speed=0.1..3",
    };
    let wanted = (GRAVITY * RADIUS / 3.0).sqrt();
    claims.push(statement.number([wanted, first_critical(&rolling)], 12));

    let spinning = wheel.branches(&[("phi_dot", 0.0)], "psi_dot", [0.5, 10.0])?;
    let statement = Statement {
        place: "(31)",
        published: "ψ̇_crit = √(4g/(5R)), in rad/s",
        command: "appell stability rolling_wheel --fix phi_dot=0 --along psi_dot=0.5..10",
    };
    let wanted = (4.0 * GRAVITY / (5.0 * RADIUS)).sqrt();
    claims.push(statement.number([wanted, first_critical(&spinning)], 12));
    Ok(())
}

/// (42), (46), (54): the unicycle.
fn unicycle(claims: &mut Vec<Claim>) -> Result<(), Error> {
    let unicycle = Mechanism::shipped("unicycle")?;
    let tilt = TILT.to_radians();
    let excluded =
        (2.0 * SLIDER_MASS * GRAVITY / (3.0 * WHEEL_MASS * RADIUS * tilt.cos().powi(3))).sqrt();
    let none = unicycle.has_none(&[("theta", tilt), ("psi_dot", excluded)], 60)?;
    let ours = if none {
        "no steady motion is found at ϑ = 10°"
    } else {
        "a steady motion is found"
    };
    let command = format!("appell steady unicycle --fix theta=10deg --fix psi_dot={excluded}");
    claims.push(
        Statement {
            place: "(42)",
            published: "at ψ̇² = 2 m₀ g/(3 m R cos³ϑ) there is no tilted steady motion",
            command: &command,
        }
        .found(ours, none),
    );
    // (46), tilted spinning at a tilt.
    let problem = unicycle.problem(&[("theta", tilt), ("phi_dot", 0.0)])?;
    let motions = problem.solve_isolated(60).map_err(computation)?;
    let command = "appell steady unicycle --fix theta=10deg --fix phi_dot=0";
    let place = |motion: &appell_analysis::SteadyMotion| unicycle.value("r", &motion.point);
    let places: Vec<f64> = motions.iter().map(place).collect::<Result<_, _>>()?;
    let ours = places.first().copied().unwrap_or(f64::NAN);
    let published = "place of the mass in tilted spinning, here at ϑ = 10°, in m";
    claims.push(
        Statement {
            place: "(46)",
            published,
            command,
        }
        .number([place_in_spinning(tilt), ours], 10),
    );
    let above = !places.is_empty() && places.iter().all(|r| r * tilt > 0.0);
    let ours = format!("r ϑ > 0 in all {} motions found", places.len());
    let published = "the point mass is always above the wheel centre";
    claims.push(
        Statement {
            place: "after (46)",
            published,
            command,
        }
        .found(ours, above),
    );

    straight_unicycle(claims, unicycle)
}

/// (54) and section IV.B: straight rolling of the unicycle.
fn straight_unicycle(claims: &mut Vec<Claim>, unicycle: Mechanism) -> Result<(), Error> {
    let rolling = unicycle.branches(&[("psi_dot", 0.0)], "phi_dot", [0.5, 10.0])?;
    let statement = Statement {
        place: "(54)",
        published: "φ̇_crit = √(g/(2R)), in rad/s",
        command: "appell stability unicycle --fix psi_dot=0 --along phi_dot=0.5..10",
    };
    let wanted = (GRAVITY / (2.0 * RADIUS)).sqrt();
    claims.push(statement.number([wanted, first_critical(&rolling)], 12));

    let rolling = unicycle.branches(&[("psi_dot", 0.0)], "speed", [0.1, 3.0])?;
    let critical = first_critical(&rolling);
    let statement = |published| Statement {
        place: "section IV.B",
        published,
        command: "appell stability unicycle --fix psi_dot=0 --along speed=0.1..3",
    };
    let printed = statement("the critical speed is 1.21 m/s");
    claims.push(printed.number([1.21, critical], 3));
    let formula = statement("the critical speed is √(R g/2), in m/s");
    let wanted = (RADIUS * GRAVITY / 2.0).sqrt();
    claims.push(formula.number([wanted, critical], 12));
    Ok(())
}

/// (56), (57), (63), (67): controllability.
fn reach(claims: &mut Vec<Claim>) -> Result<(), Error> {
    let (mut ranks, mut lane, mut turn) = (Vec::new(), Vec::new(), Vec::new());
    for speed in [1.0, 5.0] {
        let (equations, outputs) = straight(speed, &OUTPUTS)?;
        ranks.push(
            Controllability::of(&equations.system)
                .map_err(computation)?
                .rank,
        );
        lane.push(output_rank(&equations.system, &outputs));
        turn.push(output_rank(&equations.system, &outputs[..5]));
    }
    let command = "appell control unicycle --at 'omega_2=5[m/s]/R'";
    let mut rank = |place: &str, what: &str, found: &[usize], wanted: usize| {
        let holds = found.iter().all(|rank| *rank == wanted);
        let ours = format!("{found:?} at 1 and 5 m/s");
        claims.push(
            Statement {
                place,
                published: what,
                command,
            }
            .found(ours, holds)
            .exactly(),
        );
    };
    rank("(56), (57)", "rank M_c = 6 of 10", &ranks, 6);
    rank(
        "(63)",
        "rank M_oc = 6: six outputs are controllable",
        &lane,
        6,
    );
    rank(
        "after (69)",
        "rank M_oc = 5: five outputs are controllable",
        &turn,
        5,
    );
    for outputs in [&OUTPUTS[..], &OUTPUTS[..5]] {
        let mut worst = 15;
        for speed in [1.0, 5.0] {
            let closed = steered(speed, outputs)?
                .system
                .closed(&placed(speed, outputs)?);
            let found = characteristic_polynomial(&closed).map_err(computation)?;
            // (λ + 8)ⁿ
            let times = |polynomial: Vec<f64>, _: &&str| {
                let padded = polynomial.iter().chain(&[0.0]);
                let shifted = [0.0].iter().chain(&polynomial);
                padded.zip(shifted).map(|(a, b)| a - POLE * b).collect()
            };
            let wanted: Vec<f64> = outputs.iter().fold(vec![1.0], times);
            let pairs = wanted.iter().zip(&found);
            worst = pairs.fold(worst, |worst, (a, b)| worst.min(digits(*a, *b)));
        }
        let published = format!("all {} poles at −8 1/s at both speeds", outputs.len());
        let ours = format!("coefficients of the characteristic polynomial agree in {worst} digits");
        let command = "appell control unicycle --at 'omega_2=5[m/s]/R' --poles -8";
        let claim = Statement {
            place: "(67)",
            published: &published,
            command,
        }
        .found(ours, worst >= 9);
        claims.push(claim.noted(format!("{worst} digits agree")));
    }
    Ok(())
}

/// (66), (71): the desired paths.
fn references(claims: &mut Vec<Claim>) {
    let printed_lane = Path {
        amplitude: 10.0,
        ..Path::lane(10.0)
    };
    let printed_turn = Path {
        end: -Path::TURN.end,
        ..Path::TURN
    };
    for (place, printed, right, unit) in [
        ("(66)", printed_lane, Path::lane(10.0), "m"),
        ("(71)", printed_turn, Path::TURN, "rad"),
    ] {
        let [before, after] = [printed.jump(), right.jump()];
        let published = "the desired path is continuous at 7 s";
        let ours = format!(
            "as printed it jumps by {before:.2} {unit}, as corrected by {after:.1e} {unit}"
        );
        let holds = before > 1.0 && after < 1e-9;
        let command =
            "appell simulate unicycle --feedback docs/examples/feedback/lane_change_5_m_s.toml";
        let claim = Statement {
            place,
            published,
            command,
        }
        .found(ours, holds);
        claims.push(claim.erratum("undecided"));
    }
}
