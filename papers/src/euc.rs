//! The equations of *Experimental Model Identification of the Longitudinal Dynamics of an Electric
//! Unicycle with a Human Rider* (Mihályi, Ji, Orosz, Takács), corrected by the errata.
//!
//! Letters: `ga` and `ph` for the pitch angles of body and rider, a leading `d` for a rate, `dd`
//! for an acceleration. `row1` … are the derived equations of motion, left side minus right side; a
//! torque is correct if it makes them vanish.

use std::sync::LazyLock;

use crate::equations::{Equation, items};

/// The equations of motion and all torques.
pub static EQUATIONS: LazyLock<Vec<Equation>> =
    LazyLock::new(|| items(include_str!("euc.toml")).unwrap());
