//! The changes of the spec under a hypothesis, so that the spec can be improved without the recordings.

use appell_estimate::{Measured, Unknown};
use appell_spec::compose::Composition;
use appell_spec::edit::{EditError, set_deviations, set_parameters};
use appell_spec::mechanism::{Parameter, ParameterId};
use appell_spec::units::{self, Unit};
use serde::{Deserialize, Serialize};
use toml_edit::{DocumentMut, Item};

use super::{Bench, ChangeError, Fitted, Result, whole};
use crate::effects::{Acts, Candidate, EffectModel, ModelError, Part, Term, with_candidates};

/// Changes of a spec.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Changes {
    /// Items to add, in the spec language, with the fitted values.
    pub items: String,
    /// Terms added to an input wherever it acts, or to a coordinate in the geometry.
    pub inputs: Vec<Term>,
    /// Parameters of the items, without switches.
    #[serde(skip)]
    pub brought: Vec<Refitted>,
    /// Parameters of this rig.
    pub parameters: Vec<Refitted>,
    /// Gains and scales of this rig, within their tolerances: relative errors, or factors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub gains: Vec<Refitted>,
    /// Effects on inputs or channels, which a spec cannot express.
    #[serde(rename = "beside")]
    pub signal_effects: Vec<SignalEffect>,
}

/// The value of a parameter on this rig, in its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Refitted {
    /// Name.
    pub name: String,
    /// Value that the data set states.
    pub stated: f64,
    /// Its stated standard deviation, if there is one.
    #[serde(default)]
    pub stated_std: Option<f64>,
    /// Most likely value.
    pub value: f64,
    /// Standard deviation; `None` if the parameter was not free.
    pub std: Option<f64>,
    /// Unit.
    pub unit: String,
}

/// An effect on an input or a channel.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SignalEffect {
    /// Name.
    pub effect: String,
    /// How it acts: `lag`, `delay` of an input; `bias`, `scale`, `late`, `slow` of a channel, or `shows` for a
    /// channel that measures another quantity.
    pub acts: String,
    /// The input or channel.
    pub on: String,
    /// The output that a channel measures, among the items.
    pub output: Option<String>,
    /// What the channel of a robot measures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measures: Option<String>,
}

impl Refitted {
    /// Its difference from the stated value in stated standard deviations, if there is a tolerance.
    pub fn moved_by(&self) -> Option<f64> {
        let std = self.stated_std.filter(|std| *std > 0.0)?;
        Some((self.value - self.stated) / std)
    }
}

impl Changes {
    /// The values that were fitted within tolerances.
    pub fn refitted(&self) -> impl Iterator<Item = &Refitted> {
        self.parameters.iter().chain(&self.gains)
    }

    /// The spec with the changes, its comments and layout unchanged; `note` is a comment above the new items.
    pub fn improved(&self, spec: &str, note: &str) -> Result<String, ChangeError> {
        let mut values: Vec<(&str, f64)> = Vec::new();
        for one in &self.parameters {
            let unit = units::parse(&one.unit).ok();
            let value = unit.and_then(|unit| unit.read(&format!("{:e}", one.value)));
            let unreadable = || ChangeError::Unreadable {
                name: one.name.clone(),
            };
            values.push((&one.name, value.ok_or_else(unreadable)?));
        }
        let text = set_parameters(spec, &values)?;
        let (own, new) = (parameter_names(&text)?, parameter_names(&self.items)?);
        if let Some(name) = new.into_iter().find(|name| own.contains(name)) {
            return Err(ChangeError::There { name });
        }
        let mut composition = Composition::new(&text)?;
        let terms: Vec<&Term> = self.inputs.iter().collect();
        Term::add(&terms, &mut composition, None);
        composition.add_noted(&self.items, note)?;
        Ok(composition.text())
    }

    /// The changes under a fitted hypothesis.
    pub(super) fn of(bench: &Bench<'_>, fitted: &Fitted) -> Result<Self> {
        let members = || fitted.members.iter().map(|&member| bench.candidate(member));
        let beside = bench.stated_beside(&fitted.members);
        let signal_effects = members().chain(beside);
        let signal_effects = signal_effects.filter_map(|candidate| {
            let acts = match candidate.acts {
                Acts::Items | Acts::Parameter(_) => return None,
                Acts::Lag(_) => "lag",
                Acts::Delay(_) => "delay",
                Acts::Bias(_) => "bias",
                Acts::Scale(_) => "scale",
                Acts::Late(_) => "late",
                Acts::Slow(_) => "slow",
            };
            Some(SignalEffect {
                effect: candidate.name(),
                acts: acts.to_owned(),
                on: candidate.sites().concat(),
                output: None,
                measures: (candidate.acts.channel()).and_then(|channel| measured(bench, channel)),
            })
        });
        let shown = members().flat_map(|candidate| shown(bench, candidate));
        let parameters = 0..bench.effects.mechanism.parameters.len();
        let of_equations = Equations {
            effects: bench.effects,
            members: members().collect(),
            rig: &bench.set.parameters,
            values: &fitted.fit.values,
            deviations: parameters
                .map(|index| deviation(fitted, Unknown::Parameter(index)))
                .collect(),
        };
        let changes = Self::of_equations(&of_equations)?;
        let gains = changes.gains.into_iter().chain(scales(bench, fitted));
        Ok(Self {
            signal_effects: signal_effects.chain(shown).collect(),
            gains: gains.collect(),
            ..changes
        })
    }

