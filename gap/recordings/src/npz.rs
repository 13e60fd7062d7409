//! Archives of `numpy`: a zip of arrays, each a file `NAME.npy` (NEP 1: a header in the notation of Python, then the
//! numbers).
//!
//! An array of one dimension is a column of its name, one of two dimensions the columns `name[0]`, `name[1]` …. Other
//! arrays, of text or objects, are ignored.

use std::io::{BufReader, Read};
use std::path::Path;

use zip::ZipArchive;

use crate::DataError;
use crate::limits::MAX_BYTES;
use crate::table::{Columns, OwnClock, Wanted, too_many};

/// Largest number of arrays.
const MOST_ARRAYS: usize = 4096;
/// Largest number of columns of an array.
const MOST_COLUMNS: usize = 4096;
/// Longest header of an array, in bytes.
const MOST_HEADER: usize = 1 << 16;
/// Numbers that are read at once.
const BATCH: usize = 1 << 12;

/// Reads a file; `budget` is the most numbers of all columns together.
pub(crate) fn read(path: &Path, wanted: Wanted<'_>, budget: usize) -> Result<Columns, DataError> {
    let place = path.to_string_lossy();
    let whole = |message: String| DataError::whole(&*place, message);
    let file = BufReader::new(appell_files::open(path, MAX_BYTES)?);
    let mut archive = ZipArchive::new(file).map_err(|error| {
        whole(format!(
            "this is no NumPy archive, or it is damaged: {error}"
        ))
    })?;
    if archive.len() > MOST_ARRAYS {
        return Err(whole(format!(
            "the archive has more than {MOST_ARRAYS} arrays"
        )));
    }
    let mut columns = Columns {
        names: Vec::new(),
        values: Vec::new(),
        clock: OwnClock::None,
    };
    let mut left = budget;
    for index in 0..archive.len() {
        let number = format!("number {}", index + 1);
        let damaged = |name: &str, what: String| whole(format!("the array `{name}` {what}"));
        let mut entry = archive
            .by_index(index)
            .map_err(|error| damaged(&number, format!("cannot be read: {error}")))?;
        let name = entry.name().ok();
        let name = name.and_then(|name| Some(name.strip_suffix(".npy")?.to_owned()));
        let Some(name) = name else { continue };
        let array = numbers(&mut entry, &name, wanted, &mut left);
        let array = array.map_err(|problem| match problem {
            Problem::TooMany => too_many(format!("{place}: {name}")),
            Problem::Damaged(what) => damaged(&name, what),
        })?;
        for (column, values) in array {
            columns.names.push(column);
            columns.values.push(values);
        }
    }
    Ok(columns)
}

/// Names and values of columns.
type Values = Vec<(String, Vec<f64>)>;

enum Problem {
    TooMany,
    Damaged(String),
}

impl From<std::io::Error> for Problem {
    fn from(error: std::io::Error) -> Self {
        Self::Damaged(format!("is truncated or damaged: {error}"))
    }
}

/// The columns of an array, with the values of those that are wanted; none if it is of other things than numbers.
fn numbers(
    from: &mut impl Read,
    name: &str,
    wanted: Wanted<'_>,
    left: &mut usize,
) -> Result<Values, Problem> {
    let header = header(from)?;
    let Some(kind) = Kind::of(field(&header, "descr").unwrap_or_default()) else {
        return Ok(Vec::new());
    };
    let is_fortran = field(&header, "fortran_order") == Some("True");
    let shape = shape(&header)?;
    let (rows, width, is_table) = match shape[..] {
        [rows] => (rows, 1, false),
        [rows, width] => (rows, width, true),
        _ => return Ok(Vec::new()),
    };
    if width > MOST_COLUMNS {
        let what = format!("has {width} columns, and at most {MOST_COLUMNS} are read");
        return Err(Problem::Damaged(what));
    }
    let column = |index: usize| {
        if is_table {
            format!("{name}[{index}]")
        } else {
            name.to_owned()
        }
    };
    let mut values: Values = (0..width)
        .map(|index| (column(index), Vec::new()))
        .collect();
    let is_wanted: Vec<bool> = values.iter().map(|(column, _)| wanted(column)).collect();
    let there = is_wanted.iter().filter(|own| **own).count();
    if there == 0 {
        return Ok(values);
    }
    let count = rows.checked_mul(there).ok_or(Problem::TooMany)?;
    *left = left.checked_sub(count).ok_or(Problem::TooMany)?;
    let all = rows.checked_mul(width).ok_or(Problem::TooMany)?;
    let mut bytes = vec![0; BATCH * kind.size];
    let mut next = 0;
    while next < all {
        let batch = BATCH.min(all - next);
        let bytes = &mut bytes[..batch * kind.size];
        from.read_exact(bytes)?;
        for cell in bytes.chunks_exact(kind.size) {
            let column = if is_fortran {
                next / rows
            } else {
                next % width
            };
            if is_wanted[column] {
                values[column].1.push(kind.number(cell));
            }
            next += 1;
        }
    }
    Ok(values)
}

