"""FMUs of appell against `appell simulate` and `appell evaluate`, by the importer FMPy.

    python check.py APPELL FOLDER

writes to a folder and prints the largest deviations. Motions are compared relative to the largest value of each
variable, derivatives relative to the largest entry of their matrix.
"""

import csv
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model, FMU3Slave
from fmpy.validation import validate_fmu

APPELL, FOLDER = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
HERE = Path(__file__).parent

# Tolerance of both integrators, and how far motions and derivatives may be apart.
TOLERANCE, MOTION, DERIVATIVE, DIFFERENCE, COARSE = 1e-12, 1e-9, 1e-9, 1e-6, 1e-4
INTERVAL = 0.05
# Steps of the model-exchange driver in an interval.
STEPS = 40

# An arm as people get one: from a robot file.
ARM = FOLDER / "arm.toml"
FOLDER.mkdir(parents=True, exist_ok=True)
for command in (["sample", "robot", FOLDER / "robot"], ["import", FOLDER / "robot" / "arm.urdf", "-o", ARM, "--without", "friction"]):
    subprocess.run([APPELL, *command], check=True, capture_output=True)

# Model, initial values and rows of held inputs in the units of the spec, end in s.
CASES = [
    ("unicycle", {"theta": 0.03, "omega_2": 4, "r": 0.01}, ["u"], [[0, 0.2], [0.5, -0.1]], 1.0),
    ("euc_3dof", {"phi": 0.02}, ["M_d", "M_h"], [[0, 2, 1], [0.4, -1, 0.5]], 1.0),
    ("bicycle", {"omega_R": -15, "phi": 0.02}, ["T_phi", "T_delta"], [[0, 0, 0.2], [0.6, 1, 0]], 1.5),
    ("four_bar", {}, ["tau"], [[0, 0.1], [0.5, -0.2]], 1.5),
    ("cart_pole", {"theta": 0.4}, ["F"], [[0, 1], [0.7, 0]], 1.5),
    (
        str(ARM),
        {"shoulder": 0.5, "elbow": 0.3, "reach": 0.1},
        ["tau_turn", "tau_shoulder", "tau_elbow", "force_reach"],
        [[0, 0.2, 12, 4, 1], [0.3, -0.1, 10, 3, -1]],
        0.5,
    ),
    (str(HERE / "timed.toml"), {"v": 30}, ["F"], [[0, 0.001], [0.5, -0.002]], 2.0),
]

worst = {}


def near(what, found, expected, allowed):
    """Both within a part of the largest value."""
    found, expected = np.asarray(found, float), np.asarray(expected, float)
    scale = max(np.max(np.abs(expected), initial=0), 1e-3)
    off = np.max(np.abs(found - expected), initial=0) / scale
    kind = what.split(":")[0]
    worst[kind] = max(worst.get(kind, 0), off)
    assert off <= allowed, f"{what}: off by {off:.2e}\n{found}\n{expected}"


def appell(*arguments):
    told = subprocess.run([APPELL, *arguments], cwd=FOLDER, capture_output=True, text=True)
    assert told.returncode == 0, (arguments, told.stderr)


def columns(path):
    rows = list(csv.reader(line for line in open(path) if not line.startswith("#")))
    return {name: np.array([float(row[k]) for row in rows[1:]]) for k, name in enumerate(rows[0])}


