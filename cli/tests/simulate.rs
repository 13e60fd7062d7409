//! `appell simulate`: manoeuvres, inputs, failures.

mod support;

use support::{Folder, assert_close, number, repository};

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
