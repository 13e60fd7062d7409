//! Expressions, by precedence climbing.

use std::ops::Range;

use num_rational::BigRational;

use crate::ast::{ExprAst, ExprAstKind, Spanned};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Function, Span, Word};
use crate::limits::MAX_DEPTH;
use crate::number::{NumberError, exact};
use crate::suggest;
use crate::units::{self, UnitError};

use super::lexer::{Located, Token, tokens};
use super::source::Source;

/// Binding power of a sign: as strong as a product, weaker than a power.
const SIGN: u8 = 3;

/// Parses an expression up to the first error.
pub(super) fn parse(source: &Source<'_>) -> Result<ExprAst, Diagnostic> {
    let tokens = tokens(source)?;
    let mut parser = Parser {
        source,
        tokens,
        at: 0,
        depth: 0,
    };
    if parser.peek().token == Token::End {
        return Err(
            Diagnostic::error(Code::ExpressionSyntax, "the expression is empty")
                .at(source.whole.clone(), ""),
        );
    }
    let tree = parser.expression(0)?;
    if parser.peek().token == Token::End {
        Ok(tree.expr)
    } else {
        Err(parser.stray())
    }
}

/// An expression and its height; deep trees would overflow the stack of recursive passes.
struct Tree {
    expr: ExprAst,
    height: usize,
    /// Span in the text of the expression; spans are joined before they are mapped to the file.
    start: usize,
    end: usize,
}

/// The height of the highest of several expressions.
fn highest(trees: &[Tree]) -> usize {
    trees.iter().map(|tree| tree.height).max().unwrap_or(0)
}

struct Parser<'s, 'a> {
    source: &'s Source<'a>,
    tokens: Vec<Located<'a>>,
    at: usize,
    depth: usize,
}

