//! Reads a skeleton file, section by section.

use appell_spec::expr::Span;
use appell_spec::{Code, did_you_mean, shown, units};
use toml::de::DeTable;

use super::super::anthropometry::{Anthropometry, TABLES};
use super::{
    Channel, ChannelKind, Column, Columns, Frame, KEYS, MOST_NAMES, Place, Point, Rider, Segment,
    Skeleton,
};
use crate::fields::{Fields, Value};

/// Reads section by section and collects the mistakes of all of them.
pub(super) struct Reader<'r, 't> {
    fields: &'r mut Fields<'t>,
    bodies: Vec<String>,
    points: Vec<Point>,
    centre: String,
}

impl<'r, 't> Reader<'r, 't> {
    pub(super) fn new(fields: &'r mut Fields<'t>) -> Self {
        Self {
            fields,
            points: Vec::new(),
            bodies: Vec::new(),
            centre: String::new(),
        }
    }

    pub(super) fn skeleton(&mut self, table: &DeTable<'_>) -> Option<Skeleton> {
        self.fields.only(table, KEYS);
        let description = self.fields.string(table, "description");
        let mechanism = self.required_text(table, "mechanism", "name the model, such as \"euc\"");
        let columns = self.columns(table);
        self.bodies(table);
        self.points(table);
        let rider = self.rider(table);
        let frame = self.frame(table);
        let channels = self.channels(table);
        Some(Skeleton {
            description: description.map_or_else(String::new, |(text, _)| text),
            mechanism: mechanism?.0,
            columns: columns?,
            rider: rider?,
            frame: frame?,
            channels: channels?,
            bodies: std::mem::take(&mut self.bodies),
            points: std::mem::take(&mut self.points),
        })
    }

    fn required_text(
        &mut self,
        table: &DeTable<'_>,
        key: &str,
        help: &str,
    ) -> Option<(String, Span)> {
        if table.get(key).is_none() {
            self.fields.missing(key, 0..0, help);
        }
        self.fields.string(table, key)
    }

    fn columns(&mut self, table: &DeTable<'_>) -> Option<Columns> {
        let help = "write position and angles, three columns each, and their units";
        let table = self.fields.needed_section(table, "columns", help)?;
        let keys = ["position", "angles", "length", "angle"];
        self.fields.only(table, &keys);
        let length = self.scale(table, "length", "m")?;
        let angle = self.scale(table, "angle", "rad")?;
        let position = self.patterns(table, "position", length);
        let angles = self.patterns(table, "angles", angle);
        Some(Columns {
            position: position?,
            angles: angles?,
        })
    }

    /// One of a unit in SI.
    fn scale(&mut self, table: &DeTable<'_>, key: &str, si: &str) -> Option<f64> {
        let help = format!("write {key} = \"{si}\"");
        let (text, at) = self.required_text(table, key, &help)?;
        let wanted = units::parse(si).ok()?;
        match units::parse(&text) {
            Ok(unit) if unit.dimension == wanted.dimension => Some(unit.scale),
            _ => {
                let message = format!(
                    "`{}` is not a unit with the dimension of {si}",
                    shown(&text)
                );
                self.fields.tell(Code::UnitMismatch, message, at, &help);
                None
            }
        }
    }

    fn patterns(&mut self, table: &DeTable<'_>, key: &str, scale: f64) -> Option<[Column; 3]> {
        let texts = self.fields.strings(table, key);
        let place = table.get(key).map_or(0..0, toml::Spanned::span);
        let columns = texts.into_iter().map(|(text, at)| {
            let (name, sign) = match text.strip_prefix('-') {
                Some(rest) => (rest.to_owned(), -1.0),
                None => (text, 1.0),
            };
            if !name.contains("{}") {
                let message = format!("`{}` leaves no place for the name of a body", shown(&name));
                let help = "write {} where the name stands, such as \"{}.X\"";
                self.fields.tell(Code::NotAllowedHere, message, at, help);
            }
            Column {
                pattern: name,
                scale: sign * scale,
            }
        });
        let columns: Vec<Column> = columns.collect();
        let found = columns.len();
        let three = <[Column; 3]>::try_from(columns).ok();
        if three.is_none() {
            let message = format!("`{key}` has {found} columns, three are needed");
            self.fields.tell(Code::WrongType, message, place, "");
        }
        three
    }

    fn bodies(&mut self, table: &DeTable<'_>) {
        let help = "name each rigid body, such as E = \"top of the vehicle\"";
        let Some(table) = self.fields.needed_section(table, "bodies", help) else {
            return;
        };
        for (name, _) in in_order(table) {
            self.fields.string(table, &name);
            if self.bodies.len() == MOST_NAMES {
                let message = format!("a skeleton has at most {MOST_NAMES} bodies");
                self.fields.tell(Code::LimitExceeded, message, 0..0, "");
                return;
            }
            self.points.push(Point {
                name: name.clone(),
                body: self.bodies.len(),
                offset: [0.0; 3],
            });
            self.bodies.push(name);
        }
    }

