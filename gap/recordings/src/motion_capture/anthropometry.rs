//! Mass distribution of the human body: published tables.

/// A table of segment masses and centres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anthropometry {
    /// Its name in a skeleton file.
    pub name: &'static str,
    /// Where it was published.
    pub source: &'static str,
    /// Its segments.
    pub parts: &'static [Part],
}

/// A segment of the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Its name in a skeleton file.
    pub name: &'static str,
    /// Fraction of the mass of the whole body.
    pub mass: f64,
    /// Position of its centre of mass, as a fraction of the distance from its first end to its
    /// second.
    pub centre: f64,
}

const fn part(name: &'static str, mass: f64, centre: f64) -> Part {
    Part { name, mass, centre }
}

/// The tables. First ends are the upper ones: vertex, shoulder, elbow, wrist, hip, knee, heel.
pub const TABLES: &[Anthropometry] = &[
    Anthropometry {
        name: "de_leva_men",
        source: "P. de Leva, Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters, Journal of \
                 Biomechanics 29 (1996), table 4",
        parts: &[
            part("head", 0.0694, 0.5976),
            part("trunk", 0.4346, 0.4486),
            part("upper_arm", 0.0271, 0.5772),
            part("forearm", 0.0162, 0.4574),
            part("hand", 0.0061, 0.7900),
            part("thigh", 0.1416, 0.4095),
            part("shank", 0.0433, 0.4459),
            part("foot", 0.0137, 0.4415),
        ],
    },
    Anthropometry {
        name: "de_leva_women",
        source: "P. de Leva, Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters, Journal of \
                 Biomechanics 29 (1996), table 4",
        parts: &[
            part("head", 0.0668, 0.5894),
            part("trunk", 0.4257, 0.4151),
            part("upper_arm", 0.0255, 0.5754),
            part("forearm", 0.0138, 0.4559),
            part("hand", 0.0056, 0.7474),
            part("thigh", 0.1478, 0.3612),
            part("shank", 0.0481, 0.4416),
            part("foot", 0.0129, 0.4014),
        ],
    },
    Anthropometry {
        name: "winter",
        source: "D. A. Winter, Biomechanics and Motor Control of Human Movement, 4th edition (2009), table 4.1",
        parts: &[
            part("head", 0.081, 0.5),
            part("trunk", 0.497, 0.5),
            part("upper_arm", 0.028, 0.436),
            part("forearm", 0.016, 0.430),
            part("hand", 0.006, 0.506),
            part("thigh", 0.100, 0.433),
            part("shank", 0.0465, 0.433),
            part("foot", 0.0145, 0.5),
        ],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Paired segments.
    const PAIRED: [&str; 6] = ["upper_arm", "forearm", "hand", "thigh", "shank", "foot"];
    /// The tables are printed with four digits.
    const PRINTED: f64 = 2e-4;

    #[test]
    fn the_parts_of_every_table_make_a_whole_body() {
        for table in TABLES {
            let times = |part: &Part| {
                if PAIRED.contains(&part.name) {
                    2.0
                } else {
                    1.0
                }
            };
            let whole: f64 = table.parts.iter().map(|part| times(part) * part.mass).sum();
            assert!((whole - 1.0).abs() < PRINTED, "{}: {whole}", table.name);
        }
    }
}
