//! The cache of derived equations: many processes at once, damage, clearing.

use std::fmt::Write as _;
use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::support::Folder;

/// A chain of links about changing axes, large enough to be kept.
fn arm(links: usize) -> String {
    let mut text = String::from("<mujoco model=\"arm\"><worldbody>");
    for link in 0..links {
        let axis = ["1 0 0", "0 1 0", "0 0 1"][link % 3];
        let _ = write!(
            text,
            "<body name=\"l{link}\" pos=\"0.1 0.02 0.2\"><joint name=\"j{link}\" axis=\"{axis}\" damping=\"0.1\"/>\
             <inertial pos=\"0.01 0.02 0.1\" mass=\"1\" fullinertia=\"0.01 0.02 0.015 0.001 0.002 -0.001\"/>"
        );
    }
    text + &"</body>".repeat(links) + "</worldbody></mujoco>"
}

const CACHE: &str = "cache";

/// A simulation that keeps its equations in the folder `cache`.
fn simulating(folder: &Folder, csv: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_appell"))
        .args(["simulate", "arm.xml", "--t-end-s", "0.01", "--csv", csv])
        .current_dir(folder.path(""))
        .env("APPELL_CACHE", folder.path(CACHE))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program starts")
}

fn simulated(folder: &Folder, csv: &str) -> String {
    let status = simulating(folder, csv).wait().expect("it ends");
    assert!(status.success());
    folder.read(csv)
}

/// What `appell cache` says.
fn told(folder: &Folder, arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_appell"))
        .arg("cache")
        .args(arguments)
        .env("APPELL_CACHE", folder.path(CACHE))
        .output()
        .expect("the program runs");
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[test]
fn twenty_processes_share_a_cache_though_some_are_killed() {
    let folder = Folder::new();
    folder.write("arm.xml", &arm(7));
    folder.done(&[
        "simulate",
        "arm.xml",
        "--t-end-s",
        "0.01",
        "--csv",
        "without.csv",
        "--no-cache",
    ]);
    let without = folder.read("without.csv");
    let mut all: Vec<Child> = (0..20)
        .map(|number| simulating(&folder, &format!("{number}.csv")))
        .collect();
    for (number, child) in all
        .iter_mut()
        .enumerate()
        .filter(|(number, _)| number % 3 == 0)
    {
        sleep(Duration::from_millis(7 * number as u64));
        child.kill().expect("it can be killed");
    }
    for (number, child) in all.iter_mut().enumerate() {
        let status = child.wait().expect("it ends");
        if number % 3 != 0 {
            assert!(status.success(), "process {number}");
            assert!(
                folder.read(&format!("{number}.csv")) == without,
                "process {number}"
            );
        }
    }
    assert!(told(&folder, &[]).contains(" entries, "));
    assert!(simulated(&folder, "later.csv") == without);

    // Damaged entries are derived anew; what killed processes have left goes when something is written.
    for entry in fs::read_dir(folder.path(CACHE)).expect("the cache") {
        let path = entry.expect("an entry").path();
        let mut bytes = fs::read(&path).expect("its bytes");
        let middle = bytes.len() / 2;
        bytes.truncate(middle);
        fs::write(&path, bytes).expect("damage");
    }
    assert!(simulated(&folder, "repaired.csv") == without);
    let names = fs::read_dir(folder.path(CACHE)).expect("the cache");
    let names = names.map(|entry| entry.expect("an entry").file_name());
    let left: Vec<_> = names
        .filter(|name| !name.to_string_lossy().ends_with(".tape"))
        .collect();
    assert!(left.is_empty(), "{left:?}");

    assert!(told(&folder, &["--clear"]).starts_with("removed "));
    assert!(told(&folder, &[]).contains("0 entries, 0 kB"));
}

#[test]
fn a_small_mechanism_and_an_empty_variable_keep_nothing() {
    let folder = Folder::new();
    let cache = folder.path(CACHE);
    let spec = include_str!("../../../generated/mechanisms/pendulum.toml");
    folder.write("arm.xml", &arm(7));
    folder.write("pendulum.toml", spec);
    for (model, variable) in [
        ("pendulum.toml", cache.as_os_str()),
        ("arm.xml", "".as_ref()),
    ] {
        let done = Command::new(env!("CARGO_BIN_EXE_appell"))
            .args(["simulate", model, "--t-end-s", "0.01"])
            .current_dir(folder.path(""))
            .env("APPELL_CACHE", variable)
            .output()
            .expect("the program runs");
        assert!(done.status.success());
        assert!(!cache.exists());
    }
}
