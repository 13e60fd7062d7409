/// The spec this module is made from.
pub const SPEC: &str = r##"# A spec with "quotes" and "#.
name = 'unicycle'
"##;

use ::appell_runtime::Real;

/// Pseudo-velocities and coordinates.
static STATES: [::appell_runtime::model::Quantity; 10] = [
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("omega_1"),
        about: ::appell_runtime::model::Text::Borrowed("Tilt rate of the wheel."),
        unit: ::appell_runtime::model::Text::Borrowed("rad/s"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("omega_2"),
        about: ::appell_runtime::model::Text::Borrowed(
            "Spin of the wheel about its axle.",
        ),
        unit: ::appell_runtime::model::Text::Borrowed("rad/s"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("omega_3"),
        about: ::appell_runtime::model::Text::Borrowed(
            "Turn rate about the wheel's vertical.",
        ),
        unit: ::appell_runtime::model::Text::Borrowed("rad/s"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("sigma"),
        about: ::appell_runtime::model::Text::Borrowed(
            "Speed of the mass along its guide.",
        ),
        unit: ::appell_runtime::model::Text::Borrowed("m/s"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("theta"),
        about: ::appell_runtime::model::Text::Borrowed("Tilt."),
        unit: ::appell_runtime::model::Text::Borrowed("rad"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("r"),
        about: ::appell_runtime::model::Text::Borrowed(
            "Position of the mass on its guide.",
        ),
        unit: ::appell_runtime::model::Text::Borrowed("m"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("psi"),
        about: ::appell_runtime::model::Text::Borrowed("Yaw."),
        unit: ::appell_runtime::model::Text::Borrowed("rad"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("phi"),
        about: ::appell_runtime::model::Text::Borrowed("Rotation of the wheel."),
        unit: ::appell_runtime::model::Text::Borrowed("rad"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("x_G"),
        about: ::appell_runtime::model::Text::Borrowed(
            "Position of the wheel's centre.",
        ),
        unit: ::appell_runtime::model::Text::Borrowed("m"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("y_G"),
        about: ::appell_runtime::model::Text::Borrowed(
            "Position of the wheel's centre.",
        ),
        unit: ::appell_runtime::model::Text::Borrowed("m"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
];

/// Inputs and signals.
static INPUTS: [::appell_runtime::model::Quantity; 1] = [
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("u"),
        about: ::appell_runtime::model::Text::Borrowed("Force on the moving mass."),
        unit: ::appell_runtime::model::Text::Borrowed("N"),
        scale: 1.0,
        value: 0.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
];

/// Parameters.
static PARAMETERS: [::appell_runtime::model::Quantity; 4] = [
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("m"),
        about: ::appell_runtime::model::Text::Borrowed("Mass of the wheel."),
        unit: ::appell_runtime::model::Text::Borrowed("kg"),
        scale: 1.0,
        value: 10.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("m0"),
        about: ::appell_runtime::model::Text::Borrowed("Moving mass."),
        unit: ::appell_runtime::model::Text::Borrowed("kg"),
        scale: 1.0,
        value: 5.0,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("R"),
        about: ::appell_runtime::model::Text::Borrowed("Radius of the wheel."),
        unit: ::appell_runtime::model::Text::Borrowed("m"),
        scale: 1.0,
        value: 0.3,
        range: [-f64::INFINITY, f64::INFINITY],
    },
    ::appell_runtime::model::Quantity {
        name: ::appell_runtime::model::Text::Borrowed("g"),
        about: ::appell_runtime::model::Text::Borrowed("Gravity."),
        unit: ::appell_runtime::model::Text::Borrowed("m/s²"),
        scale: 1.0,
        value: 9.81,
        range: [-f64::INFINITY, f64::INFINITY],
    },
];

/// Outputs.
static OUTPUTS: [::appell_runtime::model::Quantity; 0] = [];

/// Tabulated functions of time.
static SIGNALS: [::appell_runtime::model::SignalTable; 0] = [];

/// Signal and order of derivative behind the inputs that are signals.
static SIGNAL_INPUTS: [(usize, u8); 0] = [];

/// Constraint rows.
static CONSTRAINT_ROWS: [::appell_runtime::model::Text; 0] = [];

/// Reactions in the ground.
static REACTIONS: [::appell_runtime::model::Text; 0] = [];

/// Names, units and sizes of the model.
pub static INFO: ::appell_runtime::model::ModelInfo = ::appell_runtime::model::ModelInfo {
    name: ::appell_runtime::model::Text::Borrowed("unicycle"),
    title: ::appell_runtime::model::Text::Borrowed("The mechanism unicycle."),
    source: ::appell_runtime::model::Text::Borrowed(""),
    states: ::appell_runtime::model::List::Borrowed(&STATES),
    speeds: 4,
    inputs: ::appell_runtime::model::List::Borrowed(&INPUTS),
    declared_inputs: 1,
    signals: ::appell_runtime::model::List::Borrowed(&SIGNALS),
    signal_inputs: ::appell_runtime::model::List::Borrowed(&SIGNAL_INPUTS),
    parameters: ::appell_runtime::model::List::Borrowed(&PARAMETERS),
    outputs: ::appell_runtime::model::List::Borrowed(&OUTPUTS),
    constraint_rows: ::appell_runtime::model::List::Borrowed(&CONSTRAINT_ROWS),
    reactions: ::appell_runtime::model::List::Borrowed(&REACTIONS),
    explicit_time: false,
};

/// Parameters, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters<T> {
    /// Mass of the wheel. Unit: kg.
    pub m: T,
    /// Moving mass. Unit: kg.
    pub m0: T,
    /// Radius of the wheel. Unit: m.
    pub R: T,
    /// Gravity. Unit: m/s².
    pub g: T,
}

impl<T> From<[T; 4]> for Parameters<T> {
    fn from([m, m0, R, g]: [T; 4]) -> Self {
        Self { m, m0, R, g }
    }
}

impl<T> From<Parameters<T>> for [T; 4] {
    fn from(Parameters { m, m0, R, g }: Parameters<T>) -> Self {
        [m, m0, R, g]
    }
}

impl Default for Parameters<f64> {
    /// The values of the spec.
    fn default() -> Self {
        Self {
            m: 10.0,
            m0: 5.0,
            R: 0.3,
            g: 9.81,
        }
    }
}

/// One number per pseudo-velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speeds<T> {
    /// Tilt rate of the wheel. Unit: rad/s.
    pub omega_1: T,
    /// Spin of the wheel about its axle. Unit: rad/s.
    pub omega_2: T,
    /// Turn rate about the wheel's vertical. Unit: rad/s.
    pub omega_3: T,
    /// Speed of the mass along its guide. Unit: m/s.
    pub sigma: T,
}

impl<T> From<[T; 4]> for Speeds<T> {
    fn from([omega_1, omega_2, omega_3, sigma]: [T; 4]) -> Self {
        Self {
            omega_1,
            omega_2,
            omega_3,
            sigma,
        }
    }
}

impl<T> From<Speeds<T>> for [T; 4] {
    fn from(Speeds { omega_1, omega_2, omega_3, sigma }: Speeds<T>) -> Self {
        [omega_1, omega_2, omega_3, sigma]
    }
}

/// One number per coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinates<T> {
    /// Tilt. Unit: rad.
    pub theta: T,
    /// Position of the mass on its guide. Unit: m.
    pub r: T,
    /// Yaw. Unit: rad.
    pub psi: T,
    /// Rotation of the wheel. Unit: rad.
    pub phi: T,
    /// Position of the wheel's centre. Unit: m.
    pub x_G: T,
    /// Position of the wheel's centre. Unit: m.
    pub y_G: T,
}

impl<T> From<[T; 6]> for Coordinates<T> {
    fn from([theta, r, psi, phi, x_G, y_G]: [T; 6]) -> Self {
        Self {
            theta,
            r,
            psi,
            phi,
            x_G,
            y_G,
        }
    }
}

impl<T> From<Coordinates<T>> for [T; 6] {
    fn from(Coordinates { theta, r, psi, phi, x_G, y_G }: Coordinates<T>) -> Self {
        [theta, r, psi, phi, x_G, y_G]
    }
}

/// The state, or its rates: pseudo-velocities, then coordinates. In SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State<T> {
    /// Tilt rate of the wheel. Unit: rad/s.
    pub omega_1: T,
    /// Spin of the wheel about its axle. Unit: rad/s.
    pub omega_2: T,
    /// Turn rate about the wheel's vertical. Unit: rad/s.
    pub omega_3: T,
    /// Speed of the mass along its guide. Unit: m/s.
    pub sigma: T,
    /// Tilt. Unit: rad.
    pub theta: T,
    /// Position of the mass on its guide. Unit: m.
    pub r: T,
    /// Yaw. Unit: rad.
    pub psi: T,
    /// Rotation of the wheel. Unit: rad.
    pub phi: T,
    /// Position of the wheel's centre. Unit: m.
    pub x_G: T,
    /// Position of the wheel's centre. Unit: m.
    pub y_G: T,
}

impl<T> From<[T; 10]> for State<T> {
    fn from(
        [omega_1,
        omega_2,
        omega_3,
        sigma,
        theta,
        r,
        psi,
        phi,
        x_G,
        y_G,
        ]: [T; 10],
    ) -> Self {
        Self {
            omega_1,
            omega_2,
            omega_3,
            sigma,
            theta,
            r,
            psi,
            phi,
            x_G,
            y_G,
        }
    }
}

impl<T> From<State<T>> for [T; 10] {
    fn from(
        State {
            omega_1,
            omega_2,
            omega_3,
            sigma,
            theta,
            r,
            psi,
            phi,
            x_G,
            y_G,
        }: State<T>,
    ) -> Self {
        [omega_1, omega_2, omega_3, sigma, theta, r, psi, phi, x_G, y_G]
    }
}

/// Inputs, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs<T> {
    /// Force on the moving mass. Unit: N.
    pub u: T,
}

impl<T> From<[T; 1]> for Inputs<T> {
    fn from([u]: [T; 1]) -> Self {
        Self { u }
    }
}

impl<T> From<Inputs<T>> for [T; 1] {
    fn from(Inputs { u }: Inputs<T>) -> Self {
        [u]
    }
}

/// Result of [`acceleration_energy`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelerationEnergy<T> {
    /// Sum over the bodies, in W/s.
    pub total: T,
    /// Of `wheel`, in W/s.
    pub wheel: T,
    /// Of `mass`, in W/s.
    pub mass: T,
}

/// Result of [`jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobians<T> {
    /// ẋ, the rates of the state.
    pub rates: State<T>,
    /// A = ∂ẋ/∂x. Rows and columns follow [`State`].
    pub a: [[T; 10]; 10],
    /// B = ∂ẋ/∂u. Rows follow [`State`], columns [`Inputs`].
    pub b: [[T; 1]; 10],
}

/// Result of [`all_jacobians`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AllJacobians<T> {
    /// ẋ, the rates of the state.
    pub rates: State<T>,
    /// A = ∂ẋ/∂x. Rows and columns follow [`State`].
    pub a: [[T; 10]; 10],
    /// B = ∂ẋ/∂u. Rows follow [`State`], columns [`Inputs`].
    pub b: [[T; 1]; 10],
    /// P = ∂ẋ/∂p. Rows follow [`State`], columns [`Parameters`].
    pub p: [[T; 4]; 10],
}

/// Result of [`energies`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies<T> {
    /// Kinetic energy in J.
    pub kinetic: T,
    /// Potential energy in J.
    pub potential: T,
    /// Power of the loads without a potential, in W.
    pub power: T,
}

