//! Every equation, in the order of the paper.

use super::{Equation, Formulas, Identity};
use crate::errata::ACCELERATION_ENERGY;
use crate::errata::Subject::{self, Unicycle, Wheel};

const fn lines(subject: Subject, lines: &'static str) -> Identity {
    Identity {
        subject,
        at: &[],
        formulas: Formulas::Lines(lines),
    }
}

type Values = &'static [(&'static str, &'static str)];

const fn lines_at(subject: Subject, at: Values, lines: &'static str) -> Identity {
    Identity {
        subject,
        at,
        formulas: Formulas::Lines(lines),
    }
}

const fn matrix_at(subject: Subject, at: Values, lines: &'static str) -> Identity {
    Identity {
        subject,
        at,
        formulas: Formulas::Matrix(lines),
    }
}

const fn energy(subject: Subject, text: &'static str) -> Identity {
    Identity {
        subject,
        at: &[],
        formulas: Formulas::Energy(text),
    }
}

/// Straight rolling of the unicycle.
const STRAIGHT: Values = &[("th", "0"), ("r", "0"), ("Pd", "0"), ("psi", "0")];

const CENTRE: &str = "
    vG1 = R*w2
    vG2 = -R*w1
    vG3 = 0
    xGd = R*(psid*sin(th)*cos(psi) + thd*cos(th)*sin(psi) + phid*cos(psi))
    yGd = R*(psid*sin(th)*sin(psi) - thd*cos(th)*cos(psi) + phid*sin(psi))";
const HEIGHT: &str = "zG = R*cos(th)";
const PSEUDO_VELOCITIES: &str = "
    w1 = thd
    w2 = psid*sin(th) + phid
    w3 = psid*cos(th)";
const IGNORABLE: &str = "
    psid = w3/cos(th)
    phid = w2 - w3*tan(th)
    xGd = w1*R*sin(psi)*cos(th) + w2*R*cos(psi)
    yGd = -w1*R*cos(psi)*cos(th) + w2*R*sin(psi)";
const STEADY_IGNORABLE: &str = "
    psid = w3/cos(th)
    phid = w2 - w3*tan(th)
    xGd = w2*R*cos(psi)
    yGd = w2*R*sin(psi)";
const WHEEL: &str = "
    w1d = 6/5*w2*w3 - 1/5*w3**2*tan(th) + 4*g/(5*R)*sin(th)
    w2d = -2/3*w1*w3
    w3d = -2*w1*w2 + w1*w3*tan(th)";
const ROTATION: &str = "
    T11 = cos(psi)
    T12 = -sin(psi)*cos(th)
    T13 = sin(psi)*sin(th)
    T21 = sin(psi)
    T22 = cos(psi)*cos(th)
    T23 = -cos(psi)*sin(th)
    T31 = 0
    T32 = sin(th)
    T33 = cos(th)";
const ANGULAR_VELOCITY: &str = "
    omega1 = thd
    omega2 = psid*sin(th) + phid
    omega3 = psid*cos(th)";
const ACCELERATIONS: &str = "
    aG1 = R*(w2d + w1*w3)
    aG2 = -R*(w1d - w2*w3)
    aG3 = -R*(w1**2 + w2*w3*tan(th))
    alpha1 = w1d - w2*w3 + w3**2*tan(th)
    alpha2 = w2d
    alpha3 = w3d + w1*w2 - w1*w3*tan(th)";

