//! The books of the papers. They stay under the target folder for readers.

use std::path::Path;

use appell_papers::book::euc::findings;
use appell_test_kit::{budget, is_full};
use serde_json::Value;

use crate::support::Folder;

/// Points of its charts along each axis, in an ordinary run and for readers.
const ORDINARY_GRID: usize = 60;
const FULL_GRID: usize = 240;

/// Statements of the book at least: every number from (1) to (91) is among them.
const EQUATIONS: u32 = 91;

#[test]
fn the_book_of_steering_has_every_equation_table_and_figure_and_all_statements_hold() {
    let artefact = Path::new(env!("CARGO_TARGET_TMPDIR")).join("book");
    let out = artefact.to_str().expect("a path in UTF-8");
    let folder = Folder::new();
    let grid = budget(ORDINARY_GRID, FULL_GRID).to_string();
    let made = [
        "reproduce",
        "steering",
        "--grid",
        &grid,
        "--out",
        out,
        "--json",
        "book.json",
    ];
    let told = folder.done(&made);
    assert!(told.stdout.contains("errata"), "{}", told.stdout);

    let book = folder.json("book.json");
    assert_counted_apart(&book);
    let sections = book["sections"].as_array().expect("sections");
    let claims: Vec<&Value> = sections
        .iter()
        .flat_map(|section| section["claims"].as_array().expect("claims"))
        .collect();
    let places: Vec<&str> = claims.iter().filter_map(|c| c["place"].as_str()).collect();
    for number in 1..=EQUATIONS {
        let named = format!("({number})");
        let found = places.iter().any(|place| place.contains(&named));
        assert!(found, "{named} is missing");
    }
    for other in ["table I", "table II", "table III"] {
        assert!(
            places.iter().any(|place| place.starts_with(other)),
            "{other} is missing"
        );
    }
    for figure in [3, 5, 6, 7, 8] {
        let named = format!("figure {figure}");
        assert!(
            places.iter().any(|place| place.starts_with(&named)),
            "{named} is missing"
        );
    }
    let find = |published: &str| {
        let found = claims.iter().find(|claim| claim["published"] == published);
        found.unwrap_or_else(|| panic!("nothing on {published}"))
    };
    let gain = find("P_ψ = 536.67 N");
    assert_eq!(gain["agreement"], "differs", "{gain}");
    assert!(gain["erratum"].is_string(), "{gain}");
    assert!(
        gain["ours"]
            .as_str()
            .expect("a value")
            .starts_with("563.6697"),
        "{gain}"
    );
    let force = claims.iter().find(|claim| {
        claim["published"] == "|u| < 10 N" && claim["place"] == "figure 8, lane change at 5 m/s"
    });
    let force = force.expect("the force of the lane change");
    assert!(
        force["ours"]
            .as_str()
            .expect("a value")
            .starts_with("10.35"),
        "{force}"
    );
    assert!(claims.iter().all(|claim| {
        claim["command"]
            .as_str()
            .is_some_and(|c| !c.is_empty() && survives_a_shell(c))
    }));

    let page = std::fs::read_to_string(artefact.join("steering.html")).expect("the book");
    assert_self_contained(&page);
    assert_well_formed(&page);
    assert_eq!(page.matches("<figure>").count(), 18);
}

/// Equations of the paper on the electric unicycle.
const EUC_EQUATIONS: u32 = 13;

#[test]
fn the_book_of_the_electric_unicycle_says_what_holds_on_simulated_rides() {
    let artefact = Path::new(env!("CARGO_TARGET_TMPDIR")).join("book");
    let out = artefact.to_str().expect("a path in UTF-8");
    let folder = Folder::new();
    folder.done(&["reproduce", "euc", "--out", out, "--json", "book.json"]);

    let book = folder.json("book.json");
    assert_counted_apart(&book);
    let sections = book["sections"].as_array().expect("sections");
    let claims: Vec<&Value> = sections
        .iter()
        .flat_map(|section| section["claims"].as_array().expect("claims"))
        .collect();
    let has = |named: &str| {
        let places = claims.iter().filter_map(|claim| claim["place"].as_str());
        places.clone().any(|place| place.contains(named))
    };
    for number in 1..=EUC_EQUATIONS {
        assert!(has(&format!("({number})")), "({number}) is missing");
    }
    for place in ["table 1", "table 2", "table 3"] {
        assert!(has(place), "{place} is missing");
    }
    for figure in [3, 4, 6, 7, 8] {
        assert!(
            has(&format!("figure {figure}")),
            "figure {figure} is missing"
        );
    }
    let agreement = |place: &str, published: &str| {
        let found = claims
            .iter()
            .find(|claim| claim["place"] == place && claim["published"] == published);
        &found.unwrap_or_else(|| panic!("nothing on {published}"))["agreement"]
    };
    // What depends on the paper's recordings is said to.
    for (place, published) in [
        ("figure 6", "h = 0.61 m, RMSE 4.7599 N m"),
        ("figure 7", "h = 0.28 m, RMSE 13.5626 N m"),
    ] {
        assert_eq!(
            agreement(place, published),
            "cannot_be_checked",
            "{published}"
        );
    }
    for finding in findings().expect("the findings") {
        let expected = if finding.shows {
            "approximate"
        } else {
            "differs"
        };
        assert_eq!(
            agreement(&finding.place, &finding.published),
            expected,
            "{finding:?}"
        );
    }
    let rides = artefact.join("rides");
    assert_the_plane_is_left(&folder, rides.to_str().expect("a path in UTF-8"));
    let page = std::fs::read_to_string(artefact.join("euc.html")).expect("the book");
    assert_self_contained(&page);
    assert_well_formed(&page);
    assert_eq!(page.matches("<figure>").count(), 8);
}

