//! Quantities of vehicle and rider from a capture: points, the centre of mass, the moving frame,
//! and the coordinates of the model. No derivatives yet: see `smooth.rs`.

use super::capture::{Capture, Track};
use super::pose::{Axes, Vector, difference, product, sum};
use super::skeleton::{ChannelKind, Place, Skeleton};

/// A capture in the words of its skeleton. Vectors in m, angles in rad, one of each at every time.
#[derive(Debug, Clone, PartialEq)]
pub struct Ride {
    /// Times in s.
    pub times: Vec<f64>,
    /// Yaw, tilt and pitch of the body that carries the moving frame.
    pub angles: [Vec<f64>; 3],
    /// Pivots and points, in the ground.
    pub points: Vec<Vec<Vector>>,
    /// Origin of the moving frame, in the ground.
    pub origin: Vec<Vector>,
    /// The rider's centre of mass, in the ground.
    pub centre: Vec<Vector>,
    /// The centre of mass from the origin, in the moving frame: equation (1) of Mihályi and others.
    pub relative: Vec<Vector>,
    /// The coordinates of the model, in the order of the skeleton.
    pub channels: Vec<Vec<f64>>,
}

impl Ride {
    /// The points of a skeleton in a capture.
    pub fn of(skeleton: &Skeleton, capture: &Capture) -> Self {
        let rows = capture.times.len();
        let points: Vec<Vec<Vector>> = (skeleton.points.iter())
            .map(|point| {
                let track = &capture.bodies[point.body];
                let at = |row| sum(track.pivot(row), track.axes(row).to_ground(point.offset));
                (0..rows).map(at).collect()
            })
            .collect();
        let middle = |ends: &[usize], row: usize| -> Vector {
            let whole = ends
                .iter()
                .fold([0.0; 3], |whole, &end| sum(whole, points[end][row]));
            whole.map(|component| component / ends.len() as f64)
        };
        let centre = |row: usize| -> Vector {
            let moments = skeleton.rider.segments.iter().map(|segment| {
                let [from, to] = segment.ends.each_ref().map(|ends| middle(ends, row));
                let way = difference(to, from).map(|component| segment.centre * component);
                sum(from, way).map(|component| segment.mass * component)
            });
            moments
                .fold([0.0; 3], sum)
                .map(|moment| moment / skeleton.rider.mass)
        };
        let carrier = &capture.bodies[skeleton.frame.body];
        let frames: Vec<Axes> = (0..rows).map(|row| carrier.frame(row)).collect();
        let origin = points[skeleton.frame.origin].clone();
        let centre: Vec<Vector> = (0..rows).map(centre).collect();
        let place = |place: Place| match place {
            Place::Point(index) => &points[index],
            Place::Centre => &centre,
        };
        let relative = (0..rows)
            .map(|row| frames[row].from_ground(difference(centre[row], origin[row])))
            .collect();
        let channel = |kind: ChannelKind| match kind {
            ChannelKind::Path(along) => path(&frames, place(along)),
            ChannelKind::Pitch(body) => capture.bodies[body].angles[2].clone(),
            ChannelKind::Lean(ends) => {
                let [from, to] = ends.map(place);
                let lean = |row: usize| {
                    let [x, _, z] = frames[row].from_ground(difference(to[row], from[row]));
                    x.atan2(z)
                };
                (0..rows).map(lean).collect()
            }
        };
        let channels = skeleton
            .channels
            .iter()
            .map(|own| channel(own.kind))
            .collect();
        Self {
            times: capture.times.clone(),
            angles: carrier.angles.clone(),
            relative,
            channels,
            points,
            origin,
            centre,
        }
    }

    /// The moving frame at a row.
    pub fn frame(&self, row: usize) -> Axes {
        Axes::turned([self.angles[0][row], self.angles[1][row], 0.0])
    }
}

impl Track {
    fn pivot(&self, row: usize) -> Vector {
        self.position.each_ref().map(|component| component[row])
    }

    fn axes(&self, row: usize) -> Axes {
        Axes::turned(self.angles.each_ref().map(|angle| angle[row]))
    }

    /// Yaw and tilt alone.
    fn frame(&self, row: usize) -> Axes {
        Axes::turned([self.angles[0][row], self.angles[1][row], 0.0])
    }
}

/// Frames on each side over which the direction of a path is averaged.
const NEIGHBOURS: usize = 15;

/// Distance of a point along the first axis of a frame: steps between rows, each along the averaged
/// axis of its neighbours. Noise of the point does not accumulate as long as the axis keeps its
/// direction; the product with noise of the axis would, without the average.
fn path(frames: &[Axes], place: &[Vector]) -> Vec<f64> {
    let rows = place.len();
    let seen = |row: usize| frames[row].forward().iter().all(|x| x.is_finite());
    // Sums of the axes up to each row: a mean is a difference of two of them.
    let mut sums = vec![[0.0; 3]];
    for row in 0..rows {
        let axis = if seen(row) {
            frames[row].forward()
        } else {
            [0.0; 3]
        };
        sums.push(sum(sums[row], axis));
    }
    let mut way = 0.0;
    let mut last: Option<usize> = None;
    let steps = (0..rows).map(|row| {
        if !seen(row) || !place[row].iter().all(|x| x.is_finite()) {
            return f64::NAN;
        }
        if let Some(before) = last {
            // Symmetric, so that a turn does not bias the step.
            let reach = NEIGHBOURS.min(before).min(rows - 1 - row);
            let forward = difference(sums[row + reach + 1], sums[before - reach]);
            let length = product(forward, forward).sqrt();
            way += product(difference(place[row], place[before]), forward) / length;
        }
        last = Some(row);
        way
    });
    steps.collect()
}
