//! What the first lines of a gap report say.

use appell_gap::diagnose::{
    Changes, Found, GapVerdict, HowFar, Hypothesis, Law, Left, Refitted, Report, Share, Value,
    Where,
};
use appell_report::gap::{Headline, sentence};

/// A part of the gap with its 95 % interval.
fn part(name: &str, closed: f64, interval: [f64; 2]) -> Share {
    Share {
        name: name.to_owned(),
        closed,
        interval,
        is_material: closed > 0.02,
    }
}

fn hypothesis(effect: &str, probability: f64, items: &str, value: Option<Value>) -> Hypothesis {
    let mass = Refitted {
        name: "m".to_owned(),
        stated: 1.0,
        value: 1.25,
        std: Some(0.01),
        unit: "kg".to_owned(),
        stated_std: Some(0.1),
    };
    Hypothesis {
        effects: (!effect.is_empty())
            .then(|| effect.to_owned())
            .into_iter()
            .collect(),
        probability,
        same_as: None,
        log_bayes_factor: None,
        parameters: value.into_iter().collect(),
        changes: (effect != "unknown" || !items.is_empty()).then(|| Changes {
            items: items.to_owned(),
            parameters: vec![mass],
            ..Changes::default()
        }),
    }
}

/// On one held-out run, at 1 s.
fn report(verdict: GapVerdict, which: Vec<Hypothesis>, budget: Vec<Share>) -> Report {
    let stays = budget.iter().find(|part| part.is_rest());
    let closed = 1.0 - stays.map_or(0.0, |part| part.closed);
    Report {
        mechanism: "rig".to_owned(),
        verdict,
        is_by_simulation: false,
        is_by_forces: false,
        rows: [10, 10],
        place: Where {
            domain: "none",
            equations: Vec::new(),
            windows: Vec::new(),
            region: Vec::new(),
        },
        which,
        tied: Vec::new(),
        how_far: Some(HowFar {
            horizon_s: 1.0,
            nominal: 100.0,
            refitted: 10.0,
            with_effect: 10.0,
            noise_floor: 1.0,
            closed,
            closed_ci95: [closed - 0.01, closed + 0.2],
            closed_vs_refitted: 0.0,
            budget,
            channels: Vec::new(),
            before: None,
            bettered_ci95: [[0.0; 2]; 2],
            is_worse: false,
            runs: vec!["run3.csv".to_owned()],
        }),
        detectable: Vec::new(),
        failed: Vec::new(),
        imperfections: Vec::new(),
        disturbances: Vec::new(),
        left: None,
        independent: 1.0,
        law: None,
        change: None,
        hints: Vec::new(),
        tolerances: None,
        interpolated: Vec::new(),
        found: Vec::new(),
        horizons: Vec::new(),
        pictures: None,
        experiment: None,
    }
}

fn left(about: &str, log_bayes_factor: f64) -> Left {
    Left {
        place: "x".to_owned(),
        variable: "F".to_owned(),
        about: about.to_owned(),
        log_bayes_factor,
        gain: 10.0,
        explained: 0.0,
    }
}

#[test]
fn a_wrong_parameter_is_the_cause_and_not_of_no_weight() {
    let value = Value {
        name: "parameter_error@m.value".to_owned(),
        value: 1.25,
        std: 0.01,
        unit: "kg".to_owned(),
        without: Some(1.0),
        is_determined: true,
        yardstick: None,
    };
    let wrong = hypothesis("parameter_error@m", 0.96, "", Some(value));
    let budget = vec![
        part("refit", 0.999, [0.99, 1.1]),
        part("parameter_error@m", 0.0, [0.0, 0.0]),
        part("unexplained", 0.001, [0.0, 0.01]),
    ];
    let mut report = report(GapVerdict::Explained, vec![wrong], budget);
    report.found = vec![Found {
        effect: "parameter_error@m".to_owned(),
        about: "wrong value of m".to_owned(),
        sites: Vec::new(),
    }];
    let Headline {
        cause,
        sizes,
        change,
        applied,
        error,
        ..
    } = Headline::of(&report);
    assert!(cause.starts_with("wrong value of m: "), "{cause}");
    assert!(!cause.contains("hardly"), "{cause}");
    assert_eq!(
        sizes,
        ["m = 1.250 ± 0.020 kg (stated 1 kg, +2.5 stated deviations)"]
    );
    assert_eq!(
        change,
        ["certain: parameter_error@m: write the fitted parameters into the spec (`appell apply`)"]
    );
    assert_eq!(applied, Some(1));
    let error = error.unwrap_or_default();
    assert!(
        error.starts_with("1 s ahead on held-out runs: 100 -> 10.0 times"),
        "{error}"
    );
    // Nothing is more than all there is.
    assert!(error.contains("99.9 % [98.9 %, 100.0 %]"), "{error}");
}

