//! Accelerations and forces in expressions of a spec, such as the reaction of a constraint.
//!
//! They are functions of the state, the inputs and ω̇. With symbols for ω̇ they are differentiated like other
//! functions of the solution: first at fixed ω̇, then by the chain rule.

use appell_spec::Code;
use appell_spec::expr::{Expr as Spec, Quantity, Response};
use appell_spec::mechanism::{Axis, ConstraintId, FrameId, GROUND, Mechanism};
use rustc_hash::FxHashSet;

use super::Derivation;
use super::algebra::Algebra;
use super::constraints::Constraints;
use super::contacts::Contact;
use super::expressions::Setting;
use super::finding::{Finding, Item, Outcome, unless_any};
use super::frames::FrameVector;
use super::given::Given;
use super::kinematics::Kinematics;
use super::loads::forces;
use super::reactions::reactions;
use super::symbols::{Symbols, answer};
use crate::symbolic::Expr;
use crate::symbolic::vector::Vec3;

/// The derived motion, as needed for accelerations and forces.
struct Answering<'a> {
    /// With the actual q̇.
    setting: Setting<'a>,
    constraints: &'a Constraints,
    contacts: &'a [Contact],
    kinematics: &'a Kinematics,
    /// Whether contacts creep, so that the actual q̇ differ from those in `kinematics`.
    creeps: bool,
    /// ω̇: symbols or values.
    accelerations: &'a [Expr],
    /// By place of [`Constraints::reactions`]; none if no reaction is wanted.
    reactions: Vec<Vec3>,
    given: &'a Given,
}

impl Derivation {
    /// Values for the symbols of accelerations and forces, for given ω̇ and reactions on which loads depend.
    pub(super) fn answers(
        &mut self,
        mechanism: &Mechanism,
        wanted: &[(Response, Expr)],
        accelerations: &[Expr],
        reactions_in_loads: &[(Expr, Expr)],
    ) -> Outcome<Vec<(Expr, Expr)>> {
        let bodies = self.bodies_in_ground(mechanism);
        let (algebra, kinematics) = (&mut self.algebra, &self.kinematics);
        let values = forces(&mut algebra.graph, kinematics, &self.loads, wanted);
        let reacts = |(response, _): &(Response, Expr)| {
            matches!(response, Response::Reaction(..) | Response::NormalForce(_))
        };
        let setting = Setting::new(mechanism, &self.symbols, &self.coordinate_rates);
        let reactions = if wanted.iter().any(reacts) {
            reactions(
                algebra,
                setting,
                &self.constraints,
                &self.velocities.violating,
                &bodies,
                accelerations,
                reactions_in_loads,
            )?
        } else {
            Vec::new()
        };
        let answering = Answering {
            setting,
            constraints: &self.constraints,
            contacts: &self.contacts,
            kinematics,
            creeps: self.coordinate_rates != self.rolling_rates,
            accelerations,
            reactions,
            given: &self.given,
        };
        answering.values(algebra, wanted, values)
    }
}

