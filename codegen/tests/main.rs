//! Integration tests of the derivation and its outputs.

mod build_script;
mod c_code;
mod emit_support;
#[cfg(feature = "jit")]
mod jit_support;
mod symbolic_random;

mod audit;
mod emit;
mod emit_golden;
mod findings;
mod fmu;
mod fuzz_derivation;
mod hostile;
mod inverse_angles;
#[cfg(feature = "jit")]
mod jit;
#[cfg(feature = "jit")]
mod jit_model;
#[cfg(feature = "jit")]
mod jit_random;
#[cfg(feature = "jit")]
mod jit_safety;
mod joints;
#[cfg(feature = "cache")]
mod kept;
mod on_demand;
#[cfg(feature = "jit")]
mod responses;
mod schedule;
#[cfg(feature = "jit")]
mod smooth;
mod switches;
mod symbolic_forms;
mod symbolic_identity;
mod symbolic_laws;
mod symbolic_print;
mod torsional_spring;
