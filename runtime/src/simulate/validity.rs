//! Validity of a model along a motion: ranges, contacts, conditioning.

use super::describe::describe_state;
use crate::condition::Conditions;
use crate::contact::{ContactForce, ContactForces};
use crate::inputs::ModelInputs;
use crate::integrate::{Direction, Event, EventHit};
use crate::model::{At, Model, ModelInfo};
use std::cell::RefCell;
use std::rc::Rc;

/// Response of a simulation to a violation of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Response {
    /// The limit is not checked.
    Ignore,
    /// A [`Breach`] is recorded and the motion continues.
    Report,
    /// A [`Breach`] is recorded and the motion ends.
    Stop,
}

/// Responses to violations of each kind of limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Validity {
    /// States outside their declared range. Stopping there is an error.
    pub ranges: Response,
    /// Contacts with a tensile normal force, or that slip.
    pub contacts: Response,
    /// Coefficient of friction of all contacts; overrides those of the spec. Contacts without any are not checked for
    /// slipping.
    pub friction: Option<f64>,
    /// Mass matrix, velocities and systems with a condition number above `worst_condition`.
    pub conditions: Response,
    /// The largest admissible condition number.
    pub worst_condition: f64,
}

impl Default for Validity {
    /// Stops at ranges; nothing else is checked.
    fn default() -> Self {
        Self {
            ranges: Response::Stop,
            contacts: Response::Ignore,
            friction: None,
            conditions: Response::Ignore,
            worst_condition: 1e12,
        }
    }
}

/// A limit of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// The declared range of a state.
    Range {
        /// Index of the state.
        state: usize,
    },
    /// The normal force of a contact is compressive.
    Contact {
        /// Index into [`ModelInfo::contacts`].
        contact: usize,
    },
    /// The tangential force of a contact is bounded by friction.
    Friction {
        /// Index into [`ModelInfo::contacts`].
        contact: usize,
    },
    /// A linear system is sufficiently well-conditioned.
    Condition {
        /// Index into [`Conditions::names`].
        of: usize,
    },
}

/// A violation of a limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Breach {
    /// Time in s: the root of the margin, or the start of the motion if violated there.
    pub t: f64,
    /// State at that time, in SI.
    pub state: Vec<f64>,
    /// Which limit.
    pub limit: Limit,
    /// The limited quantity, at that time and in SI: the state, the normal force, the friction demand, the condition
    /// number.
    pub value: f64,
}

impl Breach {
    /// A description in the names and units of the spec.
    pub fn describe(&self, info: &ModelInfo) -> String {
        let contact = |index: usize| info.contacts.get(index).map_or("?", |c| c.name.as_ref());
        match self.limit {
            Limit::Range { state } => info.states.get(state).map_or_else(String::new, |state| {
                let [lower, upper] = state.range.map(|limit| state.shown(limit));
                let value = state.to_unit(self.value);
                let (name, unit) = (&state.name, &state.unit);
                format!("`{name}` = {value:.6} {unit} leaves its range {lower} … {upper} {unit}")
            }),
            Limit::Contact { contact: index } => format!(
                "the contact `{}` is lost: its normal force falls below zero",
                contact(index)
            ),
            Limit::Friction { contact: index } => format!(
                "the contact `{}` slips: its friction demand is {:.6}",
                contact(index),
                self.value
            ),
            Limit::Condition { of } => {
                let what = match of {
                    0 => "mass matrix",
                    1 => "map from pseudo-velocities to generalised velocities",
                    _ => "system for the generalised velocities",
                };
                format!("the {what} has the condition number {:.1e}", self.value)
            }
        }
    }

    /// The same with time and state.
    pub fn describe_in_full(&self, info: &ModelInfo) -> String {
        let (t, what) = (self.t, self.describe(info));
        let state = describe_state(&self.state, info);
        format!("at t = {t:.9} s {what}; state:{state}")
    }
}

/// Evaluates limited quantities, with a cache for the last state.
struct Gauge<'a> {
    model: &'a dyn Model,
    inputs: &'a ModelInputs<'a>,
    p: &'a [f64],
    validity: Validity,
    u: Vec<f64>,
    forces: ContactForces,
    /// Time and state of the cached values.
    place: Option<(f64, Vec<f64>)>,
    seen_forces: Option<Vec<ContactForce>>,
    seen_conditions: Option<Conditions>,
}

