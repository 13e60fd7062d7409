//! The tree of links. A link is a set of axes with an origin; each moves relative to its carrier by a rotation
//! about the origin or by a translation of the origin along its axes.

use appell_spec::mechanism::{FrameId, GROUND, ORIGIN, PointId};
use rustc_hash::FxHashMap;

use super::super::algebra::Algebra;
use super::super::expressions::Setting;
use super::super::kinematics::Kinematics;
use super::super::rotation::Rotation;
use super::super::symbols::ids;
use crate::symbolic::vector::{self, Mat3, Vec3};
use crate::symbolic::{Expr, Graph, SymbolId};

/// Axes with an origin.
#[derive(Debug, Clone)]
pub(super) struct Link {
    /// Its name in the names of quantities.
    pub(super) name: String,
    /// Its carrier; `None` for the ground.
    pub(super) parent: Option<usize>,
    /// Its motion relative to the carrier.
    pub(super) step: Step,
    /// Its relative partial velocities, by speed: angular for a rotation, linear for a translation.
    pub(super) columns: Vec<(usize, Vec3)>,
}

/// The motion of a link relative to its carrier.
#[derive(Debug, Clone)]
pub(super) enum Step {
    /// Rotation about the origin.
    Rotation {
        /// From the axes of the carrier to those of the link.
        turns: Vec<Rotation>,
        /// Angular velocity, in the axes of the link.
        w: Vec3,
        /// Rate of its components at fixed speeds.
        w_dot: Vec3,
    },
    /// Translation with fixed axes.
    Shift {
        /// Position of the origin.
        d: Vec3,
        /// Rate of its components.
        d_dot: Vec3,
        /// Rate of these at fixed speeds.
        d_ddot: Vec3,
    },
}

impl Step {
    /// The turns from the axes of the carrier to those of the link.
    pub(super) fn turns(&self) -> &[Rotation] {
        match self {
            Self::Rotation { turns, .. } => turns,
            Self::Shift { .. } => &[],
        }
    }

    /// A vector of the carrier in the axes of the link.
    pub(super) fn inward(&self, graph: &mut Graph, v: Vec3) -> Vec3 {
        (self.turns().iter()).fold(v, |v, turn| turn.in_child(graph, v))
    }

    /// A vector of the link in the axes of the carrier.
    pub(super) fn outward(&self, graph: &mut Graph, v: Vec3) -> Vec3 {
        (self.turns().iter().rev()).fold(v, |v, turn| turn.in_parent(graph, v))
    }

    /// A tensor of the link in the axes of the carrier.
    pub(super) fn tensor_outward(&self, graph: &mut Graph, tensor: &Mat3) -> Mat3 {
        let turns = self.turns().iter().rev();
        turns.fold(*tensor, |t, turn| turn.tensor_in_parent(graph, &t))
    }

    /// A column as angular and linear acceleration.
    pub(super) fn directed(&self, column: Vec3) -> (Vec3, Vec3) {
        match self {
            Self::Rotation { .. } => (column, vector::ZERO),
            Self::Shift { .. } => (vector::ZERO, column),
        }
    }
}

/// A point fixed in a link, by its position from the origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    /// The link; `None` for the ground.
    pub(super) link: Option<usize>,
    /// Position.
    pub(super) arm: Vec3,
}

impl Place {
    /// The origin of a link.
    fn at(link: Option<usize>) -> Self {
        Self {
            link,
            arm: vector::ZERO,
        }
    }
}

/// All links, carriers first, and the locations of the bodies.
#[derive(Debug, Clone)]
pub(super) struct Links {
    pub(super) all: Vec<Link>,
    /// Names of the speeds.
    pub(super) speeds: Vec<String>,
    /// By body: the location of its centre in its link.
    pub(super) bodies: Vec<Place>,
}

impl Links {
    /// The tree of a mechanism; `None` if a body hangs on a frame that does not carry its axes.
    pub(super) fn new(
        algebra: &mut Algebra,
        setting: Setting<'_>,
        kinematics: &Kinematics,
    ) -> Option<Self> {
        let Setting {
            mechanism, symbols, ..
        } = setting;
        let signals = symbols.signals.iter().flatten().copied();
        let changing: Vec<Expr> = (symbols.coordinates.iter().copied())
            .chain(signals)
            .chain([symbols.time])
            .collect();
        let mut planting = Planting {
            changing: ids(&algebra.graph, &changing),
            algebra,
            setting,
            kinematics,
            links: Vec::new(),
            known: FxHashMap::default(),
        };
        let mut bodies = Vec::with_capacity(mechanism.bodies.len());
        for body in &mechanism.bodies {
            let place = planting.place(body.centre)?;
            let frame = body.frame.unwrap_or(planting.axes_of(body.centre));
            if body
                .inertia
                .as_ref()
                .is_some_and(|inertia| inertia.frame != frame)
            {
                return None;
            }
            bodies.push(if frame == planting.axes_of(body.centre) {
                place
            } else {
                planting.link(frame, body.centre)?
            });
        }
        let all = planting.links;
        let speeds = mechanism.pseudo_velocities.iter();
        let speeds = speeds.map(|speed| speed.label.name.clone()).collect();
        Some(Self {
            all,
            speeds,
            bodies,
        })
    }
}

