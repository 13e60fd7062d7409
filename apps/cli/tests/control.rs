//! `appell control`: designs, their files, and what is told where there is none.

use serde_json::Value;

use crate::support::Folder;

const STRAIGHT: &[&str] = &["control", "unicycle", "--at", "omega_2=1[m/s]/R"];
const LANE: &[&str] = &["--outputs", "omega_1,theta,sigma,r,psi,y_G"];

fn with<'a>(parts: &[&[&'a str]]) -> Vec<&'a str> {
    parts.concat()
}

fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().expect("a list");
    list.iter()
        .map(|number| number.as_f64().expect("a number"))
        .collect()
}

#[test]
fn a_placed_law_is_told_written_and_simulated() {
    let folder = Folder::new();
    let design = [
        "--poles",
        "-8",
        "--write",
        "law.toml",
        "--json",
        "design.json",
    ];
    let told = folder.done(&with(&[STRAIGHT, LANE, &design])).stdout;
    for part in [
        "omega_2 = 3.33333 rad/s",
        "u: controllable subspace of dimension 6 of 10",
        "uncontrollable modes in 1/s: 0 (4 times)",
        "omega_3 + 6.66667 theta",
        "with omega_3 = -6.66667 theta",
        "-2042.70  N/(rad/s)",
        "4509.36  N/m",
    ] {
        assert!(told.contains(part), "{part} in {told}");
    }
    let json = folder.json("design.json");
    assert_eq!(json["controllability"]["rank"], 6);
    let wanted = [
        -2_042.702_690_398_573_4,
        -7_637.289_619_970_486,
        2_116.859_705_141_498_6,
        11_942.044_723_257_168,
        3_382.018_348_623_852_5,
        4_509.357_798_165_137,
    ];
    for (gain, wanted) in numbers(&json["law"]["gains"][0]).into_iter().zip(wanted) {
        assert!((gain / wanted - 1.0).abs() < 1e-10, "{gain}, {wanted}");
    }
    let simulate = [
        "simulate",
        "unicycle",
        "--feedback",
        "law.toml",
        "--initial",
        "y_G=1cm",
    ];
    folder.done(&with(&[&simulate, &["--json", "motion.json"]]));
    let motion = folder.json("motion.json");
    assert!(motion["failure"].is_null());
    let y_g = motion["final_state"]["y_G"].as_f64().expect("a number");
    assert!(y_g.abs() < 1e-4, "{y_g}");
}

#[test]
fn a_regulator_of_two_inputs_goes_through_its_file() {
    let folder = Folder::new();
    let told = folder.done(&[
        "control",
        "euc_3dof",
        "--lqr",
        "Q=1,R=0.01",
        "--write",
        "law.toml",
    ]);
    assert!(
        told.stdout
            .contains("M_d, M_h: controllable subspace of dimension 6 of 6")
    );
    assert!(
        folder
            .read("law.toml")
            .contains("inputs = [\"M_d\", \"M_h\"]")
    );
    folder.done(&[
        "simulate",
        "euc_3dof",
        "--feedback",
        "law.toml",
        "--initial",
        "phi=5deg",
        "--t-end-s",
        "30",
        "--json",
        "motion.json",
    ]);
    let phi = &folder.json("motion.json")["final_state"]["phi"];
    assert!(phi.as_f64().expect("a number").abs() < 1e-5, "{phi}");
}

#[test]
fn a_sampled_law_with_a_delay_goes_through_its_file() {
    let folder = Folder::new();
    let design = ["--poles", "-4", "--sampled-ms", "20", "--delay-ms", "25"];
    let told = folder.done(&with(&[STRAIGHT, LANE, &design, &["--write", "law.toml"]]));
    assert!(
        told.stdout.contains("poles of the sampled closed loop"),
        "{}",
        told.stdout
    );
    let law = folder.read("law.toml");
    assert!(
        law.contains("sampled_ms = 20.0") && law.contains("delay_ms = 25.0"),
        "{law}"
    );
    folder.done(&[
        "simulate",
        "unicycle",
        "--feedback",
        "law.toml",
        "--initial",
        "y_G=1cm",
        "--csv",
        "motion.csv",
        "--json",
        "motion.json",
        "--dt-s",
        "0.01",
    ]);
    let motion = folder.json("motion.json");
    let y_g = motion["final_state"]["y_G"].as_f64().expect("a number");
    assert!(y_g.abs() < 1e-4, "{y_g}");
    // Nothing acts before the delay; then the input is held for a period.
    let csv = folder.read("motion.csv");
    let mut lines = csv.lines().filter(|line| !line.starts_with('#'));
    let heading: Vec<&str> = lines.next().expect("a heading").split(',').collect();
    let u = heading
        .iter()
        .position(|name| name.split(' ').next() == Some("u"))
        .expect("u");
    let inputs: Vec<f64> = lines
        .filter_map(|line| line.split(',').nth(u)?.parse().ok())
        .collect();
    assert!(inputs[..3].iter().all(|u| *u == 0.0), "{:?}", &inputs[..8]);
    assert!(
        inputs[3] != 0.0 && (inputs[3] - inputs[4]).abs() == 0.0,
        "{:?}",
        &inputs[..8]
    );
    assert!((inputs[4] - inputs[5]).abs() > 0.0, "{:?}", &inputs[..8]);
}

