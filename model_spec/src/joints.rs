//! Joints: each is expanded to items of other sections before names are resolved.
//!
//! A joint is expanded to text ([`made`]), which is parsed like any spec; the result gets the positions of the
//! joint's own keys. Therefore the spec that [`crate::expanded`] writes is exactly the one that is checked.
//!
//! | file | content |
//! |---|---|
//! | `made.rs` | the expansion of each kind |
//! | `quantities.rs` | names, units and meanings of its coordinates and pseudo-velocities |
//! | `direction.rs` | axes: rotations about them, displacements along them |
//! | `written.rs`, `piece.rs` | expressions of the spec as parts of others, with their positions |
//! | `places.rs` | replaces all positions in a syntax tree |
//! | `document.rs` | the text of a spec with expanded joints |

mod direction;
mod document;
mod made;
mod piece;
mod places;
mod quantities;
mod written;

use crate::ast::{Entry, ItemAst, SectionAst, SpecAst};
use crate::diagnostic::{Code, Diagnostic};
use crate::edit::EditError;
use crate::expr::Span;
use crate::language::Form;
use crate::limits::MAX_ITEMS;
use crate::occurrences::Namespace;
use crate::parse;

pub(crate) use made::SECTION;
use made::{Known, Made};
use piece::Piece;

/// A spec without joints.
#[derive(Debug, Clone)]
pub struct Expansion {
    /// The syntax tree with expanded joints; the positions of their items are those of
    /// the joints' keys.
    pub ast: SpecAst,
    /// Findings about the joints.
    pub findings: Vec<Diagnostic>,
    /// The items by joint.
    made: Vec<(String, Vec<Made>)>,
}

/// Expands the joints of a spec; `None` if there are none. `ast` is the syntax tree
/// of `text`.
pub fn expand(ast: &SpecAst, text: &str) -> Option<Expansion> {
    let section = ast.sections.iter().find(|s| s.section.name == SECTION)?;
    let mut rest = ast.clone();
    rest.sections.retain(|s| s.section.name != SECTION);
    let known = Known::new(ast);
    let mut expansion = Expansion {
        ast: rest,
        findings: Vec::new(),
        made: Vec::new(),
    };
    for joint in &section.items {
        if !joint.intact {
            // Names that it would define may be used.
            expansion.ast.broken = true;
            continue;
        }
        match made::made(text, joint, &known) {
            Ok(made) => expansion.admit(joint, made),
            Err(finding) => {
                expansion.ast.broken = true;
                expansion.findings.push(finding);
            }
        }
    }
    expansion.read(&section.span);
    expansion.count(&section.span);
    Some(expansion)
}

/// The text of a spec with expanded joints. `ast` is the syntax tree of `text`.
pub(crate) fn replaced(ast: &SpecAst, text: &str) -> Result<String, EditError> {
    match expand(ast, text) {
        Some(expansion) => document::replaced(text, SECTION, &expansion.made),
        None => Ok(text.to_owned()),
    }
}

/// The names that a joint gives to coordinates and pseudo-velocities after its own.
pub(crate) fn named_after(joint: &ItemAst) -> Vec<String> {
    let all = quantities::coordinates(joint).into_iter();
    let all = all.chain(quantities::speeds(joint));
    let all = all.filter(|quantity| quantity.written.is_none());
    all.map(|quantity| quantity.name).collect()
}

/// The joint that makes an item.
pub fn maker<'a>(ast: &'a SpecAst, namespace: Namespace, name: &str) -> Option<&'a ItemAst> {
    let makes = |joint: &&ItemAst| match namespace {
        Namespace::Frame | Namespace::Point => joint.name.value == name,
        Namespace::Quantity => {
            let all = quantities::coordinates(joint).into_iter();
            let mut all = all.chain(quantities::speeds(joint));
            all.any(|quantity| quantity.name == name)
        }
        Namespace::Body | Namespace::Constraint | Namespace::Load => false,
    };
    ast.items(SECTION).iter().find(makes)
}

/// Removes findings on a joint that are consequences of another one. The others get a hint on how to see
/// the expansion.
pub(crate) fn explained(
    ast: &SpecAst,
    told: &[Diagnostic],
    mut findings: Vec<Diagnostic>,
) -> Vec<Diagnostic> {
    let is_of_name = |finding: &&Diagnostic| finding.code == Code::ReservedName;
    let of_names = findings.iter().filter(is_of_name);
    let misnamed = told.iter().chain(of_names);
    let misnamed: Vec<String> = misnamed
        .filter_map(|finding| Some(at(ast, finding)?.0.name.value.clone()))
        .collect();
    let mut axes: Vec<(Code, Span)> = Vec::new();
    findings.retain_mut(|finding| {
        let Some((joint, entry)) = at(ast, finding) else {
            return true;
        };
        let name = &joint.name.value;
        if finding.code != Code::ReservedName && misnamed.contains(name) {
            return false;
        }
        finding.help.get_or_insert_with(|| shows(name));
        let mut places = Vec::new();
        finding.labels.retain(|(place, _)| {
            let is_new = !places.contains(place);
            places.push(place.clone());
            is_new
        });
        // The components of an axis occur in several expressions.
        let Some(axis) = entry.filter(|entry| matches!(entry.key.form, Form::Direction)) else {
            return true;
        };
        let seen = (finding.code, axis.span.clone());
        let is_new = !axes.contains(&seen);
        axes.push(seen);
        is_new
    });
    findings
}

