//! `appell diagnose` finds what a simulated rig has and its model lacks, and finds nothing where there
//! is nothing.

use crate::browser;
use crate::rig::{dry, viscous};
use crate::support::{Folder, number};

fn report(folder: &Folder) -> serde_json::Value {
    folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    folder.json("report.json")
}

#[test]
fn friction_is_found_with_its_value_and_closes_the_gap() {
    let report = report(&viscous(0.4));
    let top = &report["which"][0];
    assert_eq!(
        top["effects"],
        serde_json::json!(["viscous_friction@x"]),
        "{report:#}"
    );
    let parameter = &top["parameters"][0];
    let (value, std) = (parameter["value"].as_f64(), parameter["std"].as_f64());
    let off = (value.expect("a value") - 0.4) / std.expect("a deviation");
    // Four standard deviations: an event of 1 in 16 000.
    assert!(off.abs() < 4.0, "{parameter}");
    assert_eq!(report["where"]["domain"], "force");
    assert_eq!(report["where"]["equations"][0]["name"], "v");
    let closed = report["how_far"]["closed"].as_f64().expect("a number");
    assert!(closed > 0.9, "{closed}");
}

#[test]
fn nothing_is_found_where_nothing_is_missing() {
    let report = report(&viscous(0.0));
    assert_eq!(report["verdict"], "no_gap", "{report:#}");
    assert_eq!(report["where"]["domain"], "none");
}

#[test]
fn the_headline_has_the_probability_and_the_next_command_the_files() {
    let told = viscous(0.4).done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let headline = told.stdout.lines().next().expect("a headline");
    let (sure, next) = ("(probability over 99 %", "; next: ");
    assert!(
        headline.contains(sure) && headline.contains(next),
        "{headline}"
    );
    let mut lines = told.stdout.lines().skip(1);
    for begins in [
        "  size      ",
        "  change    ",
        "            appell apply carriage --report report.json",
        "  error     ",
    ] {
        let line = lines.next().unwrap_or_default();
        assert!(line.starts_with(begins), "{}", told.stdout);
    }
    assert!(told.stdout.contains("coefficient = 0."), "{}", told.stdout);
    // Without a report, the command that writes one comes first.
    let told = viscous(0.4).done(&["diagnose", "--data", "."]).stdout;
    let next = "            appell diagnose --data . --json gap.json\n            appell apply carriage --report \
                gap.json\n";
    assert!(told.contains(next), "{told}");
}

#[test]
fn a_parameter_that_is_all_that_is_wrong_is_named_with_both_values() {
    let folder = viscous(0.0);
    let description = folder.read("recording.toml");
    let wrong = "m = { value = 1.1, unit = \"kg\", std = 0.1 }";
    let right = "m = { value = 1.0, unit = \"kg\", std = 0.02 }";
    folder.write("recording.toml", &description.replace(right, wrong));
    let told = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    assert_eq!(folder.json("report.json")["verdict"], "no_gap");
    for says in [
        "once parameters are re-fitted\n  size      m = ",
        " kg (stated 1.1 kg, -1.0 stated deviations) (± 95 %)\n",
        "take the parameters over (`appell apply`)\n            appell apply carriage --report report.json\n",
    ] {
        assert!(told.stdout.contains(says), "{}", told.stdout);
    }
}

#[test]
fn a_library_without_the_cause_does_not_name_another_one() {
    let folder = dry(0.3);
    let without = [
        "--without",
        "coulomb_friction",
        "--without",
        "stribeck_friction",
        "--without",
        "directional_friction",
    ];
    let asked = ["diagnose", "--data", ".", "--json", "report.json"];
    let told = folder.done(&[&asked[..], &without[..]].concat()).stdout;
    let report = folder.json("report.json");
    assert_eq!(report["verdict"], "unexplained", "{told}");
    assert_eq!(report["law"]["equation"], "v", "{told}");
    // All runs have the same forces, so that the position tells the velocity.
    assert!(number(&report, "how_far/closed") > 0.9, "{told}");
}

#[test]
fn an_error_of_a_sensor_that_nobody_has_named_is_told_with_its_place() {
    let folder = viscous(0.0);
    for name in ["a.csv", "b.csv", "c.csv"] {
        let text = folder.read(name);
        let mut lines = text.lines();
        let mut changed = vec![lines.next().expect("a header").to_owned()];
        changed.extend(lines.map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let x: f64 = cells[1].parse().expect("a position");
            format!("{},{},{}", cells[0], x + 0.004 * (40.0 * x).sin(), cells[2])
        }));
        folder.write(name, &(changed.join("\n") + "\n"));
    }
    let told = folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
    let report = folder.json("report.json");
    assert_eq!(report["verdict"], "unexplained", "{}", told.stdout);
    let says = "an error of the channel x that depends on x";
    assert!(told.stdout.contains(says), "{}", told.stdout);
}

