//! Unit texts: products, quotients and powers of unit symbols.

use std::ops::Range;

use num_bigint::BigInt;
use num_rational::{BigRational, Ratio};
use num_traits::{One, Pow};

use super::Unit;
use super::dimension::{Dimension, Exponent};
use super::table::{PREFIXES, UNITS, UnitEntry};
use crate::suggest;

/// Longest unit text, in bytes.
const MAX_LENGTH: usize = 64;
/// Largest exponent of a unit.
const MAX_EXPONENT: i32 = 12;
/// Deepest nesting of parentheses.
const MAX_DEPTH: usize = 8;

/// Why a unit text was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum UnitError {
    /// Unknown unit.
    #[error("unknown unit `{symbol}`")]
    Unknown {
        /// The symbol.
        symbol: String,
        /// Its position in the unit text.
        at: Range<usize>,
        /// A similar unit.
        similar: Option<String>,
    },
    /// Invalid unit.
    #[error("{message}")]
    Syntax {
        /// The message.
        message: String,
        /// Its position in the unit text.
        at: Range<usize>,
    },
}

/// A partial product.
#[derive(Clone)]
struct Product {
    dimension: Dimension,
    factor: BigRational,
    pi_power: i8,
}

/// Reads a unit text such as `kg*m^2`, `N s/m` or `deg/s`.
pub fn parse(text: &str) -> Result<Unit, UnitError> {
    if text.len() > MAX_LENGTH {
        return Err(UnitError::Syntax {
            message: format!("a unit has at most {MAX_LENGTH} characters"),
            at: 0..text.len(),
        });
    }
    let mut parser = Parser { text, at: 0 };
    parser.skip_space();
    if parser.peek().is_none() {
        return Err(parser.error("the unit is empty; a pure number has the unit `1`"));
    }
    let product = parser.product(0)?;
    if parser.peek().is_some() {
        let (before, rest) = text.split_at(parser.at);
        return Err(parser.error(&match parser.peek() {
            Some('.') => {
                "a product is written with `*`, a fractional exponent as `^(1/2)`".to_owned()
            }
            Some('0'..='9') => format!("a power is written with `^`, as in `{before}^{rest}`"),
            _ => "this does not belong in a unit".to_owned(),
        }));
    }
    Ok(Unit::new(
        text.trim(),
        product.dimension,
        product.factor,
        product.pi_power,
    ))
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
}

