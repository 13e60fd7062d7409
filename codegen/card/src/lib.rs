//! Kernels on a graphics card: sources in CUDA C++ are compiled in the process (NVRTC), as `jit` compiles for the
//! processor. The libraries of the driver and of the compiler are loaded when a card is first asked for.

mod compiler;
mod error;
mod kernel;

use std::sync::Arc;

use cudarc::driver::sys::CUdevice_attribute;
use cudarc::driver::{CudaContext, CudaStream};

pub use error::CardError;
pub use kernel::{Argument, Kernel, Memory};

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

    /// Whether it also shows a screen, and ends kernels that take longer than some seconds.
    pub fn has_time_limit(&self) -> Result<bool, CardError> {
        let limit = CUdevice_attribute::CU_DEVICE_ATTRIBUTE_KERNEL_EXEC_TIMEOUT;
        Ok(self.context.attribute(limit)? != 0)
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
        let copied = Memory(self.stream.clone_htod(numbers)?);
        self.stream.synchronize()?;
        Ok(copied)
    }

    /// Compiles a source; `names` are those of kernels in it.
    pub fn compile(&self, source: &str, names: &[&str]) -> Result<Vec<Kernel>, CardError> {
        let (major, minor) = self.context.compute_capability()?;
        let ptx = compiler::compiled(source, [major, minor])?;
        let module = self.context.load_module(ptx)?;
        let kernels = names.iter().map(|name| {
            let function = module.load_function(name)?;
            Ok(Kernel::new(Arc::clone(&self.stream), function))
        });
        kernels.collect()
    }
}
