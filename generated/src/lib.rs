//! Mechanisms shipped with appell, generated from their specs in `mechanisms/`.
//!
//! One module per spec holds the equations as functions of named quantities, generic over the
//! scalar, and a type that implements [`appell_runtime::model::Model`]. [`ALL`] lists them. To add
//! a mechanism, add its spec.

use appell_runtime::model::Model;

/// A shipped mechanism.
pub struct Shipped {
    /// Name, that of its module and of its spec.
    pub name: &'static str,
    /// Its spec as messages call it.
    pub file: &'static str,
    /// Text of its spec.
    pub spec: &'static str,
    /// Text of its module, as it was compiled.
    pub code: &'static str,
    /// Its equations.
    pub model: &'static dyn Model,
    /// Each emitted function with its operations.
    pub costs: &'static [(&'static str, &'static str)],
}

impl Shipped {
    /// The mechanism of a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        ALL.iter().find(|shipped| shipped.name == name)
    }
}

impl std::fmt::Debug for Shipped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Shipped")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

include!(concat!(env!("OUT_DIR"), "/registry.rs"));