/// The joint in which a finding lies, and its key.
fn at<'a>(ast: &'a SpecAst, finding: &Diagnostic) -> Option<(&'a ItemAst, Option<&'a Entry>)> {
    let (place, _) = finding.labels.first()?;
    let holds = |part: &Span| part.start <= place.start && place.end <= part.end;
    ast.items(SECTION).iter().find_map(|joint| {
        let entry = joint.entries.iter().find(|entry| holds(&entry.span));
        (entry.is_some() || holds(&joint.name.span)).then_some((joint, entry))
    })
}

fn shows(joint: &str) -> String {
    format!(
        "it is in the expansion of the joint `{joint}`, which `appell derive` writes out as a spec"
    )
}

impl Expansion {
    /// Adopts the items of a joint whose names are not taken.
    fn admit(&mut self, joint: &ItemAst, made: Vec<Made>) {
        let mut free = Vec::new();
        for one in made {
            match self.clash(joint, &free, &one) {
                Some(finding) => self.findings.push(finding),
                None => free.push(one),
            }
        }
        self.made.push((joint.name.value.clone(), free));
    }

    /// The conflict of an item with another one of the same name.
    fn clash(&self, joint: &ItemAst, own: &[Made], one: &Made) -> Option<Diagnostic> {
        let namespace = Namespace::of_section(one.section);
        let is_same = |section: &str, name: &str| {
            Namespace::of_section(section) == namespace && name == one.name
        };
        let written = self.ast.sections.iter().find_map(|section| {
            let mut items = section.items.iter();
            let other = items.find(|item| is_same(section.section.name, &item.name.value))?;
            let whose = format!("in `[{}]`", section.section.name);
            Some((whose, other.name.span.clone()))
        });
        let of_others = self.made.iter().flat_map(|(name, made)| {
            let whose = format!("by the joint `{name}`");
            made.iter().map(move |other| (whose.clone(), other))
        });
        let of_itself = own
            .iter()
            .map(|other| ("by the joint itself".to_owned(), other));
        let made = || {
            let mut all = of_others.chain(of_itself);
            let (whose, other) = all.find(|(_, other)| is_same(other.section, &other.name))?;
            Some((whose, other.at.clone()))
        };
        let (whose, place) = written.or_else(made)?;
        let (joint, name) = (&joint.name.value, &one.name);
        let what = match one.section {
            "coordinates" => "coordinate",
            "pseudo_velocities" => "pseudo-velocity",
            "frames" => "frame",
            _ => "point",
        };
        let help = match one.key {
            Some(key) => format!("choose another name with the key `{key}` of the joint"),
            None => format!(
                "a joint makes its own {what}: omit the other `{name}`, or rename it or the joint"
            ),
        };
        let mut finding = Diagnostic::error(
            Code::DuplicateName,
            format!("the joint `{joint}` makes the {what} `{name}`, but the name is also defined {whose}"),
        )
        .at(one.at.clone(), format!("makes the {what} `{name}`"));
        if place != one.at {
            finding = finding.at(place, "defined here");
        }
        Some(finding.help(help))
    }

    /// Parses the expansion and appends it to its sections.
    fn read(&mut self, joints: &Span) {
        let all: Vec<&Made> = self.made.iter().flat_map(|(_, made)| made).collect();
        let mut text = Piece::default();
        for section in ["coordinates", "frames", "points", "pseudo_velocities"] {
            let own: Vec<&&Made> = all.iter().filter(|made| made.section == section).collect();
            if own.is_empty() {
                continue;
            }
            text = text.word(&format!("[{section}]\n"));
            for made in own {
                let name = Piece::new(made.name.as_str()).from(&made.at);
                text = text.then(&name).word(" = ").then(&made.table).word("\n");
            }
        }
        let to = |span: &Span| text.place(span).unwrap_or_else(|| joints.clone());
        let (sections, mut findings) = parse::made(&text.text);
        for finding in &mut findings {
            for (place, _) in &mut finding.labels {
                *place = to(place);
            }
            if finding.code == Code::InvalidName {
                finding.help = Some(
                    "names are made of that of the joint: shorten it, or name its coordinates and speeds"
                        .to_owned(),
                );
            }
        }
        self.findings.extend(findings);
        for mut section in sections {
            for item in &mut section.items {
                places::relocate(item, &to);
            }
            section.span = joints.clone();
            self.append(section);
        }
    }

    fn append(&mut self, made: SectionAst) {
        let mut sections = self.ast.sections.iter_mut();
        match sections.find(|s| s.section.name == made.section.name) {
            Some(section) => section.items.extend(made.items),
            None => self.ast.sections.push(made),
        }
    }

    /// Refuses too many items, and a spec without coordinates.
    fn count(&mut self, joints: &Span) {
        for section in &self.ast.sections {
            let is_made = self
                .made
                .iter()
                .any(|(_, made)| made.iter().any(|one| one.section == section.section.name));
            if is_made && section.items.len() > MAX_ITEMS {
                let message = format!(
                    "`[{}]` has at most {MAX_ITEMS} items, those of joints included",
                    section.section.name
                );
                let count = format!("{} items", section.items.len());
                self.findings.push(
                    Diagnostic::error(Code::LimitExceeded, message).at(joints.clone(), count),
                );
            }
        }
        if self.ast.items("coordinates").is_empty() && !self.ast.broken {
            let message = "no joint has a coordinate, and the section `[coordinates]` is missing";
            self.findings.push(
                Diagnostic::error(Code::MissingSection, message)
                    .at(joints.clone(), "")
                    .help("a mechanism has a joint that moves, or coordinates of its own"),
            );
        }
    }
}
