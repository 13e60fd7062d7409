//! Closed loops: what connects two links of the tree demands that points of both meet. Some of the equations may
//! say the same, as that across the plane of a four-bar; these are left out, and of the others each gets the
//! coordinate that follows from it.

use appell_spec::Code;

use crate::model::{Connection, Coupling, Link, Motion, Robot};
use crate::rotation::{Pose, Rotation, Vector, add, cross, dot, minus, scaled};
use crate::tree::Tree;
use crate::xml::Findings;

/// A row shorter than this share of itself, less what others say, adds nothing.
const NOTHING: f64 = 1e-5;
/// What a driven joint counts less where one is chosen to follow.
const DRIVEN: f64 = 1e-2;

/// A point of each of two bodies that shall meet.
#[derive(Debug)]
pub(crate) struct Meeting {
    /// Bodies, and the points from the bodies' points, in their frames; no body is the ground.
    pub(crate) ends: [(Option<usize>, Vector); 2],
    /// The body along whose axes the equations are written.
    pub(crate) along: Option<usize>,
    /// The equations that are kept: which axis, and which coordinate follows.
    pub(crate) rows: Vec<(usize, Follower)>,
}

/// A way of a body to move: which of its coordinates, or, behind those of its place, about which axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Follower {
    pub(crate) body: usize,
    pub(crate) component: usize,
}

/// The equations of all connections.
pub(crate) fn meetings(
    robot: &Robot,
    tree: &Tree,
    findings: &Findings,
) -> Vec<(String, Vec<Meeting>)> {
    let mut rows = Rows::new(robot, tree, findings);
    (robot.connections.iter())
        .map(|connection| (connection.name.clone(), rows.of(connection)))
        .collect()
}

/// The equations that are known so far, reduced to those of their followers.
struct Rows<'a> {
    robot: &'a Robot,
    tree: &'a Tree,
    findings: &'a Findings,
    /// Poses of the links as they are drawn, and near by, where no link is in line with another by chance.
    drawn: Vec<Pose>,
    near: Vec<Pose>,
    columns: Vec<Follower>,
    known: Vec<(usize, Vec<f64>)>,
}

impl<'a> Rows<'a> {
    fn new(robot: &'a Robot, tree: &'a Tree, findings: &'a Findings) -> Self {
        let mut columns = Vec::new();
        for (body, moved) in tree.bodies.iter().enumerate() {
            let count = match moved.joint.motion {
                Motion::Turning | Motion::Sliding => 1,
                Motion::Free => 6,
                Motion::Ball => 3,
            };
            columns.extend((0..count).map(|component| Follower { body, component }));
        }
        let mut rows = Self {
            robot,
            tree,
            findings,
            drawn: poses(&robot.links, |_| 0.0),
            near: poses(&robot.links, |link| 0.1 + 0.05 * ((7 * link) % 5) as f64),
            columns,
            known: Vec::new(),
        };
        for coupling in &robot.couplings {
            rows.coupled(coupling);
        }
        rows
    }

    /// The follower of a coupling follows.
    fn coupled(&mut self, coupling: &Coupling) {
        let column = |name: &str| {
            let named = |f: &Follower| self.tree.bodies[f.body].joint.name == name;
            self.columns.iter().position(named)
        };
        let Some(own) = column(&coupling.joint) else {
            return;
        };
        let mut row = vec![0.0; self.columns.len()];
        row[own] = 1.0;
        if let Some(other) = coupling.other.as_deref().and_then(column) {
            row[other] = -coupling.coefficients.get(1).copied().unwrap_or(0.0);
        }
        self.known.push((own, row));
    }

    fn of(&mut self, connection: &Connection) -> Vec<Meeting> {
        let ends = connection.ends;
        let shared = self.carrier_of_both(ends.map(|(link, _)| link));
        let along = shared.and_then(|link| self.body_of(link));
        let turned = along.map_or(Rotation::IDENTITY, |body| self.axes(body, &self.near));
        let mut meetings = Vec::new();
        for offset in connection.points() {
            let mut rows = Vec::new();
            // The second end is where the first is while all is as drawn.
            let first = (ends[0].0, add(ends[0].1, offset));
            let met = place(first, &self.drawn);
            let second = (
                ends[1].0,
                match connection.second {
                    Some(pose) => pose.of(first.1),
                    None => self.within(ends[1].0, met),
                },
            );
            for axis in 0..3 {
                let direction = turned.0.map(|row| row[axis]);
                let mut row = vec![0.0; self.columns.len()];
                for (sign, end) in [(1.0, first), (-1.0, second)] {
                    self.add_slopes(&mut row, sign, end, direction, shared);
                }
                match self.follower(row) {
                    Some(follower) if self.turns(follower) => self.refuse(connection, follower),
                    Some(follower) => rows.push((axis, follower)),
                    None => {}
                }
            }
            if !rows.is_empty() {
                let ends = [first, second].map(|(link, at)| self.on_body(link, at));
                meetings.push(Meeting { ends, along, rows });
            }
        }
        meetings
    }

