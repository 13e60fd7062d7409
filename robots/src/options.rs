//! Options of the import.

use crate::letters::Letters;
use crate::lock::Lock;
use crate::without::Without;

/// Options of the conversion of a robot to a spec.
#[derive(Debug, Clone, Default)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "options that do not depend on each other"
)]
pub struct Options {
    /// Which numbers become parameters.
    pub letters: Letters,
    /// Properties that are left out.
    pub without: Vec<Without>,
    /// Joints that become rigid.
    pub lock: Vec<Lock>,
    /// Makes angles right that differ from a right angle by less than [`SNAP`](crate::SNAP).
    pub snap: bool,
    /// Gives the root of a URDF a free joint; an MJCF file declares free joints itself.
    pub floating: bool,
    /// Makes free joints of roots rigid.
    pub grounded: bool,
    /// Makes the actuators of an MJCF file inputs, with their laws as loads. Joints without an actuator then have no
    /// input; otherwise every joint has one, a torque or a force. Without effect on a URDF.
    pub actuators: bool,
}
