//! Segments of long recordings, as fits do not need all rows.

use std::ops::Range;

use appell_estimate::EstimateError;

use crate::channel::{Channel, Role};
use crate::clock::Sampling;
use crate::finding::{Finding, FindingKind, counted};
use crate::{DataSet, Row, Run};

/// Least number of rows of a segment, as its initial state is unknown; fewer if they contain this many measured
/// values, which determine it.
const LENGTH: usize = 1000;
const VALUES: usize = 4000;
/// Time in s before a window of which inputs are kept.
const BEFORE: f64 = 0.5;
/// Least number of rows of a piece of an interrupted run.
const SHORTEST: usize = 10;

impl DataSet {
    /// Number of rows of all runs.
    pub fn rows(&self) -> usize {
        self.runs.iter().map(|run| run.times.len()).sum()
    }

    /// About `most` rows, in proportion to the length of each run, as segments spread evenly over it. A data set
    /// with fewer rows is unchanged.
    #[must_use]
    pub fn stretches(&self, most: usize) -> Self {
        let all = self.rows();
        if all <= most {
            return self.clone();
        }
        let measured = self.channels.iter().filter(|channel| channel.is_measured());
        let length = LENGTH.min(VALUES / measured.count().max(1)).max(1);
        let runs = self.runs.iter().flat_map(|run| {
            let rows = run.times.len();
            let pieces = pieces(rows, (rows * most / all).max(1), length);
            pieces.into_iter().map(|piece| cut(run, piece))
        });
        Self {
            runs: runs.collect(),
            ..self.clone()
        }
    }

    /// The same without the rows between two times of a run, for each of these windows; pieces too short for a motion
    /// are dropped.
    #[must_use]
    pub fn without(&self, windows: &[(String, [f64; 2])]) -> Self {
        let pieces = self.runs.iter().flat_map(|run| without(run, windows));
        Self {
            runs: pieces.collect(),
            ..self.clone()
        }
    }

    /// Windows of `length` seconds, about `most` of them, spread evenly over all runs, each with no more than
    /// about `rows` rows.
    pub fn windows(&self, length: f64, most: usize, rows: usize) -> Result<Self, EstimateError> {
        // Subsampled rows use the mean of an input, not its value at their beginning.
        let held = self.clone().held_at_means()?;
        let set = &held;
        let ends = |run: &Run| (run.times[0], run.times[run.times.len() - 1]);
        let total: f64 = set.runs.iter().map(ends).map(|(from, to)| to - from).sum();
        let runs = set.runs.iter().flat_map(|run| {
            let (from, to) = ends(run);
            let count = ((to - from) / total * most as f64).round().max(1.0);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let places = 0..count as usize;
            places.map(move |place| {
                let room = (to - from - length).max(0.0);
                let begin = from + room * (place as f64 + 0.5) / count;
                let [a, b] =
                    [begin, begin + length].map(|end| run.times.partition_point(|t| *t < end));
                set.thinned(&cut(run, a..b), rows)
            })
        });
        let runs = runs.filter(|run| run.times.len() > 1);
        let runs = runs.collect();
        Ok(Self { runs, ..held })
    }

    /// A run subsampled to about `most` rows: the measurements of the remaining rows, and the mean of each input up to
    /// the next of them.
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
            let is_held = matches!(channel.role, Role::Input(_));
            let value = |row: usize| if is_held { mean(row) } else { values[row] };
            kept.clone().map(value).collect()
        });
        Run {
            times: kept.clone().map(|row| run.times[row]).collect(),
            values: values.collect(),
            between: listed(run, 0..run.times.len()),
            ..run.clone()
        }
    }
}

/// Runs cut at their gaps if there are inputs, as these are unknown in between. Pieces too short for a motion are
/// dropped; each cut is reported.
pub(crate) fn uninterrupted(
    runs: Vec<Run>,
    channels: &[Channel],
    findings: &mut Vec<Finding>,
) -> Vec<Run> {
    let is_input = |channel: &Channel| matches!(channel.role, Role::Input(_));
    if !channels.iter().any(is_input) {
        return runs;
    }
    let mut pieces = Vec::new();
    for run in runs {
        if run.sampling.gaps.is_empty() {
            pieces.push(run);
            continue;
        }
        let starts = run
            .sampling
            .gaps
            .iter()
            .map(|[_, end]| run.times.partition_point(|t| t < end));
        let ends: Vec<usize> = starts.chain([run.times.len()]).collect();
        let mut from = 0;
        let mut kept = 0;
        for to in ends {
            if to - from >= SHORTEST {
                kept += 1;
                let mut piece = cut(&run, from..to);
                piece.name = format!("{}#{kept}", run.name);
                piece.sampling = Sampling::of(&piece.times);
                pieces.push(piece);
            }
            from = to;
        }
        let message = format!(
            "cut at its {} into {}, as the inputs in between were not recorded",
            if run.sampling.gaps.len() == 1 {
                "gap"
            } else {
                "gaps"
            },
            counted(kept, "run")
        );
        findings.push(Finding::new(FindingKind::Cut, message).in_run(&run.name));
    }
    pieces
}

