//! `appell simulate`: manoeuvres, inputs, failures.

use crate::support::{Folder, assert_close, number, repository};

/// Agreement with the published manoeuvres: eight digits.
const EIGHT_DIGITS: f64 = 1e-8;
/// What an integration at these tolerances leaves of an exact solution.
const INTEGRATION: f64 = 1e-9;

/// The final state of a manoeuvre with exact gains, from an independent simulation with DOP853 at
/// a relative tolerance of 1e-12.
fn manoeuvre(law: &str, expected: &[(&str, f64)], largest_input: f64) {
    let folder = Folder::new();
    let law = repository(&format!("docs/examples/feedback/{law}.toml"));
    folder.done(&[
        "simulate",
        "unicycle",
        "--feedback",
        &law,
        "--rtol",
        "1e-12",
        "--atol",
        "1e-12",
        "--dt-s",
        "0.0005",
        "--json",
        "out.json",
    ]);
    let out = folder.json("out.json");
    for (name, value) in expected {
        assert_close(
            number(&out, &format!("final_state/{name}")),
            *value,
            EIGHT_DIGITS,
            name,
        );
    }
    // The largest value is read from samples, half a millisecond apart.
    assert_close(number(&out, "extrema/u/max_abs"), largest_input, 1e-5, "u");
}

#[test]
fn the_lane_change_at_5_m_s_ends_where_it_should() {
    manoeuvre(
        "lane_change_5_m_s",
        &[
            ("omega_1", 7.132_048_807e-8),
            ("omega_2", 16.666_714_279_211_636),
            ("theta", 7.593_727_675e-6),
            ("sigma", -6.000_512_063e-5),
            ("r", 1.701_554_572e-5),
            ("psi", 2.475_145_852e-7),
            ("phi", 166.944_155_780_887_14),
            ("x_G", 47.511_097_357_635_94),
            ("y_G", -10.000_050_349_629_701),
        ],
        10.350_249_490,
    );
}

#[test]
fn the_lane_change_at_1_m_s_ends_where_it_should() {
    let end = [
        ("x_G", 9.187_490_865_058_17),
        ("y_G", -2.500_027_773_198_792),
        ("theta", 3.966_962_054e-5),
    ];
    manoeuvre("lane_change_1_m_s", &end, 3.015_014_598);
}

#[test]
fn the_right_turn_at_1_m_s_ends_where_it_should() {
    let end = [
        ("x_G", 5.666_071_750_054),
        ("y_G", -5.408_815_313_022),
        ("psi", -1.570_795_879_177_592),
    ];
    manoeuvre("right_turn_1_m_s", &end, 1.158_817_917);
}

#[test]
fn the_right_turn_at_5_m_s_ends_where_it_should() {
    let end = [
        ("x_G", 28.332_414_442_113),
        ("y_G", -27.113_357_277_169),
        ("psi", -1.570_799_388_968_944),
    ];
    manoeuvre("right_turn_5_m_s", &end, 16.791_198_613);
}

#[test]
fn recorded_inputs_are_held_and_switched_exactly() {
    let folder = Folder::new();
    // 3 N for a second from t = 0.7 s on, on 2 kg.
    folder.write("force.csv", "# comment\nt,F\n0,0\n0.7,3\n1.7,0\n");
    for method in ["dop853", "dopri5"] {
        folder.done(&[
            "simulate",
            "carriage",
            "--set",
            "m=2000g",
            "--inputs",
            "force.csv",
            "--t-end-s",
            "2.7",
            "--json",
            "out.json",
            "--method",
            method,
        ]);
        let out = folder.json("out.json");
        assert_close(number(&out, "final_state/v"), 1.5, 1e-13, "v");
        assert_close(number(&out, "final_state/x"), 0.75 + 1.5, 1e-13, "x");
    }
}

#[test]
fn expressions_know_time_state_parameters_and_switch_exactly() {
    let folder = Folder::new();
    let end = |input: &str| {
        folder.done(&[
            "simulate",
            "carriage",
            "--input",
            input,
            "--t-end-s",
            "2",
            "--json",
            "out.json",
        ]);
        let out = folder.json("out.json");
        (number(&out, "final_state/x"), number(&out, "final_state/v"))
    };
    assert_close(end("F=if(t < 0.3, 2, 0)").1, 0.6, 1e-13, "a pulse");
    assert_close(
        end("F=sin(2*t)").1,
        (1.0 - 4.0_f64.cos()) / 2.0,
        INTEGRATION,
        "a sine",
    );
    assert_close(
        end("F=m*(1 - v)").1,
        1.0 - (-2.0_f64).exp(),
        INTEGRATION,
        "a law",
    );
    assert_close(end("F=200cN").1, 4.0, 1e-12, "a unit");
    assert_close(end("F=-1").0, -2.0, 1e-12, "a negative number");
}

