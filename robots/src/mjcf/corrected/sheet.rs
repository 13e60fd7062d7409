//! Attributes that are to be written, element by element.

use std::collections::{BTreeMap, BTreeSet};

use appell_spec::Code;

use crate::format::Format;
use crate::includes::Whole;
use crate::model::Robot;
use crate::xml::{Element, Findings, Span, elements, inside, parse, tag};

use super::super::compiler::Compiler;
use super::super::defaults::Defaults;
use super::super::law::Law;
use super::body;
use super::bytes::{Edits, escaped, line_end};
use super::change::{Refused, refused};

/// Elements with changed attributes.
pub(super) struct Sheet<'x, 'f> {
    pub(super) root: Element<'x>,
    pub(super) whole: &'f Whole<'f>,
    /// The text of the file, without includes.
    original: &'f str,
    pub(super) format: Format,
    pub(super) compiler: Compiler,
    pub(super) defaults: Defaults<'x>,
    pub(super) robot: Robot,
    pending: Vec<Pending<'x>>,
    /// Laws of actuators, where they change.
    pub(super) laws: Vec<(Element<'x>, Law)>,
    pub(super) groups: Vec<body::Group>,
    /// Whether masses, inertias or armatures change.
    pub(super) reshaped: bool,
    /// Damping and friction of joints of a URDF.
    pub(super) dynamics: Vec<(Element<'x>, [f64; 2])>,
    /// Joints with backlash, and its size.
    pub(super) plays: Vec<(String, f64)>,
    /// Texts that are inserted into the file, with their places.
    inserted: Vec<(usize, String)>,
    /// Elements without contents that get some: the end of their tag, by its start, with the contents.
    filled: BTreeMap<usize, (usize, String)>,
    /// Names that were given to new elements.
    pub(super) named: BTreeSet<String>,
    /// Sentences on changes that are no attributes.
    pub(super) said: Vec<String>,
    /// What `replicate` copies, in the file.
    copied: Vec<Span>,
}

/// An element with its changed attributes.
struct Pending<'x> {
    element: Element<'x>,
    /// Its new name.
    renamed: Option<&'static str>,
    /// Attributes with their new value, or without one.
    attributes: Vec<(&'static str, Option<String>)>,
}

impl<'x, 'f> Sheet<'x, 'f> {
    pub(super) fn new(
        root: Element<'x>,
        format: Format,
        whole: &'f Whole<'f>,
        original: &'f str,
        robot: Robot,
        findings: &Findings,
    ) -> Self {
        Self {
            root,
            whole,
            original,
            format,
            compiler: Compiler::read(root, findings),
            defaults: Defaults::new(root, findings),
            robot,
            pending: Vec::new(),
            laws: Vec::new(),
            groups: Vec::new(),
            reshaped: false,
            dynamics: Vec::new(),
            plays: Vec::new(),
            inserted: Vec::new(),
            filled: BTreeMap::new(),
            named: BTreeSet::new(),
            said: Vec::new(),
            copied: copied(original),
        }
    }

    /// The element whose start tag begins at a place of the combined text.
    pub(super) fn at(&self, place: &Span) -> Option<Element<'x>> {
        let mut all = self.root.descendants();
        all.find(|one| one.is_element() && one.range().start == place.start)
    }

    /// The class of an element: its own, or the one of the bodies around it.
    pub(super) fn class(element: Element<'x>) -> Option<&'x str> {
        let around = || {
            element
                .ancestors()
                .skip(1)
                .find_map(|outer| outer.attribute("childclass"))
        };
        element.attribute("class").or_else(around)
    }

    fn pending(&self, element: Element<'x>) -> Option<&Pending<'x>> {
        self.pending.iter().find(|one| one.element == element)
    }

    /// An attribute of an element itself, as it is to be written.
    pub(super) fn own(&self, element: Element<'x>, key: &str) -> Option<String> {
        let pending = self.pending(element);
        let changed = pending.and_then(|one| one.attributes.iter().find(|(own, _)| *own == key));
        match changed {
            Some((_, value)) => value.clone(),
            None => element.attribute(key).map(str::to_owned),
        }
    }

    /// An attribute of an element or of its class; `kinds` are the names that elements of this kind have in a class.
    pub(super) fn given(&self, element: Element<'x>, kinds: &str, key: &str) -> Option<String> {
        let inherited = || self.inherited(element, kinds, key);
        self.own(element, key).or_else(inherited)
    }

    /// The attribute that an element has of its class.
    pub(super) fn inherited(&self, element: Element<'x>, kinds: &str, key: &str) -> Option<String> {
        let class = Self::class(element);
        let default = self.defaults.of_any(kinds, class, key);
        default.map(|default| default.value().to_owned())
    }

    /// Numbers of an attribute.
    pub(super) fn numbers(
        &self,
        element: Element<'x>,
        kinds: &str,
        key: &str,
    ) -> Result<Option<Vec<f64>>, Refused> {
        self.given(element, kinds, key)
            .map(|given| read(&given, element, key))
            .transpose()
    }

    /// The first number of an attribute.
    pub(super) fn first(
        &self,
        element: Element<'x>,
        kinds: &str,
        key: &str,
    ) -> Result<Option<f64>, Refused> {
        let all = self.numbers(element, kinds, key)?;
        Ok(all.and_then(|all| all.first().copied()))
    }

    /// Changes an attribute of an element.
    pub(super) fn set(
        &mut self,
        element: Element<'x>,
        key: &'static str,
        value: impl Into<String>,
    ) -> Result<(), Refused> {
        self.put(element, key, Some(value.into()))
    }

    /// Removes an attribute of an element, if it has it itself.
    pub(super) fn remove(
        &mut self,
        element: Element<'x>,
        key: &'static str,
    ) -> Result<(), Refused> {
        match self.own(element, key) {
            Some(_) => self.put(element, key, None),
            None => Ok(()),
        }
    }

    fn put(
        &mut self,
        element: Element<'x>,
        key: &'static str,
        value: Option<String>,
    ) -> Result<(), Refused> {
        let attributes = &mut self.entry(element)?.attributes;
        match attributes.iter_mut().find(|(own, _)| *own == key) {
            Some((_, own)) => *own = value,
            None => attributes.push((key, value)),
        }
        Ok(())
    }

    /// Gives an element another name.
    pub(super) fn rename(
        &mut self,
        element: Element<'x>,
        name: &'static str,
    ) -> Result<(), Refused> {
        self.entry(element)?.renamed = Some(name);
        Ok(())
    }

    fn entry(&mut self, element: Element<'x>) -> Result<&mut Pending<'x>, Refused> {
        let found = self.pending.iter().position(|one| one.element == element);
        let index = if let Some(index) = found {
            index
        } else {
            self.place(element)?;
            self.pending.push(Pending {
                element,
                renamed: None,
                attributes: Vec::new(),
            });
            self.pending.len() - 1
        };
        Ok(&mut self.pending[index])
    }

    /// The place of a start tag in the file; refuses elements of other files and copies.
    fn place(&self, element: Element<'x>) -> Result<Span, Refused> {
        let tag = tag(element);
        let what = element.tag_name().name();
        let name = element.attribute("name").unwrap_or_default();
        let place = self.whole.in_first(&tag).map_err(|file| {
            let message = format!("`{what}` `{}` is in `{file}`", appell_spec::shown(name));
            let help = "an included file is not changed: write its elements into the file that includes it";
            refused(Code::NotAllowedHere, tag.clone(), message, help)
        })?;
        let is_copy = self.original.get(place.clone()) != Some(&self.whole.text[tag.clone()])
            || self.copied.iter().any(|all| all.contains(&place.start));
        if is_copy {
            let message = format!(
                "`{what}` `{}` is a copy of `replicate`",
                appell_spec::shown(name)
            );
            let help = "write the copies out to change one of them";
            return Err(refused(Code::NotAllowedHere, tag, message, help));
        }
        Ok(place)
    }

    /// Whether an element is in the file itself.
    pub(super) fn is_in_file(&self, element: Element<'x>) -> bool {
        self.place(element).is_ok()
    }

    /// The blanks before an element on its line; none where something else stands before it.
    fn indent(&self, at: usize) -> Option<&'f str> {
        let before = &self.original[..at];
        let line = before.rfind('\n')? + 1;
        let blanks = &before[line..];
        blanks.trim().is_empty().then_some(blanks)
    }

    /// The text before an element that starts a line for itself, as far as it is separated from the others by lines.
    fn separator(&self, at: usize) -> String {
        match self.indent(at) {
            Some(blanks) => format!("{}{blanks}", line_end(self.original)),
            None => String::new(),
        }
    }

    /// Inserts an element after another one.
    pub(super) fn insert_after(&mut self, element: Element<'x>, text: &str) -> Result<(), Refused> {
        let start = self.place(element)?.start;
        let last = element.range().end - 1;
        let end = self.in_file(element, last)? + 1;
        let separator = self.separator(start);
        self.inserted.push((end, format!("{separator}{text}")));
        Ok(())
    }

    /// Inserts an element into another one, as its first child or after all others.
    pub(super) fn insert_into(
        &mut self,
        element: Element<'x>,
        text: &str,
        first: bool,
    ) -> Result<(), Refused> {
        let tag = self.place(element)?;
        let own = self.separator(tag.start);
        let child = elements(element)
            .filter_map(|child| self.place(child).ok())
            .find_map(|child| self.indent(child.start));
        let inner = match child {
            Some(blanks) => format!("{}{blanks}", line_end(self.original)),
            None if own.is_empty() => String::new(),
            None => format!("{own}  "),
        };
        let text = format!("{inner}{text}");
        if self.original[tag.clone()].ends_with("/>") {
            let filled = self.filled.entry(tag.start);
            let (_, contents) = filled.or_insert((tag.end, String::new()));
            contents.push_str(&text);
        } else if first {
            self.inserted.push((tag.end, text));
        } else {
            let close = self.in_file(element, inside(element).end)?;
            let line = self.original[..close].trim_end_matches([' ', '\t']).len();
            let at = if line > 0 && self.original[..line].ends_with('\n') {
                let before = &self.original[..line - 1];
                before.strip_suffix('\r').unwrap_or(before).len()
            } else {
                close
            };
            self.inserted.push((at, text));
        }
        Ok(())
    }

    /// A place of an element in the file.
    fn in_file(&self, element: Element<'x>, at: usize) -> Result<usize, Refused> {
        let place = self.whole.in_first(&(at..at + 1));
        let place = place.map(|place| place.start);
        place.map_err(|file| {
            let message = format!("the element ends in `{file}`");
            let help = "write it into one file";
            refused(Code::NotAllowedHere, tag(element), message, help)
        })
    }

    /// Adds the replacements in the file; the result is a sentence on each.
    pub(super) fn write(self, edits: &mut Edits) -> Result<Vec<String>, Refused> {
        let mut said = Vec::new();
        for one in &self.pending {
            let shift = self.place(one.element)?.start;
            one.write(shift, edits);
            said.extend(one.sentence(&self));
        }
        for (at, text) in &self.inserted {
            edits.replace(*at..*at, text.clone());
        }
        for (start, (end, contents)) in &self.filled {
            let ends = |c: char| c.is_whitespace() || c == '/';
            let name = self.original[start + 1..].split(ends).next();
            let name = name.unwrap_or_default();
            let separator = self.separator(*start);
            edits.replace(end - 2..*end, format!(">{contents}{separator}</{name}>"));
        }
        said.extend(self.said);
        Ok(said)
    }
}

impl Pending<'_> {
    /// Writes its attributes, where its start tag begins at `start` in the file.
    fn write(&self, start: usize, edits: &mut Edits) {
        let element = self.element;
        let base = element.range().start;
        let at = |place: usize| place - base + start;
        let name = element.tag_name().name();
        let named = start + 1..start + 1 + name.len();
        if let Some(renamed) = self.renamed {
            edits.replace(named.clone(), renamed);
        }
        let last = element.attributes().next_back();
        let end = last.map_or(named.end, |last| at(last.range().end));
        for (key, value) in &self.attributes {
            match (element.attribute_node(*key), value) {
                (Some(own), Some(value)) if own.value() != value => {
                    let place = own.range_value();
                    edits.replace(at(place.start)..at(place.end), escaped(value));
                }
                (None, Some(value)) => {
                    edits.replace(end..end, format!(" {key}=\"{}\"", escaped(value)));
                }
                (Some(own), None) => {
                    let text = &element.document().input_text()[base..own.range().start];
                    let from = base + text.trim_end().len();
                    edits.replace(at(from)..at(own.range().end), "");
                }
                _ => {}
            }
        }
    }

    /// What changes, in a sentence.
    fn sentence(&self, sheet: &Sheet<'_, '_>) -> Option<String> {
        let element = self.element;
        let kind = element.tag_name().name();
        let mut around = element.ancestors();
        let name = around.find_map(|own| own.attribute("name"));
        let (mut changes, mut dropped) = (Vec::new(), Vec::new());
        if let Some(renamed) = self.renamed {
            changes.push(format!("a `{renamed}` with its numbers written out"));
        }
        for (key, value) in &self.attributes {
            let before = element
                .attribute(*key)
                .map(str::to_owned)
                .or_else(|| sheet.inherited(element, kind, key));
            match (before, value) {
                (Some(before), Some(value)) if before != *value => {
                    changes.push(format!("{key} {value} (was {before})"));
                }
                (None, Some(value)) => changes.push(format!("{key} {value}")),
                (Some(_), None) if self.renamed.is_none() => dropped.push(format!("no {key}")),
                _ => {}
            }
        }
        changes.append(&mut dropped);
        let name = name.map_or(String::new(), |name| format!(" {name}"));
        (!changes.is_empty()).then(|| format!("{kind}{name}: {}", changes.join(", ")))
    }
}

/// Numbers of a text.
pub(super) fn read(text: &str, element: Element<'_>, key: &str) -> Result<Vec<f64>, Refused> {
    let words = text.split_ascii_whitespace();
    let read: Result<Vec<f64>, _> = words.map(str::parse).collect();
    read.map_err(|_| {
        let message = format!(
            "`{key}` is no list of numbers: `{}`",
            appell_spec::shown(text)
        );
        let help = "write numbers separated by blanks";
        refused(Code::WrongType, tag(element), message, help)
    })
}

/// What `replicate` copies.
fn copied(text: &str) -> Vec<Span> {
    if !text.contains("<replicate") {
        return Vec::new();
    }
    let text = crate::xml::begun(text);
    parse(&text).map_or_else(
        |_| Vec::new(),
        |document| {
            let all = document.root_element();
            let all = all.descendants();
            let all = all.filter(|one| one.has_tag_name("replicate"));
            all.map(|one| one.range()).collect()
        },
    )
}
