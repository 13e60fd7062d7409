//! `appell diagnose` finds what a simulated rig has and its model lacks, and finds nothing where there
//! is nothing.

mod browser;
mod rig;
mod support;

use rig::{dry, viscous};
use support::Folder;

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
fn a_library_without_the_cause_does_not_name_another_one() {
    let folder = dry(0.3);
    let without = [
        "--without",
        "coulomb_friction",
        "--without",
        "stribeck_friction",
    ];
    folder.done(
        &[
            &["diagnose", "--data", ".", "--json", "report.json"],
            &without[..],
        ]
        .concat(),
    );
    let report = folder.json("report.json");
    assert_eq!(report["verdict"], "unexplained");
    assert_eq!(report["left"]["place"], "v");
    assert_eq!(report["left"]["variable"], "v");
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
        "law that was found",
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
        "No gap beyond noise",
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
    let effect = r#"
[effect]
family = "force"
site   = "coordinate"
about  = "friction with the cube of the rate at {site}"
[parameters]
"{effect}_coefficient" = { value = 0, unit = "{force}*s^3/({unit})^3", at_least = 0 }
[loads]
"{effect}" = { kind = "generalized", coordinate = "{site}", force = "-{effect}_coefficient*dot({site})^3" }
"#;
    folder.write("cubic_friction.toml", effect);
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
    let told = "own: `site` is missing";
    assert!(ended.stderr.contains(told), "{}", ended.stderr);
}
