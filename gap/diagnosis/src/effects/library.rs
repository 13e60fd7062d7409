//! The effects that are shipped.

use super::{Effect, EffectError};

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../effects/", $name, ".toml")))),*]
    };
}

/// Files in the order in which the library is listed.
const FILES: [(&str, &str); 39] = files![
    "viscous_friction",
    "coulomb_friction",
    "directional_friction",
    "stribeck_friction",
    "spring",
    "spring_with_preload",
    "stop",
    "coupling_elastic",
    "coupling_feedback",
    "rolling_resistance",
    "spin_friction",
    "quadratic_drag",
    "constant_force",
    "ground_slope",
    "parameter_error",
    "mass_offset",
    "payload",
    "added_inertia_sliding",
    "added_inertia_turning",
    "actuator_gain",
    "actuator_bias",
    "servo_gain",
    "servo_bias",
    "servo_saturation",
    "actuator_lag",
    "actuator_delay",
    "actuator_saturation",
    "actuator_dead_zone",
    "saturation",
    "longitudinal_slip",
    "lateral_slip",
    "backlash_sliding",
    "backlash_turning",
    "sensor_bias",
    "encoder_bias",
    "encoder_scale",
    "sensor_scale",
    "sensor_delay",
    "sensor_filter",
];

/// All of them.
pub fn shipped() -> Result<Vec<Effect>, EffectError> {
    let effect = |&(name, text): &(&str, &str)| {
        let effect = Effect::read(name, &format!("{name}.toml"), text)?;
        Ok(Effect {
            file: None,
            ..effect
        })
    };
    FILES.iter().map(effect).collect()
}
