//! Scalars that are lanes: any number of them has the bits of one.

#![allow(non_snake_case, reason = "letters of the spec")]

use appell_models::unicycle::{self, rates};
use appell_runtime::model::Model;
use appell_runtime::real::{Functions, Lanes, Own, Standard};
use appell_test_kit::Random;
use appell_tests::point::Point;

/// How many places are evaluated.
const PLACES: usize = 8;
/// An angle that needs more digits of π than straight code has.
const FAR_TURNED: f64 = 1e12;

/// Rates and outputs of the unicycle in lanes of any type.
fn generic<const N: usize, E: Functions>(points: &[Point]) -> Vec<[f64; N]> {
    let lanes = |of: fn(&Point) -> &Vec<f64>, i: usize| -> Lanes<N, E> {
        std::array::from_fn(|lane| of(&points[lane])[i]).into()
    };
    let x: [Lanes<N, E>; 10] = std::array::from_fn(|i| lanes(|point| &point.x, i));
    let p: [Lanes<N, E>; 4] = std::array::from_fn(|i| lanes(|point| &point.p, i));
    let (x, u, p) = (x.into(), [lanes(|point| &point.u, 0)].into(), p.into());
    let rates = rates(&p, &x, &u).to_array();
    let outputs = unicycle::outputs(&p, &x, &u).to_array();
    let all = rates.into_iter().chain(outputs);
    all.map(|lanes| lanes.0).collect()
}

/// The bits at all places, `N` at a time.
fn in_groups<const N: usize, E: Functions>(points: &[Point; PLACES]) -> Vec<Vec<u64>> {
    let groups = points.chunks(N).flat_map(|points| {
        let found = generic::<N, E>(points);
        (0..N).map(move |lane| found.iter().map(|x| x[lane].to_bits()).collect())
    });
    groups.collect()
}

/// The bits of the functions of `f64`.
fn plain(point: &Point) -> Vec<u64> {
    let info = unicycle::Unicycle.info();
    let [mut rates, mut outputs] =
        [info.state_len(), info.output_len()].map(|len| vec![f64::NAN; len]);
    unicycle::Unicycle.rates(point.at(), &mut rates);
    unicycle::Unicycle.outputs(point.at(), &mut outputs);
    let all = rates.iter().chain(&outputs);
    all.map(|x| x.to_bits()).collect()
}

#[test]
fn lanes_of_any_number_have_the_same_bits() {
    let info = unicycle::Unicycle.info();
    let mut random = Random::of("numbers of lanes");
    for _ in 0..20 {
        let mut points: [Point; PLACES] = std::array::from_fn(|_| Point::random(info, &mut random));
        points[3].x[7] = FAR_TURNED;
        let own = in_groups::<1, Own>(&points);
        assert_eq!(own, in_groups::<2, Own>(&points));
        assert_eq!(own, in_groups::<4, Own>(&points));
        assert_eq!(own, in_groups::<8, Own>(&points));
        let standard = in_groups::<8, Standard>(&points);
        for (standard, point) in standard.iter().zip(&points) {
            assert_eq!(*standard, plain(point));
        }
    }
}
