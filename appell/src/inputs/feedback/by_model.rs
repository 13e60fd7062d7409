//! Laws that compute inputs by inverse dynamics.
//!
//! ```toml
//! law = "computed torque"                  # or "gravity compensation", with `inputs` alone
//! inputs = ["tau_1", "tau_2"]
//! follow = { q_1 = "0.5*sin(t)", q_2 = 0 } # as many coordinates, each the integral of a pseudo-velocity
//! natural_frequency = 10                   # of the errors, in rad/s
//! damping_ratio = 1
//! believes = { m_load = "2kg" }            # parameters of the law's model; the others are those of the motion
//! sampled_ms = 2                           # sampling period; inputs are held in between
//! delay_ms = 1                             # from a measurement to its effect
//! ```

use appell_spec::expr::Expr;
use appell_spec::mechanism::{CoordinateId, SpeedId};
use appell_spec::{Code, Scope};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::reading::{Reader, Value};

/// A law that computes its inputs from the equations of motion.
#[derive(Debug)]
pub struct ModelLaw {
    /// Its type.
    pub aim: Aim,
    /// Parameters of its model that differ from those of the motion, in SI.
    pub believed: Vec<(usize, f64)>,
}

/// Control law by inverse dynamics.
#[derive(Debug)]
pub enum Aim {
    /// Inputs that would hold the mechanism at rest in its present position.
    GravityCompensation,
    /// Inputs that let coordinates follow desired motions: `q̈ = q̈_d − 2ζω (q̇ − q̇_d) − ω² (q − q_d)`.
    ComputedTorque {
        /// The coordinates, with their desired motions.
        followed: Vec<Followed>,
        /// ω² in 1/s².
        stiffness: f64,
        /// 2ζω in 1/s.
        damping: f64,
    },
}

/// A coordinate whose rate is a pseudo-velocity.
#[derive(Debug)]
pub struct Followed {
    /// The coordinate, as a state.
    pub coordinate: usize,
    /// The pseudo-velocity.
    pub speed: usize,
    /// The desired coordinate over time.
    pub desired: Expr,
}

const LAWS: [&str; 2] = ["computed torque", "gravity compensation"];

const KEYS: &[&str] = &[
    "about",
    "mechanism",
    "law",
    "inputs",
    "believes",
    "sampled_ms",
    "delay_ms",
    "switching_times_s",
    "initial",
];

const KEYS_OF_FOLLOWING: &[&str] = &["follow", "natural_frequency", "damping_ratio"];

/// The law of a file with the key `law`; invalid entries are reported.
pub(super) fn read(
    reader: &mut Reader<'_>,
    table: &DeTable<'_>,
    law: &Value<'_>,
) -> Option<(Vec<usize>, ModelLaw)> {
    let (name, at) = reader.string(law)?;
    let Some(place) = LAWS.iter().position(|law| *law == name) else {
        let message = format!("there is no law `{name}`");
        let help = format!("the laws are {}", LAWS.join(", "));
        reader.tell(Code::UnknownWord, message, at, &help);
        return None;
    };
    let follows = place == 0;
    let known: Vec<&str> = if follows {
        [KEYS, KEYS_OF_FOLLOWING].concat()
    } else {
        KEYS.to_vec()
    };
    reader.known_keys(table, &known);
    reader.right_mechanism(table);
    let inputs = reader.list(table, "inputs", Reader::input);
    if table.get("inputs").is_none() {
        let message = "the key `inputs` is missing";
        reader.tell(
            Code::MissingKey,
            message,
            0..0,
            "name the inputs that the law computes",
        );
    }
    let believed = believed(reader, table);
    let aim = if follows {
        computed_torque(reader, table, inputs.as_ref()?.len())?
    } else {
        Aim::GravityCompensation
    };
    Some((inputs?, ModelLaw { aim, believed }))
}

fn computed_torque(reader: &mut Reader<'_>, table: &DeTable<'_>, inputs: usize) -> Option<Aim> {
    let Some(follow) = table.get("follow") else {
        let message = "the key `follow` is missing";
        let help = "write follow = { q = \"0.1*sin(t)\" }, with as many coordinates as inputs";
        reader.tell(Code::MissingKey, message, 0..0, help);
        return None;
    };
    let wanted = reader.by_state(table, "follow", Scope::Schedule, "the desired motion");
    let mut followed = Vec::new();
    for (coordinate, desired, at) in wanted {
        let speed = speed_of(reader, coordinate);
        let Some(speed) = speed else {
            let name = &reader.setup.info.states[coordinate].name;
            let message = format!("no pseudo-velocity is the rate of `{name}`");
            let help = "computed torque follows coordinates q with a pseudo-velocity \"dot(q)\"";
            reader.tell(Code::UnknownReference, message, at, help);
            continue;
        };
        followed.push(Followed {
            coordinate,
            speed,
            desired,
        });
    }
    reader.count("coordinate", followed.len(), "input", inputs, follow.span());
    let mut positive = |key: &str, default: Option<f64>| {
        let Some(value) = table.get(key) else {
            if default.is_none() {
                let message = format!("the key `{key}` is missing");
                let help = "give the natural frequency of the errors in rad/s, such as 10";
                reader.tell(Code::MissingKey, message, 0..0, help);
            }
            return default;
        };
        let number = reader.number(value)?;
        if number <= 0.0 {
            let message = format!("`{key}` must be positive");
            reader.tell(Code::WrongType, message, value.span(), "");
            return None;
        }
        Some(number)
    };
    let frequency = positive("natural_frequency", None);
    let damping_ratio = positive("damping_ratio", Some(1.0));
    let (frequency, damping_ratio) = frequency.zip(damping_ratio)?;
    Some(Aim::ComputedTorque {
        followed,
        stiffness: frequency * frequency,
        damping: 2.0 * damping_ratio * frequency,
    })
}

/// The pseudo-velocity that is the rate of a coordinate.
fn speed_of(reader: &Reader<'_>, coordinate: usize) -> Option<usize> {
    let setup = reader.setup;
    let coordinate = CoordinateId::new(coordinate.checked_sub(setup.info.speeds)?);
    setup.mechanism.speed_of(coordinate).map(SpeedId::index)
}

/// Values of parameters by name, in SI.
fn believed(reader: &mut Reader<'_>, table: &DeTable<'_>) -> Vec<(usize, f64)> {
    let Some(value) = table.get("believes") else {
        return Vec::new();
    };
    let DeValue::Table(entries) = value.get_ref() else {
        let help = "write `name = value` for each parameter";
        let message = "`believes` must be a table";
        reader.tell(Code::WrongType, message, value.span(), help);
        return Vec::new();
    };
    let parameters = reader.setup.info.parameters.iter();
    let names: Vec<String> = parameters.map(|p| p.name.to_string()).collect();
    let mut believed = Vec::new();
    for (name, value) in entries {
        if let Some(parameter) = reader.find(name.get_ref(), "parameter", &names, name.span())
            && let Some(number) = constant(reader, parameter, value)
        {
            believed.push((parameter, number));
        }
    }
    believed
}

fn constant(
    reader: &mut Reader<'_>,
    parameter: usize,
    value: &Spanned<DeValue<'_>>,
) -> Option<f64> {
    let id = appell_spec::mechanism::ParameterId::new(parameter);
    let unit = &reader.setup.mechanism.parameters[id].label.unit;
    let expr = reader.expression(value, Scope::Constant, "the parameter", unit)?;
    let number = reader.setup.constant(&expr);
    if number.is_none() {
        reader.tell(
            Code::NotFinite,
            "this is not a finite number",
            value.span(),
            "",
        );
    }
    number
}
