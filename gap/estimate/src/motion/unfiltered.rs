//! A motion without a filter: predictions, and segments of multiple shooting. Its steps are those of the filter.

use appell_runtime::positions::Inconsistent;

use super::closure::Closure;
use super::command::{self, OfOutputs, Switch};
use super::plant::{Place, Scratch, StateSpace};
use super::timeline::Advance;
use super::transition::{MOST_PARTS, STAGES, WEIGHTS, decays, is_uneven, within};
use crate::data::recording::{Recording, Row};
use crate::matrix::add_scaled;

/// A motion along a recording.
pub(crate) struct Unfiltered<'a> {
    pub(crate) system: StateSpace<'a>,
    pub(crate) values: &'a [f64],
    pub(crate) recording: &'a Recording,
    pub(crate) z: Vec<f64>,
    pub(crate) held: Vec<f64>,
    pub(crate) scratch: Scratch,
    pub(crate) closure: Option<Closure>,
    /// States and rates of the stages of a step.
    stages: Vec<f64>,
    rates: Vec<f64>,
    /// ∂ż/∂z at the first stage, and at the present one.
    slopes: [Vec<f64>; 2],
}

/// A stage of a step.
pub(crate) struct Stage<'s> {
    pub(crate) index: usize,
    pub(crate) place: Place<'s>,
    pub(crate) rates: &'s [f64],
    /// ∂ż/∂z.
    pub(crate) slopes: &'s [f64],
}

/// Takes the stages of a step, with work arrays.
pub(crate) type Follow<'f> = &'f mut dyn FnMut(Stage<'_>, &mut Scratch);

impl<'a> Unfiltered<'a> {
    /// At no state yet.
    pub(crate) fn new(system: StateSpace<'a>, values: &'a [f64], recording: &'a Recording) -> Self {
        let plant = system.plant;
        let n = plant.n;
        Self {
            system,
            values,
            recording,
            z: vec![0.0; n],
            held: vec![0.0; command::NUMBERS * plant.info().declared_inputs],
            scratch: plant.scratch(),
            closure: Closure::of(plant),
            stages: vec![0.0; WEIGHTS.len() * n],
            rates: vec![0.0; WEIGHTS.len() * n],
            slopes: [vec![0.0; n * n], vec![0.0; n * n]],
        }
    }

    /// Changes inputs to those of a row, the first ones of the run or later ones.
    pub(crate) fn switch(&mut self, row: Row, input: Option<usize>, first: bool) {
        let StateSpace { setup, layout, .. } = self.system;
        let switch = Switch { row, input, first };
        switch.apply(&mut self.held, setup, layout, self.values, self.recording);
    }

    /// Closes the loops at a time.
    pub(crate) fn close(&mut self, t: f64) -> Result<(), Inconsistent> {
        let Some(closure) = &mut self.closure else {
            return Ok(());
        };
        let StateSpace { plant, layout, .. } = self.system;
        let open = self.z.clone();
        let place = Place::new(layout, self.values, t, &open, &self.held);
        closure.close(plant, place, &mut self.scratch, &mut self.z)
    }

    /// What outputs that are read at a row react to, and when they were sampled: one delayed channel, or all others.
    pub(crate) fn reading(&self, row: usize, only: Option<usize>) -> (OfOutputs, f64) {
        let StateSpace { setup, layout, .. } = self.system;
        let read = OfOutputs::of(self.recording, row, &self.held, setup, layout, self.values);
        let delay = only.map_or(0.0, |channel| self.values[layout.sensor_delay(channel)]);
        (read, self.recording.times()[row] - delay)
    }

    /// One step, one of `of` parts of a whole one; the number of parts in which it has to be taken instead if it is too
    /// long. With `follow`, which is told each stage, all slopes are computed.
    pub(crate) fn step(
        &mut self,
        advance: Advance,
        of: u32,
        mut follow: Option<Follow<'_>>,
    ) -> u32 {
        let (Advance { t, h, .. }, n) = (advance, self.z.len());
        let StateSpace {
            setup,
            plant,
            layout,
        } = self.system;
        let is_checked = setup.has_corners && self.closure.is_none() && of < MOST_PARTS;
        let own = plant.info().state_len();
        let mut after = self.z.clone();
        self.stages[..n].copy_from_slice(&self.z);
        for (index, weight) in WEIGHTS.into_iter().enumerate() {
            let part = if index == 0 { 0.0 } else { STAGES[index - 1] };
            let (stages, later) = self.stages.split_at_mut((index + 1) * n);
            let (t, z) = (t + part * h, &stages[index * n..]);
            let place = Place::new(layout, self.values, t, z, &self.held);
            let rates = &mut self.rates[index * n..(index + 1) * n];
            let slopes = &mut self.slopes[usize::from(index > 0)];
            if follow.is_some() || is_checked && index == 0 {
                plant.jacobian(place, &mut self.scratch, rates, slopes);
                let parts = if is_checked {
                    decays(slopes, n, own, h)
                } else {
                    1
                };
                if parts > 1 {
                    return within(parts, of);
                }
            } else {
                plant.rates(place, &mut self.scratch, rates);
            }
            if let Some(follow) = &mut follow {
                let stage = Stage {
                    index,
                    place,
                    rates,
                    slopes,
                };
                follow(stage, &mut self.scratch);
            }
            add_scaled(h * weight, rates, &mut after);
            if let Some(next) = STAGES.get(index) {
                later[..n].copy_from_slice(&self.z);
                add_scaled(h * next, rates, &mut later[..n]);
            }
        }
        if is_checked && is_uneven(&self.stages, &self.rates, &self.slopes[0], own) {
            return within(2, of);
        }
        self.z = after;
        1
    }
}
