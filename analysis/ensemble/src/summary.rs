//! Statistics of the rows of a study with intervals, in memory that does not grow with the number of cases.

use std::collections::{BTreeMap, BTreeSet};

use crate::design::{Design, Sampling};
use crate::rows::{Column, Role, Rows};
use crate::splitting::Probability;
use crate::statistics::beta;
use crate::statistics::moments::Moments;
use crate::statistics::order::{self, Quantile, Selection};
use crate::statistics::sensitivity::{Indices, Sums};

/// Quantiles of every number, and of bands over time.
pub const PARTS: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];
/// Bars of a histogram.
const BARS: usize = 40;
/// Cases that figures show as points.
const POINTS: usize = 2000;

/// Different reasons of early ends that are counted one by one, and the word for the others.
const REASONS: usize = 100;
const OTHERS: &str = "another reason";

/// The statistics of a study.
#[derive(Debug, Clone)]
pub struct Summary {
    /// All cases of the study.
    pub cases: u64,
    /// Those whose rows are there.
    pub done: u64,
    /// Reasons of early ends, with their numbers, the most frequent first.
    pub early: Vec<(String, u64)>,
    /// Factors and kept numbers.
    pub numbers: Vec<Number>,
    /// Events.
    pub events: Vec<Event>,
    /// Courses.
    pub courses: Vec<Course>,
    /// Effects of the factors on kept numbers and events.
    pub effects: Vec<Effects>,
    /// The first cases, one list a column; courses are left out.
    pub points: Vec<Vec<f64>>,
    /// Whether the intervals hold for independent cases, or are wider than need be.
    pub sampling: Sampling,
    /// The rare event with its probability, if requested.
    pub rare: Option<(String, Probability)>,
}

/// A column of numbers.
#[derive(Debug, Clone)]
pub struct Number {
    /// The column.
    pub column: usize,
    /// Count, mean, extremes.
    pub moments: Moments,
    /// Quantiles at [`PARTS`]; none without numbers.
    pub quantiles: Vec<Quantile>,
    /// Cases in equal parts from the smallest to the largest number.
    pub bars: Vec<u64>,
}

/// An event.
#[derive(Debug, Clone)]
pub struct Event {
    /// The column.
    pub column: usize,
    /// Cases in which it is known.
    pub of: u64,
    /// Cases in which it happened.
    pub happened: u64,
    /// Interval by Wilson.
    pub wilson: [f64; 2],
    /// Interval by Clopper and Pearson.
    pub exact: [f64; 2],
}

/// Quantiles over time.
#[derive(Debug, Clone)]
pub struct Course {
    /// Its name.
    pub name: String,
    /// Its first column.
    pub column: usize,
    /// Times in s.
    pub times: Vec<f64>,
    /// For each of [`PARTS`] the quantile over time; NaN where there is no number.
    pub bands: Vec<Vec<f64>>,
    /// The mean over time.
    pub mean: Vec<f64>,
}

/// How a number or an event depends on the factors.
#[derive(Debug, Clone)]
pub struct Effects {
    /// The column of the number or event.
    pub column: usize,
    /// For each factor the means where it is in its lowest and in its highest quarter; NaN where there are none.
    pub ends: Vec<[f64; 2]>,
    /// For each factor its indices, where the sampling is made for them.
    pub indices: Option<Vec<Indices>>,
}

/// A column while its numbers are shown.
struct Seen {
    column: usize,
    moments: Moments,
    selection: Selection,
    /// Ranks of the quantiles.
    ranks: Vec<[Option<u64>; 4]>,
}

/// Results of one pass over the rows.
struct Counts {
    done: u64,
    early: BTreeMap<String, u64>,
    /// Columns of events, in how many cases each is known, and in how many it happened.
    events: Vec<(usize, u64, u64)>,
    points: Vec<Vec<f64>>,
    seen: Vec<Seen>,
}

impl Counts {
    fn new(columns: &[Column]) -> Self {
        let is_event = |column: &usize| columns[*column].role == Role::Event;
        let all = 0..columns.len();
        let seen = all
            .clone()
            .filter(|column| !is_event(column))
            .map(|column| Seen {
                column,
                moments: Moments::default(),
                selection: Selection::new(&[]),
                ranks: Vec::new(),
            });
        Self {
            done: 0,
            early: BTreeMap::new(),
            seen: seen.collect(),
            events: all.filter(is_event).map(|column| (column, 0, 0)).collect(),
            points: vec![Vec::new(); columns.len()],
        }
    }