/// The tree under construction.
struct Planting<'a> {
    algebra: &'a mut Algebra,
    setting: Setting<'a>,
    kinematics: &'a Kinematics,
    /// Symbols on which a position may depend.
    changing: Vec<SymbolId>,
    links: Vec<Link>,
    /// Locations by frame and origin.
    known: FxHashMap<(FrameId, PointId), Place>,
}

impl Planting<'_> {
    /// The frame in whose axes the position of a point is given.
    fn axes_of(&self, point: PointId) -> FrameId {
        self.kinematics.offset(point).frame
    }

    /// The location of a point, in the link with the axes in which its position is given.
    fn place(&mut self, point: PointId) -> Option<Place> {
        // Points come after their reference points, so a loop suffices.
        let mut way = Vec::new();
        let (axes, mut at) = (self.axes_of(point), point);
        let start = loop {
            if at == ORIGIN || self.axes_of(at) != axes {
                break self.link(axes, at)?;
            }
            if let Some(&known) = self.known.get(&(axes, at)) {
                break known;
            }
            way.push(at);
            at = self.setting.mechanism.points[at].from?;
        };
        let mut place = start;
        for &point in way.iter().rev() {
            let offset = self.kinematics.offset(point).v;
            place.arm = self.algebra.graph.add3(place.arm, offset);
            let graph = &self.algebra.graph;
            if offset.iter().any(|&c| graph.mentions(c, &self.changing)) {
                let link = self.shifted(place, &self.setting.mechanism.points[point].name.clone());
                place = Place::at(Some(link));
                self.known.insert((axes, point), place);
            }
        }
        Some(place)
    }

    /// The link with the axes of a frame and its origin at a point.
    fn link(&mut self, frame: FrameId, origin: PointId) -> Option<Place> {
        if let Some(&known) = self.known.get(&(frame, origin)) {
            return Some(known);
        }
        let from = if origin == ORIGIN {
            GROUND
        } else {
            self.axes_of(origin)
        };
        let mut way: Vec<FrameId> = self.kinematics.frames.ancestors(frame);
        let carrier = way.iter().position(|&f| f == from)?;
        way.truncate(carrier);
        let mut start = if origin == ORIGIN {
            Place::at(None)
        } else {
            self.place(origin)?
        };
        if start.arm != vector::ZERO {
            let name = self.setting.mechanism.points[origin].name.clone();
            start = Place::at(Some(self.shifted(start, &name)));
        }
        self.known.insert((from, origin), start);
        if let Some(known) = (way.iter()).position(|&f| self.known.contains_key(&(f, origin))) {
            start = self.known[&(way[known], origin)];
            way.truncate(known);
        }
        way.reverse();
        let place = Place::at(self.turned(start.link, &way));
        self.known.insert((frame, origin), place);
        Some(place)
    }

    /// The link of a sequence of turned frames: a single one if its angular velocity is then shorter than the
    /// rates of the turns, as for a free body.
    fn turned(&mut self, mut link: Option<usize>, way: &[FrameId]) -> Option<usize> {
        let frames = &self.kinematics.frames;
        let turns: Vec<(FrameId, Rotation)> = (way.iter())
            .flat_map(|&frame| {
                frames
                    .rotations(frame)
                    .iter()
                    .map(move |turn| (frame, turn.clone()))
            })
            .collect();
        let Some(&(last, _)) = turns.last() else {
            return link;
        };
        let mut w = vector::ZERO;
        let mut rates = Vec::new();
        for (_, turn) in &turns {
            let graph = &mut self.algebra.graph;
            w = turn.in_child(graph, w);
            w = graph.add3(w, turn.rate());
            rates.extend(turn.rate());
        }
        let together = self.algebra.shortest3(w);
        let graph = &self.algebra.graph;
        if graph.operations(&together) <= graph.operations(&rates) {
            let turns = turns.into_iter().map(|(_, turn)| turn).collect();
            return Some(self.rotated(link, last, turns, together));
        }
        for (frame, turn) in turns {
            let w = turn.rate();
            link = Some(self.rotated(link, frame, vec![turn], w));
        }
        link
    }

    fn rotated(
        &mut self,
        parent: Option<usize>,
        frame: FrameId,
        turns: Vec<Rotation>,
        w: Vec3,
    ) -> usize {
        let w_dot = self.setting.rate3(self.algebra, w);
        let w_dot = self.algebra.shortest3(w_dot);
        let name = &self.setting.mechanism.frames[frame].name;
        self.push(name, parent, Step::Rotation { turns, w, w_dot }, w)
    }

    fn shifted(&mut self, place: Place, name: &str) -> usize {
        let d = place.arm;
        let d_dot = self.setting.rate3(self.algebra, d);
        let d_ddot = self.setting.rate3(self.algebra, d_dot);
        self.push(name, place.link, Step::Shift { d, d_dot, d_ddot }, d_dot)
    }

    /// Adds a link with the partial velocities of `velocity`, that of its step.
    fn push(&mut self, name: &str, parent: Option<usize>, step: Step, velocity: Vec3) -> usize {
        let mut columns = Vec::new();
        for (place, &speed) in self.setting.symbols.speeds.iter().enumerate() {
            let partial = self.algebra.derivative3(velocity, speed);
            if partial != vector::ZERO {
                columns.push((place, partial));
            }
        }
        self.links.push(Link {
            name: name.to_owned(),
            parent,
            step,
            columns,
        });
        self.links.len() - 1
    }
}
