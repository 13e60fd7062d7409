//! Runs are read from binary files as from text, and damaged files are refused without a panic.
//!
//! `cargo test -p appell-gap --all-features formats`
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_test_kit::Random;

use crate::common::{Folder, pendulum};

/// Rows of a run.
pub(crate) const ROWS: usize = 200;
/// Times and values pass as they are.
pub(crate) const ROUNDING: f64 = 1e-12;

pub(crate) fn time(row: usize) -> f64 {
    0.01 * row as f64
}

pub(crate) fn angle(row: usize) -> f64 {
    0.5 * (3.0 * time(row)).sin()
}

pub(crate) fn torque(row: usize) -> f64 {
    0.2 * (row % 5) as f64
}

/// A folder with one run under a name, whose columns have these names.
pub(crate) fn folder(file: &str, bytes: &[u8], [theta, tau]: [&str; 2]) -> Folder {
    let channels = format!(
        "\"{theta}\" = {{ measures = \"theta\", unit = \"rad\" }}\n\
         \"{tau}\" = {{ input = \"tau\", unit = \"N m\" }}"
    );
    let folder = Folder::new();
    folder.write("recording.toml", pendulum(&channels, &[file], &[]));
    folder.write(file, bytes);
    folder
}

/// Holds a run against what was written, with what is missing.
fn assert_run(folder: &Folder, rounding: f64, is_missing: impl Fn(usize) -> bool) {
    let set = folder.read().unwrap();
    let run = &set.runs[0];
    assert_eq!(run.times.len(), ROWS);
    for row in 0..ROWS {
        assert!((run.times[row] - time(row)).abs() < ROUNDING, "{row}");
        let [theta, tau] = [run.values[0][row], run.values[1][row]];
        assert_eq!(theta.is_nan(), is_missing(row), "{row}");
        assert!(is_missing(row) || (theta - angle(row)).abs() < rounding);
        assert!((tau - torque(row)).abs() < rounding, "{row}: {tau}");
    }
}

