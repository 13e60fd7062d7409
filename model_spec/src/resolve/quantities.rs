//! Parameters, coordinates, inputs, signals, pseudo-velocities, outputs and initial values.

use num_rational::BigRational;

use crate::ast::{ItemAst, Spanned};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Expr, Motion, Quantity, Span};
use crate::ids::{CoordinateId, InputId, ParameterId, SignalId};
use crate::language::Sense;
use crate::mechanism::{
    Coordinate, Input, Interpolation, Label, Mechanism, Output, Parameter, PseudoVelocity, Signal,
};
use crate::suggest::did_you_mean;
use crate::units::{Dimension, Unit};

use super::dimensions::{Dim, Typed};
use super::meaning::Meaning;
use super::place::Place;
use super::resolver::Resolver;

impl<'a> Resolver<'a> {
    /// Defines an item that carries its own unit.
    fn labelled(&mut self, item: &'a ItemAst, quantity: Quantity) -> Label {
        let unit = item.unit("unit").map(|u| u.value);
        self.define(
            &item.name,
            Meaning::Quantity(quantity),
            unit.map(|u| u.dimension),
        );
        self.label(item, unit)
    }

    /// A number in SI; reports one beyond double precision.
    fn in_si(&mut self, unit: &Unit, number: &Spanned<&BigRational>) -> f64 {
        let value = unit.to_si(number.value);
        if value.is_finite() {
            return value;
        }
        self.tell(
            Diagnostic::error(Code::NotFinite, "the number is beyond double precision")
                .at(number.span.clone(), ""),
        );
        0.0
    }

