//! `appell simulate --html`: the page with the moving mechanism, opened in a real browser.

use serde_json::json;

use crate::browser::{Browser, pause};
use crate::support::{Folder, assert_close, repository};

/// Places on the page are in single precision.
const SINGLE: f64 = 1e-6;
/// Pictures in a second that a viewer asks for, with what the clock of a browser leaves of 60.
const SMOOTH: f64 = 55.0;
/// The same on a machine that is busy with other work.
const MOVING: f64 = 8.0;
/// Seconds within which a smooth second must come.
const TRIES: usize = 20;
/// Bytes of a page without its data.
const LARGEST: usize = 100_000;
/// A mechanism covers at least this part of its picture.
const SMALLEST: f64 = 0.004;
/// Names in the picture, and whether each lies in it.
const NAMES: &str = "{
    const stage = document.getElementById('stage').getBoundingClientRect();
    const names = [...document.querySelectorAll('#names span:not([hidden])')].map((name) => {
        const { left, top } = name.getBoundingClientRect();
        return left > stage.left && left < stage.right && top > stage.top && top < stage.bottom;
    });
    names.length > 0 && names.every(Boolean)
}";

/// The page of a motion.
fn page(folder: &Folder, arguments: &[&str]) {
    let all = [&["simulate"], arguments, &["--html", "film.html"]].concat();
    folder.done(&all);
}

fn lane_change(folder: &Folder) {
    let law = repository("docs/examples/feedback/lane_change_5_m_s.toml");
    let rows = ["--dt-s", "0.005", "--csv", "motion.csv"];
    page(
        folder,
        &[&["unicycle", "--feedback", &law], &rows[..]].concat(),
    );
}

/// Whether other programs compete for the processors; unknown is yes.
fn busy() -> bool {
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load: Option<f64> = load.split(' ').next().and_then(|n| n.parse().ok());
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    load.is_none_or(|load| load > 0.5 * processors as f64)
}

