//! Data sets are read as their descriptions say, mended where that is safe, refused where it is not.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::fmt::Write as _;

use appell_recordings::{DataSet, FindingKind, Measured, NoiseSource, Part, Role, Spec, read_bare};

use crate::common::{Folder, SWING, library, pendulum, swing};

/// Rounding of a change of units.
const ROUNDING: f64 = 1e-15;

fn one_run(text: impl AsRef<[u8]>) -> Folder {
    let folder = Folder::new();
    folder.write("recording.toml", pendulum(SWING, &["run.csv"], &[]));
    folder.write("run.csv", text);
    folder
}

#[test]
fn a_data_set_is_what_its_description_says() {
    let folder = Folder::new();
    let channels = format!("{SWING}\nroom = {{ unit = \"K\" }}");
    folder.write(
        "recording.toml",
        pendulum(&channels, &["a.csv", "b.csv"], &["c.csv"]),
    );
    for name in ["a.csv", "b.csv", "c.csv"] {
        let text = swing(200, 1, 1e-3);
        let text = text.replace('\n', ",290\n").replace("tau,290", "tau,room");
        folder.write(name, text);
    }
    let set = folder.read().unwrap();
    let parts: Vec<Part> = set.runs.iter().map(|run| run.part).collect();
    assert_eq!(parts, [Part::Fit, Part::Fit, Part::Test]);
    let roles: Vec<Role> = set.channels.iter().map(|c| c.role).collect();
    assert_eq!(
        roles,
        [
            Role::Measures(Measured::Coordinate(0)),
            Role::Input(0),
            Role::Recorded
        ]
    );
    let names = set.mechanism.parameters.iter().map(|p| &*p.label.name);
    let mass = names.clone().position(|name| name == "m").unwrap();
    let length = names.clone().position(|name| name == "l").unwrap();
    assert_eq!(set.parameters[mass].std, Some(0.1));
    assert!((set.parameters[mass].value - 1.2).abs() < ROUNDING);
    assert_eq!(set.parameters[length].std, None);
    assert_eq!(set.runs[0].times.len(), 200);
    assert!((set.runs[0].sampling.step - 0.01).abs() < 1e-12);
}

#[test]
fn a_tolerance_of_the_spec_counts_where_the_description_states_none() {
    let folder = Folder::new();
    let shipped = library().iter().find(|(name, _)| *name == "pendulum");
    let (_, spec) = shipped.unwrap();
    let text = spec
        .text
        .replace("about = \"mass of the rod\"", "std = 0.3")
        .replace(
            "value = 0.5,  unit = \"m\"",
            "value = 500, unit = \"mm\", std = 2",
        );
    folder.write("own.toml", text);
    let description = pendulum(SWING, &["a.csv"], &[]).replace("\"pendulum\"", "\"own.toml\"");
    folder.write("recording.toml", description);
    folder.write("a.csv", swing(200, 1, 1e-3));
    let set = folder.read().unwrap();
    let names = set.mechanism.parameters.iter().map(|p| &*p.label.name);
    let stds: Vec<_> = names
        .zip(set.parameters.iter().map(|own| own.std))
        .collect();
    let stated = [
        ("m", Some(0.1)),
        ("l", Some(0.002)),
        ("I", None),
        ("g", None),
    ];
    assert_eq!(stds, stated);
}

#[test]
fn values_are_in_si_whatever_the_unit_of_the_file() {
    let folder = Folder::new();
    let channels = "theta = { measures = \"theta\", unit = \"deg\", noise_std = 0.1 }\n\
                    tau = { input = \"tau\", unit = \"N mm\" }";
    folder.write("recording.toml", pendulum(channels, &["run.csv"], &[]));
    let mut text = "t,theta,tau\n".to_owned();
    for i in 0..20 {
        writeln!(text, "{},{},{}", i, 10 * (i % 3), 500).unwrap();
    }
    folder.write("run.csv", text);
    let set = folder.read().unwrap();
    let [theta, tau] = &set.runs[0].values[..] else {
        panic!("two channels")
    };
    assert!((theta[1] - 10f64.to_radians()).abs() < ROUNDING);
    assert!((tau[1] - 0.5).abs() < ROUNDING);
    let stated = set.channels[0].stated_noise.unwrap();
    assert!((stated - 0.1f64.to_radians()).abs() < ROUNDING);
}

