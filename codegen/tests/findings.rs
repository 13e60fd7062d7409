//! Errors of the derivation, reported at their positions, and specs that must be accepted.

use std::fmt::Write as _;
use std::time::Duration;

use appell_codegen::compile::{compile, derived};
use appell_codegen::formulations::compare;
use appell_codegen::program::FunctionKind;
use appell_codegen::schedule::schedule;
use appell_spec::{Code, Report};
use appell_test_kit::{ThreadTime, budget};

/// Processor time: a text this long to derive would make an editor wait.
const LONGEST_WAIT: Duration = Duration::from_secs(20);

fn refusal(text: &str) -> String {
    match compile("a.toml", text, &FunctionKind::STANDARD) {
        Ok(_) => panic!("it was accepted"),
        Err(report) => report.plain(),
    }
}

/// Warnings about a spec that is accepted.
fn warnings(text: &str) -> String {
    let derived = derived("a.toml", text).unwrap_or_else(|report| panic!("{}", report.plain()));
    Report::new("a.toml", text, derived.warnings).plain()
}

/// A point mass in space with its constraints and pseudo-velocities.
fn mass(constraints: &str, speeds: &str) -> String {
    format!(
        "[mechanism]\nname = 'mass'\ntitle = 'a mass'\n\
         [parameters]\nm = {{ value = 1, unit = 'kg' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\ny = {{ unit = 'm' }}\nz = {{ unit = 'm' }}\n\
         [points]\nP = {{ from = 'O', in = 'ground', at = ['x', 'y', 'z'] }}\n\
         [bodies]\nb = {{ centre = 'P', mass = 'm' }}\n\
         [constraints]\n{constraints}\n[pseudo_velocities]\n{speeds}\n"
    )
}

#[test]
fn a_constraint_that_follows_from_the_others_is_left_out_with_a_warning() {
    let rows = "first = { kind = 'velocity', zero = 'dot(x) + dot(y)' }\n\
                second = { kind = 'velocity', zero = 'dot(x) - dot(y)' }\n\
                third = { kind = 'velocity', zero = '3*dot(x)' }";
    let shown = warnings(&mass(rows, "w = 'dot(z)'"));
    assert!(shown.contains("redundant-constraint"), "{shown}");
    assert!(
        shown.contains("`third` follows from `first`, `second` and is left out"),
        "{shown}"
    );
}

#[test]
fn the_row_that_is_left_out_follows_in_every_configuration() {
    // At x = 0 the first is trivial, so the second must not be omitted.
    let rows = "first = { kind = 'velocity', zero = 'x*dot(x)' }\n\
                second = { kind = 'velocity', zero = 'dot(x)' }";
    let shown = warnings(&mass(rows, "v = 'dot(y)'\nw = 'dot(z)'"));
    assert!(shown.contains("`first` follows from `second`"), "{shown}");
    // At x = 0 one of them is needed, at y = 0 the other.
    let rows = "first = { kind = 'velocity', zero = 'x*dot(x)' }\n\
                second = { kind = 'velocity', zero = 'y*dot(x)' }";
    let shown = refusal(&mass(rows, "v = 'dot(y)'\nw = 'dot(z)'"));
    assert!(
        shown.contains("`second` follows from the other constraints, but not in every"),
        "{shown}"
    );
}

#[test]
fn mistakes_of_several_stages_are_told_at_once() {
    let rows = "still = { kind = 'velocity', zero = 'dot(x)' }\n\
                moving = { kind = 'velocity', zero = 'dot(x)', equals = '1 [m/s]' }\n\
                faster = { kind = 'velocity', zero = 'dot(x)', equals = '2 [m/s]' }";
    let text = mass(rows, "v = 'dot(y)'\nw = 'dot(z)'");
    let text = format!(
        "{text}[loads]\npull = {{ kind = 'force', on = 'P', in = 'ground', vector = ['1 [N]/(sin(x/1 [m])^2 + cos(x/1 [m])^2 - 1)', 0, 0] }}\n\
         [outputs]\nout = {{ value = 'x*tan(pi/2)', unit = 'm' }}\n"
    );
    let shown = refusal(&text);
    for part in [
        "`moving` contradicts",
        "`faster` contradicts",
        "pull = ",
        "out = ",
    ] {
        assert!(shown.contains(part), "{part} is not in {shown}");
    }
    assert_eq!(
        shown.matches("error[division-by-zero]").count(),
        2,
        "{shown}"
    );
}

