//! The other commands, from a new user's first to the last.

use crate::support::{self, Folder};

#[test]
fn list_names_every_shipped_mechanism() {
    let folder = Folder::new();
    let told = folder.done(&["list"]).stdout;
    folder.done(&["list", "--json", "list.json"]);
    let list = folder.json("list.json");
    let all = list["mechanisms"].as_array().expect("a list");
    assert!(all.len() >= 8);
    for mechanism in all {
        assert!(told.contains(mechanism["name"].as_str().expect("a name")));
    }
    let unicycle = all
        .iter()
        .find(|m| m["name"] == "unicycle")
        .expect("the unicycle");
    assert_eq!(unicycle["degrees_of_freedom"], 4);
    assert_eq!(unicycle["inputs"], serde_json::json!(["u"]));
}

#[test]
fn new_writes_a_spec_that_checks_and_never_overwrites() {
    let folder = Folder::new();
    folder.done(&["new", "arm"]);
    let told = folder.done(&["check", "arm.toml"]);
    assert!(
        told.stdout.contains("degrees of freedom    2: v, omega"),
        "{}",
        told.stdout
    );
    assert!(told.stderr.is_empty(), "{}", told.stderr);
    let before = folder.read("arm.toml");
    folder.write("arm.toml", &(before + "# mine\n"));
    folder.fails(2, &["new", "arm"], &["arm.toml already exists"]);
    assert!(folder.read("arm.toml").ends_with("# mine\n"));
    folder.fails(2, &["new", "../up"], &["not a valid name"]);
}

#[test]
fn a_thorough_check_tells_what_was_proven_against_whom() {
    let folder = Folder::new();
    let command = ["check", "--thorough", "unicycle", "--json", "check.json"];
    let told = folder.done(&command).stdout;
    for text in [
        "three formulations    agree",
        "Kane                proved identical: mass matrix, bias, forces, accelerations",
        "Lagrange            proved identical: accelerations, constraint forces",
        "probability that any of them is false: below",
    ] {
        assert!(told.contains(text), "{text} is missing in\n{told}");
    }
    let thorough = &folder.json("check.json")["specs"][0]["thorough"];
    assert_eq!(thorough["agrees"], true);
    assert!(thorough["error_bound"].as_f64().expect("a bound") < 1e-12);
    assert!(thorough["seconds"].as_f64().expect("a time") >= 0.0);
    let comparisons = thorough["comparisons"].as_array().expect("a list");
    assert!(comparisons.iter().any(|c| {
        c["against"] == "Lagrange" && c["quantity"] == "accelerations" && c["method"] == "identity"
    }));
    // Without the flag nobody waits for it.
    folder.done(&["check", "unicycle", "--json", "quick.json"]);
    assert!(folder.json("quick.json")["specs"][0]["thorough"].is_null());
}

#[test]
fn typed_equations_are_compared_as_functions() {
    let folder = Folder::new();
    let check = |equation: &'static str| {
        [
            "check",
            "pendulum",
            "--equation",
            equation,
            "--json",
            "check.json",
        ]
    };
    let told = folder.done(&check("dot(omega) = (tau/l - m*g*sin(theta))/(I/l + m*l)"));
    assert!(
        told.stdout.contains("dot(omega)        identical"),
        "{}",
        told.stdout
    );
    let typed = &folder.json("check.json")["specs"][0]["typed"];
    assert_eq!(typed["equations"][0]["result"], "identical");
    assert!(typed["error_bound"].as_f64().expect("a bound") < 1e-9);

    // The identity test does not know the sign of a root.
    let told = folder.done(&check("dot(theta) = omega*sqrt(m^2)/m"));
    assert!(
        told.stdout.contains("dot(theta)        equal at"),
        "{}",
        told.stdout
    );

    let wrong = check("dot(omega) = (tau + m*g*l*sin(theta))/(I + m*l^2)");
    folder.fails(4, &wrong, &["a typed equation is not the derived one"]);
    let spec = &folder.json("check.json")["specs"][0];
    assert_eq!(spec["ok"], false);
    assert_eq!(spec["typed"]["equations"][0]["result"], "different");

    folder.fails(
        2,
        &check("dot(thet) = omega"),
        &["--equation", "no state `thet`", "`theta`"],
    );
    folder.fails(2, &check("dot(theta) = omga"), &["omga", "`omega`"]);
    folder.fails(2, &check("dot(theta) = omega/0"), &["division by zero"]);
    folder.fails(2, &check("omega"), &["write `dot(NAME) = EXPRESSION`"]);
}

