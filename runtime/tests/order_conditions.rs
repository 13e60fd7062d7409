//! Order conditions of the integrators, tree by tree.
//!
//! Every rooted tree τ = [τ₁ … τₖ] stands for an equation of its own: the rate of τ is the product
//! of the states of τ₁ … τₖ. From zero its solution is t^|τ| / γ(τ), and one Runge–Kutta step of
//! length 1 gives the elementary weight Σ bᵢ Φᵢ(τ). A method has order p exactly if both agree for all trees with up to p nodes (Hairer,
//! Nørsett and Wanner, theorem II.2.13). So the conditions need no table of coefficients: a step
//! along all trees at once shows them, and its interpolant shows those of the dense output.

// A failed integration fails the test.
#![allow(clippy::unwrap_used)]

use appell_runtime::integrate::{
    Dop853, Dopri5, EmbeddedPair, NoObserver, Options, Rk4, Solver, Statistics, Step, Watch,
};
use std::ops::ControlFlow;

/// A rooted tree: its number of nodes, its density γ, and the trees below its root.
struct Tree {
    order: usize,
    density: f64,
    children: Vec<usize>,
}

/// All rooted trees with up to `order` nodes, smaller ones first.
fn rooted_trees(order: usize) -> Vec<Tree> {
    let mut trees: Vec<Tree> = Vec::new();
    for order in 1..=order {
        for children in forests(&trees, order - 1, trees.len()) {
            let below: f64 = children.iter().map(|&child| trees[child].density).product();
            trees.push(Tree {
                order,
                density: order as f64 * below,
                children,
            });
        }
    }
    trees
}

/// The multisets of the first `count` trees that have `nodes` nodes together.
fn forests(trees: &[Tree], nodes: usize, count: usize) -> Vec<Vec<usize>> {
    if nodes == 0 {
        return vec![Vec::new()];
    }
    let fitting = (0..count).filter(|&tree| trees[tree].order <= nodes);
    let with_largest = |largest: usize| {
        let others = forests(trees, nodes - trees[largest].order, largest + 1);
        others.into_iter().map(move |mut forest| {
            forest.push(largest);
            forest
        })
    };
    fitting.flat_map(with_largest).collect()
}

/// The product of the states of the trees below the root, for each tree.
fn rates(trees: &[Tree], x: &[f64], rates: &mut [f64]) {
    for (rate, tree) in rates.iter_mut().zip(trees) {
        *rate = tree.children.iter().map(|&child| x[child]).product();
    }
}

/// Coefficients reach 43; a few of their last bits add up.
const ROUNDING: f64 = 1e-14;

/// One step of length 1, accepted whatever its error.
fn step<P: EmbeddedPair>(trees: &[Tree], mut see: impl FnMut(&Step<'_>)) -> Vec<f64> {
    let mut x = vec![0.0; trees.len()];
    let mut observer = |step: &Step<'_>| {
        see(step);
        ControlFlow::Continue(())
    };
    let options = Options {
        first_step: Some(1.0),
        ..Options::with_tolerances(0.0, 1e3)
    };
    let outcome = Solver::<P>::new()
        .integrate(
            |t, x, out| {
                // The first tree is a clock: Σ aᵢⱼ = cᵢ in every stage.
                assert!((x[0] - t).abs() < ROUNDING, "row sum {} at {t}", x[0]);
                rates(trees, x, out);
            },
            [0.0, 1.0],
            &mut x,
            &options,
            &mut Watch::default(),
            &mut observer,
        )
        .unwrap();
    assert_eq!(outcome.statistics.steps, 1);
    x
}

/// Numbers of nodes of the trees that are not integrated exactly up to t = θ.
fn violated(trees: &[Tree], x: &[f64], theta: f64) -> Vec<usize> {
    let exact = |tree: &Tree| theta.powf(tree.order as f64) / tree.density;
    let wrong = |(tree, x): &(&Tree, &f64)| (**x - exact(tree)).abs() > ROUNDING;
    let violated = trees.iter().zip(x).filter(wrong);
    violated.map(|(tree, _)| tree.order).collect()
}

/// The order of one step.
fn assert_order(order: usize, step: impl Fn(&[Tree]) -> Vec<f64>) {
    let trees = rooted_trees(order + 1);
    let violated = violated(&trees, &step(&trees), 1.0);
    assert!(violated.iter().all(|&nodes| nodes > order), "{violated:?}");
    assert!(
        !violated.is_empty(),
        "no condition of order {order} + 1 can fail"
    );
}

#[test]
fn there_are_as_many_rooted_trees_as_known() {
    let trees = rooted_trees(9);
    let count = |order| trees.iter().filter(|tree| tree.order == order).count();
    // Hairer, Nørsett and Wanner, section II.2.
    let counts: Vec<usize> = (1..=9).map(count).collect();
    assert_eq!(counts, [1, 1, 2, 4, 9, 20, 48, 115, 286]);
}

#[test]
fn each_method_fulfils_all_conditions_of_its_order_and_no_more() {
    assert_order(8, |trees| step::<Dop853>(trees, |_| {}));
    assert_order(5, |trees| step::<Dopri5>(trees, |_| {}));
    assert_order(4, |trees| {
        let mut x = vec![0.0; trees.len()];
        let f = |_: f64, x: &[f64], out: &mut [f64]| rates(trees, x, out);
        let (watch, observer) = (&mut Watch::default(), &mut NoObserver);
        Rk4::new()
            .integrate(f, [0.0, 1.0], &mut x, 1.0, watch, observer)
            .unwrap();
        x
    });
}

/// The order up to which the interpolant fulfils the conditions everywhere in the step.
fn assert_interior_order<P: EmbeddedPair>(order: usize) {
    let trees = rooted_trees(order + 1);
    let mut x = vec![0.0; trees.len()];
    step::<P>(&trees, |step| {
        let interior = step.interior.unwrap();
        for part in 1..8 {
            let theta = f64::from(part) / 8.0;
            interior.state(theta, &mut x);
            let violated = violated(&trees, &x, theta);
            assert!(violated.iter().all(|&nodes| nodes > order), "{violated:?}");
            assert!(!violated.is_empty());
        }
    });
}

#[test]
fn the_interpolants_fulfil_all_conditions_of_their_order() {
    assert_interior_order::<Dop853>(7);
    assert_interior_order::<Dopri5>(4);
}

/// Steps and rejections along all trees with up to `order` nodes where nothing but rounding is
/// tolerated.
fn cost<P: EmbeddedPair>(order: usize) -> Statistics {
    let trees = rooted_trees(order);
    let mut x = vec![0.0; trees.len()];
    let options = Options {
        first_step: Some(1.0),
        ..Options::with_tolerances(0.0, ROUNDING)
    };
    let f = |_: f64, x: &[f64], out: &mut [f64]| rates(&trees, x, out);
    let (watch, observer) = (&mut Watch::default(), &mut NoObserver);
    Solver::<P>::new()
        .integrate(f, [0.0, 1.0], &mut x, &options, watch, observer)
        .unwrap()
        .statistics
}

#[test]
fn the_error_estimates_vanish_up_to_the_order_of_the_embedded_solution() {
    for statistics in [cost::<Dop853>(5), cost::<Dopri5>(4)] {
        assert_eq!((statistics.steps, statistics.rejected), (1, 0));
    }
    for statistics in [cost::<Dop853>(6), cost::<Dopri5>(5)] {
        assert!(statistics.rejected > 0, "{statistics:?}");
    }
}