    fn points(&mut self, table: &DeTable<'_>) {
        let Some(table) = self.fields.section(table, "points") else {
            return;
        };
        for (name, value) in in_order(table) {
            if let Some(point) = self.point(&name, value) {
                if self.points.iter().any(|other| other.name == point.name) {
                    let message = format!("`{}` is a body and a point", shown(&name));
                    let at = value.span();
                    self.fields
                        .tell(Code::DuplicateName, message, at, "rename one of them");
                } else if self.points.len() < 2 * MOST_NAMES {
                    self.points.push(point);
                }
            }
        }
    }

    fn point(&mut self, name: &str, value: &Value<'_>) -> Option<Point> {
        let wanted = "a table such as { body = \"E\", offset = [0, 0, -0.45], unit = \"m\" }";
        let table = self.fields.table(value, wanted)?;
        self.fields.only(table, &["body", "offset", "unit"]);
        let body = self.fields.string(table, "body");
        let (body, at) = self.present(body, "body", value)?;
        let body = self.body(&body, at)?;
        let scale = self.scale(table, "unit", "m")?;
        let offset = table.get("offset");
        let offset = self.present(offset, "offset", value)?;
        let numbers = offset.get_ref().as_array();
        let numbers = numbers.map(|list| list.iter().map(|n| self.fields.number(n)).collect());
        let numbers: Option<Vec<f64>> = numbers.flatten();
        let Some(Ok(offset)) = numbers.map(<[f64; 3]>::try_from) else {
            self.fields.wrong_type(offset, "three numbers");
            return None;
        };
        Some(Point {
            name: name.to_owned(),
            body,
            offset: offset.map(|component| component * scale),
        })
    }

    fn rider(&mut self, table: &DeTable<'_>) -> Option<Rider> {
        let help = "write mass, table and the name of the centre of mass";
        let rider = self.fields.needed_section(table, "rider", help)?;
        self.fields.only(rider, &["mass", "table", "name"]);
        let (centre, at) = self.required_text(rider, "name", "write name = \"G\"")?;
        if self.points.iter().any(|point| point.name == centre) {
            let message = format!("`{}` is a point already", shown(&centre));
            self.fields
                .tell(Code::DuplicateName, message, at, "choose another name");
        }
        self.centre.clone_from(&centre);
        let mass = self.mass(rider);
        let (name, at) = self.required_text(rider, "table", "write table = \"de_leva_men\"")?;
        let names = TABLES.iter().map(|table| table.name);
        let anthropometry = &TABLES[self.named("table", &name, at, names)?];
        let segments = self.segments(table, anthropometry, mass.unwrap_or(1.0))?;
        Some(Rider {
            mass: mass?,
            centre,
            table: anthropometry,
            segments,
        })
    }

    fn mass(&mut self, rider: &DeTable<'_>) -> Option<f64> {
        let help = "write mass = { value = 65, unit = \"kg\" }";
        let Some(value) = rider.get("mass") else {
            self.fields.missing("mass", 0..0, help);
            return None;
        };
        let table = self
            .fields
            .table(value, "a table such as { value = 65, unit = \"kg\" }")?;
        self.fields.only(table, &["value", "unit"]);
        let scale = self.scale(table, "unit", "kg")?;
        let number = table.get("value");
        let number = self.present(number, "value", value)?;
        let mass = self.fields.number(number)? * scale;
        if mass <= 0.0 {
            let message = "a mass is positive";
            self.fields
                .tell(Code::ValueOutsideLimits, message, number.span(), "");
            return None;
        }
        Some(mass)
    }

    /// The segments, their masses scaled to the mass of the body.
    fn segments(
        &mut self,
        table: &DeTable<'_>,
        anthropometry: &'static Anthropometry,
        mass: f64,
    ) -> Option<Vec<Segment>> {
        let help =
            "write a line for each segment, such as { part = \"head\", from = \"H\", to = \"N\" }";
        let table = self.fields.needed_section(table, "segments", help)?;
        let mut segments = Vec::new();
        for (name, value) in in_order(table) {
            segments.extend(self.segment(&name, value, anthropometry));
        }
        let whole: f64 = segments.iter().map(|segment: &Segment| segment.mass).sum();
        if whole <= 0.0 {
            let message = "the rider has no segment with a mass";
            self.fields.tell(Code::MissingKey, message, 0..0, help);
            return None;
        }
        // The mass of segments that are not captured, such as feet, is distributed.
        for segment in &mut segments {
            segment.mass *= mass / whole;
        }
        Some(segments)
    }

    fn segment(
        &mut self,
        name: &str,
        value: &Value<'_>,
        anthropometry: &'static Anthropometry,
    ) -> Option<Segment> {
        let wanted = "a table such as { part = \"forearm\", from = \"UAR\", to = \"LAR\" }";
        let table = self.fields.table(value, wanted)?;
        self.fields.only(table, &["part", "from", "to"]);
        let part = self.fields.string(table, "part");
        let (part, at) = self.present(part, "part", value)?;
        let parts = anthropometry.parts.iter().map(|part| part.name);
        let row = &anthropometry.parts[self.named("part", &part, at, parts)?];
        let from = self.end(table, "from", value);
        let to = self.end(table, "to", value);
        Some(Segment {
            name: name.to_owned(),
            mass: row.mass,
            centre: row.centre,
            ends: [from?, to?],
        })
    }

