//! Letters: the form of a name in a formula.
//!
//! `omega_1` is ω with index 1, `theta` is θ, `x_G` is x with the label G, `m0` is m with index 0,
//! `gamma_dot` is γ with a dot.

/// Greek letters that have names of their own.
const GREEK: &str = "alpha=α beta=β gamma=γ delta=δ epsilon=ε zeta=ζ eta=η theta=θ iota=ι kappa=κ lambda=λ mu=μ nu=ν \
    xi=ξ pi=π rho=ρ sigma=σ tau=τ upsilon=υ phi=φ chi=χ psi=ψ omega=ω Gamma=Γ Delta=Δ Theta=Θ \
    Lambda=Λ Xi=Ξ Pi=Π Sigma=Σ Phi=Φ Psi=Ψ Omega=Ω";

/// Their names and letters.
fn greek_letters() -> impl Iterator<Item = (&'static str, &'static str)> {
    GREEK.split(' ').filter_map(|row| row.split_once('='))
}

/// A letter with its dots, subscripts and superscript.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Letter {
    /// The base: one letter, Greek or Latin, or a word.
    pub base: String,
    /// Whether it names a vector or a matrix.
    pub bold: bool,
    /// Dots above: time derivatives.
    pub dots: u8,
    /// Subscripts, in order.
    pub below: Vec<String>,
    /// Superscript, such as the 0 of a⁰.
    pub above: Option<String>,
    /// δ before a virtual quantity, d before a differential, ∂ before a partial one.
    pub before: Option<char>,
    /// The variable `by` of `∂letter/∂by`.
    pub by: Option<Box<Letter>>,
}

impl Letter {
    /// A letter without decoration.
    pub fn plain(base: &str) -> Self {
        Self {
            base: base.to_owned(),
            ..Self::default()
        }
    }

    /// A bold letter: a vector or a matrix.
    pub fn bold(base: &str) -> Self {
        Self {
            bold: true,
            ..Self::plain(base)
        }
    }

    /// The letter of an identifier, which is split at its underscores: `omega_1_dot` is ω̇₁, `m_W` is m with
    /// label W.
    ///
    /// Parts `dot` and `ddot` are dots. Digits at the end of a letter are an index, as in `x1`. A word
    /// as a base keeps its underscores: `wheel_radius` is one word. `d_a_d_b` is ∂a/∂b.
    pub fn of(identifier: &str) -> Self {
        if let Some((name, by)) = identifier
            .strip_prefix("d_")
            .and_then(|rest| rest.split_once("_d_"))
            && !by.contains("_d_")
        {
            return Self {
                by: Some(Box::new(Self::of_parts(by))),
                ..Self::of_parts(name)
            };
        }
        Self::of_parts(identifier)
    }

    fn of_parts(identifier: &str) -> Self {
        let mut dots = 0;
        let mut parts: Vec<&str> = Vec::new();
        for part in identifier.split('_') {
            match part {
                "dot" if !parts.is_empty() => dots += 1,
                "ddot" if !parts.is_empty() => dots += 2,
                _ => parts.push(part),
            }
        }
        let first = parts.first().copied().unwrap_or_default();
        let stem = first.trim_end_matches(|c: char| c.is_ascii_digit());
        // Empty parts come from doubled underscores; they are kept by using the whole identifier.
        if dots > 2 || stem.is_empty() || parts.iter().any(|p| p.is_empty()) {
            return Self::plain(identifier);
        }
        let is_letter = stem.chars().count() == 1 || greek(stem).is_some();
        let (base, below) = if is_letter {
            let index = Some(&first[stem.len()..]).filter(|index| !index.is_empty());
            let labels = index.into_iter().chain(parts[1..].iter().copied());
            (label(stem), labels.map(label).collect())
        } else {
            // Numbers at the end of a word are indices, its other parts belong to it.
            let is_number = |part: &&&str| part.bytes().all(|b| b.is_ascii_digit());
            let numbers = parts.iter().rev().take_while(is_number).count();
            let (word, numbers) = parts.split_at(parts.len() - numbers);
            (
                word.join("_"),
                numbers.iter().map(|&n| n.to_owned()).collect(),
            )
        };
        Self {
            base,
            dots,
            below,
            ..Self::default()
        }
    }

    /// Adds a subscript.
    #[must_use]
    pub fn below(mut self, name: &str) -> Self {
        self.below.push(name.to_owned());
        self
    }

