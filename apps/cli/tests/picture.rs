//! Pictures by the name of their file. PNG is a feature: the gate runs this file with it, and
//! `cargo test --workspace` without.

use crate::support::Folder;

const DRAW: [&str; 4] = ["draw", "pendulum", "--out", "pendulum.png"];

#[cfg(feature = "png")]
#[test]
fn a_png_is_twice_as_large_as_its_svg_and_shows_lines_and_letters() {
    use resvg::tiny_skia::Pixmap;
    let folder = Folder::new();
    folder.done(&DRAW);
    folder.done(&["draw", "pendulum", "--out", "pendulum.svg"]);
    let svg = folder.read("pendulum.svg");
    let size = |name: &str| -> u32 {
        let (_, from) = svg.split_once(&format!("{name}=\"")).expect("a size");
        let (value, _) = from.split_once('"').expect("a value");
        value.parse().expect("a whole number")
    };
    let drawn = Pixmap::load_png(folder.path("pendulum.png")).expect("a PNG");
    let twice = ["width", "height"].map(|name| 2 * size(name));
    assert_eq!([drawn.width(), drawn.height()], twice);
    // The title stands in the first rows, alone: letters, not only lines.
    let dark = |row: usize| {
        let pixels = drawn.pixels().chunks(drawn.width() as usize).nth(row);
        pixels.is_some_and(|row| row.iter().any(|pixel| pixel.red() < 100))
    };
    assert!((0..60).any(dark), "no title");
    assert!((60..drawn.height() as usize).any(dark), "no drawing");
}

#[cfg(not(feature = "png"))]
#[test]
fn without_the_feature_the_error_tells_how_to_get_it_and_nothing_is_written() {
    let folder = Folder::new();
    folder.fails(2, &DRAW, &["--features png", ".svg"]);
    assert!(folder.files().is_empty());
}
