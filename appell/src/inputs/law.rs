//! Expressions and feedback laws as operations in front of the equations of motion.

use appell_analysis::control::schedule::GainSchedule;
use appell_codegen::schedule::{Argument, Operation, ResultArray, Schedule, Step, Tree, Value};
use appell_codegen::symbolic::{Rational, Relation};
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
pub(super) fn schedule(
    function: &StateFunction,
    slots: &[Slot],
    scheduled: &[ScheduledLaw],
    info: &ModelInfo,
) -> Schedule {
    let mut schedule = function.schedule().clone();
    let values = schedule.results.swap_remove(0).entries;
    let mut writer = Writer(schedule);
    // Slots beyond the function's values are zero.
    let value = |place: usize| values.get(place).cloned().unwrap_or_else(|| number(0.0));
    let mut inputs: Vec<Tree> = (0..).map(input).take(info.input_len()).collect();
    for (place, slot) in slots.iter().enumerate() {
        if let Slot::Input(to) = slot {
            inputs[*to] = writer.binary(Operation::Add, inputs[*to].clone(), value(place));
        }
    }
    for (place, slot) in slots.iter().enumerate() {
        if let Slot::Desired(term) = slot
            && term.law.is_none()
        {
            let off = writer.binary(Operation::Subtract, state(term.state), value(place));
            let asked = writer.binary(Operation::Multiply, number(term.gain), off);
            inputs[term.input] =
                writer.binary(Operation::Subtract, inputs[term.input].clone(), asked);
        }
    }
    for (law, scheduled) in scheduled.iter().enumerate() {
        let mut y: Vec<Tree> = scheduled.states.iter().map(|&x| state(x)).collect();
        for (place, slot) in slots.iter().enumerate() {
            if let Slot::Beside(of, column) = *slot
                && of == law
            {
                y[column] = writer.binary(Operation::Subtract, y[column].clone(), value(place));
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

struct Writer(Schedule);

impl Writer {
    /// A new value.
    fn define(&mut self, tree: Tree) -> Tree {
        let place = self.0.names.len();
        // Laws have few values.
        let value = Value(u32::try_from(place).unwrap_or(u32::MAX));
        self.0.names.push(format!("law_{place}"));
        self.0.steps.push(Step::Let { value, tree });
        Tree::Value(value)
    }

    fn binary(&mut self, operation: Operation, a: Tree, b: Tree) -> Tree {
        self.define(Tree::Binary(operation, Box::new(a), Box::new(b)))
    }

    /// u₀ − K (y − y₀), with all three interpolated over the condition.
    fn add_scheduled(&mut self, law: &ScheduledLaw, y: &[Tree], inputs: &mut [Tree]) {
        let over = match law.over {
            SchedulingVariable::State(place) => state(place),
            SchedulingVariable::Parameter(place) => {
                Tree::Argument(Argument::Parameter(index(place)))
            }
        };
        let nodes: Vec<_> = law.schedule.laws().collect();
        let along = |of: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
            let all = nodes.iter().enumerate();
            all.map(|(node, (value, _))| (*value, of(node))).collect()
        };
        let mut off = Vec::new();
        for (column, y) in y.iter().enumerate() {
            let steady = self.interpolated(&over, &along(&|node| nodes[node].1.states[column]));
            off.push(self.binary(Operation::Subtract, y.clone(), steady));
        }
        for (row, &to) in law.inputs.iter().enumerate() {
            let offset = self.interpolated(&over, &along(&|node| nodes[node].1.inputs[row]));
            let mut asked = offset;
            for (column, off) in off.iter().enumerate() {
                let gain =
                    self.interpolated(&over, &along(&|node| nodes[node].1.gain[(row, column)]));
                let term = self.binary(Operation::Multiply, gain, off.clone());
                asked = self.binary(Operation::Subtract, asked, term);
            }
            inputs[to] = self.binary(Operation::Add, inputs[to].clone(), asked);
        }
    }

    /// The polygon through points, constant before the first and after the last.
    fn interpolated(&mut self, over: &Tree, points: &[(f64, f64)]) -> Tree {
        let Some(&(_, last)) = points.last() else {
            return number(0.0);
        };
        let mut tree = number(last);
        if points
            .iter()
            .all(|(_, value)| value.to_bits() == last.to_bits())
        {
            return tree;
        }
        for pair in points.windows(2).rev() {
            let [(from, low), (to, high)] = [pair[0], pair[1]];
            let since = self.binary(Operation::Subtract, over.clone(), number(from));
            let part = self.binary(Operation::Divide, since, number(to - from));
            let more = self.binary(Operation::Multiply, number(high - low), part);
            let inside = self.binary(Operation::Add, number(low), more);
            tree = self.before(over, to, inside, tree);
        }
        self.before(over, points[0].0, number(points[0].1), tree)
    }

    /// One value before a limit of the condition, another from there on.
    fn before(&mut self, over: &Tree, limit: f64, then: Tree, otherwise: Tree) -> Tree {
        self.define(Tree::Choice {
            relation: Relation::Less,
            compared: Box::new([over.clone(), number(limit)]),
            branches: Box::new([then, otherwise]),
        })
    }
}

fn state(place: usize) -> Tree {
    Tree::Argument(Argument::State(index(place)))
}

fn input(place: u32) -> Tree {
    Tree::Argument(Argument::Input(place))
}

/// Numbers of a law are finite.
fn number(value: f64) -> Tree {
    Tree::Constant(Rational::from_f64(value).unwrap_or(Rational::ZERO))
}

fn index(place: usize) -> u32 {
    u32::try_from(place).unwrap_or(u32::MAX)
}
