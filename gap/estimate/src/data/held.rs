//! Inputs that are held from each time to the next: means, moments, lags.

/// Inputs that are held from each time to the next.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Held {
    pub(super) times: Vec<f64>,
    /// Row by row.
    pub(super) inputs: Vec<f64>,
    /// Number of inputs.
    pub(super) count: usize,
}

/// Time constants after which a lag has forgotten its input.
const FORGOTTEN: f64 = 40.0;

impl Held {
    /// No rows.
    pub(super) const fn none(count: usize) -> Self {
        Self {
            times: Vec::new(),
            inputs: Vec::new(),
            count,
        }
    }

    /// Rows of inputs; `None` unless there is a finite value of each input for each time.
    pub(super) fn of(times: Vec<f64>, inputs: Vec<f64>, count: usize) -> Option<Self> {
        let is_whole = inputs.len() == times.len() * count && inputs.iter().all(|u| u.is_finite());
        is_whole.then_some(Self {
            times,
            inputs,
            count,
        })
    }

    /// An input at a row.
    pub(super) fn at(&self, row: usize, input: usize) -> f64 {
        self.inputs[row * self.count + input]
    }

    /// From half a row before the time of a row to half a row after it.
    pub(super) fn about(&self, t: f64) -> [f64; 2] {
        let row = self.times.partition_point(|own| *own < t);
        let before = row.checked_sub(1).map(|row| t - self.times[row]);
        let after = self.times.get(row + 1).map(|next| next - t);
        let [before, after] = [before.or(after), after.or(before)].map(Option::unwrap_or_default);
        [t - 0.5 * before, t + 0.5 * after]
    }

    /// An input at a time; before the first row that of the first.
    pub(super) fn held_at(&self, input: usize, t: f64) -> f64 {
        let rows = self.times.partition_point(|own| *own <= t);
        self.at(rows.saturating_sub(1), input)
    }

    /// Its mean from one time to another.
    pub(super) fn mean_between(&self, input: usize, ends: [f64; 2]) -> f64 {
        self.moments(input, ends)[0] / (ends[1] - ends[0])
    }

    /// Its integral from one time to another, and that of its product with the time since their middle.
    pub(super) fn moments(&self, input: usize, [from, to]: [f64; 2]) -> [f64; 2] {
        let rows = self.times.partition_point(|t| *t <= from)..;
        let ends = self.times[rows].iter().copied();
        let middle = 0.5 * (from + to);
        let (mut moments, mut begin) = ([0.0; 2], from);
        for end in ends.take_while(|end| *end < to).chain([to]) {
            let area = (end - begin) * self.held_at(input, begin);
            moments[0] += area;
            moments[1] += area * (0.5 * (begin + end) - middle);
            begin = end;
        }
        moments
    }

    /// Its changes from one time to another, times half the squares of the times from them to the end on their side of a
    /// time between, divided by the whole time: the mean of its integral less the value of that at the time between.
    pub(super) fn kinks(&self, input: usize, [from, to]: [f64; 2], t: f64) -> f64 {
        let first = self.times.partition_point(|own| *own <= from).max(1);
        let rows = (first..self.times.len()).take_while(|&row| self.times[row] < to);
        let of_row = |row: usize| {
            let own = self.times[row];
            let reach = if own >= t { to - own } else { own - from };
            let [before, after] = [row - 1, row].map(|row| self.at(row, input));
            0.5 * (after - before) * reach * reach
        };
        rows.map(of_row).sum::<f64>() / (to - from)
    }

    /// An input that lags, at a time, and its derivative by the time constant. It was at rest long before.
    pub(super) fn lagged_at(&self, input: usize, t: f64, time_constant: f64) -> [f64; 2] {
        let past = t - FORGOTTEN * time_constant;
        let (mut begin, mut lagged, mut slope) = (past, self.held_at(input, past), 0.0);
        let rows = self.times.partition_point(|own| *own <= past)..;
        let ends = self.times[rows].iter().copied();
        for end in ends.take_while(|end| *end < t).chain([t]) {
            let (held, times) = (self.held_at(input, begin), (end - begin) / time_constant);
            let ahead = lagged - held;
            let decay = (-times).exp();
            slope = decay * (slope + ahead * times / time_constant);
            (lagged, begin) = (held + decay * ahead, end);
        }
        [lagged, slope]
    }

    /// The line with the same moments: its value at the beginning and its slope.
    pub(super) fn line(&self, input: usize, ends: [f64; 2]) -> [f64; 2] {
        let length = ends[1] - ends[0];
        let [integral, first] = self.moments(input, ends);
        let slope = 12.0 * first / length.powi(3);
        [integral / length - 0.5 * slope * length, slope]
    }
}