#[test]
fn all_mistakes_of_a_description_are_told_at_once_with_what_to_write_instead() {
    let folder = Folder::new();
    folder.write(
        "recording.toml",
        r#"mechanism = "pendulum"
descripton = "a slip"
[parameters]
mass = { value = 1, unit = "kg" }
l = { value = 1, unit = "kg" }
g = { value = 9.81, unit = "m/s^2", std = -1 }
[channels]
theta = { measures = "thta", unit = "rad" }
omega = { measures = "omega", unit = "rpn" }
tau = { measures = "tau", unit = "N m" }
both = { measures = "theta", input = "tau" }
t = { measures = "theta" }
[runs]
fit = ["run.csv", "../other.csv"]
test = ["run.csv"]
"#,
    );
    let told = folder.refused();
    for expected in [
        "unknown key `descripton`",
        "did you mean `description`?",
        "the spec has no parameter `mass`",
        "`l` is a length, `kg` is a mass",
        "recording.toml:5:",
        "`std` is a standard deviation",
        "no coordinate, pseudo-velocity or output `thta`",
        "did you mean `theta`?",
        "unknown unit `rpn`",
        "`tau` is an input",
        "write input = \"tau\"",
        "a channel has `measures` or `input`, not both",
        "`t` is the time",
        "`../other.csv` is not below",
        "the run `run.csv` stands here twice",
        "a run that is held out may not be fitted",
    ] {
        assert!(
            told.contains(expected),
            "`{expected}` is missing in\n{told}"
        );
    }
}

#[test]
fn what_is_no_description_is_refused() {
    let folder = Folder::new();
    assert!(folder.refused().contains("holds no recording.toml"));
    for (text, expected) in [
        ("", "the key `mechanism` is missing"),
        ("mechanism = ", "recording.toml:1:"),
        ("mechanism = \"pendulm\"", "did you mean `pendulum`?"),
        (
            "mechanism = \"pendulum\"",
            "the section `[channels]` is missing",
        ),
        (
            "mechanism = \"pendulum\"\n[channels]\ntau = { input = \"tau\" }\n[runs]\nfit = []",
            "no channel measures anything",
        ),
        (
            "mechanism = 1\n[channels]\nx = 1\n[runs]\nfit = 3",
            "expected a string",
        ),
    ] {
        folder.write("recording.toml", text);
        let told = folder.refused();
        assert!(told.contains(expected), "{text}:\n{told}");
    }
    folder.write("recording.toml", [0xff, 0xfe]);
    assert!(folder.refused().contains("not UTF-8"));
}

#[test]
fn a_spec_of_ones_own_is_found_beside_the_description_and_its_mistakes_are_told() {
    let folder = Folder::new();
    let (_, spec) = library().iter().find(|(n, _)| *n == "pendulum").unwrap();
    let description = pendulum(SWING, &["run.csv"], &[]);
    let description = description.replace("\"pendulum\"", "\"mine.toml\"");
    folder.write("recording.toml", description);
    folder.write("run.csv", swing(50, 1, 1e-3));
    folder.write("mine.toml", &spec.text);
    assert_eq!(folder.read().unwrap().mechanism.name, "pendulum");
    folder.write("mine.toml", spec.text.replace("kg", "kilo"));
    let told = folder.refused();
    assert!(told.contains("mine.toml") && told.contains("unknown unit"));
}

