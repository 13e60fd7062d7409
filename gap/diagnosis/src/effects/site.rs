//! The sites in a mechanism at which effects may act, and the placeholders that they define in the text of an
//! effect.

mod wheels;

use appell_spec::expr::{Expr, ExprKind, Quantity};
use appell_spec::mechanism::{
    BodyId, CoordinateId, InputId, Load, LoadKind, Mechanism, ParameterId, PseudoVelocity, SpeedId,
};
use appell_spec::units::{Dimension, Unit};
use num_traits::{ToPrimitive, Zero};

use super::extent::Extent;
use super::load::{Stated, controlled};
use super::site_kind::{LATER_BODY, LATER_DRIVEN, SiteKind};

/// Typical magnitudes from recordings, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales {
    /// Typical rate of each coordinate.
    pub rates: Vec<f64>,
    /// Rate over which the sign function of each coordinate's rate is smoothed.
    pub narrow: Vec<f64>,
    /// Largest value of each input.
    pub largest: Vec<f64>,
    /// Smallest and largest value of each measured coordinate that reversed at one of them.
    pub reached: Vec<Option<[f64; 2]>>,
    /// Largest magnitude of each load that depends on the motion like a controller; zero for others.
    pub loads: Vec<f64>,
    /// Columns of the measured channels.
    pub channels: Vec<String>,
    /// The coordinate that each of them measures.
    pub coordinates: Vec<Option<usize>>,
    /// The pseudo-velocity that each of them measures.
    pub speeds: Vec<Option<usize>>,
    /// Parameters with a tolerance, whose errors may exceed it.
    pub uncertain: Vec<usize>,
}

/// Width, relative to the largest input, over which a corner is smoothed.
const NARROW: f64 = 0.005;

/// Name of the site of an effect at all drives.
pub(super) const DRIVES: &str = "drives";

/// Number of drives from which a common cause at all of them is considered, and of a robot.
const MANY_DRIVES: [usize; 2] = [3, 2];

/// Number of coordinates beyond which only neighbours form pairs.
const MANY_PAIRS: usize = 3;

/// Distance of the initial position of a stop from the end of the motion, relative to its range.
const WITHIN: f64 = 0.05;

/// A site.
#[derive(Debug, Clone, Default)]
pub(super) struct Site {
    /// Name in the spec; `gravity` for the weight, the column for a channel.
    pub(super) name: String,
    /// Its index among the parameters, inputs, channels, and so on.
    pub(super) index: usize,
    /// Placeholders with their texts.
    pub(super) words: Vec<(&'static str, String)>,
    /// Axes along which a parameter of the spec already gives the position of the centre of mass.
    pub(super) placed_along: Vec<&'static str>,
    /// The statement of a load in the spec.
    pub(super) stated: Option<Stated>,
}

/// Sites in a mechanism.
pub(super) struct Sites<'m> {
    mechanism: &'m Mechanism,
    scales: &'m Scales,
    /// The text of its spec, if known.
    text: &'m str,
}

impl<'m> Sites<'m> {
    pub(super) const fn new(mechanism: &'m Mechanism, scales: &'m Scales) -> Self {
        Self::of_spec(mechanism, scales, "")
    }

    pub(super) const fn of_spec(
        mechanism: &'m Mechanism,
        scales: &'m Scales,
        text: &'m str,
    ) -> Self {
        Self {
            mechanism,
            scales,
            text,
        }
    }

    /// All sites of a kind.
    pub(super) fn of(&self, kind: SiteKind) -> Vec<Site> {
        let sites = self.all(kind);
        let later = [LATER_DRIVEN, LATER_BODY].concat();
        let mut known: Vec<&str> = kind.words().concat();
        known.retain(|word| !later.contains(word));
        known.sort_unstable();
        for site in &sites {
            let mut own: Vec<&str> = site.words.iter().map(|(word, _)| *word).collect();
            own.sort_unstable();
            debug_assert_eq!(own, known, "words of {}", kind.word());
        }
        sites
    }

