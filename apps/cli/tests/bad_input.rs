//! Whatever is wrong is told, with what to write instead, and nothing is left behind.

use crate::support::Folder;

#[test]
fn unknown_models_come_with_a_suggestion_and_the_list() {
    let folder = Folder::new();
    folder.fails(
        2,
        &["simulate", "unicylce"],
        &["did you mean `unicycle`?", "double_pendulum", "appell new"],
    );
    folder.fails(
        2,
        &["derive", "spaceship"],
        &["no shipped mechanism and no file `spaceship`"],
    );
    folder.fails(3, &["check", "missing.toml"], &["cannot read missing.toml"]);
    folder.fails(2, &["fly"], &["unrecognized subcommand"]);
    folder.fails(2, &["simulate", "unicycle", "--fast"], &["--fast"]);
}

#[test]
fn files_that_are_no_specs_are_refused() {
    let folder = Folder::new();
    folder.write("empty.toml", "");
    folder.fails(3, &["check", "empty.toml"], &["error[missing-section]"]);
    std::fs::write(folder.path("binary.toml"), [b'a', b'\n', 0xff, 0xfe]).expect("a file");
    folder.fails(3, &["check", "binary.toml"], &["binary.toml:2", "UTF-8"]);
    folder.fails(3, &["check", "."], &["this is a folder"]);
}

#[test]
fn conditions_of_a_steady_motion_are_checked() {
    let folder = Folder::new();
    let about = |conditions: &str, says: &[&str]| {
        let arguments = [
            "derive", "unicycle", "--stage", "linear", "--about", conditions,
        ];
        folder.fails(2, &arguments, says);
    };
    about(
        "tetha=0",
        &["no state, rate or input `tetha`", "did you mean `theta`?"],
    );
    about("dot(tetha)=0", &["did you mean `dot(theta)`?"]);
    about("theta", &["--about: theta: write NAME=VALUE"]);
    about("theta=0, theta=1", &["`theta` is given twice"]);
    about("theta=2*theta", &["`theta` is defined in terms of itself"]);
    about("theta=r/R, r=R*theta", &["in terms of itself"]);
    about("theta=1[m]", &["error[unit-mismatch]", "--about theta:1:1"]);
    about("theta=t", &["--about theta:1:1"]);
    about(
        "theta=1/0",
        &["error[division-by-zero]", "--about theta:1:3"],
    );
    about("omega_3=1, dot(psi)=3", &["`psi_dot` contradicts the rate"]);
    let equations = ["derive", "unicycle", "--about", "theta=0"];
    folder.fails(2, &equations, &["--about needs --stage linear"]);
}

#[test]
fn values_on_the_command_line_are_checked() {
    let folder = Folder::new();
    let simulate = |more: &[&str], says: &[&str]| {
        folder.fails(2, &[&["simulate", "unicycle"], more].concat(), says);
    };
    simulate(&["--set", "Q=1"], &["no parameter `Q`", "m, m0, R, g"]);
    simulate(&["--set", "R"], &["NAME=VALUE"]);
    simulate(
        &["--set", "R=30kg"],
        &["error[unit-mismatch]", "--set R:1:1"],
    );
    simulate(&["--set", "R=-1"], &["outside its limits"]);
    simulate(&["--set", "R=1e999"], &["1e999"]);
    simulate(&["--set", "R=1", "--set", "R=2"], &["given twice"]);
    simulate(&["--set", "R=1/0"], &["R"]);
    simulate(&["--initial", "tetha=1"], &["did you mean `theta`?"]);
    simulate(
        &["--initial", "theta=2"],
        &["outside its limits -1.5 … 1.5 rad"],
    );
    simulate(&["--input", "v=1"], &["no input `v`"]);
    simulate(
        &["--input", "u=sin("],
        &["error[expression-syntax]", "--input u:1:"],
    );
    simulate(
        &["--input", "u=2*omega_9"],
        &["error[unknown-name]", "omega_9"],
    );
    simulate(&["--input", "u=R"], &["error[unit-mismatch]"]);
    simulate(&["--input", "u=1", "--input", "u=2"], &["given twice"]);
    simulate(&["--t-end-s", "-1"], &["--t-end-s"]);
    simulate(&["--t-end-s", "nan"], &["positive number of seconds"]);
    simulate(&["--dt-s", "0"], &["positive number of seconds"]);
    simulate(&["--dt-s", "1e-9"], &["rows are too many"]);
    simulate(&["--rtol", "0", "--atol", "0"], &["atol"]);
}

#[test]
fn feedback_files_are_checked_as_a_whole() {
    let folder = Folder::new();
    folder.write(
        "law.toml",
        r#"input = "v"
states = ["theta", "omega_7"]
gains = [1, 2, "three"]
speed = 5
[desired]
theta = "if(t < 2, 0, psi)"
r = "0.1*t"
[initial]
theta = "5kg"
"#,
    );
    folder.fails(
        3,
        &["simulate", "unicycle", "--feedback", "law.toml"],
        &[
            "there is no input `v`",
            "law.toml:1:9",
            "there is no state `omega_7`",
            "law.toml:2:20",
            "expected a finite number",
            "law.toml:3:16",
            "unknown key `speed`",
            "law.toml:6:",
            "error[unit-mismatch]",
        ],
    );
    folder.write("law.toml", "input = \n");
    folder.fails(
        3,
        &["simulate", "unicycle", "--feedback", "law.toml"],
        &["law.toml:1:"],
    );
    folder.write(
        "law.toml",
        "mechanism = \"pendulum\"\ninput = \"u\"\nstates = [\"r\"]\ngains = [1]\n",
    );
    folder.fails(
        3,
        &["simulate", "unicycle", "--feedback", "law.toml"],
        &["for `pendulum`, not for `unicycle`"],
    );
    folder.write(
        "law.toml",
        "input = \"u\"\nstates = [\"r\"]\ngains = [1, 2]\n",
    );
    folder.fails(
        3,
        &["simulate", "unicycle", "--feedback", "law.toml"],
        &["2 gains for 1 state"],
    );
}

#[test]
fn recordings_are_checked_as_a_whole() {
    let folder = Folder::new();
    let recorded = |text: &str, says: &[&str]| {
        folder.write("in.csv", text);
        folder.fails(3, &["simulate", "carriage", "--inputs", "in.csv"], says);
    };
    recorded(
        "t,F\n0,1\n1,x\n0.5,2\n1,2,3\n",
        &[
            "in.csv:3:3",
            "`x` is not a finite number",
            "in.csv:4",
            "does not increase",
            "in.csv:5",
            "3 cells under 2 columns",
        ],
    );
    recorded(
        "time,F\n0,1\n",
        &["there is no column `t`", "no input `time`"],
    );
    recorded("t,G\n0,1\n", &["in.csv:1:3", "no input `G`"]);
    recorded("", &["the file is empty"]);
    recorded("t,F\n", &["there are no rows"]);
    recorded("t,F\n0,nan\n", &["not a finite number"]);
}

#[test]
fn nothing_is_left_behind_where_writing_fails() {
    let folder = Folder::new();
    folder.write("taken", "a file where a folder is needed");
    folder.fails(
        3,
        &["simulate", "carriage", "--csv", "taken/motion.csv"],
        &["there is no folder `taken`"],
    );
    std::fs::create_dir(folder.path("folder")).expect("a folder");
    folder.fails(
        3,
        &["simulate", "carriage", "--csv", "folder"],
        &["cannot write folder"],
    );
    assert_eq!(folder.files(), ["folder", "taken"]);
}