impl<'a> Parser<'_, 'a> {
    /// The next token; the list ends with [`Token::End`], which is never passed.
    fn peek(&self) -> Located<'a> {
        self.tokens[self.at.min(self.tokens.len() - 1)]
    }

    fn next(&mut self) -> Located<'a> {
        let token = self.peek();
        self.at += 1;
        token
    }

    fn error(&self, at: Located<'_>, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(Code::ExpressionSyntax, message)
            .at(self.source.span(at.start..at.end), "")
    }

    /// A token that cannot follow the previous one.
    fn stray(&self) -> Diagnostic {
        let found = self.peek();
        let words = found.token.words();
        let help = self.forgotten_sign();
        match found.token {
            Token::Number(_) | Token::Name(_) | Token::Symbol('(') => self
                .error(found, format!("expected an operator before {words}"))
                .maybe_help(help),
            Token::Relation(_) => self
                .error(found, format!("{words} is allowed only inside `if(…)`"))
                .help("write `if(a < b, x, y)`"),
            Token::Unit(_) => self
                .error(found, "a unit may only follow a number")
                .help("write `5 [N]`"),
            _ => self
                .error(found, format!("{words} is not expected here"))
                .maybe_help(help),
        }
    }

    /// The correction for a missing operator, bracket or decimal point at this position.
    fn forgotten_sign(&self) -> Option<String> {
        let before = self.tokens.get(self.at.checked_sub(1)?)?.token;
        let after = self.tokens.get(self.at + 1).map(|located| located.token);
        match (before, self.peek().token, after) {
            (Token::Name(function), Token::Number(argument) | Token::Name(argument), _)
                if Function::from_name(function).is_some() =>
            {
                Some(format!("write `{function}({argument})`"))
            }
            (Token::Name(library), Token::Number("."), Some(Token::Name(function)))
                if LIBRARIES.contains(&library) =>
            {
                let function = familiar(function).unwrap_or(function);
                Some(format!(
                    "functions stand alone: write `{function}` without `{library}.`"
                ))
            }
            (Token::Number(number), Token::Name(unit), _) if units::parse(unit).is_ok() => Some(
                format!("a product is written with `*`, a unit in brackets: `{number} [{unit}]`"),
            ),
            (Token::Number(whole), Token::Symbol(','), Some(Token::Number(part))) => {
                Some(format!("write the decimal point, `{whole}.{part}`"))
            }
            (
                Token::Number(_) | Token::Name(_) | Token::Symbol(')'),
                Token::Number(_) | Token::Name(_) | Token::Symbol('('),
                _,
            ) => Some("a product is written with `*`".to_owned()),
            _ => None,
        }
    }

    fn expect(&mut self, symbol: char, after: &str) -> Result<Located<'a>, Diagnostic> {
        let found = self.peek();
        if found.token == Token::Symbol(symbol) {
            return Ok(self.next());
        }
        let words = found.token.words();
        let message = format!("expected `{symbol}` after {after}, found {words}");
        Err(self.error(found, message).maybe_help(self.forgotten_sign()))
    }

    fn node(
        &self,
        kind: ExprAstKind,
        start: usize,
        end: usize,
        height: usize,
    ) -> Result<Tree, Diagnostic> {
        if height > MAX_DEPTH {
            return Err(self.too_deep());
        }
        Ok(Tree {
            expr: ExprAst {
                kind,
                span: self.source.span(start..end),
            },
            height,
            start,
            end,
        })
    }

    fn too_deep(&self) -> Diagnostic {
        Diagnostic::error(
            Code::LimitExceeded,
            format!("an expression may nest at most {MAX_DEPTH} operations"),
        )
        .at(self.source.whole.clone(), "")
    }

    fn expression(&mut self, least: u8) -> Result<Tree, Diagnostic> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.too_deep());
        }
        let mut left = self.prefix(least)?;
        while let Some((op, binds_left, binds_right)) = operator(self.peek().token) {
            if binds_left < least {
                break;
            }
            self.next();
            let right = self.expression(binds_right)?;
            let (start, end) = (left.start, right.end);
            let height = 1 + left.height.max(right.height);
            let kind = ExprAstKind::Binary(op, Box::new(left.expr), Box::new(right.expr));
            left = self.node(kind, start, end, height)?;
        }
        self.depth -= 1;
        Ok(left)
    }

    fn prefix(&mut self, least: u8) -> Result<Tree, Diagnostic> {
        let first = self.next();
        match first.token {
            Token::Number(text) => self.number(first, text),
            Token::Name(name) => self.name(first, name),
            Token::Symbol('-') => {
                // In `2^-1*x` the sign ends where the power ends.
                let inner = self.expression(SIGN.max(least))?;
                let (end, height) = (inner.end, inner.height + 1);
                let kind = ExprAstKind::Negate(Box::new(inner.expr));
                self.node(kind, first.start, end, height)
            }
            Token::Symbol('(') => {
                let inner = self.expression(0)?;
                let close = self.expect(')', "the expression in parentheses")?;
                // The parentheses are part of the span, not of the tree.
                Ok(Tree {
                    start: first.start,
                    end: close.end,
                    ..inner
                })
            }
            Token::End => Err(self.error(first, "unexpected end of the expression")),
            other => Err(self.error(
                first,
                format!("expected a number, a name or `(`, found {}", other.words()),
            )),
        }
    }

    fn number(&mut self, first: Located<'_>, text: &str) -> Result<Tree, Diagnostic> {
        let value = exact(text).map_err(|e| {
            number_diagnostic(e, text).at(self.source.span(first.start..first.end), "")
        })?;
        let mut end = first.end;
        let mut unit = None;
        let next = self.peek();
        if let Token::Unit(text) = next.token {
            self.next();
            end = next.end;
            let parsed = units::parse(text).map_err(|e| {
                unit_diagnostic(&e, |at| {
                    self.source
                        .span(next.start + 1 + at.start..next.start + 1 + at.end)
                })
            })?;
            unit = Some(Box::new(parsed));
        }
        self.node(ExprAstKind::Number(value, unit), first.start, end, 1)
    }

    fn name(&mut self, first: Located<'a>, name: &str) -> Result<Tree, Diagnostic> {
        if self.peek().token != Token::Symbol('(') {
            let kind = ExprAstKind::Name(name.to_owned());
            return self.node(kind, first.start, first.end, 1);
        }
        match name {
            "dot" => self.rate(first),
            "if" => self.choice(first),
            _ => match (Function::from_name(name), Word::from_name(name)) {
                (Some(function), _) => self.call(first, function),
                (None, Some(word)) => self.named(first, word),
                (None, None) => Err(self.unknown_function(first, name)),
            },
        }
    }

    fn named(&mut self, first: Located<'a>, word: Word) -> Result<Tree, Diagnostic> {
        self.expect('(', word.name())?;
        let names = self.list(|parser| {
            let inner = parser.next();
            let Token::Name(name) = inner.token else {
                let found = inner.token.words();
                let message = format!("`{}` takes names, found {found}", word.name());
                let help = format!("write `{}`", word.example());
                return Err(parser.error(inner, message).help(help));
            };
            Ok(Spanned {
                value: name.to_owned(),
                span: parser.source.span(inner.start..inner.end),
            })
        })?;
        let close = self.expect(')', "the names")?;
        let kind = ExprAstKind::Named(word, names);
        self.node(kind, first.start, close.end, 1)
    }

    /// Several parts, separated by commas.
    fn list<T>(
        &mut self,
        part: impl Fn(&mut Self) -> Result<T, Diagnostic>,
    ) -> Result<Vec<T>, Diagnostic> {
        let mut parts = vec![part(self)?];
        while self.peek().token == Token::Symbol(',') {
            self.next();
            parts.push(part(self)?);
        }
        Ok(parts)
    }

    fn rate(&mut self, first: Located<'a>) -> Result<Tree, Diagnostic> {
        self.expect('(', "`dot`")?;
        let inner = self.next();
        let Token::Name(name) = inner.token else {
            return Err(self
                .error(inner, "`dot` takes the name of a coordinate")
                .help("write out derivatives of expressions, such as `2*q*dot(q)`"));
        };
        if name == "dot" && self.peek().token == Token::Symbol('(') {
            return Err(self
                .error(inner, "`dot` takes the name of a coordinate")
                .help(SECOND_RATE));
        }
        let close = self.expect(')', "the coordinate")?;
        let kind = ExprAstKind::Rate(Spanned {
            value: name.to_owned(),
            span: self.source.span(inner.start..inner.end),
        });
        self.node(kind, first.start, close.end, 1)
    }

    fn call(&mut self, first: Located<'a>, function: Function) -> Result<Tree, Diagnostic> {
        let open = self.expect('(', "the function")?;
        let arguments = match self.peek().token {
            Token::Symbol(')') => Vec::new(),
            _ => self.list(|parser| parser.expression(0))?,
        };
        let close = self.expect(')', "the arguments")?;
        let (name, arity) = (function.name(), function.arity());
        let found = arguments.len();
        if found != arity {
            let plural = if arity == 1 { "" } else { "s" };
            let message = format!("`{name}` takes {arity} argument{plural}, found {found}");
            let place = self.source.span(open.start..close.end);
            return Err(Diagnostic::error(Code::WrongArity, message).at(place, ""));
        }
        let height = 1 + highest(&arguments);
        let arguments = arguments.into_iter().map(|tree| tree.expr);
        let kind = ExprAstKind::Call(function, arguments.collect());
        self.node(kind, first.start, close.end, height)
    }

    fn choice(&mut self, first: Located<'a>) -> Result<Tree, Diagnostic> {
        self.expect('(', "`if`")?;
        let left = self.expression(0)?;
        let relation = self.next();
        let Token::Relation(symbol) = relation.token else {
            return Err(self
                .error(relation, "`if` starts with a comparison")
                .help("write `if(a < b, x, y)`"));
        };
        let right = self.expression(0)?;
        self.expect(',', "the comparison")?;
        let then = self.expression(0)?;
        self.expect(',', "the value if the comparison holds")?;
        let otherwise = self.expression(0)?;
        let close = self.expect(')', "the value elsewhere")?;
        let (compared, branches) = ([left, right], [then, otherwise]);
        let height = 1 + highest(&compared).max(highest(&branches));
        let kind = ExprAstKind::Choice {
            relation: symbol,
            compared: Box::new(compared.map(|tree| tree.expr)),
            branches: Box::new(branches.map(|tree| tree.expr)),
        };
        self.node(kind, first.start, close.end, height)
    }

    fn unknown_function(&self, at: Located<'_>, name: &str) -> Diagnostic {
        let named = Word::ALL.iter().map(|row| row.1);
        let known = Function::ALL.iter().map(|row| row.1);
        let known = known.chain(["dot", "if"]).chain(named);
        let help = match name {
            "ddot" | "dotdot" | "der2" => SECOND_RATE.to_owned(),
            _ => familiar(name)
                .or_else(|| suggest::closest(name, known))
                .map_or_else(
                    || {
                        let names = suggest::list(Function::ALL.iter().map(|row| row.1));
                        format!("the functions are {names}")
                    },
                    suggest::meant,
                ),
        };
        Diagnostic::error(Code::UnknownFunction, format!("unknown function `{name}`"))
            .at(self.source.span(at.start..at.end), "")
            .help(help)
    }
}