#[test]
fn a_written_motion_can_be_fed_back() {
    let folder = Folder::new();
    let base = ["simulate", "carriage", "--t-end-s", "1", "--dt-s", "0.25"];
    folder.done(
        &[
            &base[..],
            &["--input", "F=if(t < 0.5, 1, 3)", "--csv", "a.csv"],
        ]
        .concat(),
    );
    folder.done(&[&base[..], &["--inputs", "a.csv", "--csv", "b.csv"]].concat());
    let rows = |name: &str| -> Vec<Vec<f64>> {
        let text = folder.read(name);
        let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
        lines
            .map(|line| {
                line.split(',')
                    .map(|cell| cell.parse().expect("a number"))
                    .collect()
            })
            .collect()
    };
    let (a, b) = (rows("a.csv"), rows("b.csv"));
    assert_eq!(a.len(), 5);
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert_close(*b, *a, 1e-12, "cell");
    }
}

#[test]
fn the_methods_agree() {
    let folder = Folder::new();
    let mut ends = Vec::new();
    for method in ["dop853", "dopri5", "rk4"] {
        folder.done(&[
            "simulate",
            "double_pendulum",
            "--initial",
            "theta1=60deg",
            "--t-end-s",
            "2",
            "--dt-s",
            "0.0005",
            "--method",
            method,
            "--json",
            "out.json",
        ]);
        ends.push(number(&folder.json("out.json"), "final_state/theta2"));
    }
    assert_close(ends[1], ends[0], 1e-7, "dopri5");
    assert_close(ends[2], ends[0], 1e-7, "rk4");
}

#[test]
fn a_falling_wheel_fails_with_time_state_and_reason_and_keeps_the_motion() {
    let folder = Folder::new();
    folder.fails(
        4,
        &[
            "simulate",
            "rolling_wheel",
            "--initial",
            "theta=0.3",
            "--csv",
            "fall.csv",
            "--json",
            "out.json",
        ],
        &["at t = ", "`theta` leaves its range", "state: omega_1 = "],
    );
    assert!(folder.read("fall.csv").lines().count() > 10);
    let out = folder.json("out.json");
    assert!(
        out["failure"]
            .as_str()
            .is_some_and(|reason| reason.contains("theta"))
    );
    assert_close(number(&out, "final_state/theta"), 1.5, 1e-6, "theta");
    assert!(number(&out, "statistics/steps") > 1.0);
    folder.done(&[
        "simulate",
        "rolling_wheel",
        "--initial",
        "theta=0.3",
        "--ignore-ranges",
        "--t-end-s",
        "0.5",
    ]);
}

#[test]
fn without_options_it_tells_something_useful() {
    let folder = Folder::new();
    let told = folder.done(&["simulate", "unicycle"]).stdout;
    assert!(told.contains("nothing moves"), "{told}");
    folder.done(&["new", "mine"]);
    let told = folder
        .done(&["simulate", "mine.toml", "--plot", "mine.svg"])
        .stdout;
    assert!(told.contains("theta"), "{told}");
    assert!(told.contains("deg"), "{told}");
    assert!(!told.contains("nothing moves"), "{told}");
    assert!(folder.read("mine.svg").starts_with("<svg"));
    assert_eq!(folder.files(), ["mine.svg", "mine.toml"]);
}

#[test]
fn json_on_standard_output_stands_alone() {
    let folder = Folder::new();
    let told = folder
        .done(&[
            "simulate",
            "pendulum",
            "--initial",
            "theta=1",
            "--json",
            "-",
        ])
        .stdout;
    let out: serde_json::Value = serde_json::from_str(&told).expect("JSON and nothing else");
    assert_eq!(out["mechanism"], "pendulum");
}

