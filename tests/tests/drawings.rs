//! The drawings of all mechanisms, `docs/drawings`. `UPDATE_DRAWINGS=1` writes them anew.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::fs;
use std::sync::LazyLock;

use appell_report::drawing::{drawing, marked};
use appell_spec::Mechanism;
use appell_tests::shipped;

fn drawn(mechanism: &Mechanism) -> String {
    drawing(mechanism, shipped::derive(mechanism))
        .unwrap_or_else(|findings| panic!("{}: {findings:?}", mechanism.file))
}

/// Names and drawings of all mechanisms.
static ALL: LazyLock<Vec<(String, String)>> = LazyLock::new(|| {
    let names = shipped::names().into_iter();
    let entry = |name: String| {
        let svg = drawn(shipped::mechanism(&name));
        (name, svg)
    };
    names.map(entry).collect()
});

#[test]
fn the_drawings_of_all_mechanisms_are_those_of_the_documents() {
    let folder = shipped::workspace().join("docs/drawings");
    let gallery = fs::read_to_string(folder.with_file_name("gallery.md")).unwrap();
    let update = std::env::var_os("UPDATE_DRAWINGS").is_some();
    for (name, svg) in &*ALL {
        let file = folder.join(format!("{name}.svg"));
        if update {
            fs::write(&file, svg).unwrap();
        }
        let kept = fs::read_to_string(&file).unwrap_or_default();
        assert!(kept == *svg, "{}: set UPDATE_DRAWINGS=1", file.display());
        let shown = format!("\"drawings/{name}.svg\"");
        assert!(gallery.contains(&shown), "docs/gallery.md lacks {shown}");
    }
}

#[test]
fn rings_mark_joints_bodies_and_points_of_attack() {
    let mechanism = shipped::mechanism("cart_pole");
    let plain = drawn(mechanism);
    let rings = |names: &[&str]| {
        let svg = marked(mechanism, shipped::derive(mechanism), names).unwrap();
        let rings = svg.lines().filter(|line| line.contains("class=\"ring"));
        let place = |line: &str| {
            let [x, y] = ["cx", "cy"].map(|name| attribute(line, name)[0].parse().unwrap());
            [x, y]
        };
        rings.map(place).collect::<Vec<[f64; 2]>>()
    };
    let [cart, pole] = places(mechanism, &plain, ["C", "G"]);
    // The pole turns about the cart, and the force acts on it.
    for name in ["x", "theta", "omega", "cart", "F", "m_cart"] {
        assert_eq!(rings(&[name]), [cart], "{name}");
    }
    assert_eq!(rings(&["pole"]), [pole]);
    assert_eq!(rings(&["gravity", "nobody"]), Vec::<[f64; 2]>::new());
}

#[test]
fn a_ring_marks_a_motor_in_the_joint_where_it_acts() {
    for (name, input, joint) in [
        ("pendulum", "tau", "O"),
        ("double_pendulum", "tau1", "O"),
        ("double_pendulum", "tau2", "E"),
        ("euc_3dof", "M_d", "C"),
        ("euc_3dof", "M_h", "A"),
    ] {
        let mechanism = shipped::mechanism(name);
        let [place] = places(mechanism, &drawn(mechanism), [joint]);
        let svg = marked(mechanism, shipped::derive(mechanism), &[input]).unwrap();
        let mut rings = svg.lines().filter(|line| line.contains("class=\"ring"));
        let ring = rings.next().unwrap();
        let at: [f64; 2] = ["cx", "cy"].map(|name| attribute(ring, name)[0].parse().unwrap());
        let away = (at[0] - place[0]).hypot(at[1] - place[1]);
        assert!(away < DIGIT, "{name}: {input}");
        assert_eq!(rings.count(), 0, "{name}: {input}");
    }
}

/// Half of the last digit of the coordinates, several times.
const DIGIT: f64 = 0.3;
/// The length of the bar is known to a digit, and so is the scale that follows from it.
const BY_THE_BAR: f64 = 1.5;

/// The values of an attribute, in order.
fn attribute<'a>(svg: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!(" {name}=\"");
    let parts = svg.split(start.as_str()).skip(1);
    parts.map(|rest| rest.split('"').next().unwrap()).collect()
}

fn numbers(text: &str) -> Vec<f64> {
    let parts = text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    let parts = parts.filter(|part| !part.is_empty());
    parts.map(|part| part.parse().unwrap()).collect()
}

/// Where the points with these names are drawn: dots follow the order of the points.
fn places<const N: usize>(mechanism: &Mechanism, svg: &str, names: [&str; N]) -> [[f64; 2]; N] {
    let (x, y) = (attribute(svg, "cx"), attribute(svg, "cy"));
    names.map(|name| {
        let points = &mechanism.points;
        let index = points.iter().position(|point| point.name == name).unwrap();
        [x[index], y[index]].map(|number| number.parse().unwrap())
    })
}

/// Every coordinate of a drawing is a number inside the view box.
fn assert_inside(name: &str, svg: &str) {
    let size = numbers(attribute(svg, "viewBox")[0]);
    let (width, height) = (size[2], size[3]);
    let mut corners = Vec::new();
    for line in attribute(svg, "d") {
        corners.extend(numbers(line).chunks(2).map(|pair| [pair[0], pair[1]]));
    }
    for (x, y) in [("x", "y"), ("cx", "cy")] {
        let pairs = attribute(svg, x).into_iter().zip(attribute(svg, y));
        corners.extend(pairs.map(|(x, y)| [x, y].map(|number| number.parse().unwrap())));
    }
    assert!(corners.len() > 10, "{name}: {svg}");
    for [x, y] in corners {
        let inside = (0.0..=width).contains(&x) && (0.0..=height).contains(&y);
        assert!(inside, "{name}: ({x}, {y}) is outside {width} x {height}");
    }
}

