//! What the numbers of two columns say of each other: rates and positions, commands and what follows them.

use super::log::Log;

/// Length of the windows over which a rate is integrated, in s.
const WINDOW: f64 = 0.1;
/// Range of delays that are searched, in s.
const DELAYS: [f64; 2] = [-0.1, 0.5];
/// Largest number of rows by which columns are shifted.
const MOST_ROWS: usize = 120;
/// Rows of a run that are compared.
const ROWS: usize = 20_000;

/// How one column follows another: y = slope · x, with the correlation of both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Relation {
    pub(super) slope: f64,
    pub(super) correlation: f64,
}

#[derive(Default)]
struct Sums {
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Sums {
    fn add(&mut self, x: f64, y: f64) {
        if x.is_finite() && y.is_finite() {
            self.xx += x * x;
            self.xy += x * y;
            self.yy += y * y;
        }
    }

    fn relation(&self) -> Option<Relation> {
        let found = self.xx > 0.0 && self.yy > 0.0;
        found.then(|| Relation {
            slope: self.xy / self.xx,
            correlation: self.xy / (self.xx * self.yy).sqrt(),
        })
    }
}

/// A rate relative to the derivative of a position, by its integrals over short windows.
pub(super) fn rate_of(log: &Log, position: usize, rate: usize) -> Option<Relation> {
    let mut sums = Sums::default();
    for run in &log.runs {
        let (times, x, v) = (&run.times, &run.values[position], &run.values[rate]);
        let rows = times.len().min(ROWS).min(x.len()).min(v.len());
        let mut first = 0;
        while first < rows {
            let (mut integral, mut last) = (0.0, first);
            while last + 1 < rows && (times[last] - times[first] < WINDOW || last < first + 3) {
                let step = times[last + 1] - times[last];
                integral += step * f64::midpoint(v[last], v[last + 1]);
                last += 1;
            }
            sums.add(x[last] - x[first], integral);
            first = last.max(first + 1);
        }
    }
    sums.relation()
}

/// How a column follows a command after the best delay, with that delay in s.
pub(super) fn follows(log: &Log, command: usize, column: usize) -> Option<(Relation, f64)> {
    let step = log.runs.iter().find_map(|run| {
        let rows = run.times.len().min(ROWS);
        let passed = run.times.get(rows.checked_sub(1)?)? - run.times[0];
        (rows > 1 && passed > 0.0).then(|| passed / (rows - 1) as f64)
    })?;
    let rows = |seconds: f64| {
        let shifts = (1..=MOST_ROWS).take_while(|rows| *rows as f64 * step < seconds.abs());
        shifts.count()
    };
    let back = (1..=rows(DELAYS[0])).rev().map(|rows| (rows, true));
    let shifts = back.chain((0..=rows(DELAYS[1])).map(|rows| (rows, false)));
    let mut best: Option<(Relation, f64)> = None;
    for (shift, is_before) in shifts {
        let mut sums = Sums::default();
        for run in &log.runs {
            let (u, y) = (&run.values[command], &run.values[column]);
            let (early, late) = if is_before { (y, u) } else { (u, y) };
            let count = early.len().min(late.len()).min(ROWS);
            if count <= shift {
                continue;
            }
            let (early, late) = (&early[..count - shift], &late[shift..count]);
            let [a, b] = [mean(early), mean(late)];
            for (early, late) in early.iter().zip(late) {
                let (early, late) = (early - a, late - b);
                if is_before {
                    sums.add(late, early);
                } else {
                    sums.add(early, late);
                }
            }
        }
        let delay = step * shift as f64 * if is_before { -1.0 } else { 1.0 };
        if let Some(relation) = sums.relation()
            && best.is_none_or(|(own, _)| relation.correlation.abs() > own.correlation.abs())
        {
            best = Some((relation, delay));
        }
    }
    best
}

fn mean(values: &[f64]) -> f64 {
    let there = || values.iter().copied().filter(|value| value.is_finite());
    there().sum::<f64>() / there().count().max(1) as f64
}