/// Generalised velocities q̇ of pseudo-velocities and coordinates.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 12 (3 +, 8 ×, 1 ÷), 2 sine-cosine pairs.
#[must_use]
#[inline]
pub fn kinematics<T: Real>(
    p: &Parameters<T>,
    x: &State<T>,
    _inputs: &Inputs<T>,
) -> Coordinates<T> {
    let &Parameters { R, .. } = p;
    let &State { omega_1, omega_2, omega_3, sigma, theta, psi, .. } = x;

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();

    // Coordinate rates.
    let psi_dot = omega_3 / cos_theta;
    let phi_dot = omega_2 - psi_dot * sin_theta;
    let R_omega_2 = R * omega_2;
    let R_cos_theta_omega_1 = R * cos_theta * omega_1;
    let x_G_dot = cos_psi * R_omega_2 + sin_psi * R_cos_theta_omega_1;
    let y_G_dot = R_omega_2 * sin_psi - cos_psi * R_cos_theta_omega_1;

    Coordinates {
        theta: omega_1,
        r: sigma,
        psi: psi_dot,
        phi: phi_dot,
        x_G: x_G_dot,
        y_G: y_G_dot,
    }
}

/// Acceleration energy S (Gibbs function) at the actual motion.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 46 (14 +, 30 ×, 2 ÷), 1 sine-cosine pair.
#[must_use]
#[inline]
pub fn acceleration_energy<T: Real>(
    p: &Parameters<T>,
    x: &State<T>,
    inputs: &Inputs<T>,
) -> AccelerationEnergy<T> {
    let &Parameters { m, m0, R, g } = p;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, .. } = x;
    let &Inputs { u } = inputs;
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let five_eighths = T::constant(0.625);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let m_R_R = m * R * R;

    // Total.
    let m0_r = m0 * r;
    let omega_3_squared = omega_3 * omega_3;
    let R_omega_3 = R * omega_3;
    let R_omega_3_omega_2 = R_omega_3 * omega_2;
    let g_sin_theta = g * sin_theta;
    let omega_1_dot_part_1 = R_omega_3_omega_2 + g_sin_theta;
    let omega_1_dot_part_2 = r * (omega_3_squared + omega_1 * omega_1);
    let omega_1_dot_part_3 = sin_theta * omega_3 / cos_theta;
    let omega_1_dot_part_4 = g_sin_theta + three_halves * R_omega_3_omega_2;
    let omega_1_dot_part_5 = quarter * R_omega_3 * omega_1_dot_part_3;
    let omega_1_dot_part_6 = u + m0 * (omega_1_dot_part_2 - omega_1_dot_part_1);
    let omega_1_dot_part_7 = m * (omega_1_dot_part_4 - omega_1_dot_part_5);
    let omega_1_dot_part_8 = omega_1_dot_part_6 + omega_1_dot_part_7;
    let omega_1_dot_part_9 = omega_1_dot_part_8 + m0 * omega_1_dot_part_1;
    let omega_1_dot_part_10 = m0_r * (omega_3_squared - omega_1_dot_part_3 * omega_2);
    let omega_1_dot_part_11 = g * cos_theta + omega_1_dot_part_3 * r * omega_3;
    let omega_1_dot_part_12 = R * (omega_1_dot_part_9 - omega_1_dot_part_10);
    let omega_1_dot_part_13 = m0_r * (omega_1_dot_part_11 + two * omega_1 * sigma);
    let omega_1_dot_part_14 = omega_1_dot_part_12 - omega_1_dot_part_13;
    let omega_1_dot = omega_1_dot_part_14 / (m0_r * r + five_quarters * m_R_R);
    let s_wheel = five_eighths * m_R_R * omega_1_dot * omega_1_dot;

    AccelerationEnergy {
        total: s_wheel,
        wheel: s_wheel,
        mass: zero,
    }
}

/// Mass matrix M = ∂²S/∂ω̇², symmetric. Rows and columns follow [`Speeds`].
///
/// ```text
///     ⎡ 5/4 m R² + m₀ R² + m₀ r²   ·                  ·                −m₀ R ⎤
///     ⎢ ·                          3/2 m R² + m₀ R²   −m₀ R r          ·     ⎥
/// M = ⎢ ·                          −m₀ R r            ¼ m R² + m₀ r²   ·     ⎥
///     ⎣ −m₀ R                      ·                  ·                m₀    ⎦
/// ```
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 18 (4 +, 10 ×, 4 sign).
#[must_use]
#[inline]
pub fn mass_matrix<T: Real>(
    p: &Parameters<T>,
    x: &State<T>,
    _inputs: &Inputs<T>,
) -> [[T; 4]; 4] {
    let &Parameters { m, m0, R, .. } = p;
    let &State { r, .. } = x;
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);

    // Combinations of parameters.
    let R_squared = R * R;
    let m0_R_squared = m0 * R_squared;
    let m_R_squared = m * R_squared;
    let minus_M_omega_1_sigma = m0 * R;
    let M_omega_2_omega_2 = m0_R_squared + three_halves * m_R_squared;

    // Mass matrix.
    let m0_r = m0 * r;
    let m0_r_r = m0_r * r;
    let M_omega_1_omega_1 = m0_r_r + m0_R_squared + five_quarters * m_R_squared;
    let minus_M_omega_2_omega_3 = R * m0_r;
    let M_omega_3_omega_3 = m0_r_r + quarter * m_R_squared;

    [
        [M_omega_1_omega_1, zero, zero, -minus_M_omega_1_sigma],
        [zero, M_omega_2_omega_2, -minus_M_omega_2_omega_3, zero],
        [zero, -minus_M_omega_2_omega_3, M_omega_3_omega_3, zero],
        [-minus_M_omega_1_sigma, zero, zero, m0],
    ]
}

/// Bias b: what is left of ∂S/∂ω̇ where the pseudo-accelerations vanish.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 49 (14 +, 33 ×, 1 ÷, 1 sign), 1 sine-cosine pair.
#[must_use]
#[inline]
pub fn bias<T: Real>(p: &Parameters<T>, x: &State<T>, _inputs: &Inputs<T>) -> Speeds<T> {
    let &Parameters { m, m0, R, .. } = p;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, .. } = x;
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Bias.
    let m0_r = m0 * r;
    let m0_r_omega_1 = m0_r * omega_1;
    let two_sigma = two * sigma;
    let tan_theta = sin_theta / cos_theta;
    let m0_r_omega_3 = m0_r * omega_3;
    let R_omega_3 = R * omega_3;
    let R_omega_2 = R * omega_2;
    let bias_omega_1_part_1 = tan_theta * (m0_r * omega_2 - quarter * m * R_omega_3);
    let bias_omega_1_part_2 = m0_r_omega_3 - bias_omega_1_part_1;
    let bias_omega_1_part_3 = R_omega_2 * (m0 + three_halves * m);
    let tan_theta_m0_r_omega_3_r = tan_theta * m0_r_omega_3 * r;
    let bias_omega_1_part_4 = R * (bias_omega_1_part_2 - bias_omega_1_part_3);
    let bias_omega_1_part_5 = tan_theta_m0_r_omega_3_r + bias_omega_1_part_4;
    let bias_omega_1 = m0_r_omega_1 * two_sigma + omega_3 * bias_omega_1_part_5;
    let R_omega_1 = R * omega_1;
    let m_R_omega_1 = m * R_omega_1;
    let bias_omega_2_part_1 = two_sigma - R_omega_1;
    let bias_omega_2_part_2 = m0_r_omega_1 * tan_theta + m_R_omega_1;
    let bias_omega_2_part_3 = bias_omega_2_part_2 - m0 * bias_omega_2_part_1;
    let bias_omega_2 = R_omega_3 * bias_omega_2_part_3;
    let bias_omega_3_part_1 = m0_r_omega_1 * r + quarter * R * m_R_omega_1;
    let bias_omega_3_part_2 = m0_r * bias_omega_2_part_1;
    let bias_omega_3_part_3 = bias_omega_3_part_2 - tan_theta * bias_omega_3_part_1;
    let bias_omega_3_part_4 = half * R_omega_2 * m_R_omega_1;
    let bias_omega_3 = bias_omega_3_part_4 + omega_3 * bias_omega_3_part_3;
    let m0_r_omega_1_omega_1 = m0_r_omega_1 * omega_1;
    let bias_sigma_part_1 = omega_3 * (m0_r_omega_3 - m0 * R_omega_2);
    let minus_bias_sigma = m0_r_omega_1_omega_1 + bias_sigma_part_1;

    Speeds {
        omega_1: bias_omega_1,
        omega_2: bias_omega_2,
        omega_3: bias_omega_3,
        sigma: -minus_bias_sigma,
    }
}

