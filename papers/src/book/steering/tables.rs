//! Tables I, II and III: parameters, and gains that place all poles at −8 1/s.

use crate::book::{Part, Result, Section, computation, rows, state};
use crate::steering::{GAINS, MISPRINT, OUTPUTS};
use appell_analysis::control::operating_point::{MotionEquations, OperatingPoint};
use appell_analysis::control::placement;
use appell_analysis::control::reduction::{Subsystem, reduce};
use nalgebra::{Complex, DMatrix};

use crate::book::claim::shown;
use crate::book::steady_motions::{Mechanism, RADIUS};

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

/// The linearised unicycle in straight rolling at a speed in m/s, and indices of the outputs among
/// its states.
pub(super) fn straight(speed: f64, outputs: &[&str]) -> Result<(MotionEquations, Vec<usize>)> {
    let unicycle = Mechanism::shipped("unicycle")?;
    let info = unicycle.0.info();
    let mut point = OperatingPoint::new(unicycle.0);
    point.x.fill(0.0);
    point.x[state(info, "omega_2")?] = speed / RADIUS;
    let equations = point.equations(&[0]).map_err(computation)?;
    let outputs = outputs.iter().map(|name| state(info, name));
    let outputs = rows(&equations, &outputs.collect::<Result<Vec<_>>>()?)?;
    Ok((equations, outputs))
}

/// The equations of the outputs about it.
pub(super) fn steered(speed: f64, outputs: &[&str]) -> Result<Subsystem> {
    let (equations, outputs) = straight(speed, outputs)?;
    reduce(&equations.system, &outputs).map_err(computation)
}

/// Gains that place all poles of the outputs.
pub(super) fn placed(speed: f64, outputs: &[&str]) -> Result<DMatrix<f64>> {
    let poles = vec![Complex::from(POLE); outputs.len()];
    let placed = placement::place(&steered(speed, outputs)?.system, &poles);
    Ok(placed.map_err(computation)?.gain)
}

/// The tables.
pub(super) fn section(_: usize) -> Result<Section> {
    let mut part = Part::read(include_str!("tables.toml"))?;
    part.parameters(Mechanism::shipped("unicycle")?.0.info())?;
    for column in GAINS.iter() {
        let outputs = &OUTPUTS[..column.printed.len()];
        part.set("table", &column.table);
        part.set("speed", column.speed);
        part.set("outputs", outputs.join(","));
        let gains = placed(column.speed, outputs)?;
        let rows = column.printed.iter().zip(gains.iter()).zip(LETTERS);
        for ((printed, gain), (letter, unit)) in rows {
            part.set("gain", format!("{letter} = {printed} {unit}"));
            entry(&mut part, printed, *gain)?;
        }
    }
    Ok(part.section())
}

/// One gain and the printed one, to which it must round.
fn entry(part: &mut Part, printed: &str, gain: f64) -> Result<()> {
    let [misprint, right] = MISPRINT;
    if printed == misprint {
        // 5 R² m p⁵/(8 φ̇ g)
        return part.found("misprint", shown(gain), format!("{gain:.2}") == right);
    }
    let decimals = printed.split_once('.');
    let decimals = decimals.map_or(0, |(_, decimals)| decimals.len());
    let rounds = format!("{gain:.decimals$}") == printed;
    part.set(
        "digits",
        printed.chars().filter(char::is_ascii_digit).count(),
    );
    part.found("gain", shown(gain), rounds)
}