    fn all(&self, kind: SiteKind) -> Vec<Site> {
        let is_length = |&q: &CoordinateId| self.dimension(q) == Dimension::LENGTH;
        // An angle may have the unit 1.
        let is_angle = |&q: &CoordinateId| self.dimension(q).is_none();
        let moving = self.moving();
        let moving = moving.into_iter();
        match kind {
            SiteKind::Coordinate => moving
                .filter(|q| is_length(q) || is_angle(q))
                .map(|q| self.coordinate(q))
                .collect(),
            SiteKind::Slider => moving
                .filter(is_length)
                .map(|q| self.coordinate(q))
                .collect(),
            SiteKind::Hinge => moving
                .filter(is_angle)
                .map(|q| self.coordinate(q))
                .collect(),
            SiteKind::DrivenSlider => self.driven(is_length),
            SiteKind::DrivenHinge => self.driven(is_angle),
            // Of a point without mass, which is a payload of some runs, nothing is unknown.
            SiteKind::Body => self
                .mechanism
                .bodies
                .ids()
                .filter(|&body| !self.is_massless_point(body))
                .map(|body| self.body(body))
                .collect(),
            SiteKind::RigidBody => self
                .mechanism
                .bodies
                .ids()
                .filter(|&body| self.mechanism.bodies[body].frame.is_some())
                .map(|body| self.rigid_body(body))
                .collect(),
            SiteKind::Reached => moving.filter_map(|q| self.reached(q)).collect(),
            SiteKind::Pair => self.pairs(),
            SiteKind::Load => self
                .loads()
                .filter(|load| !self.is_servo(&load.name))
                .collect(),
            SiteKind::Servo => self
                .loads()
                .filter(|load| self.is_servo(&load.name))
                .collect(),
            SiteKind::Joint => moving
                .filter(|&q| self.kind(q).is_some() && self.is_joint(q))
                .map(|q| self.coordinate(q))
                .collect(),
            SiteKind::Encoder => self.encoders().collect(),
            SiteKind::Wheel => self.wheels(),
            SiteKind::Contact => self.contacts(),
            SiteKind::Gravity => self.gravity().into_iter().collect(),
            SiteKind::Parameter => self
                .scales
                .uncertain
                .iter()
                .map(|&p| self.parameter(ParameterId::new(p)))
                .collect(),
            SiteKind::Input => self
                .mechanism
                .inputs
                .ids()
                .filter(|input| self.scales.largest[input.index()] > 0.0)
                .map(|input| self.input(input))
                .collect(),
            SiteKind::Channel => {
                let columns = self.scales.channels.iter().enumerate();
                let site = |(index, column): (usize, &String)| Site {
                    name: column.clone(),
                    index,
                    words: Vec::new(),
                    ..Site::default()
                };
                columns.map(site).collect()
            }
        }
    }

    fn is_massless_point(&self, body: BodyId) -> bool {
        let body = &self.mechanism.bodies[body];
        let stated = |quantity| match quantity {
            Quantity::Parameter(id) => self.mechanism.parameters[id].value,
            _ => f64::NAN,
        };
        body.frame.is_none() && body.mass.value(&stated) == 0.0
    }

    fn dimension(&self, coordinate: CoordinateId) -> Dimension {
        self.mechanism.coordinates[coordinate].label.unit.dimension
    }

    /// Coordinates whose rates appear in definitions of the pseudo-velocities; all others are dependent.
    fn moving(&self) -> Vec<CoordinateId> {
        let stands = |&q: &CoordinateId| {
            let mut speeds = self.mechanism.pseudo_velocities.iter();
            speeds.any(|speed| mentions(&speed.definition, Quantity::Rate(q)))
        };
        self.mechanism.coordinates.ids().filter(stands).collect()
    }

    /// A coordinate, with the range of its motion.
    fn reached(&self, index: CoordinateId) -> Option<Site> {
        let [least, most] = self.scales.reached[index.index()]?;
        let range = most - least;
        let mut site = self.coordinate(index);
        site.words.extend([
            ("upper", number(most - WITHIN * range)),
            ("lower", number(least + WITHIN * range)),
            ("range", number(range)),
        ]);
        Some(site)
    }

    /// Pairs of coordinates.
    fn pairs(&self) -> Vec<Site> {
        let mut moving = self.moving();
        moving.retain(|&q| self.kind(q).is_some());
        let far = if moving.len() > MANY_PAIRS {
            1
        } else {
            MANY_PAIRS
        };
        let pairs = (0..moving.len()).flat_map(|first| {
            let seconds = first + 1..moving.len().min(first + 1 + far);
            seconds.map(move |second| [first, second])
        });
        pairs
            .filter_map(|pair| self.pair(pair.map(|place| moving[place])))
            .collect()
    }

