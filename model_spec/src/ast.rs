//! The syntax tree of a spec, before names are resolved.

use num_rational::BigRational;

use crate::expr::{BinaryOp, Function, Relation, Span, Word};
use crate::language::{Key, Kind, Section, Sense};
use crate::units::Unit;

/// A value and its position.
#[derive(Debug, Clone, PartialEq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Its position in the text.
    pub span: Span,
}

/// A whole spec, section by section in the order of the text.
#[derive(Debug, Clone)]
pub struct SpecAst {
    /// The sections.
    pub sections: Vec<SectionAst>,
    /// Whether parts of the text could not be parsed, so that definitions may be missing.
    pub broken: bool,
}

/// A section.
#[derive(Debug, Clone)]
pub struct SectionAst {
    /// The kind of section.
    pub section: &'static Section,
    /// Position of its name.
    pub span: Span,
    /// Its items in the order of the text; a section that is one table has one item.
    pub items: Vec<ItemAst>,
}

/// One definition: a name and a table of keys.
#[derive(Debug, Clone)]
pub struct ItemAst {
    /// The defined name.
    pub name: Spanned<String>,
    /// Its kind, if the section has several.
    pub kind: Option<&'static Kind>,
    /// The keys and their values.
    pub entries: Vec<Entry>,
    /// Whether everything in the table could be read.
    pub intact: bool,
}

/// A key with its value.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Which key.
    pub key: &'static Key,
    /// Position of the value.
    pub span: Span,
    /// The value.
    pub value: ValueAst,
}

/// The forms of a value.
#[derive(Debug, Clone)]
pub enum ValueAst {
    /// A sentence or a name.
    Text(String),
    /// One of the words that the key takes.
    Word(Sense),
    /// Yes or no.
    Flag(bool),
    /// A number in the unit of the item.
    Number(BigRational),
    /// Several numbers.
    Numbers(Vec<Spanned<BigRational>>),
    /// A unit.
    Unit(Unit),
    /// An expression.
    Expression(ExprAst),
    /// Three expressions.
    Components(Box<[ExprAst; 3]>),
    /// Nine expressions, row by row.
    Matrix(Box<[[ExprAst; 3]; 3]>),
    /// Several names.
    Names(Vec<Spanned<String>>),
    /// A list of tables.
    Tables(Vec<ItemAst>),
    /// A table.
    Table(Box<ItemAst>),
}

/// An expression.
#[derive(Debug, Clone, PartialEq)]
pub struct ExprAst {
    /// Its form.
    pub kind: ExprAstKind,
    /// Its position in the text.
    pub span: Span,
}

/// The forms of an expression.
#[derive(Debug, Clone, PartialEq)]
pub enum ExprAstKind {
    /// A number, with its unit if stated.
    Number(BigRational, Option<Box<Unit>>),
    /// A name.
    Name(String),
    /// `dot(name)`
    Rate(Spanned<String>),
    /// `velocity(P, x)`, `force(spring)` and their kin: names of items and an axis.
    Named(Word, Vec<Spanned<String>>),
    /// `-a`
    Negate(Box<ExprAst>),
    /// `a ∘ b`
    Binary(BinaryOp, Box<ExprAst>, Box<ExprAst>),
    /// A function.
    Call(Function, Vec<ExprAst>),
    /// `if(a < b, then, otherwise)`
    Choice {
        /// Relation between the compared expressions.
        relation: Relation,
        /// Left and right side.
        compared: Box<[ExprAst; 2]>,
        /// Value where the relation holds, and value elsewhere.
        branches: Box<[ExprAst; 2]>,
    },
    /// A part that could not be parsed, which has been reported.
    Broken,
}

impl SpecAst {
    /// The items of a section, in the order of the text.
    pub fn items(&self, section: &str) -> &[ItemAst] {
        self.sections
            .iter()
            .find(|s| s.section.name == section)
            .map_or(&[], |s| &s.items)
    }
}