#[test]
fn a_lane_change_plays_in_a_browser() {
    let folder = Folder::new();
    lane_change(&folder);
    let Some(mut browser) = Browser::start(&folder.path("profile")) else {
        return;
    };
    browser.open(&folder.path("film.html"));
    browser.wait("appell.pictures > 3 && appell.playing");

    let sample = |browser: &mut Browser| {
        let place = browser.value("appell.place('G')");
        (browser.number("appell.time"), place, browser.picture())
    };
    let first = sample(&mut browser);
    pause(0.3);
    let second = sample(&mut browser);
    assert!(second.0 > first.0, "time stands still");
    assert!(second.1 != first.1, "nothing moves");
    assert!(second.2 != first.2, "the picture does not change");

    let mut best: f64 = 0.0;
    for _ in 0..TRIES {
        pause(1.0);
        best = best.max(browser.number("appell.rate"));
        if best >= SMOOTH {
            break;
        }
    }
    println!("{best} pictures in the best second");
    let wanted = if busy() { MOVING } else { SMOOTH };
    assert!(best >= wanted, "only {best} pictures in a second");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn keys_and_slider_show_the_rows_of_the_motion() {
    let folder = Folder::new();
    lane_change(&folder);
    let Some(mut browser) = Browser::start(&folder.path("profile")) else {
        return;
    };
    browser.open(&folder.path("film.html"));
    browser.wait("appell.pictures > 3");
    browser.press(" ");
    browser.wait("!appell.playing");
    browser.value(
        "document.getElementById('slider').value = 4;\
         document.getElementById('slider').dispatchEvent(new Event('input'))",
    );
    browser.press("ArrowRight");
    let rows = folder.read("motion.csv");
    let mut rows = rows.lines().filter(|line| !line.starts_with('#'));
    let names: Vec<&str> = rows.next().expect("names").split(',').collect();
    let row = rows.find(|row| row.starts_with("4.005,")).expect("a row");
    let values: Vec<f64> = row
        .split(',')
        .map(|n| n.parse().expect("a number"))
        .collect();
    let column = |name: &str| names.iter().position(|n| *n == name).expect("a column");
    for (k, name) in ["x_G", "y_G"].into_iter().enumerate() {
        let shown = browser.number(&format!("appell.place('G')[{k}]"));
        assert_close(shown, values[column(name)], SINGLE, name);
    }
    assert_close(browser.number("appell.time"), 4.005, SINGLE, "time");
    browser.press("Home");
    assert_close(browser.number("appell.time"), 0.0, SINGLE, "time");
    browser.press(" ");
    browser.wait("appell.playing && appell.time > 0.1");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn mechanisms_of_every_kind_move_without_a_complaint() {
    let folder = Folder::new();
    let Some(mut browser) = Browser::start(&folder.path("profile")) else {
        return;
    };
    for (scheme, point, arguments) in [
        (
            "light",
            "G2",
            vec!["double_pendulum", "--initial", "theta1=1"],
        ),
        ("dark", "G", vec!["euc_3dof", "--initial", "gamma=0.1"]),
        ("light", "P", vec!["bicycle", "--initial", "omega_R=-15"]),
        ("dark", "A", vec!["four_bar"]),
        ("light", "G", vec!["rolling_ball", "--initial", "omega_x=1"]),
    ] {
        page(&folder, &[&arguments[..], &["--t-end-s", "1"]].concat());
        browser.prefer(scheme);
        browser.open(&folder.path("film.html"));
        browser.wait("appell.pictures > 3");
        assert_eq!(
            browser.value("document.documentElement.dataset.theme"),
            json!(scheme)
        );
        let at = format!("JSON.stringify(appell.place('{point}'))");
        let before = browser.value(&at);
        browser.wait(&format!(
            "{at} != '{}'",
            before.as_str().unwrap_or_default()
        ));
        browser.draws(SMALLEST);
        assert_eq!(browser.value(NAMES), json!(true), "{arguments:?}");
        assert_eq!(browser.complaints(), [""; 0], "{arguments:?}");
    }
}

#[test]
fn a_browser_without_webgl_is_told_so_and_shows_the_values() {
    let folder = Folder::new();
    page(&folder, &["pendulum", "--initial", "theta=1"]);
    let Some(mut browser) = Browser::start(&folder.path("profile")) else {
        return;
    };
    let source = "HTMLCanvasElement.prototype.getContext = ((all) => function (kind, ...rest) {\
        return kind.startsWith('webgl') ? null : all.call(this, kind, ...rest);\
        })(HTMLCanvasElement.prototype.getContext)";
    browser.call(
        "Page.addScriptToEvaluateOnNewDocument",
        &json!({ "source": source }),
    );
    browser.open(&folder.path("film.html"));
    browser.wait("appell.time > 0.1");
    let told = browser.value("document.getElementById('message').innerText");
    assert!(
        told.as_str()
            .is_some_and(|told| told.contains("no WebGL 2")),
        "{told}"
    );
    browser.wait("document.querySelector('#values b').textContent.length > 0");
    assert_eq!(browser.complaints(), [""; 0]);
}

/// A spec whose texts try to leave their places.
const HOSTILE: &str = r#"
[mechanism]
name = "hostile"
title = "</title></script><script>globalThis.hacked=1</script><!--<img src=x onerror=hacked=1>"
source = "</script><script>globalThis.hacked=1</script>"
[parameters]
m = { value = 1, unit = "kg", about = "<script>globalThis.hacked=1</script>" }
l = { value = 1, unit = "m" }
[coordinates]
x = { unit = "m", about = "\"'><script>globalThis.hacked=1</script>" }
[points]
P = { from = "O", in = "ground", at = ["x", "l", 0], about = "<script>globalThis.hacked=1</script>" }
[bodies]
b = { centre = "P", mass = "m", about = "<script>globalThis.hacked=1</script>" }
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s", initial = 1 }
"#;

#[test]
fn the_text_of_a_spec_stays_text_on_the_page() {
    let folder = Folder::new();
    folder.write("hostile.toml", HOSTILE);
    page(&folder, &["hostile.toml"]);
    let html = folder.read("film.html");
    // The data and the scripts of the page.
    assert_eq!(html.matches("<script").count(), 2);
    assert_eq!(html.matches("</script").count(), 2);
    assert!(!html.contains("<img"));
    let Some(mut browser) = Browser::start(&folder.path("profile")) else {
        return;
    };
    browser.open(&folder.path("film.html"));
    browser.wait("appell.pictures > 3");
    assert_eq!(browser.value("typeof hacked"), json!("undefined"));
    let title = browser.value("document.title");
    let shown = browser.value("document.getElementById('title').textContent");
    assert_eq!(title, shown);
    assert!(shown.to_string().contains("<script>"), "{shown}");
    assert_eq!(browser.complaints(), [""; 0]);
}

#[test]
fn a_picture_that_the_browser_takes_away_comes_back() {
    let folder = Folder::new();
    page(&folder, &["pendulum", "--initial", "theta=1"]);
    let Some(mut browser) = Browser::start(&folder.path("profile")) else {
        return;
    };
    browser.open(&folder.path("film.html"));
    browser.wait("appell.pictures > 3");
    browser.draws(SMALLEST);
    browser.value(
        "globalThis.taken = document.getElementById('space').getContext('webgl2').getExtension('WEBGL_lose_context');\
         taken.loseContext()",
    );
    browser.wait("!document.getElementById('message').hidden");
    let before = browser.number("appell.time");
    browser.wait(&format!("appell.time != {before}"));
    browser.value("taken.restoreContext()");
    browser.wait("document.getElementById('message').hidden");
    browser.wait("appell.pictures > 3");
    browser.draws(SMALLEST);
    // The browser itself tells of the loss.
    let complaints = browser.complaints().into_iter();
    let others: Vec<String> = complaints.filter(|c| !c.contains("CONTEXT_LOST")).collect();
    assert_eq!(others, [""; 0]);
}

#[test]
fn the_page_is_small_and_all_our_own() {
    let folder = Folder::new();
    page(&folder, &["pendulum", "--initial", "theta=1"]);
    let html = folder.read("film.html");
    let (before, rest) = html.split_once("id=\"film\">").expect("data");
    let (_, after) = rest.split_once("</script>").expect("the end of the data");
    let size = before.len() + after.len();
    assert!(size <= LARGEST, "{size} bytes");
    for word in [
        "Copyright",
        "copyright",
        "©",
        "License",
        "licence",
        "three.js",
    ] {
        assert!(!html.contains(word), "`{word}`");
    }
}

#[test]
fn the_page_asks_nothing_of_a_network() {
    let folder = Folder::new();
    page(&folder, &["pendulum", "--initial", "theta=1"]);
    let html = folder.read("film.html");
    assert!(html.contains("default-src 'none'"));
    for start in [
        "src=",
        "href=",
        "url(",
        "import(",
        "@import",
        "fetch(\"http",
    ] {
        assert!(!html.contains(&format!("{start}\"http")), "{start}");
    }
    // The only address is the name of a language.
    let addresses = html
        .split("http")
        .skip(1)
        .filter(|rest| rest.starts_with("://") || rest.starts_with("s://"));
    for rest in addresses {
        assert!(rest.starts_with("://www.w3.org/"), "{}", &rest[..60]);
    }
}
