//! The spec that `appell new` writes.

use crate::name::{self, RULE};
use crate::suggest::shown;

/// Why a name was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is not a valid name: {RULE}")]
pub struct NameError {
    /// The name.
    pub name: String,
}

/// A commented spec to start from; it loads without findings.
pub fn starter(name: &str) -> Result<String, NameError> {
    if name::is_valid(name) {
        Ok(include_str!("starter.toml").replace("NAME", name))
    } else {
        Err(NameError { name: shown(name) })
    }
}
