//! Members of the leading hypothesis that close nothing.
//!
//! No law is exact, so that a long recording makes many an effect significant. A member without which held-out runs are
//! predicted as well is therefore no cause, unless its evidence is beyond what small errors of other members may feign.

use super::calibration::IMMATERIAL;
use super::prediction::{self, Paired, stated};
use super::{Bench, Comparison, HeldOut, Options, Result, budget, held_out};

/// Log Bayes factor beyond which a member is there although it closes nothing.
const DECISIVE: f64 = 20.0;
/// Part of its probability that a hypothesis with a member that closes nothing keeps.
const DOUBT: f64 = 0.05;

impl Comparison {
    /// Lets the same hypothesis without a member lead, as long as that member closes no material share of the gap that
    /// re-fitted parameters leave on held-out runs; not for a robot, whose servos hide what a member does to the motion.
    pub(super) fn without_immaterial(
        &mut self,
        bench: &Bench<'_>,
        runs: &HeldOut,
        options: &Options,
    ) -> Result<()> {
        if bench.is_of_robot || runs.recordings.is_empty() {
            return Ok(());
        }
        let noise = prediction::noise(bench, self.best())?;
        let horizon = options.horizon;
        let horizon = horizon.unwrap_or_else(|| held_out::horizon(&runs.recordings));
        let tolerance = options.tolerance.unwrap_or(IMMATERIAL);
        while let Some(fewer) = self.with_fewer(bench) {
            let floor = runs.floor(bench, self.best(), &noise, horizon)?;
            let stated = stated(bench, self.nominal())?;
            let errors = |own| runs.errors(bench, own, &noise, horizon);
            let [stated, refitted] = [errors(&stated)?, errors(self.nominal())?];
            let [with, without] = [errors(self.best())?, errors(&self.fits[fewer].0)?];
            let paired = Paired::of(&[&stated, &refitted, &with, &without]);
            let share = |means: &[f64]| {
                let gap = means[0].min(means[1]) - floor * floor;
                (means[3] - means[2]) / gap.max(0.0)
            };
            let [_, most] = paired.interval95(share);
            if most.is_nan() || most >= tolerance {
                break;
            }
            self.lead(fewer);
        }
        Ok(())
    }

    /// The most probable hypothesis that has all effects of the best one but one, without decisive evidence against it.
    fn with_fewer(&self, bench: &Bench<'_>) -> Option<usize> {
        let best = self.best();
        let effects = budget::effects(bench.effects, &best.members);
        let is_fewer = |&place: &usize| {
            let own = &self.fits[place].0;
            let lacks = |(_, members): &&(String, Vec<usize>)| {
                !members.iter().any(|member| own.members.contains(member))
            };
            let mut members = own.members.iter();
            let is_part = members.all(|member| best.members.contains(member));
            let lost = best.evidence.log() - own.evidence.log();
            is_part
                && !own.members.is_empty()
                && effects.iter().filter(lacks).count() == 1
                && self.independent * lost < DECISIVE
        };
        let mut fits = 1..self.fits.len();
        fits.find(is_fewer)
    }

    /// Makes a hypothesis the leading one, at the expense of that which led.
    fn lead(&mut self, place: usize) {
        let nominal = self.nominal().members.clone();
        let mut next = self.fits.remove(place);
        let moved = (1.0 - DOUBT) * self.fits[0].1;
        self.fits[0].1 -= moved;
        next.1 += moved;
        self.fits.insert(0, next);
        self.fits[1..].sort_by(|(_, a), (_, b)| b.total_cmp(a));
        let is_nominal = self.fits.iter().position(|(own, _)| own.members == nominal);
        self.nominal = is_nominal.unwrap_or(self.nominal);
    }
}
