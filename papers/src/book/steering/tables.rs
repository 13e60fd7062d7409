//! Tables I, II and III: parameters, and gains that place all poles at −8 1/s.

use crate::steering::{GAINS, Gains, MISPRINT, OUTPUTS};
use appell_analysis::control::operating_point::{MotionEquations, OperatingPoint};
use appell_analysis::control::reduction::{Subsystem, reduce};
use appell_analysis::control::robust_placement;
use nalgebra::{Complex, DMatrix};

use crate::book::claim::{Claim, Section, Statement, shown};
use crate::book::steady_motions::{Mechanism, RADIUS};
use crate::book::{computation, failed};
use appell::Error;

/// Real part of all poles in 1/s.
pub(super) const POLE: f64 = -8.0;
/// Letters of the gains, and units.
const LETTERS: [(&str, &str); 6] = [
    ("D_ϑ", "N s"),
    ("P_ϑ", "N"),
    ("D_r", "N s/m"),
    ("P_r", "N/m"),
    ("P_ψ", "N"),
    ("P_y", "N/m"),
];

/// Table I: letter in the spec, value.
const PARAMETERS: [(&str, &str, f64); 4] = [
    ("m", "kg", 10.0),
    ("m0", "kg", 5.0),
    ("R", "m", 0.3),
    ("g", "m/s²", 9.81),
];

/// The linearised unicycle in straight rolling at a speed in m/s, and indices of the outputs among
/// its states.
pub(super) fn straight(
    speed: f64,
    outputs: &[&str],
) -> Result<(MotionEquations, Vec<usize>), Error> {
    let unicycle = Mechanism::shipped("unicycle")?;
    let info = unicycle.0.info();
    let index = |name: &str| {
        let state = info.state_index(name);
        state.ok_or_else(|| failed(&format!("no state `{name}`")))
    };
    let mut point = OperatingPoint::new(unicycle.0);
    point.x.fill(0.0);
    point.x[index("omega_2")?] = speed / RADIUS;
    let equations = point.equations(&[0]).map_err(computation)?;
    let row = |name: &&str| {
        let state = index(name)?;
        let row = equations.states.iter().position(|s| *s == state);
        row.ok_or_else(|| failed(&format!("`{name}` is no state of the equations")))
    };
    let outputs: Vec<usize> = outputs.iter().map(row).collect::<Result<_, _>>()?;
    Ok((equations, outputs))
}

/// The equations of the outputs about it.
pub(super) fn steered(speed: f64, outputs: &[&str]) -> Result<Subsystem, Error> {
    let (equations, outputs) = straight(speed, outputs)?;
    reduce(&equations.system, &outputs).map_err(computation)
}

/// Gains that place all poles of the outputs.
pub(super) fn placed(speed: f64, outputs: &[&str]) -> Result<DMatrix<f64>, Error> {
    let poles = vec![Complex::from(POLE); outputs.len()];
    let placed = robust_placement::place(&steered(speed, outputs)?.system, &poles);
    Ok(placed.map_err(computation)?.gain)
}

/// The tables.
pub(super) fn section() -> Result<Section, Error> {
    let mut claims = Vec::new();
    let unicycle = Mechanism::shipped("unicycle")?;
    let info = unicycle.0.info();
    for (name, unit, value) in PARAMETERS {
        let index = info.parameter_index(name);
        let ours = index.map_or(f64::NAN, |index| info.parameters[index].value);
        let published = format!("{name} = {value} {unit}");
        claims.push(
            Statement {
                place: "table I",
                published: &published,
                command: "appell check unicycle",
            }
            .number([value, ours], 15),
        );
    }
    for Gains {
        table,
        speed,
        printed,
    } in GAINS
    {
        let outputs = &OUTPUTS[..printed.len()];
        let gains = placed(speed, outputs)?;
        let command = format!(
            "appell control unicycle --at 'omega_2={speed}[m/s]/R' --outputs {} --poles {POLE}",
            outputs.join(",")
        );
        for ((printed, gain), (letter, unit)) in printed.iter().zip(gains.iter()).zip(LETTERS) {
            claims.push(entry(
                table,
                speed,
                [letter, unit, printed],
                *gain,
                &command,
            ));
        }
    }
    Ok(Section {
        title: "Tables".to_owned(),
        about: "Gains by pole placement on the outputs of the linearised unicycle: derived equations, \
                the subsystem that the outputs form, one input. A printed gain has two decimals; it \
                is reproduced where ours rounds to it."
            .to_owned(),
        claims,
        pictures: Vec::new(),
    })
}

/// One gain and the printed one, to which it must round.
fn entry(
    table: &str,
    speed: f64,
    [letter, unit, printed]: [&str; 3],
    gain: f64,
    command: &str,
) -> Claim {
    let decimals = printed
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let rounds = format!("{gain:.decimals$}") == printed;
    let place = format!("{table}, {speed} m/s");
    let published = format!("{letter} = {printed} {unit}");
    let claim = Statement {
        place: &place,
        published: &published,
        command,
    }
    .found(shown(gain), rounds);
    let [misprint, right] = MISPRINT;
    if printed == misprint {
        // 5 R² m p⁵/(8 φ̇ g)
        let as_expected = format!("{gain:.2}") == right;
        let claim = claim.erratum("misprint, two digits swapped");
        return Claim {
            as_expected,
            ..claim
        };
    }
    let digits = printed.chars().filter(char::is_ascii_digit).count();
    claim
        .exactly()
        .noted(format!("beside all {digits} printed digits"))
}
