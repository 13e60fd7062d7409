//! The sites in a mechanism at which effects may act, and the placeholders that they define in the text of an
//! effect.

mod bodies;
mod wheels;

use appell_spec::expr::{Expr, ExprKind, Quantity};
use appell_spec::mechanism::{
    CoordinateId, Input, Label, Load, LoadKind, Mechanism, ParameterId, PseudoVelocity, SpeedId,
};
use appell_spec::units::{Dimension, Unit};
use num_traits::{ToPrimitive, Zero};

use super::load::{Stated, controlled, is_zero};
use super::site_kind::SiteKind;

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

/// The axes of a frame.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Distance of the initial position of a stop from the end of the motion, relative to its range.
const WITHIN: f64 = 0.05;

/// The units of a length and of the force along it, and of an angle.
pub(super) const LENGTH: [&str; 2] = ["m", "N"];
pub(super) const ANGLE: [&str; 2] = ["rad", "N*m"];

/// A placeholder with its text.
type Word = (&'static str, String);

/// A site.
#[derive(Debug, Clone, Default)]
pub(super) struct Site {
    /// Name in the spec; `gravity` for the weight, the column for a channel.
    pub(super) name: String,
    /// Its index among the parameters, inputs, channels, and so on.
    pub(super) index: usize,
    /// Placeholders with their texts.
    pub(super) words: Vec<Word>,
    /// Axes along which a parameter of the spec already gives the position of the centre of mass.
    pub(super) placed_along: Vec<&'static str>,
    /// The statement of a load in the spec.
    pub(super) stated: Option<Stated>,
}

impl Site {
    fn new(name: &str, index: usize, words: Vec<Word>) -> Self {
        Self {
            name: name.to_owned(),
            index,
            words,
            ..Self::default()
        }
    }
}

/// Sites in a mechanism.
pub(super) struct Sites<'m> {
    pub(super) mechanism: &'m Mechanism,
    pub(super) scales: &'m Scales,
    /// The text of its spec, if known.
    pub(super) text: &'m str,
}

