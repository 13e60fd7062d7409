//! Plots as SVG.

use appell_report::figure::{Figure, Layer, Look, Mark, Panel, Plot, Series};
use appell_report::svg::title;

fn series(label: &str, count: u32, y: impl Fn(f64) -> f64) -> Series {
    let x: Vec<f64> = (0..=count)
        .map(|i| 10.0 * f64::from(i) / f64::from(count))
        .collect();
    Series {
        label: label.to_string(),
        y: x.iter().map(|t| y(*t)).collect(),
        x,
    }
}

fn figure(panels: Vec<Panel>) -> Figure {
    Figure {
        title: "A & B".into(),
        x_label: "t [s]".into(),
        panels,
        marks: Vec::new(),
        equal_axes: false,
    }
}

fn texts(svg: &str) -> Vec<&str> {
    svg.split("<text")
        .skip(1)
        .filter_map(|t| t.split('>').nth(1)?.split('<').next())
        .collect()
}

#[test]
fn axes_have_round_ticks_names_and_units() {
    let panel = Panel {
        unit: "rad/s".into(),
        series: vec![series("omega", 100, |t| 0.3 * t.sin())],
    };
    let svg = figure(vec![panel]).to_svg();
    assert_eq!(
        texts(&svg),
        [
            "A &amp; B",
            "−0.2",
            "0.0",
            "0.2",
            "omega [rad/s]",
            "0",
            "2",
            "4",
            "6",
            "8",
            "10",
            "t [s]"
        ]
    );
    assert!(svg.contains("prefers-color-scheme:dark"));
}

#[test]
fn a_long_line_is_drawn_with_no_more_points_than_can_be_seen() {
    let panel = |count| {
        vec![Panel {
            unit: String::new(),
            series: vec![series("y", count, f64::sin)],
        }]
    };
    let points = |svg: &str| svg.matches('L').count();
    let (fine, coarse) = (
        figure(panel(200_000)).to_svg(),
        figure(panel(2_000)).to_svg(),
    );
    assert!(points(&fine) < 5_000, "{}", points(&fine));
    assert!(points(&coarse) > 1_000);
    assert_eq!(fine, figure(panel(200_000)).to_svg());
}

#[test]
fn gaps_constants_and_nothing_are_drawn_without_nan() {
    let gap = |t: f64| if (4.0..6.0).contains(&t) { f64::NAN } else { t };
    let empty = Series {
        label: "empty".into(),
        x: Vec::new(),
        y: Vec::new(),
    };
    let panels = vec![
        Panel {
            unit: "m".into(),
            series: vec![series("gap", 50, gap), empty],
        },
        Panel {
            unit: "m".into(),
            series: vec![series("constant", 50, |_| 1e7)],
        },
        Panel {
            unit: "m".into(),
            series: vec![series("zero", 50, |_| 0.0)],
        },
        Panel {
            unit: "m".into(),
            series: Vec::new(),
        },
    ];
    let svg = figure(panels).to_svg();
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let line = svg
        .split("class=\"line c0\" d=\"")
        .nth(2)
        .and_then(|d| d.split('"').next());
    assert_eq!(line.map(|line| line.matches('M').count()), Some(2));
    assert!(texts(&svg).contains(&"1.00e7"), "{:?}", texts(&svg));
    let nothing = Figure {
        panels: Vec::new(),
        ..figure(Vec::new())
    };
    assert!(nothing.to_svg().ends_with("</svg>\n"));
}

#[test]
fn equal_axes_draw_a_circle_round() {
    let angle = |i: u32| f64::from(i) / 100.0 * std::f64::consts::TAU;
    let circle = Series {
        label: "y_G".into(),
        x: (0..=100).map(|i| 3.0 * angle(i).cos()).collect(),
        y: (0..=100).map(|i| 3.0 * angle(i).sin()).collect(),
    };
    let panels = vec![Panel {
        unit: "m".into(),
        series: vec![circle],
    }];
    let svg = Figure {
        equal_axes: true,
        ..figure(panels)
    }
    .to_svg();
    let path = svg
        .split("class=\"line c0\" d=\"")
        .nth(2)
        .and_then(|d| d.split('"').next());
    let numbers = |part: usize| {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for point in path.unwrap_or("").split(['M', 'L']).skip(1) {
            let value: f64 = point
                .split(' ')
                .nth(part)
                .and_then(|n| n.parse().ok())
                .unwrap_or(0.0);
            range = [range[0].min(value), range[1].max(value)];
        }
        range[1] - range[0]
    };
    // Coordinates are written in tenths of a pixel.
    assert!(
        (numbers(0) - numbers(1)).abs() <= 0.2,
        "{} {}",
        numbers(0),
        numbers(1)
    );
    assert!(numbers(0) > 300.0);
}

#[test]
fn marks_stand_in_every_panel_and_say_what_happens() {
    let panel = |name| Panel {
        unit: String::new(),
        series: vec![series(name, 10, |t| t)],
    };
    let mut figure = figure(vec![panel("a"), panel("b")]);
    let plain = figure.to_svg();
    figure.marks = vec![Mark {
        x: 0.5,
        about: "N < 0 & slipping".to_owned(),
    }];
    let svg = figure.to_svg();
    let marks = svg
        .matches("<title>N &lt; 0 &amp; slipping</title>")
        .count();
    assert_eq!(marks, figure.panels.len());
    figure.marks[0].x = 1e9;
    assert_eq!(
        figure.to_svg(),
        plain,
        "a mark beside the figure is not drawn"
    );
}

#[test]
fn a_plot_has_points_a_band_and_a_legend_of_what_is_named() {
    let layer = |label: &str, y: [f64; 3], look| Layer {
        series: Series {
            label: label.to_owned(),
            x: vec![0.0, 1.0, 2.0],
            y: y.to_vec(),
        },
        look,
        colour: 1,
    };
    let plot = Plot {
        labels: ["t [s]".to_owned(), "x [m]".to_owned()],
        height: 160.0,
        layers: vec![
            layer("noise", [-1.0; 3], Look::Band(vec![1.0; 3])),
            layer("data", [0.0, f64::NAN, 0.5], Look::Points),
            layer("", [0.0, 0.2, 0.4], Look::Line),
        ],
    };
    let svg = plot.to_svg();
    // Two points, as the third is not finite, and the one of the legend.
    assert_eq!(svg.matches("h0").count(), 3, "{svg}");
    assert_eq!(svg.matches("class=\"band f1\"").count(), 2, "{svg}");
    assert_eq!(svg.matches("class=\"line c1\"").count(), 1, "{svg}");
    for text in ["noise", "data", "t [s]", "x [m]"] {
        assert!(svg.contains(&format!(">{text}</text>")), "{text} in {svg}");
    }
}

#[test]
fn a_long_title_is_smaller_and_a_longer_one_is_cut() {
    let shown = |letters: usize| title([0.0, 0.0], 720.0, &"a".repeat(letters));
    assert!(!shown(50).contains("style"));
    let smaller = shown(90);
    assert!(
        smaller.contains("font-size:1") && !smaller.contains('…'),
        "{smaller}"
    );
    let cut = shown(500);
    assert!(
        cut.contains("font-size:10.0px") && cut.contains("…</text>"),
        "{cut}"
    );
    assert!(cut.contains(&format!("<title>{}</title>", "a".repeat(500))));
}
