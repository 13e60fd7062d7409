//! Values and expressions of a joint as text for other sections.

use num_rational::BigRational;
use num_traits::Zero;
use toml_edit::Value;

use crate::ast::{ExprAst, ExprAstKind};
use crate::expr::Span;

use super::piece::Piece;

/// An expression of the spec, copied.
#[derive(Debug, Clone)]
pub(super) struct Written {
    /// Its text.
    pub(super) piece: Piece,
    /// Its value, if it is a number.
    pub(super) literal: Option<BigRational>,
    /// Whether it is one factor.
    is_factor: bool,
}

impl Written {
    /// Copies an expression.
    pub(super) fn new(text: &str, expression: &ExprAst) -> Self {
        let is_factor = match &expression.kind {
            ExprAstKind::Number(number, _) => *number >= BigRational::zero(),
            ExprAstKind::Negate(_) | ExprAstKind::Binary(..) => false,
            _ => true,
        };
        Self {
            piece: copied(text, expression),
            literal: literal(expression),
            is_factor,
        }
    }

    /// From generated text.
    pub(super) fn made(piece: Piece, is_factor: bool) -> Self {
        Self {
            piece,
            literal: None,
            is_factor,
        }
    }

    /// The number 0.
    pub(super) fn zero() -> Self {
        Self {
            piece: Piece::new("0"),
            literal: Some(BigRational::zero()),
            is_factor: true,
        }
    }

    /// Whether it is the number 0.
    pub(super) fn is_zero(&self) -> bool {
        self.literal.as_ref().is_some_and(Zero::is_zero)
    }

    /// As an operand of a product, a power or a minus sign.
    pub(super) fn factor(&self) -> Piece {
        if self.is_factor {
            self.piece.clone()
        } else {
            self.piece.within("(", ")")
        }
    }

    /// As a value of TOML: a plain number, or a string.
    pub(super) fn value(&self) -> Piece {
        let number = self.piece.text.parse::<Value>();
        match number {
            Ok(Value::Integer(_) | Value::Float(_)) => self.piece.clone(),
            _ => self.piece.quoted(),
        }
    }

    /// The sum with another one.
    pub(super) fn plus(&self, other: &Self) -> Self {
        if self.is_zero() {
            return other.clone();
        }
        let sum = self.piece.clone().word(" + ").then(&other.piece);
        Self::made(sum, false)
    }

    /// The difference to another one.
    pub(super) fn minus(&self, other: &Self) -> Self {
        let before = if self.is_zero() {
            Piece::new("-")
        } else {
            self.piece.clone().word(" - ")
        };
        Self::made(before.then(&other.factor()), false)
    }
}

/// The text of an expression, with escapes decoded.
fn copied(text: &str, expression: &ExprAst) -> Piece {
    let span: &Span = &expression.span;
    let letters = text.get(span.clone()).unwrap_or_default();
    let decoded = match letters.parse::<Value>() {
        Ok(Value::String(decoded)) => decoded.into_value(),
        _ => letters.to_owned(),
    };
    // The parser has reported parts that it could not read.
    if matches!(expression.kind, ExprAstKind::Broken) || decoded.contains(['"', '\\']) {
        return Piece::copied("0", span.clone());
    }
    let decoded = match &expression.kind {
        ExprAstKind::Number(number, None) if decoded.contains(['_', '+', 'x', 'o', 'b']) => {
            plain(&decoded, number)
        }
        _ => decoded.replace(['\n', '\r'], " "),
    };
    Piece::copied(decoded, span.clone())
}

/// A number that TOML alone reads, for expressions.
fn plain(letters: &str, number: &BigRational) -> String {
    if number.is_integer() {
        return number.to_string();
    }
    letters.replace(['_', '+'], "")
}

/// The number of an expression that is a literal, in its unit.
fn literal(expression: &ExprAst) -> Option<BigRational> {
    match &expression.kind {
        ExprAstKind::Number(number, _) => Some(number.clone()),
        ExprAstKind::Negate(of) => literal(of).map(|number| -number),
        _ => None,
    }
}
