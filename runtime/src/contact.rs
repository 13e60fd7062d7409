//! What surfaces have to give at the contacts of a model: normal force, tangential force, and the
//! friction that these ask for.
//!
//! A contact pushes and does not pull, and friction carries only a part of the normal force
//! (Coulomb). Equations of motion know neither limit: a constraint holds whatever it takes.

use crate::model::{At, Contact, Model};

/// The force at one contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactForce {
    /// N, the push of the surface along its normal, in N. Negative where only a glue could hold
    /// the contact. For a contact of a position constraint in W per unit of the constraint.
    pub normal: f64,
    /// Size of the force along the surface, in the same unit.
    pub tangential: f64,
    /// Coefficient of friction, where the spec tells one.
    pub friction: Option<f64>,
}

impl ContactForce {
    /// Tangential over normal force, the coefficient of friction below which the contact slips. Infinite where nothing
    /// presses.
    pub fn demand(&self) -> f64 {
        if self.normal > 0.0 {
            self.tangential / self.normal
        } else if self.normal.is_nan() {
            f64::NAN
        } else {
            f64::INFINITY
        }
    }

    /// μ times the normal force less the tangential one, for a coefficient of friction μ: what is
    /// left before the contact slips; negative where it does.
    pub fn grip(&self, friction: f64) -> f64 {
        friction * self.normal - self.tangential
    }
}

/// The forces at the contacts of a model, with work arrays.
#[derive(Debug, Clone, Default)]
pub struct ContactForces {
    reactions: Vec<f64>,
    normals: Vec<f64>,
    friction: Vec<f64>,
    forces: Vec<ContactForce>,
}

impl ContactForces {
    /// Sized at the first use.
    pub fn new() -> Self {
        Self::default()
    }

    /// One force per entry of [`ModelInfo::contacts`](crate::model::ModelInfo::contacts). Not a
    /// number where the equations have no finite solution.
    pub fn at(&mut self, model: &dyn Model, at: At<'_>) -> &[ContactForce] {
        let info = model.info();
        if info.contacts.is_empty() {
            return &[];
        }
        let mut reactions = std::mem::take(&mut self.reactions);
        reactions.resize(3 * info.reactions.len(), 0.0);
        model.constraint_forces(at, &mut reactions);
        self.of(model, at, &reactions);
        self.reactions = reactions;
        &self.forces
    }

    /// [`Self::at`] where the constraint forces are known.
    pub fn of(&mut self, model: &dyn Model, at: At<'_>, reactions: &[f64]) -> &[ContactForce] {
        let info = model.info();
        self.forces.clear();
        if info.contacts.is_empty() {
            return &self.forces;
        }
        self.normals.resize(3 * info.contacts.len(), 0.0);
        self.friction.resize(info.contacts.len(), 0.0);
        model.contacts(at, &mut self.normals, &mut self.friction);
        let surfaces = self.normals.chunks_exact(3).zip(&self.friction);
        for (contact, (normal, &friction)) in info.contacts.iter().zip(surfaces) {
            let reaction = reactions.get(3 * contact.reaction..).unwrap_or(&[]);
            self.forces.push(force(contact, reaction, normal, friction));
        }
        &self.forces
    }
}

/// Splits a reaction along a normal of any length.
fn force(contact: &Contact, reaction: &[f64], normal: &[f64], friction: f64) -> ContactForce {
    let along = |direction: &[f64]| -> f64 {
        let products = reaction.iter().zip(direction).map(|(f, n)| f * n);
        products.sum()
    };
    let length = norm(normal.iter().copied());
    let push = along(normal) / length;
    let across = reaction.iter().zip(normal);
    ContactForce {
        normal: push,
        tangential: norm(across.map(|(f, n)| f - push * n / length)),
        friction: contact.friction.map(|_| friction),
    }
}

fn norm(components: impl Iterator<Item = f64>) -> f64 {
    components.map(|c| c * c).sum::<f64>().sqrt()
}