#[test]
fn a_steady_tilt_is_held_by_its_input_and_kept_by_its_law() {
    let folder = Folder::new();
    // Rolling straight with a constant tilt: r = (m + m0) R tan(theta)/m0, u = m0 g sin(theta).
    let motion = ["--at", "theta=0.02", "--at", "r=(m+m0)*R*tan(0.02)/m0"];
    let design = [
        "--outputs",
        "omega_1,theta,sigma,r",
        "--poles",
        "-5",
        "--write",
        "law.toml",
    ];
    let told = folder.done(&with(&[STRAIGHT, &motion, &design])).stdout;
    assert!(told.contains("u = 0.980935 N"), "{told}");
    let law = folder.read("law.toml");
    assert!(
        law.contains("offset = [0.98") && law.contains("theta = 0.02"),
        "{law}"
    );
    folder.done(&[
        "simulate",
        "unicycle",
        "--feedback",
        "law.toml",
        "--initial",
        "sigma=1cm/s",
        "--json",
        "motion.json",
    ]);
    let theta = &folder.json("motion.json")["final_state"]["theta"];
    assert!(
        (theta.as_f64().expect("a number") - 0.02).abs() < 1e-6,
        "{theta}"
    );
}

#[test]
fn gains_over_the_speed_are_a_table() {
    let folder = Folder::new();
    let outputs = ["--outputs", "omega_1,theta,sigma,r,psi", "--poles", "-8"];
    let schedule = [
        "control",
        "unicycle",
        "--schedule",
        "omega_2=1[m/s]/R..5[m/s]/R/4",
    ];
    let told = folder.done(&with(&[&schedule, &outputs, &["--json", "gains.json"]]));
    assert!(told.stdout.contains("563.670") && told.stdout.contains("112.734"));
    let json = folder.json("gains.json");
    assert_eq!(json["designs"].as_array().map(Vec::len), Some(5));
    let third = &json["designs"][2];
    assert!((third["value"].as_f64().expect("a number") - 10.0).abs() < 1e-12);
    // A parameter varies as well.
    let schedule = ["control", "pendulum", "--schedule", "l=1..2/1"];
    let told = folder.run(&schedule);
    assert!(
        told.status == 0 || told.stderr.contains("no input"),
        "{}",
        told.stderr
    );
}

#[test]
fn a_law_with_gains_over_the_speed_goes_through_its_file() {
    let folder = Folder::new();
    let schedule = [
        "control",
        "unicycle",
        "--schedule",
        "omega_2=1[m/s]/R..5[m/s]/R/40",
    ];
    let write = ["--poles", "-8", "--write", "law.toml"];
    folder.done(&with(&[&schedule, LANE, &write]));
    let law = folder.read("law.toml");
    assert!(law.contains("over = \"omega_2\""), "{law}");
    assert_eq!(law.matches("[[at]]").count(), 41);
    for speed in ["1.63", "4.44"] {
        let speed = format!("omega_2={speed}[m/s]/R");
        let motion = [
            "--initial",
            &speed,
            "--initial",
            "y_G=5cm",
            "--json",
            "motion.json",
        ];
        folder.done(&with(&[
            &["simulate", "unicycle", "--feedback", "law.toml"],
            &motion,
        ]));
        let y_g = &folder.json("motion.json")["final_state"]["y_G"];
        assert!(y_g.as_f64().expect("a number").abs() < 1e-4, "{y_g}");
    }
    // What is wanted beside the steady motion is added.
    let wanted = law.replacen("[[at]]", "[desired]\ny_G = 0.1\n\n[[at]]", 1);
    folder.write("wanted.toml", &wanted);
    let motion = ["--initial", "omega_2=3[m/s]/R", "--json", "motion.json"];
    folder.done(&with(&[
        &["simulate", "unicycle", "--feedback", "wanted.toml"],
        &motion,
    ]));
    let y_g = &folder.json("motion.json")["final_state"]["y_G"];
    assert!(
        (y_g.as_f64().expect("a number") - 0.1).abs() < 1e-4,
        "{y_g}"
    );
}

