//! Members of the best hypotheses replaced by others that are alike to first order.

use appell_estimate::{Estimation, Unknown};
use appell_recordings::{Measured, Role};

use super::calibration::TIED;
use super::search::Search;
use super::{Bench, Fitted, Result};
use crate::effects::Acts;

/// What takes the place of a member: candidates, each with its unknown, and the initial value of all of them.
struct Instead {
    members: Vec<(usize, Unknown)>,
    value: f64,
}

impl Search<'_, '_> {
    /// Replaces members of the hypotheses that tie with the best one: a delay of a channel by a lag, and the delay of a
    /// drive, which is nearly that of its encoder where its joint does not move others, by the latter.
    pub(super) fn try_instead(&mut self) {
        let Some(best) = self.best() else {
            return;
        };
        let log = self.log_posterior(&self.fits[best]);
        let tied = |fitted: &&Fitted| fitted.is_there() && log - self.log_posterior(fitted) < TIED;
        let tied: Vec<Fitted> = self.fits.iter().filter(tied).cloned().collect();
        for fitted in tied {
            for &member in &fitted.members {
                if let Ok(Some(fitted)) = self.fitted_instead(&fitted, member) {
                    self.keep(fitted);
                }
            }
        }
    }

    /// `None` for members that nothing resembles, and for delays of encoders that are fitted already.
    fn fitted_instead(&self, whole: &Fitted, member: usize) -> Result<Option<Fitted>> {
        let bench = self.bench;
        let acts = bench.candidate(member).acts;
        let instead = match acts {
            // Of a group no member is replaced alone.
            _ if bench.candidate(member).is_of_group() => None,
            Acts::Late(channel) => lag(bench, whole, channel)?,
            Acts::Delay(input) => delays_of_encoder(bench, whole, input)?,
            _ => None,
        };
        let Some(instead) = instead else {
            return Ok(None);
        };
        let mut members = whole.members.clone();
        members.retain(|&own| own != member);
        members.extend(instead.members.iter().map(|(candidate, _)| *candidate));
        members.sort_unstable();
        members.dedup();
        let is_fitted = self.fits.iter().any(|own| own.members == members);
        if is_fitted && matches!(acts, Acts::Delay(_)) {
            return Ok(None);
        }
        let setup = bench.setup(&members);
        let estimation = Estimation::new(&setup, &bench.recordings)?;
        let mut start = bench.carried(whole, &estimation);
        self.take_away(member, whole, &estimation, &mut start);
        for (_, unknown) in instead.members {
            start[estimation.layout().place(unknown)?] = instead.value;
        }
        let mut fitted = bench.fit(bench.effort(), &members, &estimation, &start)?;
        self.count_late(&mut fitted)?;
        Ok(Some(fitted))
    }
}

/// The lag of a channel, unless it is too short to be distinguished from the delay.
fn lag(bench: &Bench<'_>, whole: &Fitted, channel: usize) -> Result<Option<Instead>> {
    let acts = Acts::Slow(channel);
    let delay = whole.fit.values[whole.layout.place(Unknown::SensorDelay(channel))?];
    let slow = candidate(bench, acts, false).filter(|&slow| !bench.is_too_short(slow, &[delay]));
    let free = slow.and_then(|slow| bench.of_signal(acts, &bench.setup(&[slow])));
    let (Some(slow), Some(free)) = (slow, free) else {
        return Ok(None);
    };
    Ok(Some(Instead {
        members: vec![(slow, free.unknown)],
        value: delay,
    }))
}

/// The delays of the position and the rate of the joint that an actuator of a robot drives.
fn delays_of_encoder(bench: &Bench<'_>, whole: &Fitted, input: usize) -> Result<Option<Instead>> {
    let Some(coordinate) = driven(bench, input) else {
        return Ok(None);
    };
    let setup = bench.setup(&whole.members);
    let Some(own) = bench.of_signal(Acts::Delay(input), &setup) else {
        return Ok(None);
    };
    let delay = whole.fit.values[whole.layout.place(own.unknown)?];
    let info = bench.effects.info();
    let measured = bench.set.measured(info);
    let mut members = Vec::new();
    for (channel, (own, _)) in measured.iter().enumerate() {
        let is_of_joint = match own.role {
            Role::Measures(Measured::Coordinate(own) | Measured::PseudoVelocity(own)) => {
                own == coordinate
            }
            _ => false,
        };
        let acts = Acts::Late(channel);
        let late = candidate(bench, acts, true).or_else(|| candidate(bench, acts, false));
        let late = late.filter(|_| is_of_joint);
        members.extend(late.map(|late| (late, Unknown::SensorDelay(channel))));
    }
    Ok((!members.is_empty()).then_some(Instead {
        members,
        value: delay,
    }))
}

/// The coordinate of the joint that an actuator drives; of a robot with a rate for each coordinate.
fn driven(bench: &Bench<'_>, input: usize) -> Option<usize> {
    let info = bench.effects.info();
    let robot = bench.set.robot.as_ref().filter(|_| bench.is_of_robot)?;
    let mut actuators = robot.dictionary.actuators.iter();
    let actuator = actuators.find(|own| info.inputs[input].name == own.input)?;
    let joint = actuator.joint.as_ref()?;
    let mut joints = robot.dictionary.joints.iter();
    let joint = joints.find(|own| own.name == *joint)?;
    let coordinate = info.state_index(&joint.coordinate)?;
    coordinate.checked_sub(info.speeds)
}

/// The candidate with an action, at a group of sites or at one.
fn candidate(bench: &Bench<'_>, acts: Acts, is_of_group: bool) -> Option<usize> {
    let mut candidates = bench.effects.candidates.iter();
    candidates.position(|own| own.acts == acts && own.is_of_group() == is_of_group)
}