#[test]
fn bad_recordings_are_refused_with_file_line_and_column() {
    let good = swing(60, 1, 1e-3);
    let row = "0.30,";
    let with = |replacement: &str| good.replacen(row, replacement, 1);
    let cases: [(String, &[&str]); 15] = [
        (String::new(), &["run.csv: the file is empty"]),
        ("t,theta,tau\n".to_owned(), &["0 rows", "needs 8"]),
        ("t,theta,tau\n0,0,0\n".to_owned(), &["1 row;"]),
        (
            good.replace("theta", "tetha"),
            &["run.csv:1:1", "no column `theta`", "did you mean `tetha`?"],
        ),
        (
            good.replace("tau", "theta"),
            &["`theta` stands here twice", "no column `tau`"],
        ),
        (
            good.replace("t,theta", "clock,theta"),
            &[
                "no column of the times",
                "clock = { time = true, unit = \"s\" }",
            ],
        ),
        (with("0.30,,"), &["run.csv:32:1", "4 cells under 3 columns"]),
        (
            with("0.30,left"),
            &[
                "run.csv:32:6",
                "is not a finite number",
                "leave the cell empty",
            ],
        ),
        (with("0.30,inf\"\","), &["run.csv:32"]),
        (
            with("12:30,"),
            &[
                "run.csv:32:1",
                "`12:30` is not a finite number",
                "seconds since the first row",
            ],
        ),
        (
            with("2024-01-01T00:00:00.3Z,"),
            &["run.csv:32:1", "seconds since the first row"],
        ),
        (
            good.replace(',', ";").replace("0.30;", "0,30;"),
            &["with a decimal point: `0.30`"],
        ),
        (good.replace("0.30,", "0.30,\u{1}"), &["run.csv:32"]),
        (
            format!("{good}{}", good.replace("t,theta,tau\n", "")),
            &["run.csv:62:1", "the time goes back", "split the file"],
        ),
        (good.replace("0.4", "0.3"), &["the time goes back"]),
    ];
    for (text, expected) in cases {
        let told = one_run(&text).refused();
        for expected in expected {
            assert!(
                told.contains(expected),
                "`{expected}` is missing in\n{told}"
            );
        }
    }
    let told = one_run(b"t,theta,tau\n0,\xff,0\n").refused();
    assert!(told.contains("run.csv:2: the line is not UTF-8"), "{told}");
    let told = one_run(format!("t,theta,tau\n{}", "1,".repeat(1 << 16))).refused();
    assert!(told.contains("run.csv:2: the line has more than"), "{told}");
    let nothing = good.lines().map(|line| match line.split_once(',') {
        Some((t, _)) if t != "t" => format!("{t},nan,0\n"),
        _ => format!("{line}\n"),
    });
    let told = one_run(nothing.collect::<String>()).refused();
    assert!(told.contains("`theta` holds no value"), "{told}");
    let folder = Folder::new();
    folder.write("recording.toml", pendulum(SWING, &["gone.csv"], &[]));
    assert!(folder.refused().contains("cannot read"));
}

#[test]
fn slips_of_a_logger_are_mended_and_told() {
    let good = swing(300, 1, 1e-3);
    let mut text = good
        .replacen("\n0.30,", "\n0.29,", 1)
        .replacen("\n0.50,", "\n0.47,", 1)
        .replacen("\n0.70,", "\n,", 1);
    // A dropout of both channels, and a logger that was switched off within a line.
    let dropout = text.find("\n1.00,").unwrap();
    let end = text[dropout + 1..].find('\n').unwrap() + dropout + 1;
    text.replace_range(dropout..end, "\n1.00, ,NaN");
    text.push_str("3.00,0.1");
    let set = one_run(&text).read().unwrap();
    let run = &set.runs[0];
    assert_eq!(run.times.len(), 297);
    assert!(run.times.windows(2).all(|pair| pair[0] < pair[1]));
    let row = run
        .times
        .iter()
        .position(|t| (t - 1.0).abs() < 1e-9)
        .unwrap();
    assert!(run.values[0][row].is_nan());
    assert!((run.values[1][row] - run.values[1][row - 1]).abs() < ROUNDING);
    let found = |kind| {
        let finding = set.findings.iter().find(|finding| finding.kind == kind);
        finding.unwrap_or_else(|| panic!("{kind:?} is not told: {:?}", set.findings))
    };
    assert_eq!(found(FindingKind::RepeatedTime).line, Some(32));
    assert_eq!(found(FindingKind::BackwardTime).line, Some(52));
    assert_eq!(found(FindingKind::MissingTime).line, Some(72));
    assert_eq!(found(FindingKind::CutOff).line, Some(302));
    assert_eq!(
        found(FindingKind::Dropouts).channel.as_deref(),
        Some("theta")
    );
    assert_eq!(
        found(FindingKind::HeldInput).channel.as_deref(),
        Some("tau")
    );
    assert_eq!(
        found(FindingKind::HeldInput).run.as_deref(),
        Some("run.csv")
    );
}

