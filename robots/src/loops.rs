//! Constraint equations between coordinates: loop closures, where points of two links of the tree coincide, and
//! couplings. Redundant equations, such as those normal to the plane of a four-bar, are dropped. Each remaining one
//! determines a dependent coordinate, chosen by pivoting at the assembled initial configuration.

use appell_spec::Code;

use crate::assembly::{Configuration, HELD, Linear};
use crate::elimination::{eliminated, matched};
use crate::kinematics::{Freedom, anywhere};
use crate::mass;
use crate::model::{Connection, Coupling, Link, Motion, Robot, Sum};
use crate::rotation::{Pose, Rotation, Vector, add, dot, minus};
use crate::tree::Tree;
use crate::xml::Findings;

/// Weight of a driven joint in the choice of dependent coordinates.
const DRIVEN: f64 = 1e-2;
/// Displacements at which ranks are determined, as fractions of [`anywhere`]; the first that can be assembled is used.
const BESIDE: [f64; 3] = [1.0, 0.1, 0.01];
/// Largest constraint residual due to rounded numbers in the file.
const CLOSED: f64 = 1e-4;
/// Largest number of entries of the constraint matrix.
const MOST_ENTRIES: usize = 1 << 18;

/// A pair of points, one of each body, that must coincide.
#[derive(Debug)]
pub(crate) struct Meeting {
    /// Bodies, and the points relative to the bodies' reference points, in their frames; `None` is the ground.
    pub(crate) ends: [(Option<usize>, Vector); 2],
    /// The body in whose frame the equations are written.
    pub(crate) along: Option<usize>,
    /// The retained equations: axis, and dependent coordinate.
    pub(crate) rows: Vec<(usize, Follower)>,
}

/// A dependent freedom of a body: index of its coordinate or, after those of its position, of the axis of rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Follower {
    pub(crate) body: usize,
    pub(crate) component: usize,
}

/// The equations of a robot with their dependent coordinates.
#[derive(Debug, Default)]
pub(crate) struct Equations {
    /// By connection.
    pub(crate) meetings: Vec<(String, Vec<Meeting>)>,
    /// By coupling; `None` if it is redundant.
    pub(crate) couplings: Vec<Option<Follower>>,
    /// The initial configuration, if changing the dependent coordinates alone does not satisfy the equations.
    pub(crate) start: Option<Configuration>,
}

impl Equations {
    /// All dependent coordinates.
    pub(crate) fn followers(&self) -> impl Iterator<Item = Follower> {
        let meetings = self.meetings.iter().flat_map(|(_, of)| of);
        let meetings =
            meetings.flat_map(|meeting| meeting.rows.iter().map(|(_, follower)| *follower));
        meetings.chain(self.couplings.iter().copied().flatten())
    }
}

/// An equation between coordinates.
#[derive(Clone, Copy)]
enum Row {
    Coupling(usize),
    /// Connection, pair of points and axis.
    Meeting(usize, usize, usize),
}

