//! A ride as a run of a data set.

use std::fmt::Write as _;

use appell_spec::foreign::toml_string;

use super::pose::Vector;
use super::ride::Ride;
use super::skeleton::{ChannelKind, Skeleton};
use super::smooth::Smoothed;

/// Further columns of a run: name, unit, sentence.
const DERIVED: [(&str, &str); 13] = [
    ("frame_yaw", "rad"),
    ("frame_tilt", "rad"),
    ("frame_x", "m"),
    ("frame_y", "m"),
    ("frame_z", "m"),
    ("centre_x", "m"),
    ("centre_y", "m"),
    ("centre_z", "m"),
    ("relative_x", "m"),
    ("relative_y", "m"),
    ("relative_z", "m"),
    ("frame_v", "m/s"),
    ("frame_a", "m/s^2"),
];

/// The text of `recording.toml` for runs of these names.
pub fn manifest(skeleton: &Skeleton, runs: &[String]) -> String {
    let mut text = format!(
        "mechanism   = {}\ndescription = {}\n\n[channels]\n",
        toml_string(&skeleton.mechanism),
        toml_string(&skeleton.description)
    );
    // Writing to a string cannot fail.
    for channel in &skeleton.channels {
        let unit = match channel.kind {
            ChannelKind::Path(_) => "m",
            ChannelKind::Pitch(_) | ChannelKind::Lean(_) => "rad",
        };
        let name = &channel.name;
        let _ = writeln!(text, "{name} = {{ measures = {name:?}, unit = {unit:?} }}");
    }
    for (name, unit) in DERIVED {
        let _ = writeln!(text, "{name} = {{ unit = {unit:?} }}");
    }
    let runs: Vec<String> = runs.iter().map(|run| toml_string(run)).collect();
    let _ = write!(text, "\n[runs]\nfit = [{}]\n", runs.join(", "));
    text
}

/// The text of a run: the channels, then the derived quantities.
pub fn table(skeleton: &Skeleton, ride: &Ride, smoothed: &Smoothed) -> String {
    let channels = skeleton
        .channels
        .iter()
        .map(|channel| channel.name.as_str());
    let derived = DERIVED.iter().map(|(name, _)| *name);
    let names: Vec<&str> = ["t"].into_iter().chain(channels).chain(derived).collect();
    let mut text = names.join(",") + "\n";
    for (row, t) in ride.times.iter().enumerate() {
        let _ = write!(text, "{t}");
        let own = ride.channels.iter().map(|channel| channel[row]);
        let vectors: [&[Vector]; 3] = [&ride.origin, &ride.centre, &ride.relative];
        let places = vectors.into_iter().flat_map(|vector| vector[row]);
        let along = [smoothed.velocity[row][0], smoothed.acceleration[row][0]];
        let angles = [ride.angles[0][row], ride.angles[1][row]];
        for value in own.chain(angles).chain(places).chain(along) {
            if value.is_finite() {
                let _ = write!(text, ",{value}");
            } else {
                text.push(',');
            }
        }
        text.push('\n');
    }
    text
}