#[test]
fn mistakes_in_a_schedule_are_told_at_once() {
    let folder = Folder::new();
    let simulate = ["simulate", "unicycle", "--feedback", "law.toml"];
    folder.write(
        "law.toml",
        "input = \"u\"\nstates = [\"theta\"]\nover = \"omega_2\"\noffset = 1\n\
         [[at]]\nvalue = 1\ngains = [1, 2]\n[[at]]\ngains = [1]\nspeed = 3\n",
    );
    let says = [
        "no `offset` of its own",
        "2 gains for 1 state",
        "needs `value` and `gains`",
        "unknown key `speed`",
    ];
    folder.fails(3, &simulate, &says);
    folder.write(
        "law.toml",
        "input = \"u\"\nstates = [\"theta\"]\nover = \"omega_9\"\n[[at]]\nvalue = 1\ngains = [1]\n",
    );
    folder.fails(3, &simulate, &["no state or parameter `omega_9`"]);
    folder.write(
        "law.toml",
        "input = \"u\"\nstates = [\"theta\"]\nover = \"omega_2\"\n\
         [[at]]\nvalue = 2\ngains = [1]\n[[at]]\nvalue = 1\ngains = [1]\n",
    );
    folder.fails(3, &simulate, &["must increase, but 1 follows 2"]);
    let design = [
        "control",
        "unicycle",
        "--schedule",
        "omega_2=1..5/4",
        "--poles",
        "-8",
    ];
    let sampled = ["--sampled-ms", "10", "--write", "law.toml"];
    folder.fails(
        2,
        &with(&[&design, LANE, &sampled]),
        &["a sampled law cannot be scheduled"],
    );
}

#[test]
fn a_law_keeps_the_unicycle_on_a_circle_that_is_given_by_its_rates() {
    let folder = Folder::new();
    let circle = ["--at", "theta=10deg", "--at", "psi_dot=2"];
    // An input that is not given is zero.
    let told = folder
        .done(&with(&[&["control", "unicycle"], &circle]))
        .stdout;
    assert!(told.contains("r = -0.0837462 m"), "{told}");
    let design = ["--at", "u=0", "--lqr", "Q=1,R=0.01", "--write", "law.toml"];
    let told = folder
        .done(&with(&[&["control", "unicycle"], &circle, &design]))
        .stdout;
    assert!(told.contains("r = -0.0837462 m"), "{told}");
    let simulate = [
        "simulate",
        "unicycle",
        "--feedback",
        "law.toml",
        "--t-end-s",
        "30",
    ];
    let pushed = ["--initial", "sigma=5mm/s", "--json", "motion.json"];
    folder.done(&with(&[&simulate, &pushed]));
    let motion = folder.json("motion.json");
    assert!(motion["failure"].is_null(), "{motion}");
    let theta = motion["final_state"]["theta"].as_f64().expect("a number");
    assert!((theta - 10f64.to_radians()).abs() < 1e-3, "{theta}");
    folder.fails(
        2,
        &["control", "unicycle", "--at", "x_P=1"],
        &["`x_P` is not constant"],
    );
}

#[test]
fn the_region_of_attraction_is_told_drawn_and_written() {
    let folder = Folder::new();
    let law = [
        "control",
        "unicycle",
        "--at",
        "omega_2=5[m/s]/R",
        "--poles",
        "-8",
    ];
    let outputs = ["--outputs", "omega_1,theta,sigma,r,psi"];
    let grid = [
        "--attraction",
        "omega_1=-6..6/6,r=-15cm..15cm/6",
        "--for-s",
        "8",
    ];
    let files = ["--plot", "region.svg", "--json", "region.json"];
    let told = folder.done(&with(&[&law, &outputs, &grid, &files])).stdout;
    assert!(told.contains("of 49 disturbed motions"), "{told}");
    let region = &folder.json("region.json")["attraction"];
    assert_eq!(region["fates"].as_array().map(Vec::len), Some(49));
    assert_eq!(region["fates"][24], "settled");
    assert!(region["fates"][0]["lost_s"].is_number(), "{region}");
    let safe = region["safe_part"].as_f64().expect("a number");
    assert!((safe - 1.0 / 3.0).abs() < 1e-12, "{safe}");
    let drawn = folder.read("region.svg");
    assert!(drawn.contains("settles") && drawn.contains("omega_1 at the start [rad/s]"));
    let asks = |more: &[&str], says: &[&str]| {
        folder.fails(2, &with(&[&law, &outputs, more]), says);
    };
    asks(&["--attraction", "r=1..2"], &["not a range"]);
    asks(&["--attraction", "q=1..2/3"], &["no state `q`"]);
    asks(&["--attraction", "r=0..1/2,r=0..1/2"], &["given twice"]);
    asks(
        &["--attraction", "r=0..1/2", "--for-s", "0"],
        &["positive number"],
    );
    let one = ["--attraction", "r=-1mm..1mm/2", "--plot", "one.svg"];
    asks(&one, &["two states"]);
    folder.fails(
        2,
        &["control", "unicycle", "--attraction", "r=0..1/2"],
        &["--attraction: there is no law"],
    );
}

