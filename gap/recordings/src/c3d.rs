//! C3D, the format of motion capture laboratories: points in space and analog channels, frame by frame
//! (*The C3D File Format*, Motion Lab Systems).
//!
//! ```text
//! block 1            header: how many points, samples and frames; where the parameters and the data stand
//! parameters         groups of named values: labels, scales, offsets
//! data, each frame   x, y, z and a word of validity for each point; samples of the analog channels
//! ```
//!
//! Columns are called `label.X`, `label.Y`, `label.Z` and by the labels of the analog channels, of which
//! the first sample of each frame counts; `t` is in s from the first frame on. Lengths are as the file has
//! them, mostly in mm. A point that no camera saw is missing.

use std::path::Path;

use crate::DataError;
use crate::limits::MAX_BYTES;
use crate::table::{Columns, OwnClock, Wanted, too_many};
use crate::time::TIME;

/// Bytes of a block.
const BLOCK: usize = 512;
/// The second byte of every file.
const KEY: u8 = 0x50;
/// A group of parameters and the names of one of them.
type Name = (&'static str, &'static str);

/// Reads a file; `budget` is the most numbers of all columns together.
pub(crate) fn read(path: &Path, wanted: Wanted<'_>, budget: usize) -> Result<Columns, DataError> {
    let bytes = appell_files::read(path, MAX_BYTES)?;
    let place = path.to_string_lossy();
    let file = File::of(&bytes).ok_or_else(|| {
        let message = "this is no C3D file, or it is cut off in its header or parameters";
        DataError::whole(&*place, message)
    })?;
    file.columns(wanted, budget)
        .ok_or_else(|| too_many(place.into_owned()))
}

/// How numbers are written.
#[derive(Clone, Copy)]
enum Processor {
    /// Little endian.
    Intel,
    /// The same with 16-bit words of a number exchanged, and four times the value.
    Dec,
    /// Big endian.
    Mips,
}

impl Processor {
    fn of(byte: u8) -> Option<Self> {
        match byte {
            84 => Some(Self::Intel),
            85 => Some(Self::Dec),
            86 => Some(Self::Mips),
            _ => None,
        }
    }

    fn word(self, bytes: &[u8], at: usize) -> Option<u16> {
        let two = bytes.get(at..at.checked_add(2)?)?.try_into().ok()?;
        Some(match self {
            Self::Intel | Self::Dec => u16::from_le_bytes(two),
            Self::Mips => u16::from_be_bytes(two),
        })
    }

    fn float(self, bytes: &[u8], at: usize) -> Option<f64> {
        let [a, b, c, d] = bytes.get(at..at.checked_add(4)?)?.try_into().ok()?;
        Some(f64::from(match self {
            Self::Intel => f32::from_le_bytes([a, b, c, d]),
            Self::Dec => 0.25 * f32::from_le_bytes([c, d, a, b]),
            Self::Mips => f32::from_be_bytes([a, b, c, d]),
        }))
    }
}

/// A parameter: its place, and its size as a table.
struct Parameter {
    group: i8,
    name: String,
    /// Bytes of an entry; −1 for letters.
    kind: i8,
    sizes: Vec<usize>,
    at: usize,
}

/// A file with its header and parameters.
struct File<'b> {
    bytes: &'b [u8],
    processor: Processor,
    points: usize,
    /// Analog samples of a frame and how many of each channel.
    samples: usize,
    of_each: usize,
    frames: usize,
    /// Frames per second.
    rate: f64,
    /// Scale of the points; negative where they are written as floating point numbers.
    scale: f64,
    data: usize,
    groups: Vec<(i8, String)>,
    parameters: Vec<Parameter>,
}

impl<'b> File<'b> {
    fn of(bytes: &'b [u8]) -> Option<Self> {
        if bytes.len() < BLOCK || bytes[1] != KEY {
            return None;
        }
        let section = BLOCK * usize::from(bytes[0]).checked_sub(1)?;
        let processor = Processor::of(*bytes.get(section + 3)?)?;
        let word = |at| processor.word(bytes, at).map(usize::from);
        let (first, last) = (word(6)?, word(8)?);
        let rate = processor.float(bytes, 20)?;
        let mut file = Self {
            bytes,
            processor,
            points: word(2)?,
            samples: word(4)?,
            of_each: word(18)?,
            frames: (last + 1).checked_sub(first)?,
            rate,
            scale: processor.float(bytes, 12)?,
            data: BLOCK * word(16)?.checked_sub(1)?,
            groups: Vec::new(),
            parameters: Vec::new(),
        };
        file.section(section + 4)?;
        // 16 bits do not count all frames.
        if last == usize::from(u16::MAX) {
            file.frames = usize::MAX;
        }
        let whole = bytes.len().saturating_sub(file.data) / file.frame_len().max(1);
        file.frames = file.frames.min(whole);
        (rate.is_finite() && rate > 0.0 && file.scale.is_finite()).then_some(file)
    }

