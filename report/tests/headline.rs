//! What the first lines of a gap report say.

use appell_gap::diagnose::{
    Advice, Changes, Found, GapVerdict, HowFar, Hypothesis, Law, Left, Refitted, Report, Share,
    Value, Yardstick,
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
        rows: [10, 10],
        which,
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
        independent: 1.0,
        ..Report::default()
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
        ["certain: parameter_error@m: write into the spec (`appell apply`)"]
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
                stays, an error of 10.0 times the noise, whose floor is 1.00";
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
    let says = "re-fitted parameters close 99.6 % of the gap; 0.4 % stays, an error of 10.0 times the noise, whose floor is 1.00; no \
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

/// Hypotheses `A + B` and `A + C`, of which the second cannot be ruled out, with the given size of B.
fn rivals(size: f64, std: f64) -> Report {
    let value = |effect: &str, value, std| Value {
        name: format!("{effect}.force"),
        value,
        std,
        unit: "N".to_owned(),
        without: Some(0.0),
        is_determined: f64::abs(value) > 2.0 * std,
        yardstick: None,
    };
    let of = |effects: [&str; 2], probability, other: Value| Hypothesis {
        effects: effects.map(str::to_owned).to_vec(),
        parameters: vec![value("a@x", 1.0, 0.1), other],
        ..hypothesis("", probability, "[loads]", None)
    };
    let which = vec![
        of(["a@x", "b@x"], 0.8, value("b@x", size, std)),
        of(["a@x", "c@x"], 0.2, value("c@x", 1.0, 0.1)),
    ];
    let budget = vec![
        part("a@x", 0.6, [0.5, 0.7]),
        part("b@x", 0.3, [0.2, 0.4]),
        part("unexplained", 0.1, [0.0, 0.2]),
    ];
    report(GapVerdict::Ambiguous, which, budget)
}

#[test]
fn a_change_is_certain_if_no_hypothesis_that_may_be_true_does_without_it() {
    let change = Headline::of(&rivals(1.0, 0.1)).change.join("\n");
    for says in [
        "certain: a@x: write into the spec (`appell apply`)",
        "open: b@x (or c@x 20 %)",
        "`appell apply` also writes b@x",
    ] {
        assert!(change.contains(says), "{change}");
    }
    // With another size in the other hypothesis nothing is certain, and nothing is written.
    let mut other = rivals(1.0, 0.1);
    other.which[1].parameters[0].value = 2.0;
    let told = Headline::of(&other);
    assert!(
        told.change[0].starts_with("nothing yet"),
        "{:?}",
        told.change
    );
    assert_eq!(told.applied, None);
}

#[test]
fn a_size_that_may_be_zero_is_not_determined_and_no_cause() {
    let report = rivals(0.1, 0.1);
    let told = Headline::of(&report);
    assert!(
        told.cause.starts_with("a@x closes 60.0 %"),
        "{}",
        told.cause
    );
    let size = "force (x) = not determined (-0.0960 to 0.296 N)";
    assert!(told.sizes.contains(&size.to_owned()), "{:?}", told.sizes);
    assert_eq!(Advice::of(&report).not_determined, ["b@x"]);
    let change = told.change.join("\n");
    assert!(
        change.contains("do not change: b@x (not determined)"),
        "{change}"
    );
}

#[test]
fn an_implausible_size_is_shown_with_its_yardstick_and_not_certain() {
    let mut report = rivals(1.0, 0.1);
    report.which.truncate(1);
    report.which[0].parameters[1].yardstick = Some(Yardstick {
        ratio: 36.0,
        of: "the stated inertia of v".to_owned(),
        is_large: true,
    });
    let told = Headline::of(&report);
    let says = "b@x (36.0 × the stated inertia of v: plausible?)";
    assert!(told.cause.contains(says), "{}", told.cause);
    assert!(
        told.change.contains(&format!("open: {says}")),
        "{:?}",
        told.change
    );
}

#[test]
fn equivalent_effects_are_one_finding() {
    let mut report = rivals(1.0, 0.1);
    report.which[1].same_as = Some(report.which[0].effects.clone());
    let told = Headline::of(&report);
    let says = "b@x or c@x: the recordings cannot tell, either may be changed";
    assert!(told.cause.contains(says), "{}", told.cause);
    assert!(
        told.change[0].starts_with("certain: a@x, b@x"),
        "{:?}",
        told.change
    );
    assert_eq!(told.applied, Some(1));
}

#[test]
fn the_largest_part_comes_first_if_it_has_no_cause() {
    let mut report = rivals(1.0, 0.1);
    let far = report.how_far.as_mut().expect("errors");
    far.budget = vec![
        part("a@x", 0.28, [0.2, 0.3]),
        part("b@x", 0.1, [0.05, 0.2]),
        part("unexplained", 0.62, [0.5, 0.7]),
    ];
    let says = "most of the gap (62.0 %, an error of 10.0 times the noise, whose floor is 1.00) has no known cause; ";
    let told = Headline::of(&report).cause;
    assert!(told.starts_with(says), "{told}");
}
