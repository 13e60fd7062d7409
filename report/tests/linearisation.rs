//! Linear equations about steady motions as formulas and as a page.
#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use appell_codegen::Derived;
use appell_codegen::linearisation::{Linearisation, SteadyError, SteadyMotion};
use appell_codegen::mechanics::linear::ImplicitMotion;
use appell_codegen::symbolic::Expr;
use appell_report::derivation::{self, Page};

/// Conditions by the names of symbols; the right side is a number or another symbol.
fn linearised(
    name: &str,
    conditions: &[(&str, &str)],
) -> Result<(Derived, Linearisation), SteadyError> {
    let mut derived = appell_codegen::derived(name, &crate::support::spec(name)).unwrap();
    let d = &mut derived.derivation;
    let conditions: Vec<(Expr, Expr)> = conditions
        .iter()
        .map(|(symbol, value)| {
            let value = match value.parse() {
                Ok(number) => d.algebra.graph.integer(number),
                Err(_) => symbol_named(d, value),
            };
            (symbol_named(d, symbol), value)
        })
        .collect();
    let steady = SteadyMotion::new(&derived.mechanism, d, &conditions)?;
    let linear = Linearisation::about(d, steady)?;
    Ok((derived, linear))
}

fn symbol_named(d: &appell_codegen::mechanics::Derivation, name: &str) -> Expr {
    let s = &d.symbols;
    let all = [
        &s.parameters,
        &s.speeds,
        &s.coordinates,
        &s.rates,
        &s.inputs,
    ];
    let is_named = |e: &&Expr| {
        let symbol = d.algebra.graph.as_symbol(**e).unwrap();
        d.algebra.graph.symbol_name(symbol) == name
    };
    *all.into_iter().flatten().find(is_named).unwrap()
}

fn page_of(name: &str, conditions: &[(&str, &str)]) -> Page {
    let (mut derived, linear) = linearised(name, conditions).unwrap();
    derivation::linear(&derived.mechanism, &mut derived.derivation, &linear)
}

#[test]
fn straight_rolling_reads_as_before() {
    let page = page_of(
        "unicycle",
        &[
            ("theta", "0"),
            ("r", "0"),
            ("psi_dot", "0"),
            ("psi", "0"),
            ("u", "0"),
        ],
    );
    insta::assert_snapshot!("unicycle_straight", derivation::text(&page));
    insta::assert_snapshot!("unicycle_straight_latex", derivation::latex(&page));
}

#[test]
fn steady_turning_reads_as_before() {
    insta::assert_snapshot!(
        "rolling_wheel_turning",
        derivation::text(&page_of("rolling_wheel", &[]))
    );
    insta::assert_snapshot!(
        "unicycle_turning",
        derivation::text(&page_of("unicycle", &[("u", "0")]))
    );
}

/// Mechanisms of every sort: holonomic, rolling, driven, with dependent coordinates, with a
/// factorised mass matrix.
const MECHANISMS: [&str; 9] = [
    "carriage",
    "cart_pole",
    "chaplygin_sleigh",
    "euc_2dof",
    "euc_3dof",
    "four_bar",
    "furuta_pendulum",
    "rolling_ball",
    "unicycle",
];

#[test]
fn entries_are_the_jacobians_in_the_motion() {
    for name in MECHANISMS {
        let (mut derived, linear) = linearised(name, &[]).unwrap();
        let d = &mut derived.derivation;
        let implicit = ImplicitMotion {
            gibbs: &d.gibbs,
            forces: &d.forces,
            motion: &d.motion,
            coordinate_rates: &d.coordinate_rates,
        };
        let residual = implicit.residual(&mut d.algebra, &d.symbols);
        let variables = [linear.states.as_slice(), &linear.inputs].concat();
        let columns = implicit
            .jacobian(&mut d.algebra, &d.symbols, &residual, &variables)
            .unwrap();
        let mut motion = linear.steady.substitution(&d.algebra.graph);
        let order = linear.steady.structure.order();
        for (i, &state) in order.iter().enumerate() {
            let row = linear.a[i].iter().chain(&linear.b[i]);
            for (&entry, column) in row.zip(&columns) {
                let exact = motion.apply(&mut d.algebra.graph, column[state]).unwrap();
                assert!(
                    d.algebra.test.are_equal(&d.algebra.graph, entry, exact),
                    "{name}"
                );
            }
        }
    }
}

#[test]
fn pages_of_linear_equations_are_well_formed() {
    for name in MECHANISMS {
        crate::support::assert_well_formed(&derivation::html(&page_of(name, &[])));
    }
}

#[test]
fn what_only_places_a_mechanism_is_ignorable() {
    for (name, ignorable) in [
        ("unicycle", vec!["x_G", "y_G", "psi", "phi"]),
        ("cart_pole", vec!["x"]),
        ("chaplygin_sleigh", vec!["x", "y", "psi"]),
        ("pendulum", vec![]),
    ] {
        let (derived, linear) = linearised(name, &[]).unwrap();
        let graph = &derived.derivation.algebra.graph;
        let names = linear.states[linear.essential..].iter();
        let names = names.map(|&s| graph.symbol_name(graph.as_symbol(s).unwrap()));
        assert_eq!(names.collect::<Vec<_>>(), ignorable, "{name}");
    }
}

#[test]
fn conditions_that_contradict_each_other_are_refused() {
    let refused = |conditions: &[(&str, &str)]| linearised("unicycle", conditions).err();
    let twice = refused(&[("theta", "0"), ("theta", "1")]);
    assert_eq!(twice, Some(SteadyError::Twice("theta".to_owned())));
    let circular = refused(&[("theta", "psi"), ("psi", "theta")]);
    assert_eq!(circular, Some(SteadyError::Circular("psi".to_owned())));
    let rate = refused(&[("omega_3", "1"), ("psi_dot", "3")]);
    assert_eq!(rate, Some(SteadyError::Contradiction("psi_dot".to_owned())));
    assert_eq!(
        refused(&[("m", "0"), ("m0", "0")]),
        Some(SteadyError::Undefined)
    );
}
