//! Defaults by class: missing attributes of an element are taken from its class, or from the enclosing classes.

use std::collections::BTreeMap;

use appell_spec::Code;
use roxmltree::Attribute;

use crate::xml::{Element, Findings, children, tag};

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
                    findings.error(
                        Code::MissingKey,
                        tag(element),
                        "a default class without a name",
                        help,
                    );
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
            let own = element
                .children()
                .filter(|child| child.is_element() && child.tag_name().name() != "default");
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

    /// The default of a class for an attribute of a kind of element.
    pub(super) fn attribute(
        &self,
        kind: &str,
        class: Option<&str>,
        key: &str,
    ) -> Option<Attribute<'x, 'x>> {
        self.of_any(kind, class, key)
    }

    /// The default of a class for an attribute of any of several kinds of elements, separated by blanks.
    pub(super) fn of_any(
        &self,
        kinds: &str,
        class: Option<&str>,
        key: &str,
    ) -> Option<Attribute<'x, 'x>> {
        let is_one = |name: &str| kinds.split_ascii_whitespace().any(|kind| kind == name);
        let mut name = class.or(self.main)?;
        // Classes are nested in the text, so that this ends.
        loop {
            let class = self.classes.get(name)?;
            let mut own = class
                .elements
                .iter()
                .rev()
                .filter(|element| is_one(element.tag_name().name()));
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
            let own = class.elements.iter().rev().filter(|element| {
                let word = element.tag_name().name();
                kinds.split_ascii_whitespace().any(|kind| kind == word)
            });
            chain.extend(own.copied());
            name = class.parent.filter(|parent| Some(*parent) != name);
        }
        chain.reverse();
        chain
    }
}
