//! A newcomer follows docs/gap-diagnosis.md from own recordings to an own improved spec: every file and
//! every command of that section, as written.

use crate::rig;
use crate::support::{Folder, repository};

const SECTION: &str = "## From your recordings to your improved spec\n";

/// The section of the document.
fn section() -> String {
    let text = std::fs::read_to_string(repository("docs/gap-diagnosis.md")).expect("the document");
    let (_, rest) = text.split_once(SECTION).expect("the section");
    let (section, _) = rest.split_once("\n## ").expect("another section");
    section.to_owned()
}

/// The blocks of a language.
fn blocks<'s>(section: &'s str, language: &str) -> Vec<&'s str> {
    let fence = format!("```{language}\n");
    let blocks = section.split(fence.as_str()).skip(1);
    blocks.filter_map(|rest| rest.split("```").next()).collect()
}

/// A rig with dry friction and a grain in the rail; its spec has neither, the library only the friction.
fn rig(section: &str) -> Folder {
    let folder = rig::on_grain(0.4, 0.3, 20.0);
    for (recorded, name) in [
        ("a.csv", "run1.csv"),
        ("b.csv", "run2.csv"),
        ("c.csv", "run3.csv"),
    ] {
        let text = folder.read(recorded);
        let example = blocks(section, "csv")[0];
        assert_eq!(text.lines().next(), example.lines().next(), "the header");
        folder.write(name, &text);
    }
    let spec = std::fs::read_to_string(repository("generated/mechanisms/carriage.toml"));
    folder.write("my_rig.toml", &spec.expect("a shipped spec"));
    folder.write("recording.toml", blocks(section, "toml")[0]);
    folder
}

#[test]
fn every_command_of_the_walk_through_does_what_the_text_says() {
    let section = section();
    let folder = rig(&section);
    let commands = blocks(&section, "sh");
    let mut told = Vec::new();
    for line in commands.iter().flat_map(|block| block.lines()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(words[0], "appell", "{line}");
        told.push(folder.done(&words[1..]).stdout);
    }
    assert_eq!(told.len(), 6, "commands of the section");
    for says in ["dry friction at x", "depends on x; measured, it closes"] {
        assert!(told[1].contains(says), "{}", told[1]);
    }
    let better = folder.read("better.toml");
    for has in ["coulomb_friction_x_force", "law_v_rate"] {
        assert!(better.contains(has), "{better}");
    }
    assert!(told[5].contains("no gap beyond measurement"), "{}", told[5]);
    for file in ["report.json", "gap.html", "better.toml", "motion.svg"] {
        assert!(
            folder.files().contains(&file.to_owned()),
            "{file} is missing"
        );
    }
}
