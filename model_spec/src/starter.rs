//! The spec that `appell new` writes.

use crate::limits::MAX_NAME;

/// Why a name was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is not a valid name: a letter, then letters, digits and `_`, at most {MAX_NAME}")]
pub struct NameError {
    /// The name.
    pub name: String,
}

/// A commented spec to start from; it loads without findings.
pub fn starter(name: &str) -> Result<String, NameError> {
    let mut bytes = name.bytes();
    let valid = bytes.next().is_some_and(|b| b.is_ascii_alphabetic())
        && bytes.all(|b| b.is_ascii_alphanumeric() || b == b'_')
        && name.len() <= MAX_NAME;
    if valid {
        Ok(include_str!("starter.toml").replace("NAME", name))
    } else {
        Err(NameError {
            name: name.escape_debug().take(80).collect(),
        })
    }
}
