//! What can be asked for.

use crate::letters::Letters;
use crate::lock::Lock;
use crate::without::Without;

/// How a robot becomes a spec.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Which numbers become parameters.
    pub letters: Letters,
    /// What is left out.
    pub without: Vec<Without>,
    /// Joints that become rigid.
    pub lock: Vec<Lock>,
    /// Makes angles right that differ from a right angle by less than [`SNAP`](crate::SNAP).
    pub snap: bool,
    /// Lets the root of a URDF float; elsewhere the file says what does.
    pub floating: bool,
}