#[test]
fn a_thorough_check_without_time_says_what_it_did_not_compare() {
    let folder = Folder::new();
    let check = [
        "check",
        "--thorough",
        "pendulum",
        "--time-limit-s",
        "0",
        "--json",
        "check.json",
    ];
    let parts = [
        "the time limit of 0 s was exceeded",
        "compared and equal: nothing",
        "Kane: mass matrix",
        "Lagrange: accelerations",
        "allow more time",
    ];
    folder.fails(4, &check, &parts);
    let spec = &folder.json("check.json")["specs"][0];
    assert_eq!(spec["ok"], false);
    assert!(spec["thorough"]["comparisons"][0]["agrees"].is_null());
    let negative = ["check", "--thorough", "pendulum", "--time-limit-s=-1"];
    folder.fails(
        2,
        &negative,
        &["--time-limit-s", "must be a non-negative number of seconds"],
    );
}

#[test]
fn a_thorough_check_fails_where_nothing_can_be_compared() {
    let folder = Folder::new();
    folder.write(
        "nowhere.toml",
        "[mechanism]\nname = 'nowhere'\ntitle = 'a mass nowhere'\n\
         [parameters]\nm = { value = 1, unit = 'kg' }\nl = { value = 1, unit = 'm' }\n\
         [coordinates]\nx = { unit = 'm', initial = 0.1 }\n\
         [points]\nP = { from = 'O', in = 'ground', at = ['x', 0, 0] }\n\
         Q = { from = 'O', in = 'ground', at = ['2*l', 0, 0] }\n\
         [bodies]\nb = { centre = 'P', mass = 'm' }\n\
         [pseudo_velocities]\nv = 'dot(x)'\n\
         [loads]\nleft = { kind = 'spring', between = ['O', 'P'], stiffness = '3 [N/m]*sqrt(-m/(1 [kg]))', relaxed = 'l' }\n\
         right = { kind = 'spring', between = ['P', 'Q'], stiffness = '3 [N/m]', relaxed = 'l' }\n",
    );
    let parts = ["could not be compared", "declare a `range`"];
    folder.fails(4, &["check", "--thorough", "nowhere.toml"], &parts);
}

#[test]
fn check_tells_what_a_mechanism_is() {
    let folder = Folder::new();
    let told = folder
        .done(&["check", "unicycle", "--json", "check.json"])
        .stdout;
    for text in [
        "4: omega_1",
        "2: rolling.x, rolling.y",
        "rolling.z",
        "{omega_1, sigma} {omega_2, omega_3}",
    ] {
        assert!(told.contains(text), "{text} is missing in\n{told}");
    }
    assert_eq!(
        folder.json("check.json")["specs"][0]["degrees_of_freedom"],
        4
    );
}

#[test]
fn check_reports_all_mistakes_of_all_specs() {
    let folder = Folder::new();
    folder.done(&["new", "good"]);
    let good = folder.read("good.toml");
    folder.write(
        "units.toml",
        &good.replace(
            "l       = { value = 0.4,  unit = \"m\"",
            "l       = { value = 0.4,  unit = \"kg\"",
        ),
    );
    folder.write(
        "speeds.toml",
        &good.replace(
            "omega = { value = \"dot(theta)\", unit = \"deg/s\"",
            "omega = { value = \"2*dot(x)\", unit = \"m/s\"",
        ),
    );
    let outcome = folder.fails(
        3,
        &[
            "check",
            "units.toml",
            "good.toml",
            "speeds.toml",
            "--json",
            "check.json",
        ],
        &[
            "error[unit-mismatch]",
            "--> units.toml:",
            "help:",
            "error[singular-pseudo-velocities]",
            "--> speeds.toml:",
        ],
    );
    assert!(outcome.stdout.contains("good.toml"));
    let specs = folder.json("check.json")["specs"].clone();
    assert_eq!(specs[0]["ok"], false);
    assert_eq!(specs[0]["findings"][0]["code"], "unit-mismatch");
    assert_eq!(specs[1]["ok"], true);
    assert_eq!(specs[2]["ok"], false);
}

