//! The expansion of each kind of joint.

use std::collections::BTreeSet;

use crate::ast::{ItemAst, SpecAst, ValueAst};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Span;
use crate::language::JointWord;
use crate::limits::MAX_SENTENCE;

use super::direction::{AXES, Direction, Turn, word};
use super::piece::Piece;
use super::quantities::{self, JointQuantity};
use super::written::Written;

/// The section of joints.
pub(crate) const SECTION: &str = "joints";

/// An item of another section.
#[derive(Debug, Clone)]
pub(super) struct Made {
    /// The section.
    pub(super) section: &'static str,
    /// The name of the item.
    pub(super) name: String,
    /// The source of its name.
    pub(super) at: Span,
    /// The key for another name.
    pub(super) key: Option<&'static str>,
    /// Its table, inline.
    pub(super) table: Piece,
}

/// The names of the frames and points of a spec, those of joints included.
pub(super) struct Known<'a> {
    frames: BTreeSet<&'a str>,
    points: BTreeSet<&'a str>,
}

impl<'a> Known<'a> {
    pub(super) fn new(ast: &'a SpecAst) -> Self {
        let names = |section: &str| -> BTreeSet<&'a str> {
            let own = ast.items(section).iter().chain(ast.items(SECTION));
            own.map(|item| item.name.value.as_str()).collect()
        };
        Self {
            frames: names("frames"),
            points: names("points"),
        }
    }
}

/// The items to which a joint is expanded.
pub(super) fn made(text: &str, item: &ItemAst, known: &Known<'_>) -> Result<Vec<Made>, Diagnostic> {
    let Some(word) = quantities::word(item) else {
        return Ok(Vec::new());
    };
    let mut keys = ["speed", "speeds"].into_iter();
    let named = keys.find_map(|key| item.entry(key));
    if let Some(named) = named.filter(|_| item.flag("dependent")) {
        let name = &item.name.value;
        let message = format!("the joint `{name}` is dependent and names pseudo-velocities");
        return Err(Diagnostic::error(Code::ConflictingKeys, message)
            .at(named.span.clone(), "a dependent joint makes none")
            .help(format!("keep either `dependent` or `{}`", named.key.name)));
    }
    let mut joint = Joint {
        text,
        item,
        word,
        coordinates: quantities::coordinates(item),
        speeds: quantities::speeds(item),
        made: Vec::new(),
    };
    joint.coordinates();
    let axis = Direction::new(text, item, "axis")?;
    let second = Direction::new(text, item, "second_axis")?;
    joint.place(axis.as_ref(), second.as_ref(), known)?;
    joint.speeds();
    Ok(joint.made)
}

struct Joint<'a> {
    text: &'a str,
    item: &'a ItemAst,
    word: JointWord,
    coordinates: Vec<JointQuantity>,
    speeds: Vec<JointQuantity>,
    made: Vec<Made>,
}

/// Keys with their values.
#[derive(Default)]
struct Table(Vec<Piece>);

impl Table {
    fn key(mut self, key: &str, value: &Piece) -> Self {
        self.0.push(Piece::new(format!("{key} = ")).then(value));
        self
    }

    fn maybe(self, key: &str, value: Option<&Piece>) -> Self {
        match value {
            Some(value) => self.key(key, value),
            None => self,
        }
    }

    fn text(self, key: &str, value: &str) -> Self {
        self.key(key, &Piece::new(value).quoted())
    }

    fn piece(&self) -> Piece {
        Piece::joined(&self.0, ", ").within("{ ", " }")
    }
}

