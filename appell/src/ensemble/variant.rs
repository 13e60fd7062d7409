//! A spec with a law, set up once for all its cases.

use std::path::Path;
use std::sync::Arc;

use appell_ensemble::limits::MAX_HELD;
use appell_ensemble::study::{Entry, Text};
use appell_spec::expr::Expr;
use appell_spec::{Code, Scope};

use super::factors::{self, Target};
use super::noise::Noise;
use super::reading::Reading;
use super::spec::{Extended, Quantity};
use crate::formula::{StateFunction, Workbench};
use crate::inputs::closed_loop::{ClosedLoop, Onto};
use crate::inputs::controller::{Plan, Wiring};
use crate::inputs::feedback;
use crate::setup::Setup;
use crate::{Error, Model};

/// A spec under a law.
pub(super) struct Variant {
    pub(super) model: Arc<Model>,
    pub(super) wiring: Wiring,
    /// The equations of motion under the wiring.
    pub(super) closed: ClosedLoop,
    pub(super) parameters: Vec<f64>,
    /// Limits of the parameters.
    pub(super) limits: Vec<[f64; 2]>,
    pub(super) initial: Vec<f64>,
    /// Parameters that follow from others, in their order.
    pub(super) set: Vec<(usize, StateFunction)>,
    /// Initial values that follow from parameters.
    pub(super) start: Vec<(usize, StateFunction)>,
    /// Target of each factor.
    pub(super) targets: Vec<Target>,
    pub(super) noises: Vec<Noise>,
    pub(super) kept: Arc<Vec<Quantity>>,
}

/// The setup of a spec with the nominal values of a study.
pub(super) fn nominal<'m>(
    reading: &mut Reading<'_>,
    model: &'m Model,
) -> Result<(Setup<'m>, Derived), Error> {
    let mut setup = model.setup()?;
    setup.watch_ranges = false;
    let study = reading.study;
    let mut derived = Derived::default();
    for Entry { name, value } in &study.motion.set {
        let Some(index) = reading.known(name, &setup, "parameter", &setup.info.parameters) else {
            continue;
        };
        if study.vary.iter().any(|vary| vary.name.text == name.text) {
            let message = format!("`{}` is set here and varies", name.text);
            reading.tell(Code::ConflictingKeys, message, name, "remove one of them");
            continue;
        }
        let unit = setup.unit_of_parameter(index);
        let expr = reading.expr(&setup, value, "the value", Scope::Constant, unit);
        if let Some(expr) = expr {
            setup.parameters[index] = setup.constant(&expr).unwrap_or(f64::NAN);
            derived.set.push((index, expr, value.clone()));
        }
    }
    for Entry { name, value } in &study.motion.initial {
        let Some(index) = reading.known(name, &setup, "state", &setup.info.states) else {
            continue;
        };
        let unit = setup.unit_of_state(index);
        let expr = reading.expr(&setup, value, "the initial value", Scope::Constant, unit);
        if let Some(expr) = expr {
            setup.initial[index] = setup.constant(&expr).unwrap_or(f64::NAN);
            derived.start.push((index, expr, value.clone()));
        }
    }
    Ok((setup, derived))
}

/// A value that follows from parameters, and its position in the study or its file.
type Following = (usize, Expr, Text);

/// Values that follow from parameters.
#[derive(Default)]
pub(super) struct Derived {
    set: Vec<Following>,
    start: Vec<Following>,
}

