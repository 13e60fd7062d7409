//! The units of a spec, and the names of quantities.

use std::fmt::Write as _;

use num_traits::{One, Zero};

use super::dimension::{BASE_UNITS, Dimension};

/// One row of the unit table.
#[derive(Debug, Clone, Copy)]
pub struct UnitEntry {
    /// Symbol, as written in a spec.
    pub symbol: &'static str,
    /// Name in words.
    pub name: &'static str,
    /// Exponents of metre, kilogram, second, ampere, kelvin, mole, candela.
    pub powers: [i32; 7],
    /// Size in SI as an exact fraction.
    pub size: (i64, i64),
    /// Whether the size is to be multiplied by π.
    pub times_pi: bool,
    /// Whether it may have a prefix such as `k`, `m` and `u`.
    pub prefixed: bool,
}

impl UnitEntry {
    /// Whether it measures an angle, or a rate of one.
    pub(super) fn is_angle(&self) -> bool {
        self.times_pi || self.symbol == "rad"
    }
}

/// Prefixes and their powers of ten.
pub const PREFIXES: &[(&str, i32)] = &[
    ("p", -12),
    ("n", -9),
    ("u", -6),
    ("µ", -6),
    ("m", -3),
    ("c", -2),
    ("d", -1),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
];

const fn si(symbol: &'static str, name: &'static str, powers: [i32; 7]) -> UnitEntry {
    UnitEntry {
        symbol,
        name,
        powers,
        size: (1, 1),
        times_pi: false,
        prefixed: true,
    }
}

const fn fixed(
    symbol: &'static str,
    name: &'static str,
    powers: [i32; 7],
    size: (i64, i64),
) -> UnitEntry {
    UnitEntry {
        size,
        prefixed: false,
        ..si(symbol, name, powers)
    }
}

const fn angle(
    symbol: &'static str,
    name: &'static str,
    powers: [i32; 7],
    size: (i64, i64),
) -> UnitEntry {
    UnitEntry {
        times_pi: true,
        ..fixed(symbol, name, powers, size)
    }
}

const NONE: [i32; 7] = [0; 7];
const LENGTH: [i32; 7] = [1, 0, 0, 0, 0, 0, 0];
const MASS: [i32; 7] = [0, 1, 0, 0, 0, 0, 0];
const TIME: [i32; 7] = [0, 0, 1, 0, 0, 0, 0];
const PER_TIME: [i32; 7] = [0, 0, -1, 0, 0, 0, 0];
const VELOCITY: [i32; 7] = [1, 0, -1, 0, 0, 0, 0];
const FORCE: [i32; 7] = [1, 1, -2, 0, 0, 0, 0];
const ENERGY: [i32; 7] = [2, 1, -2, 0, 0, 0, 0];
const POWER: [i32; 7] = [2, 1, -3, 0, 0, 0, 0];
const PRESSURE: [i32; 7] = [-1, 1, -2, 0, 0, 0, 0];

/// Every unit. A symbol is looked up whole before it is split into prefix and unit, so `min` is
/// the minute, `cd` the candela and `Pa` the pascal.
pub const UNITS: &[UnitEntry] = &[
    si("m", "metre", LENGTH),
    UnitEntry {
        size: (1, 1000),
        ..si("g", "gram", MASS)
    },
    si("s", "second", TIME),
    si("A", "ampere", [0, 0, 0, 1, 0, 0, 0]),
    si("K", "kelvin", [0, 0, 0, 0, 1, 0, 0]),
    si("mol", "mole", [0, 0, 0, 0, 0, 1, 0]),
    si("cd", "candela", [0, 0, 0, 0, 0, 0, 1]),
    si("rad", "radian", NONE),
    si("Hz", "hertz", PER_TIME),
    si("N", "newton", FORCE),
    si("J", "joule", ENERGY),
    si("W", "watt", POWER),
    si("Pa", "pascal", PRESSURE),
    si("C", "coulomb", [0, 0, 1, 1, 0, 0, 0]),
    si("V", "volt", [2, 1, -3, -1, 0, 0, 0]),
    si("F", "farad", [-2, -1, 4, 2, 0, 0, 0]),
    si("ohm", "ohm", [2, 1, -3, -2, 0, 0, 0]),
    si("Wb", "weber", [2, 1, -2, -1, 0, 0, 0]),
    si("T", "tesla", [0, 1, -2, -1, 0, 0, 0]),
    si("H", "henry", [2, 1, -2, -2, 0, 0, 0]),
    angle("deg", "degree of angle", NONE, (1, 180)),
    angle("rev", "revolution", NONE, (2, 1)),
    angle("rpm", "revolution per minute", PER_TIME, (1, 30)),
    fixed("%", "percent", NONE, (1, 100)),
    fixed("min", "minute", TIME, (60, 1)),
    fixed("h", "hour", TIME, (3600, 1)),
    fixed("d", "day", TIME, (86_400, 1)),
    fixed("t", "tonne", MASS, (1000, 1)),
    UnitEntry {
        size: (1, 1000),
        ..si("l", "litre", [3, 0, 0, 0, 0, 0, 0])
    },
    UnitEntry {
        size: (100_000, 1),
        ..si("bar", "bar", PRESSURE)
    },
    fixed("in", "inch", LENGTH, (254, 10_000)),
    fixed("ft", "foot", LENGTH, (3048, 10_000)),
    fixed("mi", "mile", LENGTH, (1_609_344, 1000)),
    fixed("mph", "mile per hour", VELOCITY, (1_609_344, 3_600_000)),
    fixed("lb", "pound", MASS, (45_359_237, 100_000_000)),
    fixed(
        "lbf",
        "pound-force",
        FORCE,
        (44_482_216_152_605, 10_000_000_000_000),
    ),
];

