//! Ensembles: statistics of motions whose distributions are known, and rows that depend on their cases alone.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use appell::control::Request;
use appell::ensemble::{Ensemble, Folder, Role, Rows, Running, Store, Summary, Watch};
use appell::{Model, Motion, json};
use appell_runtime::integrate::Options;

/// A mass on a spring, ω = 2 1/s. With x and v/ω normal of one deviation at the start they are so at all times.
pub(crate) const OSCILLATOR: &str = r#"
[mechanism]
name = "oscillator"
title = "Mass on a spring"
[parameters]
m = { value = 1, unit = "kg", about = "mass", at_least = 0 }
k = { value = 4, unit = "N/m", about = "stiffness", at_least = 0 }
[coordinates]
x = { unit = "m", about = "position" }
[inputs]
F = { unit = "N", about = "force" }
[points]
P = { from = "O", in = "ground", at = ["x", 0, 0], about = "mass" }
[bodies.mass]
centre = "P"
mass = "m"
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s", about = "velocity" }
[loads]
spring = { kind = "generalized", velocity = "v", force = "F - k*x", about = "spring and force" }
"#;

pub(crate) const STUDY: &str = r#"
[study]
model = "oscillator.toml"
cases = 4000
[motion]
t_end_s = 4
dt_s = 1
[vary]
x = { normal = [0, 0.1] }
v = { normal = [0, 0.2] }
[keep]
reached = { end = "x" }
middle = { end = "x", at_s = 1.5 }
swing = { max = "abs(x)" }
square = { mean = "x*x" }
far = { when = "abs(x) > 0.25[m]" }
path = { course = "x" }
"#;

/// A folder that is removed at the end of the test.
pub(crate) struct Scratch(pub(crate) PathBuf);