/// The equations in the order of the paper.
pub const EQUATIONS: &[Equation] = &[
    Equation {
        number: "(2)",
        about: "velocity of the wheel centre",
        claims: &[lines(Wheel, CENTRE), lines(Unicycle, CENTRE)],
    },
    Equation {
        number: "(3)",
        about: "height of the wheel centre",
        claims: &[lines(Wheel, HEIGHT), lines(Unicycle, HEIGHT)],
    },
    Equation {
        number: "(5)",
        about: "pseudo-velocities of the wheel",
        claims: &[lines(Wheel, PSEUDO_VELOCITIES)],
    },
    Equation {
        number: "(6)",
        about: "equations of motion of the rolling wheel",
        claims: &[
            lines(Wheel, WHEEL),
            lines(Wheel, "thd = w1"),
            lines(Wheel, IGNORABLE),
        ],
    },
    Equation {
        number: "(9)",
        about: "steady motion of the wheel in pseudo-velocities",
        claims: &[lines_at(
            Wheel,
            &[("w1", "0")],
            "5*R*w1d = 6*w2*w3*R - w3**2*R*tan(th) + 4*g*sin(th)
             w2d = 0
             w3d = 0",
        )],
    },
    Equation {
        number: "(10)",
        about: "motion of the ignorable coordinates while the essential states rest",
        claims: &[
            lines_at(Wheel, &[("w1", "0")], STEADY_IGNORABLE),
            lines_at(Unicycle, &[("w1", "0")], STEADY_IGNORABLE),
        ],
    },
    Equation {
        number: "(13)",
        about: "steady motion of the wheel in yaw and pitch rate",
        claims: &[lines(
            Wheel,
            "5*R*steady_w1d = 5*Pd**2*R*sin(th)*cos(th) + 6*Pd*Fd*R*cos(th) + 4*g*sin(th)",
        )],
    },
    Equation {
        number: "(14)",
        about: "pitch rate of a turning wheel",
        claims: &[lines_at(
            Wheel,
            &[("Fd", "-5/6*Pd*sin(th) - 2*g/(3*R)*tan(th)/Pd")],
            "steady_w1d = 0",
        )],
    },
    Equation {
        number: "(15)",
        about: "straight rolling needs an upright wheel",
        claims: &[lines_at(Wheel, &[("Pd", "0")], "5*R*steady_w1d/(4*g) = sin(th)")],
    },
    Equation {
        number: "(16)",
        about: "spinning on the spot needs an upright wheel",
        claims: &[lines_at(
            Wheel,
            &[("Fd", "0")],
            "5*R*steady_w1d = 5*Pd**2*R*sin(th)*cos(th) + 4*g*sin(th)",
        )],
    },
    Equation {
        number: "(18), (19)",
        about: "linearised wheel",
        claims: &[matrix_at(
            Wheel,
            &[],
            "A12 = 6/5*Pd*cos(th)
             A13 = 4/5*Pd*sin(th) + 6/5*Fd
             A14 = -1/5*Pd**2 + 4*g/(5*R)*cos(th)
             A21 = -2/3*Pd*cos(th)
             A31 = -Pd*sin(th) - 2*Fd
             A41 = 1
             A53 = 1/cos(th)
             A54 = Pd*tan(th)
             A62 = 1
             A63 = -tan(th)
             A64 = -Pd/cos(th)
             A71 = R*sin(psi)*cos(th)
             A72 = R*cos(psi)
             A75 = -R*sin(psi)*(Pd*sin(th) + Fd)
             A81 = -R*cos(psi)*cos(th)
             A82 = R*sin(psi)
             A85 = R*cos(psi)*(Pd*sin(th) + Fd)",
        )],
    },
    Equation {
        number: "(20)",
        about: "characteristic polynomial of the wheel",
        claims: &[lines(
            Wheel,
            "c1 = 0
             c2 = -(A12*A21 + A13*A31 + A14)
             c3 = 0
             c4 = 0
             c5 = 0
             c6 = 0
             c7 = 0
             c8 = 0",
        )],
    },
    Equation {
        number: "(21)",
        about: "square of the eigenvalues of the wheel",
        claims: &[lines(
            Wheel,
            "-c2 = 4*g/(5*R)*cos(th) - (Pd**2 + 14/5*Pd*Fd*sin(th) + 12/5*Fd**2)",
        )],
    },
    Equation {
        number: "(24)",
        about: "straight rolling of the wheel",
        claims: &[lines_at(
            Wheel,
            &[("w1", "0"), ("w3", "0"), ("th", "0"), ("psi", "0")],
            "phid = w2
             xGd = R*w2
             yGd = 0
             psid = 0",
        )],
    },
    Equation {
        number: "(25)",
        about: "linearised wheel in straight rolling",
        claims: &[matrix_at(
            Wheel,
            &[("th", "0"), ("Pd", "0"), ("psi", "0")],
            "A13 = 6/5*Fd
             A14 = 4*g/(5*R)
             A31 = -2*Fd
             A41 = 1
             A53 = 1
             A62 = 1
             A72 = R
             A81 = -R
             A85 = R*Fd",
        )],
    },
    Equation {
        number: "(26)",
        about: "square of the eigenvalues in straight rolling",
        claims: &[lines_at(
            Wheel,
            &[("th", "0"), ("Pd", "0")],
            "-c2 = 4*g/(5*R) - 12/5*Fd**2",
        )],
    },
    Equation {
        number: "(28)",
        about: "spinning of the wheel",
        claims: &[lines_at(
            Wheel,
            &[("w1", "0"), ("w2", "0"), ("th", "0")],
            "psid = w3
             phid = 0
             xGd = 0
             yGd = 0",
        )],
    },
    Equation {
        number: "(29)",
        about: "linearised wheel in spinning",
        claims: &[matrix_at(
            Wheel,
            &[("th", "0"), ("Fd", "0")],
            "A12 = 6/5*Pd
             A14 = 4*g/(5*R) - 1/5*Pd**2
             A21 = -2/3*Pd
             A41 = 1
             A53 = 1
             A62 = 1
             A64 = -Pd
             A71 = R*sin(psi)
             A72 = R*cos(psi)
             A81 = -R*cos(psi)
             A82 = R*sin(psi)",
        )],
    },
    Equation {
        number: "(30)",
        about: "square of the eigenvalues in spinning",
        claims: &[lines_at(
            Wheel,
            &[("th", "0"), ("Fd", "0")],
            "-c2 = 4*g/(5*R) - Pd**2",
        )],
    },
    Equation {
        number: "(35)",
        about: "pseudo-velocities of the unicycle",
        claims: &[lines(Unicycle, PSEUDO_VELOCITIES), lines(Unicycle, "s = rd")],
    },
    Equation {
        number: "(36)",
        about: "equations of motion of the unicycle",
        claims: &[
            lines(
                Unicycle,
                "let D1 = 5*m*R**2 + 4*m0*r**2
                 let D2 = 3*m*R**2 + 2*m0*R**2 + 12*m0*r**2
                 w1d = (4*m0*R*r*w1**2 - (m*R**2 + 4*m0*r**2)*tan(th)*w3**2 - 8*m0*r*w1*s + 2*R*(3*m*R + 2*m0*r*tan(th))*w2*w3 - 4*m0*g*r*cos(th) + 4*m*g*R*sin(th) + 4*R*u)/D1
                 w2d = 2*(-2*m0*R*r*w1*w2 - (m*R**2 + m0*R**2 + 4*m0*r**2)*w1*w3 + 2*m0*R*w3*s)/D2
                 w3d = (-2*(3*m + 2*m0)*R**2*w1*w2 + (3*m*R**2*tan(th) + 2*m0*(R**2*tan(th) + 2*R*r + 6*r**2*tan(th)))*w1*w3 - 24*m0*r*w3*s)/D2
                 thd = w1
                 sd = ((5*m*R**2 + 4*m0*(R**2 + r**2))*r*w1**2 + (5*m*R**2*r - 4*m0*R*r**2*tan(th) + 4*m0*r**3 - m*R**3*tan(th))*w3**2 - 8*m0*R*r*w1*s + R*(m*R**2 + 4*m0*(R*r*tan(th) - r**2))*w2*w3 - (m*R**2 + 4*m0*r**2)*g*sin(th) - 4*m0*g*R*r*cos(th) + (5*m/m0*R**2 + 4*R**2 + 4*r**2)*u)/D1
                 rd = s",
            ),
            lines(Unicycle, IGNORABLE),
        ],
    },
    Equation {
        number: "(39)",
        about: "steady motion of the unicycle in pseudo-velocities",
        claims: &[lines(
            Unicycle,
            "let D1 = 5*m*R**2 + 4*m0*r**2
             let w2s = Pd*sin(th) + Fd
             let w3s = Pd*cos(th)
             let rotation = m*m0*R**3 - 4*m0**2*R*r**2 + 4*m0**2*R**2*r*tan(th)
             D1*steady_w1d = w2s*w3s*(6*m*R**2 + 4*m0*R*r*tan(th)) - w3s**2*(m*R**2 + 4*m0*r**2)*tan(th) - 4*m0*g*r*cos(th) + 4*m*g*R*sin(th)
             D1*m0*steady_sd = w2s*w3s*rotation + w3s**2*(5*m*m0*R**2*r + 4*m0**2*r**3 - (m*m0*R**3 + 4*m0**2*R*r**2)*tan(th)) - (4*m0**2*g*r**2 + m*m0*g*R**2)*sin(th) - 4*m0**2*g*R*r*cos(th)",
        )],
    },
    Equation {
        number: "(40)",
        about: "steady motion of the unicycle in yaw and pitch rate",
        claims: &[lines(
            Unicycle,
            "let D1 = 5*m*R**2 + 4*m0*r**2
             D1*steady_w1d = 5*m*R**2*Pd**2*sin(th)*cos(th) + 4*m0*R*Pd**2*r*sin(th)**2 - 4*m0*Pd**2*r**2*sin(th)*cos(th) + 6*m*R**2*Pd*Fd*cos(th) + 4*m0*R*Pd*Fd*r*sin(th) - 4*m0*g*r*cos(th) + 4*m*g*R*sin(th)
             D1*steady_sd = m*R**3*Pd*Fd*cos(th) + 4*m0*R**2*Pd*Fd*r*sin(th) - 4*m0*R*Pd*Fd*r**2*cos(th) + 5*m*R**2*Pd**2*r*cos(th)**2 + 4*m0*R**2*Pd**2*r*sin(th)**2 - 8*m0*R*Pd**2*r**2*sin(th)*cos(th) + 4*m0*Pd**2*r**3*cos(th)**2 - m*g*R**2*sin(th) - 4*m0*g*R*r*cos(th) - 4*m0*g*r**2*sin(th)",
        )],
    },
    Equation {
        number: "(41)",
        about: "pitch rate and place of the mass of a turning unicycle",
        claims: &[
            lines_at(
                Unicycle,
                &[
                    ("r", "m*R*(Pd**2*R*cos(th) + 2*g)*sin(th)*cos(th)/(6*Pd**2*m*R*cos(th)**3 - 4*m0*g)"),
                    ("Fd", "Pd*(m*R*(Pd**2*R*cos(th) + 2*g)*sin(th)*cos(th)/(6*Pd**2*m*R*cos(th)**3 - 4*m0*g)*cos(th)/R - sin(th)) - g*tan(th)/(Pd*R)"),
                ],
                "steady_w1d = 0
                 steady_sd = 0",
            ),
            lines_at(
                Unicycle,
                &[("Fd", "(-4*m*g*R*sin(th) + Pd**2*(4*m0*r**2 - 5*m*R**2)*sin(th)*cos(th) - 4*Pd**2*m0*R*r*sin(th)**2 + 4*m0*g*r*cos(th))/(Pd*R*(6*m*R*cos(th) + 4*m0*r*sin(th)))")],
                "steady_w1d = 0",
            ),
        ],
    },
    Equation {
        number: "(43)",
        about: "straight rolling of the unicycle",
        claims: &[lines_at(
            Unicycle,
            &[("Pd", "0")],
            "let D1 = 5*m*R**2 + 4*m0*r**2
             D1*steady_w1d/g = 4*m*R*sin(th) - 4*m0*r*cos(th)
             -D1*steady_sd/g = (m*R**2 + 4*m0*r**2)*sin(th) + 4*m0*R*r*cos(th)",
        )],
    },
    Equation {
        number: "(44)",
        about: "turning upright: ψ̇² = 2 m₀ g/(3 m R), φ̇ = ψ̇ r/R",
        claims: &[lines_at(
            Unicycle,
            &[("th", "0"), ("m0", "3*m*R*Pd**2/(2*g)"), ("Fd", "Pd*r/R")],
            "steady_w1d = 0
             steady_sd = 0",
        )],
    },
    Equation {
        number: "(45)",
        about: "steady motion without pitch rate",
        claims: &[lines_at(
            Unicycle,
            &[("Fd", "0")],
            "let D1 = 5*m*R**2 + 4*m0*r**2
             D1*steady_w1d = Pd**2*((5*m*R**2 - 4*m0*r**2)*sin(th)*cos(th) + 4*m0*R*r*sin(th)**2) + 4*m*g*R*sin(th) - 4*m0*g*r*cos(th)
             D1*steady_sd = Pd**2*((5*m*r*R**2 - 4*m0*R**2*r + 4*m0*r**3)*cos(th)**2 + 4*m0*R**2*r - 8*m0*R*r**2*sin(th)*cos(th)) - (m*g*R**2 + 4*m0*g*r**2)*sin(th) - 4*m0*g*R*r*cos(th)",
        )],
    },
    Equation {
        number: "(47)",
        about: "height of the sliding mass",
        claims: &[lines(Unicycle, "zA = R*cos(th) + r*sin(th)")],
    },
    Equation {
        number: "(48), appendix C",
        about: "linearised unicycle",
        claims: &[matrix_at(
            Unicycle,
            &[],
            "let D1 = 5*m*R**2 + 4*m0*r**2
             let D2 = 3*m*R**2 + 2*m0*R**2 + 12*m0*r**2
             A12 = 2*R*Pd/D1*(3*m*R*cos(th) + 2*m0*r*sin(th))
             A13 = 2/D1*(2*m*R**2*Pd*sin(th) + 3*m*R**2*Fd + 2*m0*R*r*Pd*sin(th)*tan(th) + 2*m0*R*r*Fd*tan(th) - 4*m0*r**2*Pd*sin(th))
             A14 = 4*m0*R*r*Pd*(Fd + Pd*sin(th))/(D1*cos(th)) + (-m*R**2*Pd**2 + 4*m*g*R*cos(th) - 4*m0*r**2*Pd**2 + 4*m0*g*r*sin(th))/D1
             A16 = 4*m0/D1**2*(5*m*R**3*Pd**2*sin(th)**2 + 5*m*R**3*Pd*Fd*sin(th) - 20*m*R**2*r*Pd**2*sin(th)*cos(th) - 12*m*R**2*r*Pd*Fd*cos(th) - 5*m*g*R**2*cos(th) - 4*m0*R*r**2*Pd**2*sin(th)**2 - 4*m0*R*r**2*Pd*Fd*sin(th) - 8*m*g*R*r*sin(th) + 4*m0*g*r**2*cos(th))
             A21 = -(2*m*R**2*Pd*cos(th) + 2*m0*R**2*Pd*cos(th) + 4*m0*R*r*Pd*sin(th) + 4*m0*R*r*Fd + 8*m0*r**2*Pd*cos(th))/D2
             A25 = 4*m0*R*Pd*cos(th)/D2
             A31 = (-3*m*R**2*Pd*sin(th) - 2*m0*R**2*Pd*sin(th) - 6*m*R**2*Fd - 4*m0*R**2*Fd + 4*m0*R*r*Pd*cos(th) + 12*m0*r**2*Pd*sin(th))/D2
             A35 = -24*m0*r*Pd*cos(th)/D2
             A41 = 1
             A52 = R*Pd*cos(th)/D1*(m*R**2 + 4*m0*R*r*tan(th) - 4*m0*r**2)
             A53 = (m*R**3*Fd - m*R**3*Pd*sin(th) + 10*m*R**2*r*Pd*cos(th) + 4*m0*R**2*r*Pd*sin(th)*tan(th) + 4*m0*R**2*r*Fd*tan(th) - 12*m0*R*r**2*Pd*sin(th) - 4*m0*R*r**2*Fd + 8*m0*r**3*Pd*cos(th))/D1
             A54 = (-2*m*R**3*Pd**2*cos(th) + 8*m0*R**2*r*Pd**2*sin(th) + 8*m0*R**2*r*Pd*Fd - 2*m*g*R**2*cos(th)**2 - 8*m0*R*r**2*Pd**2*cos(th) + 8*m0*g*R*r*sin(th)*cos(th) - 8*m0*g*r**2*cos(th)**2)/(2*D1*cos(th))
             A56 = (25*m**2*R**4*Pd**2*cos(th)**2 + 20*m*m0*R**4*Pd**2*sin(th)**2 + 20*m*m0*R**4*Pd*Fd*sin(th) - 80*m*m0*R**3*r*Pd**2*sin(th)*cos(th) - 48*m*m0*R**3*r*Pd*Fd*cos(th) - 20*m*m0*g*R**3*cos(th) + 40*m*m0*R**2*r**2*Pd**2*cos(th)**2 - 16*m0**2*R**2*r**2*Pd**2*sin(th)**2 - 16*m0**2*R**2*r**2*Pd*Fd*sin(th) - 32*m*m0*g*R**2*r*sin(th) + 16*m0**2*g*R*r**2*cos(th) + 16*m0**2*r**4*Pd**2*cos(th)**2)/D1**2
             A65 = 1
             A73 = 1/cos(th)
             A74 = Pd*tan(th)
             A82 = 1
             A83 = -tan(th)
             A84 = -Pd/cos(th)
             A91 = R*sin(psi)*cos(th)
             A92 = R*cos(psi)
             A97 = -R*(Pd*sin(th) + Fd)*sin(psi)
             A101 = -R*cos(psi)*cos(th)
             A102 = R*sin(psi)
             A107 = R*(Pd*sin(th) + Fd)*cos(psi)
             B1 = 4*R/D1
             B5 = (5*m/m0*R**2 + 4*R**2 + 4*r**2)/D1",
        )],
    },
    Equation {
        number: "(49)",
        about: "characteristic polynomial of the unicycle",
        claims: &[lines(
            Unicycle,
            "c1 = 0
             c2 = -(A12*A21 + A13*A31 + A14 + A25*A52 + A35*A53 + A56)
             c3 = 0
             c4 = A12*A21*A35*A53 + A12*A21*A56 - A12*A31*A25*A53 - A12*A25*A54 + A13*A31*A25*A52 + A13*A31*A56 - A13*A21*A35*A52 - A13*A35*A54 + A14*A25*A52 + A14*A35*A53 + A14*A56 - A16*A21*A52 - A16*A31*A53 - A16*A54
             c5 = 0
             c6 = 0
             c7 = 0
             c8 = 0
             c9 = 0
             c10 = 0",
        )],
    },
    Equation {
        number: "(50)",
        about: "state matrix in straight rolling",
        claims: &[matrix_at(
            Unicycle,
            STRAIGHT,
            "A13 = 6/5*Fd
             A14 = 4*g/(5*R)
             A16 = -4*m0*g/(5*m*R**2)
             A31 = -2*Fd
             A41 = 1
             A53 = R/5*Fd
             A54 = -g/5
             A56 = -4*m0*g/(5*m*R)
             A65 = 1
             A73 = 1
             A82 = 1
             A92 = R
             A101 = -R
             A107 = R*Fd",
        )],
    },
    Equation {
        number: "(51), (52)",
        about: "characteristic polynomial in straight rolling",
        claims: &[lines_at(
            Unicycle,
            STRAIGHT,
            "5*m*R**2*c2 = 12*Fd**2*m*R**2 + 4*(m0 - m)*g*R
             5*m*R**2*c4 = 4*m0*g*(2*Fd**2*R - g)",
        )],
    },
    Equation {
        number: "(53)",
        about: "where b and c change sign: φ̇² = (m − m₀) g/(3 m R) and φ̇² = g/(2 R)",
        claims: &[
            lines_at(
                Unicycle,
                &[("th", "0"), ("r", "0"), ("Pd", "0"), ("psi", "0"), ("g", "3*m*R*Fd**2/(m - m0)")],
                "c2 = 0",
            ),
            lines_at(
                Unicycle,
                &[("th", "0"), ("r", "0"), ("Pd", "0"), ("psi", "0"), ("g", "2*R*Fd**2")],
                "c4 = 0",
            ),
        ],
    },
    Equation {
        number: "(55)",
        about: "input matrix in straight rolling",
        claims: &[matrix_at(
            Unicycle,
            STRAIGHT,
            "B1 = 4/(5*m*R)
             B5 = (5*m + 4*m0)/(5*m*m0)",
        )],
    },
    Equation {
        number: "(58), (59)",
        about: "the angular velocity ω₃ follows the tilt",
        claims: &[lines_at(
            Unicycle,
            STRAIGHT,
            "A31 = -2*Fd*A41
             A41 = 1
             B3 = -2*Fd*B4",
        )],
    },
    Equation {
        number: "(60)",
        about: "reduced system, with ω₃ = −2 φ̇ ϑ",
        claims: &[lines_at(
            Unicycle,
            STRAIGHT,
            "A14 - 2*Fd*A13 = 4*g/(5*R) - 12/5*Fd**2
             A16 = -4*m0*g/(5*m*R**2)
             B1 = 4/(5*m*R)
             A41 = 1
             A54 - 2*Fd*A53 = -(g/5 + 2*R/5*Fd**2)
             A56 = -4*m0*g/(5*m*R)
             B5 = (5*m + 4*m0)/(5*m*m0)
             A65 = 1
             -2*Fd*A73 = -2*Fd
             A101 = -R
             A107 = R*Fd",
        )],
    },
    Equation {
        number: "(73)",
        about: "from the tilted frame to the ground",
        claims: &[lines(Wheel, ROTATION), lines(Unicycle, ROTATION)],
    },
    Equation {
        number: "(76)",
        about: "angular velocity of the wheel",
        claims: &[
            lines(Wheel, ANGULAR_VELOCITY),
            lines(Unicycle, ANGULAR_VELOCITY),
        ],
    },
    Equation {
        number: "(79)",
        about: "generalised velocities from pseudo-velocities",
        claims: &[
            lines(Wheel, IGNORABLE),
            lines(Wheel, "thd = w1"),
            lines(Unicycle, IGNORABLE),
            lines(Unicycle, "thd = w1"),
        ],
    },
    Equation {
        number: "(81)",
        about: "accelerations in the tilted frame",
        claims: &[lines(Wheel, ACCELERATIONS), lines(Unicycle, ACCELERATIONS)],
    },
    Equation {
        number: "(82)",
        about: "acceleration energy of the wheel",
        claims: &[
            energy(
                Wheel,
                "m*R**2/8*(5*w1d**2 + 6*w2d**2 + w3d**2 + (2*w3**2*tan(th) - 12*w2*w3)*w1d
                 + 8*w1*w3*w2d + (4*w1*w2 - 2*w1*w3*tan(th))*w3d)",
            ),
            lines(
                Wheel,
                "dS1 = m*R**2/4*(5*w1d - 6*w2*w3 + w3**2*tan(th))
                 dS2 = m*R**2/2*(3*w2d + 2*w1*w3)
                 dS3 = m*R**2/4*(w3d + 2*w1*w2 - w1*w3*tan(th))",
            ),
        ],
    },
    Equation {
        number: "(83)",
        about: "Appell's equations: derivatives of S are the left-hand sides",
        claims: &[
            lines(
                Wheel,
                "dS1 = left1
                 dS2 = left2
                 dS3 = left3",
            ),
            lines(
                Unicycle,
                "dS1 = left1
                 dS2 = left2
                 dS3 = left3
                 dS4 = left4",
            ),
        ],
    },
    Equation {
        number: "(85)",
        about: "pseudo-forces on the wheel",
        claims: &[lines(
            Wheel,
            "Pi1 = m*g*R*sin(th)
             Pi2 = 0
             Pi3 = 0",
        )],
    },
    Equation {
        number: "(86)",
        about: "pseudo-accelerations of the wheel",
        claims: &[lines(Wheel, WHEEL)],
    },
    Equation {
        number: "(88)",
        about: "acceleration of the sliding mass",
        claims: &[lines(
            Unicycle,
            "aA1 = R*w2d - r*w3d + w1*w3*(R + r*tan(th)) - 2*w3*s
             aA2 = -R*w1d + sd - w1**2*r + w2*w3*R - w3**2*r
             aA3 = r*w1d - w1**2*R + 2*w1*s - w2*w3*R*tan(th) + w3**2*r*tan(th)",
        )],
    },
    Equation {
        number: "(89)",
        about: "acceleration energy of the unicycle",
        claims: &[
            energy(Unicycle, ACCELERATION_ENERGY),
            lines(
                Unicycle,
                "M11 = (5*m*R**2 + 4*m0*(R**2 + r**2))/4
                 M12 = 0
                 M13 = 0
                 M14 = -m0*R
                 M22 = (3*m + 2*m0)*R**2/2
                 M23 = -m0*R*r
                 M24 = 0
                 M32 = -m0*R*r
                 M33 = (m*R**2 + 4*m0*r**2)/4
                 M34 = 0
                 M41 = -m0*R
                 M44 = m0
                 b1 = (8*w1*s*m0*r + w3**2*(4*m0*r**2*tan(th) + 4*m0*R*r + m*R**2*tan(th)) - w2*w3*(6*m*R**2 + 4*m0*R**2 + 4*m0*R*r*tan(th)))/4
                 b2 = w1*w3*(m*R**2 + m0*R**2 + m0*R*r*tan(th)) - 2*w3*s*m0*R
                 b3 = (2*w1*w2*m*R**2 - w1*w3*(m*R**2 + 4*m0*r**2)*tan(th) - 4*w1*w3*m0*R*r + 8*w3*s*m0*r)/4
                 b4 = -m0*(w1**2*r - w2*w3*R + w3**2*r)",
            ),
        ],
    },
    Equation {
        number: "(91)",
        about: "pseudo-forces on the unicycle",
        claims: &[lines(
            Unicycle,
            "Pi1 = (m + m0)*g*R*sin(th) - m0*g*r*cos(th)
             Pi2 = 0
             Pi3 = 0
             Pi4 = u - m0*g*sin(th)",
        )],
    },
];