impl Gauge<'_> {
    /// The limited quantity and its margin: negative if the limit is violated.
    fn read(&mut self, limit: Limit, t: f64, x: &[f64]) -> (f64, f64) {
        match limit {
            Limit::Range { state } => {
                let [lower, upper] = self.model.info().states[state].range;
                (x[state], (x[state] - lower).min(upper - x[state]))
            }
            Limit::Contact { contact } => {
                let normal = self.forces_at(t, x)[contact].normal;
                (normal, normal)
            }
            Limit::Friction { contact } => {
                let given = self.validity.friction;
                let force = self.forces_at(t, x)[contact];
                let friction = given.or(force.friction).unwrap_or(f64::INFINITY);
                (force.demand(), force.grip(friction))
            }
            Limit::Condition { of } => {
                let value = self.conditions_at(t, x).iter().nth(of).unwrap_or(f64::NAN);
                // Bounded, so that a root next to a pole is located.
                let left = self.validity.worst_condition / value.max(1.0);
                (value, left.ln().max(-1e3))
            }
        }
    }

    fn forces_at(&mut self, t: f64, x: &[f64]) -> &[ContactForce] {
        self.look(t, x);
        let (model, u, p) = (self.model, &self.u, self.p);
        let forces = &mut self.forces;
        self.seen_forces
            .get_or_insert_with(|| forces.at(model, At { t, x, u, p }).to_vec())
    }

    fn conditions_at(&mut self, t: f64, x: &[f64]) -> &Conditions {
        self.look(t, x);
        let (model, u, p) = (self.model, &self.u, self.p);
        self.seen_conditions
            .get_or_insert_with(|| Conditions::of(model, At { t, x, u, p }))
    }

    /// Clears the cache if time or state differ.
    fn look(&mut self, t: f64, x: &[f64]) {
        let is_seen = |(time, state): &(f64, Vec<f64>)| time.to_bits() == t.to_bits() && state == x;
        if !self.place.as_ref().is_some_and(is_seen) {
            self.inputs.fill(t, x, &mut self.u);
            (self.seen_forces, self.seen_conditions) = (None, None);
            self.place = Some((t, x.to_vec()));
        }
    }
}

/// The limits of one simulation.
pub(super) struct Limits<'a> {
    gauge: Rc<RefCell<Gauge<'a>>>,
    /// Each with whether it ends the motion.
    watched: Vec<(Limit, bool)>,
}

impl<'a> Limits<'a> {
    pub(super) fn new(
        model: &'a dyn Model,
        inputs: &'a ModelInputs<'a>,
        p: &'a [f64],
        validity: Validity,
    ) -> Self {
        let info = model.info();
        let gauge = Gauge {
            model,
            inputs,
            p,
            validity,
            u: vec![0.0; info.input_len()],
            forces: ContactForces::new(),
            place: None,
            seen_forces: None,
            seen_conditions: None,
        };
        let mut watched = Vec::new();
        // Stopping at a range is an error of the integration.
        if validity.ranges == Response::Report {
            let states = info.states.iter().enumerate();
            let limited = states.filter(|(_, q)| q.range.iter().any(|limit| limit.is_finite()));
            watched.extend(limited.map(|(state, _)| (Limit::Range { state }, false)));
        }
        if validity.contacts != Response::Ignore {
            let stop = validity.contacts == Response::Stop;
            for (contact, surface) in info.contacts.iter().enumerate() {
                watched.push((Limit::Contact { contact }, stop));
                if surface.grips && (validity.friction.is_some() || surface.friction.is_some()) {
                    watched.push((Limit::Friction { contact }, stop));
                }
            }
        }
        if validity.conditions != Response::Ignore {
            let stop = validity.conditions == Response::Stop;
            let all = 0..Conditions::names(model).count();
            watched.extend(all.map(|of| (Limit::Condition { of }, stop)));
        }
        Self {
            gauge: Rc::new(RefCell::new(gauge)),
            watched,
        }
    }

    /// One event per limit.
    pub(super) fn events(&self) -> impl Iterator<Item = Event<'a>> + '_ {
        self.watched.iter().map(|&(limit, stop)| {
            let gauge = Rc::clone(&self.gauge);
            let left = move |t: f64, x: &[f64]| gauge.borrow_mut().read(limit, t, x).1;
            Event {
                terminal: stop,
                ..Event::new(Direction::Falling, left)
            }
        })
    }

    /// The limits violated at the start, and whether one of them ends the motion.
    pub(super) fn at_start(&self, t: f64, x: &[f64]) -> (Vec<Breach>, bool) {
        let (mut breaches, mut ends) = (Vec::new(), false);
        for &(limit, stop) in &self.watched {
            if self.gauge.borrow_mut().read(limit, t, x).1 < 0.0 {
                breaches.push(self.breach(limit, t, x.to_vec()));
                ends |= stop;
            }
        }
        (breaches, ends)
    }

    /// The breach of an event, which is numbered as in [`Limits::events`].
    pub(super) fn found(&self, event: usize, hit: EventHit) -> Option<Breach> {
        let &(limit, _) = self.watched.get(event)?;
        Some(self.breach(limit, hit.t, hit.state))
    }

    fn breach(&self, limit: Limit, t: f64, state: Vec<f64>) -> Breach {
        let (value, _) = self.gauge.borrow_mut().read(limit, t, &state);
        Breach {
            t,
            state,
            limit,
            value,
        }
    }
}
