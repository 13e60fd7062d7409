//! Defaults by class: missing attributes of an element are taken from its class, or from the enclosing classes.

use std::collections::BTreeMap;

use appell_spec::Code;
use roxmltree::Attribute;

use crate::model::Polynomial;
use crate::xml::{Element, Findings, Span, children, elements, exactly, numbers, tag};

use super::schema::has;

/// The class of elements that name none.
const MAIN: &str = "main";

/// The classes of a file.
#[derive(Default)]
pub(super) struct Defaults<'x> {
    classes: BTreeMap<&'x str, Class<'x>>,
    /// Name of the outermost class.
    main: Option<&'x str>,
}

#[derive(Default)]
struct Class<'x> {
    parent: Option<&'x str>,
    elements: Vec<Element<'x>>,
}

impl<'x> Defaults<'x> {
    pub(super) fn new(root: Element<'x>, findings: &Findings) -> Self {
        let mut defaults = Self::default();
        let mut open: Vec<(Element<'x>, Option<&'x str>)> = children(root, "default")
            .map(|default| (default, None))
            .collect();
        open.reverse();
        while let Some((element, parent)) = open.pop() {
            let name = match (element.attribute("class"), parent) {
                (Some(name), _) => name,
                (None, None) => MAIN,
                (None, Some(_)) => {
                    let help = "write `<default class=\"…\">`";
                    let message = "a default class without a name";
                    findings.error(Code::MissingKey, tag(element), message, help);
                    continue;
                }
            };
            if parent.is_none() && defaults.main.is_none() {
                defaults.main = Some(name);
            }
            let class = defaults.classes.entry(name).or_default();
            class.parent = class.parent.or(parent);
            let inner = children(element, "default").map(|inner| (inner, Some(name)));
            let inner: Vec<_> = inner.collect();
            let own = elements(element).filter(|child| !child.has_tag_name("default"));
            class.elements.extend(own);
            open.extend(inner.into_iter().rev());
        }
        defaults
    }

    pub(super) fn knows(&self, class: &str) -> bool {
        class == MAIN || self.classes.contains_key(class)
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &'x str> {
        self.classes.keys().copied()
    }

    /// The default of a class for an attribute of any of several kinds of elements, separated by blanks.
    pub(super) fn of_any(
        &self,
        kinds: &str,
        class: Option<&str>,
        key: &str,
    ) -> Option<Attribute<'x, 'x>> {
        let mut name = class.or(self.main)?;
        // Classes are nested in the text, so that this ends.
        loop {
            let class = self.classes.get(name)?;
            let mut own = class
                .elements
                .iter()
                .rev()
                .filter(|element| has(kinds, element.tag_name().name()));
            if let Some(found) = own.find_map(|element| element.attribute_node(key)) {
                return Some(found);
            }
            name = class.parent.filter(|parent| *parent != name)?;
        }
    }

    /// The defaults of a class for any of several kinds of elements, from those of the outermost class on.
    pub(super) fn chain(&self, kinds: &str, class: Option<&str>) -> Vec<Element<'x>> {
        let mut name = class.or(self.main);
        let mut chain = Vec::new();
        // Classes are nested in the text, so that this ends.
        while let Some(class) = name.and_then(|name| self.classes.get(name)) {
            let own = class.elements.iter().rev();
            let own = own.filter(|element| has(kinds, element.tag_name().name()));
            chain.extend(own.copied());
            name = class.parent.filter(|parent| Some(*parent) != name);
        }
        chain.reverse();
        chain
    }
}

/// The attributes of an element, with the defaults of its class for those that are missing.
#[derive(Clone, Copy)]
pub(super) struct Given<'r, 'x> {
    pub(super) element: Element<'x>,
    /// The names of elements of its kind in classes, separated by blanks.
    pub(super) kinds: &'static str,
    pub(super) class: Option<&'x str>,
    pub(super) defaults: &'r Defaults<'x>,
    pub(super) findings: &'r Findings,
}

impl<'x> Given<'_, 'x> {
    pub(super) fn attribute(&self, key: &str) -> Option<Attribute<'x, 'x>> {
        let own = self.element.attribute_node(key);
        own.or_else(|| self.defaults.of_any(self.kinds, self.class, key))
    }

    pub(super) fn word(&self, key: &str) -> Option<&'x str> {
        self.attribute(key).map(|given| given.value())
    }

    /// The place of a value, or of the element where there is none.
    pub(super) fn place(&self, key: &str) -> Span {
        let given = self.attribute(key);
        given.map_or_else(|| tag(self.element), |given| given.range_value())
    }

    pub(super) fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        numbers(self.findings, &self.attribute(key)?)
    }

    /// A fixed number of numbers, which are `what` in messages.
    pub(super) fn exactly<const N: usize>(&self, key: &str, what: &str) -> Option<[f64; N]> {
        exactly(self.findings, &self.attribute(key)?, what)
    }

    pub(super) fn number(&self, key: &str) -> Option<f64> {
        let [number] = self.exactly(key, &format!("`{key}`"))?;
        Some(number)
    }

    /// Up to three factors.
    pub(super) fn polynomial(&self, key: &str) -> Polynomial {
        let mut polynomial = [0.0; 3];
        let read = self.numbers(key).into_iter().flatten();
        for (factor, read) in polynomial.iter_mut().zip(read) {
            *factor = read;
        }
        polynomial
    }
}
