//! Vector code in executable memory.

use appell_runtime::lanes::AtLanes;
use cranelift_jit::{JITBuilder, JITModule};
use cranelift_module::{Module, ModuleError, default_libcall_names};

use super::super::JitError;
use super::super::check::Checked;
use super::super::elementary::Elementary;
use super::super::host::{self, Use};
use super::super::memory::Code;
use super::assemble::assemble;
use super::encode::Width;
use super::lower::lower;
use super::registers::allocate;

/// Most blocks of a frame: with eight lanes this is half a mebibyte.
const MOST_SLOTS: u32 = 8192;
/// Longer code is rejected.
const MOST_VALUES: usize = 1 << 20;

/// The vector instructions that code may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Instructions {
    /// Registers of eight numbers.
    Avx512,
    /// Registers of four numbers.
    Avx2,
    /// None: points are evaluated individually.
    Scalar,
}

impl Instructions {
    /// The widest of this processor.
    pub fn best() -> Self {
        let all = [Self::Avx512, Self::Avx2];
        let best = all.into_iter().find(|instructions| instructions.exist());
        best.unwrap_or(Self::Scalar)
    }

    /// Whether this processor has them and the platform uses the code's calling convention.
    pub fn exist(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(all(target_arch = "x86_64", unix))]
            Self::Avx512 => {
                std::is_x86_feature_detected!("avx512f")
                    && std::is_x86_feature_detected!("avx512dq")
            }
            #[cfg(all(target_arch = "x86_64", unix))]
            Self::Avx2 => std::is_x86_feature_detected!("avx2"),
            #[cfg(not(all(target_arch = "x86_64", unix)))]
            _ => false,
        }
    }
}

/// The target of vector code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Target {
    /// The instructions that it uses.
    pub instructions: Instructions,
    /// The elementary functions called by the code.
    pub elementary: Elementary,
}

impl Default for Target {
    /// The widest instructions of this processor, and the elementary functions of scalar code.
    fn default() -> Self {
        Self {
            instructions: Instructions::best(),
            elementary: Elementary::Standard,
        }
    }
}

/// Time, states, inputs, parameters, weights, addresses of the results.
type Entry = unsafe extern "C" fn(
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const f64,
    *const *mut f64,
);

/// One tape in vector code.
#[derive(Debug)]
pub(super) struct Machine {
    entry: Entry,
    width: Width,
    _code: Code,
}

impl Machine {
    /// Compiles a tape; `None` if this processor lacks the instructions, or if the code would be too long.
    pub(super) fn compile(checked: &Checked<'_>, target: Target) -> Result<Option<Self>, JitError> {
        let width = match target.instructions {
            _ if !target.instructions.exist() => return Ok(None),
            Instructions::Avx512 => Width::Zmm,
            Instructions::Avx2 => Width::Ymm,
            Instructions::Scalar => return Ok(None),
        };
        let line = lower(checked);
        if line.nodes.len() > MOST_VALUES {
            return Ok(None);
        }
        let allocated = allocate(&line, width.registers());
        if allocated.slots > MOST_SLOTS {
            return Ok(None);
        }
        let bytes = assemble(&allocated, width, target.elementary);
        let isa = host::target(0, Use::Lasting)?;
        let mut module = JITModule::new(JITBuilder::with_isa(isa, default_libcall_names()));
        let defined = define(&mut module, &bytes);
        // From here on the memory is freed, also on errors.
        let code = Code::new(module);
        let entry = defined?;
        Ok(Some(Self {
            // SAFETY: the bytes are a function of this type, in the convention of the platform:
            // `Instructions::exist` holds for no other.
            entry: unsafe { std::mem::transmute::<*const u8, Entry>(entry) },
            width,
            _code: code,
        }))
    }

    /// Executes the code.
    ///
    /// # Safety
    ///
    /// Arguments and weights have the lengths that the tape was checked for, results those of
    /// the tape.
    #[inline]
    pub(super) unsafe fn call<const N: usize>(
        &self,
        at: AtLanes<'_>,
        weights: &[[f64; 8]],
        results: [&mut [[f64; 8]]; N],
    ) {
        let mut starts = [std::ptr::null_mut::<f64>(); N];
        for (start, result) in starts.iter_mut().zip(results) {
            *start = result.as_mut_ptr().cast();
        }
        let lanes = self.width.lanes();
        for first in (0..8).step_by(lanes) {
            // The pointer of an empty array is never dereferenced.
            let part = |blocks: &[[f64; 8]]| blocks.as_ptr().cast::<f64>().wrapping_add(first);
            let mut results = starts;
            for result in &mut results {
                *result = result.wrapping_add(first);
            }
            // SAFETY: the check bounds every read by the lengths that the caller promises, and the
            // code writes each result from its start to its length. The references promise that
            // the memory is valid and that results overlap neither each other nor the arguments.
            // A part of a block ends where the block does. The code is alive while `self` is, and
            // the processor has its instructions.
            unsafe {
                (self.entry)(
                    at.t.as_ptr().wrapping_add(first),
                    part(at.x),
                    part(at.u),
                    part(at.p),
                    part(weights),
                    results.as_ptr(),
                );
            }
        }
    }
}

/// Makes the bytes executable and returns their address.
fn define(module: &mut JITModule, bytes: &[u8]) -> Result<*const u8, Box<ModuleError>> {
    let signature = module.make_signature();
    let id = module.declare_anonymous_function(&signature)?;
    module.define_function_bytes(id, 64, bytes, &[])?;
    module.finalize_definitions()?;
    Ok(module.get_finalized_function(id))
}