/// The equations of all couplings and connections. Refuses inconsistent ones.
pub(crate) fn equations(robot: &Robot, tree: &Tree, findings: &Findings) -> Equations {
    let freedoms = Freedom::all(&robot.links);
    let places = Places::new(robot, tree, freedoms);
    let count = robot.couplings.len() + 9 * robot.connections.len();
    if count.saturating_mul(places.freedoms.len()) > MOST_ENTRIES {
        let mut most = robot.connections.iter().map(|one| &one.place);
        let place = most
            .next()
            .or(robot.couplings.first().map(|one| &one.place));
        let message = format!(
            "{count} equations between {} rates are too many",
            places.freedoms.len()
        );
        let help = "leave the couplings out, or import a part of the robot";
        let place = place.cloned().unwrap_or_default();
        findings.error(Code::LimitExceeded, place, message, help);
        return Equations::default();
    }
    let mut equations = Equations::default();
    let (mut rows, mut preferred) = (Vec::new(), Vec::new());
    for (index, coupling) in robot.couplings.iter().enumerate() {
        equations.couplings.push(None);
        // The preferred dependent coordinate.
        preferred.push(match coupling.follows.terms.as_slice() {
            [(name, _)] => places.column(name),
            _ => None,
        });
        rows.push(Row::Coupling(index));
    }
    for (index, connection) in robot.connections.iter().enumerate() {
        let meetings = places.meetings(connection);
        let each = (0..meetings.len()).flat_map(|meeting| (0..3).map(move |axis| (meeting, axis)));
        rows.extend(each.map(|(meeting, axis)| Row::Meeting(index, meeting, axis)));
        equations.meetings.push((connection.name.clone(), meetings));
    }
    places.refuse_what_stays_open(&rows, findings);
    preferred.resize(rows.len(), None);
    let (kept, start) = places.followers(&preferred);
    for (row, pivot) in &kept {
        let follower = places.follower(*pivot);
        match rows[*row] {
            Row::Coupling(index) => equations.couplings[index] = Some(follower),
            Row::Meeting(index, meeting, axis) => {
                if places.turns(*pivot) {
                    places.refuse(&robot.connections[index], follower, findings);
                }
                let (_, meetings) = &mut equations.meetings[index];
                meetings[meeting].rows.push((axis, follower));
            }
        }
    }
    for (_, meetings) in &mut equations.meetings {
        meetings.retain(|meeting| !meeting.rows.is_empty());
    }
    equations.start = start;
    places.refuse_what_has_no_mass(&kept, findings);
    equations
}

/// Configurations as drawn, at the start of the motion, and in generic position.
struct Places<'a> {
    robot: &'a Robot,
    tree: &'a Tree,
    freedoms: Vec<Freedom>,
    drawn: Vec<Pose>,
    begun: Configuration,
    /// A configuration that satisfies the equations, if one was found.
    start: Option<Configuration>,
    anywhere: Configuration,
    /// Residuals of the equations after the search, if none was found.
    open: Vec<f64>,
}

impl<'a> Places<'a> {
    fn new(robot: &'a Robot, tree: &'a Tree, freedoms: Vec<Freedom>) -> Self {
        let links = &robot.links;
        let begun =
            |link: usize| (links[link].joint.as_ref()).map_or(0.0, |own| own.start() - own.zero);
        let begun = Configuration::new(links, begun);
        let mut places = Self {
            robot,
            tree,
            freedoms,
            drawn: Configuration::new(links, |_| 0.0).poses(links),
            begun: begun.clone(),
            start: None,
            anywhere: begun,
            open: Vec::new(),
        };
        let beside = places.start_and_beside();
        places.anywhere = beside.unwrap_or_else(|| places.displaced(BESIDE[0]));
        places
    }

    /// Finds an initial configuration; the result is a generic configuration near it.
    fn start_and_beside(&mut self) -> Option<Configuration> {
        let (at, linear) = self.nearest(&self.begun);
        if linear.size() <= CLOSED {
            self.start = Some(at);
            return self.beside();
        }
        self.open = linear.off;
        self.start = self.beside();
        self.start.clone()
    }

    /// The nearest configuration that satisfies all equations.
    fn assembled(&self, from: &Configuration) -> Option<Configuration> {
        let (at, linear) = self.nearest(from);
        (linear.size() <= CLOSED).then_some(at)
    }

    fn nearest(&self, from: &Configuration) -> (Configuration, Linear) {
        let links = &self.robot.links;
        from.clone()
            .assembled(links, &self.freedoms, &|at| self.linear(at))
    }

    /// A configuration near the start that satisfies all equations and is generic: no links are aligned by chance.
    fn beside(&self) -> Option<Configuration> {
        let each = BESIDE.into_iter();
        each.map(|share| self.displaced(share))
            .find_map(|from| self.assembled(&from))
    }

    /// The start, displaced along all freedoms.
    fn displaced(&self, share: f64) -> Configuration {
        let columns = 0..self.freedoms.len();
        let by: Vec<f64> = columns.map(|column| share * anywhere(column)).collect();
        let mut displaced = self.start.as_ref().unwrap_or(&self.begun).clone();
        displaced.step(&self.robot.links, &self.freedoms, &by);
        displaced
    }

