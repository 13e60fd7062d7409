//! Units and dimensions.

/// A unit as written, with its dimension and its size in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// As written in the spec, e.g. `kg*m^2`.
    pub text: String,
    /// One of this unit in SI: 1 for SI units, π/180 for `deg`.
    pub scale: f64,
}