/// Names of dimensions, and their usual units.
const QUANTITIES: &[([i32; 7], &str, &str)] = &[
    (NONE, "a pure number or an angle", "1"),
    (LENGTH, "a length", "m"),
    (MASS, "a mass", "kg"),
    (TIME, "a time", "s"),
    (PER_TIME, "a rate (1/s)", "1/s"),
    ([0, 0, -2, 0, 0, 0, 0], "an angular acceleration", "1/s^2"),
    ([2, 0, 0, 0, 0, 0, 0], "an area", "m^2"),
    ([3, 0, 0, 0, 0, 0, 0], "a volume", "m^3"),
    (VELOCITY, "a velocity", "m/s"),
    ([1, 0, -2, 0, 0, 0, 0], "an acceleration", "m/s^2"),
    (FORCE, "a force", "N"),
    (ENERGY, "a torque or an energy", "N*m"),
    (POWER, "a power", "W"),
    (PRESSURE, "a pressure", "Pa"),
    ([1, 1, -1, 0, 0, 0, 0], "a momentum", "kg*m/s"),
    ([2, 1, -1, 0, 0, 0, 0], "an angular momentum", "kg*m^2/s"),
    ([2, 1, 0, 0, 0, 0, 0], "a moment of inertia", "kg*m^2"),
    ([1, 1, 0, 0, 0, 0, 0], "a mass times a length", "kg*m"),
    ([0, 1, -2, 0, 0, 0, 0], "a stiffness", "N/m"),
    ([0, 1, -1, 0, 0, 0, 0], "a damping coefficient", "N*s/m"),
    ([-3, 1, 0, 0, 0, 0, 0], "a density", "kg/m^3"),
    ([0, 0, 0, 1, 0, 0, 0], "a current", "A"),
    ([0, 0, 0, 0, 1, 0, 0], "a temperature", "K"),
    ([2, 1, -3, -1, 0, 0, 0], "a voltage", "V"),
];

fn known(dimension: &Dimension) -> Option<&'static ([i32; 7], &'static str, &'static str)> {
    QUANTITIES
        .iter()
        .find(|(powers, _, _)| Dimension::integers(*powers) == *dimension)
}

/// `a length`, if the dimension has a name.
pub(super) fn quantity_word(dimension: &Dimension) -> Option<&'static str> {
    known(dimension).map(|(_, word, _)| *word)
}

/// The SI unit of a dimension in its usual notation.
pub(super) fn si_text(dimension: &Dimension) -> String {
    if let Some((_, _, unit)) = known(dimension) {
        return (*unit).to_owned();
    }
    let mut above = String::new();
    let mut below = String::new();
    for (base, exponent) in BASE_UNITS.iter().zip(dimension.exponents()) {
        if exponent.is_zero() {
            continue;
        }
        let positive = *exponent.numer() > 0;
        let size = if positive { *exponent } else { -*exponent };
        let text = if positive { &mut above } else { &mut below };
        if !text.is_empty() {
            text.push('*');
        }
        text.push_str(base);
        // Writing to a string cannot fail.
        if !size.is_integer() {
            let _ = write!(text, "^({size})");
        } else if !size.is_one() {
            let _ = write!(text, "^{size}");
        }
    }
    let above = if above.is_empty() {
        "1".to_owned()
    } else {
        above
    };
    match below.matches('*').count() {
        _ if below.is_empty() => above,
        0 => format!("{above}/{below}"),
        _ => format!("{above}/({below})"),
    }
}
