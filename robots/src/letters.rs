//! Numbers of a spec: written out, or as parameters with a letter.

use std::collections::BTreeSet;

use appell_spec::did_you_mean;

use crate::dictionary::Entry;
use crate::failure::Failure;
use crate::names::Names;
use crate::patterns::{self, Patterns};

/// Which numbers become parameters of the spec. The others are written out, so that zeros simplify the equations.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Letters {
    /// None.
    #[default]
    None,
    /// Masses, centres of mass and inertias.
    Inertias,
    /// All that are not zero, and the inertias.
    All,
    /// Those of links, joints or parameters with these names.
    Of(Vec<String>),
    /// Those with these names or patterns `ELEMENT.ATTRIBUTE`, where `*` stands for any characters: `elbow.damping`,
    /// `*.mass`, `hand.com`, `hand.com.x`, `gravity`. The [dictionary](crate::Dictionary) has the parameters. A pattern
    /// leaves zeros alone, except those of a centre of mass.
    Matching(Vec<String>),
}

impl Letters {
    /// Reads `none`, `inertias`, `all` or names separated by commas: all of them names of links, joints and parameters,
    /// or some of them names and patterns `ELEMENT.ATTRIBUTE`.
    pub fn read(text: &str) -> Self {
        match text.trim() {
            "none" => Self::None,
            "inertias" => Self::Inertias,
            "all" => Self::All,
            names => {
                let names = names
                    .split(',')
                    .map(str::trim)
                    .filter(|name| !name.is_empty());
                let names: Vec<String> = names.map(str::to_owned).collect();
                if names.iter().any(|name| patterns::has_attribute(name)) {
                    Self::Matching(names)
                } else {
                    Self::Of(names)
                }
            }
        }
    }
}

/// Kind of a number, which decides whether it becomes a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Kind {
    /// Of a mass, a centre of mass or an inertia.
    Inertial,
    /// Anything else.
    #[default]
    Other,
}

/// A number of the robot.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Number<'a> {
    pub(crate) value: f64,
    pub(crate) unit: &'static str,
    /// The name that it has as a parameter.
    pub(crate) letter: &'a str,
    /// The link, joint or actuator that it belongs to, as the file calls it.
    pub(crate) of: &'a str,
    /// The attribute of that element that it is, as far as patterns select it.
    pub(crate) attribute: &'static str,
    pub(crate) about: &'a str,
    pub(crate) kind: Kind,
    pub(crate) never_negative: bool,
}

/// A parameter of the spec.
#[derive(Debug)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) value: f64,
    pub(crate) unit: &'static str,
    pub(crate) about: String,
    pub(crate) never_negative: bool,
}

/// Chooses the form of each number, and collects the parameters.
#[derive(Debug)]
pub(crate) struct Numbers<'a> {
    letters: &'a Letters,
    pub(crate) parameters: Vec<Parameter>,
    /// Names that matched a number.
    used: BTreeSet<String>,
    /// All names that can be matched.
    known: BTreeSet<String>,
    /// The patterns of [`Letters::Matching`].
    pub(crate) patterns: Patterns<'a>,
    /// Parameters that are attributes of the file.
    pub(crate) entries: Vec<Entry>,
}

impl<'a> Numbers<'a> {
    pub(crate) fn new(letters: &'a Letters) -> Self {
        Self {
            letters,
            parameters: Vec::new(),
            used: BTreeSet::new(),
            known: BTreeSet::new(),
            patterns: Patterns::new(match letters {
                Letters::Matching(patterns) => patterns,
                _ => &[],
            }),
            entries: Vec::new(),
        }
    }

    /// The expression of a number.
    pub(crate) fn write(&mut self, number: Number<'_>, names: &mut Names) -> String {
        let of = if number.attribute.starts_with("gravity") {
            "gravity"
        } else {
            number.of
        };
        let names_of = [number.letter, of];
        self.known.extend(names_of.map(str::to_owned));
        let chosen = match self.letters {
            Letters::Matching(_) => {
                (self.patterns).choose(number.of, number.attribute, number.value)
            }
            Letters::None => false,
            Letters::Inertias => number.kind == Kind::Inertial,
            Letters::All => number.kind == Kind::Inertial || number.value != 0.0,
            Letters::Of(chosen) => {
                let of_it: Vec<&String> = chosen
                    .iter()
                    .filter(|one| names_of.contains(&one.as_str()))
                    .collect();
                self.used.extend(of_it.iter().map(|one| (*one).clone()));
                // A link or joint selects its inertias and nonzero numbers; a parameter name selects any value.
                of_it.iter().any(|one| *one == number.letter)
                    || (!of_it.is_empty() && (number.kind == Kind::Inertial || number.value != 0.0))
            }
        };
        if !chosen {
            return quantity(number.value, number.unit);
        }
        let name = names.new_one(number.letter);
        if matches!(self.letters, Letters::Matching(_)) {
            self.entries.push(Entry {
                element: number.of.to_owned(),
                attribute: number.attribute,
                parameter: name.clone(),
                value: number.value,
                relative: false,
            });
        }
        self.parameters.push(Parameter {
            name: name.clone(),
            value: number.value,
            unit: number.unit,
            about: number.about.to_owned(),
            never_negative: number.never_negative,
        });
        name
    }

