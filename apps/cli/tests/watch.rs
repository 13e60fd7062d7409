//! `appell watch`: the page in a real browser, and how long it takes from a save to what is seen.

use std::io::{BufRead as _, BufReader};
use std::process::{Child, Command, Stdio};
use std::time::{SystemTime, UNIX_EPOCH};

use crate::browser::{Browser, pause};
use crate::support::{Folder, repository};

/// From a save to the equations and the motion on the page, in ms, for a build that is optimised on a
/// machine that does nothing else. The tests run in another one, beside others.
const WANTED: [(&str, f64); 2] = [("unicycle", 100.0), ("bicycle", 300.0)];
/// An expression of each, of which another multiple is saved each time.
const EXPRESSIONS: [&str; 2] = ["\"m*R^2/2\"", "\"I_By\", 0]"];
/// How much longer an unoptimised build on a busy machine may take.
const GENEROUS: f64 = 40.0;
/// Saves of which the median is taken.
const SAVES: usize = 9;

/// The server, which ends with the test.
struct Server(Child);

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Serves `spec.toml` of a folder; the address of the page.
fn serve(folder: &Folder) -> (Server, String) {
    let mut process = Command::new(env!("CARGO_BIN_EXE_appell"))
        .args(["watch", "spec.toml"])
        .current_dir(folder.path(""))
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program runs");
    let from = process.stdout.take().expect("a pipe");
    let server = Server(process);
    let mut url = String::new();
    BufReader::new(from)
        .read_line(&mut url)
        .expect("an address");
    assert!(url.starts_with("http://127.0.0.1:"), "{url}");
    (server, url.trim_end().to_owned())
}

fn shipped(name: &str) -> String {
    let path = repository(&format!("generated/mechanisms/{name}.toml"));
    std::fs::read_to_string(path).expect("a spec")
}

/// A browser on the page of a spec, once everything is shown.
fn opened(folder: &Folder, text: &str) -> Option<(Server, Browser)> {
    folder.write("spec.toml", text);
    let mut browser = Browser::start(&folder.path("profile"))?;
    let (server, url) = serve(folder);
    browser.visit(&url);
    browser.wait(
        "Boolean(globalThis.appell?.seen.motion && appell.seen.equations && appell.seen.drawing)",
    );
    Some((server, browser))
}

fn milliseconds() -> f64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    now.expect("a time after 1970").as_secs_f64() * 1e3
}

/// How many elements a selector finds.
fn count(browser: &mut Browser, selector: &str) -> u64 {
    let found = browser.value(&format!("document.querySelectorAll('{selector}').length"));
    found.as_u64().expect("a number")
}

/// What the page complained of, its own server aside.
fn complaints(browser: &mut Browser) -> Vec<String> {
    let all = browser.complaints().into_iter();
    all.filter(|told| {
        !(told.contains("Network.requestWillBeSent") && told.contains("http://127.0.0.1:"))
    })
    .collect()
}

#[test]
fn a_save_is_seen_at_once() {
    for ((name, wanted), expression) in WANTED.into_iter().zip(EXPRESSIONS) {
        let folder = Folder::new();
        let text = shipped(name);
        let Some((_server, mut browser)) = opened(&folder, &text) else {
            return;
        };
        let mut taken = [Vec::new(), Vec::new()];
        for save in 0..SAVES {
            let other = format!("\"{}*{}", save + 2, &expression[1..]);
            let changed = text.replacen(expression, &other, 1);
            assert_ne!(changed, text);
            let before = browser.number("appell.seen.text.version");
            pause(0.3);
            let start = milliseconds();
            folder.write("spec.toml", &changed);
            let is_new = |part: &str| format!("appell.seen.{part}.version > {before}");
            browser.wait(&format!("{} && {}", is_new("equations"), is_new("motion")));
            for (part, taken) in ["equations", "motion"].iter().zip(&mut taken) {
                taken.push(browser.number(&format!("appell.seen.{part}.at")) - start);
            }
        }
        for (part, taken) in ["equations", "motion"].iter().zip(&mut taken) {
            taken.sort_by(f64::total_cmp);
            let (median, worst) = (taken[SAVES / 2], taken[SAVES - 1]);
            println!("{name}: {part} after {median:.0} ms, at worst {worst:.0} ms");
            assert!(
                median < GENEROUS * wanted,
                "{name}: {part} after {taken:?} ms"
            );
        }
        assert_eq!(complaints(&mut browser), [""; 0]);
    }
}

#[test]
fn equations_and_lines_lead_to_each_other() {
    let folder = Folder::new();
    let text = shipped("unicycle");
    let Some((_server, mut browser)) = opened(&folder, &text) else {
        return;
    };
    let line = |key: &str| 1 + text.lines().position(|l| l.starts_with(key)).expect(key);
    // A click on a line marks equations, and all lines of its item.
    let wheel = line("[bodies.wheel]");
    browser.value(&format!(
        "document.getElementById('line-{}').click()",
        wheel + 3
    ));
    assert!(count(&mut browser, "#equations .chosen") > 2);
    assert_eq!(count(&mut browser, "#lines .chosen"), 6);
    // A click on an equation marks its lines and no other equation.
    browser.value(
        "[...document.querySelectorAll('#equations mtr.first[data-lines]')].at(-1).dispatchEvent(\
         new MouseEvent('click', {bubbles: true}))",
    );
    assert!(count(&mut browser, "#lines .chosen") > 2);
    assert_eq!(count(&mut browser, "#equations .chosen.first"), 1);
    // Keys go through the lines.
    browser.value(
        "document.getElementById('lines').dispatchEvent(\
         new KeyboardEvent('keydown', {key: 'ArrowDown', bubbles: true}))",
    );
    assert_eq!(count(&mut browser, "#lines [aria-selected=true]"), 1);
    assert_eq!(complaints(&mut browser), [""; 0]);
}

#[test]
fn a_broken_spec_shows_its_errors_and_the_last_good_motion() {
    let folder = Folder::new();
    let text = shipped("unicycle");
    let Some((_server, mut browser)) = opened(&folder, &text) else {
        return;
    };
    let shown = browser.number("appell.seen.motion.number");
    folder.write("spec.toml", &text.replace("unit = \"kg\"", "unit = \"kq\""));
    browser.wait("document.body.classList.contains('broken')");
    assert_eq!(count(&mut browser, "#lines .finding.error"), 2);
    // The list above the text leads to them.
    assert_eq!(count(&mut browser, "#findings button.error"), 2);
    browser.value("[...document.querySelectorAll('#findings button')].at(-1).click()");
    let chosen = "document.querySelector('#lines [aria-selected=true] mark.error').textContent";
    assert_eq!(browser.value(chosen), "kq");
    assert_eq!(
        browser.value("document.querySelector('#lines mark.error').textContent"),
        "kq"
    );
    // Sliders go on with the last good model.
    browser.value(
        "{const slider = document.getElementById('parameters.R.slider'); slider.value = 0.5;\
         slider.dispatchEvent(new Event('input'))}",
    );
    browser.wait(&format!("appell.seen.motion.number > {shown}"));
    assert_eq!(
        browser.value("document.getElementById('parameters.R').value"),
        "0.5"
    );
    folder.write("spec.toml", &text);
    browser.wait("!document.body.classList.contains('broken')");
    assert_eq!(complaints(&mut browser), [""; 0]);
}
