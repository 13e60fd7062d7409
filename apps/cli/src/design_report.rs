//! A control design as text.

use std::fmt::Write as _;

use appell_runtime::model::{ModelInfo, Quantity};
use nalgebra::Complex;

use appell::control::Schedule;
use appell::control::design::{Design, DesignedGains};
use appell::control::remedies::pole_text;
use appell_report::row;
use appell_report::text::{number, table};

/// Real part in 1/s above which a mode is unstable; rounding may move a multiple zero this far.
const GROWING: f64 = 1e-6;

/// The design as text, gains in the units of the spec.
pub(crate) fn text(design: &Design, info: &ModelInfo) -> String {
    let mut text = format!("{}\n{}", info.title, motion(design, info));
    text += &reach(design, info);
    text += &equations(design, info);
    match &design.law {
        Some(law) => text += &gains(design, law, info),
        None => text += "  no law designed: use `--poles` or `--lqr`\n",
    }
    text
}

/// The nonzero values on the motion.
fn motion(design: &Design, info: &ModelInfo) -> String {
    let states = info.states.iter().zip(&design.x);
    let inputs = info.inputs.iter().zip(&design.u);
    let others = states.chain(inputs).filter(|(_, value)| **value != 0.0);
    let values: Vec<String> = others
        .map(|(q, &value)| format!("{} = {} {}", q.name, number(q.to_unit(value)), q.unit))
        .collect();
    if values.is_empty() {
        "steady motion: all states and inputs are 0\n".to_owned()
    } else {
        format!("steady motion: {}; all others are 0\n", values.join(", "))
    }
}

/// The controllable subspace, and the uncontrollable modes.
fn reach(design: &Design, info: &ModelInfo) -> String {
    let controllability = &design.controllability;
    let names = names(&info.states, &design.equations.states);
    let inputs = self::names(&info.inputs, &design.equations.inputs).join(", ");
    let order = names.len();
    let mut text = format!(
        "{inputs}: controllable subspace of dimension {} of {order}\n",
        controllability.rank
    );
    let values: Vec<String> = controllability
        .singular_values
        .iter()
        .map(|v| format!("{v:.1e}"))
        .collect();
    let _ = writeln!(
        text,
        "  singular values of the scaled controllability matrix [B AB …]: {}",
        values.join("  ")
    );
    if controllability.lost.is_empty() {
        return text;
    }
    let lost: Vec<String> = counted(&controllability.lost);
    let _ = writeln!(text, "  uncontrollable modes in 1/s: {}", lost.join(", "));
    let _ = writeln!(
        text,
        "  combinations of states that no input affects, in SI:"
    );
    for row in 0..controllability.untouched.nrows() {
        let row: Vec<f64> = controllability.untouched.row(row).iter().copied().collect();
        let _ = writeln!(text, "    {}", combination(&row, &names));
    }
    if controllability.kept().any(|mode| mode.value.re > GROWING) {
        text += "  an uncontrollable mode is unstable: no feedback to these inputs stabilises the motion\n";
    }
    text
}

/// The subsystem of the outputs.
fn equations(design: &Design, info: &ModelInfo) -> String {
    let outputs = names(&info.states, &design.outputs);
    let mut text = format!("outputs {}: a closed subsystem\n", outputs.join(", "));
    for (state, factors) in &design.subsystem.substituted {
        let state = &info.states[design.equations.states[*state]].name;
        let _ = writeln!(text, "  with {state} = {}", combination(factors, &outputs));
    }
    text
}

/// Gains in the units of the spec, and the poles.
fn gains(design: &Design, law: &DesignedGains, info: &ModelInfo) -> String {
    let (inputs, states) = (&design.equations.inputs, &design.outputs);
    let mut rows = vec![row!["gain of", "on", "", "unit"]];
    for (row, &input) in inputs.iter().enumerate() {
        let input = &info.inputs[input];
        for column in 0..law.gain.ncols() {
            let (on, pending) = (
                fed_back(design, column, info),
                if column < states.len() {
                    ""
                } else {
                    ", pending"
                },
            );
            let gain = number(law.gain[(row, column)] * on.scale / input.scale);
            let on_name = format!("{}{pending}", on.name);
            rows.push(row![input.name, on_name, gain, gain_unit(input, on)]);
        }
    }
    let mut text = table(&rows, 2..3);
    let listed = |poles: &mut dyn Iterator<Item = Complex<f64>>| {
        let poles: Vec<String> = poles.map(pole_text).collect();
        poles.join(", ")
    };
    let mut poles = law.poles.iter().copied();
    let _ = match law.sampling {
        None => writeln!(text, "closed-loop poles in 1/s: {}", listed(&mut poles)),
        Some(sampling) => writeln!(
            text,
            "poles of the sampled closed loop, z: {}\n  ln(z)/T in 1/s: {}",
            listed(&mut poles.clone()),
            listed(&mut poles.filter_map(|pole| sampling.continuous_pole(pole)))
        ),
    };
    let growing = law.growing();
    if growing > 0 {
        let _ = writeln!(
            text,
            "  the closed loop is unstable: {growing} of {} poles {}",
            law.poles.len(),
            if law.sampling.is_none() {
                "have no negative real part; write stable ones with a minus sign, such as --poles=-8"
            } else {
                "lie outside the unit circle"
            }
        );
    }
    let _ = match law.condition {
        Some(condition) => writeln!(
            text,
            "  characteristic polynomial accurate to {:.0e}, condition number of the eigenvectors \
            {condition:.1e}",
            law.residual
        ),
        None => writeln!(
            text,
            "  residual of the Riccati equation {:.0e}",
            law.residual
        ),
    };
    text
}

