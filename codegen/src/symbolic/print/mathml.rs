//! Presentation `MathML`, which browsers show without any script.

use super::super::{Function, Relation};
use super::name::{Name, greek};
use super::{Level, Notation, Piece};

/// Presentation `MathML`: `<msup><mi>ω</mi><mn>2</mn></msup>`.
///
/// Expressions come without the surrounding `<math>`, equations with it.
#[derive(Debug, Clone, Copy, Default)]
pub struct MathMl;

/// Between factors: a multiplication that is not written.
const TIMES: &str = "<mo>&#x2062;</mo>";
/// Between a function and its argument.
const APPLY: &str = "<mo>&#x2061;</mo>";

fn escaped(word: &str) -> String {
    let mut text = String::with_capacity(word.len());
    for c in word.chars() {
        match c {
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '&' => text.push_str("&amp;"),
            '"' => text.push_str("&quot;"),
            '\'' => text.push_str("&#39;"),
            c if c.is_control() => text.push('\u{fffd}'),
            c => text.push(c),
        }
    }
    text
}

/// A letter in italics, a word upright, a number as a number.
fn word(word: &str) -> String {
    if let Some(letter) = greek(word) {
        return format!("<mi>{letter}</mi>");
    }
    if !word.is_empty() && word.bytes().all(|b| b.is_ascii_digit()) {
        return format!("<mn>{word}</mn>");
    }
    format!("<mi>{}</mi>", escaped(word))
}

fn row(text: &str) -> String {
    format!("<mrow>{text}</mrow>")
}

fn grouped(piece: &Piece, least: Level) -> String {
    if piece.level < least {
        MathMl.group(&piece.text)
    } else {
        piece.text.clone()
    }
}

fn sign(first: bool, negative: bool) -> &'static str {
    match (first, negative) {
        (true, false) => "",
        (false, false) => "<mo>+</mo>",
        (_, true) => "<mo>&#x2212;</mo>",
    }
}

fn function_name(function: Function) -> &'static str {
    match function {
        Function::Sin => "sin",
        Function::Cos => "cos",
        Function::Asin => "arcsin",
        Function::Acos => "arccos",
        Function::Atan => "arctan",
        Function::Sinh => "sinh",
        Function::Cosh => "cosh",
        Function::Tanh => "tanh",
        Function::Exp => "exp",
        Function::Ln => "ln",
        Function::Sqrt => "sqrt",
        Function::Abs => "abs",
        Function::Sign => "sign",
    }
}

impl Notation for MathMl {
    fn group(&self, text: &str) -> String {
        format!("<mrow><mo>(</mo>{text}<mo>)</mo></mrow>")
    }

    fn name(&self, name: &Name) -> Piece {
        if let Some(by) = &name.by {
            let over = self
                .name(&Name {
                    by: None,
                    ..name.clone()
                })
                .text;
            let under = self.name(by).text;
            let text = format!(
                "<mfrac><mrow><mo>∂</mo>{over}</mrow><mrow><mo>∂</mo>{under}</mrow></mfrac>"
            );
            return Piece::new(text, Level::Product);
        }
        let mut text = word(&name.base);
        if name.dots > 0 {
            let dots = if name.dots == 1 { "&#x2d9;" } else { "&#xa8;" };
            text = format!("<mover accent=\"true\">{text}<mo>{dots}</mo></mover>");
        }
        if !name.subscripts.is_empty() {
            let parts: Vec<String> = name.subscripts.iter().map(|s| word(s)).collect();
            let below = match parts.as_slice() {
                [single] => single.clone(),
                _ => row(&parts.join("<mo>,</mo>")),
            };
            text = format!("<msub>{text}{below}</msub>");
        }
        Piece::new(text, Level::Atom)
    }

    fn digits(&self, digits: &str) -> String {
        format!("<mn>{}</mn>", escaped(digits))
    }

    fn sum(&self, terms: &[(bool, Piece)]) -> String {
        let mut text = String::new();
        for (i, (negative, piece)) in terms.iter().enumerate() {
            text.push_str(sign(i == 0, *negative));
            text.push_str(&piece.text);
        }
        row(&text)
    }

    fn product(&self, factors: &[Piece]) -> String {
        let factors: Vec<String> = factors.iter().map(|f| grouped(f, Level::Product)).collect();
        row(&factors.join(TIMES))
    }