/// The pieces of a run outside of its windows.
fn without(run: &Run, windows: &[(String, [f64; 2])]) -> Vec<Run> {
    let own = windows.iter().filter(|(name, _)| *name == run.name);
    let mut cuts: Vec<[usize; 2]> = own
        .map(|(_, [from, to])| {
            let end = run.times.partition_point(|t| t <= to);
            [run.times.partition_point(|t| t < from), end]
        })
        .collect();
    cuts.sort_unstable();
    cuts.push([run.times.len(); 2]);
    let mut start = 0;
    let mut pieces = Vec::new();
    for [from, to] in cuts {
        if from >= start + SHORTEST {
            pieces.push(cut(run, start..from));
        }
        start = start.max(to);
    }
    pieces
}

/// Segments of `kept` rows in total and at least about `least` rows each, each in the middle of its part of the run.
fn pieces(rows: usize, kept: usize, least: usize) -> Vec<Range<usize>> {
    let count = (kept / least).max(1);
    let length = kept / count;
    let piece = |index: usize| {
        let [from, to] = [index, index + 1].map(|end| rows * end / count);
        let start = from + (to - from - length.min(to - from)) / 2;
        start..start + length
    };
    (0..count).map(piece).collect()
}

/// The last rows before one of a run.
fn earlier(run: &Run, row: usize) -> Vec<Row> {
    let begin = run.times.get(row).map_or(f64::INFINITY, |t| t - BEFORE);
    let first = run.times.partition_point(|t| *t < begin);
    listed(run, first.min(row)..row)
}

fn listed(run: &Run, rows: Range<usize>) -> Vec<Row> {
    let row = |row: usize| Row {
        t: run.times[row],
        values: run.values.iter().map(|column| column[row]).collect(),
    };
    rows.map(row).collect()
}

/// Some rows of a run, with those shortly before them.
pub(crate) fn cut(run: &Run, rows: Range<usize>) -> Run {
    let values = run.values.iter();
    Run {
        name: run.name.clone(),
        part: run.part,
        sampling: run.sampling.clone(),
        times: run.times[rows.clone()].to_vec(),
        values: values.map(|column| column[rows.clone()].to_vec()).collect(),
        earlier: earlier(run, rows.start),
        between: Vec::new(),
        differences: run.differences.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Part;

    #[test]
    fn rows_between_two_times_are_taken_out_of_their_run() {
        let times: Vec<f64> = (0..100).map(f64::from).collect();
        let run = |name: &str| Run {
            name: name.to_owned(),
            part: Part::Fit,
            sampling: Sampling::of(&times),
            values: vec![times.clone()],
            times: times.clone(),
            earlier: Vec::new(),
            between: Vec::new(),
            differences: Vec::new(),
        };
        let runs = [run("a"), run("b")];
        let windows = [
            ("a", [60.0, 70.0]),
            ("a", [20.5, 30.0]),
            ("a", [95.0, 200.0]),
        ];
        let rest: Vec<_> = runs
            .iter()
            .map(|run| without(run, &windows.map(|(n, w)| (n.to_owned(), w))))
            .collect();
        let ends = |run: &Run| [run.times[0], run.times[run.times.len() - 1]];
        assert_eq!(
            rest[0].iter().map(ends).collect::<Vec<_>>(),
            [[0.0, 20.0], [31.0, 59.0], [71.0, 94.0]]
        );
        assert_eq!(rest[1].iter().map(ends).collect::<Vec<_>>(), [[0.0, 99.0]]);
    }

    #[test]
    fn stretches_lie_apart_within_their_run_and_have_the_rows_that_were_asked_for() {
        for (rows, kept) in [(10_000, 4000), (5001, 4999), (20_000, 1), (1500, 1400)] {
            let pieces = pieces(rows, kept, LENGTH);
            let sum: usize = pieces.iter().map(ExactSizeIterator::len).sum();
            assert!(sum <= kept && sum + pieces.len() > kept, "{sum} of {kept}");
            assert!(pieces.windows(2).all(|pair| pair[0].end <= pair[1].start));
            assert!(pieces.iter().all(|piece| piece.end <= rows));
        }
        assert_eq!(pieces(10_000, 2000, LENGTH), [2000..3000, 7000..8000]);
        assert_eq!(pieces(5000, 700, 333), [1075..1425, 3575..3925]);
    }
}