/// Generalised forces Π: virtual power of the loads per pseudo-velocity.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 10 (3 +, 7 ×), 1 sine-cosine pair.
#[must_use]
#[inline]
pub fn generalized_forces<T: Real>(
    p: &Parameters<T>,
    x: &State<T>,
    inputs: &Inputs<T>,
) -> Speeds<T> {
    let &Parameters { m, m0, R, g } = p;
    let &State { theta, r, .. } = x;
    let &Inputs { u } = inputs;
    let zero = T::constant(0.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();

    // Combinations of parameters.
    let g_m0 = g * m0;

    // Generalized forces.
    let R_sin_theta = R * sin_theta;
    let g_m_R_sin_theta = g * m * R_sin_theta;
    let force_omega_1 = g_m_R_sin_theta + g_m0 * (R_sin_theta - cos_theta * r);
    let force_sigma = u - sin_theta * g_m0;

    Speeds {
        omega_1: force_omega_1,
        omega_2: zero,
        omega_3: zero,
        sigma: force_sigma,
    }
}

/// Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 100 (32 +, 64 ×, 4 ÷), 2 sine-cosine pairs.
#[must_use]
#[inline]
pub fn rates<T: Real>(p: &Parameters<T>, x: &State<T>, inputs: &Inputs<T>) -> State<T> {
    let &Parameters { m, m0, R, g } = p;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, psi, .. } = x;
    let &Inputs { u } = inputs;
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let one = T::constant(1.0);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();

    // Combinations of parameters.
    let R_m0 = R * m0;
    let R_R_m0 = R * R_m0;
    let R_m = R * m;
    let R_R_m = R * R_m;
    let M_22 = R_R_m0 + three_halves * R_R_m;

    // Rates.
    let m0_r = m0 * r;
    let m0_r_r = m0_r * r;
    let M_11 = R_R_m0 + m0_r_r + five_quarters * R_R_m;
    let m0_r_omega_3 = m0_r * omega_3;
    let m0_r_omega_3_omega_3 = m0_r_omega_3 * omega_3;
    let m0_r_omega_1 = m0_r * omega_1;
    let g_sin_theta = g * sin_theta;
    let R_omega_3 = R * omega_3;
    let R_omega_3_omega_2 = R_omega_3 * omega_2;
    let f_4_part_1 = m0_r_omega_3_omega_3 + m0_r_omega_1 * omega_1 + u;
    let f_4 = f_4_part_1 - m0 * (g_sin_theta + R_omega_3_omega_2);
    let inv_cos_theta = one / cos_theta;
    let tan_theta = sin_theta * inv_cos_theta;
    let tan_theta_r = tan_theta * r;
    let two_sigma = two * sigma;
    let R_m0_plus_m0_r_tan_theta = R_m0 + m0_r * tan_theta;
    let f_1_part_1 = three_halves * R_m + R_m0_plus_m0_r_tan_theta;
    let quarter_tan_theta = quarter * tan_theta;
    let f_1_part_2 = R_omega_3 * (m0_r_omega_3 + m * R_omega_3 * quarter_tan_theta);
    let f_1_part_3 = R_omega_3_omega_2 * f_1_part_1 + g_sin_theta * (R_m0 + R_m);
    let f_1_part_4 = f_1_part_3 - g * m0_r * cos_theta
        - m0_r_omega_3_omega_3 * tan_theta_r;
    let f_1 = f_1_part_4 - m0_r_omega_1 * two_sigma - f_1_part_2;
    let omega_1_dot = (R * f_4 + f_1) / (M_11 - R_R_m0);
    let R_omega_3_omega_1 = R_omega_3 * omega_1;
    let R_m_R_omega_3_omega_1 = R_m * R_omega_3_omega_1;
    let f_3_part_1 = m0_r * R_omega_3_omega_1
        + quarter_tan_theta * R_m_R_omega_3_omega_1;
    let f_3_part_2 = f_3_part_1 - half * R_R_m * omega_1 * omega_2;
    let f_3 = f_3_part_2 - m0_r_omega_3 * (two_sigma - tan_theta_r * omega_1);
    let R_m0_r = R * m0_r;
    let f_2_part_1 = m0 * R_omega_3 * two_sigma - R_m_R_omega_3_omega_1;
    let f_2 = f_2_part_1 - R_m0_plus_m0_r_tan_theta * R_omega_3_omega_1;
    let M_33 = m0_r_r + quarter * R_R_m;
    let omega_2_dot_part_1 = one / (M_33 * M_22 - R_m0_r * R_m0_r);
    let omega_2_dot = omega_2_dot_part_1 * (f_3 * R_m0_r + f_2 * M_33);
    let omega_3_dot = omega_2_dot_part_1 * (R_m0_r * f_2 + f_3 * M_22);
    let sigma_dot = f_4 / m0 + R * omega_1_dot;
    let psi_dot = inv_cos_theta * omega_3;
    let phi_dot = omega_2 - tan_theta * omega_3;
    let R_omega_2 = R * omega_2;
    let R_cos_theta_omega_1 = R * cos_theta * omega_1;
    let x_G_dot = cos_psi * R_omega_2 + sin_psi * R_cos_theta_omega_1;
    let y_G_dot = R_omega_2 * sin_psi - cos_psi * R_cos_theta_omega_1;

    State {
        omega_1: omega_1_dot,
        omega_2: omega_2_dot,
        omega_3: omega_3_dot,
        sigma: sigma_dot,
        theta: omega_1,
        r: sigma,
        psi: psi_dot,
        phi: phi_dot,
        x_G: x_G_dot,
        y_G: y_G_dot,
    }
}

