//! Beyond the paper: the height from all input-free relations, weighted by the noise, with its
//! interval.

use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_estimate::HALF_WIDTH_95;
use appell_estimate::inverse::{Consistency, Found, Record, Relations, Sought, Track};
use appell_recordings::motion_capture::{Capture, Ride};
use appell_report::figure::{Figure, Panel};
use appell_runtime::model::Model;
use nalgebra::DMatrix;

use super::laboratory::{Laboratory, PERFECT, REAL, Session};
use super::rider::Manoeuvre;
use super::simulated::simulated;
use crate::book::{Part, Result, Section, computation, failed, line, parameter, shipped};

/// Heights of the profiles, relative to the estimate.
const PROFILE: [f64; 9] = [0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.35, 1.5];
/// Tolerance for a straight ride without noise in m: lateral lean of the rider shortens the
/// projected height.
const STRAIGHT: f64 = 5e-3;

/// The height from the rides of a manoeuvre.
struct Estimate {
    manoeuvre: Manoeuvre,
    found: Found,
    profile: Vec<f64>,
}

pub(super) fn section(laboratory: &Laboratory) -> Result<Section> {
    let shipped = shipped("euc_3dof")?;
    let program = appell_codegen::compile(shipped.file, shipped.spec, &FunctionKind::ALL)?;
    let model = JitModel::new(&program).map_err(computation)?;
    let mut part = Part::read(include_str!("heights.toml"))?;
    part.set("height", format!("{:.4}", laboratory.height));
    let mut estimates = Vec::new();
    for session in &laboratory.sessions {
        part.set("manoeuvre", session.manoeuvre.name());
        let estimate = find(&model, laboratory, session)?;
        let found = &estimate.found;
        let ours = interval(found, laboratory.height);
        part.found("interval", ours, found.values[0].is_finite())?;
        if session.manoeuvre != Manoeuvre::FigureEight {
            let perfect = laboratory.seen(session, PERFECT);
            let perfect = consistency(&model, laboratory, &perfect, false)?;
            let off = perfect.least().map_err(computation)?[0] - laboratory.height;
            let ours = format!(
                "without noise and marker offsets h is off by {:.2} mm: what the plane does not see of the ride",
                1e3 * off
            );
            part.found("perfect", ours, off.abs() < STRAIGHT)?;
        }
        estimates.push(estimate);
    }
    sensitivity(&mut part, &estimates)?;
    part.picture("profiles", profiles(&estimates, laboratory).to_svg())?;
    Ok(part.section())
}

/// Manoeuvres that say little about the height.
fn sensitivity(part: &mut Part, estimates: &[Estimate]) -> Result<()> {
    let deviation = |manoeuvre: Manoeuvre| {
        let mut estimates = estimates.iter();
        let estimate = estimates.find(|estimate| estimate.manoeuvre == manoeuvre);
        estimate.map_or(f64::NAN, |estimate| spread(&estimate.found))
    };
    let deviations = Manoeuvre::ALL.map(deviation);
    let [straight, speeding, braking, eight] = deviations;
    let list = Manoeuvre::ALL.iter().zip(deviations);
    let list = list.map(|(manoeuvre, std)| format!("{} {:.1} mm", manoeuvre.name(), 1e3 * std));
    let list = list.collect::<Vec<_>>().join(", ");
    let ours = format!("standard deviations of h: {list}");
    for (manoeuvre, deviation) in [
        (Manoeuvre::ConstantSpeed, straight),
        (Manoeuvre::FigureEight, eight),
    ] {
        part.set("manoeuvre", manoeuvre.name());
        let insensitive = deviation > speeding.max(braking);
        simulated(part, "not_sensitive", &ours, insensitive)?;
    }
    Ok(())
}

/// The larger of the two standard deviations of h, from the noise and robust.
fn spread(found: &Found) -> f64 {
    found.robust[(0, 0)].max(found.covariance[(0, 0)]).sqrt()
}

fn interval(found: &Found, truth: f64) -> String {
    let [low, high] = found.intervals[0];
    let value = found.values[0];
    let reach = HALF_WIDTH_95 * spread(found);
    format!(
        "h = {value:.4} m; by the noise alone from {low:.4} m to {high:.4} m, by how parts of the rides disagree from \
         {:.4} m to {:.4} m; true {truth:.4} m. Mean square of the relation in units of its noise: {:.2}",
        value - reach,
        value + reach,
        found.normalised_square()
    )
}

/// Heights of the profile.
fn heights(found: &Found) -> Vec<f64> {
    PROFILE.iter().map(|part| part * found.values[0]).collect()
}

fn find(model: &dyn Model, laboratory: &Laboratory, session: &Session) -> Result<Estimate> {
    let captures = laboratory.seen(session, REAL);
    let consistency = consistency(model, laboratory, &captures, true)?;
    let found = consistency.find().map_err(computation)?;
    let profile = consistency.profile(0, &heights(&found));
    let profile = profile.map_err(computation)?;
    Ok(Estimate {
        manoeuvre: session.manoeuvre,
        profile,
        found,
    })
}

/// Consistency of the rides with the planar model: h and the bias of the rider's angle are sought.
fn consistency<'a>(
    model: &'a dyn Model,
    laboratory: &Laboratory,
    captures: &[Capture],
    biased: bool,
) -> Result<Consistency<'a>> {
    let records: Vec<Record> = (captures.iter())
        .map(|capture| record(laboratory, capture))
        .collect();
    let track = Track::of(&records).map_err(computation)?;
    let info = model.info();
    let p = info.default_parameters();
    let mut motions = track.stretches.iter().flat_map(|stretch| &stretch.motions);
    let first = motions.next().ok_or_else(|| failed("no motion"))?;
    let relations = Relations::new(model, &[0, 1, 2], first, &p).map_err(computation)?;
    let mut sought = vec![Sought::Parameter(parameter(info, "h")?)];
    if biased {
        sought.push(Sought::Bias(2));
    }
    Consistency::new(relations, track, p, sought).map_err(computation)
}

/// x, γ and ϕ of a ride.
fn record(laboratory: &Laboratory, capture: &Capture) -> Record {
    let ride = Ride::of(&laboratory.skeleton, capture);
    let channels = &ride.channels;
    let values = DMatrix::from_fn(ride.times.len(), channels.len(), |row, k| channels[k][row]);
    Record {
        times: ride.times,
        values,
    }
}

fn profiles(estimates: &[Estimate], laboratory: &Laboratory) -> Figure {
    let panels = estimates.iter().map(|estimate| {
        let cost = |cost: &f64| 2.0 * (cost - estimate.found.cost);
        let costs = estimate.profile.iter().map(cost).collect();
        let name = estimate.manoeuvre.name();
        Panel::new("", vec![line(name, heights(&estimate.found), costs)])
    });
    let title = format!("Heights beside the true one of {:.3} m", laboratory.height);
    Figure::new(&title, "h [m]", panels.collect())
}
