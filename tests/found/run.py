"""Inputs that once went wrong, and what comes out of them now.

    python3 tests/found/run.py PROGRAM [NAME ...]

Each case runs the program over copies of its inputs in a folder of its own, with bounded memory and time, and holds the
result against a value from somewhere else: a closed form, another simulator, the parameters of a simulation. The READMEs
of the folders tell where an input was found. The standard library of Python suffices; the exit status is the number of
cases that fail. A case that is open is known to fail, and is told once it no longer does.
"""

import json
import math
import resource
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
MOST_MEMORY = 4 << 30
"""Bytes that a run may use: what used to fill the memory ends here."""
MOST_TIME = 120
"""Seconds after which a run hangs."""

CASES = []


def case(*inputs, is_open=False):
    """A case: its inputs are copied into the folder in which it runs. An open one is known to fail."""

    def add(function):
        CASES.append((function.__name__, inputs, function, is_open))
        return function

    return add


class Failed(Exception):
    """A statement that does not hold."""


class Run:
    """Runs the program in a folder."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def __call__(self, *arguments, status=0, says=(), never=()):
        """What the program prints. `status` is one or several exit statuses; a panic is never among them."""
        bound = lambda: resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        command = [self.program, *map(str, arguments)]
        try:
            ran = subprocess.run(
                command, cwd=self.folder, capture_output=True, text=True, timeout=MOST_TIME,
                preexec_fn=bound, stdin=subprocess.DEVNULL, errors="replace",
            )
        except subprocess.TimeoutExpired:
            raise Failed(f"{arguments[0]} hangs") from None
        told = ran.stdout + ran.stderr
        allowed = status if isinstance(status, tuple) else (status,)
        if ran.returncode not in allowed:
            raise Failed(f"exit status {ran.returncode}, not {status}: {told[-400:]}")
        if "panicked" in told:
            raise Failed(f"a panic: {told[-400:]}")
        for text in says:
            if text not in told:
                raise Failed(f"does not say `{text}`: {told[:600]}")
        for text in never:
            if text in told:
                raise Failed(f"says `{text}`")
        return ran.stdout

    def json(self, *arguments, **expected):
        return json.loads(self(*arguments, "--json", "-", **expected))

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return name

    def read(self, name):
        return (self.folder / name).read_text()

    def evaluated(self, spec, **state):
        """The answer at one state."""
        self.write("cases.json", json.dumps({"cases": [{"state": state}]}))
        return self.json("evaluate", spec, "--cases", "cases.json")["cases"][0]

    def simulated(self, spec, t_end, *arguments):
        return self.json("simulate", spec, "--t-end-s", t_end, *arguments)["final_state"]


def near(found, right, tolerance, what="value"):
    if not abs(found - right) <= tolerance:
        raise Failed(f"{what} is {found}, not {right} ± {tolerance}")


def holds(condition, what):
    if not condition:
        raise Failed(what)


def inside(estimate, right, what):
    low, high = estimate
    holds(low <= right <= high, f"the interval of {what} [{low}, {high}] excludes {right}")


# Untrusted input.


@case("01_c_injection")
def hostile_sentences_stay_comments(run):
    for spec in ["c_inj.toml", "fmu_inj.toml"]:
        run("derive", spec, "--out", "evil.c")
        made = subprocess.run(["gcc", "-c", "evil.c", "-o", "evil.o"], cwd=run.folder, capture_output=True, text=True)
        holds(made.returncode == 0, made.stderr[:300])
        names = subprocess.run(["nm", "evil.o"], cwd=run.folder, capture_output=True, text=True).stdout
        holds("pwn" not in names and "system" not in names, names)


@case("02_study_write_outside")
def a_study_writes_into_its_folder(run):
    run("ensemble", "st.toml", "--out", "o", status=3, says=["st.toml:22"])
    holds(not list(run.folder.parent.glob("EVIL*")), "a file elsewhere")


@case("03_study_bombs")
def studies_of_twelve_lines_do_not_fill_the_memory(run):
    for study in sorted(path.name for path in run.folder.glob("*.toml")):
        run("ensemble", study, "--out", "o", status=3, says=[f"{study}:"])


@case("04_recording_times")
def times_of_any_size_are_read_or_refused(run):
    text = run.read("recording.toml")
    for run_1 in ["run1.csv", "run1_1e300.csv", "run1_1e-300.csv"]:
        run.write("recording.toml", text.replace("run1.csv", run_1))
        for command in [["recording", "."], ["identify", "my_rig.toml", "--data", "."]]:
            run(*command, status=(0, 3, 4))
    lines = run.read("run1.csv").splitlines()
    in_ns = [lines[0]] + [line.replace(",", "e-9,", 1) for line in lines[1:]]
    run.write("run1.csv", "\n".join(in_ns) + "\n")
    run.write("recording.toml", text)
    run("identify", "my_rig.toml", "--data", ".", status=(0, 3, 4))


@case("05_ensemble_fewer_cases")
def a_folder_of_more_cases_is_not_believed(run):
    run("ensemble", "study_200.toml", "--out", "both", "--json", "200.json")
    run("ensemble", "study_64.toml", "--out", "both", "--json", "after.json")
    run("ensemble", "study_64.toml", "--out", "alone", "--json", "alone.json")
    holds(json.loads(run.read("after.json")) == json.loads(run.read("alone.json")), "statistics of other cases")


PULSES = [
    ("if(sin(7*t)>0.99,100,0)", 93.0, 0.5),
    ("if(cos(2*t)>0.999,10,0)", 2.91, 0.01),
    ("if(t*t-100 > 0, if(t*t<101,50,0), 0)", 2.49, 0.01),
    ("10*exp(-(t-13)*(t-13)*10000)", 0.177245, 1e-4),
]


@case("06_missed_switches")
def no_pulse_is_missed(run):
    for method in ["dop853", "dopri5"]:
        for pulse, right, tolerance in PULSES:
            final = run.simulated("pulse.toml", 20, "--method", method, "--input", f"F={pulse}")
            near(final["v"], right, tolerance, f"{pulse} by {method}")
        final = run.simulated("wall.toml", 10, "--method", method, "--initial", "v=1")
        near(final["v"], math.sqrt(1.2), 1e-4, f"behind the wall by {method}")


@case("07_ensemble_mean_event")
def means_and_events_do_not_depend_on_steps(run):
    answer = run.json("ensemble", "rw_dop853.toml", "--out", "o")
    # The wheel turns by 10 rad/s: the mean of sin² over 10 s.
    near(answer["kept"]["marker_mean"]["mean"], 0.5 - math.sin(200) / 400, 1e-5, "mean of sin²")
    near(answer["kept"]["marker_max"]["mean"], 1, 1e-6, "maximum of sin")
    near(answer["kept"]["top_t_s"]["mean"], math.asin(0.99) / 10, 1e-6, "time of the event")
    holds(answer["kept"]["top_t_s"]["count"] == 16, "an event that is certain")


@case("08_chain_120.toml")
def a_chain_of_120_bodies_is_bounded(run):
    run("check", "08_chain_120.toml", status=(0, 3))


@case("09_constant_overflow.toml", "09_constant_slow.toml")
def constants_are_finite(run):
    for spec in ["09_constant_overflow.toml", "09_constant_slow.toml"]:
        run("check", spec, status=3, says=["not-finite"])


@case("10_raw_string_hashes.toml")
def any_spec_can_be_quoted_in_rust(run):
    run("derive", "10_raw_string_hashes.toml", "--format", "rust", "--out", "m.rs")
    holds("#" * 256 + '"' not in run.read("m.rs").replace("\\", ""), "a raw string with more than 255 `#`")


@case("11_import_quadratic.py")
def import_is_linear_in_the_size_of_a_file(run):
    subprocess.run([sys.executable, "11_import_quadratic.py"], cwd=run.folder, check=True)
    for name in ["motors.xml", "same.urdf", "star.urdf"]:
        run("import", name, "-o", "x.toml", status=(0, 3))


@case("12_import_invalid_fail_robot_194ab780.xml", "12_import_invalid_fail_robot_dc79e9a6.urdf")
def robots_that_no_spec_describes_are_refused(run):
    for robot in sorted(path.name for path in run.folder.glob("12_*")):
        run("import", robot, "-o", "x.toml", status=3, says=[f"{robot}:"])


# Robot files.

FLAGS = {"gravity": -60.78554, "damper": -3.60745, "spring": 10.41998}
"""By MuJoCo 4.0."""


@case("01_mjcf_flags")
def flags_of_mjcf_change_the_motion(run):
    for flag, right in FLAGS.items():
        run("import", f"{flag}.xml", "-o", "x.toml")
        near(run.evaluated("x.toml", h=0.4, v_h=1.5)["rates"]["v_h"], right, 1e-4, flag)


@case("03_free_joint_damping")
def a_damped_free_joint_has_six_loads(run):
    run("import", "box.xml", "-o", "x.toml")
    run("check", "x.toml")


@case("05_loop_dead_point")
def dependent_coordinates_of_a_loop_are_regular_in_its_pose(run):
    run("import", "toggle.xml", "-o", "x.toml")
    run("check", "x.toml", never=["cannot be assembled"])
    final = run.simulated("x.toml", 0.3)
    for name, right in {"crank": -0.46539, "rod": 0.62513, "foot": 0.53397}.items():
        near(final[name], right, 1e-4, name)


@case("06_negative_rounding_inertia")
def rounding_of_an_inertia_is_zero(run):
    run("import", "leg.urdf", "-o", "x.toml")
    run("check", "x.toml")
    mass = json.loads(run("evaluate", "x.toml", "--cases", run.write("none.json", '{"cases":[{"state":%s}]}' % zeros(run)), "--json", "-"))
    near(mass["cases"][0]["mass_matrix"][0][0], 0.08, 1e-12, "M")


def zeros(run):
    """All states of a spec are zero: their names stand in the error of a case without any."""
    run.write("empty.json", '{"cases": []}')
    order = run.json("evaluate", "x.toml", "--cases", "empty.json")["state_order"]
    return json.dumps({name: 0 for name in order})


@case("07_over_256_points")
def long_robots_are_imported(run):
    subprocess.run([sys.executable, "gen.py"], cwd=run.folder, check=True)
    run("import", "snake.urdf", "-o", "x.toml", status=(0, 3), says=[])
    run("check", "x.toml", never=["too-large"])


@case("08_mimic_unknown_without_couplings")
def couplings_that_are_left_out_need_no_target(run):
    run("import", "hand.urdf", "-o", "x.toml", "--without", "couplings")
    holds(len(run.evaluated("x.toml", **json.loads(zeros(run)))["mass_matrix"]) == 2, "two joints")


@case("10_list_robots_hides_error")
def a_list_of_robots_shows_the_first_error(run):
    run("list", "--robots", "robots", status=(0, 3), says=["there is no joint `a`"])


@case("11_blank_line_before_xml")
def white_space_before_the_declaration_is_read(run):
    run("import", "p.urdf", "-o", "x.toml")


TENDONS = {"tendon.xml": (-1040.809, 6618.427)}
"""By MuJoCo 4.0 at h 0.3, k -0.2."""


@case("21_mjcf_springdamper_tendon")
def springs_of_joints_and_tendons_are_read(run):
    run("import", "springdamper.xml", "-o", "x.toml")
    spec = run.read("x.toml")
    holds("3.208" in spec and "0.6416" in spec, "stiffness 3.208 and damping 0.6416")
    run("import", "tendon_equality.xml", "-o", "x.toml")
    run("check", "x.toml")
    run("import", "tendon.xml", "-o", "x.toml")
    zero = json.loads(zeros(run))
    rates = run.evaluated("x.toml", **{**zero, "h": 0.3, "k": -0.2})["rates"]
    for name, right in zip(["v_h", "v_k"], TENDONS["tendon.xml"]):
        near(rates[name], right, 1e-2, name)


# Steady motions and constraints.

FAST = [(-29.05905452, 0), (-4.68988211, 13.29519207), (0.15416301, 0)]
"""Eigenvalues of the benchmark bicycle at 12 m/s by the closed form of Meijaard et al. (2007)."""


@case("13_steady_fast_bicycle")
def straight_running_is_steady_at_every_speed(run):
    says = ["0.154163", "13.2952", "-29.0591"]
    run("stability", "bicycle", "--fix", "speed=12", says=says)
    run("stability", "bicycle", "--fix", "speed=12", "--fix", "phi=0", says=says)
    run("stability", "bicycle", "--fix", "speed=8", "--set", "r_R=0.2", "--set", "r_F=0.2")
    run("control", "bicycle", "--at", "speed=12")
    run("stability", "bicycle", "--along", "speed=12..20")
    run("steady", "unicycle", "--fix", "speed=20", status=2, says=["leave a family of 1 dimension"])


@case("14_rolling_on_wavy_road")
def a_disc_rolls_on_a_wavy_road(run):
    run("check", "bumpy.toml")
    info = run.json("check", "bumpy.toml")
    holds("no-contact" not in json.dumps(info), "does not touch the ground")
    for start, (s, w) in {5: (4.84943, 6.96374), 20: (16.25695, 20.39179)}.items():
        final = run.simulated("bumpy.toml", 4, "--initial", f"w={start}")
        near(final["s"], s, 2e-4, f"s from {start} rad/s")
        near(final["w"], w, 2e-4, f"w from {start} rad/s")


# Recordings.


@case("15_base_unforced_collapse")
def base_parameters_of_equations_without_input_are_unbiased(run):
    answer = run.json("base", "cart.toml", "--data", ".")
    text = json.dumps(answer)
    found = {entry.get("name"): entry for entry in walk(answer) if "interval" in entry or "value" in entry}
    holds(found, text[:300])
    for name, right in {"m_cart": 1.7, "mz_rod": -0.1, "Iyy_rod": 0.034}.items():
        near(found[name]["value"], right, 0.03 * abs(right), name)


def walk(value):
    if isinstance(value, dict):
        yield value
        for inner in value.values():
            yield from walk(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from walk(inner)


def identified(run, *arguments):
    """The estimates by the names of the parameters."""
    answer = run.json("identify", *arguments)
    return {entry["name"]: entry for entry in walk(answer) if "name" in entry and "interval95" in entry}


@case("17_identify_sampled_input")
def inputs_may_be_joined_by_lines(run):
    text = run.read("recording.toml")
    text = text.replace('input = "u"', 'input = "u", interpolation = "linear"').replace(
        'input = "F"', 'input = "F", interpolation = "linear"')
    holds("linear" in text, "the recording has an input")
    run("recording", ".", says=["interpolation"])
    run.write("recording.toml", text)
    found = identified(run, "cart.toml", "--data", ".", "--free", "M,m,I,b,bc")
    for name, right in {"M": 1.3, "bc": 7.0}.items():
        inside(found[name]["interval95"], right, name)
        near(found[name]["value"], right, 0.002 * right, name)


@case("18_identify_rate_only_swing")
def a_swing_is_identified_by_its_rate(run):
    for start in [[], ["--start", "shooting"]]:
        found = identified(run, "swing.toml", "--data", ".", *start)
        for name, right in {"I": 0.180004, "c": 0.0200755, "o": 1.40008}.items():
            near(found[name]["value"], right, 0.01 * right, f"{name} {start}")


@case("19_identify_servo_lag")
def the_lag_of_a_servo_is_identified(run):
    # What least_squares.py finds; friction in MuJoCo is not that of the spec.
    best = {"Ja": 0.01236, "d": 0.0791, "f": 0.1489, "u.lag": 0.0401}
    made_with = {"Ja": 0.012, "d": 0.08, "f": 0.15, "u.lag": 0.04}

    def holds_for(spec):
        found = identified(run, spec, "--data", ".", "--also", "u.lag")
        for name in best:
            inside(found[name]["interval95"], best[name], name)
            near(found[name]["value"], made_with[name], 0.05 * made_with[name], name)

    holds_for("full.toml")
    run.write("recording.toml", run.read("recording_truth.toml"))
    holds_for("truth.toml")


@case("20_time_column_name")
def the_clock_of_a_log_may_have_any_name(run):
    run("recording", ".")
    run.write("recording.toml", run.read("recording.toml").replace("time = {", "time = { time = true,"))
    run("recording", ".")


# The language.


@case("22_message_t")
def a_reserved_name_is_one_mistake(run):
    run("check", "t.toml", status=3, says=["reserved-name"], never=["unknown-name", "did you mean `t`"])


def main():
    program, *wanted = sys.argv[1:] or sys.exit(__doc__)
    program = str(Path(program).resolve())
    failed = 0
    for name, inputs, function, is_open in CASES:
        if wanted and name not in wanted and not any(i in wanted for i in inputs):
            continue
        with tempfile.TemporaryDirectory() as parent:
            folder = Path(parent) / "case"
            folder.mkdir()
            for item in inputs:
                source = HERE / item
                if source.is_dir():
                    shutil.copytree(source, folder, dirs_exist_ok=True)
                else:
                    shutil.copy(source, folder)
            try:
                function(Run(program, folder))
                print(f"{'MENDED' if is_open else 'ok':7} {name}", flush=True)
                failed += is_open
            except (Failed, KeyError, ValueError, OSError, subprocess.SubprocessError) as error:
                failed += not is_open
                print(f"{'open' if is_open else 'FAILED':7} {name}: {type(error).__name__} {error}", flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
