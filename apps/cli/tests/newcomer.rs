//! What newcomers tripped over, each with what they are told now.

use crate::support::{Folder, repository};

const SLEIGH: &str = r#"
[mechanism]
name  = "sleigh"
title = "Sleigh whose speed is measured along the ground"
[parameters]
m = { value = 1, unit = "kg" }
I = { value = 0.05, unit = "kg*m^2" }
[coordinates]
x   = { unit = "m" }
y   = { unit = "m" }
psi = { unit = "deg", initial = 90 }
[frames]
s = { parent = "ground", about_axis = "z", by = "psi" }
[points]
C = { from = "O", in = "ground", at = ["x", "y", 0] }
[bodies]
sleigh = { frame = "s", centre = "C", mass = "m", inertia = { in = "s", diagonal = ["I", "I", "I"] } }
[constraints]
blade = { kind = "velocity", zero = "-dot(x)*sin(psi) + dot(y)*cos(psi)" }
[pseudo_velocities]
v = { value = "dot(x)", initial = 1 }
w = { value = "dot(psi)", initial = 2 }
"#;

#[test]
fn a_start_that_the_pseudo_velocities_do_not_determine_ends_there() {
    let folder = Folder::new();
    folder.write("sleigh.toml", SLEIGH);
    let said = ["at the start", "do not determine", "psi = 90.000000 deg"];
    folder.fails(4, &["simulate", "sleigh.toml"], &said);
    let check = folder.done(&["check", "sleigh.toml"]).stderr;
    assert!(
        check.contains("do not determine `dot(y)` at the initial state"),
        "{check}"
    );
    // Notes end with a line.
    assert!(check.ends_with('\n'));
}

#[test]
fn an_unstable_design_is_told() {
    let folder = Folder::new();
    let told = folder.done(&["control", "cart_pole", "--poles", "8", "--json", "law.json"]);
    assert!(
        told.stdout
            .contains("the closed loop is unstable: 4 of 4 poles"),
        "{}",
        told.stdout
    );
    let stable = &folder.json("law.json")["law"]["stable"];
    assert_eq!(*stable, false, "{}", folder.read("law.json"));
}

#[test]
fn a_degree_is_a_degree_and_words_are_told_their_sign() {
    let folder = Folder::new();
    let start = |angle: &str| {
        let motion = [
            "simulate",
            "unicycle",
            "--t-end-s",
            "0.01",
            "--initial",
            angle,
            "--csv",
            "-",
        ];
        folder.done(&motion).stdout
    };
    assert_eq!(start("theta=20°"), start("theta=20deg"));
    let words = ["simulate", "unicycle", "--initial", "theta=20degrees"];
    folder.fails(2, &words, &["unknown unit `degrees`", "did you mean `deg`"]);
    let words = ["simulate", "unicycle", "--set", "R=0.3 meters"];
    folder.fails(2, &words, &["did you mean `m`"]);
}

#[test]
fn a_prescribed_state_lies_in_its_range() {
    let folder = Folder::new();
    let said = [
        "`theta` = 10 rad is outside its limits",
        "`10deg` is inside them",
    ];
    folder.fails(2, &["steady", "unicycle", "--fix", "theta=10"], &said);
    folder.fails(2, &["stability", "unicycle", "--fix", "theta=10"], &said);
}

#[test]
fn a_drawing_shows_another_start_and_its_angles() {
    let folder = Folder::new();
    let tilted = ["draw", "unicycle", "--initial", "theta=20deg", "--out", "-"];
    let drawn = folder.done(&tilted).stdout;
    for says in ["theta = 20°", "with theta = 20deg", "class=\"angle\""] {
        assert!(drawn.contains(says), "{drawn}");
    }
    let upright = folder.done(&["draw", "unicycle", "--out", "-"]).stdout;
    assert!(!upright.contains("class=\"angle\""));
    let refused = ["draw", "unicycle", "--initial", "theta=20"];
    folder.fails(2, &refused, &["outside its limits"]);
}

#[test]
fn the_list_is_whole_where_no_terminal_cuts_it() {
    let told = Folder::new().done(&["list"]).stdout;
    assert!(!told.contains('…'), "{told}");
}

