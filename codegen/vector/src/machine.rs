//! Vector code in executable memory.

// Machine code is reached by a pointer.
#![allow(unsafe_code)]

use appell_codegen::jit::{Checked, Elementary};
use appell_runtime::lanes::AtLanes;
use memmap2::{Mmap, MmapMut};

use super::VectorError;
use super::assemble::MachineCode;
use super::instruction_set::{AVX, AVX512, InstructionSet};
use super::registers::allocate;
use super::unroll::unrolled;

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

    fn set(self) -> Option<InstructionSet> {
        match self {
            Self::Avx512 => Some(AVX512),
            Self::Avx2 => Some(AVX),
            Self::Scalar => None,
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
pub(crate) struct Machine {
    entry: Entry,
    lanes: usize,
    /// Owner of the code.
    _memory: Mmap,
}

impl Machine {
    /// Compiles a tape; `None` if this processor lacks the instructions, or if the code would be too long.
    pub(crate) fn compile(
        checked: &Checked<'_>,
        target: Target,
    ) -> Result<Option<Self>, VectorError> {
        if !target.instructions.exist() {
            return Ok(None);
        }
        let Some(code) = machine_code(checked, target)? else {
            return Ok(None);
        };
        let mut memory = MmapMut::map_anon(code.bytes.len())?;
        memory.copy_from_slice(&code.bytes);
        let memory = memory.make_exec()?;
        let entry = memory.as_ptr().wrapping_add(code.entry);
        Ok(Some(Self {
            // SAFETY: the bytes are a function of this type, in the convention of the platform:
            // `Instructions::exist` holds for no other.
            entry: unsafe { std::mem::transmute::<*const u8, Entry>(entry) },
            lanes: code.lanes,
            _memory: memory,
        }))
    }

    /// Executes the code.
    ///
    /// # Safety
    ///
    /// Arguments and weights have the lengths that the tape was checked for, results those of
    /// the tape.
    #[inline]
    pub(crate) unsafe fn call<const N: usize>(
        &self,
        at: AtLanes<'_>,
        weights: &[[f64; 8]],
        results: [&mut [[f64; 8]]; N],
    ) {
        let mut starts = [std::ptr::null_mut::<f64>(); N];
        for (start, result) in starts.iter_mut().zip(results) {
            *start = result.as_mut_ptr().cast();
        }
        for first in (0..8).step_by(self.lanes) {
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

/// The machine code of a tape, also for instructions that this processor lacks. `None` without vector
/// instructions, or if the code would be too long.
///
/// The function has the calling convention of System V and receives six addresses: of time, states, inputs,
/// parameters and weights, which are arrays of blocks, and of a list of the addresses of the results.
pub fn machine_code(
    checked: &Checked<'_>,
    target: Target,
) -> Result<Option<MachineCode>, VectorError> {
    let Some(set) = target.instructions.set() else {
        return Ok(None);
    };
    let tape = unrolled(checked.tape());
    if tape.operations.len() > MOST_VALUES {
        return Ok(None);
    }
    let (assembler, slots) = allocate(&tape, set, target.elementary);
    if slots > MOST_SLOTS {
        return Ok(None);
    }
    Ok(Some(assembler.finish(slots)?))
}
