//! Sites at bodies that roll.

use appell_spec::expr::{ExprKind, Quantity};
use appell_spec::mechanism::{BodyId, Constraint, ConstraintKind};

use super::{AXES, Site, Sites, number};

impl Sites<'_> {
    /// Bodies that roll, with their angular velocity about the normal of the ground.
    pub(in crate::effects) fn wheels(&self) -> Vec<Site> {
        let constraints = self.mechanism.constraints.iter();
        let rolling = constraints.filter_map(|constraint| match constraint.kind {
            ConstraintKind::Rolling { body, .. } => Some(body),
            _ => None,
        });
        let mut bodies: Vec<BodyId> = rolling.collect();
        bodies.sort_unstable();
        bodies.dedup();
        let wheels = bodies.into_iter().filter_map(|body| self.wheel(body));
        wheels.collect()
    }

    pub(in crate::effects) fn contacts(&self) -> Vec<Site> {
        let constraints = self.mechanism.constraints.iter().enumerate();
        let rolls =
            |kind: &ConstraintKind| matches!(kind, ConstraintKind::Rolling { creep: None, .. });
        let contacts = constraints.filter(|(_, constraint)| rolls(&constraint.kind));
        let site = |(index, constraint): (usize, &Constraint)| {
            Site::new(&constraint.name, index, Vec::new())
        };
        contacts.map(site).collect()
    }

    fn wheel(&self, body: BodyId) -> Option<Site> {
        let down = self.mechanism.down()?;
        let frame = self.mechanism.bodies[body].frame?;
        let turn = self.mechanism.frames[frame].turns.last()?;
        let ExprKind::Quantity(Quantity::Coordinate(roll)) = turn.angle.kind else {
            return None;
        };
        let name = &self.mechanism.frames[frame].name;
        let axle = AXES[turn.axis.index()];
        let axes = down.iter().zip(AXES);
        let spin: Vec<String> = axes
            .filter(|(down, _)| **down != 0)
            .map(|(down, axis)| format!("({})*angular_velocity({name}, {axis})", -down))
            .collect();
        let mut constraints = self.mechanism.constraints.iter();
        let contact = constraints.find(|constraint| {
            matches!(constraint.kind, ConstraintKind::Rolling { body: own, .. } if own == body)
        })?;
        let mut site = self.body(body);
        site.words.extend([
            ("contact", contact.name.clone()),
            ("roll", self.mechanism.coordinates[roll].label.name.clone()),
            ("narrow_rate", number(self.scales.narrow[roll.index()])),
            (
                "axle_rate",
                format!("angular_velocity({name}, {axle}, {name})"),
            ),
            ("spin", spin.join(" + ")),
            ("normal_x", (-down[0]).to_string()),
            ("normal_y", (-down[1]).to_string()),
            ("normal_z", (-down[2]).to_string()),
        ]);
        Some(site)
    }
}