#[cfg(feature = "png")]
#[test]
fn a_figure_is_what_its_name_says() {
    let folder = Folder::new();
    for (name, begins) in [
        ("a.svg", &b"<svg"[..]),
        ("a.png", b"\x89PNG"),
        ("a.pdf", b"%PDF"),
    ] {
        folder.done(&["draw", "pendulum", "--out", name]);
        let bytes = std::fs::read(folder.path(name)).expect("a figure");
        assert!(bytes.starts_with(begins), "{name}");
    }
    folder.fails(
        2,
        &["draw", "pendulum", "--out", "a.gif"],
        &["`.gif`", ".svg, .png or .pdf"],
    );
}

#[test]
fn no_folder_is_made_by_a_mistyped_path() {
    let folder = Folder::new();
    let spec = repository("generated/mechanisms/pendulum.toml");
    folder.fails(
        3,
        &["draw", &spec, "--out", "pitcures/a.svg"],
        &["no folder `pitcures`"],
    );
    folder.fails(2, &["recording", "nodir"], &["nodir"]);
    assert!(folder.files().is_empty());
}

/// The recordings of a sample rig with other rows.
fn rig(change: impl Fn(usize, &str) -> Option<String>) -> Folder {
    let folder = Folder::new();
    folder.done(&["sample", "rig", "."]);
    for run in ["run1.csv", "run2.csv", "run3.csv"] {
        let text = folder.read(run);
        let rows = text.lines().enumerate();
        let rows: Vec<String> = rows.filter_map(|(row, line)| change(row, line)).collect();
        folder.write(run, &(rows.join("\n") + "\n"));
    }
    folder
}

/// A row with another time or another position.
fn changed(line: &str, column: usize, with: impl Fn(f64) -> f64) -> String {
    let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
    if let Ok(value) = cells[column].parse::<f64>() {
        cells[column] = format!("{:.5}", with(value));
    }
    cells.join(",")
}

#[test]
fn a_stretch_that_nobody_recorded_is_no_cause() {
    let folder = rig(|row, line| (!(300..360).contains(&row)).then(|| line.to_owned()));
    let told = folder.done(&["recording", "."]).stdout;
    assert!(told.contains("cut at its gap into 2 runs"), "{told}");
    let found = folder.done(&["diagnose", "--data", "."]).stdout;
    assert!(found.contains("dry friction at x closes"), "{found}");
    let whole = [
        "simulate",
        "my_rig.toml",
        "--inputs",
        "recording.toml:run3.csv",
    ];
    folder.fails(2, &whole, &["append one of", "run3.csv#1"]);
}

#[test]
fn inputs_of_a_run_begin_with_the_motion_whatever_the_clock_said() {
    let folder = rig(|_, line| Some(changed(line, 0, |t| t + 1.731e9)));
    let moved = [
        "simulate",
        "my_rig.toml",
        "--inputs",
        "recording.toml:run3.csv",
        "--t-end-s",
        "10",
    ];
    let told = folder.done(&[&moved[..], &["--csv", "motion.csv"]].concat());
    assert!(
        told.stderr.contains("the recorded inputs end at 7.99"),
        "{}",
        told.stderr
    );
    let last = folder.read("motion.csv");
    let last = last
        .lines()
        .last()
        .expect("a row")
        .split(',')
        .nth(1)
        .expect("a velocity");
    assert!(last.parse::<f64>().expect("a number").abs() > 0.1, "{last}");
    let bare = [
        "simulate",
        "my_rig.toml",
        "--inputs",
        "run3.csv",
        "--t-end-s",
        "10",
    ];
    folder.fails(
        3,
        &bare,
        &[
            "the inputs begin at 1731000000 s",
            "the motion ends at 10 s",
        ],
    );
}

#[test]
fn recordings_of_a_rig_at_rest_are_refused() {
    let folder = rig(|_, line| Some(changed(line, 1, |_| 0.1)));
    for command in [&["diagnose"][..], &["identify", "my_rig.toml"]] {
        let command = [command, &["--data", "."]].concat();
        folder.fails(3, &command, &["`x` never changes"]);
    }
}

#[test]
fn the_rate_of_a_wave_is_found_between_those_that_are_tried() {
    let folder = Folder::new();
    folder.done(&["sample", "rig", "."]);
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let text = folder.json("report.json")["law"]["forms"][0]["form"].to_string();
    let rate = text
        .split("sin(")
        .nth(1)
        .and_then(|rest| rest.split('*').next());
    let rate: f64 = rate
        .unwrap_or_else(|| panic!("{text}"))
        .parse()
        .expect("a rate");
    // The rig has a grain of 20 rad/m.
    assert!((rate - 20.0).abs() < 0.3, "{text}");
}