impl Parser<'_> {
    fn peek(&self) -> Option<char> {
        self.text
            .get(self.at..)
            .and_then(|rest| rest.chars().next())
    }

    fn skip(&mut self, c: char) {
        self.at += c.len_utf8();
    }

    fn skip_space(&mut self) {
        while self.peek() == Some(' ') {
            self.at += 1;
        }
    }

    fn error(&self, message: &str) -> UnitError {
        let end = self.peek().map_or(self.at, |c| self.at + c.len_utf8());
        UnitError::Syntax {
            message: message.to_owned(),
            at: self.at..end,
        }
    }

    fn product(&mut self, depth: usize) -> Result<Product, UnitError> {
        let mut result = self.power(depth)?;
        let mut divided = false;
        loop {
            let spaced = self.peek() == Some(' ');
            self.skip_space();
            match self.peek() {
                Some(c @ ('*' | '·')) => {
                    self.skip(c);
                    self.skip_space();
                    let factor = self.power(depth)?;
                    result = self.combine(&result, &factor, false)?;
                }
                Some('/') => {
                    self.skip('/');
                    self.skip_space();
                    let divisor = self.power(depth)?;
                    result = self.combine(&result, &divisor, true)?;
                    divided = true;
                }
                Some(c) if spaced && c != ')' => {
                    if divided {
                        return Err(self.error(
                            "a blank after a quotient is ambiguous; use `*`, `/` or parentheses",
                        ));
                    }
                    let factor = self.power(depth)?;
                    result = self.combine(&result, &factor, false)?;
                }
                _ => return Ok(result),
            }
        }
    }

    fn combine(&self, a: &Product, b: &Product, divide: bool) -> Result<Product, UnitError> {
        let exponent = Exponent::from_integer(if divide { -1 } else { 1 });
        let b = self.raise(b, exponent)?;
        let dimension = a
            .dimension
            .times(&b.dimension)
            .map_err(|e| self.error(&e.to_string()))?;
        Ok(Product {
            dimension,
            factor: &a.factor * &b.factor,
            pi_power: a.pi_power.saturating_add(b.pi_power),
        })
    }

    fn power(&mut self, depth: usize) -> Result<Product, UnitError> {
        let base = self.atom(depth)?;
        match self.peek() {
            Some('^') => {
                self.skip('^');
                let exponent = self.exponent()?;
                self.raise(&base, exponent)
            }
            Some(c @ ('²' | '³')) => {
                self.skip(c);
                self.raise(&base, Exponent::from_integer(if c == '²' { 2 } else { 3 }))
            }
            _ => Ok(base),
        }
    }

    fn raise(&self, base: &Product, exponent: Exponent) -> Result<Product, UnitError> {
        let dimension = base
            .dimension
            .power(exponent)
            .map_err(|e| self.error(&e.to_string()))?;
        if exponent.is_integer() {
            let n = exponent.to_integer();
            // The exponents of π stay small: at most 32 symbols with |n| ≤ 12.
            let pi_power = i32::from(base.pi_power).saturating_mul(n).clamp(-100, 100);
            return Ok(Product {
                dimension,
                factor: Pow::pow(&base.factor, n),
                pi_power: i8::try_from(pi_power).unwrap_or(0),
            });
        }
        if base.factor.is_one() && base.pi_power == 0 {
            return Ok(Product {
                dimension,
                ..base.clone()
            });
        }
        Err(self.error("a fractional power needs SI units without prefix"))
    }

    fn exponent(&mut self) -> Result<Exponent, UnitError> {
        let parenthesised = self.peek() == Some('(');
        if parenthesised {
            self.skip('(');
        }
        let numerator = self.integer()?;
        let mut exponent = Ratio::from_integer(numerator);
        if parenthesised {
            if self.peek() == Some('/') {
                self.skip('/');
                let denominator = self.integer()?;
                if denominator == 0 {
                    return Err(self.error("the exponent divides by zero"));
                }
                exponent = Ratio::new(numerator, denominator);
            }
            if self.peek() != Some(')') {
                return Err(self.error("expected `)` after the exponent"));
            }
            self.skip(')');
        }
        Ok(exponent)
    }

    fn integer(&mut self) -> Result<i32, UnitError> {
        let negative = self.peek() == Some('-');
        if negative {
            self.skip('-');
        }
        let start = self.at;
        while self.peek().is_some_and(|c| c.is_ascii_digit()) {
            self.at += 1;
        }
        let digits = self.text.get(start..self.at).unwrap_or_default();
        match digits.parse::<i32>() {
            Ok(n) if n <= MAX_EXPONENT => Ok(if negative { -n } else { n }),
            Ok(_) => Err(self.error("the exponent is too large")),
            Err(_) => Err(self.error("expected an integer exponent")),
        }
    }

    fn atom(&mut self, depth: usize) -> Result<Product, UnitError> {
        match self.peek() {
            Some('(') if depth < MAX_DEPTH => {
                self.skip('(');
                self.skip_space();
                let inner = self.product(depth + 1)?;
                if self.peek() != Some(')') {
                    return Err(self.error("expected `)`"));
                }
                self.skip(')');
                Ok(inner)
            }
            Some('1') => {
                self.skip('1');
                if self.peek().is_some_and(|c| c.is_alphanumeric() || c == '.') {
                    return Err(self.error("a unit cannot contain a number other than `1`"));
                }
                Ok(Product {
                    dimension: Dimension::NONE,
                    factor: BigRational::one(),
                    pi_power: 0,
                })
            }
            Some(c @ ('%' | '°')) => {
                let start = self.at;
                self.skip(c);
                self.symbol(start)
            }
            Some(c) if c.is_alphabetic() => {
                let start = self.at;
                while let Some(c) = self.peek().filter(|c| c.is_alphabetic()) {
                    self.skip(c);
                }
                self.symbol(start)
            }
            _ => Err(self.error("expected a unit; a pure number has the unit `1`")),
        }
    }

    fn symbol(&self, start: usize) -> Result<Product, UnitError> {
        let at = start..self.at;
        let symbol = self.text.get(at.clone()).unwrap_or_default();
        // `kgm2` lacks the signs of multiplication and power.
        let rest = self.text.get(self.at..).unwrap_or_default();
        let digits = rest.strip_prefix('^').unwrap_or(rest);
        let count = digits.bytes().take_while(u8::is_ascii_digit).count();
        let power = match digits.get(..count) {
            Some(digits) if count > 0 => format!("^{digits}"),
            _ => String::new(),
        };
        lookup(symbol).ok_or_else(|| UnitError::Unknown {
            symbol: symbol.to_owned(),
            at,
            similar: similar(symbol).map(|similar| similar + &power),
        })
    }
}

