//! The sites in a mechanism at which effects may act, and their placeholders in the text of an
//! effect.

use appell_spec::expr::{Expr, ExprKind, Quantity};
use appell_spec::mechanism::{
    BodyId, Constraint, ConstraintKind, CoordinateId, InputId, Load, LoadKind, Mechanism,
    ParameterId, PseudoVelocity,
};
use appell_spec::units::{Dimension, Unit};
use num_traits::Zero;

/// Kinds of sites.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SiteKind {
    /// A coordinate whose rate moves something by itself.
    Coordinate,
    /// Such a coordinate that is a length.
    Slider,
    /// Such a coordinate that is an angle.
    Hinge,
    /// A slider that a pseudo-velocity of its own moves, and an input.
    DrivenSlider,
    /// Such a hinge.
    DrivenHinge,
    /// A body.
    Body,
    /// A body with a frame.
    RigidBody,
    /// A body that rolls.
    Wheel,
    /// A rolling contact that does not creep yet.
    Contact,
    /// The weight.
    Gravity,
    /// A parameter.
    Parameter,
    /// An input.
    Input,
    /// A measured channel.
    Channel,
}

/// Word, kind, and what it is.
const WORDS: [(&str, SiteKind, &str); 13] = [
    (
        "coordinate",
        SiteKind::Coordinate,
        "length or angle that is not prescribed",
    ),
    ("slider", SiteKind::Slider, "length that is not prescribed"),
    ("hinge", SiteKind::Hinge, "angle that is not prescribed"),
    (
        "driven_slider",
        SiteKind::DrivenSlider,
        "length that inputs drive, its rate a pseudo-velocity",
    ),
    (
        "driven_hinge",
        SiteKind::DrivenHinge,
        "angle that inputs drive, its rate a pseudo-velocity",
    ),
    ("body", SiteKind::Body, "body"),
    ("rigid_body", SiteKind::RigidBody, "body with a frame"),
    ("wheel", SiteKind::Wheel, "body that rolls"),
    ("contact", SiteKind::Contact, "rolling contact"),
    ("gravity", SiteKind::Gravity, "weight"),
    (
        "parameter",
        SiteKind::Parameter,
        "parameter with a tolerance",
    ),
    ("input", SiteKind::Input, "input that was used"),
    ("channel", SiteKind::Channel, "measured column"),
];

impl SiteKind {
    pub(super) fn of(word: &str) -> Option<Self> {
        let found = WORDS.iter().find(|(own, ..)| *own == word);
        found.map(|(_, kind, _)| *kind)
    }

    #[cfg(test)]
    pub(super) fn all() -> impl Iterator<Item = Self> {
        WORDS.into_iter().map(|(_, kind, _)| kind)
    }

    pub(super) fn kinds() -> String {
        WORDS.map(|(word, ..)| word).join(", ")
    }

    /// Its word.
    pub fn word(self) -> &'static str {
        self.row().map_or("", |(word, ..)| word)
    }

    /// What each is, in words.
    pub fn about(self) -> &'static str {
        self.row().map_or("", |(.., about)| about)
    }

    fn row(self) -> Option<&'static (&'static str, Self, &'static str)> {
        WORDS.iter().find(|(_, kind, _)| *kind == self)
    }

    /// Lists of words that stand for something at such a place, beside `effect` and `site`.
    pub(super) fn words(self) -> &'static [&'static [&'static str]] {
        match self {
            Self::Coordinate | Self::Slider | Self::Hinge => &[OF_COORDINATE, ACROSS],
            Self::DrivenSlider | Self::DrivenHinge => {
                &[OF_COORDINATE, ACROSS, OF_DRIVEN, LATER_DRIVEN]
            }
            Self::Body | Self::RigidBody => &[OF_BODY, LATER_BODY],
            Self::Wheel => &[OF_BODY, OF_WHEEL, LATER_BODY],
            Self::Gravity => &[&["gravity"], ACROSS],
            Self::Input => &[&["unit", "largest", "narrow"]],
            Self::Contact | Self::Parameter | Self::Channel => &[],
        }
    }
}