#[test]
fn gaps_extra_columns_and_angles_that_start_anew_are_told() {
    let mut text = "t;\"theta\";tau;spare\n".to_owned();
    for i in 0..300 {
        let t = f64::from(i) * 0.01 + if i < 150 { 0.0 } else { 0.5 };
        let theta = (5.0 * t + 3.0).rem_euclid(std::f64::consts::TAU);
        writeln!(text, "{t:.3};{theta:.9};\"0\";x").unwrap();
    }
    let set = one_run(&text).read().unwrap();
    // What the input was in the gap is not known.
    let names: Vec<&str> = set.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!(names, ["run.csv#1", "run.csv#2"]);
    for run in &set.runs {
        for (t, theta) in run.times.iter().zip(&run.values[0]) {
            assert!((theta - 5.0 * t - 3.0).abs() < 1e-6);
        }
        assert_eq!((run.times.len(), run.sampling.gaps.len()), (150, 0));
    }
    let kinds: Vec<FindingKind> = set.findings.iter().map(|f| f.kind).collect();
    for kind in [
        FindingKind::Gap,
        FindingKind::Cut,
        FindingKind::UnknownColumn,
        FindingKind::Unwrapped,
        FindingKind::Constant,
    ] {
        assert!(kinds.contains(&kind), "{kind:?} is not among {kinds:?}");
    }
}

#[test]
fn a_stated_noise_level_is_held_against_the_data() {
    let noise = |stated: &str| {
        let folder = Folder::new();
        let channels = SWING.replace("\"rad\"", &format!("\"rad\"{stated}"));
        folder.write("recording.toml", pendulum(&channels, &["run.csv"], &[]));
        folder.write("run.csv", swing(2000, 1, 1e-3));
        let set = folder.read().unwrap();
        let disagrees = set
            .findings
            .iter()
            .any(|finding| finding.kind == FindingKind::NoiseDisagrees);
        (set.channels[0].noise.unwrap(), disagrees)
    };
    for stated in ["", ", noise_std = 1.8e-3", ", noise_std = 0.6e-3"] {
        let (noise, disagrees) = noise(stated);
        assert_eq!(noise.source, NoiseSource::Differences);
        assert!((noise.std / 1e-3 - 1.0).abs() < 0.1, "{noise:?}");
        assert!(!disagrees);
    }
    for (stated, used) in [("1e-2", 5e-3), ("1e-4", 2e-4)] {
        let (noise, disagrees) = noise(&format!(", noise_std = {stated}"));
        assert!((noise.std / used - 1.0).abs() < 1e-3, "{noise:?}");
        assert!(disagrees, "{noise:?}");
    }
}

#[test]
fn the_steps_of_an_encoder_are_found() {
    let step = 1.534e-3;
    let mut text = "t,theta,tau\n".to_owned();
    for i in 0..1000 {
        let t = f64::from(i) * 0.01;
        let theta = (0.4 * (2.0 * t).sin() / step).round() * step;
        writeln!(text, "{t:.2},{theta:.6},{}", i % 2).unwrap();
    }
    let set = one_run(&text).read().unwrap();
    let noise = set.channels[0].noise.unwrap();
    assert!((noise.quantum.unwrap() / step - 1.0).abs() < 1e-3);
    assert!(noise.std >= 0.999 * step / 12f64.sqrt(), "{noise:?}");
    let told = set
        .findings
        .iter()
        .any(|f| f.kind == FindingKind::Quantised);
    assert!(told);
}

#[test]
fn held_out_runs_change_no_noise_level() {
    let noise = |std| {
        let folder = Folder::new();
        folder.write("recording.toml", pendulum(SWING, &["a.csv"], &["b.csv"]));
        folder.write("a.csv", swing(500, 1, 1e-3));
        folder.write("b.csv", swing(500, 1, std));
        folder.read().unwrap().channels[0].noise
    };
    assert_eq!(noise(1e-3), noise(1e-1));
}

