//! Names of the file and of its numbers in the spec.

/// How the names of a robot file and its numbers are called in the spec.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Dictionary {
    /// Numbers that are parameters, chosen by [`Letters::Matching`](crate::Letters::Matching).
    pub entries: Vec<Entry>,
    /// Actuators that are inputs ([`Options::actuators`](crate::Options)), in the order of the file.
    pub actuators: Vec<ActuatorName>,
    /// Joints with an axis, in the order of the tree.
    pub joints: Vec<JointName>,
    /// Bodies of the file, in its order.
    pub bodies: Vec<BodyName>,
    /// The acceleration of gravity, x, y and z.
    pub gravity: [f64; 3],
}

impl Dictionary {
    /// The name in the spec of a number `ELEMENT.ATTRIBUTE`, a joint, its velocity `JOINT.velocity`, or an actuator.
    pub fn in_spec(&self, name: &str) -> Option<&str> {
        let number = || {
            let mut entries = self.entries.iter().filter(|one| !one.parameter.is_empty());
            let is_it = |one: &&Entry| {
                let rest = name.strip_prefix(one.element.as_str());
                rest.and_then(|rest| rest.strip_prefix('.')) == Some(one.attribute)
            };
            entries.find(is_it).map(|one| one.parameter.as_str())
        };
        let joint = || {
            let mut joints = self.joints.iter();
            joints.find_map(|joint| match name.strip_prefix(joint.name.as_str())? {
                "" => Some(joint.coordinate.as_str()),
                ".velocity" => Some(&joint.velocity),
                _ => None,
            })
        };
        let actuator = || {
            let mut actuators = self.actuators.iter();
            let actuator = actuators.find(|one| one.name == name);
            actuator.map(|one| one.input.as_str())
        };
        number().or_else(joint).or_else(actuator)
    }
}

/// A number of the file that is a parameter of the spec.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// The element that has it: a body, a joint, an actuator, or `option`. Of bodies that are fixed to each other, the one
    /// with the joint.
    pub element: String,
    /// Its attribute: `mass`, `com.x`, `com.y`, `com.z`, `inertia`, `damping`, `armature`, `frictionloss`, `stiffness`,
    /// `springref`, `ref`, `kp`, `kv`, `gear`, `gain`, `bias`, `forcerange`, `timeconst`, `delay`, `gravity` (`gravity.x`
    /// … where it has several components).
    pub attribute: &'static str,
    /// The parameter of the spec; empty for `timeconst` and `delay`, which are not in the spec.
    pub parameter: String,
    /// Its value in SI as the file has it, together with what is fixed to the body, or with what actuators add to the
    /// armature and the damping of a joint. Of gravity, the magnitude of a component.
    pub value: f64,
    /// Whether the parameter is a factor of what the file has, 1 at first.
    pub relative: bool,
}

/// An actuator that is an input of the spec.
#[derive(Debug, Clone, PartialEq)]
pub struct ActuatorName {
    /// Its name in the file, or a name made from its joint or tendon.
    pub name: String,
    /// The input: its command (`ctrl`).
    pub input: String,
    /// The load: its force, after gear and limits.
    pub load: String,
    /// Its joint, unless it drives a tendon.
    pub joint: Option<String>,
    /// Time constant of its filter in s, 0 without one. The filter is not in the spec: its force follows the input at once.
    pub lag: f64,
    /// Delay of its command in s. It is not in the spec either.
    pub delay: f64,
    /// Whether its command is a position or a velocity, in the unit of its joint.
    pub is_servo: bool,
    /// Its transmission ratio.
    pub gear: f64,
    /// What multiplies its command, before the gear; without the part that depends on the motion.
    pub gain: f64,
    /// Its constant force before the gear.
    pub bias: f64,
    /// Whether its force depends on the motion of what it drives.
    pub follows_motion: bool,
}

/// A joint with an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct JointName {
    /// Its name in the file.
    pub name: String,
    /// Its coordinate.
    pub coordinate: String,
    /// Its rate: a pseudo-velocity, or `dot(COORDINATE)` if it depends on others.
    pub velocity: String,
    /// The output of the spec that is the torque or force of all actuators on it; `None` without actuators.
    pub torque: Option<String>,
}

/// A body of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyName {
    /// Its name in the file.
    pub name: String,
    /// The body of the spec of which it is a part; `ground` if it does not move.
    pub body: String,
    /// Rotation matrix from the axes of that body to its own in the file; those of the ground are the same.
    pub axes: [[f64; 3]; 3],
}
