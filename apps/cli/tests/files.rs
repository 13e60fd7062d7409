//! Files appear complete or not at all, wherever they are meant to be.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{FileTypeExt as _, PermissionsExt as _, symlink};
use std::process::Command;

use crate::support::Folder;

/// Writes a page of the pendulum to a file.
const DERIVE: [&str; 5] = ["derive", "pendulum", "--stage", "kinematics", "--out"];

fn page(folder: &Folder) -> String {
    folder.done(&DERIVE[..4]).stdout
}

fn derive_to(file: &str) -> Vec<&str> {
    [&DERIVE[..], &[file]].concat()
}

#[test]
fn a_pipe_is_written_to_and_stays_a_pipe() {
    let folder = Folder::new();
    let pipe = folder.path("pipe");
    let made = Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo runs").success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).expect("text")
    });
    folder.done(&derive_to("pipe"));
    assert_eq!(reader.join().expect("the reader ends"), page(&folder));
    let kind = fs::metadata(&pipe).expect("the pipe").file_type();
    assert!(kind.is_fifo());
    assert_eq!(folder.files(), ["pipe"]);
}

#[test]
fn a_spec_may_come_through_a_pipe_of_the_shell() {
    let folder = Folder::new();
    folder.done(&["new", "mine"]);
    for command in [
        "cat mine.toml | \"$0\" check -",
        "cat mine.toml | \"$0\" check /dev/stdin",
        "\"$0\" check <(cat mine.toml)",
    ] {
        let ran = Command::new("bash")
            .args(["-c", command, env!("CARGO_BIN_EXE_appell")])
            .current_dir(folder.path(""))
            .output()
            .expect("bash runs");
        let told = String::from_utf8_lossy(&ran.stdout);
        assert!(told.contains("degrees of freedom"), "{command}: {told}");
    }
}

#[test]
fn a_named_pipe_and_a_device_are_not_opened() {
    let folder = Folder::new();
    let pipe = folder.path("pipe.toml");
    let made = Command::new("mkfifo").arg(&pipe).status();
    assert!(made.expect("mkfifo runs").success());
    folder.fails(3, &["check", "pipe.toml"], &["this is a pipe"]);
    folder.fails(3, &["check", "/dev/zero"], &["or a device"]);
    let cases = [
        "evaluate",
        "pendulum",
        "--cases",
        "pipe.toml",
        "--json",
        "-",
    ];
    folder.fails(3, &cases, &["this is a pipe"]);
}

#[test]
fn a_link_is_followed_and_stays_a_link() {
    let folder = Folder::new();
    fs::create_dir(folder.path("elsewhere")).expect("a folder");
    folder.write("elsewhere/page.txt", "old");
    symlink("elsewhere/page.txt", folder.path("link")).expect("a link");
    symlink("elsewhere/new.txt", folder.path("dangling")).expect("a link");
    for (link, target) in [
        ("link", "elsewhere/page.txt"),
        ("dangling", "elsewhere/new.txt"),
    ] {
        folder.done(&derive_to(link));
        assert_eq!(folder.read(target), page(&folder));
        let kind = fs::symlink_metadata(folder.path(link)).expect("the link");
        assert!(kind.file_type().is_symlink(), "{link}");
    }
    assert_eq!(folder.files(), ["dangling", "elsewhere", "link"]);
}

#[test]
fn a_file_keeps_its_permissions() {
    let folder = Folder::new();
    folder.write("page.txt", "old");
    let path = folder.path("page.txt");
    fs::set_permissions(&path, Permissions::from_mode(0o640)).expect("permissions");
    folder.done(&derive_to("page.txt"));
    let mode = fs::metadata(&path).expect("the file").permissions().mode();
    assert_eq!(mode & 0o777, 0o640);
}

#[test]
fn what_is_read_only_stays_as_it_is() {
    let folder = Folder::new();
    folder.write("kept.txt", "mine");
    let path = folder.path("kept.txt");
    fs::set_permissions(&path, Permissions::from_mode(0o444)).expect("permissions");
    folder.fails(3, &derive_to("kept.txt"), &["cannot write kept.txt"]);
    assert_eq!(folder.read("kept.txt"), "mine");

    fs::create_dir(folder.path("closed")).expect("a folder");
    let closed = folder.path("closed");
    fs::set_permissions(&closed, Permissions::from_mode(0o555)).expect("permissions");
    // Whoever may write everywhere, such as root, writes here too.
    let may_write = fs::write(closed.join("probe"), "").is_ok();
    let outcome = folder.run(&derive_to("closed/page.txt"));
    fs::set_permissions(&closed, Permissions::from_mode(0o755)).expect("permissions");
    if may_write {
        assert_eq!(outcome.status, 0, "{}", outcome.stderr);
    } else {
        assert_eq!(outcome.status, 3);
        assert!(outcome.stderr.contains("cannot write closed/page.txt"));
        assert_eq!(fs::read_dir(closed).expect("the folder").count(), 0);
    }
}

#[test]
fn folders_that_nobody_asked_for_are_not_made() {
    let folder = Folder::new();
    folder.fails(
        3,
        &derive_to("a/b/page.txt"),
        &["there is no folder `a/b`: create it first"],
    );
    assert!(folder.files().is_empty(), "{:?}", folder.files());
}

#[test]
fn a_file_beyond_the_limit_is_not_read() {
    let folder = Folder::new();
    let long = format!("# {}\n", "x".repeat(1 << 20));
    folder.write("long.toml", &long);
    folder.fails(
        3,
        &["check", "long.toml"],
        &["long.toml: the file exceeds the limit of 1 MiB"],
    );
    let simulate = ["simulate", "pendulum", "--feedback", "long.toml"];
    folder.fails(
        3,
        &simulate,
        &["long.toml: the file exceeds the limit of 1 MiB"],
    );
}