    /// The changes of the equations under a hypothesis.
    pub(super) fn of_equations(of: &Equations<'_>) -> Result<Self> {
        Ok(Self {
            items: of.items()?,
            inputs: (of.candidates())
                .flat_map(|candidate| candidate.added.clone())
                .collect(),
            brought: of.brought(),
            parameters: of.parameters(),
            gains: of.gains(),
            signal_effects: Vec::new(),
        })
    }
}

/// The equations of a hypothesis, with its values.
pub(super) struct Equations<'e> {
    pub(super) effects: &'e EffectModel,
    pub(super) members: Vec<&'e Candidate>,
    /// The parameters stated by the data set.
    pub(super) rig: &'e [appell_recordings::Parameter],
    /// Values of all parameters in SI.
    pub(super) values: &'e [f64],
    /// Standard deviation of each parameter that was free, in SI.
    pub(super) deviations: Vec<Option<f64>>,
}

/// What a channel of a robot measures, as its file calls it.
fn measured(bench: &Bench<'_>, channel: usize) -> Option<String> {
    bench.set.robot.as_ref()?;
    let label = bench.set.channels[channel]
        .role
        .label(&bench.set.mechanism)?;
    Some(bench.set.named(&label.name).into_owned())
}

/// Channels that measure another quantity than the spec states.
fn shown(bench: &Bench<'_>, candidate: &Candidate) -> Vec<SignalEffect> {
    let measured = bench.set.measured(bench.effects.info());
    let mut shown = Vec::new();
    for (state, output) in &candidate.shows {
        let state = bench.effects.info().state_index(state).map(Measured::State);
        let channels = measured.iter().filter(|(_, own)| Some(*own) == state);
        shown.extend(channels.map(|(channel, _)| SignalEffect {
            effect: candidate.name(),
            acts: "shows".to_owned(),
            on: channel.column.clone(),
            output: Some(output.clone()),
            measures: None,
        }));
    }
    shown
}

/// Names of the parameters of a spec.
fn parameter_names(text: &str) -> Result<Vec<String>, EditError> {
    let document: DocumentMut =
        text.parse()
            .map_err(|e: toml_edit::TomlError| EditError::Syntax {
                message: e.message().to_owned(),
            })?;
    let parameters = document.get("parameters").and_then(Item::as_table_like);
    let names = parameters.into_iter().flat_map(|table| table.iter());
    Ok(names.map(|(name, _)| name.to_owned()).collect())
}

impl Equations<'_> {
    /// The members, and what the spec of the hypotheses has beside that of the user.
    fn candidates(&self) -> impl Iterator<Item = &Candidate> {
        let members = self.members.iter().copied();
        members.chain(&self.effects.in_spec)
    }

    /// The items of the members, with the fitted sizes and shapes, each with its standard deviation as tolerance.
    fn items(&self) -> Result<String> {
        let members: Vec<Candidate> = self.candidates().cloned().collect();
        let text = with_candidates("", &members).map_err(ModelError::from)?;
        let info = self.effects.info();
        let [mut values, mut deviations]: [Vec<(&str, f64)>; 2] = [Vec::new(), Vec::new()];
        for candidate in &members {
            for (index, part) in self.effects.own(candidate) {
                let parameter = &info.parameters[index];
                let own = &self.effects.mechanism.parameters[ParameterId::new(index)];
                let value = match part {
                    Part::Switch => 1.0,
                    Part::Size | Part::Shape(_) | Part::Term(_) => {
                        rounded(self.values[index], self.deviations[index], own)
                    }
                };
                values.push((&parameter.name, value));
                if let Some(std) = self.deviations[index].filter(|std| std.is_finite()) {
                    deviations.push((&parameter.name, to_digits(std, 2, &own.label.unit)));
                }
            }
        }
        let text = set_parameters(&text, &values).map_err(ModelError::from)?;
        Ok(set_deviations(&text, &deviations).map_err(ModelError::from)?)
    }

    /// Sizes and shapes of the members.
    fn brought(&self) -> Vec<Refitted> {
        let own = (self.candidates()).flat_map(|candidate| self.effects.own(candidate));
        own.filter(|(_, part)| *part != Part::Switch)
            .map(|(index, _)| {
                let label = &self.effects.mechanism.parameters[ParameterId::new(index)].label;
                let in_unit = |value: f64| label.unit.from_si(value);
                Refitted {
                    name: label.name.clone(),
                    stated: 0.0,
                    stated_std: None,
                    value: in_unit(self.values[index]),
                    std: self.deviations[index].map(in_unit),
                    unit: label.unit.text.clone(),
                }
            })
            .collect()
    }

    /// Gains that the spec of the hypotheses has as parameters.
    fn gains(&self) -> Vec<Refitted> {
        let candidates = self.effects.candidates.iter();
        let gain = |own: &Candidate| {
            let Acts::Parameter(index) = own.acts else {
                return None;
            };
            let is_member = self.members.iter().any(|member| member.acts == own.acts);
            let short = own.short(&self.effects.info().parameters[index].name);
            (own.has_tolerance && !is_member).then(|| Refitted {
                name: format!("{}.{short}", own.name()),
                stated: self.rig[index].value,
                stated_std: self.rig[index].std,
                value: self.values[index],
                std: self.deviations[index],
                unit: "1".to_owned(),
            })
        };
        candidates.filter_map(gain).collect()
    }

    /// Parameters of the mechanism that were free, or whose values on this rig differ from the spec.
    fn parameters(&self) -> Vec<Refitted> {
        let candidates = self.effects.candidates.iter();
        let candidates = candidates.chain(&self.effects.in_spec);
        let brought: Vec<&String> = candidates
            .flat_map(|candidate| candidate.parameters.iter().map(|(name, _)| name))
            .collect();
        let mut told = Vec::new();
        for (index, parameter) in self.effects.mechanism.parameters.iter().enumerate() {
            let rig = self.rig[index];
            let free = self.deviations[index];
            let as_in_spec = free.is_none() && rig.value.total_cmp(&parameter.value).is_eq();
            if as_in_spec || brought.contains(&&parameter.label.name) {
                continue;
            }
            let unit = &parameter.label.unit;
            let value = match free {
                Some(_) => rounded(self.values[index], free, parameter),
                None => rig.value,
            };
            told.push(Refitted {
                name: parameter.label.name.clone(),
                stated: unit.from_si(rig.value),
                stated_std: rig.std.map(|std| unit.from_si(std)),
                value: unit.from_si(value),
                std: free.map(|std| unit.from_si(std)),
                unit: unit.text.clone(),
            });
        }
        told
    }
}