/// A spec with the law of a choice, if there is one; nothing if the study is invalid, which is reported.
pub(super) fn variant(
    reading: &mut Reading<'_>,
    extended: &Extended,
    law: Option<&Text>,
    folder: &Path,
    targets: &[Target],
) -> Result<Option<Variant>, Error> {
    let model = &extended.model;
    let (mut setup, derived) = nominal(reading, model)?;
    let study = reading.study;
    let mut plan = Plan::new(&setup);
    let mut start = Vec::new();
    for file in study.motion.feedback.iter().chain(law) {
        let Some(path) = reading.file(folder, file) else {
            continue;
        };
        let law = feedback::read(&path, &setup)?;
        let started = law.start(&mut setup);
        reading.at(file, started)?;
        let initial = law.initial.iter();
        start.extend(initial.map(|(state, expr)| (*state, expr.clone(), file.clone())));
        reading.at(file, plan.feedback(law))?;
    }
    // Values of the study override those of laws.
    for (index, expr, _) in &derived.start {
        setup.initial[*index] = setup.constant(expr).unwrap_or(f64::NAN);
    }
    start.extend(derived.start);
    for Entry { name, value } in &study.motion.input {
        let Some(index) = reading.known(name, &setup, "input", setup.declared_inputs()) else {
            continue;
        };
        let unit = setup.unit_of_input(index);
        let expr = reading.expr(&setup, value, "the input", Scope::Law, unit);
        if let Some(expr) = expr {
            reading.at(value, plan.input(index, &expr, &setup))?;
        }
    }
    let noises = noises(reading, &setup);
    if !reading.findings.is_empty() {
        return Ok(None);
    }
    let set = compile(reading, &setup, derived.set)?;
    let start = compile(reading, &setup, start)?;
    let parameters = 0..setup.mechanism.parameters.len();
    let limits = parameters.map(|index| setup.limits_of_parameter(index));
    let inputs = study.motion.input.iter().map(|input| &input.value);
    let driving = study.motion.feedback.iter().chain(law).chain(inputs);
    let wiring = match driving.last() {
        Some(driving) => {
            let wiring = plan.wiring(&setup, study.motion.t_end);
            reading.at(driving, wiring)?
        }
        None => Some(plan.wiring(&setup, study.motion.t_end)?),
    };
    let Some(wiring) = wiring.filter(|_| reading.findings.is_empty()) else {
        return Ok(None);
    };
    let seen: Vec<Onto> = noises.iter().map(|noise| noise.onto).collect();
    Ok(Some(Variant {
        model: Arc::clone(model),
        limits: limits.collect(),
        closed: wiring.closed_loop(model.rates()?, setup.info, &seen)?,
        wiring,
        set,
        start,
        parameters: setup.parameters.clone(),
        initial: setup.initial.clone(),
        targets: targets.to_vec(),
        noises,
        kept: Arc::clone(&extended.kept),
    }))
}

/// The noise of a study on measurements of laws, and on parameters.
fn noises(reading: &mut Reading<'_>, setup: &Setup<'_>) -> Vec<Noise> {
    let study = reading.study;
    let (mut noises, mut held) = (Vec::new(), 0.0);
    for noise in &study.noise {
        held += study.motion.t_end / noise.every.value;
        if held > MAX_HELD {
            let message = format!("a motion would have more than {MAX_HELD} values of noise");
            let help = "write a longer `every_s`, or a shorter motion";
            reading.tell(Code::LimitExceeded, message, &noise.every, help);
            break;
        }
        let target = factors::named(setup, &noise.name.text);
        let (onto, unit) = match target {
            Some(Target::State(index)) => (Onto::Measured(index), setup.unit_of_state(index)),
            Some(Target::Parameter(index)) if noise.unit.is_some() => {
                (Onto::Parameter(index), setup.unit_of_parameter(index))
            }
            _ => {
                let message = format!("there is no state `{}`", noise.name.text);
                let help = "noise is on a state that laws measure, or a quantity of the study's own with its `unit`";
                reading.tell(Code::UnknownName, message, &noise.name, help);
                continue;
            }
        };
        if let Some(deviation) = reading.constant(setup, &noise.deviation, unit) {
            reading.not_negative(&noise.deviation, deviation);
            noises.push(Noise::new(
                study.seed,
                &noise.name.text,
                onto,
                deviation,
                noise.every.value,
            ));
        }
    }
    noises
}

/// Values that follow from parameters as functions of them.
fn compile(
    reading: &mut Reading<'_>,
    setup: &Setup<'_>,
    following: Vec<Following>,
) -> Result<Vec<(usize, StateFunction)>, Error> {
    let mut functions = Vec::new();
    for (index, expr, at) in following {
        let mut bench = Workbench::new(&setup.mechanism);
        let Some(lowered) = bench.lower(&expr) else {
            let message = "the expression divides by the number zero";
            reading.tell(Code::DivisionByZero, message, &at, "");
            continue;
        };
        functions.push((index, bench.function(setup.info, vec![lowered])?));
    }
    Ok(functions)
}