impl Answering<'_> {
    /// `values` with those of the other accelerations and forces.
    fn values(
        &self,
        algebra: &mut Algebra,
        wanted: &[(Response, Expr)],
        mut values: Vec<(Expr, Expr)>,
    ) -> Outcome<Vec<(Expr, Expr)>> {
        let mut findings = Vec::new();
        for &(response, symbol) in wanted {
            algebra.check_size()?;
            let value = match response {
                Response::Force(..) => continue,
                Response::Acceleration(point, axis, frame) => {
                    let v = self.kinematics.velocity(point);
                    Ok(self.rate_of(algebra, v, frame)[axis.index()])
                }
                Response::AngularAcceleration(of, axis, frame) => {
                    let w = self.kinematics.frames.angular_velocity(of);
                    Ok(self.rate_of(algebra, w, frame)[axis.index()])
                }
                Response::Reaction(constraint, along) => self.reaction(algebra, constraint, along),
                Response::NormalForce(constraint) => self.normal(algebra, constraint),
                Response::DriveForce(speed) => {
                    let drives = self.given.drives(&mut algebra.graph, self.accelerations);
                    let mut drives = drives.into_iter();
                    let own = drives.find(|(driven, _)| *driven == speed.index());
                    own.map(|(_, force)| force).ok_or(Untold::Undetermined)
                }
            };
            match value {
                Ok(value) => values.push((symbol, algebra.shortest(value))),
                Err(reason) => findings.push(untold(self.setting.mechanism, response, reason)),
            }
        }
        unless_any(findings)?;
        Ok(values)
    }

    /// The rate of a vector relative to the ground, in the components of a frame.
    fn rate_of(&self, algebra: &mut Algebra, vector: FrameVector, frame: FrameId) -> Vec3 {
        let frames = &self.kinematics.frames;
        let FrameVector { frame: own, v } = if self.creeps {
            // With creep, these angular velocities are not those of the actual motion.
            let v = frames.express(&mut algebra.graph, vector, GROUND);
            FrameVector::new(GROUND, v)
        } else {
            vector
        };
        let mut rate = self.setting.rate3(algebra, v);
        let speeds = self.setting.symbols.speeds.iter();
        for (&speed, &acceleration) in speeds.zip(self.accelerations) {
            let partial = v.map(|component| algebra.derivative(component, speed));
            let part = algebra.graph.scale3(acceleration, partial);
            rate = algebra.graph.add3(rate, part);
        }
        let graph = &mut algebra.graph;
        let turning = graph.cross(frames.angular_velocity(own).v, v);
        let v = graph.add3(rate, turning);
        frames.express(graph, FrameVector::new(own, v), frame)
    }

    /// A component of the reaction where a constraint acts, or its multiplier.
    fn reaction(
        &self,
        algebra: &mut Algebra,
        constraint: ConstraintId,
        along: Option<(Axis, FrameId)>,
    ) -> Result<Expr, Untold> {
        let v = self.reaction_of(constraint)?;
        let Some((axis, frame)) = along else {
            return Ok(v[0]);
        };
        let force = FrameVector::new(GROUND, v);
        let frames = &self.kinematics.frames;
        Ok(frames.express(&mut algebra.graph, force, frame)[axis.index()])
    }

    /// The reaction where a constraint acts, if it is reported.
    fn reaction_of(&self, constraint: ConstraintId) -> Result<Vec3, Untold> {
        let mut rows = self.constraints.rows_of(constraint);
        let place = rows.next().and_then(|row| self.constraints.reported(row));
        place
            .map(|place| self.reactions[place])
            .ok_or(Untold::Undetermined)
    }

    fn normal(&self, algebra: &mut Algebra, constraint: ConstraintId) -> Result<Expr, Untold> {
        // A reaction that is not reported has no contact.
        self.reaction_of(constraint)?;
        let mut contacts = self.contacts.iter();
        let contact = contacts
            .find(|contact| contact.constraint == constraint)
            .ok_or(Untold::Normal)?;
        let force = self.reactions[contact.place];
        Ok(algebra.graph.dot(contact.normal, force))
    }
}

/// The accelerations and forces in some expressions, with their symbols.
pub fn named_in<'e>(
    symbols: &Symbols,
    exprs: impl IntoIterator<Item = &'e Spec>,
) -> Vec<(Response, Expr)> {
    let mut named = FxHashSet::default();
    for expr in exprs {
        expr.visit(&mut |quantity| {
            if let Quantity::Response(response) = quantity {
                named.insert(response);
            }
        });
    }
    let mut wanted = symbols.responses.clone();
    wanted.retain(|(response, _)| named.contains(response));
    wanted
}

/// Why a force is undetermined.
#[derive(Clone, Copy)]
enum Untold {
    Undetermined,
    Normal,
}

fn untold(mechanism: &Mechanism, response: Response, reason: Untold) -> Finding {
    let (code, why, help) = match reason {
        Untold::Undetermined => (
            Code::UndeterminedReaction,
            "the constraints do not determine this reaction alone",
            "keep one constraint for each prevented motion; of a contact and a position \
             constraint that say the same, name the contact",
        ),
        Untold::Normal => (
            Code::ContactNotJudged,
            "the normal of its surface is not known, or another contact shares its reaction",
            "name a frame that follows the surface and its normal axis, such as `in = \"slope\", \
             normal = \"z\"`, and give each contact a point of its own",
        ),
    };
    Finding {
        code,
        message: format!("`{}` cannot be told: {why}", answer(mechanism, response)),
        item: who_names(mechanism, response),
        help: help.to_owned(),
    }
}

/// The first item that refers to a force.
fn who_names(mechanism: &Mechanism, response: Response) -> Item {
    let names = |exprs: &[&Spec]| {
        let mut found = false;
        for expr in exprs {
            expr.visit(&mut |quantity| found |= quantity == Quantity::Response(response));
        }
        found
    };
    for (index, load) in mechanism.loads.entries() {
        if names(&load.kind.expressions()) {
            return Item::Load(index);
        }
    }
    for (index, output) in mechanism.outputs.entries() {
        if names(&[&output.value]) {
            return Item::Output(index);
        }
    }
    Item::Mechanism
}
