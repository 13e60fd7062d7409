//! The next experiment of `appell diagnose` tells apart what its recordings cannot.

use crate::rig;
use crate::support::number;

/// So little friction that these recordings hardly tell its law.
const FRICTION: f64 = 0.003;
const LIMITS: [&str; 4] = ["--limit", "F=-6..6", "--limit", "x=-6..6"];

#[test]
fn a_tie_is_separated_by_the_experiment_that_was_proposed() {
    let mut rig = rig::Rig::new(|v| FRICTION * v);
    let asked = [
        &["diagnose", "--data", ".", "--json", "report.json"],
        &LIMITS[..],
    ]
    .concat();
    let told = rig.folder.done(&asked).stdout;
    let report = rig.folder.json("report.json");
    assert_eq!(report["verdict"], "ambiguous", "{report:#}");
    // Every tied hypothesis has its value, and the experiment comes before `apply`.
    let headline = told.lines().next().expect("a headline");
    assert!(headline.matches(" = ").count() >= 2, "{headline}");
    let next = told.find("  next      ").expect("an experiment");
    let then = told
        .find("  change    nothing yet: record the experiment below")
        .expect("an order");
    assert!(then < next, "{told}");
    let experiment = &report["experiment"];
    assert_eq!(experiment["file"], "experiment.csv");
    let (now, then) = (
        number(experiment, "separation_now"),
        number(experiment, "separation_then"),
    );
    assert!(now < 3.0 && then > 6.0, "{now} now, {then} then");

    // The rig does what the table says.
    let table = rig.folder.read("experiment.csv");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("t,F"));
    let force = |line: &str| -> f64 {
        let (_, force) = line.split_once(',').expect("two columns");
        force.parse().expect("a number")
    };
    let forces: Vec<f64> = lines.map(force).collect();
    assert!(forces.iter().all(|force| force.abs() <= 6.0));
    rig.record_to_fit("d.csv", &forces);
    let recorded = rig.folder.read("d.csv");
    let places = recorded
        .lines()
        .skip(1)
        .filter_map(|line| line.split(',').nth(1));
    let farthest = places.fold(0.0_f64, |most, x| {
        most.max(x.parse::<f64>().expect("a number").abs())
    });
    // The limit, and what the true friction does that the fitted one does not.
    assert!(farthest < 6.3, "{farthest} m");

    rig.folder.done(&asked);
    let again = rig.folder.json("report.json");
    assert_eq!(again["verdict"], "explained", "{again:#}");
    let found = &again["which"][0];
    assert_eq!(found["effects"], serde_json::json!(["viscous_friction@x"]));
    // Beside it stand what the library lacks, .04, and pairs that it is one of.
    assert!(number(found, "probability") > 0.94, "{found}");
    let which = again["which"].as_array().expect("hypotheses");
    let others = which[1..].iter().filter(|one| {
        let effects = one["effects"].as_array().expect("effects");
        !effects.contains(&"unknown".into()) && !effects.contains(&"viscous_friction@x".into())
    });
    for rival in others {
        assert!(number(rival, "probability") < 0.01, "{rival}");
    }
    assert!(again["experiment"].is_null());
}

#[test]
fn a_file_of_the_user_stays_where_an_experiment_is_proposed() {
    let folder = rig::Rig::new(|v| FRICTION * v).folder;
    let asked = ["diagnose", "--data", ".", "--json", "report.json"];
    let own = "t,x,F\n0,0,1\n";
    folder.write("experiment.csv", own);
    let told = folder.done(&asked).stdout;
    let says = "experiment.csv does not belong to the previous gap report and is not overwritten";
    assert!(
        told.contains("written to experiment-2.csv") && told.contains(says),
        "{told}"
    );
    let file = || folder.json("report.json")["experiment"]["file"].clone();
    assert_eq!(file(), "experiment-2.csv");
    let proposed = folder.read("experiment-2.csv");

    // The same again replaces what it has proposed, and nothing else.
    folder.write("experiment-2.csv", "t,F\n");
    folder.done(&asked);
    assert_eq!(folder.read("experiment-2.csv"), proposed);
    assert_eq!(folder.read("experiment.csv"), own);

    // A recording under the name of the experiment has more columns.
    folder.write("experiment-2.csv", own);
    folder.done(&asked);
    assert_eq!(folder.read("experiment-2.csv"), own);
    assert_eq!(file(), "experiment-3.csv");

    // Whoever names the file means it.
    folder.done(&[&asked[..], &["--experiment", "experiment.csv"]].concat());
    assert_eq!(folder.read("experiment.csv"), proposed);
}

#[test]
fn limits_name_columns_and_run_upwards() {
    let folder = rig::viscous(0.4);
    let asked = |limit| ["diagnose", "--data", ".", "--limit", limit];
    let told = ["there is no such column; the columns are x, F"];
    folder.fails(2, &asked("f=-1..1"), &told);
    folder.fails(2, &asked("F=1..-1"), &["1 is not less than -1"]);
    folder.fails(
        2,
        &asked("F=fast"),
        &["write NAME=FROM..TO with two numbers"],
    );
}