    fn see(&mut self, rows: &Rows, columns: &[Column]) {
        self.done += rows.len() as u64;
        for reason in rows.reasons.iter().filter(|reason| !reason.is_empty()) {
            let is_known = self.early.len() < REASONS || self.early.contains_key(reason);
            let reason = if is_known { reason.as_str() } else { OTHERS };
            *self.early.entry(reason.to_owned()).or_default() += 1;
        }
        for seen in &mut self.seen {
            for &value in &rows.values[seen.column] {
                seen.moments.add(value);
            }
        }
        for (column, of, happened) in &mut self.events {
            for value in rows.values[*column].iter().filter(|v| v.is_finite()) {
                *of += 1;
                *happened += u64::from(*value != 0.0);
            }
        }
        let lists = self.points.iter_mut().zip(&rows.values).zip(columns);
        for ((points, values), column) in lists {
            if !is_course(column) {
                let room = POINTS.saturating_sub(points.len());
                points.extend(values.iter().take(room));
            }
        }
    }

    /// Finds the quantiles of all columns, some columns at a time: the digit counts take memory.
    fn seek<E>(
        &mut self,
        columns: &[Column],
        scan: &mut impl FnMut(Wanted<'_>, See<'_>) -> Result<(), E>,
    ) -> Result<BTreeMap<usize, Vec<Quantile>>, E> {
        let mut found = BTreeMap::new();
        for some in self.seen.chunks_mut(TOGETHER) {
            for seen in &mut *some {
                let count = seen.moments.count;
                seen.ranks = PARTS.map(|part| order::ranks(part, count)).to_vec();
                if is_course(&columns[seen.column]) {
                    // Bands have no intervals.
                    for ranks in &mut seen.ranks {
                        ranks[2..].fill(None);
                    }
                }
                let ranks: Vec<u64> = seen.ranks.iter().flatten().copied().flatten().collect();
                seen.selection = Selection::new(&ranks);
            }
            let own: BTreeSet<usize> = some.iter().map(|seen| seen.column).collect();
            for _ in 0..order::PASSES {
                scan(&|column| own.contains(&column), &mut |rows| {
                    for seen in &mut *some {
                        let values = rows.values[seen.column].iter();
                        for &value in values.filter(|value| value.is_finite()) {
                            seen.selection.see(value);
                        }
                    }
                })?;
                for seen in &mut *some {
                    seen.selection.advance();
                }
            }
            for seen in some {
                found.insert(seen.column, seen.quantiles());
                seen.selection = Selection::new(&[]);
            }
        }
        Ok(found)
    }
}

/// Columns whose quantiles are sought at a time: some ten kilobytes for each digit of each rank.
const TOGETHER: usize = 256;

/// The columns that a pass needs; the others may be empty.
pub type Wanted<'w> = &'w dyn Fn(usize) -> bool;
/// Receiver of the rows in a pass.
pub type See<'s> = &'s mut dyn FnMut(&Rows);

fn is_course(column: &Column) -> bool {
    matches!(column.role, Role::Course { .. })
}

impl Summary {
    /// The statistics of rows that `scan` shows in the order of cases, as often as it is called.
    pub fn new<E>(
        columns: &[Column],
        design: &Design,
        seed: u64,
        mut scan: impl FnMut(Wanted<'_>, See<'_>) -> Result<(), E>,
    ) -> Result<Self, E> {
        let mut counts = Counts::new(columns);
        scan(&|_| true, &mut |rows| counts.see(rows, columns))?;
        let quantiles = counts.seek(columns, &mut scan)?;
        let seen = counts.seen.iter();
        let mut numbers: Vec<Number> = seen
            .filter(|seen| !is_course(&columns[seen.column]))
            .map(|seen| Number {
                column: seen.column,
                moments: seen.moments,
                quantiles: quantiles[&seen.column].clone(),
                bars: vec![0; BARS],
            })
            .collect();
        let mut effects = Collected::new(columns, design, &numbers, &quantiles);
        scan(&|column| !is_course(&columns[column]), &mut |rows| {
            for number in &mut numbers {
                let Moments { min, max, .. } = number.moments;
                let values = rows.values[number.column].iter();
                for value in values.filter(|value| value.is_finite()) {
                    number.bars[bar(*value, min, max)] += 1;
                }
            }
            effects.see(rows);
        })?;
        let mut early: Vec<(String, u64)> = counts.early.into_iter().collect();
        early.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let events = counts.events.into_iter();
        Ok(Self {
            cases: design.cases(),
            done: counts.done,
            early,
            events: events
                .map(|(column, of, happened)| Event {
                    column,
                    of,
                    happened,
                    wilson: beta::wilson(happened, of),
                    exact: beta::exact(happened, of),
                })
                .collect(),
            courses: courses(columns, &counts.seen, &quantiles),
            numbers,
            effects: effects.finish(columns, seed),
            points: counts.points,
            sampling: design.sampling(),
            rare: None,
        })
    }

    /// The number of a column.
    pub fn number(&self, column: usize) -> Option<&Number> {
        self.numbers.iter().find(|number| number.column == column)
    }
}

impl Seen {
    fn quantiles(&self) -> Vec<Quantile> {
        let numbers = self.selection.numbers();
        let mut from = 0;
        let mut quantiles = Vec::new();
        for (part, ranks) in PARTS.iter().zip(&self.ranks) {
            let count = ranks.iter().flatten().count();
            let own = &numbers[from..from + count];
            from += count;
            quantiles.extend(Quantile::new(*part, self.moments.count, *ranks, own));
        }
        quantiles
    }
}

