//! Stretches of long recordings, as fits do not need all rows.

use std::ops::Range;

use super::{DataSet, Run};

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
