//! Named expressions of a spec stand for what they name.

use crate::support::Folder;

const CASES: &str = r#"{"cases": [{"state": {"v": 0.3, "omega": 1, "x": 0.1, "theta": 0.2}}]}"#;

#[test]
fn a_spec_with_definitions_has_the_equations_of_one_without() {
    let folder = Folder::new();
    folder.done(&["new", "plain"]);
    let plain = folder.read("plain.toml");
    let named = plain
        .replace(
            "[frames]",
            "[definitions]\nreach = \"x + across\"\nacross = { value = \"l*sin(theta)\", unit = \"m\", about = \"bob from the pivot\" }\n\n[frames]",
        )
        .replace("value = \"x + l*sin(theta)\"", "value = \"reach\"")
        .replace("vector = [\"F\", 0, 0]", "vector = [\"F - k*across\", 0, 0]");
    let plain = plain.replace(
        "vector = [\"F\", 0, 0]",
        "vector = [\"F - k*l*sin(theta)\", 0, 0]",
    );
    folder.write("plain.toml", &plain);
    folder.write("named.toml", &named);
    folder.write("cases.json", CASES);
    let values = |spec| {
        folder
            .done(&["evaluate", spec, "--cases", "cases.json"])
            .stdout
    };
    assert_eq!(values("plain.toml"), values("named.toml"));
    let page = folder.done(&["derive", "named.toml"]).stdout;
    assert!(page.contains("across = l sin θ"), "{page}");
    let moved = [
        "simulate",
        "named.toml",
        "--t-end-s",
        "0.1",
        "--input",
        "F=-2[N/m]*reach",
    ];
    folder.done(&moved);
    let refused = ["simulate", "named.toml", "--set", "l=reach"];
    folder.fails(
        2,
        &refused,
        &["cannot depend on the coordinate `x`", "through `reach`"],
    );
}