    /// Refuses constraints that cannot be satisfied.
    fn refuse_what_stays_open(&self, rows: &[Row], findings: &Findings) {
        if self.start.is_some() {
            return;
        }
        let off = self.open.iter().map(|off| off.abs()).enumerate();
        let Some((row, off)) = off.max_by(|(_, a), (_, b)| a.total_cmp(b)) else {
            return;
        };
        let (name, place) = match rows[row] {
            Row::Coupling(index) => {
                let coupling = &self.robot.couplings[index];
                (&coupling.name, &coupling.place)
            }
            Row::Meeting(index, ..) => {
                let connection = &self.robot.connections[index];
                (&connection.name, &connection.place)
            }
        };
        let message = format!(
            "`{}` cannot hold near the joint positions: its residual is {} in SI units",
            appell_spec::shown(name),
            crate::letters::plain((off * 1e6).round() / 1e6)
        );
        let help = "correct places, lengths or values, or import it without couplings";
        findings.error(Code::NotAllowedHere, place.clone(), message, help);
    }

    /// All equations at a configuration.
    fn linear(&self, at: &Configuration) -> Linear {
        let poses = at.poses(&self.robot.links);
        let mut linear = Linear::default();
        for coupling in &self.robot.couplings {
            self.coupled(coupling, at, &mut linear);
        }
        for connection in &self.robot.connections {
            self.connected(connection, &poses, &mut linear);
        }
        linear
    }

    /// The column of a joint with an axis.
    fn column(&self, name: &str) -> Option<usize> {
        let body = *self.tree.by_joint.get(name)?;
        let link = self.tree.bodies[body].link;
        self.freedoms
            .iter()
            .position(|freedom| freedom.link == link)
    }

    fn follower(&self, freedom: usize) -> Follower {
        let Freedom { link, component } = self.freedoms[freedom];
        Follower {
            body: self.tree.body_of[link].unwrap_or_default(),
            component,
        }
    }

    /// Adds the row of a coupling.
    fn coupled(&self, coupling: &Coupling, at: &Configuration, linear: &mut Linear) {
        let value = |name: &str| {
            let body = self.tree.by_joint.get(name);
            let body = body.map(|body| &self.tree.bodies[*body]);
            body.map_or(0.0, |body| body.joint.zero + at.ways[body.link])
        };
        let mut row = vec![0.0; self.freedoms.len()];
        let mut add = |sum: &Sum, by: f64| {
            for (name, factor) in &sum.terms {
                if let Some(column) = self.column(name) {
                    row[column] += by * factor;
                }
            }
        };
        add(&coupling.follows, 1.0);
        let other = coupling.other.as_ref();
        let x = other.map_or(0.0, |other| other.at(value) - coupling.zeros[1]);
        // The polynomial and its slope by Horner's rule, from the highest power on.
        let factors = coupling.coefficients.iter().rev();
        let (polynomial, slope) = factors.fold((0.0, 0.0), |(sum, slope), factor| {
            (sum * x + factor, slope * x + sum)
        });
        if let Some(other) = other {
            add(other, -slope);
        }
        let follows = coupling.follows.at(value) - coupling.zeros[0];
        linear.rows.push(row);
        linear.off.push(follows - polynomial);
    }

    /// The pairs of points of a connection, without their equations.
    fn meetings(&self, connection: &Connection) -> Vec<Meeting> {
        let along = self.along(connection);
        let points = connection.points().into_iter();
        points
            .map(|offset| Meeting {
                ends: connection
                    .ends_at(offset)
                    .map(|(link, at)| self.on_body(link, at)),
                along,
                rows: Vec::new(),
            })
            .collect()
    }

    /// The common ancestor of both ends, in whose frame the equations are written.
    fn along(&self, connection: &Connection) -> Option<usize> {
        let shared = self.carrier_of_both(connection.links());
        shared.and_then(|link| self.tree.body_of[link])
    }

    /// Adds the rows of a connection.
    fn connected(&self, connection: &Connection, poses: &[Pose], linear: &mut Linear) {
        let shared = self.carrier_of_both(connection.links());
        let along = self.along(connection);
        let turned = along.map_or(Rotation::IDENTITY, |body| self.axes(body, poses));
        for offset in connection.points() {
            let ends = connection.ends_at(offset);
            let [first, second] = ends.map(|(link, at)| place(link, at, poses));
            let between = minus(first, second);
            for axis in 0..3 {
                let direction = turned.0.map(|row| row[axis]);
                let mut row = vec![0.0; self.freedoms.len()];
                for (sign, end) in [(1.0, ends[0]), (-1.0, ends[1])] {
                    self.add_slopes(&mut row, sign, end, direction, shared, poses);
                }
                linear.rows.push(row);
                linear.off.push(dot(between, direction));
            }
        }
    }

