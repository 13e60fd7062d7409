//! Programs compiled to machine code.

use std::sync::Arc;

use appell_runtime::model::At;

use super::host::Use;
use super::on_demand::OnDemand;
use super::{JitError, Sizes};
use crate::model::{Engine, ProgramModel};
use crate::program::FunctionKind;
use crate::symbolic::Rational;
use crate::tape::Tape;
use crate::tapes::Tapes;

/// A model compiled in this process.
///
/// The rates are compiled immediately, every other function is derived and compiled at its first use: most users need
/// few of them, and finding a short tape for all derivatives takes longer than compiling it. Concurrent calls of the same function
/// wait for its compilation. Functions that are too long to be compiled are interpreted with the same results.
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
    /// For each parameter, whether it is zero in the specialised model: all bits set. Every call compares all of them.
    zeros: Vec<u64>,
}

impl Whole {
    fn of(model: &Arc<JitModel>, zeros: &[usize]) -> Self {
        let mut masks = vec![0; model.engine.sizes.parameters];
        for &parameter in zeros {
            masks[parameter] = u64::MAX;
        }
        Self {
            model: model.clone(),
            zeros: masks,
        }
    }

    fn is_needed(&self, p: &[f64]) -> bool {
        // Without a branch for each parameter; the sign of a zero is shifted out.
        let others = p.iter().zip(&self.zeros);
        others.fold(0, |bits, (value, zero)| bits | value.to_bits() << 1 & zero) != 0
    }

    /// The tape of a function of the specialised model.
    fn tape(&self, kind: FunctionKind, tape: &Tape) -> Tape {
        let is_zero = |index: usize| self.zeros[index] != 0;
        let mut tape = tape.clone();
        let parameters = self.model.engine.sizes.parameters.max(1);
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
    /// Compiles the rates of a program or a derivation and prepares its other functions.
    pub fn new(functions: impl Into<Tapes>) -> Result<Self, JitError> {
        Self::over(Arc::new(functions.into()))
    }

    /// The same with functions that others use as well.
    pub fn over(tapes: Arc<Tapes>) -> Result<Self, JitError> {
        let kind = FunctionKind::Rates;
        let engine = Jit {
            sizes: Sizes::from(tapes.info()),
            parts: [const { OnDemand::new(Use::Lasting) }; FunctionKind::COUNT],
            whole: None,
        };
        // An unsupported processor is detected here and not during a simulation.
        let rates = tapes.get(kind).ok_or(JitError::MissingFunction { kind })?;
        engine.parts[kind as usize].compile(rates, engine.sizes)?;
        Ok(Self::of(tapes, engine))
    }

    /// The same model, specialised for zero parameters. Derivatives with respect to these are omitted and read as
    /// zero. If one of them is not zero, the general model is evaluated.
    #[must_use]
    pub fn without(self: &Arc<Self>, zeros: &[usize]) -> Self {
        let engine = Jit {
            sizes: self.engine.sizes,
            parts: [const { OnDemand::new(Use::Brief) }; FunctionKind::COUNT],
            whole: Some(Whole::of(self, zeros)),
        };
        Self::of(self.tapes.clone(), engine)
    }
}

impl Jit {
    /// The engine to be used at given parameters.
    fn at(&self, p: &[f64]) -> &Self {
        match &self.whole {
            Some(whole) if whole.is_needed(p) => &whole.model.engine,
            _ => self,
        }
    }

    /// The tape of the specialised model, if it is one.
    fn own<'t>(&'t self, kind: FunctionKind, tape: &'t Tape) -> &'t Tape {
        match &self.whole {
            Some(whole) => self.parts[kind as usize].tape(|| whole.tape(kind, tape)),
            None => tape,
        }
    }
}

impl Engine for Jit {
    #[inline]
    fn call<const N: usize>(
        &self,
        kind: FunctionKind,
        tape: &Tape,
        at: At<'_>,
        own: &[f64],
        out: [&mut [f64]; N],
    ) {
        let engine = self.at(at.p);
        engine.parts[kind as usize]
            .ready(|| engine.own(kind, tape), engine.sizes)
            .call_weighted(at, own, out);
    }

    fn tape<'t>(&'t self, kind: FunctionKind, tape: &'t Tape, p: &[f64]) -> &'t Tape {
        self.at(p).own(kind, tape)
    }
}