#[test]
fn files_without_a_description_are_read_by_the_names_of_the_spec() {
    let folder = Folder::new();
    let names = ["a.csv", "b.csv", "c.csv"];
    for name in names {
        folder.write(name, swing(900, 1, 1e-3));
    }
    let spec = || -> Spec {
        let found = library().iter().find(|(name, _)| *name == "pendulum");
        found.unwrap().1.clone()
    };
    let paths: Vec<_> = names.iter().map(|name| folder.path(name)).collect();
    let parts = |count: usize| {
        let set = read_bare(spec(), &paths[..count]).unwrap();
        assert!(set.channels[0].noise.is_some());
        let told = set.findings.iter().any(|f| f.kind == FindingKind::Split);
        assert!(told);
        set.runs
            .iter()
            .map(|run| (run.part, run.times.len()))
            .collect::<Vec<_>>()
    };
    let (fit, test) = (Part::Fit, Part::Test);
    assert_eq!(parts(3), [(fit, 900), (fit, 900), (test, 900)]);
    assert_eq!(parts(2), [(fit, 900), (test, 900)]);
    // The last third of 8.99 s begins at 5.99 s; a second of it lies between.
    assert_eq!(parts(1), [(fit, 600), (test, 200)]);
    folder.write("short.csv", swing(30, 1, 1e-3));
    let short = read_bare(spec(), &[folder.path("short.csv")]).unwrap();
    assert_eq!(short.runs.len(), 1);
    assert!(
        short
            .findings
            .iter()
            .any(|f| f.kind == FindingKind::NoTestRun)
    );
    folder.write("other.csv", "t,speed\n0,1\n");
    let told = read_bare(spec(), &[folder.path("other.csv")]).unwrap_err();
    assert!(
        told.to_string()
            .contains("no column is a quantity of `pendulum`")
    );
    assert!(read_bare(spec(), &[]).is_err());
}

#[test]
fn files_of_motive_are_read_by_bodies_and_axes() {
    let folder = Folder::new();
    let channels = "\"arm.Rotation.X\" = { measures = \"theta\", unit = \"deg\" }";
    folder.write("recording.toml", pendulum(channels, &["run.csv"], &[]));
    let mut text = "Format Version,1.23,Take Name,swing,Length Units,Meters\n\n\
                    ,Type,Rigid Body,Rigid Body,Rigid Body\n,Name,arm,arm,arm\n\
                    ,ID,\"9A,1\",\"9A,1\",\"9A,1\"\n,,Rotation,Position,Mean Marker Error\n\
                    Frame,Time (Seconds),X,X,\n"
        .to_owned();
    for i in 0..50 {
        writeln!(text, "{i},{:.6},{},{},", f64::from(i) / 120.0, i % 7, 0.1).unwrap();
    }
    folder.write("run.csv", text);
    let set = folder.read().unwrap();
    assert!((set.runs[0].values[0][3] - 3f64.to_radians()).abs() < ROUNDING);
    let told = set
        .findings
        .iter()
        .find(|f| f.kind == FindingKind::UnknownColumn);
    let told = &told.unwrap().message;
    assert!(
        told.contains("Frame, arm.Position.X, arm.Mean Marker Error"),
        "{told}"
    );
    folder.write("run.csv", "Format Version,1.23\n,Name,arm\n");
    assert!(
        folder
            .refused()
            .contains("no line that begins with `Frame`")
    );
}