#[test]
fn everything_is_drawn_on_the_paper() {
    for (name, svg) in &*ALL {
        assert_inside(name, svg);
    }
}

#[test]
fn the_points_of_a_leaning_unicycle_are_where_geometry_says() {
    let mut mechanism = shipped::mechanism("unicycle").clone();
    let (x_g, y_g, tilt, slide, radius) = (0.2_f64, 0.1, 0.4_f64, 0.15, 0.3);
    for q in &mut mechanism.coordinates {
        match q.label.name.as_str() {
            "x_G" => q.initial = x_g,
            "y_G" => q.initial = y_g,
            "theta" => q.initial = tilt,
            "r" => q.initial = slide,
            _ => {}
        }
    }
    let svg = drawn(&mechanism);
    let [o, g, p, a] = places(&mechanism, &svg, ["O", "G", "P", "A"]);
    // The bar of the scale is the last line: 0.1 m.
    let bar = numbers(attribute(&svg, "d").last().unwrap());
    let pixels = (bar[2] - bar[0]) / 0.1;
    let (sin, cos) = tilt.sin_cos();
    let wanted = [
        (g, [x_g, y_g, radius * cos]),
        (p, [x_g, y_g + radius * sin, 0.0]),
        (a, [x_g, y_g + slide * cos, radius * cos + slide * sin]),
    ];
    // The eye looks along -y turned by 32 degrees about z, from 20 degrees above.
    let [(sin_a, cos_a), (sin_e, cos_e)] = [32.0_f64, 20.0].map(|d| d.to_radians().sin_cos());
    for (drawn, [x, y, z]) in wanted {
        let right = x * cos_a + y * sin_a;
        let up = z * cos_e + (y * cos_a - x * sin_a) * sin_e;
        let [dx, dy] = [
            drawn[0] - o[0] - pixels * right,
            o[1] - drawn[1] - pixels * up,
        ];
        assert!(
            dx.abs() < BY_THE_BAR && dy.abs() < BY_THE_BAR,
            "off by {dx}, {dy}"
        );
    }
}

#[test]
fn the_loop_of_the_four_bar_linkage_is_drawn_closed() {
    let linkage = shipped::mechanism("four_bar");
    let svg = drawn(linkage);
    let [o, a, b, d] = places(linkage, &svg, ["O", "A", "B", "D"]);
    let span = |[x1, y1]: [f64; 2], [x2, y2]: [f64; 2]| (x2 - x1).hypot(y2 - y1);
    let metre = span(o, d) / 0.3;
    for (drawn, wanted) in [(span(o, a), 0.1), (span(a, b), 0.3), (span(b, d), 0.25)] {
        assert!(
            (drawn - wanted * metre).abs() < DIGIT,
            "{drawn}: {wanted} m"
        );
    }
}

/// A mass at a place with three components that depend on `x`, which starts at zero.
fn mass_at(title: &str, place: &str) -> Mechanism {
    let spec = format!(
        "[mechanism]\nname = 'mass'\ntitle = {title:?}\n\
         [parameters]\nm = {{ value = 1, unit = 'kg' }}\nl = {{ value = 1, unit = 'm' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\n\
         [points]\nP = {{ from = 'O', in = 'ground', at = [{place}] }}\n\
         [bodies]\nb = {{ centre = 'P', mass = 'm' }}\n\
         [pseudo_velocities]\nv = {{ value = 'dot(x)', unit = 'm/s' }}\n"
    );
    shipped::read("mass.toml", &spec)
}

#[test]
fn what_is_nowhere_or_far_away_is_told_and_not_drawn() {
    for place in ["x + l*ln(x/l)", "x + 1e200*l"] {
        let svg = drawn(&mass_at("A mass", &format!("'{place}', 0, 0")));
        assert!(svg.contains("(position not finite): P"), "{svg}");
        assert_inside(place, &svg);
    }
}

#[test]
fn a_mechanism_of_any_size_has_a_drawing() {
    for place in [
        "x",
        "x + 1e99*l",
        "x + 1e-99*l",
        "x + 1e-300*l",
        "x - 1e16*l",
    ] {
        let svg = drawn(&mass_at("A mass", &format!("'{place}', 0, 0")));
        assert!(!svg.contains("nowhere"), "{svg}");
        assert_inside(place, &svg);
    }
}

#[test]
fn a_mass_far_away_on_the_line_of_sight_is_drawn_on_few_squares() {
    let [(sin_a, cos_a), (sin_e, cos_e)] = [32.0_f64, 20.0].map(|d| d.to_radians().sin_cos());
    let sight = [-sin_a * cos_e, cos_a * cos_e, -sin_e];
    let [x, y, z] = sight.map(|c| format!("{:.16}*l", 1e9 * c));
    let svg = drawn(&mass_at("A mass", &format!("'x + {x}', '{y}', '{z}'")));
    assert_inside("on the line of sight", &svg);
    assert!(svg.matches("class=\"grid\"").count() < 50, "{svg}");
}

#[test]
fn the_text_of_a_spec_stays_text() {
    let svg = drawn(&mass_at("</text><script>alert('&')</script>", "'x', 0, 0"));
    assert!(!svg.contains("<script"), "{svg}");
    assert!(svg.contains("&lt;script&gt;"), "{svg}");
}
