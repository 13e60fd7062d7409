//! Expressions given at run time, evaluated with the names of a mechanism.

use std::sync::Arc;

use appell_codegen::jit::{NativeFunction, Sizes};
use appell_codegen::mechanics::symbols::{Symbols, ids};
use appell_codegen::program::{Arguments, Array, Function, FunctionKind, Layout, Program};
use appell_codegen::schedule::{pi, schedule};
use appell_codegen::symbolic::{Derivatives, Expr, Graph};
use appell_codegen::tape::{Tape, enclose_along, interpret};
use appell_runtime::Signal;
use appell_runtime::model::{Along, At, ModelInfo, Quantity};
use appell_runtime::real::{Enclosure, Real};
use appell_runtime::signal::{SignalError, differentiated, enclosed};
use appell_spec::Mechanism;
use appell_spec::expr::Expr as SpecExpr;

/// An expression graph with the symbols of a mechanism.
#[derive(Clone)]
pub(crate) struct Workbench {
    /// The graph.
    pub(crate) graph: Graph,
    /// The symbols.
    pub(crate) symbols: Symbols,
}

impl Workbench {
    /// The symbols of a mechanism.
    pub(crate) fn new(mechanism: &Mechanism) -> Self {
        let mut graph = Graph::new();
        let mut symbols = Symbols::new(&mut graph, mechanism);
        // The floating-point value, exactly.
        symbols.pi = graph.number(pi());
        Self { graph, symbols }
    }

    /// Lowers an expression of the spec language; `None` if it divides by zero.
    pub(crate) fn lower(&mut self, expr: &SpecExpr) -> Option<Expr> {
        self.symbols.lower(&mut self.graph, expr).ok()
    }

    /// The rate of a function of time and signals.
    pub(crate) fn rate(&mut self, expr: Expr) -> Expr {
        let time = (self.symbols.time, Graph::ONE);
        let signals = self.symbols.signals.iter();
        let signals = signals.flat_map(|&[value, first, second]| [(value, first), (first, second)]);
        let variables: Vec<(Expr, Expr)> = std::iter::once(time).chain(signals).collect();
        let mut rate = Graph::ZERO;
        for (variable, by_time) in variables {
            let symbol = ids(&self.graph, &[variable])[0];
            let slope = Derivatives::with_respect_to(symbol).of(&mut self.graph, expr);
            let part = self.graph.mul(slope, by_time);
            rate = self.graph.add(rate, part);
        }
        rate
    }

    /// Values of expressions in the parameters.
    pub(crate) fn constants(&self, exprs: &[Expr], parameters: &[f64]) -> Vec<f64> {
        let mut values = vec![f64::NAN; self.graph.len()];
        for (symbol, &value) in ids(&self.graph, &self.symbols.parameters)
            .iter()
            .zip(parameters)
        {
            values[symbol.0 as usize] = value;
        }
        appell_codegen::symbolic::evaluate(&self.graph, &values, exprs)
    }

    /// The expressions as a function of time, state and parameters.
    pub(crate) fn function(
        self,
        model: &ModelInfo,
        exprs: Vec<Expr>,
    ) -> Result<StateFunction, SignalError> {
        let Self { graph, symbols } = self;
        let signals = model
            .signals
            .iter()
            .map(Signal::new)
            .collect::<Result<Vec<_>, _>>()?;
        let mut info = model.clone();
        // The inputs of this function: those of the model, of which it must not use the declared ones, and
        // all signals.
        let of_signals = model.signals.iter().map(|signal| Quantity {
            name: signal.name.clone(),
            ..Quantity::new("", "", "")
        });
        info.inputs = model.inputs.iter().cloned().chain(of_signals).collect();
        let mut input_symbols = symbols.inputs.clone();
        let derivatives = model.signal_inputs.iter();
        input_symbols.extend(
            derivatives.map(|&(signal, order)| symbols.signals[signal][usize::from(order)]),
        );
        input_symbols.extend(symbols.signals.iter().map(|orders| orders[0]));
        let arguments = Arguments {
            time: ids(&graph, &[symbols.time])[0],
            states: ids(
                &graph,
                &[symbols.speeds.as_slice(), &symbols.coordinates].concat(),
            ),
            inputs: ids(&graph, &input_symbols),
            parameters: ids(&graph, &symbols.parameters),
            pi: graph.as_symbol(symbols.pi),
        };
        let count = exprs.len();
        let layout = Layout::List(count);
        let results = vec![Array::new("values", "Values.", layout, exprs)];
        let function = Function::new(FunctionKind::Outputs, results);
        let function = function.over(Arc::new(graph), Vec::new());
        let sizes = Sizes::from(&info);
        let program = Program {
            info,
            file: String::new(),
            arguments,
            dependent: Vec::new(),
            systems: Vec::new(),
            hints: Arc::default(),
            functions: vec![function],
        };
        let tape = schedule(&program, &program.functions[0]);
        // The interpreter gives the same results.
        let native = NativeFunction::compile(&tape, sizes).ok();
        Ok(StateFunction {
            tape,
            native,
            count,
            declared: model.declared_inputs,
            derivatives: model.signal_inputs.to_vec(),
            signals,
        })
    }
}