/// Scales of channels with tolerances.
fn scales(bench: &Bench<'_>, fitted: &Fitted) -> Vec<Refitted> {
    let scale = |own: &Candidate| {
        let unknown = own.acts.in_error()?;
        let (Unknown::Scale(_), [stated, stated_std]) = (unknown, bench.wanted(unknown)?.prior?)
        else {
            return None;
        };
        let value = fitted.fit.values[fitted.layout.place(unknown).ok()?];
        Some(Refitted {
            name: format!("{}.scale", own.name()),
            stated,
            stated_std: Some(stated_std),
            value,
            std: deviation(fitted, unknown),
            unit: "1".to_owned(),
        })
    };
    let beside = bench.stated_beside(&fitted.members);
    beside.filter_map(scale).collect()
}

/// Standard deviation of a value in SI, the prior one at a limit; `None` if it was not free.
fn deviation(fitted: &Fitted, unknown: Unknown) -> Option<f64> {
    let mut free = fitted.fit.free.iter();
    let place = free.position(|free| free.unknown == unknown)?;
    let std = if fitted.fit.at_limit[place] {
        fitted.fit.free[place].prior?[1]
    } else {
        fitted.fit.deviation(place).ok()?
    };
    let value = fitted.fit.values[fitted.layout.place(unknown).ok()?];
    Some(std * fitted.fit.free[place].stretch(value))
}

/// A value in SI, rounded in its unit to so many digits after the first.
fn to_digits(value: f64, digits: usize, unit: &Unit) -> f64 {
    let text = format!("{:.digits$e}", unit.from_si(value));
    unit.read(&text).unwrap_or(value)
}

/// A value in SI, rounded to the significant digits in its unit and two more; within the limits.
fn rounded(value: f64, deviation: Option<f64>, parameter: &Parameter) -> f64 {
    /// Number of digits without a standard deviation.
    const DIGITS: usize = 6;
    let digits = deviation
        .map(|std| (value / std).abs())
        .filter(|ratio| ratio.is_finite() && *ratio > 0.0)
        .map_or(DIGITS, |ratio| {
            whole(ratio.log10().ceil().clamp(0.0, 12.0)) + 2
        });
    let number = to_digits(value, digits, &parameter.label.unit);
    let number = parameter.at_least.map_or(number, |limit| number.max(limit));
    parameter.at_most.map_or(number, |limit| number.min(limit))
}

#[cfg(test)]
mod tests {
    use appell_spec::expr::Span;
    use appell_spec::mechanism::Label;

    use super::*;

    #[test]
    fn a_rounded_value_stays_within_its_limits() {
        let parameter = Parameter {
            label: Label {
                name: "rate".to_owned(),
                about: String::new(),
                unit: units::parse("rad/s").expect("a unit"),
                line: 1,
                span: Span::default(),
            },
            value: 0.1,
            at_least: Some(0.053_232),
            at_most: Some(0.9994),
            std: None,
        };
        let rounded = |value| rounded(value, Some(0.05), &parameter);
        assert!((rounded(0.5) - 0.5).abs() < 1e-12);
        assert!(rounded(0.053_232) >= 0.053_232);
        assert!(rounded(0.9994) <= 0.9994);
    }
}
