//! Progress on standard error, shown on a terminal only.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Does work of unknown duration under a spinner, which is there to show its stages.
pub(crate) fn during<T>(doing: &str, work: impl FnOnce(&ProgressBar) -> T) -> T {
    let spinner = ProgressBar::new_spinner().with_message(doing.to_owned());
    spinner.enable_steady_tick(Duration::from_millis(120));
    let done = work(&spinner);
    spinner.finish_and_clear();
    done
}

/// A bar over the simulated time, in milliseconds.
pub(crate) fn clock(until_s: f64) -> ProgressBar {
    let bar = ProgressBar::new(milliseconds(until_s));
    // The template is constant, so that it parses; without it only the style differs.
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {percent} %  {elapsed}") {
        bar.set_style(style);
    }
    bar
}

/// A bar over named parts.
pub(crate) fn parts() -> ProgressBar {
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:40} {pos}/{len}  {msg}  {elapsed}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(120));
    bar
}

/// A bar over cases of some kind, with the time left.
pub(crate) fn cases(all: u64, kind: &str) -> ProgressBar {
    let bar = ProgressBar::new(all).with_message(kind.to_owned());
    let template = "{bar:40} {percent} %  {human_pos} of {human_len} {msg}  {per_sec}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float saturates, which is right here"
)]
pub(crate) fn milliseconds(t: f64) -> u64 {
    (t * 1e3) as u64
}
