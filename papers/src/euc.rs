//! The equations of *Experimental Model Identification of the Longitudinal Dynamics of an Electric
//! Unicycle with a Human Rider* (Mihályi, Ji, Orosz, Takács), corrected by the errata. Each is
//! compared with the derivation as a function, not at points.
//!
//! Letters: `ga` and `ph` for the pitch angles of body and rider, a leading `d` for a rate, `dd`
//! for an acceleration. `row1` … are the derived equations of motion, left side minus right side; a
//! torque is correct if it makes them vanish.

use crate::errata::Subject;

/// A numbered equation.
#[derive(Debug)]
pub struct Equation {
    /// Its number in the paper.
    pub number: &'static str,
    /// Its content.
    pub about: &'static str,
    /// The printed form.
    pub text: &'static str,
    /// The mechanism.
    subject: Subject,
    /// Lines `derived = formula`.
    lines: &'static str,
    /// Symbols with given values.
    at: &'static [(&'static str, &'static str)],
}

/// The first torque, (9).
macro_rules! torque_1 {
    () => {
        "(R*(m11*ddx + m12*ddga + m13*ddph + h1))"
    };
}
/// The second torque, (10).
macro_rules! torque_2 {
    () => {
        "(R*m11/(R*m11 + m12 + m13)*((m0*h0 - m*l0)*g*sin(ga) + m*g*h*sin(ph) - (m22 + m23)*ddga - (m23 + m33)*ddph - h2 - h3 + (m12 + m13)/m11*(m12*ddga + m13*ddph + h1)))"
    };
}
/// Both of (13).
macro_rules! mean_torque_1 {
    () => {
        "(-m*h*R*sin(ph)*dph**2 + (m + m0 + mw + Jw/R**2)*R*ddx + m*h*R*cos(ph)*ddph)"
    };
}
macro_rules! mean_torque_2 {
    () => {
        "(((m + m0 + mw + Jw/R**2)*m*g*h*R*sin(ph) - m**2*h**2*R*sin(ph)*cos(ph)*dph**2 + (m**2*h**2*R*cos(ph)**2 - (m + m0 + mw + Jw/R**2)*R*(J + m*h**2))*ddph)/(m*h*cos(ph) + (m + m0 + mw + Jw/R**2)*R))"
    };
}

const MASS_MATRIX: &str = "m11 = m + m0 + mw + Jw/R**2
m12 = -(m*l0 - m0*h0)*cos(ga)
m13 = m*h*cos(ph)
m22 = J0 + m0*h0**2 + m*l0**2
m23 = -m*h*l0*cos(ph - ga)
m33 = J + m*h**2
m21 = -(m*l0 - m0*h0)*cos(ga)
m31 = m*h*cos(ph)
m32 = -m*h*l0*cos(ph - ga)";
const BIAS: &str = "h1 = -m*h*dph**2*sin(ph) + (m*l0 - m0*h0)*dga**2*sin(ga)
h2 = m*h*l0*dph**2*sin(ph - ga)
h3 = -m*h*l0*dga**2*sin(ph - ga)";
const FORCES: &str = "Q1 = Md/R
Q2 = Mh - Md + (m0*h0 - m*l0)*g*sin(ga)
Q3 = m*g*h*sin(ph) - Mh";
const TWO_DOF_MASS_MATRIX: &str = "m11 = m + m0 + mw + Jw/R**2
m12 = m*h*cos(ph)
m21 = m*h*cos(ph)
m22 = J + m*h**2";
const TWO_DOF_REST: &str = "h1 = -m*h*dph**2*sin(ph)
h2 = 0
Q1 = Md/R
Q2 = m*g*h*sin(ph) - Md";
const KINETIC_ENERGY: &str = "T = 1/2*(m + m0 + mw + Jw/R**2)*dx**2 + 1/2*(J0 + m*l0**2 + m0*h0**2)*dga**2 + 1/2*(J + m*h**2)*dph**2 - (m*l0 - m0*h0)*dx*dga*cos(ga) + m*h*dx*dph*cos(ph) - m*h*l0*dga*dph*cos(ph - ga)";
const POWER: &str = "power = Md*(dx/R - dga) + Mh*(dga - dph)
energy_rate = Md*(dx/R - dga) + Mh*(dga - dph)
V = m0*g*h0*cos(ga) + m*g*(h*cos(ph) - l0*cos(ga)) + (m + m0 + mw)*g*R";

/// The equations of motion and all torques.
pub static EQUATIONS: &[Equation] = &[
    direct("(6)", "mass matrix", Subject::Euc3, MASS_MATRIX),
    direct("(7)", "terms without accelerations", Subject::Euc3, BIAS),
    direct("(8)", "active forces", Subject::Euc3, FORCES),
    Equation {
        number: "(9)",
        about: "driving torque from the first equation",
        text: torque_1!(),
        subject: Subject::Euc3,
        lines: "row1 = 0",
        at: &[("Md", torque_1!())],
    },
    Equation {
        number: "(10)",
        about: "driving torque from all equations, without the forward acceleration",
        text: torque_2!(),
        subject: Subject::Euc3,
        lines: "row2 + row3 = 0",
        at: &[
            ("Md", torque_2!()),
            (
                "ddx",
                concat!("(", torque_2!(), "/R - m12*ddga - m13*ddph - h1)/m11"),
            ),
        ],
    },
    direct(
        "(11)",
        "mass matrix of the model with two degrees of freedom",
        Subject::Euc2,
        TWO_DOF_MASS_MATRIX,
    ),
    direct(
        "(12)",
        "its other terms, M_h = M_d",
        Subject::Euc2,
        TWO_DOF_REST,
    ),
    Equation {
        number: "(13)",
        about: "its driving torque from the first equation",
        text: mean_torque_1!(),
        subject: Subject::Euc2,
        lines: "row1 = 0",
        at: &[("Md", mean_torque_1!())],
    },
    Equation {
        number: "(13)",
        about: "its driving torque without the forward acceleration",
        text: mean_torque_2!(),
        subject: Subject::Euc2,
        lines: "row2 = 0",
        at: &[
            ("Md", mean_torque_2!()),
            (
                "ddx",
                concat!(
                    "(",
                    mean_torque_2!(),
                    "/R + m*h*dph**2*sin(ph) - m*h*cos(ph)*ddph)/(m + m0 + mw + Jw/R**2)"
                ),
            ),
        ],
    },
    direct("(A.1)", "kinetic energy", Subject::Euc3, KINETIC_ENERGY),
    direct(
        "(A.2)",
        "power of the active forces; the potential counts from the ground",
        Subject::Euc3,
        POWER,
    ),
];

const fn direct(
    number: &'static str,
    about: &'static str,
    subject: Subject,
    lines: &'static str,
) -> Equation {
    Equation {
        number,
        about,
        text: lines,
        subject,
        lines,
        at: &[],
    }
}

impl Equation {
    /// Differences from the derivation; empty if the equation holds.
    pub fn differences(&self) -> Vec<String> {
        self.subject.paper().differences(self.lines, self.at)
    }

    /// The shipped mechanism.
    pub const fn mechanism(&self) -> &'static str {
        self.subject.mechanism()
    }
}