#[test]
fn derive_writes_every_format_and_stage() {
    let folder = Folder::new();
    let mut last = 0;
    for stage in ["kinematics", "energy", "equations", "jacobians", "all"] {
        let page = folder
            .done(&["derive", "unicycle", "--stage", stage])
            .stdout;
        assert!(page.len() > last, "{stage} holds everything before it");
        last = page.len();
    }
    folder.done(&[
        "derive",
        "unicycle",
        "--format",
        "html",
        "--out",
        "page.html",
    ]);
    assert!(folder.read("page.html").starts_with("<!"));
    let latex = folder
        .done(&["derive", "unicycle", "--format", "latex"])
        .stdout;
    assert!(latex.contains("\\documentclass"), "{latex}");
    let rust = folder
        .done(&["derive", "unicycle", "--format", "rust"])
        .stdout;
    assert!(rust.contains("pub fn mass_matrix<T: Real>"));
}

#[test]
fn derive_writes_the_linear_equations_about_a_steady_motion() {
    let folder = Folder::new();
    let about = |conditions: &str| {
        let arguments = [
            "derive", "unicycle", "--stage", "linear", "--about", conditions,
        ];
        folder.done(&arguments).stdout
    };
    // The names of pseudo-velocities, of rates and of coordinates say the same.
    let straight = about("theta=0, r=0, dot(psi)=0, u=0");
    assert!(straight.contains("A₁,₅ = 4 g/(5 R)"), "{straight}");
    assert!(straight.contains("χ = λ² (λ⁴ + χ₂ λ² + χ₄)"), "{straight}");
    let again = about("omega_1=0, sigma=0, omega_3=0, r=0[m], theta=0, u=0");
    assert_eq!(straight, again);
    let rest = about("omega_2 = 0, theta=0, r=0, psi_dot=0, u=0");
    assert!(rest.contains("φ\u{307} = 0"), "{rest}");
    let solved = about("u=0, dot(phi)=-dot(psi)*sin(theta)");
    assert!(solved.contains("ω₂ = 0"), "{solved}");
}

#[test]
fn joints_are_written_out() {
    let folder = Folder::new();
    let spec = "\
[mechanism]
name  = 'swing'
title = 'a pendulum on a cart'
[parameters]
m = { value = 2, unit = 'kg' } # both
l = { value = 0.5, unit = 'm' }
g = { value = 9.81, unit = 'm/s^2' }
[joints]
# on the rail
cart = { kind = 'prismatic', axis = 'x' }
rod  = { kind = 'revolute', parent = 'cart', axis = [0, -1, 0], coordinate = 'theta' }
[points]
G = { from = 'rod', in = 'rod', at = [0, 0, '-l'] }
[bodies]
cart = { centre = 'cart', mass = 'm' }
bob  = { centre = 'G', mass = 'm' }
[loads]
weight = { kind = 'gravity', down = '-z', acceleration = 'g' }
";
    folder.write("swing.toml", spec);
    let shown = folder
        .done(&["derive", "swing.toml", "--format", "spec"])
        .stdout;
    folder.done(&["derive", "swing.toml", "--out", "whole.toml"]);
    assert_eq!(folder.read("whole.toml"), shown);
    assert!(
        shown.contains("# both") && shown.contains("# on the rail"),
        "{shown}"
    );
    assert!(
        !shown.contains("joints") && shown.contains("by = \"theta\""),
        "{shown}"
    );
    // Before that stand the lines of the spec.
    let equations = |file: &str| {
        let page = folder.done(&["derive", file, "--stage", "all"]).stdout;
        let equations = page.split_once("Appell's equations, solved");
        equations.expect("equations").1.to_owned()
    };
    assert_eq!(equations("swing.toml"), equations("whole.toml"));
    folder.write("bad.toml", &spec.replace("'cart', axis", "'cat', axis"));
    folder.fails(
        3,
        &["derive", "bad.toml", "--format", "spec"],
        &["bad.toml:11:38"],
    );
}

#[test]
fn derived_rust_is_that_of_the_shipped_module() {
    let folder = Folder::new();
    let shipped = folder
        .done(&["derive", "pendulum", "--format", "rust"])
        .stdout;
    let spec = support::repository("generated/mechanisms/pendulum.toml");
    let derived = folder.done(&["derive", &spec, "--format", "rust"]).stdout;
    // Comments name the file without its folder.
    assert_eq!(
        shipped.replace("mechanisms/pendulum.toml", "pendulum.toml"),
        derived
    );
}

