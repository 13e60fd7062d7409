//! Messages of ROS 2: their definitions, and the numbers in their bytes (OMG, *Common Data
//! Representation*: numbers are aligned to multiples of their own length).

use std::collections::BTreeMap;

use super::names::{LONGEST, NAMES, Names, Tell};

/// Messages inside messages are at most so deep.
const DEEPEST: usize = 16;

/// The message types of a channel by name; the first one has an empty name.
pub(super) struct Definitions {
    types: BTreeMap<String, Vec<Field>>,
}

struct Field {
    name: String,
    kind: Kind,
    count: Count,
}

enum Kind {
    Number(Number),
    /// Bytes of a letter.
    Text(usize),
    Message(String),
}

#[derive(Clone, Copy)]
enum Number {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

/// How many of a field there are.
#[derive(Clone, Copy)]
enum Count {
    One,
    Fixed(usize),
    Any,
}

impl Definitions {
    /// Reads the text of a definition: the message, then those that it contains, each after a line of
    /// `=` and a line `MSG: package/Name`.
    pub(super) fn of(text: &str) -> Self {
        let mut types: BTreeMap<String, Vec<Field>> = BTreeMap::new();
        let mut own = String::new();
        types.insert(own.clone(), Vec::new());
        for line in text.lines() {
            let line = line.split('#').next().unwrap_or_default().trim();
            if let Some(name) = line.strip_prefix("MSG:") {
                name.trim().clone_into(&mut own);
                types.entry(own.clone()).or_default();
            } else if let Some(field) = Field::of(line)
                && let Some(fields) = types.get_mut(&own)
            {
                fields.push(field);
            }
        }
        Self { types }
    }

    /// Passes every number of a message, with its path, to `tell`; `None` if the bytes do not fit the
    /// definitions.
    pub(super) fn read(&self, bytes: &[u8], topic: &str, tell: Tell<'_>) -> Option<()> {
        // The encapsulation header has four bytes; the second one gives the byte order.
        let (head, body) = bytes.split_at_checked(4)?;
        let mut reader = Reader {
            definitions: self,
            bytes: body,
            at: 0,
            little: head[1] & 1 == 1,
            elements: body.len(),
            names: Names::of(topic, tell),
            joints: Vec::new(),
        };
        reader.message("", 0)
    }

    fn fields(&self, name: &str) -> Option<&[Field]> {
        let exact = self.types.get(name);
        let found = exact.or_else(|| {
            let own = name.rsplit('/').next()?;
            let mut types = self.types.iter();
            let is_own = |full: &str| full.rsplit('/').next() == Some(own);
            types
                .find(|(full, _)| is_own(full))
                .map(|(_, fields)| fields)
        });
        found.map(Vec::as_slice)
    }
}

impl Field {
    /// `float64[3] position`; `None` for constants, separators of messages and other lines.
    fn of(line: &str) -> Option<Self> {
        let (kind, rest) = line.split_once(char::is_whitespace)?;
        let name = rest.split_whitespace().next()?;
        if rest.contains('=') && !rest.contains('"') || kind.starts_with('=') {
            return None;
        }
        let (kind, count) = match kind.strip_suffix(']').and_then(|kind| kind.split_once('[')) {
            Some((kind, "")) => (kind, Count::Any),
            Some((kind, most)) if most.starts_with("<=") => (kind, Count::Any),
            Some((kind, count)) => (kind, Count::Fixed(count.parse().ok()?)),
            None => (kind, Count::One),
        };
        let kind = match kind.split("<=").next().unwrap_or(kind) {
            "bool" | "byte" | "char" | "uint8" => Kind::Number(Number::Unsigned(1)),
            "uint16" => Kind::Number(Number::Unsigned(2)),
            "uint32" => Kind::Number(Number::Unsigned(4)),
            "uint64" => Kind::Number(Number::Unsigned(8)),
            "int8" => Kind::Number(Number::Signed(1)),
            "int16" => Kind::Number(Number::Signed(2)),
            "int32" => Kind::Number(Number::Signed(4)),
            "int64" => Kind::Number(Number::Signed(8)),
            "float32" => Kind::Number(Number::Float(4)),
            "float64" => Kind::Number(Number::Float(8)),
            "string" => Kind::Text(1),
            "wstring" => Kind::Text(2),
            other => Kind::Message(other.to_owned()),
        };
        Some(Self {
            name: name.to_owned(),
            kind,
            count,
        })
    }
}

struct Reader<'a> {
    definitions: &'a Definitions,
    bytes: &'a [u8],
    at: usize,
    little: bool,
    /// Elements of lists that may still come: each has at least a byte.
    elements: usize,
    names: Names<'a>,
    /// The names of joints: of the message, or of one that contains it.
    joints: Vec<String>,
}