    /// A factor of a property of an element, 1 as the file has it; `None` if the property is not selected.
    pub(crate) fn factor(&mut self, number: Number<'_>, names: &mut Names) -> Option<String> {
        if !self.patterns.choose(number.of, number.attribute, 1.0) {
            return None;
        }
        let name = self.write(
            Number {
                value: 1.0,
                unit: "1",
                ..number
            },
            names,
        );
        if let Some(entry) = self.entries.last_mut() {
            entry.relative = true;
        }
        Some(name)
    }

    /// The first chosen name that matched nothing, with one that would have matched.
    pub(crate) fn unknown(&self) -> Option<Failure> {
        let (name, known) = match self.letters {
            Letters::Matching(_) => (self.patterns.unknown()?, &self.patterns.known),
            Letters::Of(chosen) => {
                let mut unused = chosen.iter().filter(|one| !self.used.contains(*one));
                (unused.next()?, &self.known)
            }
            _ => return None,
        };
        let otherwise = || "name links, joints or parameters of the robot".to_owned();
        Some(Failure::Unknown {
            name: name.clone(),
            help: did_you_mean(name, known.iter().map(String::as_str), otherwise),
        })
    }
}

/// A number without rounding errors: 0.3, not 0.30000000000000004.
pub(crate) fn tidy(x: f64) -> f64 {
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let rounded: f64 = format!("{x:.13e}").parse().unwrap_or(x);
    let short = if (rounded - x).abs() <= ROUNDING * x.abs() {
        rounded
    } else {
        x
    };
    // A zero has no sign.
    short + 0.0
}

/// A number in the syntax of TOML and of expressions.
pub(crate) fn plain(x: f64) -> String {
    let x = tidy(x);
    if x != 0.0 && !(1e-4..1e7).contains(&x.abs()) {
        format!("{x:e}")
    } else {
        format!("{x}")
    }
}

/// A number with its unit, as an expression; zero has none.
pub(crate) fn quantity(x: f64, unit: &str) -> String {
    match (plain(x), unit) {
        (zero, _) if zero == "0" => zero,
        (number, "1") => number,
        (number, "rad") => angle(x).unwrap_or(number),
        (number, unit) => format!("{number} [{unit}]"),
    }
}

/// An angle that is a simple part of π.
fn angle(x: f64) -> Option<String> {
    use std::f64::consts::PI;
    for parts in [1_u8, 2, 3, 4, 6] {
        let count = (x * f64::from(parts) / PI).round();
        let exact = count * PI / f64::from(parts);
        let same = (x - exact).abs() <= 2.0 * f64::EPSILON * x.abs();
        if count == 0.0 || count.abs() > 12.0 || !same {
            continue;
        }
        let head = match count {
            1.0 => "pi".to_owned(),
            -1.0 => "-pi".to_owned(),
            count => format!("{count}*pi"),
        };
        return Some(if parts == 1 {
            head
        } else {
            format!("{head}/{parts}")
        });
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_they_were_written() {
        for (x, expected) in [
            (0.1 + 0.2, "0.3"),
            (0.1, "0.1"),
            (1.0 / 3.0, "0.3333333333333333"),
            (-0.0, "0"),
            (1e-7, "1e-7"),
            (12345.678, "12345.678"),
        ] {
            assert_eq!(plain(x), expected);
        }
    }

    #[test]
    fn angles_that_are_parts_of_a_turn_are_told_by_pi() {
        use std::f64::consts::PI;
        for (x, expected) in [
            (PI / 2.0, "pi/2"),
            (-PI, "-pi"),
            (0.75 * PI, "3*pi/4"),
            (PI / 2.0 + 1e-11, "1.5707963268048966"),
            (0.3, "0.3"),
            (0.0, "0"),
        ] {
            assert_eq!(quantity(x, "rad"), expected);
        }
    }
}
