//! Stability by general means: critical values that are known from elsewhere, to the last digits.
#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_analysis::{
    Axis, Boundary, Branch, BranchOptions, Branches, Change, Chart, Kind, Point, Stability,
    Verdict, loci,
};
use appell_tests::steady::{problem, shipped, term};
use nalgebra::{Matrix2, Matrix3};

/// Twelve digits.
const CRITICAL: f64 = 1e-12;

fn branches(name: &str, given: &[(&str, f64)], along: &str, range: [f64; 2]) -> Vec<Branch> {
    let model = shipped(name);
    let problem = problem(model, given);
    let options = BranchOptions::default();
    let branches = Branches::new(&problem, term(model, along), range, &[], options).unwrap();
    branches.trace(20).unwrap()
}

fn assert_digits(what: &str, found: f64, wanted: f64) {
    let error = (found / wanted - 1.0).abs();
    assert!(error < CRITICAL, "{what}: {found} against {wanted}");
}

/// Values on a branch at which a kind of change happens.
fn changes(branch: &Branch, wanted: impl Fn(Change) -> bool) -> Vec<f64> {
    let specials = branch.specials.iter().filter(|special| match special.kind {
        Kind::Critical(change) => wanted(change),
        _ => false,
    });
    specials.map(|special| special.motion.value).collect()
}

#[test]
fn wheel_and_unicycle_stand_up_above_their_critical_speeds() {
    for (name, given, wanted) in [
        (
            "rolling_wheel",
            &[("psi_dot", 0.0), ("theta", 0.0)][..],
            0.990_454_441_153_150_7,
        ),
        ("unicycle", &[("psi_dot", 0.0)][..], 1.213_053_997_149_343_7),
    ] {
        let found = branches(name, given, "speed", [0.1, 3.0]);
        assert_eq!(found.len(), 1, "{name}");
        let critical = changes(&found[0], |change| change == Change::RealZero);
        assert_eq!(critical.len(), 1, "{name}");
        assert_digits(name, critical[0], wanted);
        let points = &found[0].points;
        assert_eq!(points[0].stability.verdict, Verdict::Unstable);
        assert_eq!(points[points.len() - 1].stability.verdict, Verdict::Neutral);
        assert_eq!(found[0].changes().count(), 1);
    }
}

#[test]
fn the_bicycle_is_stable_between_its_weave_and_capsize_speeds() {
    let found = branches("bicycle", &[], "speed", [0.5, 10.0]);
    // Straight running comes first; turning without hands crosses it at the capsize speed.
    let straight = &found[0];
    let weave = changes(straight, |change| {
        matches!(change, Change::Oscillation { .. })
    });
    let capsize = changes(straight, |change| change == Change::RealZero);
    assert_eq!((weave.len(), capsize.len()), (1, 1));
    assert_digits("weave", weave[0], 4.292_382_536_341_11);
    assert_digits("capsize", capsize[0], 6.024_262_015_388_37);
    let crossings = straight.specials.iter();
    let crossings: Vec<_> = crossings.filter(|s| s.kind == Kind::Crossing).collect();
    assert_eq!(crossings.len(), 1);
    assert_digits("turning", crossings[0].motion.value, 6.024_262_015_388_37);
    assert!(found.len() > 1, "the turning motions are followed");
    for point in &straight.points {
        let verdict = if (weave[0]..=capsize[0]).contains(&point.value) {
            Verdict::Asymptotic
        } else {
            Verdict::Unstable
        };
        assert_eq!(point.stability.verdict, verdict, "at {} m/s", point.value);
        assert_eq!((point.stability.zeros, point.stability.family), (1, 1));
    }

    // Every mode keeps its place: none jumps by more than its neighbours do.
    let modes = loci(straight.points.iter().map(|point| &point.stability));
    assert_eq!(modes.len(), 4);
    for (k, point) in straight.points.iter().enumerate() {
        let mut rest = point.stability.eigenvalues();
        for mode in &modes {
            let place = rest.iter().position(|value| *value == mode[k]).unwrap();
            rest.swap_remove(place);
        }
    }
    let castering = modes.iter().filter(|mode| {
        let end = mode[mode.len() - 1];
        end.im == 0.0 && end.re < -10.0
    });
    assert_eq!(castering.count(), 1);
}

/// The largest tilt of a wheel that is not stable at every yaw rate, in degrees: where the boundary
/// turns back.
fn largest_tilt(name: &str) -> Vec<f64> {
    let model = shipped(name);
    let axis = |name: &str, range: [f64; 2]| Axis {
        term: term(model, name),
        range,
        count: 40,
    };
    let axes = [axis("theta", [-1.0, 1.0]), axis("psi_dot", [0.5, 8.0])];
    let chart = Chart::of(&problem(model, &[]), axes, &[], 10, 2).unwrap();
    assert!(chart.cells.iter().all(|cells| cells.len() == 1), "{name}");
    assert_eq!(chart.boundaries.len(), 1, "{name}");
    let boundary = &chart.boundaries[0];
    assert!(!boundary.decides.contains(&false));
    assert_eq!(boundary.change, Change::RealZero);
    let folds = boundary.folds.iter().filter(|fold| fold.axis == 0);
    folds.map(|fold| fold.at[0].to_degrees()).collect()
}

#[test]
fn a_rolling_disc_is_stable_beyond_a_tilt_that_its_inertia_decides() {
    for (name, wanted, digits) in [
        ("rolling_wheel", 18.623_570_746_969_177, CRITICAL),
        // The reference has twelve digits.
        ("axisymmetric_wheel", 19.203_773_871_3, 3e-12),
    ] {
        let tilts = largest_tilt(name);
        assert_eq!(tilts.len(), 2, "{name}: {tilts:?}");
        for tilt in tilts {
            let error = (tilt.abs() / wanted - 1.0).abs();
            assert!(error < digits, "{name}: {tilt} against {wanted}");
        }
    }
}