impl<'a> Reader<'a> {
    fn message(&mut self, name: &str, depth: usize) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        let definitions: &'a Definitions = self.definitions;
        let here = self.names.place();
        let outer = self.joints.clone();
        for field in definitions.fields(name)? {
            self.names.field(&field.name);
            match field.count {
                Count::One => self.value(&field.kind, depth)?,
                Count::Fixed(_) | Count::Any => {
                    let count = match field.count {
                        Count::Fixed(count) => count,
                        _ => self.length()?,
                    };
                    self.elements = self.elements.checked_sub(count)?;
                    if matches!(field.kind, Kind::Text(1)) && NAMES.contains(&&*field.name) {
                        self.joints = (0..count).map(|_| self.text()).collect::<Option<_>>()?;
                    } else {
                        self.list(&field.kind, count, depth)?;
                    }
                }
            }
            self.names.back(here);
        }
        self.joints = outer;
        Some(())
    }

    /// The elements of a list, by their numbers and, where there are as many, by the names of joints.
    fn list(&mut self, kind: &Kind, count: usize, depth: usize) -> Option<()> {
        let here = self.names.place();
        for index in 0..count {
            self.names.element(index, count, &self.joints);
            self.value(kind, depth)?;
            self.names.back(here);
        }
        Some(())
    }

    fn value(&mut self, kind: &Kind, depth: usize) -> Option<()> {
        match kind {
            Kind::Number(number) => {
                let value = self.number(*number)?;
                self.names.tell(value);
            }
            Kind::Text(width) => {
                let length = self.length()?.checked_mul(*width)?;
                self.skip(length)?;
            }
            Kind::Message(name) => self.message(name, depth + 1)?,
        }
        Some(())
    }

    /// A text, without the zero at its end.
    fn text(&mut self) -> Option<String> {
        let length = self.length()?;
        let bytes = self.bytes.get(self.at..self.at.checked_add(length)?)?;
        self.at += length;
        let text = String::from_utf8_lossy(bytes);
        let text = text.trim_end_matches('\0');
        Some(text.chars().take(LONGEST).collect())
    }

    fn length(&mut self) -> Option<usize> {
        let bytes = self.take(4)?;
        usize::try_from(bytes).ok()
    }

    #[allow(
        clippy::cast_possible_truncation,
        reason = "the upper bytes are those of other numbers"
    )]
    fn number(&mut self, number: Number) -> Option<f64> {
        Some(match number {
            Number::Unsigned(width) => self.take(width)? as f64,
            Number::Signed(width) => {
                let above = 64 - 8 * u32::try_from(width).ok()?;
                let bits = self.take(width)? << above;
                (bits.cast_signed() >> above) as f64
            }
            Number::Float(4) => f64::from(f32::from_bits(self.take(4)? as u32)),
            Number::Float(_) => f64::from_bits(self.take(8)?),
        })
    }

    /// The bits of a number of a given length in bytes, at the next multiple of that length.
    fn take(&mut self, width: usize) -> Option<u64> {
        let start = self.at.next_multiple_of(width);
        let bytes = self.bytes.get(start..start + width)?;
        self.at = start + width;
        let join = |bits: u64, byte: &u8| (bits << 8) | u64::from(*byte);
        Some(if self.little {
            bytes.iter().rev().fold(0, join)
        } else {
            bytes.iter().fold(0, join)
        })
    }

    fn skip(&mut self, length: usize) -> Option<()> {
        let end = self.at.checked_add(length)?;
        (end <= self.bytes.len()).then(|| self.at = end)
    }
}