#[test]
fn a_plain_number_is_in_the_unit_of_the_spec_however_it_is_written() {
    let folder = Folder::new();
    folder.done(&["new", "mine"]);
    let start = |value: &str| {
        let initial = format!("theta={value}");
        let run = [
            "simulate",
            "mine.toml",
            "--t-end-s",
            "0.01",
            "--json",
            "out.json",
        ];
        folder.done(&[&run[..], &["--initial", &initial]].concat());
        number(&folder.json("out.json"), "initial_state/theta")
    };
    let twenty_degrees = 20.0_f64.to_radians();
    for text in [
        "20",
        "2*10",
        "20deg",
        "20 deg",
        "20[deg]",
        "min(20, 30)",
        "pi/pi*20",
    ] {
        assert_close(start(text), twenty_degrees, 1e-15, text);
    }
    assert_close(start("0.35[rad]"), 0.35, 1e-15, "radians");
    let refused = |value: &str, says: &str| {
        let initial = format!("theta={value}");
        folder.fails(
            2,
            &["simulate", "mine.toml", "--initial", &initial],
            &[says],
        );
    };
    refused("20 + 1[m]", "cannot add");
    refused("5/l", "write units after the numbers");
    refused("2*l", "error[unit-mismatch]");
}

#[test]
fn inputs_and_laws_read_numbers_in_the_unit_of_the_spec() {
    let folder = Folder::new();
    folder.done(&["new", "mine"]);
    let spec = repository("generated/mechanisms/carriage.toml");
    let spec = std::fs::read_to_string(spec).expect("the carriage");
    let kilo = spec.replace("unit = \"N\"", "unit = \"kN\"");
    assert_ne!(kilo, spec);
    folder.write("kilo.toml", &kilo);
    let run = |arguments: &[&str]| {
        let base = [
            "simulate",
            "kilo.toml",
            "--t-end-s",
            "1",
            "--json",
            "out.json",
        ];
        folder.done(&[&base[..], arguments].concat());
        number(&folder.json("out.json"), "final_state/v")
    };
    assert_close(run(&["--input", "F=1"]), 1000.0, 1e-12, "a number");
    assert_close(
        run(&["--input", "F=if(t < 1, 0.5, 0)"]),
        500.0,
        1e-12,
        "a choice",
    );
    assert_close(run(&["--input", "F=500[N]"]), 500.0, 1e-12, "a unit");
    folder.write(
        "law.toml",
        "input = 'F'\nstates = []\ngains = []\noffset = 2\n",
    );
    assert_close(run(&["--feedback", "law.toml"]), 2000.0, 1e-12, "an offset");
    folder.fails(
        2,
        &["simulate", "kilo.toml", "--input", "F=-3*x - v"],
        &["write units after the numbers"],
    );
    run(&["--input", "F=-3[kN/m]*x - 1[kN*s/m]*v"]);
}

#[test]
fn ignored_ranges_are_ignored_at_the_start_too() {
    let folder = Folder::new();
    let run = [
        "simulate",
        "unicycle",
        "--t-end-s",
        "0.01",
        "--ignore-ranges",
    ];
    folder.done(&[&run[..], &["--initial", "theta=1.6"]].concat());
    folder.write(
        "law.toml",
        "input = 'u'\nstates = []\ngains = []\ninitial = { theta = 1.6 }\n",
    );
    folder.done(&[&run[..], &["--feedback", "law.toml"]].concat());
    folder.fails(
        3,
        &["simulate", "unicycle", "--feedback", "law.toml"],
        &["law.toml: `theta` = 1.6 rad is outside its limits"],
    );
}

#[test]
fn csv_on_standard_output_stands_alone() {
    let folder = Folder::new();
    let run = [
        "simulate",
        "pendulum",
        "--initial",
        "theta=1",
        "--dt-s",
        "5",
    ];
    let outcome = folder.done(&[&run[..], &["--csv", "-"]].concat());
    let rows: Vec<&str> = outcome
        .stdout
        .lines()
        .filter(|row| !row.starts_with('#'))
        .collect();
    assert_eq!(rows.len(), 4);
    let width = rows[0].split(',').count();
    assert!(rows.iter().all(|row| row.split(',').count() == width));
    assert!(outcome.stderr.contains("smallest"), "{}", outcome.stderr);
}

/// Columns of a CSV file with their units.
fn columns(folder: &Folder, file: &str) -> Vec<(String, String)> {
    let text = folder.read(file);
    let units = text.lines().find_map(|line| line.strip_prefix("# units: "));
    let names = text.lines().find(|line| !line.starts_with('#'));
    let names = names.expect("a header").split(',').map(str::to_owned);
    let units = units.expect("units").split(", ").map(str::to_owned);
    names.zip(units).collect()
}

