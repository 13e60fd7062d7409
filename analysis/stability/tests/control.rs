//! Gains beside those of other programs, and what must hold of any.
//!
//! The numbers were computed with `SciPy` 1.17.1 and python-control 0.10.2 for the system below.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use appell_analysis::control::controllability::Controllability;
use appell_analysis::control::lqr::{self, RiccatiError, weights};
use appell_analysis::control::placement::{Placement, PlacementError};
use appell_analysis::control::reduction::{ReductionError, independent_states, reduce};
use appell_analysis::control::sampled::{Sampling, SamplingError};
use appell_analysis::control::staircase::Staircase;
use appell_analysis::control::{LinearSystem, placement};
use nalgebra::{Complex, DMatrix};

/// Two programs with rounding of their own.
const OTHERS: f64 = 1e-11;
/// Rounding of some hundred operations.
const ROUNDING: f64 = 1e-12;

/// Four states, two inputs: an aeroplane's longitudinal motion in its structure.
fn aeroplane() -> LinearSystem {
    #[rustfmt::skip]
    let a = [
        -0.5, 1.25, 0.0, -9.81,
        -0.2, -1.5, 1.0, 0.0,
        0.3, 4.0, -0.75, 0.0,
        0.0, 0.0, 1.0, 0.0,
    ];
    let b = [0.5, 1.0, 0.0, -0.25, 2.0, 0.125, 0.0, 0.0];
    LinearSystem {
        a: DMatrix::from_row_slice(4, 4, &a),
        b: DMatrix::from_row_slice(4, 2, &b),
    }
}

/// Its first input alone.
fn single() -> LinearSystem {
    let LinearSystem { a, b } = aeroplane();
    LinearSystem {
        a,
        b: b.columns(0, 1).into_owned(),
    }
}

#[track_caller]
fn assert_rows(got: &DMatrix<f64>, wanted: &[f64], tolerance: f64) {
    let wanted = DMatrix::from_row_slice(got.nrows(), got.ncols(), wanted);
    let off = (got - &wanted).amax() / wanted.amax();
    assert!(
        off <= tolerance,
        "off by {off:e}: {got} instead of {wanted}"
    );
}

/// Poles from pairs of real and imaginary part.
fn poles(parts: &[[f64; 2]]) -> Vec<Complex<f64>> {
    parts
        .iter()
        .map(|[re, im]| Complex::new(*re, *im))
        .collect()
}

/// Numbers between -1 and 1 that are the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn matrix(&mut self, rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |_, _| self.next())
    }

    fn system(&mut self, order: usize, inputs: usize) -> LinearSystem {
        LinearSystem {
            a: self.matrix(order, order) * 3.0,
            b: self.matrix(order, inputs),
        }
    }
}

#[test]
fn the_continuous_regulator_is_that_of_other_programs() {
    let (q, r) = (weights(&[1.0, 2.0, 0.5, 4.0]), weights(&[0.25, 2.0]));
    let regulator = lqr::continuous(&aeroplane(), &q, &r).unwrap();
    #[rustfmt::skip]
    let cost = [
        0.473_560_625_950_705_47, 0.015_202_141_733_231_058, -0.249_383_705_880_148_13, -1.511_855_429_075_566,
        0.015_202_141_733_231_058, 0.995_595_353_003_197_3, 0.243_148_536_168_215_58, -0.385_261_345_083_654_67,
        -0.249_383_705_880_148_13, 0.243_148_536_168_215_58, 0.547_271_977_100_335_4, 1.813_143_840_452_886_6,
        -1.511_855_429_075_566, -0.385_261_345_083_654_67, 1.813_143_840_452_886_6, 10.577_678_628_193_919,
    ];
    #[rustfmt::skip]
    let gain = [
        -1.047_948_395_139_774_1, 1.975_592_572_812_186_8, 3.879_408_405_042_387, 11.481_439_865_471_96,
        0.219_293_563_641_189_6, -0.101_651_564_748_270_67, -0.120_880_921_392_330_05, -0.594_448_556_374_020_7,
    ];
    assert_rows(&regulator.cost, &cost, OTHERS);
    assert_rows(&regulator.gain, &gain, OTHERS);
    assert!(regulator.residual < ROUNDING, "{}", regulator.residual);
    assert!(regulator.poles.iter().all(|pole| pole.re < -1.6));
}

