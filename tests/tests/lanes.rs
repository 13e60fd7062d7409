//! Blocks of places: every lane has the bits of its place alone, at every width of the processor's vectors.

#![allow(non_snake_case, reason = "letters of the spec")]

use appell_models::Shipped;
use appell_models::unicycle::{self, Inputs, Parameters, State, rates};
use appell_runtime::Real;
use appell_runtime::lanes::{AtLanes, Equations, LANES, Level, place_by_place};
use appell_runtime::model::{At, Model, ModelInfo};
use appell_runtime::real::{Functions, Lanes, Own, Standard};
use appell_test_kit::Random;
use appell_tests::point::Point;
use appell_tests::shipped;

/// Own functions and those of the platform differ by rounding; equations enlarge that.
const ROUNDING: f64 = 1e-9;
/// An angle that needs more digits of π than straight code has.
const FAR_TURNED: f64 = 1e12;

/// A block of random places.
struct Block {
    t: [f64; LANES],
    x: Vec<[f64; LANES]>,
    u: Vec<[f64; LANES]>,
    p: Vec<[f64; LANES]>,
}

impl Block {
    fn random(info: &ModelInfo, random: &mut Random) -> Self {
        let points: [Point; LANES] = std::array::from_fn(|_| Point::random(info, random));
        let columns = |of: fn(&Point) -> &Vec<f64>| {
            (0..of(&points[0]).len())
                .map(|i| std::array::from_fn(|lane| of(&points[lane])[i]))
                .collect()
        };
        Self {
            t: std::array::from_fn(|lane| points[lane].t),
            x: columns(|point| &point.x),
            u: columns(|point| &point.u),
            p: columns(|point| &point.p),
        }
    }

    fn at(&self) -> AtLanes<'_> {
        AtLanes {
            t: &self.t,
            x: &self.x,
            u: &self.u,
            p: &self.p,
        }
    }
}

/// Rates, A, B and outputs at every place of a block.
fn in_lanes(model: &dyn Model, at: AtLanes<'_>) -> [Vec<[f64; LANES]>; 5] {
    let info = model.info();
    let (n, m) = (info.state_len(), info.input_len());
    let mut all = [n, n, n * n, n * m, info.output_len()].map(|len| vec![[0.0; LANES]; len]);
    let [rates, same, a, b, outputs] = &mut all;
    model.rates_lanes(at, rates);
    model.jacobians_lanes(at, same, a, b);
    model.outputs_lanes(at, outputs);
    all
}

/// The same place by place: with own functions, or with those of the standard library.
fn by_place(model: &dyn Model, at: AtLanes<'_>, own: bool) -> [Vec<[f64; LANES]>; 5] {
    let info = model.info();
    let (n, m) = (info.state_len(), info.input_len());
    let mut all = [n, n, n * n, n * m, info.output_len()].map(|len| vec![[0.0; LANES]; len]);
    let results = all.each_mut().map(Vec::as_mut_slice);
    place_by_place(at, results, |t, [x, u, p], [rates, same, a, b, outputs]| {
        let at = At { t, x, u, p };
        if own {
            model.rates_own(at, rates);
            model.jacobians_own(at, same, a, b);
            model.outputs_own(at, outputs);
        } else {
            model.rates(at, rates);
            model.jacobians(at, same, a, b);
            model.outputs(at, outputs);
        }
    });
    all
}

/// The bits of numbers; all NaN are one.
fn bits(all: &[Vec<[f64; LANES]>; 5]) -> Vec<u64> {
    let numbers = all.iter().flatten().flatten();
    let bits = numbers.map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() });
    bits.collect()
}

#[test]
fn a_lane_of_a_shipped_model_has_the_bits_of_its_place_alone() {
    for shipped in appell_models::ALL {
        let model = shipped.model;
        let mut random = Random::of(shipped.name);
        for round in 0..4 {
            let mut block = Block::random(model.info(), &mut random);
            if round == 3 {
                // Some lanes leave the straight way.
                block.x.iter_mut().for_each(|x| x[5] = FAR_TURNED);
                block.x.iter_mut().for_each(|x| x[2] = f64::NAN);
            }
            let lanes = bits(&in_lanes(model, block.at()));
            let alone = bits(&by_place(model, block.at(), true));
            assert_eq!(lanes, alone, "{}, round {round}", shipped.name);
        }
    }
}

#[test]
fn own_functions_change_a_shipped_model_by_rounding() {
    for Shipped { name, model, .. } in appell_models::ALL {
        let mut random = Random::of(name);
        let block = Block::random(model.info(), &mut random);
        let own = in_lanes(*model, block.at());
        let standard = by_place(*model, block.at(), false);
        for (own, standard) in own.iter().zip(&standard) {
            for lane in 0..LANES {
                let largest = standard.iter().fold(1.0, |most, x| x[lane].abs().max(most));
                for (own, standard) in own.iter().zip(standard) {
                    let off = (own[lane] - standard[lane]).abs();
                    assert!(off <= ROUNDING * largest, "{name}: {own:?} {standard:?}");
                }
            }
        }
    }
}

