//! Figures of a study.

use appell_ensemble::rows::{Column, Role};
use appell_ensemble::summary::{Course, Effects, Event, Number};

use super::parts::About;
use super::parts::{in_brackets, labelled};
use crate::figure::{Histogram, Layer, Lever, Look, Mark, Plot, Scatter, Tornado};
use crate::text::short;

/// A figure with its name and heading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Name of its file, without extension.
    pub name: String,
    /// A heading.
    pub heading: String,
    /// The figure as SVG.
    pub svg: String,
}

/// All figures: bands over time, then for each kept number and event its histogram, the sensitivities, and the
/// cases over its two most influential factors.
pub fn figures(about: &About<'_>) -> Vec<Named> {
    let mut all: Vec<Named> = Vec::new();
    let mut put = |name: &str, kind: &str, heading: String, svg: String| {
        let name = format!("{name}-{kind}");
        all.push(Named { name, heading, svg });
    };
    for course in &about.summary.courses {
        let column = &about.columns[course.column];
        let heading = format!("{}: {} over time", course.name, column.about);
        put(&course.name, "bands", heading, bands(column, course));
    }
    for effects in &about.summary.effects {
        let column = &about.columns[effects.column];
        let name = &column.name;
        let number = about.summary.number(effects.column);
        if let Some(number) = number.filter(|number| number.moments.count > 0) {
            let heading = format!("{name}: {}", column.about);
            put(name, "histogram", heading, histogram(column, number));
        }
        let levers = levers(about, effects);
        if levers.is_empty() || !has_spread(about, effects.column) {
            continue;
        }
        let heading = format!("{name}: what moves it");
        put(name, "levers", heading, tornado(about, effects, &levers));
        if let [a, b, ..] = levers[..] {
            let [x, y] = [a, b].map(|factor| &about.columns[factor].name);
            let heading = format!("{name} over {x} and {y}");
            put(name, "cases", heading, cases(about, effects.column, [a, b]));
        }
    }
    all
}

fn event<'a>(about: &About<'a>, column: usize) -> Option<&'a Event> {
    let mut events = about.summary.events.iter();
    events.find(|event| event.column == column)
}

/// Whether the values of a column differ.
fn has_spread(about: &About<'_>, column: usize) -> bool {
    match (event(about, column), about.summary.number(column)) {
        (Some(event), _) => event.happened > 0 && event.happened < event.of,
        (None, Some(number)) => number.moments.max > number.moments.min,
        (None, None) => false,
    }
}

/// Quantiles and mean of a course over time.
fn bands(column: &Column, course: &Course) -> String {
    let values = |list: &[f64]| -> Vec<f64> { list.iter().map(|&v| column.to_unit(v)).collect() };
    let band = |place: usize| values(&course.bands[place]);
    let layer =
        |label: &str, y: Vec<f64>, look, colour| Layer::new(label, look, colour, &course.times, y);
    let plot = Plot {
        labels: ["t [s]".to_owned(), in_brackets(&course.name, &column.unit)],
        height: 220.0,
        layers: vec![
            layer("5 to 95 %", band(0), Look::Band(band(4)), 0),
            layer("25 to 75 %", band(1), Look::Core(band(3)), 0),
            layer("median", band(2), Look::Line, 0),
            layer("mean", values(&course.mean), Look::Line, 1),
        ],
    };
    plot.to_svg()
}

fn histogram(column: &Column, number: &Number) -> String {
    let names = [(0, "5 %"), (2, "median"), (4, "95 %")].into_iter();
    let marks = names.filter_map(|(place, name)| {
        let quantile = number.quantiles.get(place)?;
        Some(Mark {
            x: column.to_unit(quantile.value),
            about: name.to_owned(),
        })
    });
    let figure = Histogram {
        label: labelled(column),
        counted: "cases".to_owned(),
        ends: [number.moments.min, number.moments.max].map(|end| column.to_unit(end)),
        bars: number.bars.clone(),
        marks: marks.collect(),
    };
    figure.to_svg()
}

/// Factors in the order of their effects, the largest first; those that choose between files are left out.
fn levers(about: &About<'_>, effects: &Effects) -> Vec<usize> {
    let is_number = |factor: &usize| matches!(&about.columns[*factor].role, Role::Factor(items) if items.is_empty());
    let mut order: Vec<usize> = (0..effects.ends.len()).filter(is_number).collect();
    let size = |factor: &usize| {
        if let Some(indices) = &effects.indices {
            return indices.get(*factor).map_or(0.0, |i| i.total.value);
        }
        let [low, high] = effects.ends[*factor];
        (high - low).abs()
    };
    order.retain(|factor| size(factor).is_finite());
    order.sort_by(|a, b| size(b).total_cmp(&size(a)));
    order
}

fn tornado(about: &About<'_>, effects: &Effects, levers: &[usize]) -> String {
    let column = &about.columns[effects.column];
    let number = about.summary.number(effects.column);
    let event = event(about, effects.column);
    let centre = match (number, event) {
        (Some(number), _) => column.to_unit(number.moments.mean),
        (None, Some(event)) => event.happened as f64 / event.of as f64,
        (None, None) => 0.0,
    };
    let lever = |&factor: &usize| Lever {
        name: about.columns[factor].name.clone(),
        ends: effects.ends[factor].map(|end| column.to_unit(end)),
    };
    let figure = Tornado {
        label: match event {
            Some(_) => format!("probability of {}", column.name),
            None => format!("mean of {}", labelled(column)),
        },
        legend: ["lowest quarter", "highest quarter"].map(str::to_owned),
        centre,
        levers: levers.iter().map(lever).collect(),
    };
    figure.to_svg()
}

fn cases(about: &About<'_>, column: usize, axes: [usize; 2]) -> String {
    let of = &about.columns[column];
    let points = &about.summary.points;
    let is_event = matches!(of.role, Role::Event);
    let number = about.summary.number(column).filter(|_| !is_event);
    let quantiles = number.map_or(&[][..], |number| &number.quantiles);
    let inner = quantiles.get(1..4).unwrap_or_default();
    let limits: Vec<f64> = inner.iter().map(|quantile| quantile.value).collect();
    let class = |value: f64| {
        if is_event {
            usize::from(value != 0.0)
        } else {
            limits.iter().filter(|limit| value > **limit).count()
        }
    };
    let classes = if is_event {
        vec!["not".to_owned(), of.name.clone()]
    } else {
        let shown: Vec<String> = limits.iter().map(|&l| short(of.to_unit(l))).collect();
        let name = |place: usize| match place {
            0 => format!("below {}", shown.first().map_or("", String::as_str)),
            place if place == shown.len() => format!("above {}", shown[place - 1]),
            place => format!("to {}", shown[place]),
        };
        (0..=shown.len()).map(name).collect()
    };
    let place = |axis: usize, case: usize| {
        let column = axes[axis];
        points[column]
            .get(case)
            .map_or(f64::NAN, |&value| about.columns[column].to_unit(value))
    };
    let all = points[column].iter().enumerate();
    let all = all.filter(|(_, value)| value.is_finite());
    let figure = Scatter {
        labels: axes.map(|axis| labelled(&about.columns[axis])),
        about: labelled(of),
        classes,
        points: all
            .map(|(case, &value)| ([place(0, case), place(1, case)], class(value)))
            .collect(),
    };
    figure.to_svg()
}
