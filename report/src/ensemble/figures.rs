//! Figures of a study.

use appell_ensemble::rows::{Column, Role};
use appell_ensemble::summary::{Course, Effects, Number};

use super::about::About;
use super::parts::labelled;
use crate::figure::{Histogram, Layer, Lever, Look, Plot, Scatter, Series, Tornado};
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
    for course in &about.summary.courses {
        let column = &about.columns[course.column];
        all.push(Named {
            name: format!("{}-bands", course.name),
            heading: format!("{}: {} over time", course.name, column.about),
            svg: bands(column, course),
        });
    }
    for effects in &about.summary.effects {
        let column = &about.columns[effects.column];
        let number = about.summary.number(effects.column);
        if let Some(number) = number.filter(|number| number.moments.count > 0) {
            all.push(Named {
                name: format!("{}-histogram", column.name),
                heading: format!("{}: {}", column.name, column.about),
                svg: histogram(column, number),
            });
        }
        let levers = levers(about, effects);
        if levers.is_empty() || !has_spread(about, effects.column) {
            continue;
        }
        all.push(Named {
            name: format!("{}-levers", column.name),
            heading: format!("{}: what moves it", column.name),
            svg: tornado(about, effects, &levers),
        });
        if let [a, b, ..] = levers[..] {
            all.push(Named {
                name: format!("{}-cases", column.name),
                heading: format!(
                    "{} over {} and {}",
                    column.name, about.columns[a].name, about.columns[b].name
                ),
                svg: cases(about, effects.column, [a, b]),
            });
        }
    }
    all
}

/// Whether the values of a column differ.
fn has_spread(about: &About<'_>, column: usize) -> bool {
    let event = about.summary.events.iter().find(|e| e.column == column);
    match (event, about.summary.number(column)) {
        (Some(event), _) => event.happened > 0 && event.happened < event.of,
        (None, Some(number)) => number.moments.max > number.moments.min,
        (None, None) => false,
    }
}

/// Name of a course and unit, without its time.
fn bands(column: &Column, course: &Course) -> String {
    let unit = match column.unit.as_str() {
        "" | "1" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let values = |list: &[f64]| {
        list.iter()
            .map(|&v| column.to_unit(v))
            .collect::<Vec<f64>>()
    };
    let layer = |label: &str, y: Vec<f64>, look, colour| Layer {
        series: Series {
            label: label.to_owned(),
            x: course.times.clone(),
            y,
        },
        look,
        colour,
    };
    let band = |place: usize| values(&course.bands[place]);
    let plot = Plot {
        labels: ["t [s]".to_owned(), format!("{}{unit}", course.name)],
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
    let mut marks = Vec::new();
    for (place, name) in [(0, "5 %"), (2, "median"), (4, "95 %")] {
        if let Some(quantile) = number.quantiles.get(place) {
            marks.push((column.to_unit(quantile.value), name.to_owned()));
        }
    }
    let figure = Histogram {
        label: labelled(column),
        counted: "cases".to_owned(),
        ends: [number.moments.min, number.moments.max].map(|end| column.to_unit(end)),
        bars: number.bars.clone(),
        marks,
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
    let event = about
        .summary
        .events
        .iter()
        .find(|e| e.column == effects.column);
    let centre = match (number, event) {
        (Some(number), _) => column.to_unit(number.moments.mean),
        (None, Some(event)) => event.happened as f64 / event.of as f64,
        (None, None) => 0.0,
    };
    let what = if event.is_some() {
        format!("probability of {}", column.name)
    } else {
        format!("mean of {}", labelled(column))
    };
    let figure = Tornado {
        label: what,
        legend: ["lowest quarter", "highest quarter"].map(str::to_owned),
        centre,
        levers: levers
            .iter()
            .map(|&factor| Lever {
                name: about.columns[factor].name.clone(),
                ends: effects.ends[factor].map(|end| column.to_unit(end)),
            })
            .collect(),
    };
    figure.to_svg()
}

fn cases(about: &About<'_>, column: usize, axes: [usize; 2]) -> String {
    let of = &about.columns[column];
    let points = &about.summary.points;
    let (classes, class): (Vec<String>, Box<dyn Fn(f64) -> usize>) =
        if matches!(of.role, Role::Event) {
            (
                vec!["not".to_owned(), of.name.clone()],
                Box::new(|value: f64| usize::from(value != 0.0)),
            )
        } else {
            let number = about.summary.number(column);
            let quantiles = number.map_or(&[][..], |number| &number.quantiles);
            let inner = quantiles.get(1..4).unwrap_or_default();
            let limits: Vec<f64> = inner.iter().map(|q| q.value).collect();
            let shown: Vec<String> = limits.iter().map(|&l| short(of.to_unit(l))).collect();
            let mut names = Vec::new();
            for place in 0..=shown.len() {
                names.push(match place {
                    0 => format!("below {}", shown.first().map_or("", String::as_str)),
                    place if place == shown.len() => format!("above {}", shown[place - 1]),
                    place => format!("to {}", shown[place]),
                });
            }
            let class = move |value: f64| limits.iter().filter(|limit| value > **limit).count();
            (names, Box::new(class))
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