/// The text of the header.
fn header(from: &mut impl Read) -> Result<String, Problem> {
    let mut start = [0; 8];
    from.read_exact(&mut start)?;
    if &start[..6] != b"\x93NUMPY" {
        return Err(Problem::Damaged("is not in the format of NumPy".to_owned()));
    }
    let length = if start[6] == 1 {
        let mut length = [0; 2];
        from.read_exact(&mut length)?;
        usize::from(u16::from_le_bytes(length))
    } else {
        let mut length = [0; 4];
        from.read_exact(&mut length)?;
        usize::try_from(u32::from_le_bytes(length)).unwrap_or(usize::MAX)
    };
    if length > MOST_HEADER {
        return Err(Problem::Damaged("has a header without end".to_owned()));
    }
    let mut text = vec![0; length];
    from.read_exact(&mut text)?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}

/// The value of a key in a header such as `{'descr': '<f8', 'fortran_order': False, 'shape': (200, 3), }`.
fn field<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let (_, rest) = header.split_once(&format!("'{key}':"))?;
    let rest = rest.trim_start();
    if let Some(inner) = rest.strip_prefix('(') {
        return inner.split(')').next();
    }
    let value = rest.split([',', '}']).next()?.trim();
    Some(value.trim_matches('\''))
}

fn shape(header: &str) -> Result<Vec<usize>, Problem> {
    let damaged = || Problem::Damaged("has a header that is damaged".to_owned());
    let sizes = field(header, "shape").ok_or_else(damaged)?;
    let sizes = sizes
        .split(',')
        .map(str::trim)
        .filter(|size| !size.is_empty());
    sizes
        .map(|size| size.parse().map_err(|_| damaged()))
        .collect()
}

/// How a number is written.
struct Kind {
    letter: u8,
    size: usize,
    is_big: bool,
}

impl Kind {
    /// `<f8`, `|u1`; `None` for text, objects and complex numbers.
    fn of(text: &str) -> Option<Self> {
        let [order, letter, size] = *text.as_bytes() else {
            return None;
        };
        let size = usize::from(size.checked_sub(b'0')?);
        let is_known = match letter {
            b'f' => matches!(size, 2 | 4 | 8),
            b'i' | b'u' => matches!(size, 1 | 2 | 4 | 8),
            b'b' => size == 1,
            _ => false,
        };
        let is_big = order == b'>';
        is_known.then_some(Self {
            letter,
            size,
            is_big,
        })
    }

    /// The number in bytes of this size.
    fn number(&self, bytes: &[u8]) -> f64 {
        let mut word = [0; 8];
        for (place, byte) in bytes.iter().enumerate() {
            let place = if self.is_big {
                self.size - 1 - place
            } else {
                place
            };
            word[place] = *byte;
        }
        let bits = u64::from_le_bytes(word);
        let low = u32::from_le_bytes([word[0], word[1], word[2], word[3]]);
        match (self.letter, self.size) {
            (b'f', 8) => f64::from_bits(bits),
            (b'f', 4) => f64::from(f32::from_bits(low)),
            (b'f', _) => half(u16::from_le_bytes([word[0], word[1]])),
            (b'i', size) => {
                let above = 64 - 8 * u32::try_from(size).unwrap_or(8);
                ((bits << above).cast_signed() >> above) as f64
            }
            _ => bits as f64,
        }
    }
}

/// A number in half precision (IEEE 754: a sign, five bits of the exponent, ten of the fraction).
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let exponent = i32::from((bits >> 10) & 0x1f);
    let fraction = f64::from(bits & 0x3ff) / 1024.0;
    sign * match exponent {
        0 => fraction * 2f64.powi(-14),
        0x1f if fraction > 0.0 => f64::NAN,
        0x1f => f64::INFINITY,
        _ => (1.0 + fraction) * 2f64.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::half;

    #[test]
    fn half_precision_is_read() {
        for (bits, value) in [(0x3c00, 1.0), (0xc000, -2.0), (0x3555, 0.333_251_953_125)] {
            assert!((half(bits) - value).abs() < 1e-15);
        }
        assert!(half(0x7e00).is_nan());
    }
}