    fn pair(&self, [first, second]: [CoordinateId; 2]) -> Option<Site> {
        let ([first_unit, first_force], [second_unit, second_force]) =
            (self.kind(first)?, self.kind(second)?);
        let [first_rate, second_rate] = [first, second].map(|q| self.scales.rates[q.index()]);
        let ratio = if first_unit == second_unit {
            1.0
        } else {
            first_rate / second_rate
        };
        let label = |q: CoordinateId| self.mechanism.coordinates[q].label.name.clone();
        let texts = [first_unit, second_unit, first_force, second_force].map(str::to_owned);
        let [first_unit, second_unit, first_force, second_force] = texts;
        Some(Site {
            name: format!("{},{}", label(first), label(second)),
            index: first.index(),
            words: vec![
                ("first", label(first)),
                ("second", label(second)),
                ("first_unit", first_unit),
                ("second_unit", second_unit),
                ("first_force", first_force),
                ("second_force", second_force),
                ("ratio", number(ratio)),
            ],
            ..Site::default()
        })
    }

    /// Loads that depend on the motion like a controller.
    fn loads(&self) -> impl Iterator<Item = Site> {
        let loads = self.mechanism.loads.iter().enumerate();
        let site = move |(index, load): (usize, &Load)| {
            let largest = self.scales.loads[index];
            let stated = Stated::of(self.mechanism, load, self.text)?;
            (largest > 0.0).then(|| Site {
                name: load.name.clone(),
                index,
                words: vec![
                    ("expression", Stated::name("{effect}")),
                    ("unit", stated.unit.to_owned()),
                    ("largest", number(largest)),
                    ("narrow", number(NARROW * largest)),
                ],
                stated: Some(stated),
                ..Site::default()
            })
        };
        loads.filter_map(site)
    }

    /// Whether a load with the name of an input acts along a coordinate.
    fn is_joint(&self, q: CoordinateId) -> bool {
        let mut loads = self.mechanism.loads.iter();
        loads.any(|load| {
            let LoadKind::Generalized { velocity, .. } = &load.kind else {
                return false;
            };
            velocity.kind == ExprKind::Quantity(Quantity::Rate(q)) && self.is_input(&load.name)
        })
    }

    /// Channels of the joints of a robot.
    fn encoders(&self) -> impl Iterator<Item = Site> {
        let channels = self.scales.channels.iter().zip(&self.scales.coordinates);
        channels
            .enumerate()
            .filter_map(|(index, (column, coordinate))| {
                let mut joints = self
                    .mechanism
                    .coordinates
                    .ids()
                    .filter(|&q| self.is_joint(q));
                let q = joints.find(|q| Some(q.index()) == *coordinate)?;
                let [unit, _] = self.kind(q)?;
                let name = &self.mechanism.coordinates[q].label.name;
                Some(Site {
                    name: column.clone(),
                    index,
                    words: vec![("coordinate", name.clone()), ("unit", unit.to_owned())],
                    ..Site::default()
                })
            })
    }

    /// Whether a load is the actuator of the input of this name.
    pub(super) fn is_servo(&self, name: &str) -> bool {
        let mut loads = self.mechanism.loads.iter();
        self.is_input(name) && loads.any(|load| load.name == name && controlled(load).is_some())
    }

    fn is_input(&self, name: &str) -> bool {
        let mut inputs = self.mechanism.inputs.iter();
        inputs.any(|input| input.label.name == name)
    }

    /// Coordinates whose rates are pseudo-velocities and appear in no other one, if there are inputs; the
    /// index is that of the pseudo-velocity.
    fn driven(&self, fits: impl Fn(&CoordinateId) -> bool) -> Vec<Site> {
        let speeds = &self.mechanism.pseudo_velocities;
        let of = |(index, speed): (usize, &PseudoVelocity)| {
            let ExprKind::Quantity(Quantity::Rate(q)) = speed.definition.kind else {
                return None;
            };
            let users = speeds
                .iter()
                .filter(|own| mentions(&own.definition, Quantity::Rate(q)));
            let mut site = Site {
                index,
                ..self.coordinate(q)
            };
            let own = ("pseudo_velocity", speed.label.name.clone());
            site.words.push(own);
            (users.count() == 1 && fits(&q)).then_some(site)
        };
        if self.scales.largest.iter().all(|&largest| largest <= 0.0) {
            return Vec::new();
        }
        speeds.iter().enumerate().filter_map(of).collect()
    }