class Case:
    def __init__(self, model, initial, inputs, rows, end):
        self.model, self.initial, self.inputs, self.rows, self.end = model, initial, inputs, rows, end
        self.name = Path(model).stem
        self.fmu = FOLDER / f"{self.name}.fmu"
        appell("export", model, "--fmu")
        problems = validate_fmu(str(self.fmu))
        assert not problems, (self.name, problems)
        held = FOLDER / f"{self.name}_inputs.csv"
        with open(held, "w") as to:
            to.write("\n".join([",".join(["t", *inputs]), *(",".join(map(str, row)) for row in rows)]))
        appell(
            "simulate", model, "--inputs", held, "--t-end-s", str(end), "--dt-s", str(INTERVAL), "--rtol", str(TOLERANCE),
            "--atol", str(TOLERANCE), "--ignore-ranges", "--csv", f"{self.name}.csv",
            *(word for name, value in initial.items() for word in ("--initial", f"{name}={value}")),
        )
        self.motion = columns(FOLDER / f"{self.name}.csv")
        self.description = read_model_description(str(self.fmu))
        variables = self.description.modelVariables
        self.reference = {v.name: v.valueReference for v in variables}
        units = {unit.name: {shown.name: shown.factor for shown in unit.displayUnits} for unit in self.description.unitDefinitions}
        # A value in the unit of the spec is the factor times that in SI.
        self.factor = {v.name: float(units[v.unit][v.displayUnit]) if v.displayUnit else 1.0 for v in variables}
        self.rates = [u.variable for u in self.description.derivatives]
        self.states = [rate.derivative for rate in self.rates]
        self.outputs = [v for v in variables if v.causality == "output" and v not in self.states]
        self.parameters = [v for v in variables if v.causality == "parameter"]
        self.unzipped = extract(str(self.fmu), unzipdir=str(FOLDER / f"{self.name}_unzipped"))

    def shown(self, variable):
        """A column of the motion in SI."""
        return self.motion[variable.name] / self.factor[variable.name]

    def instance(self, kind, tolerance=None):
        part = self.description.modelExchange if kind is FMU3Model else self.description.coSimulation
        fmu = kind(
            guid=self.description.guid, unzipDirectory=self.unzipped, modelIdentifier=part.modelIdentifier, instanceName="it"
        )
        fmu.instantiate()
        fmu.enterInitializationMode(tolerance=tolerance, startTime=0.0)
        for name, value in self.initial.items():
            fmu.setFloat64([self.reference[name]], [value / self.factor[name]])
        self.hold(fmu, 0.0)
        return fmu

    def hold(self, fmu, t):
        """Sets the inputs that hold from a time on; tells whether a row begins there."""
        row = [row for row in self.rows if row[0] <= t + 1e-9][-1]
        values = [value / self.factor[name] for name, value in zip(self.inputs, row[1:])]
        fmu.setFloat64([self.reference[name] for name in self.inputs], values)
        return abs(row[0] - t) < 1e-9

    def compare(self, kind, rows, variables):
        for k, variable in enumerate(variables):
            near(f"{kind}: {self.name}, {variable.name}", np.array(rows)[:, k], self.shown(variable)[: len(rows)], MOTION)

    def times(self):
        return [k * INTERVAL for k in range(round(self.end / INTERVAL) + 1)]

    def co_simulation(self):
        fmu = self.instance(FMU3Slave, TOLERANCE)
        fmu.exitInitializationMode()
        variables = self.states + self.outputs
        references = [v.valueReference for v in variables]
        rows = [fmu.getFloat64(references)]
        for t, later in zip(self.times(), self.times()[1:]):
            self.hold(fmu, t)
            # A snapshot in the middle: the same step twice, and in two parts.
            if len(rows) == 7:
                kept = fmu.getFMUState()
                fmu.doStep(t, later - t)
                first = fmu.getFloat64(references)
                bytes_ = fmu.serializeFMUState(kept)
                again = fmu.deserializeFMUState(bytes_)
                fmu.setFMUState(again)
                fmu.doStep(t, later - t)
                assert fmu.getFloat64(references) == first, self.name
                fmu.setFMUState(kept)
                fmu.doStep(t, (later - t) / 3)
                fmu.doStep(t + (later - t) / 3, later - t - (later - t) / 3)
                fmu.freeFMUState(kept)
                fmu.freeFMUState(again)
            else:
                fmu.doStep(t, later - t)
            self.hold(fmu, later)
            rows.append(fmu.getFloat64(references))
        self.compare("co-simulation", rows, variables)
        fmu.terminate()
        fmu.freeInstance()

    def model_exchange(self):
        fmu = self.instance(FMU3Model)
        fmu.exitInitializationMode()
        driver = Driver(fmu, len(self.states), self.description.numberOfEventIndicators)
        variables = self.states + self.outputs
        references = [v.valueReference for v in variables]
        rows = [fmu.getFloat64(references)]
        for t, later in zip(self.times(), self.times()[1:]):
            if self.hold(fmu, t):
                driver.event()
            driver.go_to(later)
            self.hold(fmu, later)
            if driver.is_event_near():
                driver.event()
            rows.append(fmu.getFloat64(references))
        self.compare("model exchange", rows, variables)
        self.events = driver.events
        fmu.terminate()
        fmu.freeInstance()

    def derivatives(self):
        """At the last state of the motion but two."""
        row = len(self.motion["t"]) - 3
        t = self.motion["t"][row]
        state = {v.name: self.shown(v)[row] for v in self.states}
        inputs = {name: self.motion[name][row] / self.factor[name] for name in self.inputs}
        cases = FOLDER / f"{self.name}_cases.json"
        cases.write_text(json.dumps({"cases": [{"t": t, "state": state, "inputs": inputs}]}))
        appell("evaluate", self.model, "--cases", cases, "--json", f"{self.name}_values.json")
        values = json.loads((FOLDER / f"{self.name}_values.json").read_text())
        order, values = values, values["cases"][0]
        assert [v.name for v in self.states] == order["state_order"]
        fmu = self.instance(FMU3Model)
        fmu.exitInitializationMode()
        fmu.updateDiscreteStates()
        fmu.enterContinuousTimeMode()
        fmu.setTime(t)
        fmu.setFloat64([self.reference[name] for name in self.inputs], [inputs[name] for name in self.inputs])
        fmu.setContinuousStates((np.ctypeslib.as_ctypes(np.array(list(state.values())))), len(state))
        fmu.enterEventMode()
        fmu.updateDiscreteStates()
        rates = [v.valueReference for v in self.rates]
        near(f"rates: {self.name}", fmu.getFloat64(rates), list(values["rates"].values()), DERIVATIVE)

        def matrix(unknowns, knowns):
            """By columns, and by rows from the adjoint."""
            by_column = [fmu.getDirectionalDerivative(unknowns, [known], [1.0]) for known in knowns]
            by_row = [fmu.getAdjointDerivative([unknown], knowns, [1.0], len(knowns)) for unknown in unknowns]
            direct = np.array(by_column).T.reshape(len(unknowns), len(knowns))
            assert np.array_equal(direct, np.array(by_row).reshape(direct.shape)), self.name
            return direct

        of = {"x": [v.valueReference for v in self.states], "u": [self.reference[name] for name in self.inputs]}
        of["p"] = [v.valueReference for v in self.parameters]
        for name, known in [("A", "x"), ("B", "u"), ("P", "p")]:
            expected = np.array(values[name])[:, : len(of[known])]
            near(f"{name}: {self.name}", matrix(rates, of[known]), expected, DERIVATIVE)
        outputs = [v.valueReference for v in self.outputs]
        if not outputs:
            return
        for known in "xup":
            found = matrix(outputs, of[known])
            differences = []
            for k, reference in enumerate(of[known]):
                middle = fmu.getFloat64([reference])[0]
                h = 1e-5 * max(abs(middle), 1e-2)
                sides = []
                for side in (middle + h, middle - h, middle):
                    if known == "x":
                        x = np.array(list(state.values()))
                        x[k] = side
                        fmu.enterContinuousTimeMode()
                        fmu.setContinuousStates(np.ctypeslib.as_ctypes(x), len(x))
                        fmu.enterEventMode()
                    elif known == "p" and self.parameters[k].variability == "fixed":
                        sides = [np.zeros(len(outputs))] * 2
                        found[:, k] = 0
                        break
                    else:
                        fmu.setFloat64([reference], [side])
                    sides.append(np.array(fmu.getFloat64(outputs)))
                differences.append((sides[0] - sides[1]) / (2 * h))
            if differences:
                near(f"outputs by {known}: {self.name}", found, np.array(differences).T, DIFFERENCE)
        fmu.freeInstance()

    def by_fmpy(self):
        """The motion as the importer computes it by itself."""
        start = {name: value / self.factor[name] for name, value in self.initial.items()}
        dtype = [("time", float)] + [(name, float) for name in self.inputs]
        rows = []
        for k, row in enumerate(self.rows):
            values = [value / self.factor[name] for name, value in zip(self.inputs, row[1:])]
            rows.append((row[0], *values))
            rows.append((self.rows[k + 1][0] if k + 1 < len(self.rows) else self.end, *values))
        for kind, tolerance, allowed in [("ModelExchange", 1e-8, COARSE), ("CoSimulation", TOLERANCE, MOTION)]:
            found = simulate_fmu(
                str(self.fmu), fmi_type=kind, stop_time=self.end, output_interval=INTERVAL, relative_tolerance=tolerance,
                start_values=start, input=np.array(rows, dtype=dtype), output=[v.name for v in self.states],
                record_events=False,
            )
            for v in self.states:
                expected = self.shown(v)[-1]
                scale = np.max(np.abs(self.shown(v)))
                near(f"FMPy {kind}: {self.name}, {v.name}", [found[v.name][-1] / scale], [expected / scale], allowed)