impl Scratch {
    /// One of its own, whoever else takes the name at the same time.
    pub(crate) fn new(name: &str) -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(0);
        let (process, number) = (std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed));
        let path =
            Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{process}-{number}"));
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("oscillator.toml"), OSCILLATOR).unwrap();
        Self(path)
    }

    pub(crate) fn ensemble(&self, study: &str) -> Ensemble {
        Ensemble::parse("study.toml", study, &self.0).unwrap()
    }

    pub(crate) fn store(&self, name: &str) -> Folder {
        Folder::new(&self.0.join(name)).unwrap()
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub(crate) fn filled(ensemble: &Ensemble, store: &dyn Store, running: Running) -> Summary {
    let missing = ensemble.missing(store, running).unwrap().chunks;
    let watch = Watch {
        go_on: &|| true,
        done: &|_| {},
    };
    ensemble.fill(store, &missing, running, watch).unwrap();
    ensemble.summary(store).unwrap()
}

pub(crate) fn column(ensemble: &Ensemble, name: &str) -> usize {
    let mut columns = ensemble.columns().iter();
    columns.position(|column| column.name == name).unwrap()
}

#[test]
fn statistics_of_an_oscillator_are_those_of_its_distributions() {
    let scratch = Scratch::new("oscillator");
    let ensemble = scratch.ensemble(STUDY);
    let summary = filled(&ensemble, &scratch.store("out"), Running::default());
    assert_eq!((summary.done, summary.early.len()), (4000, 0));
    for name in ["reached", "middle"] {
        let number = summary.number(column(&ensemble, name)).unwrap();
        // Four standard errors.
        assert!(number.moments.mean.abs() < 0.4 / 4000_f64.sqrt(), "{name}");
        assert!((number.moments.deviation() - 0.1).abs() < 0.003, "{name}");
        let [low, high] = number.quantiles[4].interval.map(Option::unwrap);
        assert!((low..high).contains(&0.164_485), "{name}: {low} {high}");
    }
    // The amplitude is that of Rayleigh: P(amplitude > a) = exp(-a² / 2σ²).
    let event = &summary.events[0];
    let known = (-0.25_f64.powi(2) / 0.02).exp();
    assert!(
        (event.wilson[0]..event.wilson[1]).contains(&known),
        "{event:?}"
    );
    let swing = summary.number(column(&ensemble, "swing")).unwrap();
    let [low, high] = swing.moments.interval().unwrap();
    let mean = 0.1 * (std::f64::consts::PI / 2.0).sqrt();
    assert!((low..high).contains(&mean), "{low} {high} {mean}");
    // 5 % and 95 % at every time.
    for (place, z) in [(0, -1.644_854), (2, 0.0), (4, 1.644_854)] {
        for value in &summary.courses[0].bands[place] {
            assert!((value - 0.1 * z).abs() < 0.008, "{place}: {value}");
        }
    }
    assert_eq!(summary.courses[0].times, [0.0, 1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn kept_numbers_of_a_case_are_those_of_its_motion() {
    let scratch = Scratch::new("numbers");
    let ensemble = scratch.ensemble(STUDY);
    let rows = ensemble.rows(0..50);
    for case in 0..50 {
        let value = |name: &str| rows.values[column(&ensemble, name)][case];
        let (x, v) = (value("x"), value("v"));
        let at = |t: f64| x * (2.0 * t).cos() + 0.5 * v * (2.0 * t).sin();
        let amplitude = x.hypot(0.5 * v);
        let near = |found: f64, wanted: f64| (found - wanted).abs() < 1e-8;
        assert!(near(value("reached"), at(4.0)));
        assert!(near(value("middle"), at(1.5)));
        assert!(near(value("path@3"), at(3.0)));
        assert!(
            near(value("swing"), amplitude),
            "{} {amplitude}",
            value("swing")
        );
        let when = value("swing_t_s");
        assert!((at(when).abs() - amplitude).abs() < 1e-8);
        // ∫ x² over 4 s by the primitive.
        let steps: Vec<f64> = (0..4000)
            .map(|k| at((f64::from(k) + 0.5) / 1000.0).powi(2))
            .collect();
        let mean = steps.iter().sum::<f64>() / 4000.0;
        assert!(
            (value("square") - mean).abs() < 1e-7,
            "{} {mean}",
            value("square")
        );
        let far = value("far");
        assert_eq!(far > 0.0, amplitude > 0.25);
        if far > 0.0 {
            let t = value("far_t_s");
            assert!(t == 0.0 || near(at(t).abs(), 0.25), "{t}");
        } else {
            assert!(value("far_t_s").is_nan());
        }
    }
}

/// Bits of all rows.
#[test]
fn events_at_the_start_are_those_of_the_assembled_mechanism() {
    // The spec guesses 1.8 rad for the rocker, which stands at 1.555 rad.
    let study = r#"
[study]
model = "four_bar"
cases = 2
[motion]
t_end_s = 0.01
[vary]
theta1 = { uniform = ["1rad", "1.001rad"] }
[keep]
high = { when = "theta3 > 1.7[rad]", stop = true }
low = { when = "theta3 < 1.7[rad]" }
"#;
    let ensemble = Ensemble::parse("study.toml", study, Path::new(".")).unwrap();
    let rows = ensemble.rows(0..2);
    let named = |name: &str| {
        let mut columns = ensemble.columns().iter();
        &rows.values[columns.position(|column| column.name == name).unwrap()]
    };
    assert_eq!(named("high"), &[0.0, 0.0]);
    assert_eq!(named("low"), &[1.0, 1.0]);
    assert_eq!(named("low_t_s"), &[0.0, 0.0]);
    assert_eq!(rows.ends, [0.01, 0.01]);
}

fn bits(ensemble: &Ensemble, store: &dyn Store) -> Vec<u64> {
    let mut bits = Vec::new();
    ensemble
        .scan(store, |rows: &Rows| {
            for row in 0..rows.len() {
                bits.extend(rows.values.iter().map(|column| column[row].to_bits()));
                bits.push(rows.ends[row].to_bits());
            }
        })
        .unwrap();
    bits
}

#[test]
fn rows_and_statistics_do_not_depend_on_threads_chunks_and_shards() {
    let scratch = Scratch::new("threads");
    for sampling in ["random", "latin", "sobol"] {
        let study = STUDY.replace(
            "cases = 4000",
            &format!("cases = 150\nsampling = \"{sampling}\""),
        );
        let ensemble = scratch.ensemble(&study);
        let name = |way: &str| scratch.store(&format!("{sampling}-{way}"));
        let one = name("one");
        let alone = Running {
            jobs: Some(1),
            chunk: Some(150),
            ..Running::default()
        };
        let reference = json::ensemble(ensemble.columns(), &filled(&ensemble, &one, alone));
        let expected = bits(&ensemble, &one);
        let threads = name("threads");
        let many = Running {
            jobs: Some(3),
            chunk: Some(7),
            ..Running::default()
        };
        let summary = filled(&ensemble, &threads, many);
        assert_eq!(json::ensemble(ensemble.columns(), &summary), reference);
        assert_eq!(bits(&ensemble, &threads), expected);
        // Shards of one size, then what is missing in chunks of another.
        let shards = name("shards");
        let shard = Running {
            shard: Some("2/3".parse().unwrap()),
            ..many
        };
        filled(&ensemble, &shards, shard);
        let other = Running {
            chunk: Some(11),
            ..Running::default()
        };
        let summary = filled(&ensemble, &shards, other);
        assert_eq!(json::ensemble(ensemble.columns(), &summary), reference);
        assert_eq!(bits(&ensemble, &shards), expected);
    }
}

#[test]
fn random_cases_stay_the_same_when_there_are_more() {
    let scratch = Scratch::new("more");
    let few = scratch.ensemble(&STUDY.replace("4000", "30"));
    let many = scratch.ensemble(&STUDY.replace("4000", "60"));
    let store = scratch.store("out");
    filled(&few, &store, Running::default());
    let missing = many.missing(
        &store,
        Running {
            chunk: Some(30),
            ..Running::default()
        },
    );
    assert_eq!(missing.unwrap().chunks.len(), 1);
    let bits = |rows: Rows| {
        rows.values
            .concat()
            .iter()
            .map(|v| v.to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(few.rows(0..30)), bits(many.rows(0..30)));
}

/// y = sin x₁ + 7 sin² x₂ + 0.1 x₃⁴ sin x₁ over the cube from -π to π (T. Ishigami and T. Homma, 1990).
#[test]
fn sensitivity_indices_of_the_ishigami_function_are_the_known_ones() {
    let scratch = Scratch::new("ishigami");
    let study = r#"
[study]
model = "oscillator.toml"
cases = 2048
sampling = "sensitivity"
[motion]
t_end_s = 1e-3
[vary]
x_1 = { uniform = ["-pi", "pi"], unit = "1" }
x_2 = { uniform = ["-pi", "pi"], unit = "1" }
x_3 = { uniform = ["-pi", "pi"], unit = "1" }
[keep]
y = { end = "sin(x_1) + 7*sin(x_2)^2 + 0.1*x_3^4*sin(x_1)" }
"#;
    let ensemble = scratch.ensemble(study);
    assert_eq!(ensemble.design().cases(), 2048 * 5);
    let summary = filled(&ensemble, &scratch.store("out"), Running::default());
    let indices = summary.effects[0].indices.as_ref().unwrap();
    let known = [[0.3139, 0.5576], [0.4424, 0.4424], [0.0, 0.2437]];
    for (found, [first, total]) in indices.iter().zip(known) {
        for (index, known) in [(found.first, first), (found.total, total)] {
            assert!((index.value - known).abs() < 0.01, "{index:?} {known}");
            let [low, high] = index.interval;
            assert!(
                low - 0.01 < known && known < high + 0.01,
                "{index:?} {known}"
            );
        }
    }
}

#[test]
fn correlated_factors_are_as_correlated_as_they_should_be() {
    let scratch = Scratch::new("correlated");
    let study = STUDY.replace(
        "cases = 4000",
        "cases = 2000\ncorrelations = [[\"x\", \"v\", -0.7]]",
    );
    let rows = scratch.ensemble(&study).rows(0..2000);
    let [x, v] = [&rows.values[0], &rows.values[1]];
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let found = product(x, v) / (product(x, x) * product(v, v)).sqrt();
    assert!((found + 0.7).abs() < 0.03, "{found}");
}

#[test]
fn grids_choices_tables_and_laws_vary() {
    let scratch = Scratch::new("grids");
    let law = |gain: u32| {
        format!("mechanism = \"oscillator\"\ninput = \"F\"\nstates = [\"v\"]\ngains = [{gain}]\n")
    };
    std::fs::write(scratch.0.join("soft.toml"), law(1)).unwrap();
    std::fs::write(scratch.0.join("hard.toml"), law(8)).unwrap();
    std::fs::write(scratch.0.join("points.csv"), "m,x\n1,0.1\n2,0.2\n3,0.3\n").unwrap();
    let study = r#"
[study]
model = "oscillator.toml"
table = "points.csv"
[motion]
t_end_s = 2
initial.v = "x0/(1[s])"
[vary]
feedback = { grid = ["soft.toml", "hard.toml"] }
k = { range = [3, 5], count = 3 }
x0 = { choice = ["10cm", "20cm"], unit = "cm" }
[keep]
swing = { max = "abs(x)" }
start = { end = "v", at_s = 0 }
"#;
    let ensemble = scratch.ensemble(study);
    assert_eq!(ensemble.design().cases(), 2 * 3 * 3);
    let rows = ensemble.rows(0..18);
    let value = |name: &str| &rows.values[column(&ensemble, name)];
    assert_eq!(value("feedback")[..9], [0.0; 9]);
    assert_eq!(
        value("k")[..9],
        [3.0, 3.0, 3.0, 4.0, 4.0, 4.0, 5.0, 5.0, 5.0]
    );
    assert_eq!(value("m")[..6], [1.0, 2.0, 3.0, 1.0, 2.0, 3.0]);
    assert_eq!(value("x")[..3], [0.1, 0.2, 0.3]);
    assert!(value("x0").iter().all(|x| [0.1, 0.2].contains(x)));
    assert_eq!(value("start"), value("x0"));
    assert!(matches!(&ensemble.columns()[0].role, Role::Factor(items) if items.len() == 2));
    // More damping, less swing.
    assert!(value("swing")[0] > value("swing")[9]);
}

/// White noise, held for `every`, moves a free mass by a random walk of its velocity: as a force, and as the error of
/// the position that a law measures to hold against the spring.
#[test]
fn noise_moves_a_mass_as_far_as_it_should() {
    let scratch = Scratch::new("noise");
    for motion in [
        "set.k = 0\ninput.F = \"gust\"\n[noise]\ngust = { deviation = 2, every_s = 0.1, unit = \"N\" }",
        "set.k = 2\ninput.F = \"k*x\"\n[noise]\nx = { deviation = \"100cm\", every_s = 0.1 }",
    ] {
        let study = format!(
            "[study]\nmodel = \"oscillator.toml\"\ncases = 1500\n[motion]\nt_end_s = 1\n{motion}\n\
             [keep]\nspeed = {{ end = \"v\" }}\n"
        );
        let rows = scratch.ensemble(&study).rows(0..1500);
        let variance = rows.values[0].iter().map(|v| v * v).sum::<f64>() / 1500.0;
        // Ten independent steps of 0.2 m/s.
        assert!((variance - 0.4).abs() < 0.04, "{variance}");
    }
}

#[test]
fn a_kept_noise_is_what_acts() {
    let scratch = Scratch::new("kept_noise");
    let study = "[study]\nmodel = \"oscillator.toml\"\ncases = 50\n[motion]\nt_end_s = 1\ninput.F = \"gust\"\n\
        [noise]\ngust = { deviation = 2, every_s = 0.3, unit = \"N\" }\n\
        [keep]\nforce = { end = \"F\" }\nnoise = { end = \"gust\" }\nboth = { max = \"abs(F - gust)\" }\n";
    let ensemble = scratch.ensemble(study);
    let rows = ensemble.rows(0..50);
    let of = |name: &str| &rows.values[column(&ensemble, name)];
    assert_eq!(of("force"), of("noise"));
    assert!(
        of("noise")
            .iter()
            .any(|value| (value - of("noise")[0]).abs() > STATED)
    );
    assert!(of("both").iter().all(|value| *value == 0.0));
}

/// A free mass that passes a place: x = t.
const PASSING: &str = "[study]\nmodel = \"oscillator.toml\"\ncases = 20\n[motion]\nt_end_s = 10\ndt_s = 0.2\nset.k = 0\n\
    [vary]\nv = { uniform = [1, 1] }\nx = { uniform = [0, 0.3] }\n[keep]\n";

#[test]
fn what_comes_and_goes_between_samples_counts() {
    let scratch = Scratch::new("passing");
    let kept = "wide = { when = \"if(abs(x - 5.5[m]) < 0.0125[m], 1, 0) > 0.5\" }\n\
        smooth = { when = \"exp(-((x - 5.5[m])/1e-3[m])^2) > 0.5\" }\n\
        peak = { max = \"exp(-((x - 5.5[m])/1e-3[m])^2)\" }\n\
        part = { mean = \"if(sin(30[1/m]*x) > 0.9, 1, 0)\" }\n";
    let study = PASSING.replace("uniform = [1, 1]", "uniform = [0.999, 1]") + kept;
    for method in ["dop853", "dopri5"] {
        let study = study.replace("t_end_s", &format!("method = \"{method}\"\nt_end_s"));
        let ensemble = scratch.ensemble(&study);
        let rows = ensemble.rows(0..20);
        let of = |name: &str| &rows.values[column(&ensemble, name)];
        for name in ["wide", "smooth"] {
            assert!(
                of(name).iter().all(|happened| *happened > 0.5),
                "{method} {name}"
            );
        }
        assert!(
            of("peak").iter().all(|peak| (peak - 1.0).abs() < STATED),
            "{method}"
        );
        // Of 47.7 periods; the part of one that counts is acos(.9)/π.
        let share = 0.9_f64.acos() / std::f64::consts::PI;
        assert!(
            of("part")
                .iter()
                .all(|part| (part - share).abs() < 0.02 * share),
            "{method}"
        );
    }
}

#[test]
fn a_quantity_that_is_no_number_for_a_part_of_the_motion_is_missing() {
    let scratch = Scratch::new("undefined");
    let study = PASSING.replace("uniform = [1, 1]", "uniform = [0.999, 1]")
        + "least = { min = \"acos(x/5[m])\" }\nmost = { max = \"sqrt(x/1[m] - 3)\" }\n\
           all = { mean = \"sqrt(x/1[m] - 3)\" }\n";
    let ensemble = scratch.ensemble(&study);
    let rows = ensemble.rows(0..20);
    for name in ["least", "most", "all"] {
        let of = &rows.values[column(&ensemble, name)];
        assert!(of.iter().all(|value| value.is_nan()), "{name}: {of:?}");
    }
}

#[test]
fn a_motion_under_a_law_is_that_of_simulate() {
    let scratch = Scratch::new("laws");
    let model = Model::shipped("cart_pole").unwrap();
    let design = model.control(&Request::default().poles("-3")).unwrap();
    let law = model.law(&design).unwrap();
    let scheduled = "\
inputs = ['F']
states = ['x', 'theta', 'v', 'omega']
over = 'theta'
[[at]]
value = -0.1
gains = [1, 2, 1, 0.5]
[[at]]
value = 0.1
gains = [2, 3, 1.5, 0.7]
";
    let laws = [
        ("continuous", law.clone()),
        ("sampled", format!("sampled_ms = 20\ndelay_ms = 5\n{law}")),
        ("scheduled", scheduled.to_owned()),
    ];
    for (name, law) in laws {
        std::fs::write(scratch.0.join("law.toml"), &law).unwrap();
        let study = "[study]\nmodel = \"cart_pole\"\ncases = 11\n\
             [motion]\nt_end_s = 0.9\nrtol = 1e-11\natol = 1e-11\nfeedback = \"law.toml\"\n\
             [vary]\ntheta = { uniform = [0.05, 0.2] }\n\
             [keep]\nx = { end = \"x\" }\nomega = { end = \"omega\" }\n";
        let ensemble = scratch.ensemble(study);
        let rows = ensemble.rows(0..11);
        for case in 0..11 {
            let theta = rows.values[column(&ensemble, "theta")][case];
            let motion = Motion::new(0.9)
                .initial("theta", format!("{theta}rad"))
                .feedback(&law);
            let motion = Motion {
                options: Options::with_tolerances(1e-11, 1e-11),
                ..motion
            };
            let motion = model.simulate(&motion).unwrap().trajectory;
            for kept in ["x", "omega"] {
                let expected = *motion.column(kept).unwrap().last().unwrap();
                let found = rows.values[ensemble
                    .columns()
                    .iter()
                    .rposition(|c| c.name == kept)
                    .unwrap()][case];
                assert!(
                    (found - expected).abs() < 1e-9,
                    "{name}, {kept}: {found} {expected}"
                );
            }
        }
    }
}

#[test]
fn an_event_that_stops_ends_the_motion_there() {
    let scratch = Scratch::new("stop");
    let study = STUDY.replace("0.25[m]\"", "0.05[m]\", stop = true");
    let ensemble = scratch.ensemble(&study);
    let rows = ensemble.rows(0..100);
    let value = |name: &str| &rows.values[column(&ensemble, name)];
    let mut stopped = 0;
    for case in 0..100 {
        assert_eq!(rows.reasons[case], "");
        if value("far")[case] > 0.0 {
            stopped += 1;
            let t = value("far_t_s")[case];
            assert_eq!(rows.ends[case].to_bits(), t.to_bits());
            let reached = value("reached")[case].abs();
            assert!(t == 0.0 || (reached - 0.05).abs() < 1e-9, "{reached}");
        } else {
            assert_eq!(rows.ends[case].to_bits(), 4_f64.to_bits());
        }
    }
    assert!((50..100).contains(&stopped), "{stopped}");
}

/// Steps end where an input switches at a time that differs from case to case.
#[test]
fn an_input_switches_at_a_time_that_varies() {
    let scratch = Scratch::new("switch");
    let study = r#"
[study]
model = "oscillator.toml"
cases = 20
[motion]
t_end_s = 3
set.k = 0
input.F = "if(t < t_push, 0, 1)"
[vary]
t_push = { uniform = [1, 2], unit = "s" }
[keep]
speed = { end = "v" }
"#;
    let rows = scratch.ensemble(study).rows(0..20);
    for (t, v) in rows.values[0].iter().zip(&rows.values[1]) {
        assert!((v - (3.0 - t)).abs() < 1e-13, "{t} {v}");
    }
}

#[test]
fn a_motion_that_ends_early_is_a_row_with_its_reason() {
    let scratch = Scratch::new("early");
    let spec = OSCILLATOR.replace(
        "about = \"position\"",
        "about = \"position\", range = [-0.2, 0.2]",
    );
    std::fs::write(scratch.0.join("oscillator.toml"), spec).unwrap();
    let ensemble = scratch.ensemble(&STUDY.replace("4000", "200"));
    let summary = filled(&ensemble, &scratch.store("out"), Running::default());
    let (reason, count) = &summary.early[0];
    assert_eq!(reason, "`x` leaves its range");
    let reached = summary.number(column(&ensemble, "reached")).unwrap();
    assert!(*count > 10 && reached.moments.missing == *count, "{count}");
    // Of those that ended early it is known only where it happened.
    let event = &summary.events[0];
    assert!(
        event.happened > 0 && event.of + count == 200 + event.happened,
        "{event:?}"
    );
}

/// The amplitude is that of Rayleigh: P(amplitude > 5.26 σ) = 1e-6.
#[test]
fn the_probability_of_a_rare_swing_is_found_by_splitting() {
    let scratch = Scratch::new("rare");
    let study = STUDY
        .replace("0.25[m]", "0.5256521769[m]")
        .replace("4000", "10");
    let ensemble = scratch.ensemble(&format!(
        "{study}[rare]\nevent = \"far\"\nparticles = 2000\n"
    ));
    let store = scratch.store("out");
    let watch = Watch {
        go_on: &|| true,
        done: &|_| {},
    };
    let running = Running::default();
    let missing = ensemble.missing_replicates(&store, running).unwrap().chunks;
    assert_eq!(missing.len(), 10);
    ensemble
        .fill_replicates(&store, &missing[..3], running, watch)
        .unwrap();
    assert_eq!(ensemble.probability(&store).unwrap(), None);
    let left = ensemble.missing_replicates(&store, running).unwrap().chunks;
    ensemble
        .fill_replicates(&store, &left, running, watch)
        .unwrap();
    let found = ensemble.probability(&store).unwrap().unwrap();
    let [low, high] = found.interval;
    assert!(low < 1e-6 && 1e-6 < high && high / low < 4.0, "{found:?}");
    assert!(found.evaluations < 1e6, "{found:?}");
}

/// A wheel that rolls at a constant speed, whose states are linear in time: the steps are as long as the motion.
const ROLLING: &str = r#"
[study]
model = "rolling_wheel"
cases = 4
[motion]
t_end_s = 10
method = "dop853"
initial.omega_2 = "10"
[vary]
m = { scatter = "5%" }
[keep]
square = { mean = "sin(phi)^2" }
top = { max = "sin(phi)" }
low = { min = "cos(phi)" }
bend = { mean = "abs(sin(phi))" }
passes = { when = "sin(phi) > 0.99" }
stops = { when = "sin(phi) < -0.999", stop = false }
end = { end = "phi" }
"#;

/// Of the largest value of a quantity.
const STATED: f64 = 1e-6;

#[test]
fn statistics_do_not_depend_on_the_length_of_steps() {
    let scratch = Scratch::new("rolling");
    for method in ["dop853", "dopri5"] {
        let ensemble = scratch.ensemble(&ROLLING.replace("dop853", method));
        let rows = ensemble.rows(0..4);
        let value = |name: &str| rows.values[column(&ensemble, name)][0];
        let phi = value("end");
        assert!((phi.abs() - 100.0).abs() < 1e-6, "{phi}");
        let near = |name: &str, wanted: f64| {
            let found = value(name);
            assert!(
                (found - wanted).abs() < STATED,
                "{method} {name}: {found} {wanted}"
            );
        };
        near("square", 0.5 - 200_f64.sin() / 400.0);
        near("top", 1.0);
        near("low", -1.0);
        // 31 whole half turns, then the rest.
        let rest = 1.0 - (100.0 - 31.0 * std::f64::consts::PI).cos();
        near("bend", (62.0 + rest) / 100.0);
        near("passes", 1.0);
        let sign = phi.signum();
        let first = |sine: f64| {
            let angle = (sign * sine).asin();
            if angle > 0.0 {
                angle
            } else {
                std::f64::consts::PI - angle
            }
        };
        near("passes_t_s", first(0.99) / 10.0);
        near("stops_t_s", first(-0.999) / 10.0);
    }
    let stopped = scratch.ensemble(&ROLLING.replace("stop = false", "stop = true"));
    let rows = stopped.rows(0..1);
    let end = rows.ends[0];
    assert!((0.0..0.7).contains(&end), "{end}");
}