    /// Adds how a point of a link moves along a direction with every coordinate behind the link that carries
    /// both ends: what moves that moves both.
    fn add_slopes(
        &self,
        row: &mut [f64],
        sign: f64,
        end: (Option<usize>, Vector),
        direction: Vector,
        shared: Option<usize>,
    ) {
        let end_at = place(end, &self.near);
        let mut at = end.0;
        while let Some(index) = at.filter(|_| at != shared) {
            let link = &self.robot.links[index];
            let found = (self.tree.bodies.iter()).position(|body| body.link == index);
            if let (Some(joint), Some(body)) = (&link.joint, found) {
                let pose = self.near[index];
                let axis = pose.rotation.of(joint.axis);
                for (column, slope) in self.columns.iter().zip(row.iter_mut()) {
                    if column.body != body {
                        continue;
                    }
                    let velocity = match joint.motion {
                        Motion::Turning => cross(axis, minus(end_at, pose.of(joint.anchor))),
                        Motion::Sliding => axis,
                        Motion::Free if column.component < 3 => {
                            Rotation::IDENTITY.0[column.component]
                        }
                        Motion::Free | Motion::Ball => {
                            let axis = pose.rotation.0.map(|row| row[column.component % 3]);
                            cross(axis, minus(end_at, pose.of(joint.anchor)))
                        }
                    };
                    *slope += sign * dot(velocity, direction);
                }
            }
            at = link.parent;
        }
    }

    /// The coordinate that follows from a row; none where the row says nothing new.
    fn follower(&mut self, mut row: Vec<f64>) -> Option<Follower> {
        let length = |row: &[f64]| row.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let whole = length(&row).max(NOTHING);
        for (pivot, known) in &self.known {
            let factor = row[*pivot] / known[*pivot];
            for (entry, known) in row.iter_mut().zip(known) {
                *entry -= factor * known;
            }
        }
        let follows = |column: usize| self.known.iter().any(|(pivot, _)| *pivot == column);
        let weight = |column: usize| {
            if self.turns(self.columns[column]) {
                return 0.0;
            }
            let joint = &self.tree.bodies[self.columns[column].body].joint.name;
            let driven = self.robot.driven.contains(joint);
            row[column].abs() * if driven { DRIVEN } else { 1.0 }
        };
        let open = (0..row.len())
            .filter(|&column| !follows(column) && row[column].abs() > NOTHING * whole);
        let pivot = open.max_by(|&a, &b| weight(a).total_cmp(&weight(b)))?;
        self.known.push((pivot, row));
        Some(self.columns[pivot])
    }

    /// Whether a way to move is a turn of what has no angle.
    fn turns(&self, way: Follower) -> bool {
        match self.tree.bodies[way.body].joint.motion {
            Motion::Turning | Motion::Sliding => false,
            Motion::Free => way.component >= 3,
            Motion::Ball => true,
        }
    }

    fn refuse(&self, connection: &Connection, follower: Follower) {
        let joint = &self.tree.bodies[follower.body].joint.name;
        self.findings.error(
            Code::NotAllowedHere,
            connection.place.clone(),
            format!(
                "`{}` closes a loop in which the attitude of joint `{joint}` would have to follow",
                connection.name
            ),
            "connect by a point what a ball joint or a free joint turns, or use hinges",
        );
    }

    /// The last link that carries both; none is the ground.
    fn carrier_of_both(&self, ends: [Option<usize>; 2]) -> Option<usize> {
        let way = |end: Option<usize>| -> Vec<usize> {
            std::iter::successors(end, |&link| self.robot.links[link].parent).collect()
        };
        let [first, second] = ends.map(way);
        first.into_iter().find(|link| second.contains(link))
    }

    fn body_of(&self, link: usize) -> Option<usize> {
        let holds = |body: &crate::tree::Body| body.parts.iter().any(|part| part.link == link);
        self.tree.bodies.iter().position(holds)
    }

    /// Directions of the axes of a body's frame.
    fn axes(&self, body: usize, poses: &[Pose]) -> Rotation {
        let moved = &self.tree.bodies[body];
        poses[moved.link].rotation.then(moved.own)
    }

    /// A place as a link has it while all is as drawn.
    fn within(&self, link: Option<usize>, place: Vector) -> Vector {
        link.map_or(place, |link| {
            let pose = self.drawn[link];
            pose.rotation.inverse().of(minus(place, pose.position))
        })
    }

    /// A point of a link as its body has it.
    fn on_body(&self, link: Option<usize>, at: Vector) -> (Option<usize>, Vector) {
        let at = place((link, at), &self.drawn);
        let Some(body) = link.and_then(|link| self.body_of(link)) else {
            return (None, at);
        };
        let moved = &self.tree.bodies[body];
        let origin = match moved.joint.motion {
            Motion::Turning | Motion::Ball => moved.joint.anchor,
            Motion::Sliding | Motion::Free => [0.0; 3],
        };
        let origin = self.drawn[moved.link].of(origin);
        let at = self.axes(body, &self.drawn).inverse().of(minus(at, origin));
        (Some(body), crate::inertia::position_without_rounding(at))
    }
}

/// Where a point of a link is.
fn place((link, at): (Option<usize>, Vector), poses: &[Pose]) -> Vector {
    link.map_or(at, |link| poses[link].of(at))
}

/// Poses of all links where joints with an axis have moved by some way from how they are drawn.
fn poses(links: &[Link], moved: impl Fn(usize) -> f64) -> Vec<Pose> {
    let mut poses: Vec<Pose> = Vec::with_capacity(links.len());
    for (index, link) in links.iter().enumerate() {
        let on = link.parent.map_or(Pose::IDENTITY, |parent| poses[parent]);
        let mut pose = on.then(link.pose);
        if let Some(joint) = &link.joint {
            let way = moved(index);
            match joint.motion {
                Motion::Turning => {
                    let rotation = Rotation::about_vector(joint.axis, way);
                    let position = minus(joint.anchor, rotation.of(joint.anchor));
                    pose = pose.then(Pose { rotation, position });
                }
                Motion::Sliding => {
                    let position = scaled(joint.axis, 0.1 * way);
                    pose = pose.then(Pose {
                        rotation: Rotation::IDENTITY,
                        position,
                    });
                }
                Motion::Ball | Motion::Free => {}
            }
        }
        poses.push(pose);
    }
    poses
}
