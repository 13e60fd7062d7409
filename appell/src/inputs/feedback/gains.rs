//! Laws with constant gains, in continuous and in discrete time.

use appell_analysis::control::sampled::Sampling;
use appell_codegen::tape::{Arithmetic, Tape, Value};
use appell_runtime::model::Along;
use appell_runtime::real::{Enclosure, Real};
use appell_spec::expr::Expr;
use appell_spec::{Code, Scope};
use toml::de::DeTable;

use super::reading::Reader;
use super::schedule;
use crate::inputs::law::{self, Law, Moment, Stage};

/// Feedback of the deviations of states from their desired values.
#[derive(Debug)]
struct Gains {
    desired: Vec<Expr>,
    /// Those with a desired value first.
    terms: Vec<Term>,
    sampled: Option<Sampled>,
}

/// Proportional feedback of the deviation of one state to one input.
#[derive(Debug, Clone, Copy)]
struct Term {
    input: usize,
    state: usize,
    gain: f64,
    /// Place of the desired value; zero if there is none.
    desired: Option<usize>,
}

/// A discrete-time controller.
#[derive(Debug)]
struct Sampled {
    sampling: Sampling,
    inputs: Vec<usize>,
    /// A row for each input: gains of the pending inputs, those of the oldest measurement first.
    pending_gains: Vec<Vec<f64>>,
}

impl Gains {
    fn new(
        inputs: &[usize],
        states: Vec<(usize, Option<Expr>)>,
        gains: &[Vec<f64>],
        sampled: Option<Sampled>,
    ) -> Self {
        let mut desired = Vec::new();
        let states = states.into_iter().map(|(state, expr)| {
            let place = expr.is_some().then_some(desired.len());
            desired.extend(expr);
            (state, place)
        });
        let states: Vec<_> = states.collect();
        let rows = inputs.iter().zip(gains);
        let terms = rows.flat_map(|(&input, gains)| {
            let columns = states.iter().zip(gains);
            columns.map(move |(&(state, desired), &gain)| Term {
                input,
                state,
                gain,
                desired,
            })
        });
        let mut terms: Vec<Term> = terms.collect();
        terms.sort_by_key(|term| term.desired.is_none());
        Self {
            desired,
            terms,
            sampled,
        }
    }

    /// Subtracts the feedback from the inputs.
    fn subtract(&self, at: &Moment<'_>, u: &mut [f64]) {
        for term in &self.terms {
            let desired = term.desired.map_or(0.0, |place| at.desired[place]);
            u[term.input] -= term.gain * (at.x[term.state] - desired);
        }
    }
}

impl Law for Gains {
    fn desired(&self) -> Vec<&Expr> {
        self.desired.iter().collect()
    }

    fn stage(&self) -> Stage {
        match self.sampled {
            None => Stage::Gains,
            Some(_) => Stage::Sampled,
        }
    }

    fn sampling(&self) -> Option<Sampling> {
        self.sampled.as_ref().map(|sampled| sampled.sampling)
    }

    fn add(&self, at: &Moment<'_>, u: &mut [f64]) {
        let (Some(sampled), Some(sampler)) = (&self.sampled, at.sampler) else {
            return self.subtract(at, u);
        };
        let acting = sampler.acting(at.t, |pending| {
            let mut asked = vec![0.0; u.len()];
            self.subtract(at, &mut asked);
            sampled.asked(&asked, &pending.concat())
        });
        for (&input, acting) in sampled.inputs.iter().zip(acting.iter().flatten()) {
            u[input] += *acting;
        }
    }

    fn write(&self, desired: &[Value], tape: &mut Tape, inputs: &mut [Value]) {
        let zero = law::number(tape, 0.0);
        for term in &self.terms {
            let desired = term.desired.map_or(zero, |place| desired[place]);
            let (state, gain) = (law::state(tape, term.state), law::number(tape, term.gain));
            let off = tape.binary(Arithmetic::Subtract, state, desired);
            let asked = tape.binary(Arithmetic::Multiply, gain, off);
            inputs[term.input] = tape.binary(Arithmetic::Subtract, inputs[term.input], asked);
        }
    }