#[test]
fn printed_commands_survive_a_shell() {
    let folder = Folder::new();
    let told = folder.done(&["sample", "rig", "my rig"]).stdout;
    let commands = told.lines().filter(|line| line.starts_with("  appell "));
    let commands: Vec<&str> = commands.map(str::trim).collect();
    assert_eq!(commands.len(), 2, "{told}");
    for command in commands {
        crate::documents::shell(&folder, command);
    }
}

#[test]
fn a_closed_loop_is_assembled_before_it_is_linearised() {
    let folder = Folder::new();
    let at = ["control", "four_bar", "--at", "theta1=1.44162"];
    let design = ["--outputs", "theta1,omega", "--poles", "-20"];
    let told = folder.done(&[&at[..], &design[..]].concat()).stdout;
    for part in [
        "theta2 = 0.521199 rad",
        "theta3 = 1.67881 rad",
        "poles in 1/s: -20.0000, -20.0000",
    ] {
        assert!(told.contains(part), "{part} in {told}");
    }
    // The choice of outputs is closed by itself.
    let told = folder
        .done(&["control", "four_bar", "--poles", "-20"])
        .stdout;
    assert!(
        told.contains("outputs omega, theta1: a closed subsystem"),
        "{told}"
    );
    for outputs in [&[][..], &["--outputs", "theta1,omega"]] {
        let turning = ["control", "four_bar", "--at", "omega=1"];
        let said = ["not steady: `theta1` changes by 1.00000 rad per second"];
        folder.fails(2, &[&turning[..], outputs].concat(), &said);
    }
}

#[test]
fn a_loop_that_cannot_be_assembled_is_told_with_a_remedy() {
    let folder = Folder::new();
    let said = ["no value of `theta", "in SI units", "correct the lengths"];
    for command in ["simulate", "control"] {
        folder.fails(2, &[command, "four_bar", "--set", "b=2m"], &said);
    }
}

#[test]
fn a_constraint_that_is_stated_twice_is_left_out() {
    let folder = Folder::new();
    let spec = text_of("generated/mechanisms/four_bar.toml");
    let again = "[pseudo_velocities]";
    let twice = "again = { kind = \"position\", zero = \"c*sin(theta3) - a*sin(theta1) - b*sin(theta2)\" }\n";
    folder.write(
        "twice.toml",
        &spec.replace(again, &format!("{twice}{again}")),
    );
    let told = folder.done(&["check", "twice.toml"]).stderr;
    assert!(
        told.contains("`again` follows from `upwards` and is left out"),
        "{told}"
    );
    assert!(!told.contains("initial-state"), "{told}");
    let motion = |model: &str| {
        let motion = [
            "simulate",
            model,
            "--t-end-s",
            "0.5",
            "--engine",
            "jit",
            "--json",
            "-",
        ];
        folder.done(&motion).stdout
    };
    let last = |text: &str| -> f64 {
        let value: serde_json::Value = serde_json::from_str(text).expect("JSON");
        value["final_state"]["theta1"].as_f64().expect("a number")
    };
    let (once, twice) = (last(&motion("four_bar")), last(&motion("twice.toml")));
    assert!((once - twice).abs() < 1e-9, "{once}, {twice}");
}

#[test]
fn a_start_that_was_tried_is_not_proposed_again() {
    let folder = Folder::new();
    let rest = ["simulate", "rolling_ball", "--t-end-s", "1"];
    let first = folder.done(&rest).stdout;
    let proposed = first.split("try `--initial ").nth(1).expect("a hint");
    let proposed = proposed.split('`').next().expect("a name");
    let again = folder
        .done(&[&rest[..], &["--initial", proposed]].concat())
        .stdout;
    assert!(again.contains("nothing moves"), "{again}");
    assert!(!again.contains(proposed), "{again}");
    let speed = again.split("try `--initial ").nth(1).expect("a hint");
    let speed = speed.split('`').next().expect("a name");
    let moved = folder
        .done(&[&rest[..], &["--initial", speed]].concat())
        .stdout;
    assert!(!moved.contains("nothing moves"), "{moved}");
}

fn text_of(path: &str) -> String {
    std::fs::read_to_string(repository(path)).expect("a shipped spec")
}