#[test]
fn the_sampled_regulator_is_that_of_other_programs() {
    let sampled = Sampling::new(0.05, 0.0).unwrap().discretise(&aeroplane());
    #[rustfmt::skip]
    let a = [
        0.974_959_383_043_285_7, 0.058_759_578_141_674_554, -0.010_525_489_389_665_66, -0.484_363_710_146_399_23,
        -0.009_169_482_939_327_386, 0.932_158_719_519_377_2, 0.047_380_669_023_932_134, 0.002_314_937_082_268_558,
        0.013_604_850_472_633_942, 0.189_812_738_049_904_23, 0.967_904_060_491_661_8, -0.003_447_708_771_075_381_3,
        0.000_351_448_396_643_769_7, 0.004_827_798_806_875_806, 0.049_153_781_441_103_286, 0.999_941_597_765_613_4,
    ];
    assert_rows(&sampled.a, &a, ROUNDING);
    let (q, r) = (weights(&[1.0, 2.0, 0.5, 4.0]), weights(&[0.25, 2.0]));
    let regulator = lqr::discrete(&sampled, &q, &r).unwrap();
    #[rustfmt::skip]
    let gain = [
        -0.841_011_224_644_005_6, 1.902_680_881_089_163_6, 3.471_725_111_604_391, 9.792_070_217_297_818,
        0.211_652_964_849_169_18, -0.096_178_757_702_217_48, -0.123_115_710_412_231_17, -0.608_533_761_289_596_9,
    ];
    assert_rows(&regulator.gain, &gain, OTHERS);
    assert!(regulator.residual < ROUNDING, "{}", regulator.residual);
    assert!(regulator.poles.iter().all(|pole| pole.norm() < 1.0));
}

#[test]
fn a_delay_shares_the_period_between_the_old_input_and_the_new_one() {
    let sampling = Sampling::new(0.05, 0.02).unwrap();
    let sampled = sampling.discretise(&single());
    assert_eq!((sampling.pending(), sampled.order()), (1, 5));
    let old = [
        0.009_523_977_910_085_35,
        0.001_456_201_915_647_150_2,
        0.039_053_298_341_090_46,
        0.001_579_819_582_000_920_9,
    ];
    let new = [
        0.014_811_006_987_790_063,
        0.000_836_927_099_521_405_1,
        0.059_429_988_739_438_03,
        0.000_894_207_541_109_321_4,
    ];
    assert_rows(&sampled.a.view((0, 4), (4, 1)).into_owned(), &old, ROUNDING);
    assert_rows(&sampled.b.rows(0, 4).into_owned(), &new, ROUNDING);
    // A delay of whole periods shifts: with 0.1 s two inputs are pending, with 0.11 s three.
    for (delay, pending) in [(0.0, 0), (0.05, 1), (0.1, 2), (0.15, 3), (0.11, 3)] {
        let sampling = Sampling::new(0.05, delay).unwrap();
        assert_eq!(sampling.pending(), pending, "{delay}");
        // At rest all that acts is what was asked for: the steady effect does not depend on it.
        let sampled = sampling.discretise(&single());
        let n = sampled.order();
        let rest = (DMatrix::identity(n, n) - &sampled.a)
            .lu()
            .solve(&sampled.b)
            .unwrap();
        let expected = -single().a.lu().solve(&single().b).unwrap();
        assert_rows(&rest.rows(0, 4).into_owned(), expected.as_slice(), 1e-10);
    }
}

#[test]
fn gains_of_one_input_are_those_of_ackermann() {
    let placed = placement::place(
        &single(),
        &poles(&[[-1.0, 0.0], [-2.0, 0.0], [-3.0, 0.0], [-4.0, 0.0]]),
    );
    let wanted = [
        -0.135_363_831_128_010_73,
        1.762_404_460_226_466_6,
        3.658_840_957_782_002,
        9.059_762_930_396_7,
    ];
    assert_rows(&placed.unwrap().gain, &wanted, OTHERS);
    // A pair and a double pole, in an order that separates the pair.
    let placed = placement::place(
        &single(),
        &poles(&[[-2.0, -1.0], [-3.0, 0.0], [-2.0, 1.0], [-3.0, 0.0]]),
    );
    let wanted = [
        -0.717_838_500_596_688_3,
        2.252_651_471_136_832_4,
        3.804_459_625_149_171_6,
        10.119_511_536_821_11,
    ];
    assert_rows(&placed.unwrap().gain, &wanted, OTHERS);
}

/// Every pole has its place in the spectrum.
#[track_caller]
fn assert_poles(placed: &Placement, wanted: &[Complex<f64>], tolerance: f64) {
    let mut open = placed.poles.clone();
    for pole in wanted {
        let distance = |other: &Complex<f64>| (other - pole).norm();
        let nearest =
            (0..open.len()).min_by(|&i, &j| distance(&open[i]).total_cmp(&distance(&open[j])));
        let found = open.swap_remove(nearest.unwrap());
        assert!(distance(&found) <= tolerance, "{pole}: {:?}", placed.poles);
    }
}