/// Rates ẋ with their derivatives by state and inputs.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 285 (79 +, 192 ×, 4 ÷, 10 sign), 2 sine-cosine pairs.
#[must_use]
#[inline]
pub fn jacobians<T: Real>(
    p: &Parameters<T>,
    x: &State<T>,
    inputs: &Inputs<T>,
) -> Jacobians<T> {
    let &Parameters { m, m0, R, g } = p;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, psi, .. } = x;
    let &Inputs { u } = inputs;
    let minus_two = T::constant(-2.0);
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let one = T::constant(1.0);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();

    // Combinations of parameters.
    let R_m0 = R * m0;
    let R_R_m0 = R * R_m0;
    let R_m = R * m;
    let three_halves_R_m = three_halves * R_m;
    let half_R_m = half * R_m;
    let quarter_R_m = quarter * R_m;
    let M_22 = R_R_m0 + R * three_halves_R_m;
    let inv_m0 = one / m0;

    // Rates.
    let m0_r = m0 * r;
    let m0_r_r = m0_r * r;
    let M_11 = R_R_m0 + m0_r_r + five_quarters * R * R_m;
    let inv_M_11_minus_R_R_m0 = one / (M_11 - R_R_m0);
    let g_sin_theta = g * sin_theta;
    let r_omega_3 = r * omega_3;
    let r_omega_3_omega_3 = r_omega_3 * omega_3;
    let R_omega_3 = R * omega_3;
    let R_omega_3_omega_2 = R_omega_3 * omega_2;
    let r_omega_1 = r * omega_1;
    let f_4_part_1 = g_sin_theta + R_omega_3_omega_2 - r_omega_3_omega_3;
    let f_4 = u - m0 * (f_4_part_1 - r_omega_1 * omega_1);
    let a_psi_omega_3 = one / cos_theta;
    let minus_a_phi_omega_3 = sin_theta * a_psi_omega_3;
    let f_1_part_1 = R_omega_3 * minus_a_phi_omega_3;
    let m_R_omega_3 = m * R_omega_3;
    let quarter_m_R_omega_3 = quarter * m_R_omega_3;
    let R_omega_2 = R * omega_2;
    let f_1_part_2 = minus_a_phi_omega_3 * omega_3;
    let f_1_part_3 = r_omega_3 * f_1_part_2;
    let g_cos_theta = g * cos_theta;
    let two_sigma = two * sigma;
    let f_1_part_4 = g_cos_theta + R_omega_3 * omega_3 + two_sigma * omega_1;
    let f_1_part_5 = f_1_part_4 - f_1_part_1 * omega_2;
    let f_1_part_6 = R * g_sin_theta + R_omega_3 * R_omega_2;
    let f_1_part_7 = R_m * g_sin_theta + R_omega_3_omega_2 * three_halves_R_m;
    let f_1_part_8 = f_1_part_7 + m0 * (f_1_part_6 - r * (f_1_part_3 + f_1_part_5));
    let f_1 = f_1_part_8 - f_1_part_1 * quarter_m_R_omega_3;
    let omega_1_dot = inv_M_11_minus_R_R_m0 * (R * f_4 + f_1);
    let R_m0_r = R * m0_r;
    let R_omega_1 = R * omega_1;
    let R_omega_1_half_R_m = R_omega_1 * half_R_m;
    let R_m0_r_omega_1 = R_m0_r * omega_1;
    let two_m0_r = two * m0_r;
    let m0_r_omega_1 = m0_r * omega_1;
    let f_3_part_1 = m0_r_omega_1 * r + R_omega_1 * quarter_R_m;
    let f_3_part_2 = R_m0_r_omega_1 + minus_a_phi_omega_3 * f_3_part_1;
    let d_f_3_d_omega_3 = f_3_part_2 - two_m0_r * sigma;
    let f_3 = d_f_3_d_omega_3 * omega_3 - R_omega_1_half_R_m * omega_2;
    let f_2_part_1 = f_1_part_2 * m0_r_omega_1;
    let m0_R_omega_3 = m0 * R_omega_3;
    let f_2_part_2 = m0_R_omega_3 * omega_1 - m0 * two_sigma * omega_3;
    let minus_f_2 = R * (f_2_part_1 + m_R_omega_3 * omega_1 + f_2_part_2);
    let M_33 = m0_r_r + R * quarter_R_m;
    let omega_2_dot_part_1 = one / (R_m0_r * R_m0_r - M_33 * M_22);
    let omega_2_dot = omega_2_dot_part_1 * (minus_f_2 * M_33 - R_m0_r * f_3);
    let omega_3_dot = omega_2_dot_part_1 * (R_m0_r * minus_f_2 - f_3 * M_22);
    let sigma_dot = f_4 * inv_m0 + R * omega_1_dot;
    let psi_dot = a_psi_omega_3 * omega_3;
    let phi_dot = omega_2 - f_1_part_2;
    let cos_theta_R_omega_1 = cos_theta * R_omega_1;
    let x_G_dot = R_omega_2 * cos_psi + sin_psi * cos_theta_R_omega_1;
    let y_G_dot = R_omega_2 * sin_psi - cos_psi * cos_theta_R_omega_1;

    // Derivatives by the state.
    let a_omega_1_omega_1_part_1 = m0_r * sigma - R_m0_r_omega_1;
    let a_omega_1_omega_1_part_2 = minus_two * inv_M_11_minus_R_R_m0;
    let a_omega_1_omega_1 = a_omega_1_omega_1_part_1 * a_omega_1_omega_1_part_2;
    let a_omega_1_omega_2_part_1 = m0_r * f_1_part_1;
    let a_omega_1_omega_2_part_2 = R_omega_3 * three_halves_R_m;
    let a_omega_1_omega_2_part_3 = a_omega_1_omega_2_part_1 + a_omega_1_omega_2_part_2;
    let a_omega_1_omega_2 = inv_M_11_minus_R_R_m0 * a_omega_1_omega_2_part_3;
    let a_omega_1_omega_3_part_1 = f_1_part_2 * r;
    let a_omega_1_omega_3_part_2 = three_halves_R_m + m0_r * minus_a_phi_omega_3;
    let a_omega_1_omega_3_part_3 = half * m * f_1_part_1;
    let a_omega_1_omega_3_part_4 = omega_2 * a_omega_1_omega_3_part_2;
    let a_omega_1_omega_3_part_5 = a_omega_1_omega_3_part_3 - a_omega_1_omega_3_part_4;
    let a_omega_1_omega_3_part_6 = two_m0_r * a_omega_1_omega_3_part_1;
    let a_omega_1_omega_3_part_7 = R * a_omega_1_omega_3_part_5;
    let a_omega_1_omega_3_part_8 = a_omega_1_omega_3_part_6 + a_omega_1_omega_3_part_7;
    let minus_a_omega_1_omega_3 = inv_M_11_minus_R_R_m0 * a_omega_1_omega_3_part_8;
    let a_omega_1_sigma = m0_r_omega_1 * a_omega_1_omega_1_part_2;
    let a_psi_omega_3_squared = a_psi_omega_3 * a_psi_omega_3;
    let a_omega_1_theta_part_1 = R_omega_3 * a_psi_omega_3_squared;
    let a_omega_1_theta_part_2 = g_sin_theta + a_omega_1_theta_part_1 * omega_2;
    let a_omega_1_theta_part_3 = r_omega_3_omega_3 * a_psi_omega_3_squared;
    let a_omega_1_theta_part_4 = a_omega_1_theta_part_2 - a_omega_1_theta_part_3;
    let a_omega_1_theta_part_5 = R_m * g_cos_theta + m0_r * a_omega_1_theta_part_4;
    let a_omega_1_theta_part_6 = quarter_m_R_omega_3 * a_omega_1_theta_part_1;
    let a_omega_1_theta_part_7 = a_omega_1_theta_part_5 - a_omega_1_theta_part_6;
    let a_omega_1_theta = inv_M_11_minus_R_R_m0 * a_omega_1_theta_part_7;
    let d_f_4_d_r = m0 * (omega_1 * omega_1 + omega_3 * omega_3);
    let R_d_f_4_d_r = R * d_f_4_d_r;
    let d_omega_1_dot_d_r_part_1 = R_d_f_4_d_r - m0 * (f_1_part_5 + two * f_1_part_3);
    let d_omega_1_dot_d_r_part_2 = d_omega_1_dot_d_r_part_1 - omega_1_dot * two_m0_r;
    let d_omega_1_dot_d_r = inv_M_11_minus_R_R_m0 * d_omega_1_dot_d_r_part_2;
    let minus_d_f_2_d_omega_1 = a_omega_1_omega_2_part_1 + R_omega_3 * (R_m0 + R_m);
    let a_omega_2_omega_1_part_1 = f_1_part_1 * quarter_R_m;
    let a_omega_2_omega_1_part_2 = m0_r * (R_omega_3 + a_omega_1_omega_3_part_1);
    let a_omega_2_omega_1_part_3 = a_omega_2_omega_1_part_1 + a_omega_2_omega_1_part_2;
    let d_f_3_d_omega_1 = a_omega_2_omega_1_part_3 - R_omega_2 * half_R_m;
    let a_omega_2_omega_1_part_4 = M_33 * minus_d_f_2_d_omega_1;
    let a_omega_2_omega_1_part_5 = a_omega_2_omega_1_part_4 - R_m0_r * d_f_3_d_omega_1;
    let a_omega_2_omega_1 = omega_2_dot_part_1 * a_omega_2_omega_1_part_5;
    let a_omega_2_omega_2_part_1 = R_omega_1_half_R_m * omega_2_dot_part_1;
    let a_omega_2_omega_2 = R_m0_r * a_omega_2_omega_2_part_1;
    let a_omega_2_omega_3_part_1 = minus_a_phi_omega_3 * m0_r_omega_1 + R_m * omega_1;
    let a_omega_2_omega_3_part_2 = m0 * (two_sigma - R_omega_1);
    let minus_d_f_2_d_omega_3 = R
        * (a_omega_2_omega_3_part_1 - a_omega_2_omega_3_part_2);
    let a_omega_2_omega_3_part_3 = M_33 * minus_d_f_2_d_omega_3;
    let a_omega_2_omega_3_part_4 = a_omega_2_omega_3_part_3 - R_m0_r * d_f_3_d_omega_3;
    let a_omega_2_omega_3 = omega_2_dot_part_1 * a_omega_2_omega_3_part_4;
    let a_omega_2_sigma_part_1 = two * omega_2_dot_part_1;
    let a_omega_2_sigma_part_2 = m0_r * m0_r * R_omega_3 - m0_R_omega_3 * M_33;
    let a_omega_2_sigma = a_omega_2_sigma_part_1 * a_omega_2_sigma_part_2;
    let a_omega_2_theta_part_1 = m0_r_omega_1 * a_omega_1_theta_part_1;
    let a_omega_2_theta_part_2 = r_omega_3 * m0_r_omega_1 * a_psi_omega_3_squared;
    let a_omega_2_theta_part_3 = quarter_R_m * a_omega_1_theta_part_1 * omega_1;
    let d_f_3_d_theta = a_omega_2_theta_part_2 + a_omega_2_theta_part_3;
    let a_omega_2_theta_part_4 = M_33 * a_omega_2_theta_part_1;
    let a_omega_2_theta_part_5 = a_omega_2_theta_part_4 - R_m0_r * d_f_3_d_theta;
    let a_omega_2_theta = omega_2_dot_part_1 * a_omega_2_theta_part_5;
    let d_f_3_d_r = f_2_part_2 + two * f_2_part_1;
    let d_omega_2_dot_d_r_part_1 = f_1_part_1 * M_33 * omega_1 + two * minus_f_2 * r;
    let R_f_3_plus_d_f_3_d_r_r = R * (f_3 + d_f_3_d_r * r);
    let d_omega_2_dot_d_r_part_2 = d_omega_2_dot_d_r_part_1 - R_f_3_plus_d_f_3_d_r_r;
    let d_D_2_d_r = two_m0_r * M_22 - two * R_m0 * R_m0_r;
    let d_omega_2_dot_d_r_part_3 = m0 * d_omega_2_dot_d_r_part_2;
    let d_omega_2_dot_d_r_part_4 = d_omega_2_dot_d_r_part_3 + omega_2_dot * d_D_2_d_r;
    let d_omega_2_dot_d_r = omega_2_dot_part_1 * d_omega_2_dot_d_r_part_4;
    let M_22_d_f_3_d_omega_1 = M_22 * d_f_3_d_omega_1;
    let a_omega_3_omega_1_part_1 = R_m0_r * minus_d_f_2_d_omega_1;
    let a_omega_3_omega_1_part_2 = M_22_d_f_3_d_omega_1 - a_omega_3_omega_1_part_1;
    let minus_a_omega_3_omega_1 = omega_2_dot_part_1 * a_omega_3_omega_1_part_2;
    let a_omega_3_omega_2 = M_22 * a_omega_2_omega_2_part_1;
    let d_f_3_d_omega_3_M_22 = d_f_3_d_omega_3 * M_22;
    let a_omega_3_omega_3_part_1 = R_m0_r * minus_d_f_2_d_omega_3;
    let a_omega_3_omega_3_part_2 = d_f_3_d_omega_3_M_22 - a_omega_3_omega_3_part_1;
    let minus_a_omega_3_omega_3 = omega_2_dot_part_1 * a_omega_3_omega_3_part_2;
    let a_omega_3_sigma_part_1 = m0_r * M_22 * omega_3 - R_m0_r * m0_R_omega_3;
    let a_omega_3_sigma = a_omega_2_sigma_part_1 * a_omega_3_sigma_part_1;
    let M_22_d_f_3_d_theta = M_22 * d_f_3_d_theta;
    let a_omega_3_theta_part_1 = M_22_d_f_3_d_theta - R_m0_r * a_omega_2_theta_part_1;
    let minus_a_omega_3_theta = omega_2_dot_part_1 * a_omega_3_theta_part_1;
    let d_omega_3_dot_d_r_part_1 = M_22 * d_f_3_d_r - m0 * f_1_part_1 * R_m0_r_omega_1;
    let d_omega_3_dot_d_r_part_2 = d_omega_3_dot_d_r_part_1 - R_m0 * minus_f_2;
    let d_omega_3_dot_d_r_part_3 = d_omega_3_dot_d_r_part_2 - omega_3_dot * d_D_2_d_r;
    let minus_d_omega_3_dot_d_r = omega_2_dot_part_1 * d_omega_3_dot_d_r_part_3;
    let b_omega_1_u = R * inv_M_11_minus_R_R_m0;
    let d_sigma_dot_d_omega_1_part_1 = a_omega_1_omega_1_part_1 * b_omega_1_u;
    let d_sigma_dot_d_omega_1 = two * (r_omega_1 - d_sigma_dot_d_omega_1_part_1);
    let d_sigma_dot_d_omega_2 = a_omega_1_omega_2_part_3 * b_omega_1_u - R_omega_3;
    let d_sigma_dot_d_omega_3_part_1 = inv_m0 * (two_m0_r * omega_3 - R_m0 * omega_2);
    let d_sigma_dot_d_omega_3_part_2 = a_omega_1_omega_3_part_8 * b_omega_1_u;
    let d_sigma_dot_d_omega_3 = d_sigma_dot_d_omega_3_part_1
        - d_sigma_dot_d_omega_3_part_2;
    let a_sigma_sigma = R_m0_r_omega_1 * a_omega_1_omega_1_part_2;
    let d_sigma_dot_d_theta = a_omega_1_theta_part_7 * b_omega_1_u - g_cos_theta;
    let d_sigma_dot_d_r = R * d_omega_1_dot_d_r + inv_m0 * d_f_4_d_r;
    let a_psi_theta = a_psi_omega_3 * f_1_part_2;
    let minus_a_phi_theta = a_psi_omega_3_squared * omega_3;
    let R_cos_theta = R * cos_theta;
    let a_x_G_omega_1 = sin_psi * R_cos_theta;
    let a_x_G_omega_2 = R * cos_psi;
    let sin_theta_R_omega_1 = sin_theta * R_omega_1;
    let minus_a_x_G_theta = sin_psi * sin_theta_R_omega_1;
    let minus_a_y_G_omega_1 = cos_psi * R_cos_theta;
    let a_y_G_omega_2 = R * sin_psi;
    let a_y_G_theta = cos_psi * sin_theta_R_omega_1;

    // Derivatives by the inputs.
    let d_sigma_dot_d_u = inv_m0 + R * b_omega_1_u;

    let mut a = [[zero; 10]; 10];
    a[0][0] = a_omega_1_omega_1;
    a[0][1] = a_omega_1_omega_2;
    a[0][2] = -minus_a_omega_1_omega_3;
    a[0][3] = a_omega_1_sigma;
    a[0][4] = a_omega_1_theta;
    a[0][5] = d_omega_1_dot_d_r;
    a[1][0] = a_omega_2_omega_1;
    a[1][1] = a_omega_2_omega_2;
    a[1][2] = a_omega_2_omega_3;
    a[1][3] = a_omega_2_sigma;
    a[1][4] = a_omega_2_theta;
    a[1][5] = d_omega_2_dot_d_r;
    a[2][0] = -minus_a_omega_3_omega_1;
    a[2][1] = a_omega_3_omega_2;
    a[2][2] = -minus_a_omega_3_omega_3;
    a[2][3] = a_omega_3_sigma;
    a[2][4] = -minus_a_omega_3_theta;
    a[2][5] = -minus_d_omega_3_dot_d_r;
    a[3][0] = d_sigma_dot_d_omega_1;
    a[3][1] = d_sigma_dot_d_omega_2;
    a[3][2] = d_sigma_dot_d_omega_3;
    a[3][3] = a_sigma_sigma;
    a[3][4] = d_sigma_dot_d_theta;
    a[3][5] = d_sigma_dot_d_r;
    a[4][0] = one;
    a[5][3] = one;
    a[6][2] = a_psi_omega_3;
    a[6][4] = a_psi_theta;
    a[7][1] = one;
    a[7][2] = -minus_a_phi_omega_3;
    a[7][4] = -minus_a_phi_theta;
    a[8][0] = a_x_G_omega_1;
    a[8][1] = a_x_G_omega_2;
    a[8][4] = -minus_a_x_G_theta;
    a[8][6] = -y_G_dot;
    a[9][0] = -minus_a_y_G_omega_1;
    a[9][1] = a_y_G_omega_2;
    a[9][4] = a_y_G_theta;
    a[9][6] = x_G_dot;

    let mut b = [[zero; 1]; 10];
    b[0][0] = b_omega_1_u;
    b[3][0] = d_sigma_dot_d_u;

    Jacobians {
        rates: State {
            omega_1: omega_1_dot,
            omega_2: omega_2_dot,
            omega_3: omega_3_dot,
            sigma: sigma_dot,
            theta: omega_1,
            r: sigma,
            psi: psi_dot,
            phi: phi_dot,
            x_G: x_G_dot,
            y_G: y_G_dot,
        },
        a,
        b,
    }
}

