//! Programs compiled to machine code.

use std::ops::Range;
use std::sync::Arc;

use appell_runtime::model::At;

use super::host::Use;
use super::on_demand::OnDemand;
use super::{JitError, Sizes};
use crate::model::{Engine, ProgramModel, tape_of};
use crate::program::{FunctionKind, Program};
use crate::symbolic::Rational;
use crate::tape::Tape;

/// A model compiled in this process.
///
/// The rates are compiled immediately, every other function at its first use: most users need few of them, and
/// finding a short tape for all derivatives takes longer than compiling it. Concurrent calls of the same function
/// wait for its compilation. Functions that are too long to be compiled are interpreted with the same results;
/// [`Self::interpreted`] lists these.
///
/// [`Self::without`] specialises it for parameters that are zero.
pub type JitModel = ProgramModel<Jit>;

/// Calls machine code.
#[derive(Debug)]
pub struct Jit {
    sizes: Sizes,
    /// By [`FunctionKind`], in the order of its variants.
    parts: [OnDemand; FunctionKind::COUNT],
    /// The general model, if this one is specialised.
    whole: Option<Whole>,
}

/// The model without specialisation.
#[derive(Debug)]
struct Whole {
    model: Arc<JitModel>,
    /// The parameters that are zero in the specialised model.
    zeros: Vec<usize>,
    /// The same as ranges: every call compares all of them.
    ranges: Vec<Range<usize>>,
}

impl Whole {
    fn of(model: &Arc<JitModel>, mut zeros: Vec<usize>) -> Self {
        zeros.sort_unstable();
        let runs = zeros.chunk_by(|one, next| one + 1 == *next);
        let ranges = runs.map(|run| run[0]..run[0] + run.len()).collect();
        Self {
            model: model.clone(),
            zeros,
            ranges,
        }
    }

    fn is_needed(&self, p: &[f64]) -> bool {
        let others = |range: &Range<usize>| -> usize {
            let values = p[range.clone()].iter();
            // Without a branch for each parameter.
            values.map(|value| usize::from(*value != 0.0)).sum()
        };
        self.ranges.iter().any(|range| others(range) > 0)
    }

    /// The tape of a function of the specialised model.
    fn tape(&self, kind: FunctionKind) -> Tape {
        let Self { model, zeros, .. } = self;
        let is_zero = |index: usize| zeros.binary_search(&index).is_ok();
        let mut tape = model.engine.own(&model.program, kind).clone();
        let parameters = model.engine.sizes.parameters.max(1);
        let by_parameters = matches!(
            kind,
            FunctionKind::ParameterJacobian | FunctionKind::Adjoint | FunctionKind::OutputAdjoint
        );
        let zero = tape.constant(Rational::ZERO);
        let slopes = tape.results.iter_mut();
        for result in slopes.filter(|result| by_parameters && result.name == "p") {
            for (place, entry) in result.entries.iter_mut().enumerate() {
                if is_zero(place % parameters) {
                    *entry = zero;
                }
            }
        }
        tape.without(is_zero)
    }
}

impl ProgramModel<Jit> {
    /// Compiles the rates of a program and prepares its other functions.
    pub fn new(program: &Program) -> Result<Self, JitError> {
        let kind = FunctionKind::Rates;
        if program.function(kind).is_none() {
            return Err(JitError::MissingFunction { kind });
        }
        let engine = Jit {
            sizes: Sizes::from(&program.info),
            parts: [const { OnDemand::new(Use::Lasting) }; FunctionKind::COUNT],
            whole: None,
        };
        let model = Self::of(Arc::new(program.clone()), engine);
        // An unsupported processor is detected here and not during a simulation.
        let engine = &model.engine;
        engine.parts[kind as usize].compile(engine.own(program, kind), engine.sizes)?;
        Ok(model)
    }

    /// The same model, specialised for zero parameters. Derivatives with respect to these are omitted and read as
    /// zero. If one of them is not zero, the general model is evaluated.
    #[must_use]
    pub fn without(self: &Arc<Self>, zeros: &[usize]) -> Self {
        let engine = Jit {
            sizes: self.engine.sizes,
            parts: [const { OnDemand::new(Use::Brief) }; FunctionKind::COUNT],
            whole: Some(Whole::of(self, zeros.to_vec())),
        };
        Self::of(self.program.clone(), engine)
    }

    /// Compiles all functions now instead of at their first use.
    pub fn compile_all(&self) {
        for kind in FunctionKind::ALL {
            let tape = || self.engine.own(&self.program, kind);
            self.engine.parts[kind as usize].ready(tape, self.engine.sizes);
        }
    }

    /// The functions used so far that are interpreted, with the reason.
    pub fn interpreted(&self) -> impl Iterator<Item = (FunctionKind, &JitError)> {
        FunctionKind::ALL
            .into_iter()
            .zip(&self.engine.parts)
            .filter_map(|(kind, part)| Some((kind, part.reason()?)))
    }
}

impl Jit {
    /// The tape of the specialised model, if it is one.
    fn own(&self, program: &Program, kind: FunctionKind) -> &Tape {
        self.parts[kind as usize].tape(|| match &self.whole {
            Some(whole) => whole.tape(kind),
            None => tape_of(program, kind),
        })
    }

    /// The engine to be used at given parameters.
    fn at(&self, p: &[f64]) -> &Self {
        match &self.whole {
            Some(whole) if whole.is_needed(p) => &whole.model.engine,
            _ => self,
        }
    }
}

impl Engine for Jit {
    #[inline]
    fn call<const N: usize>(
        &self,
        program: &Program,
        kind: FunctionKind,
        at: At<'_>,
        own: &[f64],
        out: [&mut [f64]; N],
    ) {
        let engine = self.at(at.p);
        let tape = || engine.own(program, kind);
        engine.parts[kind as usize]
            .ready(tape, engine.sizes)
            .call(at, own, out);
    }

    fn tape(&self, program: &Program, kind: FunctionKind, p: &[f64]) -> &Tape {
        self.at(p).own(program, kind)
    }
}
