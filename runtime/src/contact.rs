//! Contact forces of a model: normal force, tangential force, and the friction coefficient that they require.
//!
//! A contact can push but not pull, and friction is bounded by the normal force (Coulomb). The equations of motion
//! respect neither limit: their constraints are bilateral.

use crate::model::{At, Contact, Model};

/// The force at one contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactForce {
    /// N, the push of the surface along its normal, in N. Negative if only an adhesive bond could sustain the
    /// contact. For a contact of a position constraint in W per unit of the constraint.
    pub normal: f64,
    /// Magnitude of the force along the surface, in the same unit.
    pub tangential: f64,
    /// Coefficient of friction, if the spec gives one.
    pub friction: Option<f64>,
}

impl ContactForce {
    /// Tangential over normal force, the coefficient of friction below which the contact slips. Infinite without a
    /// compressive normal force.
    pub fn demand(&self) -> f64 {
        if self.normal > 0.0 {
            self.tangential / self.normal
        } else if self.normal.is_nan() {
            f64::NAN
        } else {
            f64::INFINITY
        }
    }

    /// μ times the normal force minus the tangential force, for a coefficient of friction μ: the margin against
    /// slipping, negative if the contact slips.
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
    /// The arrays are allocated at the first use.
    pub fn new() -> Self {
        Self::default()
    }

    /// One force per entry of [`ModelInfo::contacts`](crate::model::ModelInfo::contacts). NaN if the equations have
    /// no finite solution.
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

    /// [`Self::at`] for known constraint forces.
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

/// Decomposes a reaction along a normal of any length.
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
