//! What is read, and what stays of files that are written.
#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::fs;
use std::io::Write as _;
use std::path::Path;

use appell_files::{Draft, FileError, below, read, read_text, remove_left_behind, within};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn regular_files_of_bounded_size_are_read() {
    let here = folder();
    let path = here.path().join("a.txt");
    fs::write(&path, "ground").unwrap();
    assert_eq!(read_text(&path, 6).unwrap(), "ground");
    assert!(matches!(read(&path, 5), Err(FileError::TooLarge { .. })));
    let other = read(here.path(), 5);
    assert!(matches!(other, Err(FileError::NotRegular { .. })));
    fs::write(&path, b"a\nb\xff").unwrap();
    let text = read_text(&path, 6);
    assert!(matches!(text, Err(FileError::NotText { line: 2, .. })));
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_refused_before_they_are_opened() {
    let here = folder();
    let pipe = here.path().join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    for path in [pipe.as_path(), Path::new("/dev/zero")] {
        assert!(matches!(read(path, 5), Err(FileError::NotRegular { .. })));
    }
    // Its length is zero by what the system tells, and its content is not.
    assert!(matches!(
        read(Path::new("/proc/self/maps"), 5),
        Err(FileError::TooLarge { .. } | FileError::System { .. })
    ));
}

#[test]
fn a_file_names_what_lies_below_its_folder() {
    let here = folder();
    let root = here.path();
    for named in ["a.csv", "./a.csv", "runs/a.csv", "runs/../a.csv"] {
        assert_eq!(below(root, named).unwrap(), root.join(named));
    }
    for named in ["../a.csv", "runs/../../a.csv", "/etc/passwd"] {
        let refused = below(root, named);
        assert!(matches!(refused, Err(FileError::Outside { .. })), "{named}");
    }
}

#[test]
fn a_user_names_the_folder_below_which_files_lie() {
    let here = folder();
    let root = here.path();
    let scenes = root.join("scenes");
    assert!(within(root, &scenes, "../arm.xml").is_ok());
    for named in ["../../arm.xml", "/etc/passwd"] {
        assert!(within(root, &scenes, named).is_err(), "{named}");
    }
    assert!(within(Path::new(""), Path::new(""), "a.xml").is_ok());
    assert!(within(Path::new(""), Path::new("scenes"), "../a.xml").is_ok());
    assert!(within(Path::new(""), Path::new(""), "../a.xml").is_err());
}

#[cfg(unix)]
#[test]
fn links_lead_to_files_below_the_folder() {
    let (here, elsewhere) = (folder(), folder());
    let root = here.path();
    fs::write(elsewhere.path().join("secret"), "").unwrap();
    fs::write(root.join("own"), "").unwrap();
    std::os::unix::fs::symlink(elsewhere.path().join("secret"), root.join("out")).unwrap();
    std::os::unix::fs::symlink("own", root.join("in")).unwrap();
    assert!(below(root, "in").is_ok());
    assert!(matches!(below(root, "out"), Err(FileError::Outside { .. })));
}

#[test]
fn a_draft_is_put_in_its_place_or_leaves_nothing() {
    let here = folder();
    let path = here.path().join("a.csv");
    fs::write(&path, "old").unwrap();
    let mut draft = Draft::new(&path).unwrap();
    draft.write_all(b"half of it").unwrap();
    drop(draft);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    let [mut one, mut other] = [(); 2].map(|()| Draft::new(&path).unwrap());
    one.write_all(b"one").unwrap();
    other.write_all(b"other").unwrap();
    one.finish().unwrap();
    other.finish().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"other");
    assert_eq!(names(here.path()), ["a.csv"]);
}

#[cfg(unix)]
#[test]
fn permissions_are_those_of_other_files_and_stay() {
    use std::os::unix::fs::PermissionsExt as _;
    let here = folder();
    let mode = |name: &str| {
        let about = fs::metadata(here.path().join(name)).unwrap();
        about.permissions().mode() & 0o777
    };
    let write = |name: &str| {
        Draft::new(&here.path().join(name))
            .unwrap()
            .finish()
            .unwrap();
    };
    fs::write(here.path().join("plain"), "").unwrap();
    write("new");
    assert_eq!(mode("new"), mode("plain"));
    fs::set_permissions(here.path().join("plain"), fs::Permissions::from_mode(0o600)).unwrap();
    write("plain");
    assert_eq!(mode("plain"), 0o600);
}

#[test]
fn drafts_without_a_writer_are_removed_and_others_stay() {
    let here = folder();
    let mut written = Draft::new(&here.path().join("a.txt")).unwrap();
    written.write_all(b"ground").unwrap();
    fs::write(here.path().join(".killed.draft"), "gro").unwrap();
    fs::write(here.path().join(".other"), "").unwrap();
    remove_left_behind(here.path()).unwrap();
    assert!(!names(here.path()).contains(&".killed.draft".to_owned()));
    written.finish().unwrap();
    remove_left_behind(here.path()).unwrap();
    assert_eq!(names(here.path()), [".other", "a.txt"]);
}