#[test]
fn models_without_lanes_of_their_own_go_place_by_place() {
    for shipped in appell_models::ALL.iter().take(6) {
        let model = shipped::complete_model(shipped.name);
        let mut random = Random::of(shipped.name);
        let block = Block::random(model.info(), &mut random);
        let lanes = bits(&in_lanes(model, block.at()));
        assert_eq!(lanes, bits(&by_place(model, block.at(), false)));
        assert_eq!(lanes, bits(&by_place(model, block.at(), true)));
        assert_eq!(
            lanes,
            bits(&by_place(shipped.model, block.at(), false)),
            "the plain mode of emitted code"
        );
    }
}

/// Rates and outputs of the unicycle in lanes of any type.
fn generic<const N: usize, E: Functions>(block: &Block, first: usize) -> Vec<[f64; N]> {
    let lanes = |of: &[[f64; LANES]], i: usize| -> Lanes<N, E> {
        std::array::from_fn(|lane| of[i][first + lane]).into()
    };
    let x: [Lanes<N, E>; 10] = std::array::from_fn(|i| lanes(&block.x, i));
    let p: [Lanes<N, E>; 4] = std::array::from_fn(|i| lanes(&block.p, i));
    let (x, u, p) = (x.into(), [lanes(&block.u, 0)].into(), p.into());
    let rates = rates(&p, &x, &u).to_array();
    let outputs = unicycle::outputs(&p, &x, &u).to_array();
    let all = rates.into_iter().chain(outputs);
    all.map(|lanes| lanes.0).collect()
}

/// The same for all lanes of a block, `N` at a time.
fn in_groups<const N: usize, E: Functions>(block: &Block) -> Vec<Vec<u64>> {
    let groups = (0..LANES).step_by(N).flat_map(|first| {
        let found = generic::<N, E>(block, first);
        (0..N).map(move |lane| found.iter().map(|x| x[lane].to_bits()).collect())
    });
    groups.collect()
}

#[test]
fn lanes_of_any_number_have_the_same_bits() {
    let info = unicycle::Unicycle.info();
    let mut random = Random::of("numbers of lanes");
    for _ in 0..20 {
        let mut block = Block::random(info, &mut random);
        block.x[7][3] = FAR_TURNED;
        let own = in_groups::<1, Own>(&block);
        assert_eq!(own, in_groups::<2, Own>(&block));
        assert_eq!(own, in_groups::<4, Own>(&block));
        assert_eq!(own, in_groups::<8, Own>(&block));
        let standard = in_groups::<8, Standard>(&block);
        let plain = by_place(&unicycle::Unicycle, block.at(), false);
        for (lane, standard) in standard.iter().enumerate() {
            let plain = plain[0].iter().chain(&plain[4]);
            let plain: Vec<u64> = plain.map(|x| x[lane].to_bits()).collect();
            assert_eq!(*standard, plain, "plain mode, lane {lane}");
        }
    }
}

appell_runtime::in_lanes! {
    RatesInLanes = rates(
        Parameters[4] { m, m0, R, g },
        State[10] { omega_1, omega_2, omega_3, sigma, x_G, y_G, psi, theta, phi, r },
        Inputs[1] { u }
    ) => [10](whole [
        omega_1_dot, omega_2_dot, omega_3_dot, sigma_dot, x_G_dot, y_G_dot, psi_dot, theta_dot,
        phi_dot, r_dot
    ]) [0]() [0]()
}

#[test]
fn the_width_of_vectors_changes_no_bit() {
    let mut random = Random::of("levels");
    for round in 0..20 {
        let mut block = Block::random(unicycle::Unicycle.info(), &mut random);
        if round % 4 == 3 {
            block.x[6][round % LANES] = FAR_TURNED;
        }
        let rates = |level: Level| {
            let mut rates = [[0.0; LANES]; 10];
            RatesInLanes::block_at(level, block.at(), [&mut rates, &mut [], &mut []]);
            rates.map(|lanes| lanes.map(f64::to_bits))
        };
        let mut model = [[0.0; LANES]; 10];
        unicycle::Unicycle.rates_lanes(block.at(), &mut model);
        let model = model.map(|lanes| lanes.map(f64::to_bits));
        for level in Level::ALL {
            if !level.is_available() {
                println!("this processor has no {level:?}");
            }
            assert_eq!(rates(level), model, "{level:?}");
        }
    }
}

