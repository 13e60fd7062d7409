//! Formulas as papers print them, typed with `*`, `/`, `^` or `**`.

use std::collections::BTreeMap;

use appell_codegen::symbolic::{Expr, Function, Graph, Rational};

/// Meanings of the names of a formula.
#[derive(Debug, Clone, Default)]
pub struct Scope(BTreeMap<String, Expr>);

impl Scope {
    /// Defines a name.
    pub fn define(&mut self, name: &str, value: Expr) {
        self.0.insert(name.to_owned(), value);
    }

    /// The expression of a name.
    pub fn get(&self, name: &str) -> Option<Expr> {
        self.0.get(name).copied()
    }
}

/// The expression of a formula.
///
/// # Panics
///
/// With the position, if the formula is invalid or a name is undefined.
pub fn formula(graph: &mut Graph, scope: &Scope, text: &str) -> Expr {
    let mut reader = Reader {
        graph,
        scope,
        text,
        rest: text,
    };
    let value = reader.sum();
    reader.space();
    assert!(
        reader.rest.is_empty(),
        "`{}` is left over in `{text}`",
        reader.rest
    );
    value
}

/// Reads lines `name = formula`. Each name can be used in later lines.
pub fn definitions(graph: &mut Graph, scope: &mut Scope, text: &str) -> Vec<(String, Expr)> {
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    lines
        .map(|line| {
            let (name, right) = line
                .split_once('=')
                .unwrap_or_else(|| panic!("no `=` in `{line}`"));
            let value = formula(graph, scope, right);
            scope.define(name.trim(), value);
            (name.trim().to_owned(), value)
        })
        .collect()
}

struct Reader<'a> {
    graph: &'a mut Graph,
    scope: &'a Scope,
    text: &'a str,
    rest: &'a str,
}

impl<'a> Reader<'a> {
    fn space(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn take(&mut self, token: &str) -> bool {
        self.space();
        match self.rest.strip_prefix(token) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn while_true(&mut self, keep: impl Fn(char) -> bool) -> &'a str {
        let end = self.rest.find(|c| !keep(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word
    }

    fn sum(&mut self) -> Expr {
        let mut parts = vec![self.product()];
        loop {
            if self.take("+") {
                parts.push(self.product());
            } else if self.take("-") {
                let part = self.product();
                parts.push(self.graph.neg(part));
            } else {
                return self.graph.sum(&parts);
            }
        }
    }

    fn product(&mut self) -> Expr {
        let mut value = self.signed();
        loop {
            self.space();
            let power_follows = self.rest.starts_with("**");
            if !power_follows && self.take("*") {
                let factor = self.signed();
                value = self.graph.mul(value, factor);
            } else if self.take("/") {
                let divisor = self.signed();
                value = self.graph.div(value, divisor);
            } else {
                return value;
            }
        }
    }

    fn signed(&mut self) -> Expr {
        if self.take("-") {
            let value = self.signed();
            return self.graph.neg(value);
        }
        let base = self.atom();
        if self.take("**") || self.take("^") {
            let exponent = self.signed();
            return self.graph.power(base, exponent);
        }
        base
    }

    fn atom(&mut self) -> Expr {
        if self.take("(") {
            let value = self.sum();
            self.close();
            return value;
        }
        self.space();
        if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
            return self.number();
        }
        let word = self.while_true(|c| c.is_ascii_alphanumeric() || c == '_');
        if self.take("(") {
            let argument = self.sum();
            self.close();
            return match word {
                "sin" => self.graph.sin(argument),
                "cos" => self.graph.cos(argument),
                "tan" => self.graph.tan(argument),
                "sqrt" => self.graph.function(Function::Sqrt, argument),
                _ => panic!("no function `{word}` in `{}`", self.text),
            };
        }
        self.scope
            .get(word)
            .unwrap_or_else(|| panic!("no name `{word}` before `{}` in `{}`", self.rest, self.text))
    }

    fn close(&mut self) {
        assert!(
            self.take(")"),
            "no `)` before `{}` in `{}`",
            self.rest,
            self.text
        );
    }

    fn number(&mut self) -> Expr {
        let digits = self.while_true(|c| c.is_ascii_digit() || c == '.');
        let (whole, decimals) = digits.split_once('.').unwrap_or((digits, ""));
        let numerator: i64 = format!("{whole}{decimals}").parse().unwrap();
        let denominator = 10_i64.pow(u32::try_from(decimals.len()).unwrap());
        self.graph.number(Rational::new(numerator, denominator))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_binds_weaker_than_a_power_and_stronger_than_a_product() {
        let mut graph = Graph::new();
        let x = graph.symbol("x");
        let mut scope = Scope::default();
        scope.define("x", x);
        let a = formula(&mut graph, &scope, "-x**2*3 + 0.5");
        let b = formula(&mut graph, &scope, "1/2 - (3*x^2)");
        assert_eq!(a, b);
    }
}