def lines():
    """Inputs that run on along lines, against the closed form of a mass under F = cos 3t."""
    fmu = FOLDER / "lines.fmu"
    appell("export", HERE / "mass.toml", "--fmu", "--interpolation", "linear", "--out", fmu)
    description = read_model_description(str(fmu))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    slave = FMU3Slave(
        guid=description.guid, unzipDirectory=extract(str(fmu), unzipdir=str(FOLDER / "lines")),
        modelIdentifier=description.coSimulation.modelIdentifier, instanceName="it",
    )
    slave.instantiate()
    slave.enterInitializationMode(tolerance=TOLERANCE, startTime=0.0)
    slave.exitInitializationMode()
    step, end = 0.01, 2.0
    for k in range(round(end / step)):
        slave.setFloat64([reference["F"]], [np.cos(3 * k * step)])
        slave.doStep(k * step, step)
    # A line is off by about 5/12 h^2 u'' in the mean of a step, the held first step by h^2/2 u': held inputs by half a step.
    near("lines: v", slave.getFloat64([reference["v"]]), [np.sin(3 * end) / 3], 1e-3)
    assert abs(slave.getFloat64([reference["F"]])[0] - np.cos(3 * (end - step))) < 1e-15
    # Set once, it is held after the step in which it changes.
    slave.setFloat64([reference["F"]], [0.0])
    slave.doStep(end, step)
    before = slave.getFloat64([reference["v"]])[0]
    slave.doStep(end + step, step)
    assert slave.getFloat64([reference["v"]])[0] == before
    slave.terminate()
    slave.freeInstance()