    fn fraction(&self, over: &[Piece], under: &[Piece]) -> Piece {
        let side = |factors: &[Piece]| match factors {
            [single] => single.text.clone(),
            _ => self.product(factors),
        };
        Piece::new(
            format!("<mfrac>{}{}</mfrac>", side(over), side(under)),
            Level::Product,
        )
    }

    fn power(&self, base: &Piece, exponent: u32) -> Piece {
        let base = grouped(base, Level::Atom);
        Piece::new(
            format!("<msup>{base}<mn>{exponent}</mn></msup>"),
            Level::Power,
        )
    }

    fn general_power(&self, base: &Piece, exponent: &Piece) -> Piece {
        let base = grouped(base, Level::Atom);
        Piece::new(
            format!("<msup>{base}{}</msup>", exponent.text),
            Level::Power,
        )
    }

    fn function(&self, function: Function, exponent: u32, argument: &Piece) -> Piece {
        match function {
            Function::Sqrt => {
                return Piece::new(format!("<msqrt>{}</msqrt>", argument.text), Level::Atom);
            }
            Function::Abs => {
                let text = format!("<mrow><mo>|</mo>{}<mo>|</mo></mrow>", argument.text);
                return Piece::new(text, Level::Atom);
            }
            _ => {}
        }
        let mut name = format!("<mi>{}</mi>", function_name(function));
        if exponent > 1 {
            name = format!("<msup>{name}<mn>{exponent}</mn></msup>");
        }
        let level = if argument.level == Level::Atom {
            Level::Prefix
        } else {
            Level::Power
        };
        Piece::new(
            row(&format!("{name}{APPLY}{}", grouped(argument, Level::Atom))),
            level,
        )
    }

    fn call(&self, function: &str, arguments: &[Piece]) -> Piece {
        let arguments: Vec<&str> = arguments.iter().map(|a| a.text.as_str()).collect();
        let arguments = self.group(&arguments.join("<mo>,</mo>"));
        Piece::new(
            row(&format!("<mi>{}</mi>{APPLY}{arguments}", escaped(function))),
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
            Relation::Less => "&lt;",
            Relation::LessOrEqual => "&#x2264;",
        };
        let condition = row(&format!("{}<mo>{sign}</mo>{}", left.text, right.text));
        let case =
            |value: &str, when: &str| format!("<mtr><mtd>{value}</mtd><mtd>{when}</mtd></mtr>");
        let text = format!(
            "<mrow><mo>{{</mo><mtable columnalign=\"left left\">{}{}</mtable></mrow>",
            case(&then.text, &condition),
            case(&otherwise.text, "<mtext>otherwise</mtext>"),
        );
        // The brace has no right end: as a factor it needs parentheses.
        Piece::new(text, Level::Sum)
    }

    fn equation(&self, left: &Piece, terms: &[(bool, Piece)], width: usize) -> String {
        let mut rows: Vec<String> = Vec::new();
        let mut current = String::new();
        let mut used = visible(&left.text) + 1;
        for (i, (negative, piece)) in terms.iter().enumerate() {
            let length = visible(&piece.text) + 1;
            if !current.is_empty() && used + length > width {
                rows.push(std::mem::take(&mut current));
                used = visible(&left.text) + 1;
            }
            current.push_str(sign(i == 0, *negative));
            current.push_str(&piece.text);
            used += length;
        }
        rows.push(current);
        let mut body = String::new();
        for (i, line) in rows.iter().enumerate() {
            let head = if i == 0 {
                format!("<mtd>{}</mtd><mtd><mo>=</mo></mtd>", left.text)
            } else {
                "<mtd></mtd><mtd></mtd>".to_owned()
            };
            body.extend(["<mtr>", &head, "<mtd>", &row(line), "</mtd></mtr>"]);
        }
        format!(
            "<math xmlns=\"http://www.w3.org/1998/Math/MathML\" display=\"block\">\
             <mtable displaystyle=\"true\" columnalign=\"right center left\">{body}</mtable></math>"
        )
    }

    fn list(&self, equations: &[String]) -> String {
        equations.join("\n")
    }
}

/// Characters that remain when the tags are gone; an entity is one.
fn visible(markup: &str) -> usize {
    let (mut count, mut in_tag, mut in_entity) = (0, false, false);
    for c in markup.chars() {
        match c {
            '<' => in_tag = true,
            '>' => in_tag = false,
            '&' if !in_tag => in_entity = true,
            ';' if in_entity => {
                in_entity = false;
                count += 1;
            }
            _ if in_tag || in_entity => {}
            _ => count += 1,
        }
    }
    count
}