/// Whether a symbol is one of angles.
pub(super) fn is_angle(symbol: &str) -> bool {
    entry(symbol).is_some_and(|(unit, _)| unit.is_angle())
}

fn lookup(symbol: &str) -> Option<Product> {
    let (unit, ten) = entry(symbol)?;
    Some(product(unit.powers, unit.size, unit.times_pi, ten))
}

/// A symbol, whole or with a prefix: its unit, and the power of ten before it.
fn entry(symbol: &str) -> Option<(&'static UnitEntry, i32)> {
    // The sign of the degree is read, and written as `deg`; the Greek letter of keyboards is the sign of micro.
    let micro = symbol
        .strip_prefix('\u{3bc}')
        .map(|rest| format!("\u{b5}{rest}"));
    let symbol = match symbol {
        "°" => "deg",
        symbol => micro.as_deref().unwrap_or(symbol),
    };
    let whole = UNITS.iter().find(|unit| unit.symbol == symbol);
    if let Some(unit) = whole {
        return Some((unit, 0));
    }
    PREFIXES.iter().find_map(|(prefix, ten)| {
        let rest = symbol.strip_prefix(prefix)?;
        let unit = UNITS.iter().find(|u| u.prefixed && u.symbol == rest)?;
        Some((unit, *ten))
    })
}

fn product(powers: [i32; 7], size: (i64, i64), times_pi: bool, ten: i32) -> Product {
    let size = BigRational::new(BigInt::from(size.0), BigInt::from(size.1));
    let prefix = Pow::pow(BigRational::from_integer(BigInt::from(10)), ten);
    Product {
        dimension: Dimension::integers(powers),
        factor: size * prefix,
        pi_power: i8::from(times_pi),
    }
}