/// Nothing broke, and each statement is counted as what it is.
fn assert_counted_apart(book: &Value) {
    assert_eq!(book["unexpected"], 0);
    let sections = book["sections"].as_array().expect("sections").iter();
    let claims = sections.flat_map(|section| section["claims"].as_array().expect("claims"));
    let claims: Vec<&Value> = claims.collect();
    let count = |agreement: &str| {
        let found = claims
            .iter()
            .filter(|claim| claim["agreement"] == agreement);
        assert_eq!(book[agreement], found.clone().count(), "{agreement}");
        found.count()
    };
    let four = ["exact", "approximate", "differs", "cannot_be_checked"].map(count);
    assert!(four.iter().all(|count| *count > 0), "{four:?}");
    assert_eq!(book["statements"], four.iter().sum::<usize>());
    assert_eq!(
        claims.len(),
        four.iter().sum::<usize>() + count("not_in_paper")
    );
}

/// Effects of the plane that no ride has; others take long beside a model that falls over.
const WITHOUT: [&str; 25] = [
    "directional_friction",
    "stop",
    "coupling",
    "payload",
    "saturation",
    "viscous_friction",
    "coulomb_friction",
    "stribeck_friction",
    "rolling_resistance",
    "spin_friction",
    "quadratic_drag",
    "ground_slope",
    "lateral_slip",
    "longitudinal_slip",
    "mass_offset",
    "added_inertia",
    "parameter_error",
    "sensor_scale",
    "sensor_delay",
    "sensor_bias",
    "actuator_lag",
    "actuator_delay",
    "actuator_saturation",
    "actuator_dead_zone",
    "actuator_gain",
];

/// The planar model beside rides that are planar, and beside an eight.
fn assert_the_plane_is_left(folder: &Folder, rides: &str) {
    let straight = format!("{rides}/constant_speed");
    folder.done(&["diagnose", "--data", &straight, "--json", "straight.json"]);
    assert_eq!(folder.json("straight.json")["verdict"], "no_gap");
    if !is_full() {
        return;
    }

    let (eight, spatial) = (
        format!("{rides}/figure_eight"),
        format!("{rides}/spatial.toml"),
    );
    let mut asked = vec!["diagnose", "--data", &eight, "--alternative", &spatial];
    asked.extend(["--json", "eight.json"]);
    asked.extend(WITHOUT.iter().flat_map(|kind| ["--without", kind]));
    folder.done(&asked);
    let report = folder.json("eight.json");
    let leading = serde_json::json!(["alternative:spatial"]);
    assert_eq!(report["which"][0]["effects"], leading, "{report:#}");
    let hints = report["hints"].as_array().expect("hints");
    assert!(
        hints.iter().any(|hint| hint["variable"] == "theta"),
        "{hints:?}"
    );
    let far = &report["how_far"];
    let [refitted, spatial, noise] =
        ["refitted", "with_effect", "noise_floor"].map(|key| far[key].as_f64().expect("a number"));
    assert!(refitted > 1.5 * spatial && spatial < 1.2 * noise, "{far}");
}

/// Nothing of the page is elsewhere.
fn assert_self_contained(page: &str) {
    let namespaces = ["http://www.w3.org/1999/xhtml", "http://www.w3.org/2000/svg"];
    let rest = namespaces
        .iter()
        .fold(page.to_owned(), |page, name| page.replace(name, ""));
    for foreign in [
        "http:", "https:", "src=", "@import", "url(", "<script", "<link",
    ] {
        assert!(!rest.contains(foreign), "`{foreign}` in the book");
    }
    let links = rest.split("href=\"").skip(1);
    assert!(
        links.into_iter().all(|link| link.starts_with('#')),
        "a link leads out of the book"
    );
}

/// Every element is closed in its order.
fn assert_well_formed(page: &str) {
    let mut open: Vec<&str> = Vec::new();
    for part in page.split('<').skip(1) {
        let (tag, _) = part.split_once('>').expect("a tag ends");
        if tag.starts_with('!') || tag.ends_with('/') {
            continue;
        }
        let name = tag.split_whitespace().next().unwrap_or_default();
        match name.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop(), Some(name), "`</{name}>` closes another element"),
            None => open.push(name),
        }
    }
    assert!(open.is_empty(), "not closed: {open:?}");
}

#[test]
fn a_paper_that_is_not_known_is_refused_with_those_that_are() {
    Folder::new().fails(2, &["reproduce", "stering"], &["steering"]);
}

/// What a shell would take apart or expand stands between quotes.
fn survives_a_shell(command: &str) -> bool {
    let mut bare = command.split('\'').step_by(2);
    bare.all(|part| !part.contains(['>', '<', '[', '*', '(']))
}
