//! `LaTeX`, with `amsmath` for `aligned` and `cases`.

use super::super::{Function, Relation};
use super::name::{Name, greek};
use super::{Level, Notation, Piece};

/// `LaTeX`: `\omega_1^2\,\sin\theta`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Latex;

/// Any characters as text that `LaTeX` prints and does not obey.
fn escaped(word: &str) -> String {
    let mut text = String::with_capacity(word.len());
    for c in word.chars() {
        match c {
            '\\' => text.push_str("\\backslash "),
            '^' => text.push_str("\\hat{}"),
            '~' => text.push_str("\\sim "),
            '{' | '}' | '$' | '&' | '#' | '%' | '_' => {
                text.push('\\');
                text.push(c);
            }
            c if c.is_control() => text.push('?'),
            c => text.push(c),
        }
    }
    text
}

/// A letter or a word in its font.
fn word(word: &str, font: &str) -> String {
    match greek(word) {
        Some(_) => format!("\\{word}"),
        None if word.chars().count() == 1 || word.bytes().all(|b| b.is_ascii_digit()) => {
            escaped(word)
        }
        None => format!("\\{font}{{{}}}", escaped(word)),
    }
}

fn grouped(piece: &Piece, least: Level) -> String {
    if piece.level < least {
        Latex.group(&piece.text)
    } else {
        piece.text.clone()
    }
}

/// `x^2`, `x^{10}`, `x^{a}`
fn braced(text: &str) -> String {
    if text.len() == 1 {
        text.to_owned()
    } else {
        format!("{{{text}}}")
    }
}

/// A control word must not swallow the letter after it.
fn joined(left: &str, right: &str) -> String {
    let swallows = left.ends_with(|c: char| c.is_ascii_alphabetic())
        && left
            .rsplit(|c: char| !c.is_ascii_alphabetic())
            .next()
            .is_some_and(|w| left.len() > w.len() && left[..left.len() - w.len()].ends_with('\\'));
    let space = if swallows && right.starts_with(|c: char| c.is_ascii_alphabetic()) {
        " "
    } else {
        ""
    };
    format!("{left}{space}{right}")
}

impl Latex {
    fn function_name(function: Function) -> &'static str {
        match function {
            Function::Sin => "\\sin",
            Function::Cos => "\\cos",
            Function::Asin => "\\arcsin",
            Function::Acos => "\\arccos",
            Function::Atan => "\\arctan",
            Function::Sinh => "\\sinh",
            Function::Cosh => "\\cosh",
            Function::Tanh => "\\tanh",
            Function::Exp => "\\exp",
            Function::Ln => "\\ln",
            Function::Sqrt => "\\sqrt",
            Function::Abs => "\\operatorname{abs}",
            Function::Sign => "\\operatorname{sign}",
        }
    }
}

impl Notation for Latex {
    fn group(&self, text: &str) -> String {
        format!("\\left({text}\\right)")
    }

    fn name(&self, name: &Name) -> Piece {
        if let Some(by) = &name.by {
            let over = joined(
                "\\partial",
                &self
                    .name(&Name {
                        by: None,
                        ..name.clone()
                    })
                    .text,
            );
            let under = joined("\\partial", &self.name(by).text);
            return Piece::new(format!("\\frac{{{over}}}{{{under}}}"), Level::Product);
        }
        let base = word(&name.base, "mathit");
        let base = match name.dots {
            0 => base,
            1 => joined(
                "\\dot",
                &if base.starts_with('\\') {
                    base
                } else {
                    format!("{{{base}}}")
                },
            ),
            _ => joined(
                "\\ddot",
                &if base.starts_with('\\') {
                    base
                } else {
                    format!("{{{base}}}")
                },
            ),
        };
        if name.subscripts.is_empty() {
            return Piece::new(base, Level::Atom);
        }
        let subscripts: Vec<String> = name.subscripts.iter().map(|s| word(s, "mathrm")).collect();
        let text = format!("{base}_{}", braced(&subscripts.join(",")));
        Piece::new(text, Level::Atom)
    }

    fn digits(&self, digits: &str) -> String {
        digits.replace('…', "\\dots")
    }

    fn sum(&self, terms: &[(bool, Piece)]) -> String {
        let mut text = String::new();
        for (i, (negative, piece)) in terms.iter().enumerate() {
            match (i, negative) {
                (0, false) => {}
                (0, true) => text.push('-'),
                (_, false) => text.push_str(" + "),
                (_, true) => text.push_str(" - "),
            }
            text.push_str(&piece.text);
        }
        text
    }