/// Equations that choose, and hide in the choice that an angle is too large for straight code.
fn choosing<T: Real>(x: &Numbers<T>, _: &Numbers<T>, _: &Numbers<T>) -> Numbers<T> {
    let one = T::constant(1.0);
    let chosen = T::if_less(x.a.sin(), T::constant(0.5), one, T::constant(2.0));
    let powers = x.a.cos().powf(T::constant(0.0)) + one.powf(x.a.tan());
    let others = T::if_less_or_equal(x.a.cos(), T::constant(0.5), one, T::constant(2.0));
    let b = powers + others + x.b.sign() * x.b.abs() + x.b.atan2(x.a);
    Numbers { a: chosen, b }
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Numbers<T> {
    a: T,
    b: T,
}
appell_runtime::vector!(Numbers { a, b });

appell_runtime::in_lanes! {
    Choosing = choosing(Numbers[2] { a, b }, Numbers[2] { a, b }, Numbers[2] { a, b })
        => [2](whole [a, b]) [0]() [0]()
}

#[test]
fn what_leaves_the_straight_way_is_not_hidden_by_a_choice() {
    let angles = [0.3, 1e10, -1e15, 2.0, f64::NAN, 1e300, 1.0, f64::INFINITY];
    let x = [angles, [1.0, -2.0, 0.0, -0.0, 3.0, f64::NAN, 1e-300, 5.0]];
    let mut found = [[0.0; LANES]; 2];
    let at = AtLanes {
        t: &[0.0; LANES],
        x: &x,
        u: &x,
        p: &x,
    };
    Choosing::block(at, [&mut found, &mut [], &mut []]);
    for lane in 0..LANES {
        let numbers = Numbers::from(x.map(|x| Lanes::own([x[lane]])));
        let alone = choosing(&numbers, &numbers, &numbers);
        let bits = |x: f64| if x.is_nan() { u64::MAX } else { x.to_bits() };
        assert_eq!(bits(found[0][lane]), bits(alone.a.0[0]), "lane {lane}");
        assert_eq!(bits(found[1][lane]), bits(alone.b.0[0]), "lane {lane}");
        let mut place = [0.0; 2];
        let x = x.map(|x| x[lane]);
        let at = At {
            t: 0.0,
            x: &x,
            u: &x,
            p: &x,
        };
        Choosing::place(at, [&mut place, &mut [], &mut []]);
        assert_eq!(bits(place[0]), bits(alone.a.0[0]), "place {lane}");
        assert_eq!(bits(place[1]), bits(alone.b.0[0]), "place {lane}");
    }
}

#[test]
fn functions_of_blocks_have_the_bits_of_functions_of_numbers() {
    use appell_runtime::elementary as own;
    use appell_runtime::lanes::functions as blocks;
    type OfBlock = fn(&[f64; LANES], &mut [f64; LANES]);
    type OfNumber = fn(f64) -> f64;
    let unary: [(OfBlock, OfNumber); 11] = [
        (blocks::sin, own::sin),
        (blocks::cos, own::cos),
        (blocks::tan, own::tan),
        (blocks::asin, own::asin),
        (blocks::acos, own::acos),
        (blocks::atan, own::atan),
        (blocks::sinh, own::sinh),
        (blocks::cosh, own::cosh),
        (blocks::tanh, own::tanh),
        (blocks::exp, own::exp),
        (blocks::ln, own::ln),
    ];
    let mut random = Random::of("functions of blocks");
    let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    for round in 0..200 {
        let mut draw = || std::array::from_fn(|_| random.between(-3.0, 3.0));
        let (mut x, y): ([f64; LANES], [f64; LANES]) = (draw(), draw());
        if round % 2 == 1 {
            x[round % LANES] = [FAR_TURNED, f64::NAN, -0.0, f64::INFINITY][round / 2 % 4];
        }
        let (mut found, mut second) = ([0.0; LANES], [0.0; LANES]);
        for (place, (of_block, of_number)) in unary.iter().enumerate() {
            of_block(&x, &mut found);
            let all = (0..LANES).all(|lane| same(found[lane], of_number(x[lane])));
            assert!(all, "function {place} at {x:?}: {found:?}");
        }
        blocks::sin_cos(&x, &mut found, &mut second);
        let all = (0..LANES).all(|lane| {
            let (sin, cos) = own::sin_cos(x[lane]);
            same(found[lane], sin) && same(second[lane], cos)
        });
        assert!(all, "sin_cos at {x:?}");
        blocks::atan2(&y, &x, &mut found);
        blocks::powf(&x, &y, &mut second);
        let all = (0..LANES).all(|lane| {
            same(found[lane], own::atan2(y[lane], x[lane]))
                && same(second[lane], own::powf(x[lane], y[lane]))
        });
        assert!(all, "atan2 and powf at {x:?}, {y:?}");
    }
}