#[test]
fn what_cannot_be_designed_says_what_to_write_instead() {
    let folder = Folder::new();
    let fails = |more: &[&str], says: &[&str]| folder.fails(2, &with(&[STRAIGHT, more]), says);
    fails(
        &["--outputs", "theta,r"],
        &["has order 4", "add sigma, omega_1"],
    );
    fails(
        &["--outputs", "omega_1,theta,omega_3"],
        &["`omega_3` depends linearly", "remove it"],
    );
    fails(&["--outputs", "theta,phi"], &["`phi` is not affected"]);
    fails(&["--outputs", "thta"], &["did you mean `theta`?"]);
    fails(&["--outputs", "theta,theta"], &["given twice"]);
    fails(&["--inputs", "v"], &["no input `v`"]);
    fails(
        &["--poles", "-8,-7"],
        &["2 poles are given for 6 states", "write 6 poles"],
    );
    fails(&["--poles", "-8+"], &["`-8+` is not a pole", "-2+3i,-2-3i"]);
    fails(
        &["--poles", "-1+i,-1,-1,-1,-1,-1"],
        &["lacks its complex conjugate", "-1.00000-1.00000i"],
    );
    fails(&["--lqr", "Q=1"], &["R is missing"]);
    fails(&["--lqr", "Q=1,2,R=1"], &["2 weights in Q for 6 outputs"]);
    fails(&["--lqr", "Q=1,R=0"], &["R must be positive"]);
    fails(&["--lqr", "Q=-1,R=1"], &["Q may be negative"]);
    fails(
        &["--at", "theta=0.1"],
        &["not steady", "`omega_1` changes", "--at"],
    );
    fails(
        &["--at", "thta=0.1"],
        &["no state or input `thta`", "theta"],
    );
    fails(
        &["--at", "theta=1m"],
        &["error[unit-mismatch]", "--at theta"],
    );
    fails(&["--write", "law.toml"], &["--write: there is no law"]);
    fails(
        &["--poles", "-8", "--sampled-ms", "0"],
        &["positive number of seconds"],
    );
    fails(&["--poles", "-8", "--delay-ms", "1"], &["--sampled-ms"]);
    fails(
        &["--schedule", "omega_2=1..2"],
        &["not a range", "eight intervals"],
    );
    fails(
        &["--schedule", "speed=1..2/2"],
        &["no state, input or parameter `speed`"],
    );
    folder.fails(2, &["control", "rolling_wheel"], &["no input", "[inputs]"]);
    // Two inputs give a pole twice at most.
    let thrice = ["control", "euc_3dof", "--poles", "-3"];
    folder.fails(
        2,
        &thrice,
        &[
            "requested 6 times",
            "at most 2, the number of inputs",
            "spread",
        ],
    );
    assert_eq!(folder.files(), [""; 0]);
}

#[test]
fn mistakes_in_a_law_of_several_inputs_are_told_at_once() {
    let folder = Folder::new();
    folder.write(
        "law.toml",
        "inputs = [\"M_d\", \"M_h\"]\nstates = [\"v\", \"x\"]\ngains = [[1, 2], [3]]\noffset = [1]\n\
         delay_ms = 3\n",
    );
    let says = [
        "1 gain for 2 states",
        "1 offset for 2 inputs",
        "`delay_ms` needs `sampled_ms`",
    ];
    folder.fails(
        3,
        &["simulate", "euc_3dof", "--feedback", "law.toml"],
        &says,
    );
    folder.write(
        "law.toml",
        "input = \"M_d\"\ninputs = [\"M_h\"]\nstates = [\"v\"]\ngains = [1]\nsampled_ms = -1\n",
    );
    let says = ["`input` or `inputs`, not both"];
    folder.fails(
        3,
        &["simulate", "euc_3dof", "--feedback", "law.toml"],
        &says,
    );
    folder.write(
        "law.toml",
        "input = \"M_d\"\nstates = [\"v\"]\ngains = [1]\nsampled_ms = 1e-9\n",
    );
    let says = ["measurements are too many"];
    folder.fails(
        2,
        &["simulate", "euc_3dof", "--feedback", "law.toml"],
        &says,
    );
}