    /// The end of a segment: a point, or several whose middle it is.
    fn end(&mut self, table: &DeTable<'_>, key: &str, whole: &Value<'_>) -> Option<Vec<usize>> {
        let value = table.get(key);
        let value = self.present(value, key, whole)?;
        let names = if value.get_ref().is_array() {
            self.fields.strings(table, key)
        } else {
            self.fields.string(table, key).into_iter().collect()
        };
        if names.is_empty() {
            self.fields
                .wrong_type(value, "a point, or a list of points");
            return None;
        }
        names
            .into_iter()
            .map(|(name, at)| self.point_named(&name, at))
            .collect()
    }

    fn frame(&mut self, table: &DeTable<'_>) -> Option<Frame> {
        let help = "write body and origin of the frame that moves with the vehicle";
        let table = self.fields.needed_section(table, "frame", help)?;
        self.fields.only(table, &["body", "origin"]);
        let body = self.required_text(table, "body", "write body = \"E\"");
        let origin = self.required_text(table, "origin", "write origin = \"C\"");
        let body = body.and_then(|(name, at)| self.body(&name, at));
        let origin = origin.and_then(|(name, at)| self.point_named(&name, at));
        Some(Frame {
            body: body?,
            origin: origin?,
        })
    }

    fn channels(&mut self, table: &DeTable<'_>) -> Option<Vec<Channel>> {
        let help = "write a line for each coordinate of the model, such as x = { path = \"C\" }";
        let table = self.fields.needed_section(table, "channels", help)?;
        let mut channels = Vec::new();
        for (name, value) in in_order(table) {
            let kind = self.channel(value);
            channels.extend(kind.map(|kind| Channel { name, kind }));
        }
        Some(channels)
    }

    fn channel(&mut self, value: &Value<'_>) -> Option<ChannelKind> {
        let wanted = "one of { path = \"C\" }, { pitch_of = \"E\" }, { lean = [\"C\", \"G\"] }";
        let table = self.fields.table(value, wanted)?;
        self.fields.only(table, &["path", "pitch_of", "lean"]);
        if table.len() != 1 {
            self.fields.wrong_type(value, wanted);
            return None;
        }
        if let Some((name, at)) = self.fields.string(table, "path") {
            return self.place(&name, at).map(ChannelKind::Path);
        }
        if table.get("lean").is_some() {
            let names = self.fields.strings(table, "lean");
            let places: Option<Vec<Place>> = names
                .into_iter()
                .map(|(name, at)| self.place(&name, at))
                .collect();
            let Ok(ends) = <[Place; 2]>::try_from(places?) else {
                self.fields
                    .wrong_type(value, "two points, such as [\"C\", \"G\"]");
                return None;
            };
            return Some(ChannelKind::Lean(ends));
        }
        let (name, at) = self.fields.string(table, "pitch_of")?;
        self.body(&name, at).map(ChannelKind::Pitch)
    }

    /// A value that has to be there.
    fn present<T>(&mut self, value: Option<T>, key: &str, whole: &Value<'_>) -> Option<T> {
        // A value of the wrong type has been reported already.
        let stands = whole
            .get_ref()
            .as_table()
            .is_some_and(|table| table.contains_key(key));
        if value.is_none() && !stands {
            self.fields.missing(key, whole.span(), "");
        }
        value
    }

    fn body(&mut self, name: &str, at: Span) -> Option<usize> {
        let bodies = self.bodies.clone();
        self.named("body", name, at, bodies.iter().map(String::as_str))
    }

    fn point_named(&mut self, name: &str, at: Span) -> Option<usize> {
        let points: Vec<String> = self.points.iter().map(|p| p.name.clone()).collect();
        self.named("point", name, at, points.iter().map(String::as_str))
    }

    fn place(&mut self, name: &str, at: Span) -> Option<Place> {
        if name == self.centre {
            return Some(Place::Centre);
        }
        self.point_named(name, at).map(Place::Point)
    }

    /// The place of a name among those that are known; other names are reported.
    fn named<'n>(
        &mut self,
        what: &str,
        name: &str,
        at: Span,
        mut known: impl Iterator<Item = &'n str> + Clone,
    ) -> Option<usize> {
        let all = known.clone();
        let found = known.position(|own| own == name);
        if found.is_none() {
            let help = did_you_mean(name, all.clone(), || {
                let list: Vec<&str> = all.collect();
                format!("there are {}", list.join(", "))
            });
            let message = format!("there is no {what} `{}`", shown(name));
            self.fields.tell(Code::UnknownReference, message, at, &help);
        }
        found
    }
}

/// Keys and values in the order of the file.
fn in_order<'a, 'd>(table: &'a DeTable<'d>) -> Vec<(String, &'a Value<'d>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    let entries = entries.into_iter();
    entries
        .map(|(key, value)| (key.get_ref().as_ref().to_owned(), value))
        .collect()
}