impl ItemAst {
    /// The entry under a key.
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.entries.iter().find(|e| e.key.name == key)
    }

    /// The value under a key.
    pub fn value(&self, key: &str) -> Option<&ValueAst> {
        self.entry(key).map(|entry| &entry.value)
    }

    /// The meaning of the word under a key.
    pub fn word(&self, key: &str) -> Option<Sense> {
        match self.value(key)? {
            ValueAst::Word(meaning) => Some(*meaning),
            _ => None,
        }
    }

    /// Whether the flag under a key is set.
    pub fn flag(&self, key: &str) -> bool {
        matches!(self.value(key), Some(ValueAst::Flag(true)))
    }

    /// The text under a key: a sentence or a name.
    pub fn text(&self, key: &str) -> Option<Spanned<&str>> {
        match self.value(key)? {
            ValueAst::Text(text) => self.spanned(key, text.as_str()),
            _ => None,
        }
    }

    /// The number under a key.
    pub fn number(&self, key: &str) -> Option<Spanned<&BigRational>> {
        match self.value(key)? {
            ValueAst::Number(number) => self.spanned(key, number),
            _ => None,
        }
    }

    /// The numbers under a key.
    pub fn numbers(&self, key: &str) -> Option<&[Spanned<BigRational>]> {
        match self.value(key)? {
            ValueAst::Numbers(numbers) => Some(numbers),
            _ => None,
        }
    }

    /// The names under a key.
    pub fn names(&self, key: &str) -> Option<&[Spanned<String>]> {
        match self.value(key)? {
            ValueAst::Names(names) => Some(names),
            _ => None,
        }
    }

    /// The unit under a key.
    pub fn unit(&self, key: &str) -> Option<Spanned<&Unit>> {
        match self.value(key)? {
            ValueAst::Unit(unit) => self.spanned(key, unit),
            _ => None,
        }
    }

    /// The expression under a key.
    pub fn expression(&self, key: &str) -> Option<&ExprAst> {
        match self.value(key)? {
            ValueAst::Expression(expression) => Some(expression),
            _ => None,
        }
    }

    /// The components under a key.
    pub fn components(&self, key: &str) -> Option<&[ExprAst; 3]> {
        match self.value(key)? {
            ValueAst::Components(components) => Some(components),
            _ => None,
        }
    }

    /// A value with the position of that under a key.
    fn spanned<T>(&self, key: &str, value: T) -> Option<Spanned<T>> {
        let span = self.entry(key)?.span.clone();
        Some(Spanned { value, span })
    }
}

impl ValueAst {
    /// The expressions of which it consists, those of tables aside.
    pub fn expressions(&self) -> Vec<&ExprAst> {
        match self {
            Self::Expression(one) => vec![one],
            Self::Components(three) => three.iter().collect(),
            Self::Matrix(nine) => nine.iter().flatten().collect(),
            _ => Vec::new(),
        }
    }

    /// The tables of which it consists.
    pub fn tables(&self) -> &[ItemAst] {
        match self {
            Self::Tables(tables) => tables,
            Self::Table(table) => std::slice::from_ref(table),
            _ => &[],
        }
    }
}

impl ExprAst {
    /// The expressions of which it consists, from left to right.
    pub fn parts(&self) -> Vec<&Self> {
        match &self.kind {
            ExprAstKind::Number(..)
            | ExprAstKind::Name(_)
            | ExprAstKind::Rate(_)
            | ExprAstKind::Named(..)
            | ExprAstKind::Broken => Vec::new(),
            ExprAstKind::Negate(a) => vec![a],
            ExprAstKind::Binary(_, a, b) => vec![a, b],
            ExprAstKind::Call(_, arguments) => arguments.iter().collect(),
            ExprAstKind::Choice {
                compared, branches, ..
            } => compared.iter().chain(branches.iter()).collect(),
        }
    }
}