#[test]
fn every_speed_without_mass_is_named() {
    let text = mass("", "u = 'dot(x)'\nv = 'dot(y)'\nw = 'dot(z)'")
        .replace("at = ['x', 'y', 'z']", "at = ['x', 0, 0]")
        .replace(
            "[constraints]",
            "[outputs]\no = { value = 'y + z', unit = 'm' }",
        );
    let shown = refusal(&text);
    assert!(shown.contains("`v` moves no mass"), "{shown}");
    assert!(shown.contains("`w` moves no mass"), "{shown}");
}

/// A mass on a rail with a spring to a point above the rail at a height.
fn spring(height: &str, range: &str) -> String {
    format!(
        "[mechanism]\nname = 'spring'\ntitle = 'a mass on a spring'\n\
         [parameters]\nm = {{ value = 1, unit = 'kg' }}\nh = {{ value = 1, unit = 'm' }}\n\
         [coordinates]\nx = {{ unit = 'm', initial = 1{range} }}\n\
         [points]\nP = {{ from = 'O', in = 'ground', at = ['x', 0, 0] }}\n\
         W = {{ from = 'O', in = 'ground', at = [0, 0, '{height}'] }}\n\
         [bodies]\nb = {{ centre = 'P', mass = 'm' }}\n\
         [pseudo_velocities]\nv = 'dot(x)'\n\
         [loads]\ns = {{ kind = 'spring', between = ['W', 'P'], stiffness = '1 [N/m]', relaxed = '0.5*h' }}\n"
    )
}

#[test]
fn a_spring_that_can_lose_its_length_is_warned_of() {
    assert!(!warnings(&spring("h", ", range = [-2, 2]")).contains("vanishing-length"));
    assert!(!warnings(&spring("0", ", range = [0.5, 2]")).contains("vanishing-length"));
    let through_the_wall = warnings(&spring("0", ", range = [-2, 2]"));
    assert!(
        through_the_wall.contains("vanishing-length"),
        "{through_the_wall}"
    );
    let at_rest = warnings(&spring("0", "").replace("initial = 1", "initial = 0"));
    assert!(at_rest.contains("vanishing-length"), "{at_rest}");
    let never = refusal(&spring("0", "").replace("['x', 0, 0]", "[0, 0, 0]"));
    assert!(never.contains("always coincide"), "{never}");
}

#[test]
fn pseudo_velocities_that_depend_on_each_other_at_the_start_are_warned_of() {
    let singular = "u = 'x*dot(x)'\nv = 'dot(y)'\nw = 'dot(z)'";
    let shown = warnings(&mass("", singular));
    assert!(
        shown.contains("do not determine `dot(x)` at the initial state"),
        "{shown}"
    );
    let elsewhere =
        mass("", singular).replace("x = { unit = 'm' }", "x = { unit = 'm', initial = 1 }");
    assert!(!warnings(&elsewhere).contains("at the initial state"));
}

#[test]
fn a_constraint_that_contradicts_the_others_is_named() {
    let rows = "still = { kind = 'velocity', zero = 'dot(x)' }\n\
                moving = { kind = 'velocity', zero = 'dot(x)', equals = '1 [m/s]' }";
    let shown = refusal(&mass(rows, "v = 'dot(y)'\nw = 'dot(z)'"));
    assert!(shown.contains("dependent-constraints"), "{shown}");
    assert!(
        shown.contains("`moving` contradicts the other constraints"),
        "{shown}"
    );
}