/// Rates ẋ with their derivatives by state, inputs and parameters.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 454 (141 +, 297 ×, 4 ÷, 12 sign), 2 sine-cosine pairs.
#[must_use]
#[inline]
pub fn all_jacobians<T: Real>(
    p: &Parameters<T>,
    x: &State<T>,
    inputs: &Inputs<T>,
) -> AllJacobians<T> {
    let &Parameters { m, m0, R, g } = p;
    let &State { omega_1, omega_2, omega_3, sigma, theta, r, psi, .. } = x;
    let &Inputs { u } = inputs;
    let minus_five_halves = T::constant(-2.5);
    let minus_two = T::constant(-2.0);
    let minus_three_halves = T::constant(-1.5);
    let minus_five_quarters = T::constant(-1.25);
    let zero = T::constant(0.0);
    let quarter = T::constant(0.25);
    let half = T::constant(0.5);
    let one = T::constant(1.0);
    let five_quarters = T::constant(1.25);
    let three_halves = T::constant(1.5);
    let two = T::constant(2.0);
    let three = T::constant(3.0);

    // Sines and cosines.
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_psi, cos_psi) = psi.sin_cos();

    // Combinations of parameters.
    let R_squared = R * R;
    let m0_R_squared = m0 * R_squared;
    let R_m = R * m;
    let R_R_m = R * R_m;
    let three_halves_R_m = three_halves * R_m;
    let half_R_m = half * R_m;
    let M_22 = m0_R_squared + R * three_halves_R_m;
    let inv_m0 = one / m0;
    let m0_R = m0 * R;
    let two_m0_R = two * m0_R;
    let d_M_22_d_R = two_m0_R + three * R_m;

    // Rates.
    let m0_r = m0 * r;
    let m0_r_r = m0_r * r;
    let M_11 = m0_R_squared + m0_r_r + five_quarters * R_R_m;
    let omega_1_dot_part_1 = one / (M_11 - m0_R_squared);
    let R_omega_3 = R * omega_3;
    let R_omega_3_omega_2 = R_omega_3 * omega_2;
    let m0_R_omega_3_omega_2 = m0 * R_omega_3_omega_2;
    let m0_r_omega_1 = m0_r * omega_1;
    let g_sin_theta = g * sin_theta;
    let m0_r_omega_3 = m0_r * omega_3;
    let f_4_part_1 = m0 * g_sin_theta - m0_r_omega_3 * omega_3;
    let f_4 = m0_r_omega_1 * omega_1 + u - m0_R_omega_3_omega_2 - f_4_part_1;
    let m_R_omega_3 = m * R_omega_3;
    let a_psi_omega_3 = one / cos_theta;
    let minus_a_phi_omega_3 = sin_theta * a_psi_omega_3;
    let f_1_part_1 = quarter * minus_a_phi_omega_3;
    let f_1_part_2 = R_omega_3 * f_1_part_1;
    let two_sigma = two * sigma;
    let r_omega_1 = r * omega_1;
    let R_g_sin_theta = R * g_sin_theta;
    let R_R_omega_3_omega_2 = R * R_omega_3_omega_2;
    let r_omega_3 = r * omega_3;
    let f_1_part_3 = minus_a_phi_omega_3 * r_omega_3;
    let minus_a_phi_omega_3_r = minus_a_phi_omega_3 * r;
    let g_cos_theta = g * cos_theta;
    let f_1_part_4 = two_sigma * r_omega_1 + r_omega_3 * f_1_part_3;
    let f_1_part_5 = f_1_part_4 + R_omega_3 * r_omega_3 + g_cos_theta * r;
    let f_1_part_6 = f_1_part_5 - R_g_sin_theta - R_R_omega_3_omega_2;
    let f_1_part_7 = f_1_part_6 - R_omega_3_omega_2 * minus_a_phi_omega_3_r;
    let f_1_part_8 = R_m * g_sin_theta + R_omega_3_omega_2 * three_halves_R_m;
    let f_1 = f_1_part_8 - m_R_omega_3 * f_1_part_2 - m0 * f_1_part_7;
    let omega_1_dot = omega_1_dot_part_1 * (R * f_4 + f_1);
    let R_m0_r = R * m0_r;
    let R_omega_1 = R * omega_1;
    let R_omega_1_half_R_m = R_omega_1 * half_R_m;
    let R_m0_r_omega_1 = R_m0_r * omega_1;
    let f_3_part_1 = R_m0_r_omega_1 + m0_r_omega_1 * minus_a_phi_omega_3_r;
    let d_f_3_d_omega_3 = f_3_part_1 + R_m * f_1_part_1 * R_omega_1 - m0_r * two_sigma;
    let f_3 = d_f_3_d_omega_3 * omega_3 - R_omega_1_half_R_m * omega_2;
    let f_2_part_1 = minus_a_phi_omega_3 * omega_3;
    let f_2_part_2 = m0_r_omega_1 * f_2_part_1;
    let R_omega_3_omega_1 = R_omega_3 * omega_1;
    let m_R_omega_3_omega_1 = m * R_omega_3_omega_1;
    let m0_R_omega_3_omega_1 = m0 * R_omega_3_omega_1;
    let m0_two_sigma_omega_3 = m0 * two_sigma * omega_3;
    let f_2_part_3 = m0_R_omega_3_omega_1 - m0_two_sigma_omega_3;
    let minus_f_2 = R * (f_2_part_2 + m_R_omega_3_omega_1 + f_2_part_3);
    let M_33 = m0_r_r + quarter * R_R_m;
    let omega_2_dot_part_1 = minus_f_2 * M_33 - R_m0_r * f_3;
    let omega_2_dot_part_2 = one / (R_m0_r * R_m0_r - M_33 * M_22);
    let omega_2_dot = omega_2_dot_part_1 * omega_2_dot_part_2;
    let omega_3_dot_part_1 = R_m0_r * minus_f_2 - f_3 * M_22;
    let omega_3_dot = omega_2_dot_part_2 * omega_3_dot_part_1;
    let f_4_over_m0 = f_4 * inv_m0;
    let sigma_dot = f_4_over_m0 + R * omega_1_dot;
    let psi_dot = a_psi_omega_3 * omega_3;
    let phi_dot = omega_2 - f_2_part_1;
    let R_omega_2 = R * omega_2;
    let cos_theta_sin_psi = cos_theta * sin_psi;
    let x_G_dot = cos_psi * R_omega_2 + R_omega_1 * cos_theta_sin_psi;
    let cos_theta_cos_psi = cos_theta * cos_psi;
    let y_G_dot = R_omega_2 * sin_psi - R_omega_1 * cos_theta_cos_psi;

    // Derivatives by the state.
    let a_omega_1_omega_1_part_1 = m0_r * sigma - R_m0_r_omega_1;
    let a_omega_1_omega_1_part_2 = minus_two * omega_1_dot_part_1;
    let a_omega_1_omega_1 = a_omega_1_omega_1_part_1 * a_omega_1_omega_1_part_2;
    let m0_r_R_omega_3 = m0_r * R_omega_3;
    let a_omega_1_omega_2_part_1 = minus_a_phi_omega_3 * m0_r_R_omega_3;
    let a_omega_1_omega_2_part_2 = R_omega_3 * three_halves_R_m;
    let a_omega_1_omega_2_part_3 = a_omega_1_omega_2_part_1 + a_omega_1_omega_2_part_2;
    let a_omega_1_omega_2 = omega_1_dot_part_1 * a_omega_1_omega_2_part_3;
    let two_m0_r = two * m0_r;
    let a_omega_1_omega_3_part_1 = m0_r * minus_a_phi_omega_3 * omega_2;
    let a_omega_1_omega_3_part_2 = half * m_R_omega_3 * minus_a_phi_omega_3;
    let a_omega_1_omega_3_part_3 = a_omega_1_omega_3_part_1 - a_omega_1_omega_3_part_2;
    let three_halves_R_m_omega_2 = three_halves_R_m * omega_2;
    let a_omega_1_omega_3_part_4 = three_halves_R_m_omega_2 + a_omega_1_omega_3_part_3;
    let a_omega_1_omega_3_part_5 = f_1_part_3 * two_m0_r;
    let a_omega_1_omega_3_part_6 = R * a_omega_1_omega_3_part_4;
    let a_omega_1_omega_3_part_7 = a_omega_1_omega_3_part_5 - a_omega_1_omega_3_part_6;
    let minus_a_omega_1_omega_3 = omega_1_dot_part_1 * a_omega_1_omega_3_part_7;
    let a_omega_1_sigma = m0_r_omega_1 * a_omega_1_omega_1_part_2;
    let a_psi_omega_3_squared = a_psi_omega_3 * a_psi_omega_3;
    let a_omega_1_theta_part_1 = quarter * R_omega_3 * m_R_omega_3;
    let a_omega_1_theta_part_2 = m0_r * a_psi_omega_3_squared;
    let a_omega_1_theta_part_3 = R_omega_3_omega_2 - r_omega_3 * omega_3;
    let a_omega_1_theta_part_4 = R_m * g_cos_theta + m0_r * g_sin_theta;
    let a_omega_1_theta_part_5 = a_omega_1_theta_part_2 * a_omega_1_theta_part_3;
    let a_omega_1_theta_part_6 = a_omega_1_theta_part_4 + a_omega_1_theta_part_5;
    let a_omega_1_theta_part_7 = a_omega_1_theta_part_1 * a_psi_omega_3_squared;
    let a_omega_1_theta_part_8 = a_omega_1_theta_part_6 - a_omega_1_theta_part_7;
    let a_omega_1_theta = omega_1_dot_part_1 * a_omega_1_theta_part_8;
    let d_f_4_d_r = m0 * (omega_1 * omega_1 + omega_3 * omega_3);
    let d_omega_1_dot_d_r_part_1 = g_cos_theta + R_omega_3 * omega_3;
    let d_omega_1_dot_d_r_part_2 = two * r_omega_3 * f_2_part_1;
    let d_omega_1_dot_d_r_part_3 = d_omega_1_dot_d_r_part_1 + d_omega_1_dot_d_r_part_2;
    let d_omega_1_dot_d_r_part_4 = d_omega_1_dot_d_r_part_3 + two_sigma * omega_1;
    let d_omega_1_dot_d_r_part_5 = R_omega_3_omega_2 * minus_a_phi_omega_3;
    let d_omega_1_dot_d_r_part_6 = d_omega_1_dot_d_r_part_4 - d_omega_1_dot_d_r_part_5;
    let d_omega_1_dot_d_r_part_7 = R * d_f_4_d_r - m0 * d_omega_1_dot_d_r_part_6;
    let d_omega_1_dot_d_r_part_8 = omega_1_dot_part_1 * omega_1_dot;
    let d_omega_1_dot_d_r_part_9 = omega_1_dot_part_1 * d_omega_1_dot_d_r_part_7;
    let d_omega_1_dot_d_r_part_10 = two_m0_r * d_omega_1_dot_d_r_part_8;
    let d_omega_1_dot_d_r = d_omega_1_dot_d_r_part_9 - d_omega_1_dot_d_r_part_10;
    let minus_d_f_2_d_omega_1 = a_omega_1_omega_2_part_1 + R_omega_3 * (R_m + m0_R);
    let a_omega_2_omega_1_part_1 = m0_r_R_omega_3 + m0_r * f_1_part_3 + R_m * f_1_part_2;
    let d_f_3_d_omega_1 = a_omega_2_omega_1_part_1 - half_R_m * R_omega_2;
    let a_omega_2_omega_1_part_2 = M_33 * minus_d_f_2_d_omega_1;
    let a_omega_2_omega_1_part_3 = a_omega_2_omega_1_part_2 - R_m0_r * d_f_3_d_omega_1;
    let a_omega_2_omega_1 = omega_2_dot_part_2 * a_omega_2_omega_1_part_3;
    let a_omega_2_omega_2_part_1 = R_omega_1_half_R_m * omega_2_dot_part_2;
    let a_omega_2_omega_2 = R_m0_r * a_omega_2_omega_2_part_1;
    let R_m_omega_1 = R_m * omega_1;
    let a_omega_2_omega_3_part_1 = m0_r_omega_1 * minus_a_phi_omega_3 + R_m_omega_1;
    let a_omega_2_omega_3_part_2 = m0 * (two_sigma - R_omega_1);
    let minus_d_f_2_d_omega_3 = R
        * (a_omega_2_omega_3_part_1 - a_omega_2_omega_3_part_2);
    let a_omega_2_omega_3_part_3 = M_33 * minus_d_f_2_d_omega_3;
    let a_omega_2_omega_3_part_4 = a_omega_2_omega_3_part_3 - R_m0_r * d_f_3_d_omega_3;
    let a_omega_2_omega_3 = omega_2_dot_part_2 * a_omega_2_omega_3_part_4;
    let m0_R_omega_3 = m0 * R_omega_3;
    let a_omega_2_sigma_part_1 = two * omega_2_dot_part_2;
    let a_omega_2_sigma_part_2 = m0_r * m0_r_R_omega_3 - M_33 * m0_R_omega_3;
    let a_omega_2_sigma = a_omega_2_sigma_part_1 * a_omega_2_sigma_part_2;
    let a_omega_2_theta_part_1 = R_omega_3_omega_1 * a_omega_1_theta_part_2;
    let m0_r_omega_1_r_omega_3 = m0_r_omega_1 * r_omega_3;
    let a_omega_2_theta_part_2 = quarter * R_m * R_omega_3_omega_1;
    let a_omega_2_theta_part_3 = m0_r_omega_1_r_omega_3 + a_omega_2_theta_part_2;
    let d_f_3_d_theta = a_psi_omega_3_squared * a_omega_2_theta_part_3;
    let a_omega_2_theta_part_4 = M_33 * a_omega_2_theta_part_1;
    let a_omega_2_theta_part_5 = a_omega_2_theta_part_4 - R_m0_r * d_f_3_d_theta;
    let a_omega_2_theta = omega_2_dot_part_2 * a_omega_2_theta_part_5;
    let d_omega_2_dot_d_r_part_1 = minus_a_phi_omega_3 * R_omega_3_omega_1;
    let d_f_3_d_r = f_2_part_3 + two * f_2_part_2;
    let R_r = R * r;
    let d_omega_2_dot_d_r_part_2 = M_33 * d_omega_2_dot_d_r_part_1;
    let d_omega_2_dot_d_r_part_3 = d_omega_2_dot_d_r_part_2 + two * minus_f_2 * r;
    let d_omega_2_dot_d_r_part_4 = d_omega_2_dot_d_r_part_3 - d_f_3_d_r * R_r;
    let d_omega_2_dot_d_r_part_5 = m0 * omega_2_dot_part_2;
    let d_omega_2_dot_d_r_part_6 = d_omega_2_dot_d_r_part_4 - R * f_3;
    let d_D_2_d_r = M_22 * two_m0_r - R_m0_r * two_m0_R;
    let d_omega_2_dot_d_r_part_7 = omega_2_dot_part_2 * omega_2_dot_part_2;
    let d_omega_2_dot_d_r_part_8 = omega_2_dot_part_1 * d_omega_2_dot_d_r_part_7;
    let d_omega_2_dot_d_r_part_9 = d_omega_2_dot_d_r_part_5 * d_omega_2_dot_d_r_part_6;
    let d_omega_2_dot_d_r_part_10 = d_D_2_d_r * d_omega_2_dot_d_r_part_8;
    let d_omega_2_dot_d_r = d_omega_2_dot_d_r_part_9 + d_omega_2_dot_d_r_part_10;
    let M_22_d_f_3_d_omega_1 = M_22 * d_f_3_d_omega_1;
    let a_omega_3_omega_1_part_1 = R_m0_r * minus_d_f_2_d_omega_1;
    let a_omega_3_omega_1_part_2 = M_22_d_f_3_d_omega_1 - a_omega_3_omega_1_part_1;
    let minus_a_omega_3_omega_1 = omega_2_dot_part_2 * a_omega_3_omega_1_part_2;
    let a_omega_3_omega_2 = M_22 * a_omega_2_omega_2_part_1;
    let d_f_3_d_omega_3_M_22 = d_f_3_d_omega_3 * M_22;
    let a_omega_3_omega_3_part_1 = R_m0_r * minus_d_f_2_d_omega_3;
    let a_omega_3_omega_3_part_2 = d_f_3_d_omega_3_M_22 - a_omega_3_omega_3_part_1;
    let minus_a_omega_3_omega_3 = omega_2_dot_part_2 * a_omega_3_omega_3_part_2;
    let a_omega_3_sigma_part_1 = m0_r_omega_3 * M_22 - R_m0_r * m0_R_omega_3;
    let a_omega_3_sigma = a_omega_2_sigma_part_1 * a_omega_3_sigma_part_1;
    let M_22_d_f_3_d_theta = M_22 * d_f_3_d_theta;
    let a_omega_3_theta_part_1 = M_22_d_f_3_d_theta - R_m0_r * a_omega_2_theta_part_1;
    let minus_a_omega_3_theta = omega_2_dot_part_2 * a_omega_3_theta_part_1;
    let M_22_d_f_3_d_r = M_22 * d_f_3_d_r;
    let d_omega_3_dot_d_r_part_1 = m0 * R_m0_r * d_omega_2_dot_d_r_part_1;
    let d_omega_3_dot_d_r_part_2 = M_22_d_f_3_d_r - d_omega_3_dot_d_r_part_1;
    let d_omega_3_dot_d_r_part_3 = d_omega_3_dot_d_r_part_2 - minus_f_2 * m0_R;
    let d_omega_3_dot_d_r_part_4 = omega_3_dot_part_1 * d_omega_2_dot_d_r_part_7;
    let d_omega_3_dot_d_r_part_5 = d_D_2_d_r * d_omega_3_dot_d_r_part_4;
    let d_omega_3_dot_d_r_part_6 = omega_2_dot_part_2 * d_omega_3_dot_d_r_part_3;
    let d_omega_3_dot_d_r = d_omega_3_dot_d_r_part_5 - d_omega_3_dot_d_r_part_6;
    let b_omega_1_u = R * omega_1_dot_part_1;
    let d_sigma_dot_d_omega_1_part_1 = a_omega_1_omega_1_part_1 * b_omega_1_u;
    let d_sigma_dot_d_omega_1 = two * (r_omega_1 - d_sigma_dot_d_omega_1_part_1);
    let d_sigma_dot_d_omega_2 = a_omega_1_omega_2_part_3 * b_omega_1_u - R_omega_3;
    let d_sigma_dot_d_omega_3_part_1 = inv_m0 * (two_m0_r * omega_3 - m0_R * omega_2);
    let d_sigma_dot_d_omega_3_part_2 = a_omega_1_omega_3_part_7 * b_omega_1_u;
    let d_sigma_dot_d_omega_3 = d_sigma_dot_d_omega_3_part_1
        - d_sigma_dot_d_omega_3_part_2;
    let a_sigma_sigma = R_m0_r_omega_1 * a_omega_1_omega_1_part_2;
    let d_sigma_dot_d_theta = a_omega_1_theta_part_8 * b_omega_1_u - g_cos_theta;
    let d_sigma_dot_d_r = R * d_omega_1_dot_d_r + inv_m0 * d_f_4_d_r;
    let a_psi_theta = a_psi_omega_3 * f_2_part_1;
    let minus_a_phi_theta = a_psi_omega_3_squared * omega_3;
    let a_x_G_omega_1 = R * cos_theta_sin_psi;
    let a_x_G_omega_2 = R * cos_psi;
    let sin_theta_R_omega_1 = sin_theta * R_omega_1;
    let minus_a_x_G_theta = sin_psi * sin_theta_R_omega_1;
    let minus_a_y_G_omega_1 = R * cos_theta_cos_psi;
    let a_y_G_omega_2 = R * sin_psi;
    let a_y_G_theta = cos_psi * sin_theta_R_omega_1;

    // Derivatives by the inputs.
    let d_sigma_dot_d_u = inv_m0 + R_squared * omega_1_dot_part_1;

    // Derivatives by the parameters.
    let d_omega_1_dot_d_m_part_1 = R_g_sin_theta + three_halves * R_R_omega_3_omega_2;
    let d_f_1_d_m = d_omega_1_dot_d_m_part_1 - R_omega_3 * f_1_part_2;
    let d_omega_1_dot_d_m_part_2 = minus_five_quarters * R_squared;
    let d_omega_1_dot_d_m_part_3 = omega_1_dot_part_1 * d_f_1_d_m;
    let d_omega_1_dot_d_m_part_4 = d_omega_1_dot_d_m_part_2 * d_omega_1_dot_d_r_part_8;
    let d_omega_1_dot_d_m = d_omega_1_dot_d_m_part_3 + d_omega_1_dot_d_m_part_4;
    let r_squared = r * r;
    let d_f_4_d_m0 = r_omega_1 * omega_1 - g_sin_theta - a_omega_1_theta_part_3;
    let d_omega_1_dot_d_m0_part_1 = d_omega_1_dot_d_r_part_8 * r_squared;
    let d_omega_1_dot_d_m0_part_2 = omega_1_dot_part_1 * (f_1_part_7 - R * d_f_4_d_m0);
    let minus_d_omega_1_dot_d_m0 = d_omega_1_dot_d_m0_part_1 + d_omega_1_dot_d_m0_part_2;
    let d_omega_1_dot_d_R_part_1 = a_omega_1_omega_3_part_3 + d_M_22_d_R * omega_2;
    let d_omega_1_dot_d_R_part_2 = m0_R_omega_3_omega_2 - f_4_part_1 - f_4;
    let d_omega_1_dot_d_R_part_3 = d_omega_1_dot_d_R_part_2 - m * g_sin_theta;
    let d_omega_1_dot_d_R_part_4 = omega_3 * d_omega_1_dot_d_R_part_1;
    let d_omega_1_dot_d_R_part_5 = d_omega_1_dot_d_R_part_3 - d_omega_1_dot_d_R_part_4;
    let d_omega_1_dot_d_R_part_6 = minus_five_halves * R_m * d_omega_1_dot_d_r_part_8;
    let d_omega_1_dot_d_R_part_7 = omega_1_dot_part_1 * d_omega_1_dot_d_R_part_5;
    let d_omega_1_dot_d_R = d_omega_1_dot_d_R_part_6 - d_omega_1_dot_d_R_part_7;
    let p_omega_1_g_part_1 = m0_r * cos_theta - R_m * sin_theta;
    let minus_p_omega_1_g = omega_1_dot_part_1 * p_omega_1_g_part_1;
    let d_D_2_d_m = R_squared * (three_halves * M_33 + quarter * M_22);
    let R_R_omega_3_omega_1 = R * R_omega_3_omega_1;
    let d_omega_2_dot_d_m_part_1 = f_1_part_1 * R_R_omega_3_omega_1;
    let d_f_3_d_m = d_omega_2_dot_d_m_part_1 - half * R_squared * omega_2 * omega_1;
    let d_omega_2_dot_d_m_part_2 = quarter * R_squared * minus_f_2;
    let M_33_R_R_omega_3_omega_1 = M_33 * R_R_omega_3_omega_1;
    let d_omega_2_dot_d_m_part_3 = d_omega_2_dot_d_m_part_2 + M_33_R_R_omega_3_omega_1;
    let d_omega_2_dot_d_m_part_4 = d_omega_2_dot_d_m_part_3 - R_m0_r * d_f_3_d_m;
    let d_omega_2_dot_d_m_part_5 = d_omega_2_dot_d_r_part_8 * d_D_2_d_m;
    let d_omega_2_dot_d_m_part_6 = omega_2_dot_part_2 * d_omega_2_dot_d_m_part_4;
    let d_omega_2_dot_d_m = d_omega_2_dot_d_m_part_5 + d_omega_2_dot_d_m_part_6;
    let d_omega_2_dot_d_m0_part_1 = R_omega_3 * two_sigma - R_R_omega_3_omega_1;
    let d_f_2_d_m0 = d_omega_2_dot_d_m0_part_1 - d_omega_2_dot_d_r_part_1 * r;
    let d_omega_2_dot_d_m0_part_2 = r_omega_1 * f_1_part_3 + R_omega_3_omega_1 * r;
    let d_f_3_d_m0 = d_omega_2_dot_d_m0_part_2 - two_sigma * r_omega_3;
    let d_omega_2_dot_d_m0_part_3 = minus_f_2 * r_squared - M_33 * d_f_2_d_m0;
    let d_omega_2_dot_d_m0_part_4 = d_omega_2_dot_d_m0_part_3 - R_m0_r * d_f_3_d_m0;
    let d_omega_2_dot_d_m0_part_5 = d_omega_2_dot_d_m0_part_4 - f_3 * R_r;
    let d_D_2_d_m0 = R_squared * M_33 + M_22 * r_squared - two * R_m0_r * R_r;
    let d_omega_2_dot_d_m0_part_6 = omega_2_dot_part_2 * d_omega_2_dot_d_m0_part_5;
    let d_omega_2_dot_d_m0_part_7 = d_omega_2_dot_d_r_part_8 * d_D_2_d_m0;
    let d_omega_2_dot_d_m0 = d_omega_2_dot_d_m0_part_6 + d_omega_2_dot_d_m0_part_7;
    let d_D_2_d_R = M_33 * d_M_22_d_R + half_R_m * M_22 - R_m0_r * two_m0_r;
    let d_omega_2_dot_d_R_part_1 = m0_r_omega_1 * omega_3
        + half * m * d_omega_2_dot_d_r_part_1;
    let d_f_3_d_R = d_omega_2_dot_d_R_part_1 - R_m_omega_1 * omega_2;
    let d_omega_2_dot_d_R_part_2 = m0_two_sigma_omega_3 - f_2_part_2;
    let d_omega_2_dot_d_R_part_3 = two * (m_R_omega_3_omega_1 + m0_R_omega_3_omega_1);
    let d_f_2_d_R = d_omega_2_dot_d_R_part_2 - d_omega_2_dot_d_R_part_3;
    let d_omega_2_dot_d_R_part_4 = half_R_m * minus_f_2 - m0_r * f_3;
    let d_omega_2_dot_d_R_part_5 = d_omega_2_dot_d_R_part_4 - R_m0_r * d_f_3_d_R;
    let d_omega_2_dot_d_R_part_6 = d_omega_2_dot_d_R_part_5 - M_33 * d_f_2_d_R;
    let d_omega_2_dot_d_R_part_7 = d_omega_2_dot_d_r_part_8 * d_D_2_d_R;
    let d_omega_2_dot_d_R_part_8 = omega_2_dot_part_2 * d_omega_2_dot_d_R_part_6;
    let d_omega_2_dot_d_R = d_omega_2_dot_d_R_part_7 + d_omega_2_dot_d_R_part_8;
    let R_squared_f_3 = R_squared * f_3;
    let d_omega_3_dot_d_m_part_1 = R_m0_r * R_R_omega_3_omega_1;
    let d_omega_3_dot_d_m_part_2 = minus_three_halves * R_squared_f_3;
    let d_omega_3_dot_d_m_part_3 = d_omega_3_dot_d_m_part_1 + d_omega_3_dot_d_m_part_2;
    let d_omega_3_dot_d_m_part_4 = d_omega_3_dot_d_m_part_3 - M_22 * d_f_3_d_m;
    let d_omega_3_dot_d_m_part_5 = d_omega_3_dot_d_r_part_4 * d_D_2_d_m;
    let d_omega_3_dot_d_m_part_6 = omega_2_dot_part_2 * d_omega_3_dot_d_m_part_4;
    let d_omega_3_dot_d_m = d_omega_3_dot_d_m_part_5 + d_omega_3_dot_d_m_part_6;
    let d_omega_3_dot_d_m0_part_1 = minus_f_2 * R_r - R_squared_f_3;
    let d_omega_3_dot_d_m0_part_2 = d_omega_3_dot_d_m0_part_1 - M_22 * d_f_3_d_m0;
    let d_omega_3_dot_d_m0_part_3 = d_omega_3_dot_d_m0_part_2 - R_m0_r * d_f_2_d_m0;
    let d_omega_3_dot_d_m0_part_4 = omega_2_dot_part_2 * d_omega_3_dot_d_m0_part_3;
    let d_omega_3_dot_d_m0_part_5 = d_omega_3_dot_d_r_part_4 * d_D_2_d_m0;
    let d_omega_3_dot_d_m0 = d_omega_3_dot_d_m0_part_4 + d_omega_3_dot_d_m0_part_5;
    let d_omega_3_dot_d_R_part_1 = m0_r * minus_f_2 - M_22 * d_f_3_d_R;
    let d_omega_3_dot_d_R_part_2 = d_omega_3_dot_d_R_part_1 - f_3 * d_M_22_d_R;
    let d_omega_3_dot_d_R_part_3 = d_omega_3_dot_d_R_part_2 - R_m0_r * d_f_2_d_R;
    let d_omega_3_dot_d_R_part_4 = omega_2_dot_part_2 * d_omega_3_dot_d_R_part_3;
    let d_omega_3_dot_d_R_part_5 = d_omega_3_dot_d_r_part_4 * d_D_2_d_R;
    let d_omega_3_dot_d_R = d_omega_3_dot_d_R_part_4 + d_omega_3_dot_d_R_part_5;
    let p_sigma_m = R * d_omega_1_dot_d_m;
    let d_sigma_dot_d_m0_part_1 = inv_m0 * (d_f_4_d_m0 - f_4_over_m0);
    let d_sigma_dot_d_m0 = d_sigma_dot_d_m0_part_1 - R * minus_d_omega_1_dot_d_m0;
    let d_sigma_dot_d_R = omega_1_dot + R * d_omega_1_dot_d_R - omega_2 * omega_3;
    let minus_d_sigma_dot_d_g = sin_theta + b_omega_1_u * p_omega_1_g_part_1;
    let p_x_G_R = cos_theta_sin_psi * omega_1 + cos_psi * omega_2;
    let p_y_G_R = sin_psi * omega_2 - cos_theta_cos_psi * omega_1;

    let mut a = [[zero; 10]; 10];
    a[0][0] = a_omega_1_omega_1;
    a[0][1] = a_omega_1_omega_2;
    a[0][2] = -minus_a_omega_1_omega_3;
    a[0][3] = a_omega_1_sigma;
    a[0][4] = a_omega_1_theta;
    a[0][5] = d_omega_1_dot_d_r;
    a[1][0] = a_omega_2_omega_1;
    a[1][1] = a_omega_2_omega_2;
    a[1][2] = a_omega_2_omega_3;
    a[1][3] = a_omega_2_sigma;
    a[1][4] = a_omega_2_theta;
    a[1][5] = d_omega_2_dot_d_r;
    a[2][0] = -minus_a_omega_3_omega_1;
    a[2][1] = a_omega_3_omega_2;
    a[2][2] = -minus_a_omega_3_omega_3;
    a[2][3] = a_omega_3_sigma;
    a[2][4] = -minus_a_omega_3_theta;
    a[2][5] = d_omega_3_dot_d_r;
    a[3][0] = d_sigma_dot_d_omega_1;
    a[3][1] = d_sigma_dot_d_omega_2;
    a[3][2] = d_sigma_dot_d_omega_3;
    a[3][3] = a_sigma_sigma;
    a[3][4] = d_sigma_dot_d_theta;
    a[3][5] = d_sigma_dot_d_r;
    a[4][0] = one;
    a[5][3] = one;
    a[6][2] = a_psi_omega_3;
    a[6][4] = a_psi_theta;
    a[7][1] = one;
    a[7][2] = -minus_a_phi_omega_3;
    a[7][4] = -minus_a_phi_theta;
    a[8][0] = a_x_G_omega_1;
    a[8][1] = a_x_G_omega_2;
    a[8][4] = -minus_a_x_G_theta;
    a[8][6] = -y_G_dot;
    a[9][0] = -minus_a_y_G_omega_1;
    a[9][1] = a_y_G_omega_2;
    a[9][4] = a_y_G_theta;
    a[9][6] = x_G_dot;

    let mut b = [[zero; 1]; 10];
    b[0][0] = b_omega_1_u;
    b[3][0] = d_sigma_dot_d_u;

    let mut p = [[zero; 4]; 10];
    p[0][0] = d_omega_1_dot_d_m;
    p[0][1] = -minus_d_omega_1_dot_d_m0;
    p[0][2] = d_omega_1_dot_d_R;
    p[0][3] = -minus_p_omega_1_g;
    p[1][0] = d_omega_2_dot_d_m;
    p[1][1] = d_omega_2_dot_d_m0;
    p[1][2] = d_omega_2_dot_d_R;
    p[2][0] = d_omega_3_dot_d_m;
    p[2][1] = d_omega_3_dot_d_m0;
    p[2][2] = d_omega_3_dot_d_R;
    p[3][0] = p_sigma_m;
    p[3][1] = d_sigma_dot_d_m0;
    p[3][2] = d_sigma_dot_d_R;
    p[3][3] = -minus_d_sigma_dot_d_g;
    p[8][2] = p_x_G_R;
    p[9][2] = p_y_G_R;

    AllJacobians {
        rates: State {
            omega_1: omega_1_dot,
            omega_2: omega_2_dot,
            omega_3: omega_3_dot,
            sigma: sigma_dot,
            theta: omega_1,
            r: sigma,
            psi: psi_dot,
            phi: phi_dot,
            x_G: x_G_dot,
            y_G: y_G_dot,
        },
        a,
        b,
        p,
    }
}

