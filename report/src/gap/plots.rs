//! Figures of a gap report.

use appell_gap::diagnose::{Experiment, ForceHistory, ForceLaw, Trace};
use appell_spec::Mechanism;

use crate::figure::{Layer, Look, Plot};
use crate::svg::{Document, Element, text};
use crate::text::short;

/// Number of channels drawn.
const DRAWN: usize = 3;
/// Colours: data, as stated, re-fitted, with the effect.
const COLOURS: [usize; 4] = [2, 1, 4, 0];

/// The channels whose predictions the effect improves most, in the order of the recordings.
pub(super) fn most_bettered<'t>(traces: impl Iterator<Item = &'t Trace>) -> Vec<&'t Trace> {
    let traces: Vec<&Trace> = traces.collect();
    let mut order: Vec<usize> = (0..traces.len()).collect();
    let gain = |&i: &usize| better(traces[i]);
    order.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    order.truncate(DRAWN);
    order.sort_unstable();
    order.into_iter().map(|i| traces[i]).collect()
}

/// Decrease of the mean square prediction error, relative to its expected value.
fn better(trace: &Trace) -> f64 {
    let square = |predicted: &[f64]| -> f64 {
        let errors = errors(trace, predicted).into_iter();
        let finite = errors.filter(|error| error.is_finite());
        finite.map(|error| error * error).sum()
    };
    (square(&trace.refitted) - square(&trace.with_effect)) / trace.deviation.powi(2)
}

fn errors(trace: &Trace, predicted: &[f64]) -> Vec<f64> {
    (trace.measured.iter().zip(predicted))
        .map(|(measured, predicted)| measured - predicted)
        .collect()
}

/// A channel with its predictions and their errors.
pub(super) fn trace(trace: &Trace) -> [String; 2] {
    let [data, stated, refitted, effect] = COLOURS;
    let layer =
        |label: &str, look, colour, y: Vec<f64>| Layer::new(label, look, colour, &trace.times, y);
    let plot = |name: &str, height, first: Layer, shown: &dyn Fn(&[f64]) -> Vec<f64>| {
        let plot = Plot {
            labels: ["t [s]".to_owned(), format!("{name} [{}]", trace.unit)],
            height,
            layers: vec![
                first,
                layer("as stated", Look::Line, stated, shown(&trace.nominal)),
                layer("re-fitted", Look::Line, refitted, shown(&trace.refitted)),
                layer(
                    "with the effect",
                    Look::Line,
                    effect,
                    shown(&trace.with_effect),
                ),
            ],
        };
        plot.to_svg()
    };
    let measured = layer("measured", Look::Points, data, trace.measured.clone());
    let wide = 2.0 * trace.deviation;
    let edge = |value: f64| vec![value; trace.times.len()];
    let expected = layer("expected", Look::Band(edge(wide)), data, edge(-wide));
    [
        plot(&trace.column, 170.0, measured, &<[f64]>::to_vec),
        plot("error", 150.0, expected, &|predicted| {
            errors(trace, predicted)
        }),
    ]
}

/// The missing force against the variable on which it depends.
pub(super) fn law(law: &ForceLaw) -> String {
    let force = format!(
        "missing force in the equation of {} [{}]",
        law.equation, law.unit
    );
    over_variable(law, force, 260.0)
}

/// The missing torques of joints over their rates and positions.
pub(super) fn joints(joints: &[[ForceLaw; 2]]) -> impl Iterator<Item = String> {
    let laws = joints.iter().flatten();
    laws.map(|law| over_variable(law, format!("missing [{}]", law.unit), 190.0))
}

/// A missing force, named by a label, over its variable.
fn over_variable(law: &ForceLaw, force: String, height: f64) -> String {
    let layer = |label: &str, points: &[[f64; 2]], look, colour| {
        let [x, y] = [0, 1].map(|k| points.iter().map(|point| point[k]).collect::<Vec<f64>>());
        Layer::new(label, look, colour, &x, y)
    };
    let [data, stated, _, effect] = COLOURS;
    let [low, high] = drawn(law);
    let is_drawn = |[_, force]: &&[f64; 2]| (low..=high).contains(force);
    let points: Vec<[f64; 2]> = law.points.iter().filter(is_drawn).copied().collect();
    let recordings = match law.points.len() - points.len() {
        0 => "recordings".to_owned(),
        beyond => format!("recordings ({beyond} of {} lie beyond)", law.points.len()),
    };
    let mut layers = vec![
        layer(&recordings, &points, Look::Points, data),
        layer("binned median", &law.medians, Look::Line, stated),
    ];
    if !law.law.is_empty() {
        layers.push(layer("identified law", &law.law, Look::Line, effect));
    }
    let plot = Plot {
        labels: [format!("{} [{}]", law.variable, law.variable_unit), force],
        height,
        layers,
    };
    plot.to_svg()
}