impl Joint<'_> {
    fn name(&self) -> &str {
        &self.item.name.value
    }

    fn add(&mut self, section: &'static str, name: &str, table: &Table) {
        let at = self.item.name.span.clone();
        self.made.push(Made {
            section,
            name: name.to_owned(),
            table: table.piece().from(&at),
            at,
            key: None,
        });
    }

    fn add_quantity(
        &mut self,
        section: &'static str,
        key: &'static str,
        quantity: &JointQuantity,
        table: &Table,
    ) {
        let own = || self.item.name.span.clone();
        let at = quantity.written.clone().unwrap_or_else(own);
        self.made.push(Made {
            section,
            name: quantity.name.clone(),
            table: table.piece().from(&at),
            at,
            key: Some(key),
        });
    }

    /// The value of a key as it is written.
    fn verbatim(&self, key: &str) -> Option<Piece> {
        let span = &self.item.entry(key)?.span;
        let letters = self.text.get(span.clone()).unwrap_or_default();
        Some(Piece::copied(letters, span.clone()))
    }

    fn coordinates(&mut self) {
        let all = self.coordinates.clone();
        let key = if all.len() == 1 {
            "coordinate"
        } else {
            "coordinates"
        };
        let initial = self.item.numbers("initial").unwrap_or_default();
        let initial: Vec<Piece> = initial
            .iter()
            .map(|number| {
                let letters = self.text.get(number.span.clone()).unwrap_or_default();
                Piece::copied(letters, number.span.clone())
            })
            .collect();
        for (place, quantity) in all.iter().enumerate() {
            let about = self.about_of(quantity, all.len() == 1);
            let table = Table::default()
                .text("unit", quantity.unit)
                .key("about", &about)
                .maybe("range", self.verbatim("range").as_ref());
            let table = if all.len() == 1 {
                table.maybe("initial", self.verbatim("initial").as_ref())
            } else {
                table.maybe("initial", initial.get(place))
            };
            self.add_quantity("coordinates", key, quantity, &table);
        }
    }

    /// The sentence about a coordinate.
    fn about_of(&self, quantity: &JointQuantity, is_alone: bool) -> Piece {
        let quoted = |sentence: String| toml_edit::Value::from(sentence).to_string();
        let Some(own) = self.item.text("about") else {
            let sentence = format!("{} of joint {}", quantity.about, self.name());
            return Piece::new(quoted(sentence));
        };
        let sentence = format!("{}: {}", own.value, quantity.about);
        let sentence = if is_alone || sentence.len() > MAX_SENTENCE {
            own.value.to_owned()
        } else {
            sentence
        };
        Piece::new(quoted(sentence)).from(&own.span)
    }

    fn speeds(&mut self) {
        let relative = self.relative_angular_velocity();
        let rates: Vec<Piece> = self
            .coordinates
            .iter()
            .map(|q| Piece::new(format!("dot({})", q.name)))
            .collect();
        let values = match self.word {
            JointWord::Ball => relative,
            JointWord::Free => rates.into_iter().take(3).chain(relative).collect(),
            _ => rates,
        };
        let all = self.speeds.clone();
        let key = if all.len() == 1 { "speed" } else { "speeds" };
        for (quantity, value) in all.iter().zip(values) {
            let table = Table::default()
                .key("value", &value.quoted())
                .text("unit", quantity.unit);
            self.add_quantity("pseudo_velocities", key, quantity, &table);
        }
    }

    /// Components of the angular velocity relative to the parent, in the frame of the joint.
    fn relative_angular_velocity(&self) -> Vec<Piece> {
        let own = self.name();
        let parent = self.item.text("parent").map(|parent| parent.value);
        let parent = parent.filter(|parent| *parent != "ground");
        let component = |axis: &str| {
            let of = |frame: &str| format!("angular_velocity({frame}, {axis}, {own})");
            let value = match parent {
                Some(parent) => format!("{} - {}", of(own), of(parent)),
                None => of(own),
            };
            Piece::new(value)
        };
        AXES.map(component).into()
    }

    /// A coordinate in an expression.
    fn coordinate(&self, place: usize) -> Written {
        let Some(quantity) = self.coordinates.get(place) else {
            return Written::zero();
        };
        let at = quantity.written.as_ref().unwrap_or(&self.item.name.span);
        Written::made(Piece::new(quantity.name.as_str()).from(at), true)
    }

    /// An expression of the joint.
    fn expression(&self, key: &str) -> Option<Written> {
        let expression = self.item.expression(key)?;
        Some(Written::new(self.text, expression))
    }

    /// A coordinate plus the offset of the joint.
    fn with_offset(&self, place: usize) -> Written {
        let offset = self.expression("offset").unwrap_or_else(Written::zero);
        offset.plus(&self.coordinate(place))
    }

    /// The frame and the point.
    fn place(
        &mut self,
        axis: Option<&Direction>,
        second: Option<&Direction>,
        known: &Known<'_>,
    ) -> Result<(), Diagnostic> {
        let name = self.name().to_owned();
        let mut parent = self
            .verbatim("parent")
            .unwrap_or_else(|| Piece::new("ground").quoted());
        let from = self.from(known)?;
        let carrier = parent.clone();
        let mut turns = self.constant_turns();
        // With constant rotations, a planar joint moves in an intermediate frame.
        if self.word == JointWord::Planar && !turns.is_empty() {
            let mount = format!("mount_{name}");
            let table = self.frame(&parent, &std::mem::take(&mut turns));
            self.add("frames", &mount, &table);
            parent = Piece::new(mount).quoted();
        }
        let is_turned = !turns.is_empty();
        turns.extend(self.moving_turns(axis, second));
        let table = match self.word {
            JointWord::Ball | JointWord::Free => self.quaternion(&parent),
            _ => self.frame(&parent, &turns),
        };
        let table = table.maybe("about", self.verbatim("about").as_ref());
        self.add("frames", &name, &table);
        // The axis has the same components before and after a rotation about it.
        let moving = if is_turned {
            Piece::new(name.as_str()).quoted()
        } else {
            parent
        };
        self.point(&name, &from, &carrier, &moving, axis);
        Ok(())
    }

    /// The point: displaced from its position in the parent.
    fn point(
        &mut self,
        name: &str,
        from: &Piece,
        carrier: &Piece,
        moving: &Piece,
        axis: Option<&Direction>,
    ) {
        let at = self.at();
        let point = |from: &Piece, frame: &Piece, at: &[Written; 3]| {
            let values: Vec<Piece> = at.each_ref().map(Written::value).into();
            let at = Piece::joined(&values, ", ").within("[", "]");
            let at = match self.item.entry("at") {
                Some(entry) => at.from(&entry.span),
                None => at,
            };
            Table::default()
                .key("from", from)
                .key("in", frame)
                .key("at", &at)
        };
        let is_there = at.iter().all(Written::is_zero);
        let moves = !matches!(
            self.word,
            JointWord::Revolute | JointWord::Universal | JointWord::Ball | JointWord::Fixed
        );
        if !moves {
            let table = point(from, carrier, &at);
            self.add("points", name, &table);
        } else if is_there || carrier.text == moving.text {
            let frame = if is_there { moving } else { carrier };
            let table = point(from, frame, &self.moved(&at, axis));
            self.add("points", name, &table);
        } else {
            let guide = format!("guide_{name}");
            let (fixed, origin) = (
                point(from, carrier, &at),
                Piece::new(guide.as_str()).quoted(),
            );
            let nowhere = [(); 3].map(|()| Written::zero());
            let table = point(&origin, moving, &self.moved(&nowhere, axis));
            self.add("points", &guide, &fixed);
            self.add("points", name, &table);
        }
    }

    /// A position, displaced by the coordinates.
    fn moved(&self, at: &[Written; 3], axis: Option<&Direction>) -> [Written; 3] {
        let mut moved = at.clone();
        match (self.word, axis) {
            (JointWord::Free, _) => {
                for (place, component) in moved.iter_mut().enumerate() {
                    *component = component.plus(&self.coordinate(place));
                }
                moved
            }
            (JointWord::Planar, _) => {
                for (place, along) in quantities::plane(self.item).into_iter().enumerate() {
                    moved[along] = moved[along].plus(&self.coordinate(place));
                }
                moved
            }
            (JointWord::Prismatic, Some(axis)) => axis.moved(at, &self.with_offset(0)),
            (JointWord::Cylindrical, Some(axis)) => axis.moved(at, &self.coordinate(1)),
            (JointWord::Screw, Some(axis)) => {
                let pitch = self.expression("pitch").unwrap_or_else(Written::zero);
                let turned = self.coordinate(0).piece;
                let way = pitch.factor().word("*").then(&turned).word("/(2*pi)");
                axis.moved(at, &Written::made(way, false))
            }
            _ => moved,
        }
    }

    /// The rotations by the coordinates.
    fn moving_turns(&self, axis: Option<&Direction>, second: Option<&Direction>) -> Vec<Turn> {
        let about = |axis: Option<&Direction>, angle: &Written| {
            axis.map_or_else(Vec::new, |axis| axis.turns(angle))
        };
        match self.word {
            JointWord::Revolute => about(axis, &self.with_offset(0)),
            JointWord::Cylindrical | JointWord::Screw => about(axis, &self.coordinate(0)),
            JointWord::Planar => about(axis, &self.coordinate(2)),
            JointWord::Universal => {
                let first = about(axis, &self.coordinate(0)).into_iter();
                first.chain(about(second, &self.coordinate(1))).collect()
            }
            JointWord::Prismatic | JointWord::Ball | JointWord::Free | JointWord::Fixed => {
                Vec::new()
            }
        }
    }

    /// The constant rotations before those of the joint.
    fn constant_turns(&self) -> Vec<Turn> {
        let Some(ValueAst::Tables(turns)) = self.item.entry("turns").map(|entry| &entry.value)
        else {
            return Vec::new();
        };
        let turn = |turn: &ItemAst| {
            let axis = &turn.entry("about_axis")?.span;
            let letters = self.text.get(axis.clone()).unwrap_or_default();
            let by = Written::new(self.text, turn.expression("by")?);
            Some((Piece::copied(letters, axis.clone()), by))
        };
        turns.iter().filter_map(turn).collect()
    }

    /// A frame given by rotations.
    fn frame(&self, parent: &Piece, turns: &[Turn]) -> Table {
        let turned =
            |table: Table, (axis, by): &Turn| table.key("about_axis", axis).key("by", &by.value());
        let table = Table::default().key("parent", parent);
        match turns {
            [] => turned(table, &(word(2, false), Written::zero())),
            [one] => turned(table, one),
            several => {
                let tables = several.iter().map(|one| turned(Table::default(), one));
                let tables: Vec<Piece> = tables.map(|table| table.piece()).collect();
                let list = Piece::joined(&tables, ", ").within("[", "]");
                let at = self.item.entry("axis").or_else(|| self.item.entry("turns"));
                let at = at.map_or(&self.item.name.span, |entry| &entry.span);
                table.key("turns", &list.from(at))
            }
        }
    }

    /// A frame given by a quaternion, whose components are the last coordinates.
    fn quaternion(&self, parent: &Piece) -> Table {
        let first = self.coordinates.len().saturating_sub(4);
        let names = (first..self.coordinates.len()).map(|place| self.coordinate(place).piece);
        let names: Vec<Piece> = names.map(|name| name.quoted()).collect();
        let list = Piece::joined(&names, ", ").within("[", "]");
        Table::default()
            .key("parent", parent)
            .key("quaternion", &list)
    }

    fn at(&self) -> [Written; 3] {
        match self.item.components("at") {
            Some(at) => at.each_ref().map(|one| Written::new(self.text, one)),
            None => [(); 3].map(|()| Written::zero()),
        }
    }

    /// The point relative to which the joint is positioned.
    fn from(&self, known: &Known<'_>) -> Result<Piece, Diagnostic> {
        if let Some(from) = self.verbatim("from") {
            return Ok(from);
        }
        let origin = Piece::new("O").quoted();
        let Some(parent) = self.item.text("parent") else {
            return Ok(origin);
        };
        if known.points.contains(parent.value) {
            return Ok(Piece::new(parent.value).quoted().from(&parent.span));
        }
        if parent.value == "ground" || !known.frames.contains(parent.value) {
            return Ok(origin);
        }
        let message = format!("the joint `{}` has no `from`", self.name());
        Err(Diagnostic::error(Code::MissingKey, message)
            .at(self.item.name.span.clone(), "`from` is missing")
            .at(parent.span.clone(), "no point has this name")
            .help("name the point from which the joint is placed"))
    }
}