    fn product(&self, factors: &[Piece]) -> String {
        let factors: Vec<String> = factors.iter().map(|f| grouped(f, Level::Product)).collect();
        factors.join("\\,")
    }

    fn fraction(&self, over: &[Piece], under: &[Piece]) -> Piece {
        let side = |factors: &[Piece]| match factors {
            [single] => single.text.clone(),
            _ => self.product(factors),
        };
        Piece::new(
            format!("\\frac{{{}}}{{{}}}", side(over), side(under)),
            Level::Product,
        )
    }

    fn power(&self, base: &Piece, exponent: u32) -> Piece {
        let exponent = braced(&exponent.to_string());
        Piece::new(
            format!("{}^{exponent}", grouped(base, Level::Atom)),
            Level::Power,
        )
    }

    fn general_power(&self, base: &Piece, exponent: &Piece) -> Piece {
        let text = format!("{}^{}", grouped(base, Level::Atom), braced(&exponent.text));
        Piece::new(text, Level::Power)
    }

    fn function(&self, function: Function, exponent: u32, argument: &Piece) -> Piece {
        match function {
            Function::Sqrt => {
                return Piece::new(format!("\\sqrt{{{}}}", argument.text), Level::Atom);
            }
            Function::Abs => {
                return Piece::new(format!("\\left|{}\\right|", argument.text), Level::Atom);
            }
            _ => {}
        }
        let mut name = Self::function_name(function).to_owned();
        if exponent > 1 {
            name = format!("{name}^{}", braced(&exponent.to_string()));
        }
        if argument.level == Level::Atom {
            Piece::new(joined(&name, &argument.text), Level::Prefix)
        } else {
            Piece::new(
                format!("{name}{}", self.group(&argument.text)),
                Level::Power,
            )
        }
    }

    fn call(&self, function: &str, arguments: &[Piece]) -> Piece {
        let arguments: Vec<&str> = arguments.iter().map(|a| a.text.as_str()).collect();
        let arguments = self.group(&arguments.join(", "));
        Piece::new(
            format!("\\operatorname{{{function}}}{arguments}"),
            Level::Power,
        )
    }

    fn choice(
        &self,
        relation: Relation,
        [left, right]: [&Piece; 2],
        [then, otherwise]: [&Piece; 2],
    ) -> Piece {
        let sign = match relation {
            Relation::Less => "<",
            Relation::LessOrEqual => "\\le",
        };
        let (then, otherwise) = (&then.text, &otherwise.text);
        let condition = format!("{} {sign} {}", left.text, right.text);
        let text = format!(
            "\\begin{{cases}} {then} & {condition} \\\\ {otherwise} & \\text{{otherwise}} \\end{{cases}}"
        );
        // Braces end nowhere visible: as a factor it needs parentheses.
        Piece::new(text, Level::Sum)
    }

    fn equation(&self, left: &Piece, terms: &[(bool, Piece)], width: usize) -> String {
        let whole = format!("{} = {}", left.text, self.sum(terms));
        if visible(&whole) <= width || terms.len() < 2 {
            return whole;
        }
        let mut text = format!("\\begin{{aligned}}\n{} ={{}}& ", left.text);
        let mut used = visible(&left.text) + 3;
        let indent = used;
        for (i, (negative, piece)) in terms.iter().enumerate() {
            let length = visible(&piece.text) + 3;
            if i > 0 && used + length > width {
                text.push_str(" \\\\\n& ");
                used = indent;
            }
            match (i, negative) {
                (0, false) => {}
                (0, true) => text.push('-'),
                (_, false) => text.push_str(" {}+ "),
                (_, true) => text.push_str(" {}- "),
            }
            text.push_str(&piece.text);
            used += length;
        }
        text.push_str("\n\\end{aligned}");
        text
    }

    fn list(&self, equations: &[String]) -> String {
        if let [single] = equations {
            return single.clone();
        }
        format!(
            "\\begin{{gathered}}\n{}\n\\end{{gathered}}",
            equations.join(" \\\\\n")
        )
    }
}

/// About how many characters remain of `LaTeX` source on the page: a control word is one, braces and
/// scripts' marks are none.
fn visible(source: &str) -> usize {
    let mut count = 0;
    let mut in_word = false;
    for c in source.chars() {
        match c {
            '\\' => {
                count += 1;
                in_word = true;
            }
            c if in_word && c.is_ascii_alphabetic() => {}
            '{' | '}' | '^' | '_' | ' ' => in_word = false,
            _ => {
                count += 1;
                in_word = false;
            }
        }
    }
    count
}