#[test]
fn reactions_are_columns_with_units() {
    let folder = Folder::new();
    let run = ["simulate", "rolling_wheel", "--t-end-s", "0.1"];
    folder.done(&[&run[..], &["--reactions", "--csv", "a.csv"]].concat());
    let found = columns(&folder, "a.csv");
    let reactions: Vec<_> = found
        .iter()
        .filter(|(name, _)| name.starts_with("reaction_"))
        .collect();
    assert_eq!(reactions.len(), 3);
    assert!(
        reactions.iter().all(|(_, unit)| unit == "N"),
        "{reactions:?}"
    );
    folder.done(&[&run[..], &["--csv", "b.csv"]].concat());
    assert!(
        columns(&folder, "b.csv")
            .iter()
            .all(|(name, _)| !name.starts_with("reaction_"))
    );
}

#[test]
fn a_multiplier_has_the_unit_that_makes_it_a_power() {
    let folder = Folder::new();
    folder.write(
        "table.toml",
        r#"[mechanism]
name = "table"
title = "A block pushed over a turning table"
[parameters]
m = { value = 1, unit = "kg" }
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
[points]
P = { from = "O", in = "ground", at = ["x", "y", "0[m]"] }
[bodies]
b = { centre = "P", mass = "m" }
[constraints]
tied = { kind = "velocity", zero = "dot(y) - 2*dot(x)" }
turned = { kind = "velocity", zero = "dot(x)/1[m]", equals = "1[rad/s]" }
[pseudo_velocities]
[outputs]
"#,
    );
    let outcome = folder.run(&["simulate", "table.toml", "--reactions", "--csv", "a.csv"]);
    assert_eq!(outcome.status, 0, "{}", outcome.stderr);
    let found = columns(&folder, "a.csv");
    let unit = |name: &str| {
        found
            .iter()
            .find(|(other, _)| other == name)
            .map(|(_, unit)| unit.as_str())
    };
    assert_eq!(unit("reaction_tied_x"), Some("N"));
    assert_eq!(unit("reaction_turned_x"), Some("N*m"));
}

#[test]
fn only_the_column_whose_name_the_spec_uses_is_renamed() {
    let folder = Folder::new();
    folder.write(
        "names.toml",
        r#"[mechanism]
name = "names"
title = "A block on a moving track"
[parameters]
m = { value = 1, unit = "kg" }
[coordinates]
y = { unit = "m", initial = 7 }
[inputs]
F = { unit = "N" }
[signals]
s = { unit = "m", t = [0, 1, 2], value = [0, 1, 4], interpolation = "cubic" }
[points]
P = { from = "O", in = "ground", at = ["y + s", 0, 0] }
[bodies]
b = { centre = "P", mass = "m" }
[pseudo_velocities]
v = "dot(y)"
[loads]
push = { kind = "force", on = "P", in = "ground", vector = ["F", 0, 0] }
[outputs]
power = { value = "F*v", unit = "W" }
"#,
    );
    let run = ["simulate", "names.toml", "--t-end-s", "1", "--input", "F=1"];
    let outcome = folder.done(&[&run[..], &["--csv", "a.csv", "--plot", "a.svg"]].concat());
    let names: Vec<String> = columns(&folder, "a.csv")
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    assert_eq!(
        names,
        [
            "t",
            "v",
            "y",
            "F",
            "s",
            "s_dot",
            "s_ddot",
            "power",
            "kinetic_energy",
            "potential_energy",
            "power_2"
        ]
    );
    assert!(outcome.stderr.contains("`power_2`"), "{}", outcome.stderr);
    assert!(folder.read("a.svg").contains(">s_dot"));
    folder.done(&[
        "simulate",
        "names.toml",
        "--t-end-s",
        "1",
        "--inputs",
        "a.csv",
    ]);
}

#[test]
fn a_run_gives_up_after_the_most_steps() {
    let folder = Folder::new();
    folder.fails(
        4,
        &[
            "simulate",
            "pendulum",
            "--initial",
            "theta=1",
            "--max-steps",
            "5",
            "--csv",
            "a.csv",
            "--json",
            "out.json",
        ],
        &["the limit of 5 steps was reached", "at t = "],
    );
    assert!(folder.read("a.csv").lines().count() > 4);
    let out = folder.json("out.json");
    let cost = |what: &str| number(&out, &format!("statistics/{what}"));
    assert_close(cost("steps") + cost("rejected"), 5.0, 0.0, "steps");
}

