//! The equations at many places: eight at once, on several processors.

use std::num::NonZero;
use std::sync::OnceLock;
use std::thread;

use appell_codegen::jit::Sizes;
use appell_codegen::program::FunctionKind;
use appell_runtime::inputs::ZeroInputs;
use appell_runtime::lanes::{AtLanes, LANES};
use appell_runtime::model::At;
use appell_vector::VectorFunction;

use crate::{Error, Model, ModelInputs};

/// Fewer places than this are evaluated one by one, which takes no compilation.
const FEW: usize = 64;
/// Places that are worth a thread.
const PLACES_OF_A_THREAD: usize = 1024;

/// A list of numbers at each place, row by row, or one for all.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    numbers: &'a [f64],
    width: usize,
    /// From a row to the next; zero if there is one for all.
    step: usize,
}

impl<'a> Rows<'a> {
    /// Rows of this width.
    pub const fn each(numbers: &'a [f64], width: usize) -> Self {
        Self {
            numbers,
            width,
            step: width,
        }
    }

    /// The same row everywhere.
    pub const fn same(numbers: &'a [f64]) -> Self {
        Self {
            numbers,
            width: numbers.len(),
            step: 0,
        }
    }

    /// Numbers in a row.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// A row.
    pub fn row(&self, place: usize) -> &'a [f64] {
        &self.numbers[place * self.step..][..self.width]
    }

    /// The rows of eight places from `first`; places beyond `last` are like it.
    fn load(&self, first: usize, last: usize, to: &mut [[f64; LANES]]) {
        for lane in 0..LANES {
            let row = self.row((first + lane).min(last));
            for (to, number) in to.iter_mut().zip(row) {
                to[lane] = *number;
            }
        }
    }
}

/// Places at which the equations are evaluated, in SI.
#[derive(Debug, Clone, Copy)]
pub struct Places<'a> {
    /// Times, one in a row.
    pub t: Rows<'a>,
    /// States.
    pub x: Rows<'a>,
    /// All inputs, or the declared ones; signals have the values of their tables then.
    pub u: Rows<'a>,
    /// Parameters.
    pub p: Rows<'a>,
    /// Pseudo-accelerations, for functions that take them.
    pub accelerations: Rows<'a>,
}

/// Compiled functions of eight places.
#[derive(Debug, Default)]
pub(crate) struct Vectors([OnceLock<Option<VectorFunction>>; FunctionKind::ALL.len()]);