    /// Reads the groups and parameters that begin at an offset.
    fn section(&mut self, mut at: usize) -> Option<()> {
        let bytes = self.bytes;
        let signed = |at: usize| bytes.get(at).map(|byte| byte.cast_signed());
        loop {
            let length = usize::from(signed(at)?.unsigned_abs());
            if length == 0 {
                return Some(());
            }
            let id = signed(at + 1)?;
            let name = bytes.get(at + 2..at + 2 + length)?;
            let name = String::from_utf8_lossy(name).trim().to_uppercase();
            let link = at + 2 + length;
            let next = usize::from(self.processor.word(bytes, link)?);
            if id < 0 {
                self.groups.push((id.checked_neg()?, name));
            } else {
                let kind = signed(link + 2)?;
                let dimensions = usize::from(*bytes.get(link + 3)?);
                let sizes = bytes.get(link + 4..link + 4 + dimensions)?;
                self.parameters.push(Parameter {
                    group: id,
                    name,
                    kind,
                    sizes: sizes.iter().map(|&size| usize::from(size)).collect(),
                    at: link + 4 + dimensions,
                });
            }
            if next == 0 {
                return Some(());
            }
            at = link + next;
        }
    }

    fn parameter(&self, (group, name): Name) -> Option<&Parameter> {
        let (id, _) = self.groups.iter().find(|(_, own)| own == group)?;
        let mut own = self.parameters.iter();
        own.find(|parameter| parameter.group == *id && parameter.name == name)
    }

    /// An entry of a parameter of numbers; as many as there are, else the only one.
    fn number(&self, name: Name, index: usize) -> Option<f64> {
        let parameter = self.parameter(name)?;
        let count: usize = parameter.sizes.iter().product();
        if index >= count {
            return None;
        }
        match parameter.kind {
            4 => self.processor.float(self.bytes, parameter.at + 4 * index),
            2 => {
                let word = self.processor.word(self.bytes, parameter.at + 2 * index)?;
                Some(f64::from(word.cast_signed()))
            }
            _ => None,
        }
    }

    /// The labels of a group, which goes on in `LABELS2` and so forth.
    fn labels(&self, group: &'static str) -> Vec<String> {
        let names = ["LABELS", "LABELS2", "LABELS3"];
        let all = names
            .into_iter()
            .filter_map(|name| self.parameter((group, name)));
        all.flat_map(|parameter| {
            let (length, count) = match parameter.sizes[..] {
                [length, count] if parameter.kind == -1 => (length, count),
                _ => (0, 0),
            };
            let label = move |index: usize| {
                let at = parameter.at + index * length;
                let text = self.bytes.get(at..at + length).unwrap_or_default();
                String::from_utf8_lossy(text).trim().to_owned()
            };
            (0..count).map(label)
        })
        .collect()
    }

    fn is_float(&self) -> bool {
        self.scale < 0.0
    }

    /// Bytes of a number.
    fn width(&self) -> usize {
        if self.is_float() { 4 } else { 2 }
    }

    fn frame_len(&self) -> usize {
        (4 * self.points + self.samples) * self.width()
    }

    /// A number of a frame, by its place in the frame.
    fn entry(&self, frame: usize, index: usize) -> f64 {
        let at = self.data + frame * self.frame_len() + index * self.width();
        let number = if self.is_float() {
            self.processor.float(self.bytes, at)
        } else {
            let word = self.processor.word(self.bytes, at);
            word.map(|word| f64::from(word.cast_signed()))
        };
        number.unwrap_or(f64::NAN)
    }

    /// The wanted columns; `None` if they exceed the budget.
    fn columns(&self, wanted: Wanted<'_>, budget: usize) -> Option<Columns> {
        let mut columns = Columns {
            names: vec![TIME.to_owned()],
            values: vec![Vec::new()],
            clock: OwnClock::Column,
        };
        let mut left = budget;
        let mut add = |name: String, value: &dyn Fn(usize) -> f64| {
            let mut values = Vec::new();
            if wanted(&name) {
                left = left.checked_sub(self.frames)?;
                values.extend((0..self.frames).map(value));
            }
            columns.names.push(name);
            columns.values.push(values);
            Some(())
        };
        let named = |labels: &[String], index: usize, what: &str| {
            let own = labels.get(index).filter(|label| !label.is_empty());
            own.cloned()
                .unwrap_or_else(|| format!("{what}{}", index + 1))
        };
        let labels = self.labels("POINT");
        let unit = if self.is_float() { 1.0 } else { self.scale };
        for point in 0..self.points {
            let label = named(&labels, point, "point");
            for (axis, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
                let value = |frame| {
                    let is_seen = self.entry(frame, 4 * point + 3) >= 0.0;
                    let value = unit * self.entry(frame, 4 * point + axis);
                    if is_seen { value } else { f64::NAN }
                };
                add(format!("{label}.{letter}"), &value)?;
            }
        }
        let labels = self.labels("ANALOG");
        let general = self.number(("ANALOG", "GEN_SCALE"), 0).unwrap_or(1.0);
        for channel in 0..self.samples / self.of_each.max(1) {
            let offset = self.number(("ANALOG", "OFFSET"), channel).unwrap_or(0.0);
            let scale = self.number(("ANALOG", "SCALE"), channel).unwrap_or(1.0);
            let value =
                |frame| general * scale * (self.entry(frame, 4 * self.points + channel) - offset);
            add(named(&labels, channel, "analog"), &value)?;
        }
        left.checked_sub(self.frames)?;
        let times = (0..self.frames).map(|frame| frame as f64 / self.rate);
        columns.values[0] = times.collect();
        Some(columns)
    }
}