/// A symbol as a product of up to three different units: the first with a prefix or whole, the others whole; or else of
/// two of any kind.
fn factors(symbol: &str) -> Option<String> {
    const MOST: usize = 3;
    const LONGEST: usize = 8;
    type Is<'f> = &'f dyn Fn(&str) -> bool;
    fn split(
        symbol: &str,
        [first, others]: [Is<'_>; 2],
        before: &[&str],
        most: usize,
    ) -> Option<String> {
        let is_one = |part: &str| first(part) && !before.contains(&part);
        if most == 1 {
            return is_one(symbol).then(|| symbol.to_owned());
        }
        let cuts = (1..symbol.len()).filter_map(|at| symbol.split_at_checked(at));
        let mut cuts = cuts.filter(|(own, _)| is_one(own));
        cuts.find_map(|(own, rest)| {
            let before = [before, &[own]].concat();
            let rest = split(rest, [others; 2], &before, most - 1)?;
            Some(format!("{own}*{rest}"))
        })
    }
    // `Nms` has seconds in it rather than milliseconds, `Nmm` millimetres rather than square metres.
    let whole = |part: &str| part == "kg" || UNITS.iter().any(|unit| unit.symbol == part);
    let any = |part: &str| lookup(part).is_some();
    let few = |kinds: [Is<'_>; 2], most: usize| {
        (2..=most).find_map(|most| split(symbol, kinds, &[], most))
    };
    if symbol.len() > LONGEST {
        return None;
    }
    few([&whole, &whole], MOST)
        .or_else(|| few([&any, &whole], MOST))
        .or_else(|| few([&any, &any], 2))
}

/// A unit in different case; of prefixes only `k` is unambiguous.
fn in_other_case(symbol: &str) -> Option<String> {
    let same = |a: &str| {
        UNITS
            .iter()
            .find(|unit| unit.symbol.eq_ignore_ascii_case(a))
    };
    if symbol.len() > 1
        && let Some(unit) = same(symbol)
    {
        return Some(unit.symbol.to_owned());
    }
    let unit = same(symbol.strip_prefix(['k', 'K'])?).filter(|unit| unit.prefixed)?;
    Some(format!("k{}", unit.symbol))
}

fn similar(symbol: &str) -> Option<String> {
    let spoken = UNITS
        .iter()
        .find(|u| {
            symbol.eq_ignore_ascii_case(u.name)
                || symbol.eq_ignore_ascii_case(&format!("{}s", u.name))
        })
        .map(|u| u.symbol.to_owned());
    let common = match symbol {
        "sec" | "S" => Some("s"),
        "meter" | "meters" => Some("m"),
        "degrees" | "degree" => Some("deg"),
        "radians" => Some("rad"),
        "kilogram" => Some("kg"),
        "degC" | "celsius" => Some("K"),
        "kmh" | "kph" => Some("km/h"),
        "mps" => Some("m/s"),
        "dps" => Some("deg/s"),
        "Ω" => Some("ohm"),
        "L" => Some("l"),
        _ => None,
    };
    spoken
        .or_else(|| common.map(str::to_owned))
        .or_else(|| in_other_case(symbol))
        .or_else(|| factors(symbol))
        .or_else(|| suggest::closest(symbol, UNITS.iter().map(|u| u.symbol)).map(str::to_owned))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(text: &str) -> f64 {
        parse(text).map_or(f64::NAN, |u| u.scale)
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "scales are exact fractions rounded once")]
    fn sizes_are_exact_where_si_says_so() {
        assert_eq!(scale("mm"), 0.001);
        assert_eq!(scale("g"), 0.001);
        assert_eq!(scale("kg"), 1.0);
        assert_eq!(scale("min"), 60.0);
        assert_eq!(scale("km/h"), 1.0 / 3.6);
        assert_eq!(scale("N s/m"), 1.0);
        assert_eq!(scale("kN*mm"), 1.0);
        assert_eq!(scale("g/cm^3"), 1000.0);
        assert_eq!(scale("deg"), std::f64::consts::PI / 180.0);
        assert_eq!(scale("%"), 0.01);
        assert_eq!(scale("1/min"), 1.0 / 60.0);
        assert_eq!(scale("mm²"), 1e-6);
        assert_eq!(scale("\u{b5}m"), scale("um"));
        assert_eq!(scale("\u{3bc}m"), scale("um"));
    }

    #[test]
    fn angles_are_told_from_pure_numbers() {
        for (text, is_angle, has_angle) in [
            ("rad", true, true),
            ("deg", true, true),
            ("mrad", true, true),
            ("rev", true, true),
            ("1", false, false),
            ("%", false, false),
            ("m/m", false, false),
            ("deg/s", false, true),
            ("rpm", false, true),
            ("N*m/rad", false, true),
            ("N*m", false, false),
        ] {
            let unit = parse(text).expect(text);
            assert_eq!(
                (unit.is_angle(), unit.has_angle()),
                (is_angle, has_angle),
                "{text}"
            );
        }
    }

    #[test]
    fn refused_texts_say_why() {
        for (text, expected) in [
            ("", "the unit is empty; a pure number has the unit `1`"),
            ("5 m", "expected a unit; a pure number has the unit `1`"),
            (
                "m^0.5",
                "a product is written with `*`, a fractional exponent as `^(1/2)`",
            ),
            ("m^99", "the exponent is too large"),
            (
                "N/m s",
                "a blank after a quotient is ambiguous; use `*`, `/` or parentheses",
            ),
            ("(m", "expected `)`"),
            ("furlong", "unknown unit `furlong`"),
            (
                "deg^(1/2)",
                "a fractional power needs SI units without prefix",
            ),
        ] {
            let message = parse(text).map_or_else(|e| e.to_string(), |u| u.text);
            assert_eq!(message, expected, "{text}");
        }
    }

    #[test]
    fn what_is_no_product_of_units_is_not_proposed_as_one() {
        for text in ["slug", "furlong"] {
            let Err(UnitError::Unknown { similar, .. }) = parse(text) else {
                panic!("{text} is a unit");
            };
            assert!(!similar.is_some_and(|one| one.contains('*')), "{text}");
        }
    }

    #[test]
    fn similar_units_are_proposed() {
        for (text, expected) in [
            ("Nm", "N*m"),
            ("kgm", "kg*m"),
            ("kgm2", "kg*m^2"),
            ("kgm^2", "kg*m^2"),
            ("Nms", "N*m*s"),
            ("Nmm", "N*mm"),
            ("mNm", "mN*m"),
            ("kNm", "kN*m"),
            ("kNms", "kN*m*s"),
            ("Nmm2", "N*mm^2"),
            ("KN", "kN"),
            ("kn", "kN"),
            ("KG", "kg"),
            ("HZ", "Hz"),
            ("khz", "kHz"),
            ("dps", "deg/s"),
            ("mps", "m/s"),
            ("Nm/rad", "N*m"),
            ("kgm2/s", "kg*m^2"),
            ("sec", "s"),
            ("metre", "m"),
            ("dge", "deg"),
            ("degrees", "deg"),
        ] {
            let Err(UnitError::Unknown { similar, .. }) = parse(text) else {
                panic!("{text} is a unit");
            };
            assert_eq!(similar.as_deref(), Some(expected));
        }
    }
}