#[test]
fn gains_of_several_inputs_are_as_robust_as_those_of_other_programs() {
    // Condition numbers of the eigenvectors as SciPy reaches them with Tits and Yang's method for the
    // balanced system.
    for (wanted, condition) in [
        ([[-1.0, 0.0], [-2.0, 0.0], [-3.0, 0.0], [-4.0, 0.0]], 8.2453),
        (
            [[-2.0, 1.0], [-2.0, -1.0], [-3.0, 0.0], [-5.0, 0.0]],
            8.2182,
        ),
        (
            [[-1.0, 2.0], [-1.0, -2.0], [-4.0, 1.0], [-4.0, -1.0]],
            3.5169,
        ),
        ([[-3.0, 0.0], [-3.0, 0.0], [-5.0, 0.0], [-5.0, 0.0]], 456.00),
    ] {
        let wanted = poles(&wanted);
        let placed = placement::place(&aeroplane(), &wanted).unwrap();
        assert_poles(&placed, &wanted, 1e-9);
        println!("{wanted:?}: {} beside {condition}", placed.condition);
        assert!(placed.condition < 1.01 * condition, "{}", placed.condition);
    }
}

#[test]
fn poles_of_random_systems_go_where_they_are_wanted() {
    let mut random = Random(7);
    for (order, inputs) in [
        (2, 1),
        (3, 1),
        (6, 1),
        (10, 1),
        (3, 2),
        (6, 2),
        (8, 3),
        (12, 4),
    ] {
        for _ in 0..20 {
            let system = random.system(order, inputs);
            let mut wanted: Vec<Complex<f64>> = (0..order)
                .map(|i| Complex::from(-1.0 - i as f64 * 0.4 + 0.1 * random.next()))
                .collect();
            wanted[0] = Complex::new(-1.0, 2.0);
            wanted[1] = wanted[0].conj();
            let placed = placement::place(&system, &wanted).unwrap();
            assert!(placed.residual < 1e-8, "{order} {inputs} {placed:?}");
        }
    }
}

#[test]
fn regulators_of_random_systems_solve_their_equations() {
    let mut random = Random(11);
    for (order, inputs) in [(1, 1), (2, 1), (6, 2), (12, 3), (16, 4)] {
        for _ in 0..10 {
            let system = random.system(order, inputs);
            let half = random.matrix(order, order);
            let (q, r) = (&half * half.transpose(), DMatrix::identity(inputs, inputs));
            let regulator = lqr::continuous(&system, &q, &r).unwrap();
            assert!(
                regulator.residual < ROUNDING,
                "{order}: {}",
                regulator.residual
            );
            let sampled = Sampling::new(0.02, 0.03).unwrap();
            let regulator = sampled.regulate(&system, &q, &r).unwrap();
            assert!(
                regulator.residual < ROUNDING,
                "{order}: {}",
                regulator.residual
            );
        }
    }
}

#[test]
fn a_sampled_regulator_refuses_weights_of_what_is_pending() {
    let system = Random(13).system(2, 1);
    // One measurement period of delay adds one state.
    let sampled = Sampling::new(0.02, 0.02).unwrap();
    let (q, r) = (DMatrix::identity(3, 3), DMatrix::identity(1, 1));
    assert_eq!(sampled.discretise(&system).order(), 3);
    let refused = sampled.regulate(&system, &q, &r).unwrap_err();
    assert_eq!(refused.to_string(), "Q must be 2 × 2, not 3 × 3");
}

/// A chain of integrators beside a mode at +1 that no input reaches.
fn chain_and_lost_mode() -> LinearSystem {
    #[rustfmt::skip]
    let a = [
        0.0, 1.0, 0.0,
        0.0, 0.0, 0.0,
        0.0, 0.0, 1.0,
    ];
    LinearSystem {
        a: DMatrix::from_row_slice(3, 3, &a),
        b: DMatrix::from_column_slice(3, 1, &[0.0, 1.0, 0.0]),
    }
}

#[test]
fn a_mode_out_of_reach_is_told_with_its_states_in_any_coordinates() {
    let plain = chain_and_lost_mode();
    let mut random = Random(3);
    for _ in 0..20 {
        // Other states: x = T z, with rows of very different units.
        let mut t = random.matrix(3, 3) + DMatrix::identity(3, 3) * 2.0;
        t.row_mut(0).scale_mut(1e4);
        let inverse = t.clone().try_inverse().unwrap();
        let system = LinearSystem {
            a: &t * &plain.a * &inverse,
            b: &t * &plain.b,
        };
        let told = Controllability::of(&system).unwrap();
        assert_eq!(told.rank, 2);
        assert!((told.lost[0] - 1.0).norm() < 1e-9);
        assert_eq!(told.kept().count(), 1);
        // The combination of states that obeys w' = w is the last row of T⁻¹.
        let (row, exact) = (told.untouched.row(0), inverse.row(2));
        assert!((row / row[0] - exact / exact[0]).norm() < 1e-6 * (exact / exact[0]).norm());
        let lost: Vec<_> = told.modes.iter().filter(|mode| mode.lost).collect();
        assert_eq!(lost.len(), 1);
        assert!((lost[0].value - 1.0).norm() < 1e-9);
        assert!(
            told.modes
                .iter()
                .any(|mode| !mode.lost && mode.multiplicity == 2)
        );
    }
}