#[test]
fn a_division_by_zero_in_an_angle_is_told_at_its_frame() {
    let text = mass("", "u = 'dot(x)'\nv = 'dot(y)'\nw = 'dot(z)'")
        .replace("in = 'ground'", "in = 'arm'")
        + "[frames]\narm = { parent = 'ground', about_axis = 'z', by = 'x/(m - m)*(1 [kg/m])' }\n";
    let shown = refusal(&text);
    assert!(shown.contains("division-by-zero"), "{shown}");
    assert!(shown.contains("| ^^^\n"), "{shown}");
}

#[test]
fn an_imposed_position_brings_its_velocity_and_acceleration() {
    let text = "[mechanism]\nname = 'lift'\ntitle = 'a mass on a lift'\n\
         [parameters]\nm = { value = 1, unit = 'kg' }\n\
         [coordinates]\nx = { unit = 'm' }\n\
         [signals]\nlift = { t = [0, 1, 2], value = [0, 1, 0], unit = 'm', interpolation = 'cubic' }\n\
         [points]\nP = { from = 'O', in = 'ground', at = ['x', 0, 'lift'] }\n\
         [bodies]\nb = { centre = 'P', mass = 'm' }\n\
         [pseudo_velocities]\nv = 'dot(x)'\n";
    let program = compile("lift.toml", text, &FunctionKind::STANDARD)
        .unwrap_or_else(|report| panic!("{}", report.plain()));
    let names: Vec<_> = program
        .info
        .inputs
        .iter()
        .map(|input| input.name.as_ref())
        .collect();
    assert_eq!(names, ["lift", "lift_dot", "lift_ddot"]);
    for function in &program.functions {
        schedule(&program, function);
    }
}

#[test]
fn a_parameter_that_may_change_its_sign_is_no_safe_pivot() {
    let numeric = |limits: &str| {
        let text = format!(
            "[mechanism]\nname = 'slide'\ntitle = 'a mass'\n\
             [parameters]\nm = {{ value = 1, unit = 'kg' }}\na = {{ value = 1, unit = '1'{limits} }}\n\
             [coordinates]\nx = {{ unit = 'm' }}\n\
             [points]\nP = {{ from = 'O', in = 'ground', at = ['x', 0, 0] }}\n\
             [bodies]\nb = {{ centre = 'P', mass = 'm' }}\n\
             [pseudo_velocities]\nv = 'a*dot(x)'\n"
        );
        let derived =
            derived("slide.toml", &text).unwrap_or_else(|report| panic!("{}", report.plain()));
        derived.derivation.velocities.solved_numerically
    };
    assert!(numeric("").is_empty());
    assert_eq!(numeric(", at_least = -1, at_most = 2"), [0]);
}

#[test]
fn two_contacts_that_share_a_reaction_are_warned_of() {
    let text = "[mechanism]\nname = 'axle'\ntitle = 'two wheels on one axle'\n\
         [parameters]\nm = { value = 1, unit = 'kg' }\nR = { value = 1, unit = 'm' }\n\
         [coordinates]\nx = { unit = 'm' }\n\
         [frames]\nwheel = { parent = 'ground', about_axis = 'y', by = 'x/R' }\n\
         [points]\nC = { from = 'O', in = 'ground', at = ['x', 0, 'R'] }\n\
         A = { from = 'C', in = 'ground', at = [0, 'R', '-R'] }\n\
         B = { from = 'C', in = 'ground', at = [0, '-R', '-R'] }\n\
         [bodies]\nb = { frame = 'wheel', centre = 'C', mass = 'm', inertia = { in = 'ground', diagonal = ['m*R^2/2', 'm*R^2', 'm*R^2/2'] } }\n\
         [constraints]\nleft = { kind = 'rolling', body = 'b', contact = 'A' }\n\
         right = { kind = 'rolling', body = 'b', contact = 'B' }\n\
         [pseudo_velocities]\nv = 'dot(x)'\n";
    let shown = warnings(text);
    assert!(
        shown.contains("the reactions of `left` and `right` are statically indeterminate"),
        "{shown}"
    );
}

