//! Messages of robots that name their joints, with topics that have times of their own.
#![cfg(feature = "mcap")]
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::Writer;
use mcap::records::MessageHeader;

use crate::formats::{ROUNDING, ROWS, angle, assert_damage_is_told, folder, torque};

/// The joints of a robot in changing order, and commands at a twentieth of their rate.
fn joints() -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut writer = Writer::new(&mut bytes).unwrap();
    let none = BTreeMap::new();
    let schema = "string[] name\nfloat64[] position\nfloat64[] velocity\n";
    let id = writer.add_schema("sensor_msgs/msg/JointState", "ros2msg", schema.as_bytes());
    let states = writer
        .add_channel(id.unwrap(), "/joint_states", "cdr", &none)
        .unwrap();
    let schema = "float64[] data\n";
    let id = writer.add_schema(
        "std_msgs/msg/Float64MultiArray",
        "ros2msg",
        schema.as_bytes(),
    );
    let commands = writer
        .add_channel(id.unwrap(), "/effort", "cdr", &none)
        .unwrap();
    let doubles = |bytes: &mut Vec<u8>, values: &[f64]| {
        while !(bytes.len() - 4).is_multiple_of(4) {
            bytes.push(0);
        }
        bytes.extend(u32::try_from(values.len()).unwrap().to_le_bytes());
        while !values.is_empty() && !(bytes.len() - 4).is_multiple_of(8) {
            bytes.push(0);
        }
        bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    };
    for row in 0..ROWS {
        let log_time = 1_700_000_000_000_000_000 + 10_000_000 * row as u64;
        let mut write = |channel_id, log_time, data: &[u8]| {
            let header = MessageHeader {
                channel_id,
                sequence: 0,
                log_time,
                publish_time: log_time,
            };
            writer.write_to_known_channel(&header, data).unwrap();
        };
        if row % 20 == 0 {
            let mut data = vec![0, 1, 0, 0];
            doubles(&mut data, &[torque(row / 20)]);
            write(commands, log_time - 3_000_000, &data);
        }
        let mut order = [("other", 9.0), ("theta", angle(row))];
        order.rotate_left(row % 2);
        let mut data = vec![0, 1, 0, 0];
        data.extend(2_u32.to_le_bytes());
        for (name, _) in order {
            while !(data.len() - 4).is_multiple_of(4) {
                data.push(0);
            }
            data.extend(6_u32.to_le_bytes());
            data.extend(name.as_bytes());
            data.push(0);
        }
        doubles(&mut data, &order.map(|(_, position)| position));
        doubles(&mut data, &[]);
        write(states, log_time, &data);
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

#[test]
fn joints_are_columns_by_name_and_commands_are_held_between_their_messages() {
    let columns = ["/joint_states.position[*]", "/effort.data[*]"];
    let folder = folder("run.mcap", &joints(), columns);
    let text = std::fs::read_to_string(folder.path("recording.toml")).unwrap();
    let text = text.replace("measures = \"theta\"", "measures = \"*\"");
    let text = text.replace("input = \"tau\"", "input = [\"tau\"]");
    folder.write("recording.toml", text);
    let set = folder.read().unwrap();
    assert_eq!(set.channels[0].column, "/joint_states.position[theta]");
    let run = &set.runs[0];
    assert_eq!(run.times.len(), ROWS);
    for row in 0..ROWS {
        assert!((run.values[0][row] - angle(row)).abs() < ROUNDING, "{row}");
        assert!(
            (run.values[1][row] - torque(row / 20)).abs() < ROUNDING,
            "{row}"
        );
    }
    let kinds: Vec<_> = set.findings.iter().map(|finding| finding.kind).collect();
    assert!(
        kinds.contains(&appell_recordings::FindingKind::Asynchronous),
        "{kinds:?}"
    );
}

#[test]
fn damaged_joints_are_refused_or_read() {
    let columns = ["/joint_states.position[theta]", "/effort.data[0]"];
    assert_damage_is_told("run.mcap", &joints(), columns);
}