/// Damages copies of a file: cut off, or bytes changed. None may panic; what is cut off in its
/// beginning is refused.
pub(crate) fn assert_damage_is_told(file: &str, bytes: &[u8], columns: [&str; 2]) {
    let folder = folder(file, bytes, columns);
    for length in [0, 1, 3, 16, 100] {
        folder.write(file, &bytes[..length]);
        let message = folder.refused();
        assert!(message.contains(file), "{message}");
    }
    let mut dice = Random::new(1);
    for _ in 0..300 {
        let mut damaged = bytes.to_vec();
        for _ in 0..=dice.below(4) {
            let at = dice.below(damaged.len());
            damaged[at] = u8::try_from(dice.below(256)).unwrap();
        }
        if dice.below(4) == 0 {
            damaged.truncate(dice.below(bytes.len()));
        }
        folder.write(file, &damaged);
        if let Ok(set) = folder.read() {
            let run = &set.runs[0];
            assert!(run.times.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(
                run.values
                    .iter()
                    .flatten()
                    .all(|value| !value.is_infinite())
            );
        }
    }
}

mod c3d {
    use super::*;

    /// How numbers of a file are written.
    #[derive(Clone, Copy)]
    enum Numbers {
        Floats,
        /// With the scale of the points.
        Integers(f32),
    }

    /// Numbers with the end of small significance first.
    fn words(values: &[u16]) -> Vec<u8> {
        values.iter().flat_map(|word| word.to_le_bytes()).collect()
    }

    fn group(id: i8, name: &str) -> Vec<u8> {
        let length = u8::try_from(name.len()).unwrap();
        let head = [length, id.wrapping_neg().cast_unsigned()];
        [&head[..], name.as_bytes(), &[3, 0, 0]].concat()
    }

    fn parameter(id: u8, name: &str, kind: i8, sizes: &[u8], data: &[u8]) -> Vec<u8> {
        let length = u8::try_from(name.len()).unwrap();
        let dimensions = u8::try_from(sizes.len()).unwrap();
        let rest = [&[kind.cast_unsigned(), dimensions], sizes, data, &[0]].concat();
        let next = u16::try_from(2 + rest.len()).unwrap().to_le_bytes();
        [&[length, id], name.as_bytes(), &next, &rest].concat()
    }

    /// One point whose `X` is the angle in mrad, one analog channel with two samples a frame.
    fn file(numbers: Numbers) -> Vec<u8> {
        let scale = match numbers {
            Numbers::Floats => -1.0_f32,
            Numbers::Integers(scale) => scale,
        };
        let mut bytes = vec![2, 0x50];
        bytes.extend(words(&[1, 2, 1, u16::try_from(ROWS).unwrap(), 10]));
        bytes.extend(scale.to_le_bytes());
        bytes.extend(words(&[4, 2]));
        bytes.extend(100_f32.to_le_bytes());
        bytes.resize(512, 0);
        bytes.extend([1, 0x50, 2, 84]);
        bytes.extend(group(1, "POINT"));
        bytes.extend(parameter(1, "LABELS", -1, &[6, 1], b"arm   "));
        bytes.extend(group(2, "ANALOG"));
        bytes.extend(parameter(2, "LABELS", -1, &[5, 1], b"motor"));
        bytes.extend(parameter(2, "GEN_SCALE", 4, &[], &0.5_f32.to_le_bytes()));
        bytes.extend(parameter(2, "SCALE", 4, &[1], &0.002_f32.to_le_bytes()));
        bytes.extend(parameter(2, "OFFSET", 2, &[1], &100_i16.to_le_bytes()));
        bytes.resize(3 * 512, 0);
        for row in 0..ROWS {
            let seen = if row == 7 { -1.0 } else { 0.0 };
            let analog = 1e3 * torque(row) + 100.0;
            let entries = [1e3 * angle(row), 0.0, 0.0, seen, analog, 0.0];
            for (place, entry) in entries.into_iter().enumerate() {
                #[allow(clippy::cast_possible_truncation, reason = "as the format has it")]
                match numbers {
                    Numbers::Floats => bytes.extend((entry as f32).to_le_bytes()),
                    Numbers::Integers(scale) => {
                        let unit = if place < 3 { f64::from(scale) } else { 1.0 };
                        bytes.extend(((entry / unit).round() as i16).to_le_bytes());
                    }
                }
            }
        }
        bytes
    }

    /// The angle is written in mrad.
    fn rig(bytes: &[u8]) -> Folder {
        let folder = folder("run.c3d", bytes, ["arm.X", "motor"]);
        let text = std::fs::read_to_string(folder.path("recording.toml")).unwrap();
        folder.write("recording.toml", text.replace("\"rad\"", "\"mrad\""));
        folder
    }

    #[test]
    fn points_and_analog_channels_are_read_with_their_scales() {
        // Single precision of values of some hundred.
        assert_run(&rig(&file(Numbers::Floats)), 1e-6, |row| row == 7);
        // Half of the scale, in mrad.
        let integers = file(Numbers::Integers(0.1));
        assert_run(&rig(&integers), 0.51e-4, |row| row == 7);
    }

    #[test]
    fn a_column_that_is_missing_is_told_with_one_that_is_alike() {
        let folder = folder("run.c3d", &file(Numbers::Floats), ["arn.X", "motor"]);
        let message = folder.refused();
        assert!(message.contains("did you mean `arm.X`"), "{message}");
    }

    #[test]
    fn damaged_files_are_refused_or_read() {
        assert_damage_is_told("run.c3d", &file(Numbers::Floats), ["arm.X", "motor"]);
    }
}

#[cfg(not(feature = "parquet"))]
#[test]
fn a_format_that_was_not_built_in_is_told_with_its_feature() {
    let folder = folder("run.parquet", b"PAR1", ["theta", "tau"]);
    let message = folder.refused();
    assert!(message.contains("feature"), "{message}");
}

#[cfg(feature = "parquet")]
mod parquet {
    use std::sync::Arc;

    use ::parquet::data_type::{DoubleType, FloatType, Int64Type};
    use ::parquet::file::properties::WriterProperties;
    use ::parquet::file::writer::SerializedFileWriter;
    use ::parquet::schema::parser::parse_message_type;

    use super::*;

    fn file() -> Vec<u8> {
        file_of("t (TIMESTAMP(MICROS, true))")
    }

    /// Times in µs by this clock, an angle that is missing once, a torque in single precision.
    fn file_of(clock: &str) -> Vec<u8> {
        let schema = format!(
            "message run {{
            required int64 {clock};
            optional double theta;
            required float tau;
            required binary note (UTF8);
        }}"
        );
        let schema = Arc::new(parse_message_type(&schema).unwrap());
        let mut bytes = Vec::new();
        let properties = Arc::new(WriterProperties::builder().build());
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties).unwrap();
        for rows in [0..ROWS / 2, ROWS / 2..ROWS] {
            let mut group = writer.next_row_group().unwrap();
            let mut column = group.next_column().unwrap().unwrap();
            let times: Vec<i64> = rows
                .clone()
                .map(|row| 1_700_000_000_000_000 + 10_000 * i64::try_from(row).unwrap())
                .collect();
            column
                .typed::<Int64Type>()
                .write_batch(&times, None, None)
                .unwrap();
            column.close().unwrap();
            let mut column = group.next_column().unwrap().unwrap();
            let levels: Vec<i16> = rows.clone().map(|row| i16::from(row != 7)).collect();
            let angles: Vec<f64> = rows.clone().filter(|row| *row != 7).map(angle).collect();
            column
                .typed::<DoubleType>()
                .write_batch(&angles, Some(&levels), None)
                .unwrap();
            column.close().unwrap();
            let mut column = group.next_column().unwrap().unwrap();
            #[allow(
                clippy::cast_possible_truncation,
                reason = "single precision is written"
            )]
            let torques: Vec<f32> = rows.clone().map(|row| torque(row) as f32).collect();
            column
                .typed::<FloatType>()
                .write_batch(&torques, None, None)
                .unwrap();
            column.close().unwrap();
            let mut column = group.next_column().unwrap().unwrap();
            let notes = vec!["as planned".into(); rows.len()];
            column
                .typed::<::parquet::data_type::ByteArrayType>()
                .write_batch(&notes, None, None)
                .unwrap();
            column.close().unwrap();
            group.close().unwrap();
        }
        writer.close().unwrap();
        bytes
    }

    #[test]
    fn columns_are_read_with_what_is_missing_and_times_from_stamps() {
        assert_run(
            &folder("run.parquet", &file(), ["theta", "tau"]),
            1e-7,
            |row| row == 7,
        );
    }

    #[test]
    fn the_clock_has_any_name_and_unit() {
        let stamps = file_of("timestamp (TIMESTAMP(MICROS, true))");
        let is_missing = |row: usize| row == 7;
        let columns = ["theta", "tau"];
        assert_run(&folder("run.parquet", &stamps, columns), 1e-7, is_missing);
        for (clock, line) in [
            ("time_us", ""),
            ("clock", "clock = { time = true, unit = \"us\" }\n"),
        ] {
            let folder = folder("run.parquet", &file_of(clock), columns);
            let text = std::fs::read_to_string(folder.path("recording.toml")).unwrap();
            let stated = text.replace("[channels]\n", &format!("[channels]\n{line}"));
            folder.write("recording.toml", stated);
            let run = &folder.read().unwrap().runs[0];
            assert!((run.duration() - time(ROWS - 1)).abs() < 1e-6, "{clock}");
        }
        let folder = folder("run.parquet", &stamps, columns);
        let text = std::fs::read_to_string(folder.path("recording.toml")).unwrap();
        let wrong = "[channels]\ntimestamp = { unit = \"ms\" }\n";
        folder.write("recording.toml", text.replace("[channels]\n", wrong));
        assert!(folder.refused().contains("itself states the unit"));
    }

    /// As `lerobot` writes them: lists of one length, of which one is missing and one is short.
    fn lists() -> Vec<u8> {
        let schema = "message run {
            required float timestamp;
            required int64 episode_index;
            optional group observation.state (LIST) {
                repeated group list { optional float element; }
            }
            optional group action (LIST) {
                repeated group list { optional double element; }
            }
        }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let mut bytes = Vec::new();
        let properties = Arc::new(WriterProperties::builder().build());
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let rows = || (0..2).flat_map(|_| 0..ROWS);
        let mut column = group.next_column().unwrap().unwrap();
        #[allow(
            clippy::cast_possible_truncation,
            reason = "single precision is written"
        )]
        let times: Vec<f32> = rows().map(|row| time(row) as f32).collect();
        column
            .typed::<FloatType>()
            .write_batch(&times, None, None)
            .unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        let episodes: Vec<i64> = (0..2 * ROWS).map(|row| i64::from(row >= ROWS)).collect();
        column
            .typed::<Int64Type>()
            .write_batch(&episodes, None, None)
            .unwrap();
        column.close().unwrap();
        let (mut values, mut defined, mut repeated) = (Vec::new(), Vec::new(), Vec::new());
        for row in rows() {
            if row == 7 {
                defined.push(0);
                repeated.push(0);
                continue;
            }
            #[allow(
                clippy::cast_possible_truncation,
                reason = "single precision is written"
            )]
            values.extend([0.5, angle(row) as f32]);
            defined.extend([3, 3]);
            repeated.extend([0, 1]);
        }
        let mut column = group.next_column().unwrap().unwrap();
        let typed = column.typed::<FloatType>();
        typed
            .write_batch(&values, Some(&defined), Some(&repeated))
            .unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        let commands: Vec<f64> = rows().map(torque).collect();
        let ones = vec![3; commands.len()];
        let firsts = vec![0; commands.len()];
        let typed = column.typed::<DoubleType>();
        typed
            .write_batch(&commands, Some(&ones), Some(&firsts))
            .unwrap();
        column.close().unwrap();
        group.close().unwrap();
        writer.close().unwrap();
        bytes
    }

    #[test]
    fn lists_are_columns_and_episodes_are_runs() {
        let columns = ["observation.state[1]", "action[0]"];
        let folder = folder("all.parquet", &lists(), columns);
        let text = std::fs::read_to_string(folder.path("recording.toml")).unwrap();
        folder.write(
            "recording.toml",
            text.replace("all.parquet", "all.parquet#0-1"),
        );
        let set = folder.read().unwrap();
        assert_eq!(set.runs.len(), 2);
        let run = &set.runs[1];
        assert_eq!(run.times.len(), ROWS);
        for row in 0..ROWS {
            assert!((run.times[row] - time(row)).abs() < 1e-6);
            assert_eq!(run.values[0][row].is_nan(), row == 7);
            assert!(row == 7 || (run.values[0][row] - angle(row)).abs() < 1e-7);
            assert!((run.values[1][row] - torque(row)).abs() < 1e-12);
        }
    }

    #[test]
    fn damaged_lists_are_refused_or_read() {
        let columns = ["observation.state[1]", "action[0]"];
        assert_damage_is_told("run.parquet", &lists(), columns);
    }

    #[test]
    fn text_is_no_channel() {
        let message = folder("run.parquet", &file(), ["theta", "note"]).refused();
        assert!(message.contains("`note` holds no numbers"), "{message}");
    }

    #[test]
    fn damaged_files_are_refused_or_read() {
        assert_damage_is_told("run.parquet", &file(), ["theta", "tau"]);
    }
}

