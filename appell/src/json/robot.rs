//! Imported robot files.

use appell_robots::Imported;
use serde_json::{Value, json};

use crate::check;

/// The result of importing a robot file, as JSON.
pub fn robot(file: &str, robot: &Imported) -> Value {
    let left_out = robot.left_out.iter();
    let left_out = left_out
        .map(|one| json!({ "what": one.what, "file": one.file, "lines": one.lines, "effect": one.effect }))
        .collect::<Vec<_>>();
    let warnings = robot.warnings.iter();
    let warnings = warnings
        .map(|report| json!({ "file": report.file(), "findings": check::findings(report) }))
        .collect::<Vec<_>>();
    json!({
        "file": file, "ok": true, "name": robot.name, "format": robot.format.word(), "bodies": robot.bodies,
        "joints": robot.joints, "nearly_right_angles": robot.nearly_right, "warnings": warnings, "left_out": left_out,
    })
}