/// A rolling wheel whose outputs are called like computed columns, and a turned coordinate without
/// a point.
fn wheel_with_hostile_names(folder: &Folder) {
    let wheel = repository("generated/mechanisms/rolling_wheel.toml");
    let text = std::fs::read_to_string(wheel).expect("a shipped mechanism");
    let text = text.replace(
        "[outputs]",
        "[inputs]\nu = { unit = 'N' }\n[loads.push]\nkind = 'force'\non = 'G'\nin = 'yawed'\n\
         vector = ['u', 0, 0]\n\
         [outputs]\n\
         normal_force_P = { value = '2[kN]', unit = 'kN' }\n\
         reaction_arm_x = { value = '5[m]', unit = 'm' }\n",
    );
    folder.write("hostile.toml", &text);
}

#[test]
fn an_output_called_like_a_computed_column_keeps_its_unit() {
    let folder = Folder::new();
    wheel_with_hostile_names(&folder);
    let run = ["simulate", "hostile.toml", "--t-end-s", "0.1"];
    folder.done(&[&run[..], &["--reactions", "--csv", "a.csv"]].concat());
    let found = columns(&folder, "a.csv");
    for (name, unit, first) in [
        ("normal_force_P", "kN", 2.0),
        ("reaction_arm_x", "m", 5.0),
        ("normal_force_P_2", "N", 98.1),
    ] {
        let place = found.iter().position(|(other, _)| other == name);
        let place = place.unwrap_or_else(|| panic!("no column {name}: {found:?}"));
        assert_eq!(found[place].1, unit, "{name}");
        let text = folder.read("a.csv");
        let mut rows = text.lines().filter(|line| !line.starts_with('#')).skip(1);
        let row = rows.next().expect("a row");
        let value = row.split(',').nth(place).and_then(|cell| cell.parse().ok());
        assert_close(value.expect("a number"), first, 1e-12, name);
    }
}

#[test]
fn a_motion_written_with_everything_can_be_fed_back() {
    let folder = Folder::new();
    wheel_with_hostile_names(&folder);
    let run = ["simulate", "hostile.toml", "--t-end-s", "0.1"];
    let all = ["--input", "u=1", "--reactions", "--conditions"];
    folder.done(&[&run[..], &all, &["--csv", "a.csv"]].concat());
    let names = columns(&folder, "a.csv");
    for computed in [
        "tangential_force_P",
        "friction_demand_P",
        "condition_mass_matrix",
    ] {
        assert!(names.iter().any(|(name, _)| name == computed), "{names:?}");
    }
    folder.done(&[&run[..], &["--inputs", "a.csv"]].concat());
    // What no motion has stays a mistake.
    let mistaken = folder
        .read("a.csv")
        .replace("tangential_force_P", "reaction_of_nothing");
    folder.write("b.csv", &mistaken);
    let refused = [&run[..], &["--inputs", "b.csv"]].concat();
    folder.fails(3, &refused, &["no input `reaction_of_nothing`"]);
}

#[test]
fn the_default_tolerance_is_that_of_the_library() {
    let folder = Folder::new();
    let tolerance = appell_runtime::integrate::Options::default();
    let help = folder.done(&["simulate", "--help"]).stdout;
    for value in [tolerance.rtol, tolerance.atol] {
        assert!(help.contains(&format!("[default: {value:e}]")), "{help}");
    }
    // What the motion of a wobbling disc loses to the default in 20 s: 6e-8 with 1e-9.
    let spun = |tolerance: &[&str], name: &str| {
        let motion = [
            "simulate",
            "rolling_wheel",
            "--initial",
            "theta=0.3",
            "--initial",
            "omega_2=10",
            "--t-end-s",
            "20",
            "--csv",
            name,
        ];
        folder.done(&[&motion[..], tolerance].concat());
        let text = folder.read(name);
        let last = text.lines().last().expect("a row").split(',');
        last.map(|value| value.parse().expect("a number"))
            .collect::<Vec<f64>>()
    };
    let own = spun(&[], "own.csv");
    let exact = spun(&["--rtol", "1e-13", "--atol", "1e-13"], "exact.csv");
    for (own, exact) in own.iter().zip(&exact) {
        assert!(
            (own - exact).abs() < 5e-9 * exact.abs().max(1.0),
            "{own}, {exact}"
        );
    }
}
