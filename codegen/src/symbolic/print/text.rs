//! Plain text with Unicode letters, superscripts and subscripts.

use super::super::{Function, Relation};
use super::name::{Name, greek};
use super::{Level, Notation, Piece};

/// Plain Unicode text: `ω₁²·sin θ`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Text;

const MINUS: &str = "−";

fn superscript(number: u32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    number
        .to_string()
        .bytes()
        .map(|b| DIGITS[usize::from(b - b'0') % 10])
        .collect()
}

/// A short subscript in small letters, if all of its letters exist. Words read better in full size.
fn subscript(word: &str) -> Option<String> {
    const LETTERS: [(char, char); 19] = [
        ('a', 'ₐ'),
        ('e', 'ₑ'),
        ('h', 'ₕ'),
        ('i', 'ᵢ'),
        ('j', 'ⱼ'),
        ('k', 'ₖ'),
        ('l', 'ₗ'),
        ('m', 'ₘ'),
        ('n', 'ₙ'),
        ('o', 'ₒ'),
        ('p', 'ₚ'),
        ('r', 'ᵣ'),
        ('s', 'ₛ'),
        ('t', 'ₜ'),
        ('u', 'ᵤ'),
        ('v', 'ᵥ'),
        ('x', 'ₓ'),
        ('+', '₊'),
        ('-', '₋'),
    ];
    if word.len() > 2 && !word.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    word.chars()
        .map(|c| match c.to_digit(10) {
            Some(digit) => char::from_u32('₀' as u32 + digit),
            None => LETTERS
                .iter()
                .find(|(plain, _)| *plain == c)
                .map(|&(_, small)| small),
        })
        .collect()
}

/// A word without characters that could break or turn the line.
fn harmless(word: &str) -> String {
    let shown = |c: char| {
        if c.is_alphanumeric() || c.is_ascii_graphic() {
            c
        } else {
            '\u{fffd}'
        }
    };
    greek(word).map_or_else(|| word.chars().map(shown).collect(), String::from)
}

fn grouped(piece: &Piece, least: Level) -> String {
    if piece.level < least {
        format!("({})", piece.text)
    } else {
        piece.text.clone()
    }
}

fn function_name(function: Function) -> &'static str {
    match function {
        Function::Sin => "sin",
        Function::Cos => "cos",
        Function::Asin => "asin",
        Function::Acos => "acos",
        Function::Atan => "atan",
        Function::Sinh => "sinh",
        Function::Cosh => "cosh",
        Function::Tanh => "tanh",
        Function::Exp => "exp",
        Function::Ln => "ln",
        Function::Sqrt => "√",
        Function::Abs => "abs",
        Function::Sign => "sign",
    }
}

impl Notation for Text {
    fn group(&self, text: &str) -> String {
        format!("({text})")
    }

    fn name(&self, name: &Name) -> Piece {
        if let Some(by) = &name.by {
            let over = self.name(&Name {
                by: None,
                ..name.clone()
            });
            return Piece::new(
                format!("∂{}/∂{}", over.text, self.name(by).text),
                Level::Fraction,
            );
        }
        let mut text = harmless(&name.base);
        if name.is_letter() {
            text.push_str(
                ["", "\u{307}", "\u{308}"]
                    .get(name.dots)
                    .copied()
                    .unwrap_or_default(),
            );
        } else if name.dots > 0 {
            text.push_str(if name.dots == 1 { "_dot" } else { "_ddot" });
        }
        let small: Option<Vec<String>> = name.subscripts.iter().map(|s| subscript(s)).collect();
        match small {
            Some(small) if name.is_letter() => text.push_str(&small.join(",")),
            _ => {
                for part in &name.subscripts {
                    text.push('_');
                    text.push_str(&harmless(part));
                }
            }
        }
        Piece::new(text, Level::Atom)
    }

    fn digits(&self, digits: &str) -> String {
        digits.to_owned()
    }

    fn sum(&self, terms: &[(bool, Piece)]) -> String {
        let mut text = String::new();
        for (i, (negative, piece)) in terms.iter().enumerate() {
            match (i, negative) {
                (0, false) => {}
                (0, true) => text.push_str(MINUS),
                (_, false) => text.push_str(" + "),
                (_, true) => {
                    text.push(' ');
                    text.push_str(MINUS);
                    text.push(' ');
                }
            }
            text.push_str(&piece.text);
        }
        text
    }

    fn product(&self, factors: &[Piece]) -> String {
        let factors: Vec<String> = factors.iter().map(|f| grouped(f, Level::Product)).collect();
        factors.join("·")
    }