#[test]
fn all_shares_of_a_sentence_are_parts_of_the_same_gap() {
    let friction = hypothesis("dry@x", 0.99, "[loads]", None);
    let budget = vec![
        part("refit", 0.6, [0.5, 0.7]),
        part("dry@x", 0.3, [0.2, 0.35]),
        part("unexplained", 0.1, [0.05, 0.2]),
    ];
    let told = sentence(&report(GapVerdict::Explained, vec![friction], budget));
    let says = "re-fitted parameters close 60.0 % of the gap; dry@x closes 30.0 % [20.0 %, 35.0 %] of the gap; 10.0 % \
                stays, an error of 10.0 times the noise floor";
    assert!(told.starts_with(says), "{told}");
}

#[test]
fn what_the_library_lacks_does_not_hide_what_parameters_close() {
    let which = || {
        vec![
            hypothesis("unknown", 0.61, "", None),
            hypothesis("", 0.39, "", None),
        ]
    };
    let budget = || {
        vec![
            part("refit", 0.996, [0.99, 1.0]),
            part("unexplained", 0.004, [0.0, 0.01]),
        ]
    };
    let mut report = report(GapVerdict::Unexplained, which(), budget());
    report.left = Some(left("an error of x", 70.0));
    let told = Headline::of(&report);
    let says = "re-fitted parameters close 99.6 % of the gap; 0.4 % stays, an error of 10.0 times the noise floor; no \
                effect of the library explains the rest: an error of x";
    assert_eq!(told.cause, says);
    assert_eq!(
        told.sizes,
        ["m = 1.250 ± 0.020 kg (stated 1 kg, +2.5 stated deviations)"]
    );
    let change = told.change.join("\n");
    assert!(
        change.contains("given hypothesis 2, writes the fitted"),
        "{change}"
    );
    // Where the odds are small, it is left open.
    report.left = Some(left("an error of x", 0.5));
    let told = sentence(&report);
    assert!(told.contains("leave it open (probability 61 %)"), "{told}");
}

#[test]
fn a_law_is_written_by_the_hypothesis_that_has_it_alone() {
    let law = || Law {
        equation: "v".to_owned(),
        unit: "N".to_owned(),
        depends_on: "x".to_owned(),
        variable: "x".to_owned(),
        variable_unit: "m".to_owned(),
        factor: None,
        curve: Vec::new(),
        log_bayes_factor: 9.0,
        forms: Vec::new(),
    };
    let budget = || vec![part("unexplained", 1.0, [1.0, 1.0])];
    let change = |which: Vec<Hypothesis>| {
        let mut report = report(GapVerdict::Unexplained, which, budget());
        report.law = Some(law());
        Headline::of(&report).change.join("\n")
    };
    let unknown = |items: &str| hypothesis("unknown", 0.9, items, None);
    let measured = change(vec![unknown("[loads]")]);
    assert!(
        measured.starts_with("`appell apply` writes the measured force"),
        "{measured}"
    );
    let plain = hypothesis("", 0.95, "", None);
    let second = change(vec![plain, unknown("[loads]")]);
    assert!(
        second.starts_with("`appell apply`, given hypothesis 2, writes"),
        "{second}"
    );
    // What holds no law is not said to be written.
    assert!(!change(vec![unknown("")]).contains("writes the measured"));
}