#[test]
fn a_drawing_is_named_after_its_mechanism_or_goes_where_it_is_sent() {
    let folder = Folder::new();
    folder.done(&["draw", "pendulum"]);
    let svg = folder.read("pendulum.svg");
    assert!(
        svg.starts_with("<svg ") && svg.contains(">G (rod)<"),
        "{svg}"
    );
    assert_eq!(folder.done(&["draw", "pendulum", "--out", "-"]).stdout, svg);
    folder.done(&["draw", "pendulum", "--out", "drawn.svg"]);
    assert_eq!(folder.read("drawn.svg"), svg);
    assert_eq!(folder.files(), ["drawn.svg", "pendulum.svg"]);
}

#[test]
fn the_demo_writes_what_it_says() {
    let folder = Folder::new();
    let told = folder.done(&["demo", "--out", "demo"]).stdout;
    for name in [
        "unicycle.html",
        "unicycle.rs",
        "lane_change.csv",
        "lane_change.svg",
        "path.svg",
    ] {
        assert!(told.contains(name), "{name} is missing in\n{told}");
        assert!(!folder.read(&format!("demo/{name}")).is_empty());
    }
    let header = folder.read("demo/lane_change.csv");
    assert!(header.contains("t,omega_1,omega_2,omega_3,sigma,x_G,y_G"));
}

#[test]
fn completions_exist_for_shells() {
    let folder = Folder::new();
    assert!(
        folder
            .done(&["completions", "bash"])
            .stdout
            .contains("COMPLETE")
    );
}

#[test]
fn a_page_of_a_shipped_mechanism_begins_with_its_spec() {
    let folder = Folder::new();
    let command = "appell derive pendulum --format spec --out pendulum.toml";
    folder.fails(2, &["watch", "pendulum"], &[command, "appell watch"]);
    folder.done(&command.split(' ').skip(1).collect::<Vec<_>>());
    folder.done(&["check", "pendulum.toml"]);
}

#[test]
fn every_effect_has_a_law_a_picture_sites_and_an_example() {
    let folder = Folder::new();
    let told = folder.done(&["effects", "--json", "effects.json"]).stdout;
    let effects = folder.json("effects.json");
    let effects = effects["effects"].as_array().expect("a list");
    assert!(effects.len() > 20);
    for effect in effects {
        assert!(told.contains(effect["name"].as_str().expect("a name")));
        for key in ["law", "picture", "sites"] {
            assert_ne!(effect[key], "", "{effect}");
        }
        // No shipped spec has a controller in it, or the actuators of a robot.
        let of_robots = ["load", "servo", "joint", "encoder"].map(serde_json::Value::from);
        let has_example = effect["example"]["sites"] != serde_json::json!([]);
        assert!(
            has_example || of_robots.contains(&effect["site"]),
            "{effect}"
        );
    }
    let told = folder
        .done(&["effects", "spring", "--model", "pendulum"])
        .stdout;
    for says in ["F = -k q", "spring@theta", "kind = \"generalized\"", "\\ |"] {
        assert!(told.contains(says), "{told}");
    }
    folder.fails(2, &["effects", "sprnig"], &["did you mean `spring`?"]);
    let failed = folder.fails(
        2,
        &["effects", "coulom"],
        &["there is no effect `coulom`; did you mean `coulomb_friction`?"],
    );
    assert!(!failed.stderr.contains("--"), "{}", failed.stderr);
    // What is brought to a drive has its numbers.
    let told = folder.done(&["effects", "backlash", "--model", "cart_pole"]);
    assert!(!told.stdout.contains("{inertia}") && !told.stdout.contains("{drive}"));
}

#[test]
fn names_of_others_command_no_terminal() {
    let folder = Folder::new();
    let (evil, shown) = ("a\u{1b}[2J\u{202e}", "a\\u{1b}[2J\\u{202e}");
    let manifest = "mechanism = \"a\\u001b[2J\\u202e\"\n[channels]\n[runs]\nfit = [\"run.csv\"]\n";
    folder.write("recording.toml", manifest);
    let spec = format!("{evil}.toml");
    folder.write(&spec, &format!("[mechanism]\nname = \"{evil}\"\n"));
    // Commands to the terminal are left out of what is said about flags.
    let flag = "a\\u{202e}";
    let cases: [(i32, &[&str], &str); 4] = [
        (3, &["check", &spec], shown),
        (2, &["check", evil], shown),
        (3, &["recording", "."], shown),
        (2, &["new", "one", evil], flag),
    ];
    for (status, arguments, says) in cases {
        let told = folder.fails(status, arguments, &[says]).stderr;
        assert!(!told.contains(['\u{1b}', '\u{202e}']), "{told:?}");
    }
}