#[cfg(feature = "mcap")]
mod mcap {
    use std::collections::BTreeMap;
    use std::io::Cursor;

    use ::mcap::Writer;
    use ::mcap::records::MessageHeader;

    use super::*;

    /// The message language of ROS 2: constants, text and lists stand before what is looked for.
    const DEFINITION: &str = "\
uint8 STALE=3   # a constant
string name
int16[] codes
Joint joint
================================================================================
MSG: rig/Joint
bool on
float64[2] position
";

    /// The bytes of such a message: numbers stand at multiples of their own length.
    fn message(angle: f64) -> Vec<u8> {
        let mut bytes = vec![0, 1, 0, 0];
        bytes.extend(4_u32.to_le_bytes());
        bytes.extend(b"arm\0");
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend((-2_i16).to_le_bytes());
        bytes.push(1);
        while (bytes.len() - 4) % 8 > 0 {
            bytes.push(0);
        }
        bytes.extend(0.0_f64.to_le_bytes());
        bytes.extend(angle.to_le_bytes());
        bytes
    }

    fn file() -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        let mut writer = Writer::new(&mut bytes).unwrap();
        let (none, sequence) = (BTreeMap::new(), 0);
        let schema = writer
            .add_schema("rig/State", "ros2msg", DEFINITION.as_bytes())
            .unwrap();
        let state = writer.add_channel(schema, "/state", "cdr", &none).unwrap();
        let command = writer.add_channel(0, "/command", "json", &none).unwrap();
        for row in 0..ROWS {
            let log_time = 1_700_000_000_000_000_000 + 10_000_000 * row as u64;
            let mut write = |channel_id, data: &[u8]| {
                let header = MessageHeader {
                    channel_id,
                    sequence,
                    log_time,
                    publish_time: log_time,
                };
                writer.write_to_known_channel(&header, data).unwrap();
            };
            let text = format!(
                "{{\"motor\": [{{\"torque\": {}}}], \"mode\": \"on\", \"stamp\": {}}}",
                torque(row),
                10 * row
            );
            write(command, text.as_bytes());
            if row != 7 {
                write(state, &message(angle(row)));
            }
        }
        writer.finish().unwrap();
        drop(writer);
        bytes.into_inner()
    }

    const COLUMNS: [&str; 2] = ["/state.joint.position[1]", "/command.motor[0].torque"];

    #[test]
    fn messages_of_two_topics_make_rows() {
        assert_run(&folder("run.mcap", &file(), COLUMNS), ROUNDING, |row| {
            row == 7
        });
    }

    #[test]
    fn a_field_of_a_message_may_be_the_clock() {
        let folder = folder("run.mcap", &file(), COLUMNS);
        let text = std::fs::read_to_string(folder.path("recording.toml")).unwrap();
        let line = "[channels]\n\"/command.stamp\" = { time = true, unit = \"ms\" }\n";
        folder.write("recording.toml", text.replace("[channels]\n", line));
        assert_run(&folder, ROUNDING, |row| row == 7);
    }

    #[test]
    fn damaged_files_are_refused_or_read() {
        assert_damage_is_told("run.mcap", &file(), COLUMNS);
    }
}
