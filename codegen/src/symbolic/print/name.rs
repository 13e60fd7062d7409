//! Names of quantities: a letter or a word, dots, subscripts.

/// A name taken apart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Name {
    /// Letter, Greek letter or word.
    pub base: String,
    /// How many dots stand above it.
    pub dots: usize,
    /// Subscripts, in order.
    pub subscripts: Vec<String>,
    /// For `∂name/∂by`: what it is differentiated by.
    pub by: Option<Box<Name>>,
}

/// Greek letters that have names of their own in `LaTeX`.
pub const GREEK: [(&str, char); 33] = [
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("iota", 'ι'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("upsilon", 'υ'),
    ("phi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Theta", 'Θ'),
    ("Lambda", 'Λ'),
    ("Xi", 'Ξ'),
    ("Pi", 'Π'),
    ("Sigma", 'Σ'),
    ("Phi", 'Φ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
];

/// The Greek letter of a name.
pub(super) fn greek(word: &str) -> Option<char> {
    GREEK
        .iter()
        .find(|(name, _)| *name == word)
        .map(|&(_, letter)| letter)
}

impl Name {
    /// Takes an identifier apart at its underscores: `omega_1_dot` is ω̇₁, `m_W` is m with subscript W.
    ///
    /// Parts `dot` and `ddot` are dots. Digits at the end of a letter are a subscript, as in `x1`. A
    /// word as a base keeps its underscores: `wheel_radius` is one word. `d_a_d_b` is ∂a/∂b.
    pub fn parse(identifier: &str) -> Self {
        if let Some((name, by)) = identifier
            .strip_prefix("d_")
            .and_then(|rest| rest.split_once("_d_"))
            && !by.contains("_d_")
        {
            return Self {
                by: Some(Box::new(Self::plain(by))),
                ..Self::plain(name)
            };
        }
        Self::plain(identifier)
    }

    fn plain(identifier: &str) -> Self {
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
        let letters = first.trim_end_matches(|c: char| c.is_ascii_digit());
        let is_letter = letters.chars().count() == 1 || greek(letters).is_some();
        // Empty parts come from doubled underscores; only the whole identifier tells them apart.
        let is_regular = parts.iter().all(|p| !p.is_empty()) && dots <= 2;
        if !is_letter || !is_regular {
            let is_word = is_regular && !letters.is_empty();
            // Numbers at the end of a word are subscripts, its other parts belong to it.
            let numbers = if is_word {
                parts
                    .iter()
                    .rev()
                    .take_while(|p| p.bytes().all(|b| b.is_ascii_digit()))
                    .count()
            } else {
                0
            };
            let (word, subscripts) = parts.split_at(parts.len() - numbers);
            return Self {
                base: if is_word {
                    word.join("_")
                } else {
                    identifier.to_owned()
                },
                dots: if is_word { dots } else { 0 },
                subscripts: subscripts.iter().map(|&s| s.to_owned()).collect(),
                by: None,
            };
        }
        let mut subscripts = Vec::new();
        if letters.len() < first.len() {
            subscripts.push(first[letters.len()..].to_owned());
        }
        subscripts.extend(parts[1..].iter().map(|&s| s.to_owned()));
        Self {
            base: letters.to_owned(),
            dots,
            subscripts,
            by: None,
        }
    }

    /// Whether the base is one letter, Greek or not.
    pub fn is_letter(&self) -> bool {
        greek(&self.base).is_some() || self.base.chars().count() == 1
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;

    fn parts(identifier: &str) -> (String, usize, Vec<String>) {
        let name = Name::parse(identifier);
        assert_eq!(name.by, None);
        (name.base, name.dots, name.subscripts)
    }

    #[test]
    fn identifiers_come_apart_at_underscores() {
        let expect = |base: &str, dots, subscripts: &[&str]| {
            (
                base.to_owned(),
                dots,
                subscripts.iter().map(|&s| s.to_owned()).collect(),
            )
        };
        assert_eq!(parts("theta"), expect("theta", 0, &[]));
        assert_eq!(parts("omega_1_dot"), expect("omega", 1, &["1"]));
        assert_eq!(parts("phi_ddot"), expect("phi", 2, &[]));
        assert_eq!(parts("x12"), expect("x", 0, &["12"]));
        assert_eq!(parts("I_B_xx"), expect("I", 0, &["B", "xx"]));
        assert_eq!(parts("wheel_radius"), expect("wheel_radius", 0, &[]));
        assert_eq!(
            parts("wheel_radius_2_dot"),
            expect("wheel_radius", 1, &["2"])
        );
        assert_eq!(parts("dot"), expect("dot", 0, &[]));
        assert_eq!(parts("__"), expect("__", 0, &[]));
        assert_eq!(parts("7"), expect("7", 0, &[]));
        assert_eq!(parts(""), expect("", 0, &[]));
    }

    #[test]
    fn names_of_derivatives_are_quotients() {
        let name = Name::parse("d_lever_d_theta_1");
        assert_eq!(name.base, "lever");
        assert_eq!(name.by.unwrap().subscripts, ["1"]);
    }
}
