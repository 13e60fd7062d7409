//! Stretches of long recordings, as fits do not need all rows.

use std::ops::Range;

use crate::{DataSet, Run};

/// Least number of rows of a stretch, as its initial state is unknown.
const LENGTH: usize = 1000;

impl DataSet {
    /// Number of rows of all runs.
    pub fn rows(&self) -> usize {
        self.runs.iter().map(|run| run.times.len()).sum()
    }

    /// About `most` rows: each run keeps its share, in stretches spread evenly over it. A data set
    /// with fewer rows is unchanged.
    #[must_use]
    pub fn stretches(&self, most: usize) -> Self {
        let all = self.rows();
        if all <= most {
            return self.clone();
        }
        let runs = self.runs.iter().flat_map(|run| {
            let rows = run.times.len();
            let pieces = pieces(rows, (rows * most / all).max(1));
            pieces.into_iter().map(|piece| cut(run, piece))
        });
        Self {
            runs: runs.collect(),
            ..self.clone()
        }
    }

    /// Windows of so many seconds, about `most` of them, spread evenly over all runs, each with no more than
    /// about `rows` rows.
    #[must_use]
    pub fn windows(&self, length: f64, (most, rows): (usize, usize)) -> Self {
        let ends = |run: &Run| (run.times[0], run.times[run.times.len() - 1]);
        let total: f64 = self.runs.iter().map(ends).map(|(from, to)| to - from).sum();
        let runs = self.runs.iter().flat_map(|run| {
            let (from, to) = ends(run);
            let count = ((to - from) / total * most as f64).round().max(1.0);
            // As many as asked for.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let places = 0..count as usize;
            places.map(move |place| {
                let room = (to - from - length).max(0.0);
                let begin = from + room * (place as f64 + 0.5) / count;
                let [a, b] =
                    [begin, begin + length].map(|end| run.times.partition_point(|t| *t < end));
                self.thinned(&cut(run, a..b), rows)
            })
        });
        Self {
            runs: runs.filter(|run| run.times.len() > 1).collect(),
            ..self.clone()
        }
    }

    /// A run with no more than about so many rows: what is measured in those that remain, and the mean of each
    /// input until the next of them.
    fn thinned(&self, run: &Run, most: usize) -> Run {
        let every = run.times.len() / most;
        if every < 2 {
            return run.clone();
        }
        let kept = (0..run.times.len()).step_by(every);
        let columns = self.channels.iter().zip(&run.values);
        let values = columns.map(|(channel, values)| {
            let mean = |row: usize| {
                let held = &values[row..values.len().min(row + every)];
                held.iter().sum::<f64>() / held.len() as f64
            };
            let is_held = matches!(channel.role, crate::Role::Input(_));
            let value = |row: usize| if is_held { mean(row) } else { values[row] };
            kept.clone().map(value).collect()
        });
        Run {
            times: kept.clone().map(|row| run.times[row]).collect(),
            values: values.collect(),
            ..run.clone()
        }
    }
}

/// Stretches of `kept` rows together, each in the middle of its part of the run.
fn pieces(rows: usize, kept: usize) -> Vec<Range<usize>> {
    let count = (kept / LENGTH).max(1);
    let length = kept / count;
    let piece = |index: usize| {
        let [from, to] = [index, index + 1].map(|end| rows * end / count);
        let start = from + (to - from - length.min(to - from)) / 2;
        start..start + length
    };
    (0..count).map(piece).collect()
}

fn cut(run: &Run, rows: Range<usize>) -> Run {
    let values = run.values.iter();
    Run {
        times: run.times[rows.clone()].to_vec(),
        values: values.map(|column| column[rows.clone()].to_vec()).collect(),
        ..run.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_lie_apart_within_their_run_and_have_the_rows_that_were_asked_for() {
        for (rows, kept) in [(10_000, 4000), (5001, 4999), (20_000, 1), (1500, 1400)] {
            let pieces = pieces(rows, kept);
            let sum: usize = pieces.iter().map(ExactSizeIterator::len).sum();
            assert!(sum <= kept && sum + pieces.len() > kept, "{sum} of {kept}");
            assert!(pieces.windows(2).all(|pair| pair[0].end <= pair[1].start));
            assert!(pieces.iter().all(|piece| piece.end <= rows));
        }
        assert_eq!(pieces(10_000, 2000), [2000..3000, 7000..8000]);
    }
}