#[test]
fn the_page_shows_where_which_and_how_far_and_needs_nothing_beside_it() {
    let folder = viscous(0.4);
    folder.done(&["diagnose", "--data", ".", "--html", "page.html"]);
    let page = folder.read("page.html");
    let told = [
        "viscous_friction@x",
        "identified law",
        "free run",
        "held out",
        "class=\"ring c1\"",
        "class=\"band f2\"",
        "smallest size",
        "appell apply",
    ];
    for text in told {
        assert!(page.contains(text), "`{text}` is missing");
    }
    assert!(
        !page.contains("NaN") && !page.contains("inf"),
        "a number is none"
    );
    let Some(mut browser) = browser::Browser::start(&folder.path("browser")) else {
        return;
    };
    browser.open(&folder.path("page.html"));
    let colours = ["light", "dark"].map(|scheme| {
        browser.prefer(scheme);
        browser
            .value("getComputedStyle(document.body).backgroundColor")
            .to_string()
    });
    assert_ne!(colours[0], colours[1]);
    let wide = browser.number("document.documentElement.scrollWidth - innerWidth");
    assert!(
        wide <= 0.0,
        "the page is {wide} pixels wider than the window"
    );
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn a_page_without_a_gap_tells_what_would_have_been_seen() {
    let folder = viscous(0.0);
    folder.done(&["diagnose", "--data", ".", "--html", "page.html"]);
    let page = folder.read("page.html");
    let told = [
        "o gap beyond measurement and process noise",
        "No equation disagrees",
        "<details open>",
    ];
    for text in told {
        assert!(page.contains(text), "`{text}` is missing");
    }
    assert!(!page.contains("class=\"ring"), "nothing is marked");
}

#[test]
fn two_runs_of_the_program_write_the_same_bytes() {
    let folder = viscous(0.4);
    let bytes = || {
        folder.done(&["diagnose", "--data", ".", "--json", "report.json"]);
        folder.read("report.json")
    };
    assert_eq!(bytes(), bytes());
}

#[test]
fn a_user_adds_an_effect_without_code() {
    let folder = viscous(0.4);
    folder.write("cubic_friction.toml", CUBIC);
    let asked = [
        "diagnose",
        "--data",
        ".",
        "--effects",
        "cubic_friction.toml",
    ];
    folder.done(&[&asked[..], &["--json", "report.json"]].concat());
    let report = folder.read("report.json");
    assert!(report.contains("cubic_friction@x"), "{report}");
}

#[test]
fn an_effect_that_cannot_be_read_is_bad_data() {
    let folder = viscous(0.4);
    folder.write("own.toml", "[effect]\nfamily = \"force\"\n");
    let ended = folder.run(&["diagnose", "--data", ".", "--effects", "own.toml"]);
    assert_eq!(ended.status, 3, "{}", ended.stderr);
    for told in ["`site` is missing", "own.toml:1:1"] {
        assert!(ended.stderr.contains(told), "{}", ended.stderr);
    }
}

const CUBIC: &str = r#"[effect]
family = "force"
site   = "coordinate"
about  = "friction with the cube of the rate at {site}"
[parameters]
"{effect}_coefficient" = { value = 0, unit = "{force}*s^3/({unit})^3", at_least = 0 }
[loads]
"{effect}" = { kind = "generalized", coordinate = "{site}", force = "-{effect}_coefficient*dot({site})^3" }
"#;

#[test]
fn a_mistake_in_an_own_effect_is_told_in_its_words_and_at_its_place() {
    let folder = viscous(0.4);
    let told = |text: &str, says: &[&str]| {
        folder.write("cubic.toml", text);
        let asked = ["diagnose", "--data", ".", "--effects", "cubic.toml"];
        let stderr = folder.fails(3, &asked, says).stderr;
        for of_the_spec in ["carriage", "cubic_x"] {
            assert!(!stderr.contains(of_the_spec), "{stderr}");
        }
    };
    let unknown = [
        "unknown name `{effect}_coeficient`",
        "cubic.toml:8:71",
        "where `{site}` is `x`",
        "did you mean `{effect}_coefficient`?",
    ];
    told(
        &CUBIC.replace("-{effect}_coefficient", "-{effect}_coeficient"),
        &unknown,
    );
    let dimension = ["must have the unit `N`", "cubic.toml:8:69"];
    told(&CUBIC.replace("})^3\" }\n", "})^2\" }\n"), &dimension);
    let nothing = [
        "unknown placeholder `{sit}`",
        "cubic.toml:8:",
        "did you mean `{site}`?",
    ];
    told(&CUBIC.replace("dot({site})", "dot({sit})"), &nothing);
    // This shows only once the equations are derived.
    let zero = ["divides by zero", "cubic.toml:8:"];
    told(
        &CUBIC.replace("dot({site})^3", "dot({site})^3*{site}/({site} - {site})"),
        &zero,
    );
    // What is added to an input stands in the expressions of the spec.
    let input = CUBIC
        .replace("\"coordinate\"", "\"input\"")
        .replace("\"{force}*s^3/({unit})^3\"", "\"{unit}\"");
    let (parameters, _) = input.split_once("[loads]").expect("a load");
    let input = format!("{parameters}[input]\n\"{{site}}\" = \"{{effect}}_coefficient*wrong\"\n");
    told(&input, &["unknown name `wrong`", "cubic.toml:8:12"]);
}

#[test]
fn an_own_effect_with_a_name_of_the_library_stands_in_its_place_and_that_is_told() {
    let folder = viscous(0.4);
    let own = CUBIC
        .replace("coefficient", "damping")
        .replace("s^3/({unit})^3", "s/({unit})")
        .replace("})^3\" }\n", "})\" }\n");
    folder.write("viscous_friction.toml", &own);
    let asked = [
        "diagnose",
        "--data",
        ".",
        "--json",
        "report.json",
        "--effects",
    ];
    let told = folder.done(&[&asked[..], &["viscous_friction.toml"]].concat());
    let says = "viscous_friction.toml: effect `viscous_friction` replaces the shipped one";
    assert!(told.stdout.contains(says), "{}", told.stdout);
    let report = folder.json("report.json");
    assert!(report["data"].to_string().contains(says), "{report:#}");
    let top = &report["which"][0];
    let name = "viscous_friction@x.damping";
    assert_eq!(top["parameters"][0]["name"], name, "{report:#}");
    assert_eq!(top["parameters"].as_array().map(Vec::len), Some(1));
    folder.write("cubic.toml", CUBIC);
    let told = folder.done(&[&asked[..], &["cubic.toml"]].concat());
    assert!(!told.stdout.contains("in place"), "{}", told.stdout);
}

#[test]
fn a_gain_near_a_factor_between_units_is_doubted_and_has_no_unit() {
    let folder = viscous(0.0);
    for name in ["a.csv", "b.csv", "c.csv"] {
        let text = folder.read(name);
        // Millimetres, which the description calls metres.
        let lines = text.lines().enumerate().map(|(row, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            match cells[1].parse::<f64>() {
                Ok(x) if row > 0 => format!("{},{},{}", cells[0], 1e3 * x, cells[2]),
                _ => line.to_owned(),
            }
        });
        folder.write(name, &(lines.collect::<Vec<_>>().join("\n") + "\n"));
    }
    let description = folder.read("recording.toml");
    let description = description.replace("1e-3 }", "1 }");
    // Units are doubted before a fit, unless somebody vouches for them.
    let asked = ["diagnose", "--data", "."];
    folder.write("recording.toml", &description);
    folder.fails(3, &asked, &["write unit = \"mm\"", "unit_checked = true"]);
    let vouched = description.replace("unit = \"m\"", "unit = \"m\", unit_checked = true");
    let vouched = vouched.replace("unit = \"N\"", "unit = \"N\", unit_checked = true");
    folder.write("recording.toml", &vouched);
    let told = folder.done(&["diagnose", "--data", ".", "--html", "page.html"]);
    let gain = "actuator_gain@F  gain = ";
    let line = told.stdout.lines().find(|line| line.contains(gain));
    let line = line.unwrap_or_else(|| panic!("no gain in\n{}", told.stdout));
    assert!(!line.ends_with(" 1") && line.contains(" ± "), "{line}");
    let says = "times its command, which is close to 1000: is the unit of `F` right?";
    assert!(told.stdout.contains(says), "{}", told.stdout);
    let page = folder.read("page.html");
    assert!(page.contains("close to 1000: is the unit of F right?"));
}