/// The correction to suggest for a second derivative in an expression.
pub(crate) const SECOND_RATE: &str = "accelerations are results: an output may name `acceleration(P, x)` of a point, or \
     `angular_acceleration(F, x)` of a frame; a spec states rates, `dot(q)`";

/// Prefixes of functions in other languages.
const LIBRARIES: [&str; 8] = ["np", "numpy", "math", "Math", "sp", "sympy", "ca", "jnp"];

/// Names of functions in other languages.
fn familiar(name: &str) -> Option<&'static str> {
    Some(match name {
        "log" => "ln",
        "arctan" => "atan",
        "arcsin" => "asin",
        "arccos" => "acos",
        "arctan2" => "atan2",
        "fabs" | "absolute" => "abs",
        "sgn" | "signum" => "sign",
        "minimum" | "fmin" => "min",
        "maximum" | "fmax" => "max",
        "where" | "if_else" => "if",
        "der" | "diff" | "ddt" => "dot",
        "pow" | "power" => "^",
        _ => return None,
    })
}

/// An operator with its binding powers to the left and to the right.
fn operator(token: Token<'_>) -> Option<(BinaryOp, u8, u8)> {
    match token {
        Token::Symbol('+') => Some((BinaryOp::Add, 1, 2)),
        Token::Symbol('-') => Some((BinaryOp::Subtract, 1, 2)),
        Token::Symbol('*') => Some((BinaryOp::Multiply, 3, 4)),
        Token::Symbol('/') => Some((BinaryOp::Divide, 3, 4)),
        // Right associative: a^b^c is a^(b^c).
        Token::Symbol('^') => Some((BinaryOp::Power, 6, 5)),
        _ => None,
    }
}

