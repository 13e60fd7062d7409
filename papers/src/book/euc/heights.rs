//! Beyond the paper: the height from all input-free relations, weighted by the noise, with its
//! interval.

use appell_codegen::jit::JitModel;
use appell_codegen::program::FunctionKind;
use appell_estimate::HALF_WIDTH_95;
use appell_estimate::inverse::{Consistency, Found, Record, Relations, Sought, Track};
use appell_models::Shipped;
use appell_recordings::motion_capture::{Capture, Ride};
use appell_report::figure::{Figure, Panel, Series};
use appell_runtime::model::Model;
use nalgebra::{DMatrix, DVector};

use super::laboratory::{Laboratory, PERFECT, REAL, Session};
use super::rider::Manoeuvre;
use crate::book::claim::{Picture, Section, Statement};
use crate::book::{computation, failed};
use appell::Error;

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

pub(super) fn section(laboratory: &Laboratory) -> Result<Section, Error> {
    let shipped = Shipped::find("euc_3dof");
    let shipped = shipped.ok_or_else(|| failed("the planar model is not shipped"))?;
    let program = appell_codegen::compile(shipped.file, shipped.spec, &FunctionKind::ALL)?;
    let model = JitModel::new(&program).map_err(computation)?;
    let command = "appell motion SKELETON ride.csv; appell inverse euc_3dof --data recording --free h --bias phi";
    let mut claims = Vec::new();
    let mut estimates = Vec::new();
    for session in &laboratory.sessions {
        let name = session.manoeuvre.name();
        let place = format!("height, {name}");
        let real = find(&model, laboratory, session)?;
        claims.push(
            Statement {
                place: &place,
                published: "nothing: one number without an interval",
                command,
            }
            .found(
                interval(&real.found, laboratory.height),
                real.found.values[0].is_finite(),
            )
            .added(),
        );
        if session.manoeuvre != Manoeuvre::FigureEight {
            let perfect = laboratory.seen(session, PERFECT);
            let perfect = consistency(&model, laboratory, &perfect, false)?;
            let off = perfect.least().map_err(computation)?[0] - laboratory.height;
            let ours = format!(
                "without noise and marker offsets h is off by {:.2} mm: what the plane does not see of the ride",
                1e3 * off
            );
            let claim = Statement {
                place: &place,
                published: "nothing",
                command,
            }
            .found(ours, off.abs() < STRAIGHT);
            claims.push(claim.added());
        }
        estimates.push(real);
    }
    let deviation = |manoeuvre: Manoeuvre| {
        let mut estimates = estimates.iter();
        let estimate = estimates.find(|estimate: &&Estimate| estimate.manoeuvre == manoeuvre);
        estimate.map_or(f64::NAN, |estimate| spread(&estimate.found))
    };
    let [straight, speeding, braking, eight] = Manoeuvre::ALL.map(deviation);
    let ours = format!(
        "standard deviations of h: constant speed {:.1} mm, acceleration {:.1} mm, deceleration {:.1} mm, figure-eight \
         {:.1} mm",
        1e3 * straight,
        1e3 * speeding,
        1e3 * braking,
        1e3 * eight
    );
    for (manoeuvre, deviation) in [("constant speed", straight), ("figure-eight", eight)] {
        claims.push(
            Statement {
                place: "height",
                published: &format!("{manoeuvre} is not sensitive to h"),
                command,
            }
            .simulated(&ours, deviation > speeding.max(braking)),
        );
    }
    Ok(Section {
        title: "What the rides tell of the height".to_owned(),
        about: format!(
            "The three equations of the plane leave one relation over whatever the two torques were; it is M_d,1 = \
             M_d,2. Here it is weighed by the noise with all its correlations, and the rider's angle, seen from the \
             pedals, may show a constant too much. The true height is {:.4} m.",
            laboratory.height
        ),
        claims,
        pictures: vec![Picture {
            svg: figure(&estimates, laboratory).to_svg(),
            caption: "How much less likely other heights are: twice the inconsistency above its minimum. An interval of \
                      95 % ends where the line crosses 3.84 if the model holds."
                .to_owned(),
        }],
    })
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

fn find(model: &dyn Model, laboratory: &Laboratory, session: &Session) -> Result<Estimate, Error> {
    let captures = laboratory.seen(session, REAL);
    let consistency = consistency(model, laboratory, &captures, true)?;
    let found = consistency.find().map_err(computation)?;
    let heights: Vec<f64> = PROFILE.iter().map(|part| part * found.values[0]).collect();
    let profile = consistency.profile(0, &heights).map_err(computation)?;
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
) -> Result<Consistency<'a>, Error> {
    let records: Vec<Record> = (captures.iter())
        .map(|capture| record(laboratory, capture))
        .collect();
    let track = Track::of(&records).map_err(computation)?;
    let info = model.info();
    let p = info.default_parameters();
    let mut motions = track.stretches.iter().flat_map(|stretch| &stretch.motions);
    let first = motions.next().ok_or_else(|| failed("no motion"))?;
    let relations = Relations::new(model, &[0, 1, 2], first, &p).map_err(computation)?;
    let h = info.parameter_index("h").ok_or_else(|| failed("no `h`"))?;
    let mut sought = vec![Sought::Parameter(h)];
    if biased {
        sought.push(Sought::Bias(2));
    }
    Consistency::new(relations, track, p, sought).map_err(computation)
}

/// x, γ and ϕ of a ride.
fn record(laboratory: &Laboratory, capture: &Capture) -> Record {
    let ride = Ride::of(&laboratory.skeleton, capture);
    let columns: Vec<DVector<f64>> = (ride.channels.iter())
        .map(|channel| DVector::from_column_slice(channel))
        .collect();
    Record {
        times: ride.times,
        values: DMatrix::from_columns(&columns),
    }
}

fn figure(estimates: &[Estimate], laboratory: &Laboratory) -> Figure {
    let panel = |estimate: &Estimate| Panel {
        unit: String::new(),
        series: vec![Series {
            label: estimate.manoeuvre.name().to_owned(),
            x: PROFILE
                .iter()
                .map(|part| part * estimate.found.values[0])
                .collect(),
            y: estimate
                .profile
                .iter()
                .map(|cost| 2.0 * (cost - estimate.found.cost))
                .collect(),
        }],
    };
    Figure {
        title: format!("Heights beside the true one of {:.3} m", laboratory.height),
        x_label: "h [m]".to_owned(),
        panels: estimates.iter().map(panel).collect(),
        marks: Vec::new(),
        equal_axes: false,
    }
}
