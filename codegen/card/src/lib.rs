//! Kernels on a graphics card: sources in CUDA C++ are compiled in the process (NVRTC), as `jit` compiles for the
//! processor. The libraries of the driver and of the compiler are loaded when a card is first asked for.

mod kernel;

use std::sync::Arc;

use cudarc::driver::sys::CUresult;
use cudarc::driver::{CudaContext, CudaStream, DriverError};
use cudarc::nvrtc::{CompileError, CompileOptions, compile_ptx_with_opts};

pub use kernel::{Argument, Kernel, Memory};

/// Why there is no card, or why it computes nothing.
#[derive(Debug, Clone, thiserror::Error)]
pub enum CardError {
    /// A library cannot be loaded.
    #[error(
        "there is no {what} (`{library}`): install {package}, or name its folder in `LD_LIBRARY_PATH`"
    )]
    Missing {
        /// What it is.
        what: &'static str,
        /// The name of its file.
        library: &'static str,
        /// The package that has it.
        package: &'static str,
    },
    /// Its memory is too small.
    #[error("the memory of the graphics card is too small")]
    Memory,
    /// The driver refuses.
    #[error("the graphics card cannot be used: {0}")]
    Driver(String),
    /// The compiler refuses a source.
    #[error("the equations cannot be compiled for the graphics card: {0}")]
    Compiler(String),
    /// More places than one call takes.
    #[error("a call of a kernel takes at most {most} places, not {places}")]
    TooMany {
        /// The requested ones.
        places: usize,
        /// The most.
        most: usize,
    },
}

impl From<DriverError> for CardError {
    fn from(error: DriverError) -> Self {
        if error.0 == CUresult::CUDA_ERROR_OUT_OF_MEMORY {
            return Self::Memory;
        }
        let name = error
            .error_string()
            .map(|text| text.to_string_lossy().into_owned());
        Self::Driver(name.unwrap_or_else(|_| format!("{error:?}")))
    }
}

impl From<CompileError> for CardError {
    fn from(error: CompileError) -> Self {
        match error {
            CompileError::CompileError { log, .. } => {
                Self::Compiler(log.to_string_lossy().trim().to_owned())
            }
            other => Self::Compiler(other.to_string()),
        }
    }
}

/// A graphics card.
#[derive(Debug, Clone)]
pub struct Card {
    context: Arc<CudaContext>,
    stream: Arc<CudaStream>,
}

impl Card {
    /// The first card of this machine.
    pub fn first() -> Result<Self, CardError> {
        kernel::libraries()?;
        let context = CudaContext::new(0)?;
        let stream = context.default_stream();
        Ok(Self { context, stream })
    }

    /// Its name.
    pub fn name(&self) -> Result<String, CardError> {
        Ok(self.context.name()?)
    }

    /// Numbers in its memory, zero at first; at least one.
    pub fn zeros(&self, count: usize) -> Result<Memory, CardError> {
        Ok(Memory(self.stream.alloc_zeros(count.max(1))?))
    }

    /// A copy of numbers in its memory.
    pub fn copy(&self, numbers: &[f64]) -> Result<Memory, CardError> {
        if numbers.is_empty() {
            return self.zeros(1);
        }
        Ok(Memory(self.stream.clone_htod(numbers)?))
    }

    /// Compiles a source; `names` are those of kernels in it.
    pub fn compile(&self, source: &str, names: &[&str]) -> Result<Vec<Kernel>, CardError> {
        let (major, minor) = self.context.compute_capability()?;
        let compile = |options| {
            compile_ptx_with_opts(
                source,
                CompileOptions {
                    options,
                    ..CompileOptions::default()
                },
            )
        };
        // A compiler older than the card does not know it; the driver translates what it writes for others.
        let ptx = compile(vec![format!("-arch=compute_{major}{minor}")]);
        let ptx = ptx.or_else(|_| compile(Vec::new()))?;
        let module = self.context.load_module(ptx)?;
        let kernels = names.iter().map(|name| {
            let function = module.load_function(name)?;
            Ok(Kernel::new(Arc::clone(&self.stream), function))
        });
        kernels.collect()
    }
}