    fn bounds(&self, desired: &[Enclosure], along: &Along<'_>, u: &mut [Enclosure]) {
        if self.sampled.is_some() {
            return u.fill(Enclosure::UNKNOWN);
        }
        for term in &self.terms {
            let zero = Enclosure::constant(0.0);
            let desired = term.desired.map_or(zero, |place| desired[place]);
            u[term.input] += Enclosure::constant(-term.gain) * (along.x[term.state] - desired);
        }
    }
}

impl Sampled {
    /// The inputs after a measurement, from the feedback of the states and the pending inputs, the oldest
    /// first. Initially fewer inputs are pending than there are gains.
    fn asked(&self, feedback: &[f64], pending: &[f64]) -> Vec<f64> {
        let rows = self.inputs.iter().zip(&self.pending_gains);
        rows.map(|(&input, gains)| {
            let terms = gains.iter().rev().zip(pending.iter().rev());
            feedback[input] - terms.map(|(gain, pending)| gain * pending).sum::<f64>()
        })
        .collect()
    }
}

const KEYS: &[&str] = &[
    "about",
    "at",
    "mechanism",
    "input",
    "inputs",
    "law",
    "offset",
    "over",
    "states",
    "gains",
    "sampled_ms",
    "delay_ms",
    "pending_gains",
    "switching_times_s",
    "desired",
    "initial",
];

/// Offsets of inputs, and the law of their feedback.
type OffsetLaw = (Vec<(usize, Expr)>, Box<dyn Law>);

/// A law `u = offset - K (y - y_desired)`; invalid entries are reported.
pub(super) fn read(reader: &mut Reader<'_>, table: &DeTable<'_>) -> Option<OffsetLaw> {
    keys(reader, table);
    let inputs = reader.inputs(table);
    let states = reader.list(table, "states", Reader::state);
    let desired = reader.by_state(table, "desired", Scope::Schedule, "the desired value");
    for (state, _, at) in &desired {
        if states
            .as_ref()
            .is_some_and(|states| !states.contains(state))
        {
            let message = "a desired value for a state without a gain";
            let help = "add the state to `states`, with its gain";
            reader.tell(Code::UnknownReference, message, at.clone(), help);
        }
    }
    let is_scheduled = table.get("over").is_some() || table.get("at").is_some();
    let gains = reader.gains(table, "gains");
    let sampling = reader.sampling(table);
    let pending_gains = reader.gains(table, "pending_gains");
    let (inputs, states) = inputs.zip(states)?;
    let offsets = reader.offsets(table, &inputs);
    if let Some(gains) = &gains {
        reader.count_gains(table, "gains", gains, inputs.len(), states.len());
    }
    let sampled = sampling.map(|sampling| {
        let pending = sampling.pending() * inputs.len();
        if let Some(gains) = &pending_gains {
            reader.count_gains(table, "pending_gains", gains, inputs.len(), pending);
        }
        Sampled {
            sampling,
            inputs: inputs.clone(),
            pending_gains: pending_gains.unwrap_or(vec![vec![0.0; pending]; inputs.len()]),
        }
    });
    let desired_value = |state: usize| {
        let found = desired.iter().find(|(other, ..)| *other == state);
        (state, found.map(|(_, expr, _)| expr.clone()))
    };
    if is_scheduled {
        let law = schedule::read(reader, table, inputs, states, desired_value)?;
        return Some((offsets, Box::new(law)));
    }
    let states = states.into_iter().map(desired_value).collect();
    let law = Gains::new(&inputs, states, &gains?, sampled);
    Some((offsets, Box::new(law)))
}

/// Reports unknown and missing keys, and a law for another mechanism.
fn keys(reader: &mut Reader<'_>, table: &DeTable<'_>) {
    reader.known_keys(table, KEYS);
    let needs = "a law needs `input` or `inputs`, `states`, and `gains` or a schedule";
    let replaced = |key: &str| match key {
        "input" => table.get("inputs").is_some(),
        "gains" => table.get("over").is_some() || table.get("at").is_some(),
        _ => false,
    };
    for key in ["input", "states", "gains"] {
        if table.get(key).is_none() && !replaced(key) {
            reader.missing(key, needs);
        }
    }
    reader.right_mechanism(table);
}
