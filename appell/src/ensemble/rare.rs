//! The probability of a rare event of a study, by splitting.

use appell_ensemble::chunk::{Chunk, Chunks, Missing};
use appell_ensemble::design::Design;
use appell_ensemble::limits::MAX_SCORES;
use appell_ensemble::rows::{Column, Rows};
use appell_ensemble::run::{self, Ended, Watch};
use appell_ensemble::splitting::{self, Landscape, Probability, REPLICATES, Splitting};
use appell_ensemble::store::Store;
use appell_ensemble::study::{Keep, Kept, Rare};
use appell_runtime::model::ModelInfo;
use appell_spec::Code;

use super::noise::Draws;
use super::reading::Reading;
use super::spec::Quantity;
use super::{Ensemble, Running, Task, layout};
use crate::Error;

/// Evaluation in each motion: the maximum of the comparison of the event.
pub(super) fn task(
    reading: &mut Reading<'_>,
    rare: &Rare,
    design: &Design,
    factors: Vec<Column>,
    info: &ModelInfo,
    kept: &[Quantity],
) -> Option<Task> {
    if design.drawn().count() < design.factors().len() {
        let message = "the probability of a rare event needs factors that are drawn";
        let help = "leave grids and tables out";
        reading.tell(Code::ConflictingKeys, message, &rare.event, help);
        return None;
    }
    let study = reading.study;
    let which = study
        .keep
        .iter()
        .position(|k| k.name.text == rare.event.text)?;
    let keep = vec![Keep {
        kept: Kept::Max,
        unit: None,
        ..study.keep[which].clone()
    }];
    let held: f64 = study
        .noise
        .iter()
        .map(|n| study.motion.t_end / n.every.value + 1.0)
        .sum();
    let numbers = (design.drawn().count() as f64 + held) * rare.particles.value as f64;
    if numbers > MAX_SCORES as f64 {
        let message = format!("all particles together have {numbers:.0} random numbers");
        let help = format!(
            "at most {MAX_SCORES} are possible: write fewer particles, or a longer `every_s`"
        );
        reading.tell(Code::LimitExceeded, message, &rare.particles, &help);
    }
    let layout = layout::layout(reading, factors, &keep, info, &[kept[which]]);
    Some(Task {
        keep,
        which: vec![which],
        layout,
    })
}

/// The maximum of the comparison in a motion.
struct Peak<'e> {
    ensemble: &'e Ensemble,
    task: &'e Task,
}

impl Landscape for Peak<'_> {
    fn dimension(&self) -> usize {
        let noises = usize::try_from(self.ensemble.cases.noise_times()).unwrap_or(usize::MAX);
        self.ensemble
            .cases
            .design
            .drawn()
            .count()
            .saturating_add(noises)
    }

    fn heights(&self, scores: &[Vec<f64>]) -> Vec<f64> {
        let draws: Vec<Draws<'_>> = scores.iter().map(|one| Draws::Scores(one)).collect();
        let rows = self.ensemble.cases.rows_of(self.task, &draws);
        let column = self.task.layout.first[0];
        rows.iter().map(|row| row.values[column]).collect()
    }
}

impl Ensemble {
    /// Replicates of the rare event as chunks; none if the study has no rare event.
    pub fn replicates(&self) -> Option<Chunks> {
        self.rare.as_ref()?;
        Some(Chunks {
            study: format!("{}-rare-{}", self.hash, self.all_particles()),
            cases: REPLICATES,
            size: 1,
        })
    }

    /// The replicates missing from a store.
    pub fn missing_replicates(
        &self,
        store: &dyn Store,
        running: Running,
    ) -> Result<Missing, Error> {
        let Some(chunks) = self.replicates() else {
            return Ok(Missing::default());
        };
        let missing = chunks.unsound_or_missing(store, &splitting::columns(), running.shard);
        missing.map_err(Error::computation)
    }

    /// Runs replicates and writes each to the store when it is complete; the watch counts replicates.
    pub fn fill_replicates(
        &self,
        store: &dyn Store,
        missing: &[Chunk],
        running: Running,
        watch: Watch<'_>,
    ) -> Result<Ended, Error> {
        let (Some(task), Some(chunks)) = (&self.rare, self.replicates()) else {
            return Ok(Ended::Done);
        };
        let peak = Peak {
            ensemble: self,
            task,
        };
        let splitting = Splitting::new(&peak, self.particles(), self.cases.study.seed);
        run::run(
            &splitting,
            &chunks,
            missing,
            store,
            running.threads()?,
            watch,
        )
        .map_err(Error::computation)
    }

    fn all_particles(&self) -> u64 {
        let rare = self.cases.study.rare.as_ref();
        rare.map_or(0, |rare| rare.particles.value)
    }

    /// Particles of a replicate.
    fn particles(&self) -> usize {
        usize::try_from(self.all_particles() / REPLICATES).unwrap_or(usize::MAX)
    }

    /// The probability of the rare event, once all replicates are there.
    pub fn probability(&self, store: &dyn Store) -> Result<Option<Probability>, Error> {
        let Some(chunks) = self.replicates() else {
            return Ok(None);
        };
        let there = chunks.there(store).map_err(Error::computation)?;
        if !chunks.missing(&there, None).is_empty() {
            return Ok(None);
        }
        let mut all = Rows::new(0, 2, 0);
        let mut see = |rows: &Rows| {
            for row in 0..rows.len() {
                all.push(&[rows.values[0][row], rows.values[1][row]], 0.0, "");
            }
        };
        let columns = splitting::columns();
        run::scan(store, &chunks, &there, &columns, &|_| true, &mut see)
            .map_err(Error::computation)?;
        Ok(Probability::new(&all))
    }
}