class Driver:
    """Model exchange with steps of order five (Dormand and Prince), events located to the last digit."""

    ROWS = [
        [1 / 5], [3 / 40, 9 / 40], [44 / 45, -56 / 15, 32 / 9], [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656], [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
    NODES = [1 / 5, 3 / 10, 4 / 5, 8 / 9, 1]

    def __init__(self, fmu, states, indicators):
        self.fmu, self.n, self.m, self.t, self.events = fmu, states, indicators, 0.0, 0
        self.buffer, self.signs = np.zeros(states), np.zeros(max(indicators, 1))
        self.update()
        fmu.enterContinuousTimeMode()

    def update(self):
        _, _, _, _, defined, when = self.fmu.updateDiscreteStates()
        self.next = when if defined else np.inf

    def event(self):
        self.events += 1
        self.fmu.enterEventMode()
        self.update()
        self.fmu.enterContinuousTimeMode()

    def is_event_near(self):
        return abs(self.next - self.t) < 1e-12

    def states(self):
        self.fmu.getContinuousStates(np.ctypeslib.as_ctypes(self.buffer), self.n)
        return self.buffer.copy()

    def rates(self, t, x):
        self.fmu.setTime(t)
        self.fmu.setContinuousStates(np.ctypeslib.as_ctypes(x), self.n)
        rates = np.zeros(self.n)
        self.fmu.getContinuousStateDerivatives(np.ctypeslib.as_ctypes(rates), self.n)
        return rates

    def switched(self, t):
        if self.m == 0:
            return False
        self.fmu.setTime(t)
        self.fmu.getEventIndicators(np.ctypeslib.as_ctypes(self.signs), self.m)
        return bool(np.any(self.signs < 0))

    def step(self, h):
        x, k = self.states(), []
        k.append(self.rates(self.t, x))
        for row, node in zip(self.ROWS, self.NODES):
            k.append(self.rates(self.t + node * h, x + h * sum(a * rate for a, rate in zip(row, k))))
        x = x + h * sum(a * rate for a, rate in zip(self.ROWS[-1], k))
        self.t += h
        self.fmu.setTime(self.t)
        self.fmu.setContinuousStates(np.ctypeslib.as_ctypes(x), self.n)
        self.fmu.completedIntegratorStep()

    def go_to(self, end):
        while self.t < end - 1e-12:
            until = min(end, self.next)
            h = min((until - self.t) / max(1, np.ceil((until - self.t) / INTERVAL * STEPS)), until - self.t)
            if self.switched(self.t + h):
                same, other = self.t, self.t + h
                while same < (middle := (same + other) / 2) < other:
                    same, other = (same, middle) if self.switched(middle) else (middle, other)
                h = other - self.t
                self.step(h)
                self.event()
                continue
            self.step(h)
            if self.t >= self.next - 1e-12 and self.t < end - 1e-12:
                self.event()


def refused(call):
    """Whether a call is an error, as it has to be."""
    try:
        call()
    except FMICallException:
        return True
    return False


def manners(case):
    """What an FMU refuses, what it starts anew, and the derivatives of initial values."""
    other = FMU3Model(
        guid="{another}", unzipDirectory=case.unzipped, modelIdentifier=case.name, instanceName="it"
    )
    try:
        other.instantiate(loggingOn=False)
    except Exception:
        pass
    else:
        raise AssertionError("an FMU with another token")
    fmu = case.instance(FMU3Model)
    free, follows = case.reference["theta1"], case.reference["theta2"]
    near("initial values", fmu.getFloat64([follows]), [case.motion["theta2"][0]], MOTION)
    for unknown in [follows, case.reference["der(omega)"], case.reference["x_B"]]:
        slope = fmu.getDirectionalDerivative([unknown], [free], [1.0])
        start, h, sides = case.motion["theta1"][0], 1e-5, []
        for value in (start + h, start - h, start):
            fmu.setFloat64([free], [value])
            sides.append(fmu.getFloat64([unknown])[0])
        near("initial values by one another", slope, [(sides[0] - sides[1]) / (2 * h)], DIFFERENCE)
    length, torque, state = case.reference["a"], case.reference["tau"], case.reference["omega"]
    fmu.exitInitializationMode()
    assert refused(lambda: fmu.setFloat64([length], [1.0])), "a fixed parameter was set"
    assert refused(lambda: fmu.setFloat64([state], [1.0])), "a state was set by its reference"
    assert refused(lambda: fmu.setFloat64([10**6], [1.0])), "there is no such variable"
    assert refused(lambda: fmu.getInt32([state])), "a state is no integer"
    assert refused(lambda: fmu.getFloat64([10**6])), "there is no such variable"
    fmu.setFloat64([torque], [7.0])
    fmu.reset()
    assert fmu.getFloat64([torque, follows]) == [0.0, 0.5]
    # No torsion of the crank lets a rocker longer than all else close the loop.
    fmu.enterInitializationMode(startTime=0.0)
    fmu.setFloat64([length], [100.0])
    assert refused(fmu.exitInitializationMode), "the linkage does not close"
    fmu.freeInstance()
    slave = case.instance(FMU3Slave)
    slave.exitInitializationMode()
    assert refused(lambda: slave.doStep(0.3, 0.1)), "a step from another time"
    slave.setFloat64([torque], [np.nan])
    assert refused(lambda: slave.doStep(0.0, 0.1)), "a step without rates"
    slave.freeInstance()


def compiled_by_the_importer(case):
    """The package of sources alone: against the header of the standard, and with the same results."""
    compiler = shlex.split(os.environ.get("CC", "cc"))
    name = f"{case.name}_sources.fmu"
    appell("export", case.model, "--fmu", "--sources-only", "--out", name)
    assert not validate_fmu(str(FOLDER / name))
    unzipped = Path(extract(str(FOLDER / name), unzipdir=str(FOLDER / f"{case.name}_sources")))
    description = read_model_description(str(unzipped))
    assert description.guid == case.description.guid and not (unzipped / "binaries").exists()
    sources = unzipped / "sources"
    binary = unzipped / "binaries" / fmpy.platform_tuple / (case.name + fmpy.sharedLibraryExtension)
    binary.parent.mkdir(parents=True)
    files = description.buildConfigurations[0].sourceFileSets[0].sourceFiles
    flags = ["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-o", binary, *files, "-lm"]
    subprocess.run([*compiler, *flags], cwd=sources, check=True)
    (sources / "fmi-types.h").write_text('#include "fmi3Functions.h"\n')
    headers = Path(fmpy.__file__).parent / "c-code"
    subprocess.run([*compiler, "-std=c99", "-Werror", "-fsyntax-only", "-isystem", headers, "fmi-functions.c"], cwd=sources, check=True)
    runs = [
        simulate_fmu(str(folder), fmi_type="CoSimulation", stop_time=0.5, output_interval=INTERVAL)
        for folder in (unzipped, case.unzipped)
    ]
    assert runs[0].tobytes() == runs[1].tobytes(), "another compilation, other numbers"


def main():
    cases = [Case(*case) for case in CASES]
    for case in cases:
        case.co_simulation()
        case.model_exchange()
        case.derivatives()
        case.by_fmpy()
    timed = cases[-1]
    # One jump by a relation and six by the sign, eight rows of tables, two of the inputs.
    assert timed.events == 17, timed.events
    first = timed.fmu.read_bytes()
    appell("export", timed.model, "--fmu")
    assert timed.fmu.read_bytes() == first, "two exports differ"
    manners(next(case for case in cases if case.name == "four_bar"))
    compiled_by_the_importer(timed)
    lines()
    for what, off in worst.items():
        print(f"{what}: {off:.1e}")


main()