#[test]
fn borders_of_the_unicycle_that_nearly_meet_come_to_an_end() {
    // Beyond it a curve would go round and round.
    const POINTS: usize = 1500;
    let model = shipped("unicycle");
    let axis = |name: &str, most: f64| Axis {
        term: term(model, name),
        range: [-most, most],
        count: 60,
    };
    let axes = [axis("theta", 60f64.to_radians()), axis("psi_dot", 10.0)];
    let chart = Chart::of(&problem(model, &[("m0", 15.0)]), axes, &[], 10, 2).unwrap();
    let lengths: Vec<usize> = chart.boundaries.iter().map(|b| b.points.len()).collect();
    assert!(lengths.iter().all(|points| *points < POINTS), "{lengths:?}");
    // Left and right, forwards and backwards are alike.
    let places = |change: fn(Change) -> bool| {
        let boundaries = chart.boundaries.iter();
        boundaries
            .filter(|b| change(b.change))
            .flat_map(Boundary::deciding)
            .count()
    };
    assert!(
        places(|change| change == Change::RealZero) >= 4,
        "{lengths:?}"
    );
    assert!(
        places(|change| matches!(change, Change::Collision { .. })) >= 4,
        "{lengths:?}"
    );
}

#[test]
fn tilted_spinning_leaves_upright_spinning_at_a_crossing() {
    let found = branches("unicycle", &[("phi_dot", 0.0)], "psi_dot", [0.5, 10.0]);
    assert_eq!(found.len(), 2);
    // (46) for a small tilt.
    let [m, m0, radius, g] = [10.0_f64, 5.0, 0.3, 9.81];
    let ratio = (m + m0 + (m * m + 3.0 * m * m0 + m0 * m0).sqrt()) / (2.0 * m0);
    let wanted = (g / (radius * (ratio - 1.0))).sqrt();
    for branch in &found {
        let crossings = branch.specials.iter();
        let crossings: Vec<_> = crossings.filter(|s| s.kind == Kind::Crossing).collect();
        assert_eq!(crossings.len(), 1);
        assert_digits("crossing", crossings[0].motion.value, wanted);
    }
    // Every point of the tilted branch satisfies (46).
    let model = shipped("unicycle");
    let value = |point: &Point, name: &str| term(model, name).value(model, point);
    for at in &found[1].points {
        let (theta, r) = (value(&at.point, "theta"), value(&at.point, "r"));
        let square = m * m * theta.cos().powi(4) + 3.0 * m * m0 * theta.cos().powi(2) + m0 * m0;
        let wanted =
            radius * theta.tan() / (2.0 * m0) * (m * theta.cos().powi(2) + m0 + square.sqrt());
        assert!(
            (r - wanted).abs() < 1e-11 * wanted.abs().max(1.0),
            "{r} against {wanted}"
        );
        // Rounding of the tilt, where motions of every tilt are near.
        let turn = g * theta.tan() / (r * theta.cos() - radius * theta.sin());
        if theta.abs() > 0.01 {
            assert!((at.value - turn.sqrt()).abs() < 1e-10 * at.value);
        }
    }
}

#[test]
fn the_upright_rider_falls_in_the_modes_of_two_inverted_pendulums() {
    let model = shipped("euc_3dof");
    let problem = problem(model, &[("v", 0.0)]);
    let motion = problem.solve_isolated(1).unwrap().remove(0);
    let stability = Stability::of(model, problem.structure(), &motion.point).unwrap();
    assert_eq!(stability.verdict, Verdict::Unstable);
    // M q̈ = K q with q = (x, γ, φ), written down from the paper's (6)-(8) at rest.
    let p = |name: &str| term(model, name).value(model, &motion.point);
    let lever = p("m") * p("l_0") - p("m_0") * p("h_0");
    let m = Matrix3::new(
        p("m") + p("m_0") + p("m_w") + p("J_w") / p("R").powi(2),
        -lever,
        p("m") * p("h"),
        -lever,
        p("J_0") + p("m_0") * p("h_0").powi(2) + p("m") * p("l_0").powi(2),
        -p("m") * p("h") * p("l_0"),
        p("m") * p("h"),
        -p("m") * p("h") * p("l_0"),
        p("J") + p("m") * p("h").powi(2),
    );
    let k = Matrix3::from_diagonal(&[0.0, -lever * p("g"), p("m") * p("g") * p("h")].into());
    let squares = (m.try_inverse().unwrap() * k)
        .fixed_view::<2, 2>(1, 1)
        .into_owned();
    let squares: Matrix2<f64> = squares;
    let mut wanted: Vec<f64> = Vec::new();
    for square in squares.complex_eigenvalues().iter() {
        assert!(square.im.abs() < 1e-12);
        wanted.push(square.re);
    }
    let growing = wanted.iter().filter(|square| **square > 0.0).count();
    let found = stability.eigenvalues();
    assert_eq!(found.iter().filter(|z| z.re > 1e-9).count(), growing);
    assert!(growing > 0);
    for square in wanted {
        let nearest = found.iter().map(|z| (z * z).re - square);
        let nearest = nearest.map(f64::abs).fold(f64::INFINITY, f64::min);
        assert!(
            nearest < 1e-10 * square.abs(),
            "{square}: off by {nearest:e}"
        );
    }
}