/// What a column of the gains feeds back: an output, or an input that does not act yet.
fn fed_back<'i>(design: &Design, column: usize, info: &'i ModelInfo) -> &'i Quantity {
    let (inputs, outputs) = (&design.equations.inputs, &design.outputs);
    match outputs.get(column) {
        Some(&state) => &info.states[state],
        None => &info.inputs[inputs[(column - outputs.len()) % inputs.len()]],
    }
}

/// `N/(rad/s)`
fn gain_unit(of: &Quantity, on: &Quantity) -> String {
    let compound = on.unit.contains(['/', '*', ' ']);
    match (&*of.unit, &*on.unit) {
        (of, "" | "1") => of.to_owned(),
        ("" | "1", on) if compound => format!("1/({on})"),
        (of, on) if compound => format!("{of}/({on})"),
        (of, on) => format!("{of}/{on}"),
    }
}

/// `omega_3 + 6.66667 theta`
fn combination(factors: &[f64], names: &[String]) -> String {
    let mut text = String::new();
    for (factor, name) in factors
        .iter()
        .zip(names)
        .filter(|(factor, _)| **factor != 0.0)
    {
        let sign = match (text.is_empty(), *factor < 0.0) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = number(factor.abs());
        let size = if size == "1.00000" {
            String::new()
        } else {
            size + " "
        };
        let _ = write!(text, "{sign}{size}{name}");
    }
    text
}

/// Modes, repeated ones once with their multiplicity.
fn counted(modes: &[Complex<f64>]) -> Vec<String> {
    let size = modes.iter().map(|mode| mode.norm()).fold(1.0, f64::max);
    let mut open: Vec<Complex<f64>> = modes.to_vec();
    let mut told = Vec::new();
    while let Some(&first) = open.first() {
        let near = |mode: &Complex<f64>| (mode - first).norm() <= 1e-4 * size;
        let (same, rest): (Vec<_>, Vec<_>) = open.into_iter().partition(near);
        let mean = same.iter().sum::<Complex<f64>>() / same.len() as f64;
        // A multiple eigenvalue is accurate to a root of the rounding error only.
        let clean = |part: f64| if part.abs() <= 1e-8 * size { 0.0 } else { part };
        let mean = pole_text(Complex::new(clean(mean.re), clean(mean.im)));
        told.push(match same.len() {
            1 => mean,
            times => format!("{mean} ({times} times)"),
        });
        open = rest;
    }
    told
}

fn names(quantities: &[Quantity], places: &[usize]) -> Vec<String> {
    places
        .iter()
        .map(|&place| quantities[place].name.to_string())
        .collect()
}

/// Gains against the scheduling variable.
pub(crate) fn schedule_text(schedule: &Schedule, info: &ModelInfo) -> String {
    let Schedule { over, designs, .. } = schedule;
    let Some((_, first)) = designs.first() else {
        return String::new();
    };
    let mut heading = row![over.name, "rank"];
    let mut units = row![over.unit, ""];
    let columns = first.law.as_ref().map_or(0, |law| law.gain.ncols());
    let mut scales = Vec::new();
    for &input in &first.equations.inputs {
        for column in 0..columns {
            let (on, of) = (fed_back(first, column, info), &info.inputs[input]);
            heading.push(format!("{} on {}", of.name, on.name));
            units.push(gain_unit(of, on));
            scales.push(on.scale / of.scale);
        }
    }
    let mut rows = vec![heading, units];
    for (value, design) in designs {
        let mut row = row![number(over.to_unit(*value)), design.controllability.rank];
        if let Some(law) = &design.law {
            let gains = law.gain.transpose();
            let gains = gains.iter().zip(&scales);
            row.extend(gains.map(|(gain, scale)| number(gain * scale)));
        }
        rows.push(row);
    }
    let width = rows[0].len();
    let mut text = format!("{}\n{}", info.title, table(&rows, 0..width));
    let grows =
        |(_, design): &&(f64, Design)| design.law.as_ref().is_some_and(|law| law.growing() > 0);
    let unstable = designs.iter().filter(grows).count();
    if unstable > 0 {
        let _ = writeln!(
            text,
            "  the closed loop is unstable in {unstable} of {} designs",
            designs.len()
        );
    }
    text
}
