//! Figures 3 and 4: a figure-eight in the ground, and in the frame that moves with the unicycle.

use appell_recordings::motion_capture::{Ride, Vector};
use appell_report::figure::{Figure, Panel, Path, Series, Surface};

use super::laboratory::Laboratory;
use super::rider::Manoeuvre;
use crate::book::claim::{Picture, Section, Statement};
use crate::book::failed;
use appell::Error;

/// The capture volume of the paper in m.
const VOLUME: [f64; 3] = [6.0, 4.0, 2.0];

pub(super) fn section(laboratory: &Laboratory) -> Result<Section, Error> {
    let session = laboratory.session(Manoeuvre::FigureEight)?;
    let ride = session
        .by_3
        .rides
        .first()
        .ok_or_else(|| failed("no ride"))?;
    let top = laboratory
        .skeleton
        .body("E")
        .ok_or_else(|| failed("no body `E`"))?;
    let ranges = ranges(&ride.origin);
    let command = "appell motion docs/examples/euc/skeleton.toml ride.csv --out rides";
    let size = format!("{:.1} m × {:.1} m on the ground", ranges[0], ranges[1]);
    let lobes = turned(&ride.angles[0]);
    let swings = format!(
        "ψ runs over {:.0}°, ϑ from {:.1}° to {:.1}°",
        lobes.to_degrees(),
        least(&ride.angles[1]).to_degrees(),
        most(&ride.angles[1]).to_degrees()
    );
    let side: Vec<f64> = ride.relative.iter().map(|r| r[1]).collect();
    let ahead: Vec<f64> = ride.relative.iter().map(|r| r[0]).collect();
    let spread = format!(
        "x_CG within {:.0} mm … {:.0} mm, y_CG within {:.0} mm … {:.0} mm",
        1e3 * least(&ahead),
        1e3 * most(&ahead),
        1e3 * least(&side),
        1e3 * most(&side)
    );
    let claims = vec![
        Statement {
            place: "figure 3",
            published: "a figure-eight in a volume of 6 m × 4 m × 2 m",
            command,
        }
        .found(size, ranges[0] < VOLUME[0] && ranges[1] < VOLUME[1])
        .added(),
        Statement {
            place: "figure 3",
            published: "tilt and yaw rate are large",
            command,
        }
        .found(
            swings,
            most(&ride.angles[1]).max(-least(&ride.angles[1])) > 0.05,
        ),
        Statement {
            place: "figure 4",
            published: "G in the frame that moves with the wheel centre C, by (1) and (2)",
            command,
        }
        .found(
            spread,
            ride.relative.iter().all(|r| r[2] > 0.5 && r[2] < 1.2),
        ),
    ];
    let pictures = vec![
        Picture {
            svg: in_space(laboratory, ride).to_svg(),
            caption: "Figure 3: paths of the wheel centre C, the top of the unicycle E, the rider's centre of mass G and \
                      the head H in the capture volume."
                .to_owned(),
        },
        Picture {
            svg: from_above(ride, top).to_svg(),
            caption: "The same from above: C, E and G.".to_owned(),
        },
        Picture {
            svg: in_frame(ride, top, [0, 2], "x [m]").to_svg(),
            caption: "Figure 4 (a): E and G in the longitudinal plane (x, z) of the moving frame.".to_owned(),
        },
        Picture {
            svg: in_frame(ride, top, [1, 2], "y [m]").to_svg(),
            caption: "Figure 4 (b): E and G in the frontal plane (y, z).".to_owned(),
        },
    ];
    Ok(Section {
        title: "Figures 3 and 4: a figure-eight".to_owned(),
        about: "A simulated ride of the gallery's spatial unicycle under a rider who keeps the balance, seen by a \
                simulated capture. The paper's own path is not public; what is compared is what the paper says of it."
            .to_owned(),
        claims,
        pictures,
    })
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn ranges(places: &[Vector]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let column: Vec<f64> = places.iter().map(|place| place[k]).collect();
        most(&column) - least(&column)
    })
}

fn turned(yaw: &[f64]) -> f64 {
    most(yaw) - least(yaw)
}

fn line(label: &str, places: &[Vector], [x, y]: [usize; 2]) -> Series {
    Series {
        label: label.to_owned(),
        x: places.iter().map(|place| place[x]).collect(),
        y: places.iter().map(|place| place[y]).collect(),
    }
}

/// The paths in a box of the size of the capture volume, centred.
fn in_space(laboratory: &Laboratory, ride: &Ride) -> Surface {
    let mut paths = vec![Path {
        label: "C".to_owned(),
        points: ride.origin.clone(),
    }];
    for name in ["E", "H"] {
        if let Some(body) = laboratory.skeleton.body(name) {
            let points = ride.points[body].clone();
            let label = name.to_owned();
            paths.push(Path { label, points });
        }
    }
    let (label, points) = ("G".to_owned(), ride.centre.clone());
    paths.insert(2, Path { label, points });
    let all: Vec<Vector> = paths.iter().flat_map(|path| path.points.clone()).collect();
    let around = |k: usize| {
        let column: Vec<f64> = all.iter().map(|place| place[k]).collect();
        let middle = 0.5 * (least(&column) + most(&column));
        // One scale on the ground.
        [-0.5, 0.5].map(|part| middle + part * VOLUME[0])
    };
    Surface {
        title: "Figure-eight in space".to_owned(),
        labels: ["X [m]", "Y [m]", "Z [m]"].map(str::to_owned),
        ranges: [around(0), around(1), [0.0, VOLUME[2]]],
        kinds: Vec::new(),
        patches: Vec::new(),
        paths,
    }
}

fn from_above(ride: &Ride, top: usize) -> Figure {
    let series = vec![
        line("C", &ride.origin, [0, 1]),
        line("E", &ride.points[top], [0, 1]),
        line("G", &ride.centre, [0, 1]),
    ];
    Figure {
        title: "Figure-eight from above".to_owned(),
        x_label: "X [m]".to_owned(),
        panels: vec![Panel {
            unit: "m".to_owned(),
            series,
        }],
        marks: Vec::new(),
        equal_axes: true,
    }
}

fn in_frame(ride: &Ride, top: usize, plane: [usize; 2], axis: &str) -> Figure {
    let above: Vec<Vector> = (0..ride.times.len())
        .map(|row| {
            let [place, origin] = [ride.points[top][row], ride.origin[row]];
            ride.frame(row)
                .from_ground([0, 1, 2].map(|k| place[k] - origin[k]))
        })
        .collect();
    Figure {
        title: "Figure-eight in the moving frame".to_owned(),
        x_label: axis.to_owned(),
        panels: vec![Panel {
            unit: "m".to_owned(),
            series: vec![line("E", &above, plane), line("G", &ride.relative, plane)],
        }],
        marks: Vec::new(),
        equal_axes: true,
    }
}
