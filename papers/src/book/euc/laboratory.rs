//! All rides, captured and smoothed, shared by the parts of the book.

use appell_recordings::motion_capture::{Capture, Ride, Skeleton, Smoothed, filter};
use appell_runtime::Trajectory;

use super::capture::{Captured, Imperfection, Random};
use super::rider::{Manoeuvre, Rider};
use crate::book::{Result, computation, edited, failed, parameter};

/// The skeleton file of the examples.
pub(super) const SKELETON: &str = include_str!("../../../euc/skeleton.toml");
/// The rider's angle about the pedals, as in the skeleton, and about the wheel centre, as in (3).
const SEEN_FROM: (&str, &str) = ("lean = [\"A\", \"G\"] }", "lean = [\"C\", \"G\"] }");

/// The stated noise and marker offsets.
pub(super) const REAL: Imperfection = Imperfection {
    noise: 1.0,
    offsets: 1.0,
};
/// A perfect capture.
pub(super) const PERFECT: Imperfection = Imperfection {
    noise: 0.0,
    offsets: 0.0,
};

/// The rides of one manoeuvre.
pub(super) struct Session {
    pub(super) manoeuvre: Manoeuvre,
    /// The true motion.
    pub(super) motions: Vec<Trajectory>,
    /// The captured rides, with the rider's angle by (3).
    pub(super) by_3: View,
    /// The same with the angle about the pedals.
    pub(super) by_pedals: View,
}

/// Rides with the rider's angle about one point.
pub(super) struct View {
    pub(super) rides: Vec<Ride>,
    /// With derivatives.
    pub(super) smoothed: Vec<Smoothed>,
    /// Frames of the filter's window.
    pub(super) window: usize,
}

impl View {
    fn of(skeleton: &Skeleton, captures: &[Capture]) -> Result<Self> {
        let ride = |capture| Ride::of(skeleton, capture);
        let rides: Vec<Ride> = captures.iter().map(ride).collect();
        let filter = filter(&rides).map_err(computation)?;
        let smoothed = |ride| Smoothed::of(ride, filter).map_err(computation);
        let smoothed = rides.iter().map(smoothed);
        Ok(Self {
            smoothed: smoothed.collect::<Result<_>>()?,
            window: filter.count(),
            rides,
        })
    }
}

/// The rides of all manoeuvres.
pub(super) struct Laboratory {
    /// True height of the rider's centre of mass above the pedals in m.
    pub(super) height: f64,
    /// The skeleton of the example.
    pub(super) skeleton: Skeleton,
    rider: Captured,
    pub(super) sessions: Vec<Session>,
}

impl Laboratory {
    pub(super) fn new() -> Result<Self> {
        let skeleton = Skeleton::parse("docs/examples/euc/skeleton.toml", SKELETON)?;
        let text = edited(SKELETON, [&SEEN_FROM])?;
        let by_3 = Skeleton::parse("docs/examples/euc/skeleton.toml", &text)?;
        let captured = Captured::new(&skeleton)?;
        let height = captured.height();
        let rider = Rider::new(height)?;
        let session = |&manoeuvre: &Manoeuvre| {
            let runs = 0..manoeuvre.runs();
            let motions = runs.map(|run| rider.ride(manoeuvre, run));
            let motions: Vec<Trajectory> = motions.collect::<Result<_>>()?;
            let captures = seen(&captured, manoeuvre, &motions, REAL);
            Ok(Session {
                manoeuvre,
                by_3: View::of(&by_3, &captures)?,
                by_pedals: View::of(&skeleton, &captures)?,
                motions,
            })
        };
        let sessions = Manoeuvre::ALL.iter().map(session);
        Ok(Self {
            height,
            sessions: sessions.collect::<Result<_>>()?,
            rider: captured,
            skeleton,
        })
    }

    /// Value and unit of a parameter of the simulated spatial model.
    pub(super) fn stated(&self, name: &str) -> Result<(f64, String)> {
        let mut motions = self.sessions.iter().flat_map(|session| &session.motions);
        let motion = motions.next().ok_or_else(|| failed("nothing was ridden"))?;
        let info = motion.info();
        let index = parameter(info, name)?;
        let unit = info.parameters[index].unit.to_string();
        Ok((motion.parameters()[index], unit))
    }

    /// The rides of a manoeuvre with another imperfection of the capture.
    pub(super) fn seen(&self, session: &Session, with: Imperfection) -> Vec<Capture> {
        seen(&self.rider, session.manoeuvre, &session.motions, with)
    }
}

fn seen(
    rider: &Captured,
    manoeuvre: Manoeuvre,
    motions: &[Trajectory],
    with: Imperfection,
) -> Vec<Capture> {
    let mut random = Random::of(manoeuvre.name());
    let runs = motions.iter();
    runs.map(|motion| rider.see(motion, with, &mut random))
        .collect()
}
