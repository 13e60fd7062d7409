//! The shipped specs as a library, and data sets made for a test.

#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU32, Ordering};

use appell_recordings::{DataError, DataSet, Spec};
use appell_test_kit::Random;

static LIBRARY: LazyLock<Vec<(&'static str, Spec)>> = LazyLock::new(shipped);

/// All shipped specs by name.
pub(crate) fn library() -> &'static [(&'static str, Spec)] {
    &LIBRARY
}

fn shipped() -> Vec<(&'static str, Spec)> {
    let specs = appell_test_kit::shipped().into_iter();
    let entry = |(name, text): (String, String)| {
        let file = format!("{name}.toml");
        let name: &'static str = name.leak();
        (name, Spec { file, text })
    };
    specs.map(entry).collect()
}

/// A folder that is removed at the end of the test.
pub(crate) struct Folder(PathBuf);

static NEXT: AtomicU32 = AtomicU32::new(0);

impl Folder {
    pub(crate) fn new() -> Self {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let name = format!("appell-gap-{}-{number}", std::process::id());
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) -> &Self {
        std::fs::write(self.path(name), text).unwrap();
        self
    }

    pub(crate) fn read(&self) -> Result<DataSet, DataError> {
        appell_recordings::read(&self.0, library(), None)
    }

    /// The message of a data set that must be refused.
    pub(crate) fn refused(&self) -> String {
        match self.read() {
            Ok(set) => panic!("accepted: {:?}", set.findings),
            Err(error) => error.to_string(),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder that cannot be removed harms nobody.
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A pendulum that swings, sampled at 100 Hz with noise of `std` rad, and a torque in steps.
pub(crate) fn swing(rows: usize, seed: u64, std: f64) -> String {
    let mut text = "t,theta,tau\n".to_owned();
    let mut dice = Random::new(seed);
    for i in 0..rows {
        let t = i as f64 * 0.01;
        let theta = 0.5 * (3.0 * t).sin() + std * dice.normal();
        let tau = f64::from(u8::from(i % 100 < 50));
        writeln!(text, "{t:.2},{theta:.7},{tau}").unwrap();
    }
    text
}

/// A description of runs of a pendulum, with these lines for the channels.
pub(crate) fn pendulum(channels: &str, fit: &[&str], test: &[&str]) -> String {
    format!(
        "mechanism = \"pendulum\"\n[parameters]\nm = {{ value = 1.2, unit = \"kg\", std = 0.1 }}\n\
         [channels]\n{channels}\n[runs]\nfit = {fit:?}\ntest = {test:?}\n"
    )
}

/// Lines for the channels of [`swing`].
pub(crate) const SWING: &str = "theta = { measures = \"theta\", unit = \"rad\" }\n\
                         tau = { input = \"tau\", unit = \"N m\" }";