#[test]
fn the_staircase_is_an_orthogonal_change_of_states() {
    let mut random = Random(5);
    for (order, inputs) in [(1, 1), (4, 1), (5, 2), (9, 3)] {
        let system = random.system(order, inputs);
        let form = Staircase::of(&system);
        let one = DMatrix::identity(order, order);
        assert!((&form.q * form.q.transpose() - one).norm() < ROUNDING);
        let back = &form.q * &form.system.a * form.q.transpose();
        assert!((back - &system.a).norm() < ROUNDING * system.a.norm());
        assert!((&form.q * &form.system.b - &system.b).norm() < ROUNDING);
        assert_eq!(form.controllable(), order);
    }
    let nothing = LinearSystem {
        a: DMatrix::identity(2, 2),
        b: DMatrix::zeros(2, 1),
    };
    assert_eq!(Staircase::of(&nothing).controllable(), 0);
}

#[test]
fn outputs_without_equations_of_their_own_are_told_what_they_need() {
    let system = chain_and_lost_mode();
    let open = reduce(&system, &[0]);
    let missing = vec![1];
    assert_eq!(
        open,
        Err(ReductionError::Open {
            chosen: 1,
            order: 2,
            missing
        })
    );
    // The velocity alone is closed: it does not feel the position.
    assert_eq!(reduce(&system, &[1]).unwrap().system.order(), 1);
    assert_eq!(reduce(&system, &[2]), Err(ReductionError::Unmoved));
    let unmoved = reduce(&system, &[0, 1, 2]);
    let factors = vec![0.0, 0.0];
    assert_eq!(
        unmoved,
        Err(ReductionError::Dependent { state: 2, factors })
    );
    assert_eq!(independent_states(&system, &[2, 1, 0]), [1, 0]);
}

#[test]
fn what_cannot_be_designed_is_told() {
    let four = poles(&[[-1.0, 0.0]; 4]);
    let count = placement::place(&single(), &four[..3]).unwrap_err();
    assert_eq!(count, PlacementError::Count { given: 3, order: 4 });
    let pole = Complex::new(-1.0, 1.0);
    let unpaired = placement::place(&single(), &[pole, four[0], four[0], four[0]]).unwrap_err();
    assert_eq!(unpaired, PlacementError::Unpaired { pole });
    let lost = placement::place(&chain_and_lost_mode(), &four[..3]).unwrap_err();
    assert_eq!(lost, PlacementError::Uncontrollable { rank: 2, order: 3 });
    let multiple = placement::place(&aeroplane(), &four).unwrap_err();
    assert_eq!(
        multiple,
        PlacementError::Multiple {
            pole: four[0],
            wanted: 4,
            inputs: 2
        }
    );
    let mut twice = aeroplane();
    let first = twice.b.column(0).into_owned();
    twice.b.set_column(1, &(first * 3.0));
    let dependent = placement::place(&twice, &four).unwrap_err();
    assert_eq!(
        dependent,
        PlacementError::DependentInputs { inputs: 2, rank: 1 }
    );

    let one = DMatrix::identity(1, 1);
    let unstable = lqr::continuous(&chain_and_lost_mode(), &DMatrix::identity(3, 3), &one);
    assert_eq!(unstable.unwrap_err(), RiccatiError::NoStabilisingSolution);
    let negative = lqr::continuous(&single(), &weights(&[1.0, -1.0, 1.0, 1.0]), &one);
    assert_eq!(
        negative.unwrap_err(),
        RiccatiError::StateWeight { smallest: -1.0 }
    );
    let free = lqr::continuous(&single(), &DMatrix::identity(4, 4), &(one.clone() * 0.0));
    assert_eq!(free.unwrap_err(), RiccatiError::InputWeight);
    let shape = lqr::continuous(&single(), &one, &one).unwrap_err();
    assert!(matches!(
        shape,
        RiccatiError::Shape {
            what: "Q",
            rows: 4,
            ..
        }
    ));

    assert_eq!(Sampling::new(0.0, 0.0), Err(SamplingError::Period(0.0)));
    assert_eq!(Sampling::new(0.1, -1.0), Err(SamplingError::Delay(-1.0)));
    assert!(matches!(
        Sampling::new(1e-9, 1.0),
        Err(SamplingError::Pending { .. })
    ));
}