/// The bar of a number between the ends.
fn bar(value: f64, min: f64, max: f64) -> usize {
    let part = (value - min) / (max - min);
    if !part.is_finite() {
        return 0;
    }
    // Between 0 and the number of bars.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let bar = (part * BARS as f64) as usize;
    bar.min(BARS - 1)
}

fn courses(
    columns: &[Column],
    seen: &[Seen],
    quantiles: &BTreeMap<usize, Vec<Quantile>>,
) -> Vec<Course> {
    let mut courses: Vec<Course> = Vec::new();
    for seen in seen {
        let Role::Course { of, t } = &columns[seen.column].role else {
            continue;
        };
        if courses.last().is_none_or(|course| course.name != *of) {
            courses.push(Course {
                name: of.clone(),
                column: seen.column,
                times: Vec::new(),
                bands: vec![Vec::new(); PARTS.len()],
                mean: Vec::new(),
            });
        }
        let Some(course) = courses.last_mut() else {
            continue;
        };
        course.times.push(*t);
        let has_any = seen.moments.count > 0;
        course
            .mean
            .push(if has_any { seen.moments.mean } else { f64::NAN });
        let own = &quantiles[&seen.column];
        for (place, band) in course.bands.iter_mut().enumerate() {
            band.push(own.get(place).map_or(f64::NAN, |quantile| quantile.value));
        }
    }
    courses
}

/// Effects while rows are shown.
struct Collected {
    /// Factors with the ends of their outer quarters.
    factors: Vec<(usize, [f64; 2])>,
    /// Columns of numbers and events.
    of: Vec<usize>,
    /// For each of these and each factor the means in the quarters.
    ends: Vec<Vec<[Moments; 2]>>,
    sums: Vec<Sums>,
    /// Values of the cases of a point so far, for each column.
    point: Vec<Vec<f64>>,
}

impl Collected {
    fn new(
        columns: &[Column],
        design: &Design,
        numbers: &[Number],
        quantiles: &BTreeMap<usize, Vec<Quantile>>,
    ) -> Self {
        let factor = |column: usize| {
            let own = quantiles.get(&column)?;
            let at = |place: usize| own.get(place).map(|q| q.value);
            Some((column, [at(1)?, at(3)?]))
        };
        let count = design.factors().len();
        let factors: Vec<(usize, [f64; 2])> = (0..count).filter_map(factor).collect();
        let is_answer = |c: &Column| matches!(c.role, Role::Value | Role::Event);
        let of: Vec<usize> = (0..columns.len())
            .filter(|&column| is_answer(&columns[column]))
            .collect();
        let drawn = design.drawn().count();
        let points = design.cases() / (drawn as u64 + 2);
        let shift = |column: &usize| {
            let number = numbers.iter().find(|number| number.column == *column);
            number.map_or(0.0, |number| number.moments.mean)
        };
        let sums = match design.sampling() {
            Sampling::Sensitivity => of
                .iter()
                .map(|column| Sums::new(drawn, points, shift(column), of.len()))
                .collect(),
            _ => Vec::new(),
        };
        Self {
            ends: vec![vec![[Moments::default(); 2]; factors.len()]; of.len()],
            point: vec![Vec::new(); of.len()],
            factors,
            of,
            sums,
        }
    }

    fn see(&mut self, rows: &Rows) {
        for (ends, &column) in self.ends.iter_mut().zip(&self.of) {
            for ([low, high], &(factor, [from, to])) in ends.iter_mut().zip(&self.factors) {
                let pairs = rows.values[factor].iter().zip(&rows.values[column]);
                for (&x, &y) in pairs.filter(|(_, y)| y.is_finite()) {
                    if x <= from {
                        low.add(y);
                    }
                    if x >= to {
                        high.add(y);
                    }
                }
            }
        }
        for ((sums, point), &column) in self.sums.iter_mut().zip(&mut self.point).zip(&self.of) {
            let size = self.factors.len() as u64 + 2;
            for (case, &value) in (rows.first..).zip(&rows.values[column]) {
                point.push(value);
                if case % size == size - 1 {
                    sums.add(case / size, point);
                    point.clear();
                }
            }
        }
    }

    fn finish(self, columns: &[Column], seed: u64) -> Vec<Effects> {
        let mean = |moments: Moments| {
            let has_any = moments.count > 0;
            if has_any { moments.mean } else { f64::NAN }
        };
        let effects = self.of.iter().enumerate().map(|(place, &column)| Effects {
            column,
            ends: self.ends[place].iter().map(|ends| ends.map(mean)).collect(),
            indices: self
                .sums
                .get(place)
                .and_then(|sums| sums.indices(seed, &columns[column].name)),
        });
        effects.collect()
    }
}