const OF_COORDINATE: &[&str] = &["unit", "force", "typical_rate", "narrow_rate"];
const ACROSS: &[&str] = &["across_1", "across_2", "across_x", "across_y", "across_z"];
const OF_DRIVEN: &[&str] = &["pseudo_velocity"];
const OF_BODY: &[&str] = &[
    "centre",
    "frame",
    "speed",
    "velocity_x",
    "velocity_y",
    "velocity_z",
];
const OF_WHEEL: &[&str] = &[
    "contact",
    "roll",
    "narrow_rate",
    "axle_rate",
    "spin",
    "normal_x",
    "normal_y",
    "normal_z",
];
/// Words whose meaning is known once the mechanism has equations.
const LATER_DRIVEN: &[&str] = &["drive", "inertia"];
/// A word whose meaning is known once all effects of the body are.
const LATER_BODY: &[&str] = &["last_centre"];

/// Typical magnitudes from recordings, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Scales {
    /// Typical rate of each coordinate.
    pub rates: Vec<f64>,
    /// Rate over which a sign of each coordinate's rate is rounded.
    pub narrow: Vec<f64>,
    /// Largest value of each input.
    pub largest: Vec<f64>,
    /// Columns of the measured channels.
    pub channels: Vec<String>,
    /// Parameters with a tolerance, which may be wrong by more.
    pub uncertain: Vec<usize>,
}

/// Part of the largest input over which a corner is rounded.
const NARROW: f64 = 0.005;

/// As many drives are likely to be of one make.
const MANY_DRIVES: usize = 3;

/// A site.
#[derive(Debug, Clone)]
pub(super) struct Site {
    /// Name in the spec; `gravity` for the weight, the column for a channel.
    pub(super) name: String,
    /// Its index among its like: parameters, inputs, channels.
    pub(super) index: usize,
    /// Words and what they stand for.
    pub(super) words: Vec<(&'static str, String)>,
    /// Axes along which the drawing already places the centre of mass.
    pub(super) placed_along: Vec<&'static str>,
}

/// Sites in a mechanism.
pub(super) struct Sites<'m> {
    mechanism: &'m Mechanism,
    scales: &'m Scales,
}

