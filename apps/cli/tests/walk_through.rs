//! A newcomer follows docs/gap-diagnosis.md from own recordings to an own improved spec: every file and
//! every command of that section, as written.

use crate::documents::blocks;
use crate::support::{Folder, number, repository};

const OWN_RIG: &str = "## From your recordings to your improved spec\n";
/// A size is off by more than so many deviations once in 16 000 times.
const NEAR: f64 = 4.0;
const ARM: &str = "## A rig with a payload and a stop\n";

/// A section of the document.
fn section(title: &str) -> String {
    let text = std::fs::read_to_string(repository("docs/gap-diagnosis.md")).expect("the document");
    let (_, rest) = text.split_once(title).expect("the section");
    let (section, _) = rest.split_once("\n## ").expect("another section");
    section.to_owned()
}

#[test]
fn every_command_of_the_walk_through_does_what_the_text_says_in_an_empty_folder() {
    let section = section(OWN_RIG);
    let folder = Folder::new();
    let told = told(&section, &folder);
    let header = |text: &str| text.lines().next().map(str::to_owned);
    assert_eq!(
        header(&folder.read("run1.csv")),
        header(blocks(&section, "csv")[0])
    );
    assert_eq!(folder.read("recording.toml"), blocks(&section, "toml")[0]);
    assert_eq!(told.len(), 7, "commands of the section");
    for says in ["dry friction at x", "depends on x; measured, it closes"] {
        assert!(told[2].contains(says), "{}", told[2]);
    }
    let better = folder.read("better.toml");
    for has in ["coulomb_friction_x_force", "law_v_rate"] {
        assert!(better.contains(has), "{better}");
    }
    assert!(told[6].contains("no gap beyond measurement"), "{}", told[6]);
    for file in ["report.json", "gap.html", "better.toml", "motion.svg"] {
        assert!(
            folder.files().contains(&file.to_owned()),
            "{file} is missing"
        );
    }
}

/// What the commands of a section say, one after the other.
fn told(section: &str, folder: &Folder) -> Vec<String> {
    let commands = blocks(section, "sh");
    let lines = commands.iter().flat_map(|block| block.lines());
    let run = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[0], "appell", "{line}");
        folder.done(&words[1..]).stdout
    };
    lines.map(run).collect()
}

#[test]
fn a_payload_and_a_stop_are_found_and_written_as_the_text_says() {
    let section = section(ARM);
    let folder = Folder::new();
    let told = told(&section, &folder);
    assert_eq!(told.len(), 4, "commands of the section");
    for says in ["payload on fore", "stop at the end of q_2"] {
        assert!(told[1].contains(says), "{}", told[1]);
    }
    let report = folder.json("arm.json");
    let values = report["which"][0]["parameters"].as_array().expect("values");
    let truth = [
        ("payload@fore.mass", 0.5),
        ("payload@fore.x", 0.02),
        ("payload@fore.z", -0.17),
        ("stop@q_2.place", 0.6),
    ];
    for (name, expected) in truth {
        let own = values.iter().find(|own| own["name"] == name).expect(name);
        let (value, std) = (number(own, "value"), number(own, "std"));
        assert!((value - expected).abs() < NEAR * std, "{own}");
    }
    let better = folder.read("better_arm.toml");
    for has in ["payload_fore_mass", "stop_q_2_1_place"] {
        assert!(better.contains(has), "{better}");
    }
    let nominal = |report: &serde_json::Value| number(report, "how_far/nominal");
    let again = folder.json("again.json");
    let floor = number(&again, "how_far/noise_floor");
    assert!(nominal(&again) < 0.1 * nominal(&report), "{}", told[3]);
    let predicted = number(&again, "how_far/refitted");
    assert!(predicted < 1.5 * floor, "{}", told[3]);
    // What the first diagnosis left open of the stop is a matter of tolerances, and no gap.
    assert_eq!(again["verdict"], "no_gap", "{}", told[3]);
    assert_eq!(again["which"][0]["effects"], serde_json::json!([]));
}

#[test]
fn a_captured_ride_becomes_a_height_in_an_empty_folder() {
    let text = std::fs::read_to_string(repository("docs/motion-capture.md")).expect("the document");
    let folder = Folder::new();
    let mut told = Vec::new();
    for line in blocks(&text, "sh")[0].lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        told.push(folder.done(&words[1..]).stdout);
    }
    assert_eq!(told.len(), 3, "commands of the section");
    let truth = (told[0].split("h = ").nth(1)).and_then(|rest| rest.split(' ').next());
    let truth: f64 = truth.expect("the truth").parse().expect("a number");
    let row = told[2].lines().find(|line| line.starts_with("  h "));
    let row: Vec<&str> = row.expect("the height").split_whitespace().collect();
    let [low, high]: [f64; 2] = [row[3], row[4]].map(|end| end.parse().expect("a number"));
    assert!((low..=high).contains(&truth), "{}", told[2]);
    assert!(folder.files().contains(&"torque.svg".to_owned()));
    let refused = ["sample", "capture", "capture"];
    folder.fails(3, &refused, &["is there already"]);
}