/// A wheel with constraints at the point where it touches the ground.
fn wheel(constraints: &str) -> String {
    format!(
        "[mechanism]\nname = 'wheel'\ntitle = 'a wheel'\n\
         [parameters]\nm = {{ value = 1, unit = 'kg' }}\nR = {{ value = 1, unit = 'm' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\nphi = {{ unit = 'rad' }}\n\
         [frames]\nwheel = {{ parent = 'ground', about_axis = 'y', by = 'phi' }}\n\
         [points]\nC = {{ from = 'O', in = 'ground', at = ['x', 0, 'R'] }}\n\
         P = {{ from = 'C', in = 'ground', at = [0, 0, '-R'] }}\n\
         [bodies]\nb = {{ frame = 'wheel', centre = 'C', mass = 'm', inertia = {{ in = 'ground', diagonal = ['m*R^2/2', 'm*R^2', 'm*R^2/2'] }} }}\n\
         [constraints]\n{constraints}\n\
         [pseudo_velocities]\nv = 'dot(x)'\n\
         [loads]\nweight = {{ kind = 'gravity', down = '-z', acceleration = '9.81[m/s^2]' }}\n"
    )
}

/// A contact of the wheel that only holds it off the ground.
const KERB: &str = "kerb = { kind = 'fixed_velocity', point = 'P', in = 'ground', \
                    direction = [0, 0, 1], one_sided = true }";
/// Its contact that grips.
const GRIP: &str = "grip = { kind = 'rolling', body = 'b', contact = 'P', friction = 0.8 }";

#[test]
fn of_contacts_at_one_point_the_one_that_grips_is_judged() {
    for constraints in [[KERB, GRIP], [GRIP, KERB]] {
        let text = wheel(&constraints.join("\n"));
        let derived =
            derived("a.toml", &text).unwrap_or_else(|report| panic!("{}", report.plain()));
        let contacts = &derived.derivation.contacts;
        assert_eq!(contacts.len(), 1, "{constraints:?}");
        assert!(contacts[0].grips, "{constraints:?}");
        assert!(contacts[0].friction.is_some(), "{constraints:?}");
        assert!(!warnings(&text).contains("contact-not-judged"));
    }
}

#[test]
fn a_contact_that_another_at_its_point_outdoes_is_warned_of() {
    let slide = KERB
        .replace("kerb", "slide")
        .replace("[0, 0, 1]", "[0, 0, -1]");
    let shown = warnings(&wheel(&[&slide, GRIP].join("\n")));
    assert!(
        shown.contains("the contact `slide` is not checked: `grip` is at the same point"),
        "{shown}"
    );
    let other = GRIP.replace("grip", "other").replace("0.8", "0.5");
    let shown = warnings(&wheel(&[GRIP, &other].join("\n")));
    assert!(
        shown.contains("the contact `other` is not checked: `grip` is at the same point"),
        "{shown}"
    );
}

/// A chain of links that turn against each other about changing axes.
pub(crate) fn chain(links: usize) -> String {
    let mut text = String::from(
        "[mechanism]\nname = 'chain'\ntitle = 'a chain'\n[parameters]\nm = { value = 1, unit = 'kg' }\n\
         l = { value = 1, unit = 'm' }\n",
    );
    let mut section = |name: &str, line: &dyn Fn(usize) -> String| {
        let _ = writeln!(text, "[{name}]");
        for i in 1..=links {
            let _ = writeln!(text, "{}", line(i));
        }
    };
    section("coordinates", &|i| format!("q{i} = {{ unit = 'rad' }}"));
    section("frames", &|i| {
        let parent = if i == 1 {
            "ground".to_owned()
        } else {
            format!("F{}", i - 1)
        };
        let axis = ["x", "y", "z"][i % 3];
        format!("F{i} = {{ parent = '{parent}', about_axis = '{axis}', by = 'q{i}' }}")
    });
    section("points", &|i| {
        let from = if i == 1 {
            "O".to_owned()
        } else {
            format!("P{}", i - 1)
        };
        format!("P{i} = {{ from = '{from}', in = 'F{i}', at = ['l', 'l', 'l'] }}")
    });
    section("bodies", &|i| {
        format!("b{i} = {{ centre = 'P{i}', mass = 'm' }}")
    });
    section("pseudo_velocities", &|i| format!("w{i} = 'dot(q{i})'"));
    text
}

