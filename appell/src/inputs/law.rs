//! Expressions and feedback laws as operations in front of the equations of motion.

use appell_analysis::control::schedule::GainSchedule;
use appell_codegen::symbolic::{Rational, Relation};
use appell_codegen::tape::{Argument, Arithmetic, Operation, ResultArray, Tape, Value};
use appell_runtime::model::ModelInfo;

use super::feedback::SchedulingVariable;
use crate::formula::StateFunction;

/// Meaning of a value of the function.
pub(super) enum Slot {
    /// A term of an input.
    Input(usize),
    /// The desired value of a state.
    Desired(Term),
    /// Desired deviation from the steady motions of a scheduled law: index of the law, index of the state.
    Beside(usize, usize),
    /// A desired coordinate or its derivative: index of the law, index of the coordinate, order.
    Followed(usize, usize, usize),
}

/// Proportional feedback of the deviation of one state to one input.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term {
    pub(super) input: usize,
    pub(super) state: usize,
    pub(super) gain: f64,
    /// The sampled law to which it belongs.
    pub(super) law: Option<usize>,
}

/// A gain-scheduled law.
pub(super) struct ScheduledLaw {
    pub(super) over: SchedulingVariable,
    pub(super) schedule: GainSchedule,
    pub(super) inputs: Vec<usize>,
    pub(super) states: Vec<usize>,
}

/// The inputs of a model, in its order: external inputs plus expressions minus feedback.
pub(super) fn tape(
    function: &StateFunction,
    slots: &[Slot],
    scheduled: &[ScheduledLaw],
    info: &ModelInfo,
) -> Tape {
    let mut tape = function.tape().clone();
    let mut values = tape.results.swap_remove(0).entries;
    let mut writer = Writer(tape);
    // Slots beyond the function's values are zero.
    let zero = writer.number(0.0);
    values.resize(slots.len().max(values.len()), zero);
    let external = (0..).map(Argument::Input).take(info.input_len());
    let mut inputs: Vec<Value> = external.map(|input| writer.0.argument(input)).collect();
    for (slot, &value) in slots.iter().zip(&values) {
        if let Slot::Input(to) = slot {
            inputs[*to] = writer.binary(Arithmetic::Add, inputs[*to], value);
        }
    }
    for (slot, &value) in slots.iter().zip(&values) {
        if let Slot::Desired(term) = slot
            && term.law.is_none()
        {
            let (state, gain) = (writer.state(term.state), writer.number(term.gain));
            let off = writer.binary(Arithmetic::Subtract, state, value);
            let asked = writer.binary(Arithmetic::Multiply, gain, off);
            inputs[term.input] = writer.binary(Arithmetic::Subtract, inputs[term.input], asked);
        }
    }
    for (law, scheduled) in scheduled.iter().enumerate() {
        let states = scheduled.states.iter();
        let mut y: Vec<Value> = states.map(|&state| writer.state(state)).collect();
        for (slot, &value) in slots.iter().zip(&values) {
            if let Slot::Beside(of, column) = *slot
                && of == law
            {
                y[column] = writer.binary(Arithmetic::Subtract, y[column], value);
            }
        }
        writer.add_scheduled(scheduled, &y, &mut inputs);
    }
    writer.0.results = vec![ResultArray {
        name: "inputs".to_owned(),
        entries: inputs,
    }];
    writer.0
}

struct Writer(Tape);

impl Writer {
    fn binary(&mut self, operation: Arithmetic, a: Value, b: Value) -> Value {
        self.0.binary(operation, a, b)
    }

    fn state(&mut self, place: usize) -> Value {
        self.0.argument(Argument::State(index(place)))
    }

    /// Numbers of a law are finite.
    fn number(&mut self, value: f64) -> Value {
        self.0
            .constant(Rational::from_f64(value).unwrap_or(Rational::ZERO))
    }

    /// u₀ − K (y − y₀), with all three interpolated over the condition.
    fn add_scheduled(&mut self, law: &ScheduledLaw, y: &[Value], inputs: &mut [Value]) {
        let over = match law.over {
            SchedulingVariable::State(place) => self.state(place),
            SchedulingVariable::Parameter(place) => {
                self.0.argument(Argument::Parameter(index(place)))
            }
        };
        let nodes: Vec<_> = law.schedule.laws().collect();
        let along = |of: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            let all = nodes.iter().enumerate();
            all.map(|(node, (value, _))| (*value, of(node))).collect()
        };
        let mut off = Vec::new();
        for (column, &y) in y.iter().enumerate() {
            let steady = self.interpolated(over, &along(&|node| nodes[node].1.states[column]));
            off.push(self.binary(Arithmetic::Subtract, y, steady));
        }
        for (row, &to) in law.inputs.iter().enumerate() {
            let offset = self.interpolated(over, &along(&|node| nodes[node].1.inputs[row]));
            let mut asked = offset;
            for (column, &off) in off.iter().enumerate() {
                let gain =
                    self.interpolated(over, &along(&|node| nodes[node].1.gain[(row, column)]));
                let term = self.binary(Arithmetic::Multiply, gain, off);
                asked = self.binary(Arithmetic::Subtract, asked, term);
            }
            inputs[to] = self.binary(Arithmetic::Add, inputs[to], asked);
        }
    }

    /// The polygon through points, constant before the first and after the last.
    fn interpolated(&mut self, over: Value, points: &[(f64, f64)]) -> Value {
        let Some(&(_, last)) = points.last() else {
            return self.number(0.0);
        };
        let mut polygon = self.number(last);
        if points
            .iter()
            .all(|(_, value)| value.to_bits() == last.to_bits())
        {
            return polygon;
        }
        for pair in points.windows(2).rev() {
            let [(from, low), (to, high)] = [pair[0], pair[1]];
            let [start, length, rise, first] =
                [from, to - from, high - low, low].map(|number| self.number(number));
            let since = self.binary(Arithmetic::Subtract, over, start);
            let part = self.binary(Arithmetic::Divide, since, length);
            let more = self.binary(Arithmetic::Multiply, rise, part);
            let inside = self.binary(Arithmetic::Add, first, more);
            polygon = self.before(over, to, [inside, polygon]);
        }
        let (start, first) = points[0];
        let first = self.number(first);
        self.before(over, start, [first, polygon])
    }

    /// One value before a limit of the condition, another from there on.
    fn before(&mut self, over: Value, limit: f64, branches: [Value; 2]) -> Value {
        let limit = self.number(limit);
        self.0.push(Operation::Choice {
            relation: Relation::Less,
            compared: [over, limit],
            branches,
        })
    }
}

fn index(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(u32::MAX)
}
