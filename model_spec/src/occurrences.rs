//! Occurrences of the names of a spec: their definitions and their uses.

use crate::ast::{Entry, ExprAst, ExprAstKind, ItemAst, Spanned, SpecAst, ValueAst};
use crate::expr::{Span, Word};
use crate::joints;
use crate::language::{Form, Target};
use crate::outline::{Outline, unquoted};

/// Names of one namespace differ from each other; a frame and a point may share a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[expect(missing_docs, reason = "each variant is the kind of its name")]
pub enum Namespace {
    /// Parameters, coordinates, inputs, signals, definitions, pseudo-velocities and outputs.
    Quantity,
    Frame,
    Point,
    Body,
    Constraint,
    Load,
}

/// An occurrence of a name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Occurrence {
    /// Its namespace.
    pub namespace: Namespace,
    /// The name.
    pub name: String,
    /// Its position, without quotes; the whole string if it is written with escapes. For items named after a
    /// joint, the position of the name of the joint.
    pub span: Span,
    /// Whether the name is defined there.
    pub defines: bool,
    /// The section, the item and, for a use, the key.
    pub within: String,
}

impl From<Target> for Namespace {
    fn from(target: Target) -> Self {
        match target {
            Target::Coordinate | Target::PseudoVelocity => Self::Quantity,
            Target::Frame => Self::Frame,
            Target::Point => Self::Point,
            Target::Body => Self::Body,
            Target::Constraint => Self::Constraint,
            Target::Load => Self::Load,
        }
    }
}

impl Namespace {
    /// The namespace of the items of a section.
    pub fn of_section(section: &str) -> Option<Self> {
        Some(match section {
            "parameters" | "coordinates" | "inputs" | "signals" | "definitions"
            | "pseudo_velocities" | "outputs" => Self::Quantity,
            "frames" => Self::Frame,
            "points" => Self::Point,
            "bodies" => Self::Body,
            "constraints" => Self::Constraint,
            "loads" => Self::Load,
            _ => return None,
        })
    }
}

/// The target of the first name after a word, such as the frame in `angular_velocity(frame, z)`.
pub fn named_by(word: Word) -> Target {
    match word {
        Word::Position | Word::Velocity | Word::Speed | Word::Acceleration => Target::Point,
        Word::AngularVelocity | Word::AngularAcceleration => Target::Frame,
        Word::Reaction | Word::NormalForce => Target::Constraint,
        Word::Force => Target::Load,
        Word::DriveForce => Target::PseudoVelocity,
    }
}

/// Every name of a text, in its order; `ast` and `outline` are those of the text.
pub fn occurrences(text: &str, ast: &SpecAst, outline: &Outline) -> Vec<Occurrence> {
    let mut finder = Finder {
        text,
        found: Vec::new(),
        within: String::new(),
    };
    for key in &outline.keys {
        if let [section, name] = key.path.as_slice()
            && !name.is_empty()
        {
            finder.within = format!("{section}.{name}");
            match Namespace::of_section(section) {
                Some(namespace) => finder.see(namespace, name, &key.span, true),
                None if section == "initial" => {
                    finder.see(Namespace::Quantity, name, &key.span, false);
                }
                None if section == joints::SECTION => {
                    finder.see(Namespace::Frame, name, &key.span, true);
                    finder.see(Namespace::Point, name, &key.span, true);
                }
                None => {}
            }
        }
    }
    for joint in ast.items(joints::SECTION) {
        finder.within = format!("{}.{}", joints::SECTION, joint.name.value);
        for name in joints::named_after(joint) {
            finder.see(Namespace::Quantity, &name, &joint.name.span, true);
        }
    }
    for section in &ast.sections {
        for item in &section.items {
            finder.item(
                &format!("{}.{}", section.section.name, item.name.value),
                item,
            );
        }
    }
    finder.found.sort_by_key(|occurrence| occurrence.span.start);
    finder.found
}

struct Finder<'a> {
    text: &'a str,
    found: Vec<Occurrence>,
    within: String,
}

impl Finder<'_> {
    fn see(&mut self, namespace: Namespace, name: &str, span: &Span, defines: bool) {
        let written = self.text.get(span.clone()).unwrap_or_default();
        let is_quoted = written.len() == name.len() + 2 && unquoted(written) == name;
        let quote = usize::from(is_quoted);
        self.found.push(Occurrence {
            namespace,
            name: name.to_owned(),
            span: span.start + quote..span.end - quote,
            defines,
            within: self.within.clone(),
        });
    }

    fn item(&mut self, path: &str, item: &ItemAst) {
        for entry in &item.entries {
            self.within = format!("{path}.{}", entry.key.name);
            self.entry(entry);
        }
    }

    fn entry(&mut self, entry: &Entry) {
        match &entry.value {
            ValueAst::Text(name) => match entry.key.form {
                Form::Reference(target) => self.see(target.into(), name, &entry.span, false),
                Form::NewName => self.see(Namespace::Quantity, name, &entry.span, true),
                _ => {}
            },
            ValueAst::Names(names) => {
                let namespace = match entry.key.form {
                    Form::Two(target) => target.into(),
                    _ => Namespace::Quantity,
                };
                let defines = matches!(entry.key.form, Form::NewNames(_));
                for name in names {
                    self.see(namespace, &name.value, &name.span, defines);
                }
            }
            value => {
                self.expressions(value.expressions());
                let path = self.within.clone();
                for table in value.tables() {
                    self.item(&path, table);
                }
            }
        }
    }

    fn expressions(&mut self, all: Vec<&ExprAst>) {
        for expression in all {
            self.expression(expression);
        }
    }

    fn expression(&mut self, expression: &ExprAst) {
        match &expression.kind {
            ExprAstKind::Name(name) => {
                if !matches!(name.as_str(), "t" | "pi") {
                    self.see(Namespace::Quantity, name, &expression.span, false);
                }
            }
            ExprAstKind::Rate(name) => {
                self.see(Namespace::Quantity, &name.value, &name.span, false);
            }
            ExprAstKind::Named(word, names) => self.named(*word, names),
            _ => self.expressions(expression.parts()),
        }
    }

    /// The second name is an axis.
    fn named(&mut self, word: Word, names: &[Spanned<String>]) {
        if let Some(of) = names.first() {
            self.see(named_by(word).into(), &of.value, &of.span, false);
        }
        if let Some(frame) = names.get(2) {
            self.see(Namespace::Frame, &frame.value, &frame.span, false);
        }
    }
}