    /// Adds another letter, with its subscripts, as a subscript.
    #[must_use]
    pub fn below_letter(mut self, other: &Self) -> Self {
        self.below.push(other.to_string());
        self
    }

    /// Sets the superscript.
    #[must_use]
    pub fn above(mut self, mark: &str) -> Self {
        self.above = Some(mark.to_owned());
        self
    }

    /// Puts δ, d or ∂ before it.
    #[must_use]
    pub fn before(mut self, sign: char) -> Self {
        self.before = Some(sign);
        self
    }

    /// Adds a dot.
    #[must_use]
    pub fn dot(mut self) -> Self {
        self.dots = self.dots.saturating_add(1);
        self
    }

    /// Whether the base is a word rather than a letter.
    pub fn is_word(&self) -> bool {
        self.base.chars().nth(1).is_some()
    }
}

/// The Greek letter of a name.
fn greek(word: &str) -> Option<&'static str> {
    greek_letters().find(|row| row.0 == word).map(|row| row.1)
}

/// A Greek name as its letter, other text unchanged.
fn label(part: &str) -> String {
    greek(part).unwrap_or(part).to_owned()
}

/// The LaTeX command of a Greek letter, in the shape that Unicode gives it.
pub(super) fn greek_command(letter: char) -> Option<&'static str> {
    let name = greek_letters().find(|row| row.1.starts_with(letter))?.0;
    Some(match name {
        "phi" => "varphi",
        "epsilon" => "varepsilon",
        name => name,
    })
}

/// Unicode text: `ω̇₁`, `x_G`, `a⁰_A,x`.
impl std::fmt::Display for Letter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if let Some(sign) = self.before {
            write!(f, "{sign}")?;
        }
        f.write_str(&self.base)?;
        match self.dots {
            0 => {}
            1 => f.write_str("\u{307}")?,
            2 => f.write_str("\u{308}")?,
            _ => f.write_str("\u{20db}")?,
        }
        if let Some(mark) = &self.above {
            f.write_str(&mark.chars().map(superscript).collect::<String>())?;
        }
        if self.below.is_empty() {
            return Ok(());
        }
        let digits = |part: &String| part == "i" || part.chars().all(|c| c.is_ascii_digit());
        let numbers = self.below.iter().take_while(|part| digits(part)).count();
        // Digits are subscript characters while only digits came before them.
        if numbers > 0 {
            let joined = self.below[..numbers].join(",");
            f.write_str(&joined.chars().map(subscript).collect::<String>())?;
        }
        if numbers < self.below.len() {
            write!(f, "_{}", self.below[numbers..].join(","))?;
        }
        Ok(())
    }
}

fn subscript(c: char) -> char {
    match c.to_digit(10) {
        Some(digit) => char::from_u32(0x2080 + digit).unwrap_or(c),
        None if c == 'i' => 'ᵢ',
        None => c,
    }
}

/// Superscript form of digits and signs.
pub fn superscript(c: char) -> char {
    match c {
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '-' | '−' => '⁻',
        'T' => 'ᵀ',
        _ => match c.to_digit(10) {
            Some(digit) => char::from_u32(0x2070 + digit).unwrap_or(c),
            None => c,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::Letter;

    #[test]
    fn names_become_letters() {
        let cases = [
            ("omega_1", "ω₁"),
            ("theta", "θ"),
            ("x_G", "x_G"),
            ("m0", "m₀"),
            ("M_d", "M_d"),
            ("gamma_dot", "γ\u{307}"),
            ("gamma_dot_dot", "γ\u{308}"),
            ("omega_1_dot", "ω\u{307}₁"),
            ("x_G_dot", "x\u{307}_G"),
            ("speed", "speed"),
            ("x12", "x₁₂"),
            ("I_B_xx", "I_B,xx"),
            ("wheel_radius", "wheel_radius"),
            ("wheel_radius_2_dot", "wheel_radius\u{307}₂"),
            ("dot", "dot"),
            ("__", "__"),
            ("7", "7"),
            ("", ""),
        ];
        for (name, written) in cases {
            assert_eq!(Letter::of(name).to_string(), written, "{name}");
        }
    }

    #[test]
    fn names_of_derivatives_know_their_variable() {
        let letter = Letter::of("d_lever_d_theta_1");
        assert_eq!(letter.base, "lever");
        assert_eq!(letter.by, Some(Box::new(Letter::of("theta_1"))));
    }
}