    /// Adds the partial velocities of a point of a link along a direction. Freedoms above the common ancestor of both
    /// ends cancel and are skipped.
    fn add_slopes(
        &self,
        row: &mut [f64],
        sign: f64,
        end: (Option<usize>, Vector),
        direction: Vector,
        shared: Option<usize>,
        poses: &[Pose],
    ) {
        let (link, at) = end;
        let end_at = place(link, at, poses);
        let behind = std::iter::successors(link, |&link| self.robot.links[link].parent);
        let behind: Vec<usize> = behind.take_while(|link| Some(*link) != shared).collect();
        for (freedom, slope) in self.freedoms.iter().zip(row.iter_mut()) {
            if behind.contains(&freedom.link) {
                let velocity = freedom.twist(&self.robot.links, poses).at(end_at);
                *slope += sign * dot(velocity, direction);
            }
        }
    }

    /// The independent rows, each with its dependent freedom, and the initial configuration if it has to be given.
    ///
    /// Their number is the generic rank. Couplings prefer their declared dependent coordinate; otherwise rows and
    /// dependent freedoms are those with the largest pivots at the start, or in the generic configuration if the
    /// rank at the start is smaller.
    fn followers(
        &self,
        preferred: &[Option<usize>],
    ) -> (Vec<(usize, usize)>, Option<Configuration>) {
        let weights = (0..self.freedoms.len()).map(|column| self.weight(column));
        let weights: Vec<f64> = weights.collect();
        let at = |place: &Configuration| {
            let all = self.linear(place).rows;
            let kept = eliminated(all.clone(), preferred, &weights);
            let own: Vec<&Vec<f64>> = kept.iter().map(|one| &all[one.row]).collect();
            let pivots: Vec<usize> = kept.iter().map(|one| one.pivot).collect();
            let pivots = matched(&own, &pivots);
            let kept = kept.iter().map(|one| one.row).zip(pivots);
            kept.collect::<Vec<(usize, usize)>>()
        };
        let from = self.start.as_ref().unwrap_or(&self.begun);
        let (here, anywhere) = (at(from), at(&self.anywhere));
        let kept = if here.len() == anywhere.len() {
            here
        } else {
            anywhere
        };
        // Only dependent coordinates are changed, until the retained equations are satisfied.
        let follow = |at: &Configuration| {
            let all = self.linear(at);
            let mut linear = Linear::default();
            for (row, _) in &kept {
                let mut entries = vec![0.0; self.freedoms.len()];
                for (_, pivot) in &kept {
                    entries[*pivot] = all.rows[*row][*pivot];
                }
                linear.rows.push(entries);
                linear.off.push(all.off[*row]);
            }
            linear
        };
        let begun = self.begun.clone();
        let (_, linear) = begun.assembled(&self.robot.links, &self.freedoms, &follow);
        let start = if linear.size() <= HELD {
            None
        } else {
            self.start.clone()
        };
        (kept, start)
    }

    /// Weight of a freedom as a dependent coordinate.
    fn weight(&self, freedom: usize) -> f64 {
        let joint = self.robot.links[self.freedoms[freedom].link].joint.as_ref();
        match joint {
            _ if self.turns(freedom) => 0.0,
            Some(joint) if self.robot.driven.contains(&joint.name) => DRIVEN,
            _ => 1.0,
        }
    }

    /// Whether a freedom is a rotation that has no angle as its coordinate.
    fn turns(&self, freedom: usize) -> bool {
        let Freedom { link, component } = self.freedoms[freedom];
        let joint = self.robot.links[link].joint.as_ref();
        match joint.map(|joint| joint.motion) {
            Some(Motion::Free) => component >= 3,
            Some(Motion::Ball) => true,
            _ => false,
        }
    }