#[test]
fn a_long_chain_neither_hangs_nor_fills_the_memory() {
    let start = ThreadTime::now();
    if let Err(report) = derived("chain.toml", &chain(budget(28, 40))) {
        assert!(report.plain().contains("too-large"), "{}", report.plain());
    }
    assert!(start.elapsed() < LONGEST_WAIT, "{:?}", start.elapsed());
}

#[test]
fn the_formulations_of_a_long_chain_are_compared_or_refused_in_time() {
    for links in [8, budget(16, 24)] {
        let Ok(chain) = derived("chain.toml", &chain(links)) else {
            continue;
        };
        let start = ThreadTime::now();
        match compare(&chain.mechanism, &chain.derivation) {
            Ok(verdict) => assert!(verdict.agrees(), "{links} links: {verdict:#?}"),
            Err(findings) => assert_eq!(findings[0].code, Code::TooLarge, "{findings:?}"),
        }
        assert!(start.elapsed() < LONGEST_WAIT, "{:?}", start.elapsed());
    }
}

/// A point with an output and with bodies of numbers that are too large together.
fn numbers(output: &str, mass: &str) -> String {
    format!(
        "[mechanism]\nname = 'numbers'\ntitle = 'numbers'\n[parameters]\nk = {{ value = 1, unit = '1/m' }}\n\
         [coordinates]\nx = {{ unit = 'm' }}\n[points]\n\
         P = {{ from = 'O', in = 'ground', at = ['x*1e200', 0, 0] }}\n\
         [bodies]\nb = {{ centre = 'P', mass = '{mass} [kg]' }}\n[pseudo_velocities]\nv = 'dot(x)'\n\
         [outputs]\no = {{ value = '{output}', unit = '1' }}\n"
    )
}

#[test]
fn a_number_beyond_double_precision_is_told_at_its_expression() {
    for output in [
        "1e300*1e300",
        "1e-300*1e-300",
        "1e300/1e-300",
        "1e200^2",
        "1e300*(k*x)*1e300",
        "(1e300*k*x)^64",
        "1/(1e-300*(k*x)*1e-300)",
    ] {
        let shown = refusal(&numbers(output, "1e-300"));
        assert!(shown.contains("error[not-finite]"), "{output}\n{shown}");
        assert!(shown.contains("o = {"), "{output}\n{shown}");
    }
    let shown = refusal(&numbers("k*x", "1"));
    assert!(shown.contains("error[not-finite]: the motion"), "{shown}");
    // The sum cancels to a number.
    let shown = warnings(&numbers("1e300*1e-300*(k*x)*1e150*1e-150", "1e-300"));
    assert!(!shown.contains("not-finite"), "{shown}");
}

/// Rationals would grow by a thousand bits with each factor.
#[test]
fn long_numbers_stay_cheap() {
    let factor = "1.234567890123456789012345678901234567e250*(k*x)*1.2345678901234567890123456789012345e-250*";
    let product = factor.repeat(30) + "1";
    let shown = warnings(&numbers(&product, "1e-300"));
    assert!(!shown.contains("error"), "{shown}");
}

/// The range proposed by the note about a divisor keeps it nonzero.
#[test]
fn limits_of_parameters_take_the_place_of_pivoting() {
    let text = include_str!("audit/singular-pseudo-velocities.limits.toml");
    let pivoted = derived("a.toml", text).expect("a valid spec").derivation;
    assert!(!pivoted.velocities.solved_numerically.is_empty());
    let limited = text
        .replace(
            "value = 1, unit = \"m\" }",
            "value = 1, unit = \"m\", at_least = 0.5, at_most = 2 }",
        )
        .replace("at_least = 0 }", "at_least = 0, at_most = 0.06 }");
    let solved = derived("a.toml", &limited)
        .expect("a valid spec")
        .derivation;
    assert!(solved.velocities.solved_numerically.is_empty());
}