    fn fraction(&self, over: &[Piece], under: &[Piece]) -> Piece {
        let above = match over {
            [single] => grouped(single, Level::Power),
            // `sin θ/c` would read as the sine of a quotient.
            [.., last] if last.level == Level::Prefix => format!("({})", self.product(over)),
            _ => self.product(over),
        };
        let below = match under {
            [single] => grouped(single, Level::Power),
            _ => format!("({})", self.product(under)),
        };
        Piece::new(format!("{above}/{below}"), Level::Fraction)
    }

    fn power(&self, base: &Piece, exponent: u32) -> Piece {
        Piece::new(
            format!("{}{}", grouped(base, Level::Atom), superscript(exponent)),
            Level::Power,
        )
    }

    fn general_power(&self, base: &Piece, exponent: &Piece) -> Piece {
        let (base, exponent) = (grouped(base, Level::Atom), grouped(exponent, Level::Atom));
        Piece::new(format!("{base}^{exponent}"), Level::Power)
    }

    fn function(&self, function: Function, exponent: u32, argument: &Piece) -> Piece {
        if function == Function::Abs {
            return Piece::new(format!("|{}|", argument.text), Level::Atom);
        }
        let raised = if exponent == 1 {
            String::new()
        } else {
            superscript(exponent)
        };
        let space = if function == Function::Sqrt { "" } else { " " };
        let name = function_name(function);
        if argument.level == Level::Atom {
            Piece::new(
                format!("{name}{raised}{space}{}", argument.text),
                Level::Prefix,
            )
        } else {
            // The parentheses leave no doubt where the argument ends.
            Piece::new(format!("{name}{raised}({})", argument.text), Level::Power)
        }
    }

    fn call(&self, function: &str, arguments: &[Piece]) -> Piece {
        let arguments: Vec<&str> = arguments.iter().map(|a| a.text.as_str()).collect();
        Piece::new(format!("{function}({})", arguments.join(", ")), Level::Atom)
    }

    fn choice(
        &self,
        relation: Relation,
        [left, right]: [&Piece; 2],
        [then, otherwise]: [&Piece; 2],
    ) -> Piece {
        let sign = match relation {
            Relation::Less => "<",
            Relation::LessOrEqual => "≤",
        };
        let text = format!(
            "({} if {} {sign} {} else {})",
            then.text, left.text, right.text, otherwise.text
        );
        Piece::new(text, Level::Atom)
    }

    fn equation(&self, left: &Piece, terms: &[(bool, Piece)], width: usize) -> String {
        lines(&format!("{} = {}", left.text, self.sum(terms)), width).join("\n")
    }

    fn list(&self, equations: &[String]) -> String {
        equations.join("\n")
    }
}

/// Breaks a line before `+` and `−`, outside of parentheses where possible. A piece without such a
/// place stays whole.
pub(super) fn lines(line: &str, width: usize) -> Vec<String> {
    const INDENT: usize = 4;
    let mut done = Vec::new();
    // A line and how deeply it is indented.
    let mut rest = line.to_owned();
    let mut indent = 0;
    while columns(&rest) + indent > width {
        let Some(cut) = best_cut(&rest, width.saturating_sub(indent)) else {
            break;
        };
        done.push(format!("{:indent$}{}", "", rest[..cut].trim_end()));
        rest = rest[cut..].trim_start().to_owned();
        indent = INDENT;
    }
    done.push(format!("{:indent$}{rest}", ""));
    done
}

/// Columns of a line: combining marks take none.
fn columns(text: &str) -> usize {
    text.chars()
        .filter(|c| !('\u{300}'..'\u{370}').contains(c))
        .count()
}

/// The last place outside of as many parentheses as possible at which the first part fits, else the
/// first place at all.
fn best_cut(text: &str, width: usize) -> Option<usize> {
    let (mut depth, mut column) = (0_i32, 0);
    let mut fitting: Option<(i32, usize)> = None;
    let mut first = None;
    let mut past_start = false;
    for (i, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ' ' if past_start && (text[i..].starts_with(" + ") || text[i..].starts_with(" − ")) => {
                if column <= width {
                    if fitting.is_none_or(|(least, _)| depth <= least) {
                        fitting = Some((depth, i));
                    }
                } else if first.is_none() {
                    first = Some(i);
                }
            }
            _ => {}
        }
        // The sign that a broken line starts with is no place to break it again.
        past_start = past_start || (c != ' ' && c != '+' && c != '−');
        column += usize::from(!('\u{300}'..'\u{370}').contains(&c));
    }
    fitting.map(|(_, place)| place).or(first)
}
