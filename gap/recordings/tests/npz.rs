//! Runs are read from archives of `numpy`.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::io::{Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::common::{Folder, pendulum};

const ROWS: usize = 200;

fn time(row: usize) -> f64 {
    0.01 * row as f64
}

fn angle(row: usize) -> f64 {
    0.5 * (3.0 * time(row)).sin()
}

/// The bytes of an array.
fn array(descr: &str, is_fortran: bool, shape: &str, numbers: &[u8]) -> Vec<u8> {
    let order = if is_fortran { "True" } else { "False" };
    let mut header =
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    while !(header.len() + 11).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let length = u16::try_from(header.len()).unwrap().to_le_bytes();
    [
        b"\x93NUMPY\x01\x00",
        &length[..],
        header.as_bytes(),
        numbers,
    ]
    .concat()
}

fn doubles(values: impl Iterator<Item = f64>) -> Vec<u8> {
    values.flat_map(f64::to_le_bytes).collect()
}

fn archive(method: CompressionMethod, arrays: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(method);
    for (name, bytes) in arrays {
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// Times in ms, a table of the angle and its negative in the order of Fortran or not, a torque in single precision.
fn arrays(is_fortran: bool) -> Vec<(&'static str, Vec<u8>)> {
    let milliseconds = (0..ROWS).flat_map(|row| (10 * i64::try_from(row).unwrap()).to_be_bytes());
    let q = if is_fortran {
        let second = (0..ROWS).map(|row| -angle(row));
        doubles((0..ROWS).map(angle).chain(second))
    } else {
        doubles((0..ROWS).flat_map(|row| [angle(row), -angle(row)]))
    };
    let torque = (0..ROWS).flat_map(|row| ((row % 5) as f32).to_le_bytes());
    vec![
        (
            "time_ms",
            array(">i8", false, "(200,)", &milliseconds.collect::<Vec<_>>()),
        ),
        ("q", array("<f8", is_fortran, "(200, 2)", &q)),
        (
            "tau",
            array("<f4", false, "(200,)", &torque.collect::<Vec<_>>()),
        ),
        ("names", array("<U3", false, "(2,)", &[0; 24])),
        ("gain", array("<f8", false, "()", &[0; 8])),
    ]
}

fn rig(bytes: &[u8]) -> Folder {
    let channels = "\"q[0]\" = { measures = \"theta\", unit = \"rad\" }\n\
                    tau = { input = \"tau\", unit = \"N m\" }";
    let folder = Folder::new();
    folder.write("recording.toml", pendulum(channels, &["run.npz"], &[]));
    folder.write("run.npz", bytes);
    folder
}

#[test]
fn arrays_of_one_and_two_dimensions_are_columns() {
    for (method, is_fortran) in [
        (CompressionMethod::Stored, false),
        (CompressionMethod::Deflated, true),
    ] {
        let set = rig(&archive(method, &arrays(is_fortran))).read().unwrap();
        let run = &set.runs[0];
        assert_eq!(run.times.len(), ROWS);
        for row in 0..ROWS {
            assert!((run.times[row] - time(row)).abs() < 1e-12);
            assert!((run.values[0][row] - angle(row)).abs() < 1e-12);
            assert!((run.values[1][row] - (row % 5) as f64).abs() < 1e-12);
        }
    }
}

#[test]
fn archives_that_lie_are_refused_with_the_name_of_the_array() {
    let with = |bytes: Vec<u8>| {
        let mut arrays = arrays(false);
        arrays[1].1 = bytes;
        rig(&archive(CompressionMethod::Deflated, &arrays)).refused()
    };
    let numbers = doubles((0..ROWS).map(angle));
    for (shape, expected) in [
        ("(200, 2)", "the array `q` is truncated"),
        ("(99999999999999, 2)", "more than"),
        ("(18446744073709551615, 2)", "more than"),
        ("(2, 99999999)", "columns"),
        ("(2, x)", "header that is damaged"),
        ("(100, 2)", "200 times, but 100 values"),
    ] {
        let message = with(array("<f8", false, shape, &numbers));
        assert!(
            message.contains("run.npz") && message.contains(expected),
            "{message}"
        );
    }
    // An array of zeros that a kilobyte is enough for.
    let bomb = array("<f8", false, "(100000000, 2)", &vec![0; 1 << 24]);
    assert!(with(bomb).contains("more than"));
    assert!(with(b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec()).contains("without end"));
    assert!(with(b"PK".to_vec()).contains("truncated"));
    assert!(with(array("|O", false, "(200, 2)", &[0; 8])).contains("no column `q[0]`"));
}

#[test]
fn damaged_archives_are_refused_or_read() {
    let bytes = archive(CompressionMethod::Deflated, &arrays(false));
    let mut dice = appell_test_kit::Random::new(1);
    let folder = rig(&bytes);
    for length in [0, 1, 22, 100, bytes.len() / 2] {
        folder.write("run.npz", &bytes[..length]);
        assert!(folder.refused().contains("run.npz"));
    }
    for _ in 0..300 {
        let mut damaged = bytes.clone();
        for _ in 0..=dice.below(4) {
            let at = dice.below(damaged.len());
            damaged[at] = u8::try_from(dice.below(256)).unwrap();
        }
        folder.write("run.npz", &damaged);
        // Damaged numbers are read as they are; nothing panics.
        let _ = folder.read();
    }
}
