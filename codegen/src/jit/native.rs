//! Compiled functions and their lifetime.

use appell_runtime::model::At;
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{Module, ModuleError, default_libcall_names};

use super::JitError;
use super::check::{Sizes, check};
use super::elementary::Elementary;
use super::host::{self, Use};
use super::memory::Code;
use super::translate::{signature, translate};
use crate::tape::{Tape, interpret_into};

/// `t`, states, inputs, parameters, weights, addresses of the results.
type Entry =
    unsafe extern "C" fn(f64, *const f64, *const f64, *const f64, *const f64, *const *mut f64);

/// One tape in machine code, or interpreted. The code lives as long as this value; several threads may call it
/// at the same time.
#[derive(Debug)]
pub struct NativeFunction {
    how: How,
    sizes: Sizes,
    /// The number of weights used.
    weights: usize,
    /// Lengths of the results.
    results: Vec<usize>,
}

#[derive(Debug)]
enum How {
    Native { entry: Entry, _code: Code },
    Interpreted(Tape),
}

impl NativeFunction {
    /// Compiles a tape of a model with arguments of these sizes. It calls the elementary functions
    /// of the standard library.
    pub fn compile(tape: &Tape, sizes: Sizes) -> Result<Self, JitError> {
        Self::compile_with(tape, sizes, Elementary::Standard)
    }

    /// [`Self::compile`] with the given elementary functions.
    pub fn compile_with(
        tape: &Tape,
        sizes: Sizes,
        elementary: Elementary,
    ) -> Result<Self, JitError> {
        Self::compile_for(tape, sizes, elementary, Use::Lasting)
    }

    pub(super) fn compile_for(
        tape: &Tape,
        sizes: Sizes,
        elementary: Elementary,
        of: Use,
    ) -> Result<Self, JitError> {
        let checked = check(tape, sizes)?;
        let target = host::target(checked.operations, of)?;
        let builder = JITBuilder::with_isa(target, default_libcall_names());
        let mut module = JITModule::new(builder);
        let config = module.target_config();
        let mut context = module.make_context();
        context.func.signature = signature(config);
        translate(&checked, elementary, config, &mut context.func);
        let defined = define(&mut module, &mut context);
        // From here on the memory is freed, also on errors.
        let code = Code::new(module);
        let entry = defined?;
        Ok(Self {
            how: How::Native {
                // SAFETY: the code was compiled with `signature`, which is that of `Entry`.
                entry: unsafe { std::mem::transmute::<*const u8, Entry>(entry) },
                _code: code,
            },
            sizes,
            weights: checked.weights,
            results: tape.lengths(),
        })
    }

    /// A function that is interpreted, as one that cannot be compiled.
    pub fn interpreted(tape: &Tape, sizes: Sizes) -> Self {
        Self {
            how: How::Interpreted(tape.clone()),
            sizes,
            weights: 0,
            results: tape.lengths(),
        }
    }

    /// Evaluates the function: one slice for each result of the tape, in its order.
    ///
    /// # Panics
    ///
    /// If the length of a slice differs from the tape's results or from the sizes it was compiled for; no
    /// code is executed then.
    #[inline]
    pub fn call<const N: usize>(&self, at: At<'_>, results: [&mut [f64]; N]) {
        self.call_weighted(at, &[], results);
    }

    /// [`Self::call`] for an adjoint with its weights.
    ///
    /// # Panics
    ///
    /// As [`Self::call`], and if there are fewer weights than the tape uses.
    #[inline]
    pub fn call_weighted<const N: usize>(
        &self,
        at: At<'_>,
        weights: &[f64],
        mut results: [&mut [f64]; N],
    ) {
        check_lengths(at, self.sizes, &results, &self.results);
        check_weights(weights, self.weights);
        let entry = match &self.how {
            How::Native { entry, .. } => entry,
            How::Interpreted(tape) => return interpret_into(tape, at, weights, &mut results),
        };
        let results = results.map(<[f64]>::as_mut_ptr);
        // SAFETY: the tape's check bounds every read by `sizes` and by the weights that it
        // counted, and the translation writes
        // each result from its start to its length; both were compared above. The references promise that the
        // memory is valid and that results overlap neither each other nor the arguments. The code
        // is alive while `self` is.
        unsafe {
            entry(
                at.t,
                at.x.as_ptr(),
                at.u.as_ptr(),
                at.p.as_ptr(),
                weights.as_ptr(),
                results.as_ptr(),
            );
        }
    }
}

/// Panics if slices have other lengths than the function requires.
#[inline]
fn check_lengths(at: At<'_>, sizes: Sizes, out: &[&mut [f64]], results: &[usize]) {
    let found = Sizes {
        states: at.x.len(),
        inputs: at.u.len(),
        parameters: at.p.len(),
    };
    assert!(
        found == sizes,
        "arguments: {found:?} given, {sizes:?} expected"
    );
    assert!(
        out.iter()
            .map(|result| result.len())
            .eq(results.iter().copied()),
        "results: lengths {results:?} expected"
    );
}

/// Panics if there are fewer weights than a function uses.
#[inline]
fn check_weights(weights: &[f64], used: usize) {
    assert!(
        weights.len() >= used,
        "weights: {} given, {used} used",
        weights.len()
    );
}

/// Makes the function executable and returns its address.
fn define(
    module: &mut JITModule,
    context: &mut cranelift_codegen::Context,
) -> Result<*const u8, Box<ModuleError>> {
    let id = module.declare_anonymous_function(&context.func.signature)?;
    module.define_function(id, context)?;
    module.finalize_definitions()?;
    Ok(module.get_finalized_function(id))
}