/// Up to this many inputs and signals are evaluated without allocation.
const FEW_INPUTS: usize = 16;

/// Expressions as one function of time, state and parameters.
pub(crate) struct StateFunction {
    tape: Tape,
    native: Option<NativeFunction>,
    count: usize,
    declared: usize,
    /// Signals and the orders of their derivatives that are inputs of the model.
    derivatives: Vec<(usize, u8)>,
    signals: Vec<Signal>,
}

impl StateFunction {
    /// Its operations. Their inputs are the declared ones, then those of [`Self::fill_signals`].
    pub(crate) fn tape(&self) -> &Tape {
        &self.tape
    }

    /// How many values it has.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// How many declared inputs there are.
    pub(crate) fn declared(&self) -> usize {
        self.declared
    }

    /// How many inputs its operations have.
    pub(crate) fn inputs(&self) -> usize {
        self.declared + self.derivatives.len() + self.signals.len()
    }

    /// Whether there are inputs after the declared ones.
    pub(crate) fn has_signals(&self) -> bool {
        self.inputs() > self.declared
    }

    /// The inputs after the declared ones at `t` in s.
    pub(crate) fn fill_signals(&self, t: f64, u: &mut [f64]) {
        for (u, (signal, order)) in u.iter_mut().zip(self.tabulated()) {
            *u = signal.derivative(t, order);
        }
    }

    /// The signals and orders of their derivatives that are inputs.
    fn tabulated(&self) -> impl Iterator<Item = (&Signal, u8)> {
        let derivatives = self.derivatives.iter();
        let derivatives = derivatives.map(|&(signal, order)| (&self.signals[signal], order));
        derivatives.chain(self.signals.iter().map(|signal| (signal, 0)))
    }

    /// Bounds along a segment of a motion, written to the first entries of `values`; independent of the inputs of the
    /// segment.
    pub(crate) fn bounds(&self, along: &Along<'_>, values: &mut [Enclosure]) {
        let since = along.t - Enclosure::constant(along.start);
        let mut u = vec![Enclosure::UNKNOWN; self.declared];
        u.extend(self.tabulated().map(|(signal, order)| {
            enclosed(differentiated(signal.polynomial(along.start), order), since)
        }));
        enclose_along(&self.tape, &Along { u: &u, ..*along }, values);
    }

    /// Evaluates at time `t`, state `x` and parameters `p` into the first entries of `values`.
    pub(crate) fn values(&self, t: f64, x: &[f64], p: &[f64], values: &mut [f64]) {
        let values = &mut values[..self.count];
        if values.is_empty() {
            return;
        }
        let mut few = [0.0; FEW_INPUTS];
        let mut many = Vec::new();
        let u = if let Some(few) = few.get_mut(..self.inputs()) {
            few
        } else {
            many.resize(self.inputs(), 0.0);
            &mut many[..]
        };
        self.fill_signals(t, &mut u[self.declared..]);
        let u = &*u;
        match &self.native {
            Some(native) => native.call(At { t, x, u, p }, [values]),
            None => values.copy_from_slice(&interpret(&self.tape, t, x, u, p)[0]),
        }
    }
}