/// The message for an invalid number; the caller adds the position.
pub(super) fn number_diagnostic(error: NumberError, text: &str) -> Diagnostic {
    // A hostile number may be a megabyte long.
    let short: String = text.chars().take(30).collect();
    match error {
        NumberError::NotFinite => {
            Diagnostic::error(Code::NotFinite, format!("`{short}` is not a finite number"))
        }
        NumberError::TooLarge => Diagnostic::error(
            Code::LimitExceeded,
            "the number has too many digits or too large an exponent",
        ),
        NumberError::Syntax => {
            Diagnostic::error(Code::ExpressionSyntax, format!("`{short}` is not a number"))
        }
    }
}

/// The message for an invalid unit; `place` maps positions in the unit text to positions in the file.
pub fn unit_diagnostic(error: &UnitError, place: impl Fn(Range<usize>) -> Span) -> Diagnostic {
    match error {
        UnitError::Unknown {
            symbol,
            at,
            similar,
        } => Diagnostic::error(Code::UnknownUnit, format!("unknown unit `{symbol}`"))
            .at(place(at.clone()), "")
            .maybe_help(similar.as_deref().map(suggest::meant)),
        UnitError::Syntax { message, at } => {
            Diagnostic::error(Code::UnitSyntax, message.as_str()).at(place(at.clone()), "")
        }
    }
}

/// The number zero, for omitted expressions.
pub(crate) fn zero(span: Span) -> ExprAst {
    ExprAst {
        kind: ExprAstKind::Number(BigRational::from_integer(0.into()), None),
        span,
    }
}
