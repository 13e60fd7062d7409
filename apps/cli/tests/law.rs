//! Causes that the library does not have, changes, and many rigs at a time.

use crate::rig::{closed, dry, on_a_belt, on_grain, viscous, with_load};
use crate::support::{Folder, number};

/// The spec that a report improves, in `better.toml`.
fn improved(folder: &Folder) -> toml_edit::DocumentMut {
    folder.done(&[
        "apply",
        "carriage",
        "--report",
        "report.json",
        "-o",
        "better.toml",
    ]);
    folder.read("better.toml").parse().expect("a spec")
}

#[test]
fn a_rig_with_two_causes_one_of_them_unlisted_gets_a_spec_that_predicts() {
    let folder = on_grain(0.4, 0.3, 20.0);
    let told = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(report["verdict"], "unexplained", "{}", told.stdout);
    let law = &report["law"];
    assert_eq!(law["variable"], "x", "{law:#}");
    let form = law["forms"][0]["form"].as_str().expect("a form");
    assert!(form.starts_with("sin(") && form.contains("*x"), "{form}");
    let budget = report["how_far"]["budget"].as_array().expect("a list");
    let names: Vec<&str> = budget
        .iter()
        .filter_map(|part| part["effect"].as_str())
        .collect();
    assert!(
        names.contains(&"coulomb_friction@x") && names.contains(&"law"),
        "{names:?}"
    );
    let sum: f64 = budget.iter().map(|part| number(part, "closed")).sum();
    assert!((sum - 1.0).abs() < 0.02, "shares add up to {sum}");
    assert!(number(&report, "how_far/closed") > 0.95, "{}", told.stdout);
    let parameters = &improved(&folder)["parameters"];
    let has = |name: &str| parameters.get(name).is_some();
    assert!(has("law_v_rate") && has("coulomb_friction_x_force"));
    closed(&folder, "better.toml");
}

#[test]
fn a_load_that_swings_becomes_a_body_of_the_spec() {
    // A tenth of a carriage of 1 kg.
    let (share, rate) = (0.1, 11.0);
    let folder = with_load(share, rate, 0.05);
    let told = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(report["verdict"], "unexplained", "{}", told.stdout);
    assert_eq!(report["law"]["unit"], "kg", "{}", told.stdout);
    assert!(
        number(&report, "how_far/closed_vs_refitted") > 0.9,
        "{}",
        told.stdout
    );
    let better = improved(&folder);
    let value = |name: &str| {
        better["parameters"][name]["value"]
            .as_float()
            .expect("a number")
    };
    assert!((value("law_x_mass") / share - 1.0).abs() < 0.1, "{better}");
    assert!((value("law_x_rate") / rate - 1.0).abs() < 0.02, "{better}");
    closed(&folder, "better.toml");
}

#[test]
fn friction_that_gives_way_before_it_slides_is_told_from_friction_that_does_not() {
    let (friction, way) = (0.4, 0.15);
    let folder = on_a_belt(friction, way);
    let told = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(report["verdict"], "unexplained", "{}", told.stdout);
    let law = &report["law"];
    assert_eq!(law["variable"], "x since it turned", "{law:#}");
    // Right after a turn it still pushes.
    let forces = law["value"].as_array().expect("a list");
    let force = |place: usize| forces[place].as_f64().expect("a number");
    let (turned, slid) = (force(0), force(forces.len() - 1));
    assert!((turned / friction - 1.0).abs() < 0.1 && (slid / friction + 1.0).abs() < 0.1);
    let better = improved(&folder);
    let value = |name: &str| {
        better["parameters"][name]["value"]
            .as_float()
            .expect("a number")
    };
    assert!(
        (value("law_x_force") / friction - 1.0).abs() < 0.1,
        "{better}"
    );
    assert!((value("law_x_way") / way - 1.0).abs() < 0.2, "{better}");
    folder.done(&[
        "diagnose",
        "better.toml",
        "--data",
        ".",
        "--json",
        "again.json",
    ]);
    let nominal = |report: &serde_json::Value| number(report, "how_far/nominal");
    let [before, after] = [&report, &folder.json("again.json")].map(nominal);
    assert!(after < 0.1 * before, "{after} of {before}");
    // Friction that slides at once stays what it is.
    let folder = dry(friction);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(report["which"][0]["effects"][0], "coulomb_friction@x");
}

#[test]
fn what_changed_is_told_and_nothing_where_nothing_did() {
    let before = dry(0.3);
    let same = dry(0.3);
    let path = before.path("");
    let against = path.to_str().expect("a path");
    let asked = [
        "diagnose",
        "--data",
        ".",
        "--against",
        against,
        "--json",
        "report.json",
    ];
    let told = same.done(&asked);
    assert!(told.stdout.contains("nothing changed"), "{}", told.stdout);
    assert_eq!(same.json("report.json")["change"]["changed"], false);
    let worn = dry(0.6);
    let told = worn.done(&asked);
    let report = worn.json("report.json");
    assert_eq!(report["change"]["changed"], true, "{}", told.stdout);
    let first = report["which"][0]["effects"][0]
        .as_str()
        .expect("an effect");
    assert_eq!(
        first, "parameter_error@coulomb_friction_x_force",
        "{}",
        told.stdout
    );
}

#[test]
fn many_rigs_give_a_table_and_a_broken_one_is_a_row() {
    let (first, second) = (viscous(0.4), dry(0.3));
    second.write("recording.toml", "mechanism = \"carriage\"");
    let here = Folder::new();
    let paths = [first.path(""), second.path("")];
    let paths = paths.each_ref().map(|path| path.to_str().expect("a path"));
    let asked = [
        "diagnose",
        "--data",
        paths[0],
        paths[1],
        "--table",
        "fleet.csv",
    ];
    let told = here.done(&asked);
    assert!(
        told.stdout.contains("1 without a diagnosis"),
        "{}",
        told.stdout
    );
    let table = here.read("fleet.csv");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 3, "{table}");
    assert!(rows[1].contains("viscous_friction@x"), "{table}");
    assert!(
        rows[2].contains("[channels]") || rows[2].contains("recording.toml"),
        "{table}"
    );
    let told = here.done(&asked);
    assert!(
        told.stdout.contains("1 of them known from before"),
        "{}",
        told.stdout
    );
    let refused = [
        "diagnose",
        "--data",
        paths[0],
        paths[1],
        "--json",
        "report.json",
    ];
    here.fails(
        2,
        &refused,
        &["`--json` belongs to one data set", "--reports DIR"],
    );
}