    fn refuse(&self, connection: &Connection, follower: Follower, findings: &Findings) {
        let joint = &self.tree.bodies[follower.body].joint.name;
        let message = format!(
            "`{}` closes a loop in which the attitude of joint `{joint}` would have to follow",
            connection.name
        );
        let help = "connect a body on a ball joint or a free joint by a point only, or use hinges";
        let place = connection.place.clone();
        findings.error(Code::NotAllowedHere, place, message, help);
    }

    /// Refuses a joint without inertia along it, dependent coordinates included, as it has no equation of motion.
    fn refuse_what_has_no_mass(&self, kept: &[(usize, usize)], findings: &Findings) {
        let links = &self.robot.links;
        if findings.has_errors() || self.freedoms.len() > mass::MOST_FREEDOMS {
            return;
        }
        let m = mass::matrix(links, &self.robot.tendons, &self.anywhere.poses(links));
        let all = self.linear(&self.anywhere).rows;
        let rows = kept.iter().map(|(row, _)| all[*row].clone()).collect();
        let preferred: Vec<Option<usize>> = kept.iter().map(|(_, pivot)| Some(*pivot)).collect();
        let reduced = eliminated(rows, &preferred, &vec![1.0; self.freedoms.len()]);
        let rows = reduced.into_iter().map(|one| (one.pivot, one.entries));
        let rows: Vec<(usize, Vec<f64>)> = rows.collect();
        if let Some(freedom) = mass::without_inertia(&m, &rows) {
            let body = &self.tree.bodies[self.follower(freedom).body];
            let (link, joint) = (&links[body.link].name, &body.joint.name);
            let message = format!(
                "`{link}` moves by joint `{joint}` but has no inertia along it, nor has anything on it"
            );
            let help = "give it a mass and an inertia, or make the joint fixed";
            let place = links[body.link].place.clone();
            findings.error(Code::SingularMassMatrix, place, message, help);
        }
    }

    /// The last common ancestor of both links; `None` is the ground.
    fn carrier_of_both(&self, ends: [Option<usize>; 2]) -> Option<usize> {
        let way = |end: Option<usize>| -> Vec<usize> {
            std::iter::successors(end, |&link| self.robot.links[link].parent).collect()
        };
        let [first, second] = ends.map(way);
        first.into_iter().find(|link| second.contains(link))
    }

    /// Directions of the axes of a body's frame.
    fn axes(&self, body: usize, poses: &[Pose]) -> Rotation {
        let moved = &self.tree.bodies[body];
        poses[moved.link].rotation.then(moved.own)
    }

    /// A point of a link, in the frame of its body.
    fn on_body(&self, link: Option<usize>, at: Vector) -> (Option<usize>, Vector) {
        let at = place(link, at, &self.drawn);
        let Some(body) = link.and_then(|link| self.tree.body_of[link]) else {
            return (None, at);
        };
        let moved = &self.tree.bodies[body];
        let origin = match moved.joint.motion {
            Motion::Turning | Motion::Ball => moved.joint.anchor,
            Motion::Sliding | Motion::Free => [0.0; 3],
        };
        let origin = self.drawn[moved.link].of(origin);
        let at = self.axes(body, &self.drawn).inverse().of(minus(at, origin));
        (Some(body), crate::inertia::without_rounding(at))
    }
}

impl Connection {
    /// The links that it connects.
    fn links(&self) -> [Option<usize>; 2] {
        self.ends.map(|(link, _)| link)
    }

    /// A point of the first end, shifted in its frame, and the coincident point of the second.
    fn ends_at(&self, offset: Vector) -> [(Option<usize>, Vector); 2] {
        let [(first, at), (second, _)] = self.ends;
        let at = add(at, offset);
        [(first, at), (second, self.second.of(at))]
    }
}

/// Position of a point of a link.
fn place(link: Option<usize>, at: Vector, poses: &[Pose]) -> Vector {
    link.map_or(at, |link| poses[link].of(at))
}

/// The pose of one link in another as drawn; `None` is the ground.
pub(crate) fn drawn(links: &[Link], [first, second]: [Option<usize>; 2]) -> Pose {
    let poses = Configuration::new(links, |_| 0.0).poses(links);
    let of = |link: Option<usize>| link.map_or(Pose::IDENTITY, |link| poses[link]);
    of(second).inverse().then(of(first))
}
