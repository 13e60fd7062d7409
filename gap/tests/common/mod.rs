//! The shipped specs as a library, and data sets made for a test.
#![allow(dead_code, unreachable_pub, reason = "each test file uses a part")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicU32, Ordering};

use appell_gap::data::{self, DataError, DataSet, Spec};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng as _};

static LIBRARY: LazyLock<Vec<(&'static str, Spec)>> = LazyLock::new(shipped);

/// All shipped specs by name.
pub fn library() -> &'static [(&'static str, Spec)] {
    &LIBRARY
}

fn shipped() -> Vec<(&'static str, Spec)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../generated/mechanisms");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    paths.sort();
    let entry = |path: PathBuf| {
        let name: &'static str = path
            .file_stem()
            .unwrap()
            .to_string_lossy()
            .to_string()
            .leak();
        let text = std::fs::read_to_string(&path).unwrap();
        let file = format!("{name}.toml");
        (name, Spec { file, text })
    };
    paths.into_iter().map(entry).collect()
}

/// A folder that is removed at the end of the test.
pub struct Folder(PathBuf);

static NEXT: AtomicU32 = AtomicU32::new(0);

impl Folder {
    pub fn new() -> Self {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let name = format!("appell-gap-{}-{number}", std::process::id());
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) -> &Self {
        std::fs::write(self.path(name), text).unwrap();
        self
    }

    pub fn read(&self) -> Result<DataSet, DataError> {
        data::read(&self.0, library(), None)
    }

    /// The message of a data set that must be refused.
    pub fn refused(&self) -> String {
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

/// Noise that is the same in every run, standard normal.
pub fn normal(seed: u64) -> f64 {
    // Neighbouring seeds take the sequence two draws further.
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(2);
    let mut random = SplitMix64::seed_from_u64(seed.wrapping_mul(STEP));
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let (u, v) = (1.0 - uniform(), uniform());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// A pendulum that swings, sampled at 100 Hz with noise of `std` rad, and a torque in steps.
pub fn swing(rows: usize, seed: u64, std: f64) -> String {
    let mut text = "t,theta,tau\n".to_owned();
    for i in 0..rows {
        let t = i as f64 * 0.01;
        let theta = 0.5 * (3.0 * t).sin() + std * normal(seed + i as u64);
        let tau = f64::from(u8::from(i % 100 < 50));
        writeln!(text, "{t:.2},{theta:.7},{tau}").unwrap();
    }
    text
}

/// A description of runs of a pendulum, with these lines for the channels.
pub fn pendulum(channels: &str, fit: &[&str], test: &[&str]) -> String {
    format!(
        "mechanism = \"pendulum\"\n[parameters]\nm = {{ value = 1.2, unit = \"kg\", std = 0.1 }}\n\
         [channels]\n{channels}\n[runs]\nfit = {fit:?}\ntest = {test:?}\n"
    )
}

/// Lines for the channels of [`swing`].
pub const SWING: &str = "theta = { measures = \"theta\", unit = \"rad\" }\n\
                         tau = { input = \"tau\", unit = \"N m\" }";
