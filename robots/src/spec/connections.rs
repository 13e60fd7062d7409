//! Coincident points of loop closures.

use crate::loops::Equations;
use crate::model::Connection;
use crate::rotation::{Vector, is_zero};
use crate::table::Item;

use super::Writer;
use super::bodies::{AXES, lengths};

impl Writer<'_> {
    /// Adds the equations of connections of links.
    pub(super) fn connections(&mut self, connections: &[Connection], equations: &Equations) {
        let mut names = crate::names::Names::default();
        for (connection, (name, meetings)) in connections.iter().zip(&equations.meetings) {
            let name = crate::names::short(name);
            for meeting in meetings {
                let called = names.new_one(&name);
                let along = self.frame_of(meeting.along);
                let [first, second] = [0, 1].map(|end| {
                    let (body, at) = meeting.ends[end];
                    self.end(&called, end, body, at)
                });
                for &(axis, follower) in &meeting.rows {
                    let axis = AXES[axis];
                    let of = |point: &str| match along.as_str() {
                        "ground" => format!("position({point}, {axis})"),
                        along => format!("position({point}, {axis}, {along})"),
                    };
                    let several = &self.called.several[follower.body];
                    let dependent = several
                        .get(follower.component)
                        .unwrap_or(&self.called.coordinates[follower.body]);
                    let item = Item::default()
                        .text("kind", "position")
                        .text("zero", &format!("{} - {}", of(&first), of(&second)))
                        .text("dependent", dependent);
                    self.constraints.add(&format!("{called}_{axis}"), &item);
                }
            }
            self.mark(&connection.place);
        }
    }

    /// The point at one end of a connection.
    fn end(&mut self, connection: &str, end: usize, body: Option<usize>, at: Vector) -> String {
        if is_zero(at) {
            return self.point_of(body);
        }
        let name = self.places.new_one(&format!("{connection}_{}", end + 1));
        let (from, frame) = (self.point_of(body), self.frame_of(body));
        let item = Item::point(&from, &frame, &lengths(at));
        self.points.add(&name, &item);
        name
    }
}
