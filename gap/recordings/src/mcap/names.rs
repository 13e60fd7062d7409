//! The names of a number in a message: the path that leads to it, `topic.position[2]`, and the same path with the names
//! of joints for numbers in lists, `topic.position[elbow]`.

use std::fmt::Write as _;

/// Fields with the names of what the lists of a message are of: joints of `sensor_msgs/JointState`, of trajectories and
/// commands of `control_msgs`.
pub(super) const NAMES: [&str; 5] = [
    "name",
    "names",
    "joint_names",
    "dof_names",
    "interface_names",
];
/// Longest name of a joint.
pub(super) const LONGEST: usize = 256;

/// Takes a name and its number.
pub(super) type Tell<'t> = &'t mut dyn FnMut(&str, f64);

/// Both paths to a place in a message.
pub(super) struct Names<'t> {
    paths: [String; 2],
    tell: Tell<'t>,
}

impl<'t> Names<'t> {
    /// Those of a whole message.
    pub(super) fn of(topic: &str, tell: Tell<'t>) -> Self {
        let paths = [topic.to_owned(), topic.to_owned()];
        Self { paths, tell }
    }

    /// Goes on to a field of the message here.
    pub(super) fn field(&mut self, name: &str) {
        for path in &mut self.paths {
            path.push('.');
            path.push_str(name);
        }
    }

    /// Goes on to an element of the list of `count` here, with the name of its joint where there are as many.
    pub(super) fn element(&mut self, index: usize, count: usize, joints: &[String]) {
        let [path, named] = &mut self.paths;
        // Writing to a string cannot fail.
        let _ = write!(path, "[{index}]");
        let _ = match joints.get(index).filter(|_| joints.len() == count) {
            Some(joint) => write!(named, "[{joint}]"),
            None => write!(named, "[{index}]"),
        };
    }

    /// This place, to come back to.
    pub(super) fn place(&self) -> [usize; 2] {
        self.paths.each_ref().map(String::len)
    }

    /// Comes back to a place on the way here.
    pub(super) fn back(&mut self, place: [usize; 2]) {
        for (path, length) in self.paths.iter_mut().zip(place) {
            path.truncate(length);
        }
    }

    /// Tells the number here.
    pub(super) fn tell(&mut self, value: f64) {
        let [path, named] = &self.paths;
        (self.tell)(path, value);
        if named != path {
            (self.tell)(named, value);
        }
    }
}