    /// Groups of sites at which an effect may have a common cause, with their names: all drives, where there are many, or
    /// the position and the rate that an encoder of a robot gives, under the name of its joint.
    pub(super) fn groups(&self, kind: SiteKind) -> Vec<(String, Vec<String>)> {
        if kind != SiteKind::Channel {
            let drives = self.drives(kind).into_iter().map(str::to_owned);
            return vec![(DRIVES.to_owned(), drives.collect())];
        }
        let joints = self.mechanism.coordinates.ids();
        let groups = joints.filter(|&q| self.is_joint(q)).map(|q| {
            let measures = |channel: usize| {
                let speed = self.scales.speeds[channel].map(SpeedId::new);
                self.scales.coordinates[channel] == Some(q.index())
                    || speed.is_some() && speed == self.mechanism.speed_of(q)
            };
            let columns = self.scales.channels.iter().enumerate();
            let own = columns.filter(|(channel, _)| measures(*channel));
            let name = self.mechanism.coordinates[q].label.name.clone();
            (name, own.map(|(_, column)| column.clone()).collect())
        });
        groups.collect()
    }

    /// The names of driven coordinates, or of the inputs, where there are many, as in a robot.
    fn drives(&self, kind: SiteKind) -> Vec<&str> {
        let driven = driven(self.mechanism);
        let is_of_robot = driven.iter().all(|&q| self.is_joint(q));
        if driven.len() < MANY_DRIVES[usize::from(is_of_robot)] {
            return Vec::new();
        }
        if kind == SiteKind::Input {
            let inputs = self.mechanism.inputs.iter();
            return inputs.map(|input| input.label.name.as_str()).collect();
        }
        let name = |q: &CoordinateId| self.mechanism.coordinates[*q].label.name.as_str();
        driven.iter().map(name).collect()
    }

    /// The units of a length or an angle and of the force along it.
    fn kind(&self, index: CoordinateId) -> Option<[&'static str; 2]> {
        let dimension = self.dimension(index);
        if dimension == Dimension::LENGTH {
            Some(["m", "N"])
        } else {
            dimension.is_none().then_some(["rad", "N*m"])
        }
    }

    fn coordinate(&self, index: CoordinateId) -> Site {
        let label = &self.mechanism.coordinates[index].label;
        let [unit, force] = self.kind(index).unwrap_or(["rad", "N*m"]);
        let rate = self.scales.rates[index.index()];
        let mut words = vec![
            ("unit", unit.to_owned()),
            ("force", force.to_owned()),
            ("typical_rate", number(rate)),
            ("narrow_rate", number(self.scales.narrow[index.index()])),
        ];
        words.extend(self.across());
        Site {
            name: label.name.clone(),
            index: index.index(),
            words,
            ..Site::default()
        }
    }

    fn body(&self, index: BodyId) -> Site {
        let body = &self.mechanism.bodies[index];
        let centre = &self.mechanism.points[body.centre].name;
        let velocity = |axis: &str| format!("velocity({centre}, {axis})");
        let frame = body
            .frame
            .map(|frame| self.mechanism.frames[frame].name.clone());
        Site {
            name: body.name.clone(),
            index: index.index(),
            words: vec![
                ("centre", centre.clone()),
                ("frame", frame.unwrap_or_else(|| "ground".to_owned())),
                ("speed", format!("smooth_abs(speed({centre}), 0.001 [m/s])")),
                ("velocity_x", velocity("x")),
                ("velocity_y", velocity("y")),
                ("velocity_z", velocity("z")),
            ],
            placed_along: self.placed_along(index),
            ..Site::default()
        }
    }

    /// A body, with its size.
    fn rigid_body(&self, index: BodyId) -> Site {
        let extent = Extent::of(self.mechanism, index);
        let mut site = self.body(index);
        let [x, y, z] = extent.away.map(number);
        site.words.extend([
            ("away_x", x),
            ("away_y", y),
            ("away_z", z),
            ("reach", number(extent.reach)),
        ]);
        site
    }