    fn number_under(&mut self, item: &ItemAst, key: &str, unit: &Unit) -> Option<f64> {
        let number = item.number(key)?;
        Some(self.in_si(unit, &number))
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter> {
        let ast = self.ast;
        let items = ast.items("parameters").iter().enumerate();
        items.map(|(id, item)| self.parameter(id, item)).collect()
    }

    fn parameter(&mut self, id: usize, item: &'a ItemAst) -> Parameter {
        let label = self.labelled(item, Quantity::Parameter(ParameterId::new(id)));
        let value = self.number_under(item, "value", &label.unit);
        let at_least = self.number_under(item, "at_least", &label.unit);
        let at_most = self.number_under(item, "at_most", &label.unit);
        if let (Some(low), Some(high)) = (at_least, at_most)
            && low > high
        {
            self.empty_range(&label.name, item.number("at_least").map(|n| n.span));
        } else if let (Some(value), Some(place)) = (value, item.number("value")) {
            let below = at_least.is_some_and(|low| value < low);
            let above = at_most.is_some_and(|high| value > high);
            if below || above {
                let limit = item.number(if below { "at_least" } else { "at_most" });
                let words = if below { "below" } else { "above" };
                self.outside(&label.name, words, place.span, limit.map(|l| l.span));
            }
        }
        let std = self.number_under(item, "std", &label.unit);
        if let (Some(std), Some(place)) = (std, item.number("std"))
            && std < 0.0
        {
            let message = "`std` is a standard deviation, which is not negative";
            self.tell(
                Diagnostic::error(Code::ValueOutsideLimits, message).at(place.span, "this value"),
            );
        }
        Parameter {
            label,
            value: value.unwrap_or(0.0),
            at_least,
            at_most,
            std,
        }
    }

    fn empty_range(&mut self, name: &str, span: Option<Span>) {
        self.tell(
            Diagnostic::error(Code::EmptyRange, format!("the range of `{name}` is empty"))
                .at(span.unwrap_or(0..0), "not below the upper end")
                .help("write the lower end first"),
        );
    }

    fn outside(&mut self, name: &str, side: &str, span: Span, limit: Option<Span>) {
        let mut diagnostic = Diagnostic::error(
            Code::ValueOutsideLimits,
            format!("the value of `{name}` is {side} its limit"),
        )
        .at(span, "this value");
        if let Some(limit) = limit {
            diagnostic = diagnostic.at(limit, "this limit");
        }
        self.tell(diagnostic);
    }

    pub(super) fn coordinates(&mut self) -> Vec<Coordinate> {
        let ast = self.ast;
        let items = ast.items("coordinates").iter().enumerate();
        items.map(|(id, item)| self.coordinate(id, item)).collect()
    }

    fn coordinate(&mut self, id: usize, item: &'a ItemAst) -> Coordinate {
        let label = self.labelled(item, Quantity::Coordinate(CoordinateId::new(id)));
        let mut range = None;
        if let Some([low, high]) = item.numbers("range") {
            let [low, high] = [low, high].map(|n| {
                let number = Spanned {
                    value: &n.value,
                    span: n.span.clone(),
                };
                self.in_si(&label.unit, &number)
            });
            if low < high {
                range = Some([low, high]);
            } else {
                self.empty_range(&label.name, item.entry("range").map(|e| e.span.clone()));
            }
        }
        // Checked against the range together with `[initial]`.
        Coordinate {
            label,
            range,
            initial: 0.0,
        }
    }

    pub(super) fn inputs(&mut self) -> Vec<Input> {
        let ast = self.ast;
        let items = ast.items("inputs").iter().enumerate();
        items
            .map(|(id, item)| Input {
                label: self.labelled(item, Quantity::Input(InputId::new(id))),
            })
            .collect()
    }

    pub(super) fn signals(&mut self) -> Vec<Signal> {
        let ast = self.ast;
        let items = ast.items("signals").iter().enumerate();
        items.map(|(id, item)| self.signal(id, item)).collect()
    }

    fn signal(&mut self, id: usize, item: &'a ItemAst) -> Signal {
        let label = self.labelled(item, Quantity::Signal(SignalId::new(id)));
        let interpolation = match item.word("interpolation") {
            Some(Sense::Interpolation(written)) => written,
            _ => Interpolation::Linear,
        };
        self.interpolation.push((interpolation, &item.name.value));
        let seconds = Unit::si(Dimension::TIME);
        let times = self.samples(item, "t", &seconds);
        let values = self.samples(item, "value", &label.unit);
        if let (Some(times), Some(values)) = (&times, &values) {
            self.table(item, times, values);
        }
        Signal {
            label,
            times: times.unwrap_or_default(),
            values: values.unwrap_or_default(),
            interpolation,
        }
    }

    fn samples(&mut self, item: &ItemAst, key: &str, unit: &Unit) -> Option<Vec<f64>> {
        let numbers = item.numbers(key)?;
        let values = numbers.iter().map(|n| {
            let number = Spanned {
                value: &n.value,
                span: n.span.clone(),
            };
            self.in_si(unit, &number)
        });
        Some(values.collect())
    }

    fn table(&mut self, item: &ItemAst, times: &[f64], values: &[f64]) {
        let name = &item.name.value;
        let place = |key| item.entry(key).map_or(0..0, |e| e.span.clone());
        let diagnostic = if times.is_empty() {
            Diagnostic::error(
                Code::SignalTable,
                format!("the signal `{name}` has no samples"),
            )
            .at(place("t"), "")
        } else if times.len() != values.len() {
            Diagnostic::error(
                Code::SignalTable,
                format!(
                    "the signal `{name}` has {} times and {} values",
                    times.len(),
                    values.len()
                ),
            )
            .at(place("value"), format!("{} values", values.len()))
            .at(place("t"), format!("{} times", times.len()))
        } else if let Some(i) = (1..times.len()).find(|i| times[*i] <= times[i - 1]) {
            let at = item
                .numbers("t")
                .and_then(|n| n.get(i))
                .map_or(0..0, |n| n.span.clone());
            Diagnostic::error(
                Code::SignalTable,
                format!("the times of the signal `{name}` do not increase"),
            )
            .at(at, "not later than the previous time")
        } else {
            return;
        };
        self.tell(diagnostic);
    }

    pub(super) fn pseudo_velocities(&mut self, coordinates: &[Coordinate]) -> Vec<PseudoVelocity> {
        let ast = self.ast;
        let mut speeds = Vec::new();
        for item in ast.items("pseudo_velocities") {
            let typed = self.value_of(item, &Place::SPEED);
            if let Some(typed) = &typed
                && typed.degree != Some(1)
                && typed.dim != Dim::Unknown
            {
                self.not_linear(
                    &Place::SPEED,
                    "no rate at all",
                    typed.span(),
                    "no `dot(q)` here",
                );
            }
            let (unit, definition) = self.checked_unit(item, typed, coordinates);
            // Later expressions may use it.
            if let Some(named) = self.names.get_mut(item.name.value.as_str())
                && matches!(
                    named.meaning,
                    Meaning::Quantity(Quantity::PseudoVelocity(_))
                )
            {
                named.dimension = unit.as_ref().map(|u| u.dimension);
            }
            speeds.push(PseudoVelocity {
                label: self.label(item, unit.as_ref()),
                definition,
                rate: None,
                initial: 0.0,
            });
        }
        speeds
    }

    /// Prescribed rates, which may contain all pseudo-velocities.
    pub(super) fn given_rates(&mut self, speeds: &mut [PseudoVelocity]) {
        let ast = self.ast;
        let place = Place::equation("the rate of a pseudo-velocity");
        for (item, speed) in ast.items("pseudo_velocities").iter().zip(speeds) {
            let Some(expression) = item.expression("rate") else {
                continue;
            };
            let typed = self.elaborate(expression, &place);
            if let (Dim::Known(found), Ok(wanted)) = (typed.dim, speed.label.unit.dimension.rate())
                && found != wanted
            {
                let message = format!(
                    "the rate of `{}` is {}, not {}",
                    speed.label.name,
                    crate::units::quantity_name(&wanted),
                    crate::units::quantity_name(&found),
                );
                let diagnostic = Diagnostic::error(Code::UnitMismatch, message);
                self.tell(diagnostic.at(typed.span(), "").help(format!(
                    "write an expression in {}",
                    crate::units::Unit::si(wanted).text
                )));
            }
            speed.rate = Some(typed.expr);
        }
    }

    pub(super) fn outputs(&mut self) -> Vec<Output> {
        let ast = self.ast;
        let mut outputs = Vec::new();
        for item in ast.items("outputs") {
            let typed = self.value_of(item, &Place::OUTPUT);
            let (unit, value) = self.checked_unit(item, typed, &[]);
            outputs.push(Output {
                label: self.label(item, unit.as_ref()),
                value,
            });
        }
        outputs
    }

    pub(super) fn value_of(&mut self, item: &ItemAst, place: &Place) -> Option<Typed> {
        item.expression("value").map(|e| self.elaborate(e, place))
    }

    /// The unit of a value: the stated one if it has the right dimension, otherwise the SI unit.
    pub(super) fn checked_unit(
        &mut self,
        item: &ItemAst,
        typed: Option<Typed>,
        coordinates: &[Coordinate],
    ) -> (Option<Unit>, Expr) {
        let typed = typed.unwrap_or_else(|| Typed::poisoned(item.name.span.clone()));
        let written = item.unit("unit");
        let Some(written) = written else {
            let refused = item.entry("unit").is_none() && !item.intact;
            let unit = typed
                .dim
                .known()
                .filter(|_| !refused)
                .map(|dimension| natural_unit(dimension, &typed.expr, coordinates));
            return (unit, typed.expr);
        };
        if let Dim::Known(found) = typed.dim
            && found != written.value.dimension
        {
            let wanted = written.value.dimension;
            let message = format!(
                "`{}` is declared as {}, its value is {}",
                item.name.value,
                crate::units::quantity_name(&wanted),
                crate::units::quantity_name(&found)
            );
            let help = format!(
                "write `unit = \"{}\"`",
                natural_unit(found, &typed.expr, coordinates).text
            );
            let finding = Diagnostic::error(Code::UnitMismatch, message);
            self.tell(
                finding
                    .at(written.span, super::dimensions::unit_words(wanted))
                    .at(typed.span(), super::dimensions::unit_words(found))
                    .help(help),
            );
        }
        (Some(written.value.clone()), typed.expr)
    }

    /// Initial values: from the items themselves, and from the section `[initial]`.
    pub(super) fn initial(&mut self, mechanism: &mut Mechanism) {
        let ast = self.ast;
        for item in ast.items("initial") {
            let name = item.name.value.as_str();
            let coordinates = mechanism.coordinates.iter().map(|c| c.label.name.as_str());
            let speeds = mechanism
                .pseudo_velocities
                .iter()
                .map(|s| s.label.name.as_str());
            let states: Vec<&str> = coordinates.chain(speeds).collect();
            if !states.contains(&name) {
                let span = &item.name.span;
                self.unknown("state", name, span, |_| {
                    let help = did_you_mean(name, states.iter().copied(), || {
                        format!("the states are {}", states.join(", "))
                    });
                    Diagnostic::error(
                        Code::UnknownReference,
                        format!("there is no coordinate or pseudo-velocity `{name}`"),
                    )
                    .at(span.clone(), "")
                    .help(help)
                });
            }
        }
        for (item, coordinate) in ast
            .items("coordinates")
            .iter()
            .zip(&mut mechanism.coordinates)
        {
            if let Some((value, span)) = self.initial_value(item, &coordinate.label.unit) {
                coordinate.initial = value;
                if let Some([low, high]) = coordinate.range
                    && !(low..=high).contains(&value)
                {
                    let side = if value < low { "below" } else { "above" };
                    let limit = item.entry("range").map(|e| e.span.clone());
                    self.outside(&coordinate.label.name, side, span, limit);
                }
            } else if coordinate
                .range
                .is_some_and(|[low, high]| low > 0.0 || high < 0.0)
            {
                self.start_outside(item);
            }
        }
        let items = ast.items("pseudo_velocities").iter();
        for (item, speed) in items.zip(&mut mechanism.pseudo_velocities) {
            if let Some((value, _)) = self.initial_value(item, &speed.label.unit) {
                speed.initial = value;
            }
        }
    }

    /// Reports a range that excludes the default initial value 0.
    fn start_outside(&mut self, item: &ItemAst) {
        let message = format!("`{}` would start at 0, outside its range", item.name.value);
        let help = "write `initial = …` with a value inside the range";
        let finding = Diagnostic::error(Code::ValueOutsideLimits, message);
        self.tell(
            finding
                .at(item.name.span.clone(), "has no initial value")
                .at(
                    item.entry("range").map_or(0..0, |e| e.span.clone()),
                    "this range",
                )
                .help(help),
        );
    }

    fn initial_value(&mut self, item: &ItemAst, unit: &Unit) -> Option<(f64, Span)> {
        let ast = self.ast;
        let listed = ast
            .items("initial")
            .iter()
            .find(|i| i.name.value == item.name.value)
            .and_then(|i| i.number("value"));
        let own = item.number("initial");
        if let (Some(own), Some(listed)) = (&own, &listed) {
            let message = format!("`{}` has two initial values", item.name.value);
            let finding = Diagnostic::error(Code::ConflictingKeys, message);
            self.tell(
                finding
                    .at(listed.span.clone(), "here")
                    .at(own.span.clone(), "and here")
                    .help("keep one of them"),
            );
        }
        let number = own.or(listed)?;
        Some((self.in_si(unit, &number), number.span))
    }
}

/// The SI unit of a dimension; rates of angles are written in `rad/s`.
fn natural_unit(dimension: Dimension, value: &Expr, coordinates: &[Coordinate]) -> Unit {
    let mut of_angles = false;
    value.visit(&mut |quantity| {
        if let Quantity::Rate(id) = quantity {
            of_angles |= coordinates
                .get(id.index())
                .is_some_and(|c| c.label.unit.is_angle());
        }
        of_angles |= matches!(quantity, Quantity::Motion(Motion::AngularVelocity(..)));
    });
    let mut unit = Unit::si(dimension);
    if of_angles && Dimension::NONE.rate() == Ok(dimension) {
        "rad/s".clone_into(&mut unit.text);
    }
    unit
}