impl Sites<'_> {
    /// Coordinates that are not prescribed and pass a test.
    pub(super) fn coordinates(&self, fits: impl Fn(CoordinateId) -> bool) -> Vec<Site> {
        let moving = self.moving().into_iter().filter(|&q| fits(q));
        moving.map(|q| self.coordinate(q)).collect()
    }

    /// Coordinates whose rates appear in definitions of the pseudo-velocities; all others are dependent.
    fn moving(&self) -> Vec<CoordinateId> {
        let stands = |&q: &CoordinateId| {
            let mut speeds = self.mechanism.pseudo_velocities.iter();
            speeds.any(|speed| mentions(&speed.definition, Quantity::Rate(q)))
        };
        self.mechanism.coordinates.ids().filter(stands).collect()
    }

    /// Coordinates with the ranges of their motions.
    pub(super) fn reached(&self) -> Vec<Site> {
        let site = |q: CoordinateId| {
            let [least, most] = self.scales.reached[q.index()]?;
            let range = most - least;
            let mut site = self.coordinate(q);
            site.words.extend([
                ("upper", number(most - WITHIN * range)),
                ("lower", number(least + WITHIN * range)),
                ("range", number(range)),
            ]);
            Some(site)
        };
        self.moving().into_iter().filter_map(site).collect()
    }

    /// Pairs of coordinates.
    pub(super) fn pairs(&self) -> Vec<Site> {
        let mut moving = self.moving();
        moving.retain(|&q| self.units(q).is_some());
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

    fn pair(&self, pair: [CoordinateId; 2]) -> Option<Site> {
        let [[unit, force], [other_unit, other_force]] =
            [self.units(pair[0])?, self.units(pair[1])?];
        let [rate, other_rate] = pair.map(|q| self.scales.rates[q.index()]);
        let ratio = if unit == other_unit {
            1.0
        } else {
            rate / other_rate
        };
        let [first, second] = pair.map(|q| self.name(q));
        let words = vec![
            ("first", first.to_owned()),
            ("second", second.to_owned()),
            ("first_unit", unit.to_owned()),
            ("second_unit", other_unit.to_owned()),
            ("first_force", force.to_owned()),
            ("second_force", other_force.to_owned()),
            ("ratio", number(ratio)),
        ];
        let name = format!("{first},{second}");
        Some(Site::new(&name, pair[0].index(), words))
    }

    /// Loads that depend on the motion like a controller: those of the actuators of inputs, or all others.
    pub(super) fn loads(&self, of_servos: bool) -> Vec<Site> {
        let site = |(index, load): (usize, &Load)| {
            let largest = self.scales.loads[index];
            let stated = Stated::of(self.mechanism, load, self.text)?;
            let words = vec![
                ("expression", Stated::name("{effect}")),
                ("unit", stated.unit.to_owned()),
                ("largest", number(largest)),
                ("narrow", number(NARROW * largest)),
            ];
            let site = Site {
                stated: Some(stated),
                ..Site::new(&load.name, index, words)
            };
            (largest > 0.0 && self.is_servo(&load.name) == of_servos).then_some(site)
        };
        let loads = self.mechanism.loads.iter().enumerate();
        loads.filter_map(site).collect()
    }

    /// Whether a load with the name of an input acts along a coordinate.
    pub(super) fn is_joint(&self, q: CoordinateId) -> bool {
        let mut loads = self.mechanism.loads.iter();
        loads.any(|load| {
            let LoadKind::Generalized { velocity, .. } = &load.kind else {
                return false;
            };
            velocity.kind == ExprKind::Quantity(Quantity::Rate(q)) && self.is_input(&load.name)
        })
    }

    fn joints(&self) -> impl Iterator<Item = CoordinateId> {
        let all = self.mechanism.coordinates.ids();
        all.filter(|&q| self.is_joint(q))
    }

    /// Channels of the joints of a robot.
    pub(super) fn encoders(&self) -> Vec<Site> {
        let channels = self.scales.channels.iter().zip(&self.scales.coordinates);
        let site = |(index, (column, coordinate)): (usize, (&String, &Option<usize>))| {
            let q = self.joints().find(|q| Some(q.index()) == *coordinate)?;
            let [unit, _] = self.units(q)?;
            let name = self.name(q).to_owned();
            let words = vec![("coordinate", name), ("unit", unit.to_owned())];
            Some(Site::new(column, index, words))
        };
        channels.enumerate().filter_map(site).collect()
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

    /// Coordinates of some units whose rates are pseudo-velocities and appear in no other one, if there are inputs; the
    /// index is that of the pseudo-velocity.
    pub(super) fn driven(&self, units: [&str; 2]) -> Vec<Site> {
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
            (users.count() == 1 && self.units(q) == Some(units)).then_some(site)
        };
        if self.scales.largest.iter().all(|&largest| largest <= 0.0) {
            return Vec::new();
        }
        speeds.iter().enumerate().filter_map(of).collect()
    }

    /// Groups of sites at which an effect may have a common cause, with their names: all drives, where there are many, or
    /// the position and the rate that an encoder of a robot gives, under the name of its joint.
    pub(super) fn groups(&self, kind: &SiteKind) -> Vec<(String, Vec<String>)> {
        if kind.word != "channel" {
            return vec![(DRIVES.to_owned(), self.drives(kind.word == "input"))];
        }
        let groups = self.joints().map(|q| {
            let measures = |channel: usize| {
                let speed = self.scales.speeds[channel].map(SpeedId::new);
                self.scales.coordinates[channel] == Some(q.index())
                    || speed.is_some() && speed == self.mechanism.speed_of(q)
            };
            let columns = self.scales.channels.iter().enumerate();
            let own = columns.filter(|(channel, _)| measures(*channel));
            let columns = own.map(|(_, column)| column.clone()).collect();
            (self.name(q).to_owned(), columns)
        });
        groups.collect()
    }

    /// The names of driven coordinates, or of the inputs, where there are many, as in a robot.
    fn drives(&self, are_inputs: bool) -> Vec<String> {
        let driven = driven(self.mechanism);
        let is_of_robot = driven.iter().all(|&q| self.is_joint(q));
        if driven.len() < MANY_DRIVES[usize::from(is_of_robot)] {
            return Vec::new();
        }
        if are_inputs {
            let inputs = self.mechanism.inputs.iter();
            return inputs.map(|input| input.label.name.clone()).collect();
        }
        let names = driven.iter().map(|&q| self.name(q).to_owned());
        names.collect()
    }

    /// The units of a length or an angle and of the force along it; an angle may have the unit 1.
    pub(super) fn units(&self, q: CoordinateId) -> Option<[&'static str; 2]> {
        let dimension = self.mechanism.coordinates[q].label.unit.dimension;
        if dimension == Dimension::LENGTH {
            Some(LENGTH)
        } else {
            dimension.is_none().then_some(ANGLE)
        }
    }

    fn name(&self, q: CoordinateId) -> &str {
        &self.mechanism.coordinates[q].label.name
    }

    fn coordinate(&self, q: CoordinateId) -> Site {
        let [unit, force] = self.units(q).unwrap_or(ANGLE);
        let mut words = vec![
            ("unit", unit.to_owned()),
            ("force", force.to_owned()),
            ("typical_rate", number(self.scales.rates[q.index()])),
            ("narrow_rate", number(self.scales.narrow[q.index()])),
        ];
        words.extend(self.across());
        Site::new(self.name(q), q.index(), words)
    }

    pub(super) fn gravity(&self) -> Option<Site> {
        let mut loads = self.mechanism.loads.iter();
        let gravity = loads.find_map(|load| match &load.kind {
            LoadKind::Gravity { acceleration, .. } => Some(acceleration),
            _ => None,
        })?;
        let written = match &gravity.kind {
            ExprKind::Quantity(Quantity::Parameter(p)) => {
                self.mechanism.parameters[*p].label.name.clone()
            }
            ExprKind::Number(n) if !n.is_zero() => format!("{} [m/s^2]", n.to_f64()?),
            _ => return None,
        };
        let mut words = self.across();
        words.push(("gravity", written));
        Some(Site::new("gravity", 0, words))
    }

    /// Axes of the ground across the weight.
    fn across(&self) -> Vec<Word> {
        let down = self.mechanism.down().unwrap_or([0, 0, -1]);
        let across: Vec<usize> = (0..3).filter(|&axis| down[axis] == 0).collect();
        let letter = |place: usize| AXES[across[place]].to_owned();
        let component = |axis: usize| if across[0] == axis { "1" } else { "0" }.to_owned();
        vec![
            ("across_1", letter(0)),
            ("across_2", letter(1)),
            ("across_x", component(0)),
            ("across_y", component(1)),
            ("across_z", component(2)),
        ]
    }

    pub(super) fn parameters(&self) -> Vec<Site> {
        let site = |&index: &usize| {
            let parameter = &self.mechanism.parameters[ParameterId::new(index)];
            Site::new(&parameter.label.name, index, Vec::new())
        };
        self.scales.uncertain.iter().map(site).collect()
    }

    pub(super) fn channels(&self) -> Vec<Site> {
        let columns = self.scales.channels.iter().enumerate();
        let site = |(index, column): (usize, &String)| Site::new(column, index, Vec::new());
        columns.map(site).collect()
    }

    pub(super) fn inputs(&self) -> Vec<Site> {
        let inputs = self.mechanism.inputs.iter().zip(&self.scales.largest);
        let used = inputs
            .enumerate()
            .filter(|(_, (_, largest))| **largest > 0.0);
        let site = |(index, (input, &largest)): (usize, (&Input, &f64))| {
            let Label { name, unit, .. } = &input.label;
            // Numbers of a fragment are in SI, and so must be its unit.
            let unit = if unit.is_si() {
                unit.text.clone()
            } else {
                Unit::si(unit.dimension).text
            };
            let words = vec![
                ("unit", unit),
                ("largest", number(largest)),
                ("narrow", number(NARROW * largest)),
            ];
            Site::new(name, index, words)
        };
        used.map(site).collect()
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
    let mut is_mentioned = false;
    expr.visit(&mut |own| is_mentioned |= own == quantity);
    is_mentioned
}
