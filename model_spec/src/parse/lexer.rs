//! Expressions as tokens.

use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Relation;
use crate::limits::MAX_EXPRESSION;

use super::source::Source;

/// The forms of a token.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Token<'a> {
    Number(&'a str),
    Name(&'a str),
    /// The text between `[` and `]`.
    Unit(&'a str),
    Relation(Relation),
    Symbol(char),
    End,
}

/// A token and its position in the expression.
#[derive(Debug, Clone, Copy)]
pub(super) struct Located<'a> {
    pub(super) token: Token<'a>,
    pub(super) start: usize,
    pub(super) end: usize,
}

impl Token<'_> {
    /// The token as shown in messages.
    pub(super) fn words(&self) -> String {
        match self {
            Self::Number(text) | Self::Name(text) => format!("`{text}`"),
            Self::Unit(text) => format!("`[{text}]`"),
            Self::Relation(relation) => format!("`{}`", relation.symbol()),
            Self::Symbol(c) => format!("`{c}`"),
            Self::End => "the end".to_owned(),
        }
    }
}

/// Splits an expression into tokens; the last one is [`Token::End`].
pub(super) fn tokens<'a>(source: &Source<'a>) -> Result<Vec<Located<'a>>, Diagnostic> {
    let text = source.text;
    if text.len() > MAX_EXPRESSION {
        return Err(Diagnostic::error(
            Code::LimitExceeded,
            format!("an expression has at most {MAX_EXPRESSION} characters"),
        )
        .at(source.whole.clone(), format!("{} characters", text.len()))
        .help("split it into several points, frames or loads"));
    }
    let mut list = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let start = at;
        let token = match c {
            ' ' | '\t' | '\n' | '\r' => {
                at += 1;
                continue;
            }
            '0'..='9' | '.' => {
                at += number_length(&text[at..]);
                Token::Number(&text[start..at])
            }
            'a'..='z' | 'A'..='Z' | '_' => {
                at += text[at..]
                    .bytes()
                    .take_while(|b| b.is_ascii_alphanumeric() || *b == b'_')
                    .count();
                Token::Name(&text[start..at])
            }
            '[' => {
                let Some(length) = text[at..].find(']') else {
                    return Err(syntax(source, start, start + 1, "this `[` is never closed"));
                };
                at += length + 1;
                Token::Unit(&text[start + 1..at - 1])
            }
            '°' => {
                at += c.len_utf8();
                Token::Unit(&text[start..at])
            }
            '<' | '>' => {
                at += 1;
                let or_equal = text[at..].starts_with('=');
                at += usize::from(or_equal);
                Token::Relation(match (c, or_equal) {
                    ('<', false) => Relation::Less,
                    ('<', true) => Relation::LessOrEqual,
                    (_, false) => Relation::Greater,
                    (_, true) => Relation::GreaterOrEqual,
                })
            }
            '*' if text[at..].starts_with("**") => {
                return Err(syntax(source, start, start + 2, "`**` is not an operator")
                    .help("a power is written with `^`"));
            }
            '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => {
                at += 1;
                Token::Symbol(c)
            }
            _ => {
                let message = format!("`{}` does not belong in an expression", c.escape_debug());
                return Err(
                    syntax(source, start, start + c.len_utf8(), &message).maybe_help(advice(c))
                );
            }
        };
        list.push(Located {
            token,
            start,
            end: at,
        });
    }
    list.push(Located {
        token: Token::End,
        start: text.len(),
        end: text.len(),
    });
    Ok(list)
}

fn syntax(source: &Source<'_>, start: usize, end: usize, message: &str) -> Diagnostic {
    Diagnostic::error(Code::ExpressionSyntax, message).at(source.span(start..end), "")
}

fn advice(c: char) -> Option<String> {
    let text = match c {
        '·' | '×' => "a product is written with `*`",
        '²' => "a square is written `^2`",
        '³' => "a cube is written `^3`",
        '=' | '!' => "comparisons are `<`, `<=`, `>` and `>=`, inside `if(…)`",
        '\'' => "the time derivative of `q` is `dot(q)`",
        'π' => "the circle constant is `pi`",
        '−' => "the minus sign is `-`",
        c if c.is_alphabetic() => "names are written in the letters A–Z, a–z",
        _ => return None,
    };
    Some(text.to_owned())
}

/// Length of the number at the start of `text`: `12`, `1.5`, `.5`, `1e-3`.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        bytes[from..]
            .iter()
            .take_while(|b| b.is_ascii_digit())
            .count()
    };
    let mut at = digits(0);
    if bytes.get(at) == Some(&b'.') {
        at += 1 + digits(at + 1);
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        let exponent = digits(at + 1 + sign);
        if exponent > 0 {
            at += 1 + sign + exponent;
        }
    }
    at
}