/// Energies and power.
///
/// From `mechanisms/unicycle.toml`.
/// Operations: 8 (8 ×), 1 sine-cosine pair.
#[must_use]
#[inline]
pub fn energies<T: Real>(
    p: &Parameters<T>,
    x: &State<T>,
    inputs: &Inputs<T>,
) -> Energies<T> {
    let &Parameters { m, R, g, .. } = p;
    let &State { omega_2, sigma, theta, .. } = x;
    let &Inputs { u } = inputs;
    let three_quarters = T::constant(0.75);

    // Combinations of parameters.
    let R_m = R * m;

    // Kinetic.
    let kinetic = three_quarters * R * R_m * omega_2 * omega_2;

    // Potential.
    let potential = g * R_m * theta.cos();

    // Power.
    let power = u * sigma;

    Energies {
        kinetic,
        potential,
        power,
    }
}

/// The mechanism unicycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Unicycle;

const _: () = {
    use ::appell_runtime::model::At;

    const N: usize = 10;
    const S: usize = 4;
    const M: usize = 1;
    const K: usize = 4;

    /// The first numbers of a slice that holds at least as many.
    fn first<const LEN: usize>(numbers: &[f64]) -> [f64; LEN] {
        core::array::from_fn(|i| numbers[i])
    }

    fn parameters(at: &At<'_>) -> Parameters<f64> {
        first::<K>(at.p).into()
    }

    fn state(at: &At<'_>) -> State<f64> {
        first::<N>(at.x).into()
    }

    fn inputs(at: &At<'_>) -> Inputs<f64> {
        first::<M>(at.u).into()
    }

    fn write(to: &mut [f64], from: &[f64]) {
        to.copy_from_slice(from);
    }

    impl ::appell_runtime::model::Model for Unicycle {
        fn info(&self) -> &::appell_runtime::model::ModelInfo {
            &INFO
        }

        fn rates(&self, at: At<'_>, rates: &mut [f64]) {
            write(
                rates,
                &<[f64; N]>::from(
                    self::rates(&parameters(&at), &state(&at), &inputs(&at)),
                ),
            );
        }

        fn jacobians(
            &self,
            at: At<'_>,
            rates: &mut [f64],
            a: &mut [f64],
            b: &mut [f64],
        ) {
            let all = jacobians(&parameters(&at), &state(&at), &inputs(&at));
            write(rates, &<[f64; N]>::from(all.rates));
            write(a, all.a.as_flattened());
            write(b, all.b.as_flattened());
        }

        fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
            write(
                p,
                all_jacobians(&parameters(&at), &state(&at), &inputs(&at))
                    .p
                    .as_flattened(),
            );
        }

        fn appell(
            &self,
            at: At<'_>,
            mass: &mut [f64],
            bias: &mut [f64],
            forces: &mut [f64],
        ) {
            write(
                mass,
                mass_matrix(&parameters(&at), &state(&at), &inputs(&at)).as_flattened(),
            );
            write(
                bias,
                &<[f64; S]>::from(
                    self::bias(&parameters(&at), &state(&at), &inputs(&at)),
                ),
            );
            write(
                forces,
                &<[f64; S]>::from(
                    generalized_forces(&parameters(&at), &state(&at), &inputs(&at)),
                ),
            );
        }

        fn energies(&self, at: At<'_>) -> ::appell_runtime::model::Energies {
            let all = energies(&parameters(&at), &state(&at), &inputs(&at));
            ::appell_runtime::model::Energies {
                kinetic: all.kinetic,
                potential: all.potential,
                power: all.power,
                acceleration: acceleration_energy(
                        &parameters(&at),
                        &state(&at),
                        &inputs(&at),
                    )
                    .total,
            }
        }

        fn constraint_residual(&self, _at: At<'_>, _none: &mut [f64]) {}

        fn constraint_forces(&self, _at: At<'_>, _none: &mut [f64]) {}

        fn outputs(&self, _at: At<'_>, _none: &mut [f64]) {}
    }
};