impl<'m> Sites<'m> {
    pub(super) const fn new(mechanism: &'m Mechanism, scales: &'m Scales) -> Self {
        Self { mechanism, scales }
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
            SiteKind::Body => self
                .mechanism
                .bodies
                .ids()
                .map(|body| self.body(body))
                .collect(),
            SiteKind::RigidBody => self
                .mechanism
                .bodies
                .ids()
                .filter(|&body| self.mechanism.bodies[body].frame.is_some())
                .map(|body| self.body(body))
                .collect(),
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
                    placed_along: Vec::new(),
                };
                columns.map(site).collect()
            }
        }
    }

    fn dimension(&self, coordinate: CoordinateId) -> Dimension {
        self.mechanism.coordinates[coordinate].label.unit.dimension
    }

    /// Coordinates whose rates stand in definitions of the pseudo-velocities: the others follow.
    fn moving(&self) -> Vec<CoordinateId> {
        let stands = |&q: &CoordinateId| {
            let mut speeds = self.mechanism.pseudo_velocities.iter();
            speeds.any(|speed| mentions(&speed.definition, Quantity::Rate(q)))
        };
        self.mechanism.coordinates.ids().filter(stands).collect()
    }

    /// Coordinates whose rates are pseudo-velocities and stand in no other one, if there are inputs; the
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

    /// The names of driven coordinates, where there are many, as in a robot.
    pub(super) fn drives(&self) -> Vec<&str> {
        let driven = driven(self.mechanism);
        if driven.len() < MANY_DRIVES {
            return Vec::new();
        }
        let name = |q: &CoordinateId| self.mechanism.coordinates[*q].label.name.as_str();
        driven.iter().map(name).collect()
    }

    fn coordinate(&self, index: CoordinateId) -> Site {
        let label = &self.mechanism.coordinates[index].label;
        let is_length = self.dimension(index) == Dimension::LENGTH;
        let (unit, force) = if is_length {
            ("m", "N")
        } else {
            ("rad", "N*m")
        };
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
            placed_along: Vec::new(),
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
        }
    }

    /// Axes of the frame of a body along which its centre is placed: an error there is one of a
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

    /// Bodies that roll, with their angular velocity about the normal of the ground.
    fn wheels(&self) -> Vec<Site> {
        let rolling = self
            .mechanism
            .constraints
            .iter()
            .filter_map(|c| match c.kind {
                ConstraintKind::Rolling { body, .. } => Some(body),
                _ => None,
            });
        let mut bodies: Vec<BodyId> = rolling.collect();
        bodies.sort_unstable();
        bodies.dedup();
        bodies
            .into_iter()
            .filter_map(|body| self.wheel(body))
            .collect()
    }

    fn contacts(&self) -> Vec<Site> {
        let constraints = self.mechanism.constraints.iter().enumerate();
        let rolls =
            |kind: &ConstraintKind| matches!(kind, ConstraintKind::Rolling { creep: None, .. });
        let contacts = constraints.filter(|(_, constraint)| rolls(&constraint.kind));
        let site = |(index, constraint): (usize, &Constraint)| Site {
            name: constraint.name.clone(),
            index,
            words: Vec::new(),
            placed_along: Vec::new(),
        };
        contacts.map(site).collect()
    }

    fn wheel(&self, body: BodyId) -> Option<Site> {
        let down = self.mechanism.down()?;
        let frame = self.mechanism.bodies[body].frame?;
        let turn = self.mechanism.frames[frame].turns.last()?;
        let ExprKind::Quantity(Quantity::Coordinate(roll)) = turn.angle.kind else {
            return None;
        };
        let name = &self.mechanism.frames[frame].name;
        let axle = ["x", "y", "z"][turn.axis.index()];
        let axes = down.iter().zip(["x", "y", "z"]);
        let spin: Vec<String> = axes
            .filter(|(down, _)| **down != 0)
            .map(|(down, axis)| format!("({})*angular_velocity({name}, {axis})", -down))
            .collect();
        let mut constraints = self.mechanism.constraints.iter();
        let contact = constraints.find(|constraint| {
            matches!(constraint.kind, ConstraintKind::Rolling { body: own, .. } if own == body)
        })?;
        let mut site = self.body(body);
        site.words.extend([
            ("contact", contact.name.clone()),
            ("roll", self.mechanism.coordinates[roll].label.name.clone()),
            ("narrow_rate", number(self.scales.narrow[roll.index()])),
            (
                "axle_rate",
                format!("angular_velocity({name}, {axle}, {name})"),
            ),
            ("spin", spin.join(" + ")),
            ("normal_x", (-down[0]).to_string()),
            ("normal_y", (-down[1]).to_string()),
            ("normal_z", (-down[2]).to_string()),
        ]);
        Some(site)
    }

    fn gravity(&self) -> Option<Site> {
        let mut loads = self.mechanism.loads.iter();
        let gravity = loads.find_map(|load| match &load.kind {
            LoadKind::Gravity { acceleration, .. } => Some(acceleration),
            _ => None,
        })?;
        let mut words = self.across();
        words.push(("gravity", self.written(gravity)?));
        Some(Site {
            name: "gravity".to_owned(),
            index: 0,
            words,
            placed_along: Vec::new(),
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
            placed_along: Vec::new(),
        }
    }

    fn input(&self, index: InputId) -> Site {
        let label = &self.mechanism.inputs[index].label;
        let largest = self.scales.largest[index.index()];
        // Numbers of a fragment are in SI; so has to be its unit.
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
            placed_along: Vec::new(),
        }
    }

    /// A constant expression in the words of the spec.
    fn written(&self, expr: &Expr) -> Option<String> {
        match &expr.kind {
            ExprKind::Quantity(Quantity::Parameter(p)) => {
                Some(self.mechanism.parameters[*p].label.name.clone())
            }
            _ => None,
        }
    }
}

/// Digits that are enough for a scale, and give the same text everywhere.
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
