//! The same recordings for another spec of the same mechanism, by names.

use appell_estimate::smoothing::angle::unwrap;
use appell_spec::Mechanism;

use crate::{Channel, DataError, DataSet, Measured, Part, Role, Spec, noise};

impl DataSet {
    /// Recordings bound to another spec. A quantity keeps its name; a column that the first spec
    /// does not know is bound if the other one has a quantity of its name and dimension. Quantities
    /// that the other one lacks are only recorded.
    pub fn rebound(&self, spec: &Spec) -> Result<Self, DataError> {
        let mechanism = appell_spec::load(&spec.file, &spec.text)?.mechanism;
        let mut set = self.bound_to(&mechanism);
        set.spec = spec.clone();
        for (index, channel) in set.channels.iter_mut().enumerate() {
            let role = role(channel, &self.mechanism, &mechanism);
            let was_measured = channel.is_measured();
            channel.role = role;
            if channel.is_angle() && !was_measured {
                for run in &mut set.runs {
                    unwrap(&mut run.values[index]);
                }
            }
        }
        // Newly measured channels get a noise level.
        if set.runs.iter().any(|run| run.part == Part::Fit) {
            noise::find(&mut set);
        }
        Ok(set)
    }
}

/// Kind of a column for another mechanism.
fn role(channel: &Channel, from: &Mechanism, to: &Mechanism) -> Role {
    let input = |name: &str| Role::input(name, to);
    let measured = |name: &str| Measured::named(name, to).map(Role::Measures);
    let name = |role: Role| {
        role.label(from)
            .map_or(channel.column.as_str(), |l| &l.name)
    };
    let found = match channel.role {
        Role::Measures(_) => measured(name(channel.role)),
        Role::Input(_) => input(name(channel.role)),
        Role::Recorded => measured(&channel.column)
            .or_else(|| input(&channel.column))
            .filter(|role| {
                let label = role.label(to);
                label.is_some_and(|l| l.unit.dimension == channel.unit.dimension)
            }),
    };
    found.unwrap_or(Role::Recorded)
}