#[test]
fn inputs_are_joined_by_lines_where_the_description_says_so() {
    let folder = Folder::new();
    folder.write("run.csv", swing(200, 1, 1e-3));
    let read = |line: &str| {
        let channels = format!("theta = {{ measures = \"theta\", unit = \"rad\" }}\n{line}");
        folder.write("recording.toml", pendulum(&channels, &["run.csv"], &[]));
        folder.read()
    };
    let joined = |key: &str| {
        let line = format!("tau = {{ input = \"tau\", unit = \"N m\"{key} }}");
        read(&line).unwrap().channels[1].is_joined()
    };
    assert!(joined(", interpolation = \"linear\"") && joined(", interpolation = \"cubic\""));
    assert!(!joined(", interpolation = \"hold\"") && !joined(""));
    for (line, told) in [
        (
            "tau = { input = \"tau\", unit = \"N m\", interpolation = \"quintic\" }",
            "`quintic` is no interpolation of an input",
        ),
        (
            "tau = { unit = \"N m\", interpolation = \"linear\" }",
            "only inputs run on between rows",
        ),
    ] {
        let error = read(line).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn an_input_that_changes_smoothly_is_told_with_what_half_a_row_does() {
    let rows = |every: usize| {
        let mut text = String::from("t,theta,tau\n");
        for row in (0..400).step_by(every) {
            let t = 0.005 * f64::from(row);
            writeln!(text, "{t},{},{}", (3.0 * t).sin(), 2.0 * (20.0 * t).sin()).unwrap();
        }
        text
    };
    let told = |set: &DataSet| {
        let mut findings = set.findings.iter();
        let found = findings.find(|finding| finding.kind == FindingKind::SmoothInput);
        found.map(|finding| finding.message.clone())
    };
    let folder = one_run(rows(1));
    let message = told(&folder.read().unwrap()).unwrap();
    // ω h / 2 of its size.
    for part in ["2.500 ms", "4.9", "\"linear\" or \"cubic\""] {
        assert!(message.contains(part), "{message}");
    }
    let stated = SWING.replace("\"N m\"", "\"N m\", interpolation = \"hold\"");
    folder.write("recording.toml", pendulum(&stated, &["run.csv"], &[]));
    assert_eq!(told(&folder.read().unwrap()), None);
    // Lines are (ω h)²/12 of the size off.
    let stated = SWING.replace("\"N m\"", "\"N m\", interpolation = \"linear\"");
    folder.write("recording.toml", pendulum(&stated, &["run.csv"], &[]));
    assert_eq!(told(&folder.read().unwrap()), None);
    folder.write("run.csv", rows(4));
    let message = told(&folder.read().unwrap()).unwrap();
    for part in ["1.3", "interpolation = \"cubic\""] {
        assert!(message.contains(part), "{message}");
    }
    folder.write("recording.toml", pendulum(SWING, &["run.csv"], &[]));
    folder.write("run.csv", swing(400, 1, 1e-3));
    assert_eq!(told(&folder.read().unwrap()), None);
}

#[test]
fn an_angle_far_beyond_a_turn_is_not_unwrapped() {
    let folder = Folder::new();
    // Four degrees a row, which were taken for radians.
    let rows = (0..60).map(|row| format!("{},{},0", 0.01 * f64::from(row), 4 * row));
    let rows: Vec<String> = rows.collect();
    folder.write("run.csv", format!("t,theta,tau\n{}\n", rows.join("\n")));
    folder.write("recording.toml", pendulum(SWING, &["run.csv"], &[]));
    let set = folder.read().unwrap();
    let last = set.runs[0].values[0].last().copied();
    assert_eq!(last, Some(236.0));
    assert!(
        set.findings
            .iter()
            .all(|finding| finding.kind != FindingKind::Unwrapped)
    );
}

#[cfg(unix)]
#[test]
fn files_elsewhere_and_what_is_no_file_are_not_opened() {
    let secret = Folder::new();
    secret.write("secret.csv", "t,theta,tau\nroot:x:0:0,1,2\n");
    let folder = one_run(swing(60, 1, 1e-3));
    let link = |from: &std::path::Path| {
        std::fs::remove_file(folder.path("run.csv")).unwrap();
        std::os::unix::fs::symlink(from, folder.path("run.csv")).unwrap();
    };
    link(&secret.path("secret.csv"));
    let message = folder.refused();
    assert!(message.contains("is not below"), "{message}");
    assert!(!message.contains("root:x"), "{message}");
    link(std::path::Path::new("/dev/zero"));
    let message = folder.refused();
    assert!(message.contains("is not below"), "{message}");
    std::fs::remove_file(folder.path("run.csv")).unwrap();
    let socket = std::os::unix::net::UnixListener::bind(folder.path("run.csv"));
    // A path may be too long for a socket.
    if socket.is_ok() {
        let message = folder.refused();
        assert!(message.contains("name a regular file"), "{message}");
        std::fs::remove_file(folder.path("run.csv")).unwrap();
    }
    std::fs::create_dir(folder.path("run.csv")).unwrap();
    assert!(folder.refused().contains("this is a folder"));
    let text = std::fs::read_to_string(folder.path("recording.toml")).unwrap();
    for spec in ["/etc/passwd", "../secret.toml"] {
        folder.write(
            "recording.toml",
            text.replace("\"pendulum\"", &format!("{spec:?}")),
        );
        let message = folder.refused();
        assert!(message.contains("is not below"), "{message}");
        assert!(!message.contains("root:"), "{message}");
    }
}