impl Model {
    /// Evaluates a function at `count` places: `results` are its arrays, row by row for each place. `alone` evaluates it at one
    /// place with its pseudo-accelerations; numbers have the same bits in any case. Without a number of `threads` all
    /// processors are used where that is worth it.
    pub fn at_places<const R: usize>(
        &self,
        function: Option<FunctionKind>,
        places: &Places<'_>,
        count: usize,
        mut results: [&mut [f64]; R],
        threads: Option<usize>,
        alone: impl Fn(At<'_>, &[f64], [&mut [f64]; R]) + Sync,
    ) -> Result<(), Error> {
        let together = match function {
            Some(kind) if count >= FEW => self.vector(kind)?,
            _ => None,
        };
        let most = threads.unwrap_or_else(|| {
            let processors = thread::available_parallelism().map_or(1, NonZero::get);
            processors.min(count / PLACES_OF_A_THREAD)
        });
        let share = count
            .div_ceil(most.max(1))
            .next_multiple_of(LANES)
            .max(LANES);
        let sizes = results.each_ref().map(|result| result.len() / count.max(1));
        let work = |first: usize, end: usize, results: [&mut [f64]; R]| match together {
            Some(function) => self.in_blocks(function, places, first, end, results),
            None => self.one_by_one(places, first, end, results, &alone),
        };
        thread::scope(|scope| {
            for first in (0..count).step_by(share) {
                let end = count.min(first + share);
                let mut sizes = sizes.into_iter();
                let own = results.each_mut().map(|result| {
                    let size = sizes.next().unwrap_or(0);
                    let (own, others) = std::mem::take(result).split_at_mut(size * (end - first));
                    *result = others;
                    own
                });
                if end < count {
                    scope.spawn(move || work(first, end, own));
                } else {
                    work(first, end, own);
                }
            }
        });
        Ok(())
    }

    /// A function of eight places, unless the model lacks it.
    fn vector(&self, kind: FunctionKind) -> Result<Option<&VectorFunction>, Error> {
        let Some(tape) = self.made()?.tapes().get(kind) else {
            return Ok(None);
        };
        let known = self.vectors.0[kind as usize].get_or_init(|| {
            let sizes = Sizes::from(self.info());
            let function = VectorFunction::compile(tape, sizes).ok();
            function.filter(VectorFunction::is_vector)
        });
        Ok(known.as_ref())
    }

    fn in_blocks<const R: usize>(
        &self,
        function: &VectorFunction,
        places: &Places<'_>,
        first: usize,
        end: usize,
        mut results: [&mut [f64]; R],
    ) {
        let info = self.info();
        let zeros = |count: usize| vec![[0.0; LANES]; count];
        let (mut x, mut u, mut p) = (
            zeros(info.state_len()),
            zeros(info.input_len()),
            zeros(info.parameter_len()),
        );
        let (mut t, mut own) = (zeros(1), zeros(info.speeds));
        let sizes = results
            .each_ref()
            .map(|result| result.len() / (end - first));
        let mut found = sizes.map(zeros);
        let signals = self.signals(places);
        for (from, column) in [(places.p, &mut p), (places.u, &mut u)] {
            if from.step == 0 {
                from.load(first, end - 1, column);
            }
        }
        for block in (first..end).step_by(LANES) {
            let last = end - 1;
            places.t.load(block, last, &mut t);
            places.x.load(block, last, &mut x);
            places.accelerations.load(block, last, &mut own);
            if places.p.step > 0 {
                places.p.load(block, last, &mut p);
            }
            if let Some(signals) = &signals {
                let mut all = vec![0.0; info.input_len()];
                for lane in 0..LANES {
                    let place = (block + lane).min(last);
                    signals.fill(places.t.row(place)[0], places.x.row(place), &mut all);
                    for (u, value) in u.iter_mut().zip(&all) {
                        u[lane] = *value;
                    }
                }
            }
            if places.u.step > 0 || signals.is_some() {
                places.u.load(block, last, &mut u);
            }
            let at = AtLanes {
                t: &t[0],
                x: &x,
                u: &u,
                p: &p,
            };
            function.call_weighted(at, &own, found.each_mut().map(Vec::as_mut_slice));
            let lanes = LANES.min(end - block);
            for ((result, found), size) in results.iter_mut().zip(&found).zip(sizes) {
                let rows = &mut result[(block - first) * size..][..lanes * size];
                for (lane, row) in rows.chunks_mut(size.max(1)).enumerate() {
                    for (to, from) in row.iter_mut().zip(found) {
                        *to = from[lane];
                    }
                }
            }
        }
    }

    fn one_by_one<const R: usize>(
        &self,
        places: &Places<'_>,
        first: usize,
        end: usize,
        mut results: [&mut [f64]; R],
        alone: &impl Fn(At<'_>, &[f64], [&mut [f64]; R]),
    ) {
        let sizes = results
            .each_ref()
            .map(|result| result.len() / (end - first).max(1));
        let signals = self.signals(places);
        let mut all = vec![0.0; self.info().input_len()];
        for place in first..end {
            let (t, x, mut u) = (
                places.t.row(place)[0],
                places.x.row(place),
                places.u.row(place),
            );
            if let Some(signals) = &signals {
                signals.fill(t, x, &mut all);
                all[..u.len()].copy_from_slice(u);
                u = &all;
            }
            let at = At {
                t,
                x,
                u,
                p: places.p.row(place),
            };
            let mut sizes = sizes.into_iter();
            let own = results.each_mut().map(|result| {
                let size = sizes.next().unwrap_or(0);
                &mut result[(place - first) * size..][..size]
            });
            alone(at, places.accelerations.row(place), own);
        }
    }

    /// The tables of signals where these are not given; they were checked when the model was made.
    fn signals(&self, places: &Places<'_>) -> Option<ModelInputs<'_>> {
        let are_missing = places.u.width() < self.info().input_len();
        are_missing
            .then(|| ModelInputs::new(self.info(), &ZeroInputs).ok())
            .flatten()
    }
}