/// The range of forces that is drawn: jumps of a channel cause outliers.
fn drawn(law: &ForceLaw) -> [f64; 2] {
    /// Fraction of the points at each end that may lie outside, and the margin.
    const BEYOND: f64 = 0.1;
    const MARGIN: f64 = 1.0;
    let mut forces: Vec<f64> = law.points.iter().map(|[_, force]| *force).collect();
    forces.sort_by(f64::total_cmp);
    // Too few points for quantiles.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let outside = (BEYOND * forces.len() as f64) as usize;
    let inside = forces
        .get(outside..forces.len() - outside)
        .unwrap_or_default();
    let lines = law.medians.iter().chain(&law.law).map(|[_, force]| force);
    let all = || inside.iter().chain(lines.clone()).copied();
    let (low, high) = (
        all().fold(f64::INFINITY, f64::min),
        all().fold(f64::NEG_INFINITY, f64::max),
    );
    let margin = MARGIN * (high - low);
    [low - margin, high + margin]
}

/// The missing force of each equation over time, relative to the maximum of the equation.
pub(super) fn over_time(map: &ForceHistory) -> String {
    const LEFT: f64 = 190.0;
    const WIDTH: f64 = 720.0;
    const ROW: f64 = 26.0;
    const GAP: f64 = 6.0;
    // Mean width of a letter.
    const LETTER: f64 = 6.6;
    let parts: usize = map.runs.iter().map(|(_, _, parts)| parts).sum();
    let gaps = GAP * map.runs.len().saturating_sub(1) as f64;
    let cell = (WIDTH - LEFT - gaps) / parts.max(1) as f64;
    let height = ROW * map.equations.len() as f64 + 40.0;
    let mut svg = Document::styled_by_page([WIDTH, height], "heat");
    for (row, equation) in map.equations.iter().enumerate() {
        let largest = equation.medians.iter().copied().fold(0.0, f64::max);
        let y = ROW * row as f64;
        svg.put(&text([4.0, y + 17.0]).text(&equation.name));
        let size = text([LEFT - 8.0, y + 17.0]).with("class", "small");
        svg.put(&size.text(&format!("{} {}", short(largest), equation.unit)));
        let mut index = 0;
        for (run, (_, _, parts)) in map.runs.iter().enumerate() {
            for _ in 0..*parts {
                let x = LEFT + cell * index as f64 + GAP * run as f64;
                let part = equation.medians[index] / largest.max(f64::MIN_POSITIVE);
                let lengths = [
                    ("x", x),
                    ("y", y + 2.0),
                    ("width", cell + 0.3),
                    ("height", ROW - 4.0),
                ];
                let colour = format_args!("{part:.2}");
                let square = Element::new("rect").lengths(lengths);
                svg.put(&square.with("fill-opacity", colour).empty());
                index += 1;
            }
        }
    }
    let (mut index, mut taken) = (0, 0.0);
    for (run, (name, from, parts)) in map.runs.iter().enumerate() {
        let x = LEFT + cell * index as f64 + GAP * run as f64;
        index += parts;
        let to = from + map.part * *parts as f64;
        let label = format!("{name}: {} to {} s", short(*from), short(to));
        let width = LETTER * label.chars().count() as f64;
        // Short segments of a run leave no room for a name.
        if x < taken || x + width > WIDTH {
            continue;
        }
        taken = x + width;
        svg.put(&text([x, height - 20.0]).text(&label));
    }
    svg.finish()
}

/// The inputs of an experiment, in the units of the spec.
pub(super) fn experiment(experiment: &Experiment, mechanism: &Mechanism) -> Vec<String> {
    let plot = |(name, values): &(String, Vec<f64>)| {
        let mut inputs = mechanism.inputs.iter();
        let input = inputs.find(|input| input.label.name == *name)?;
        let unit = &input.label.unit;
        // Each value is held until the next time.
        let times = &experiment.times;
        let ends = (0..values.len())
            .flat_map(|row| [times[row], *times.get(row + 1).unwrap_or(&times[row])]);
        let y = values.iter().flat_map(|value| [unit.from_si(*value); 2]);
        let x: Vec<f64> = ends.collect();
        let plot = Plot {
            labels: ["t [s]".to_owned(), format!("{name} [{}]", unit.text)],
            height: 150.0,
            layers: vec![Layer::new("", Look::Line, 0, &x, y.collect())],
        };
        Some(plot.to_svg())
    };
    experiment.inputs.iter().filter_map(plot).collect()
}