    /// Axes of the frame of a body along which parameters give its centre: an error there is one of a
    /// parameter.
    fn placed_along(&self, index: BodyId) -> Vec<&'static str> {
        let body = &self.mechanism.bodies[index];
        let centre = &self.mechanism.points[body.centre];
        if Some(centre.frame) != body.frame {
            return Vec::new();
        }
        let is_zero = |expr: &Expr| matches!(&expr.kind, ExprKind::Number(n) if n.is_zero());
        let axes = ["x", "y", "z"].into_iter().zip(&centre.at);
        axes.filter(|(_, at)| !is_zero(at))
            .map(|(axis, _)| axis)
            .collect()
    }

    fn gravity(&self) -> Option<Site> {
        let mut loads = self.mechanism.loads.iter();
        let gravity = loads.find_map(|load| match &load.kind {
            LoadKind::Gravity { acceleration, .. } => Some(acceleration),
            _ => None,
        })?;
        let mut words = self.across();
        words.push(("gravity", self.written(gravity, "m/s^2")?));
        Some(Site {
            name: "gravity".to_owned(),
            index: 0,
            words,
            ..Site::default()
        })
    }

    /// Axes of the ground across the weight.
    fn across(&self) -> Vec<(&'static str, String)> {
        let down = self.mechanism.down().unwrap_or([0, 0, -1]);
        let across: Vec<usize> = (0..3).filter(|&axis| down[axis] == 0).collect();
        let letter = |place: usize| ["x", "y", "z"][across[place]].to_owned();
        let component = |axis: usize| if across[0] == axis { "1" } else { "0" }.to_owned();
        vec![
            ("across_1", letter(0)),
            ("across_2", letter(1)),
            ("across_x", component(0)),
            ("across_y", component(1)),
            ("across_z", component(2)),
        ]
    }

    fn parameter(&self, index: ParameterId) -> Site {
        Site {
            name: self.mechanism.parameters[index].label.name.clone(),
            index: index.index(),
            words: Vec::new(),
            ..Site::default()
        }
    }

    fn input(&self, index: InputId) -> Site {
        let label = &self.mechanism.inputs[index].label;
        let largest = self.scales.largest[index.index()];
        // Numbers of a fragment are in SI, and so must be its unit.
        let unit = if label.unit.is_si() {
            label.unit.text.clone()
        } else {
            Unit::si(label.unit.dimension).text
        };
        Site {
            name: label.name.clone(),
            index: index.index(),
            words: vec![
                ("unit", unit),
                ("largest", number(largest)),
                ("narrow", number(NARROW * largest)),
            ],
            ..Site::default()
        }
    }

    /// A parameter or a number, as an expression in the language of the spec.
    fn written(&self, expr: &Expr, unit: &str) -> Option<String> {
        match &expr.kind {
            ExprKind::Quantity(Quantity::Parameter(p)) => {
                Some(self.mechanism.parameters[*p].label.name.clone())
            }
            ExprKind::Number(n) if !n.is_zero() => Some(format!("{} [{unit}]", n.to_f64()?)),
            _ => None,
        }
    }
}

/// A scale with few digits, so that its text is the same on all machines.
pub(super) fn number(value: f64) -> String {
    format!("{value:.3e}")
}

/// Coordinates with an input along their rate alone.
pub(crate) fn driven(mechanism: &Mechanism) -> Vec<CoordinateId> {
    let inputs = |load: &Load| {
        let LoadKind::Generalized { velocity, force } = &load.kind else {
            return None;
        };
        let ExprKind::Quantity(Quantity::Rate(q)) = velocity.kind else {
            return None;
        };
        let mut inputs = mechanism.inputs.ids().map(Quantity::Input);
        inputs.any(|input| mentions(force, input)).then_some(q)
    };
    let mut driven: Vec<CoordinateId> = mechanism.loads.iter().filter_map(inputs).collect();
    driven.sort_unstable();
    driven.dedup();
    driven
}

fn mentions(expr: &Expr, quantity: Quantity) -> bool {
    match &expr.kind {
        ExprKind::Number(_) => false,
        ExprKind::Quantity(own) => *own == quantity,
        ExprKind::Negate(a) => mentions(a, quantity),
        ExprKind::Binary(_, a, b) => mentions(a, quantity) || mentions(b, quantity),
        ExprKind::Call(_, parts) => parts.iter().any(|part| mentions(part, quantity)),
        ExprKind::Choice {
            compared, branches, ..
        } => {
            let mut parts = compared.iter().chain(branches.iter());
            parts.any(|part| mentions(part, quantity))
        }
    }
}
