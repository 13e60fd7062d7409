"""Checks the simulators by what does not come from them: energy, closed forms, each other, chi-square.

check.py [--archive]      with --archive a case is made anew and held against the committed one"""

import argparse
import json
import re
import tarfile
import tempfile
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

import catalogue
import generate
import loops
import mechanisms
import oracle
import rigid
import simulate
import substitutes
import truths
import twins
from effects import Actuator, DryFriction, Force, Parameter, Rig, Richer
from plan import single

HERE = Path(__file__).resolve().parent
ENERGY = 1e-7  # relative; the tolerance of the integration over two seconds
SELF = 0.1  # part of a gap by which a law with events may differ from the same one in steps
AGREEMENT = 1e-6  # rms between MuJoCo and SciPy, in units of the coordinates
TIMES = np.arange(0, 2.0001, 0.01)


def parameters(name):
    return dict(catalogue.RIGS[name]["parameters"])


def start_of(mechanism):
    x = np.random.default_rng(3).normal(0, 0.3, len(mechanism.coordinates) + len(mechanism.speeds))
    if mechanism.name in ("unicycle", "rolling_wheel"):
        x[len(mechanism.coordinates) + 1] = 9.0
    return x


def moved(name, effects=(), push=1.0, mujoco=False, times=TIMES):
    """A run under slow commands without noise."""
    mechanism = mechanisms.ALL[name]
    rig = Rig(mechanism, parameters(name), list(effects))
    amplitude = push * np.array(catalogue.forces(name, rig.parameters))[: len(mechanism.inputs)]
    drive = lambda k, t, x: amplitude * np.sin(3 * t)
    calm = np.zeros((len(times), len(mechanism.speeds)))
    return (rigid if mujoco else simulate).run(rig, drive, times, start_of(mechanism), calm)


def energy_is_conserved_without_forces():
    for name, mechanism in mechanisms.ALL.items():
        times = TIMES[:60] if "euc" in name else TIMES  # riders fall
        trial = moved(name, push=0.0, times=times)
        q, v = mechanism.split(trial.states)
        energy = mechanism.energy(parameters(name), q, v)
        kinetic = energy - mechanism.potential(parameters(name), q)
        assert np.ptp(energy) < ENERGY * max(np.max(kinetic), 1e-3), (name, np.ptp(energy))


def energy_grows_by_the_work_of_inputs():
    for name in ("cart_pole", "double_pendulum"):
        mechanism, trial = mechanisms.ALL[name], moved(name)
        q, v = mechanism.split(trial.states)
        energy = mechanism.energy(parameters(name), q, v)
        column = [np.argmax(c) for c in mechanism.input_map({}, np.zeros(2)).T]
        work = np.sum(trial.commands[:-1] * np.diff(q[:, column], axis=0))  # held over each sample
        assert abs(energy[-1] - energy[0] - work) < 1e-7, (name, energy[-1] - energy[0], work)


def mujoco_and_scipy_agree():
    mechanism = mechanisms.double_pendulum
    with_effects = {
        "carriage": [Force("viscous_friction", "x", 0.4), Force("spring", "x", 2.0)],
        "pendulum": [Parameter("mass_offset", "rod", 0.02), Force("viscous_friction", "theta", 0.05)],
        "cart_pole": [Parameter("mass_offset", "pole", 0.02), Actuator("actuator_lag", "F", 0.05)],
        "double_pendulum": [
            Parameter("added_inertia", "theta1", 0.01, mechanism),
            Force("spring", "theta2", 0.2),
        ],
    }
    for name, effects in with_effects.items():
        for some in ([], effects):
            ours, theirs = moved(name, some), moved(name, some, mujoco=True)
            apart = np.sqrt(np.mean((ours.states - theirs.states) ** 2))
            limit = (
                1e-4 if any(isinstance(e, Actuator) for e in some) else AGREEMENT
            )  # a lag goes in steps there
            assert apart < limit, (name, len(some), apart)


def wheels_that_hardly_slip_roll():
    """Derived without the formulas of the papers, and equal to them in the limit."""
    for name, build, times in (
        ("unicycle", truths.slipping_unicycle, TIMES[:40]),
        ("euc_2dof", truths.slipping_euc, TIMES[:40]),
    ):
        rolls = moved(name, times=times).states[-1]
        apart = []
        for compliance in (0.02, 0.002):
            effect = Richer("slip", "contact", compliance, build)
            apart.append(np.max(np.abs(moved(name, [effect], times=times).states[-1] - rolls)))
        assert apart[0] < 0.02 and apart[1] < 0.15 * apart[0], (name, apart)


def dry_friction_stops_and_holds():
    """A carriage slows down by F_c/m, stops, and does not move until the push exceeds F_c."""
    p = parameters("carriage")
    friction = 0.5
    rig = Rig(mechanisms.carriage, p, [DryFriction("coulomb_friction", "x", friction)])
    push = lambda k, t, x: np.array([0.0 if t < 1.5 else 0.8 * friction if t < 1.75 else 2 * friction])
    trial = simulate.run(rig, push, TIMES, np.array([0.0, 0.3]), np.zeros((len(TIMES), 1)))
    x, v = trial.states.T
    stop = 0.3**2 * p["m"] / (2 * friction)
    assert abs(x[120] - stop) < 1e-8 and v[120] == 0.0, (x[120], stop)
    assert x[175] == x[120], "held below break-away"
    assert abs(v[-1] - friction / p["m"] * 0.25) < 1e-8, v[-1]


def actuators_follow_their_differential_equations():
    lag, swing = Actuator("actuator_lag", "F", 0.05), Actuator("actuator_lag", "F", 0.05, "second_order")
    command = lambda t: np.sin(5 * t)
    pulse = 1.2 / 0.05
    x = np.zeros(3)
    for t in TIMES[:-1]:
        lag.hold(t, command(t))
        swing.hold(t, command(t))
        u = command(t)
        rates = lambda s, x: [(u - x[0]) / 0.05, x[2], pulse**2 * (u - x[1]) - 1.2 * pulse * x[2]]
        x = solve_ivp(rates, (t, t + 0.01), x, rtol=1e-11, atol=1e-13).y[:, -1]
        assert abs(lag.value(t + 0.01) - x[0]) < 1e-9 and abs(swing.value(t + 0.01) - x[1]) < 1e-9


def delays_shift_the_command():
    """The momentum of a carriage is the impulse of the late command."""
    for delay, mujoco in ((0.0137, False), (0.0137, True), (0.0003, True)):
        trial = moved("carriage", [Actuator("actuator_delay", "F", delay)], mujoco=mujoco)
        u = trial.commands[:, 0]
        whole, part = divmod(delay, 0.01)
        last = len(u) - 2 - int(whole)  # what still comes, for the rest of its sample
        late = u[0] * delay + np.sum(u[:last]) * 0.01 + u[last] * (0.01 - part)
        gained = parameters("carriage")["m"] * (trial.states[-1, 1] - trial.states[0, 1])
        assert abs(gained - late) < 1e-8, (delay, mujoco, gained, late)


def lugre_and_play_lose_energy():
    """What a rig has besides may not drive it."""
    for effect in (
        catalogue.make(
            mechanisms.pendulum, parameters("pendulum"), "coulomb_friction", "theta", 4.0, "lugre"
        ),
        catalogue.make(mechanisms.pendulum, parameters("pendulum"), "hysteresis", "theta", 4.0),
        catalogue.make(mechanisms.pendulum, parameters("pendulum"), "backlash", "theta", 1.0),
    ):
        trial = moved("pendulum", [effect], push=0.0)
        q, v = mechanisms.pendulum.split(trial.states)
        energy = mechanisms.pendulum.energy(parameters("pendulum"), q, v)
        assert energy[-1] < energy[0] + 1e-6, (effect.kind, effect.law, energy[[0, -1]])


def normalised(place, rig, trial, measured):
    """Innovations of the oracle's filter with the true law, each row in its standard deviations."""
    filter = oracle.Filter(rig, trial, place.noise, place.disturbance_sd)
    inputs, still = oracle.held(trial.commands), np.zeros(len(place.disturbance_sd))
    x, out = trial.states[0].copy(), []
    for k in range(len(trial.t)):
        e = measured[k] - x[: filter.n]
        out.append(filter.white[k] @ e)
        x = x + filter.K[k] @ e
        if k + 1 < len(trial.t):
            step = trial.t[k + 1] - trial.t[k]
            x = oracle.flow(place.mechanism, place.true, x, inputs[k], still, step)
    return np.array(out[10:])


def innovations_of_the_true_filter_are_white():
    """The oracle's filter on recordings without a gap: mean normalised innovation of one."""
    for name, number in generate.names().items():
        case = generate.CASES[number]
        if case.null_kind != "clean" or case.mechanism not in ("carriage", "pendulum"):
            continue
        place = generate.world(number, case)
        rig = place.rig([])
        trial = generate.trial(place, rig, 0)
        out = normalised(place, rig, trial, generate.recorded(place, rig, trial, 0))
        mean = np.mean(np.square(out))
        assert abs(mean - 1) < 4 * np.sqrt(2 / np.size(out)), (name, mean)


def loops_have_no_gap():
    """Innovations of the true filter have variance one and correlate neither with the last ones nor with changes
    of the last command, where gusts are white or there are none."""
    for name, loop in loops.LOOPS.items():
        place = loops.world(name)
        if place.case.gusts and place.correlation_s:
            continue
        place.disturbance_sd = place.disturbance_sd * (1.0 if loop.gusts else 1e-6)
        trials, shown = loops.trials(place)
        out = normalised(place, place.rig([]), trials[0], shown[0])
        rounding = np.square([generate.resolution(noise)[0] for noise in place.noise]) / 12
        most = 1 + np.max(rounding / np.square(place.noise))
        chance = 4 * np.sqrt(2 / np.size(out))
        assert 1 - chance < np.mean(np.square(out)) < most + chance, (name, np.mean(np.square(out)))
        before = np.diff(trials[0].commands, axis=0)[8 : 8 + len(out)]
        for channel in out.T:
            known = [channel[:-1], *before.T[:, 1:]]
            correlations = [np.corrcoef(channel[1:], other)[0, 1] for other in known]
            assert np.max(np.abs(correlations)) < 4.5 / np.sqrt(len(out)), (name, correlations)


def loops_move_as_by_the_other_integrator():
    """The recorded commands, given again."""
    for name in ("loop_17", "loop_23", "loop_39"):
        place = loops.world(name)
        trial = loops.trials(place)[0][0]
        again = simulate.run(
            place.rig([]), lambda k, t, x: trial.commands[k], trial.t[:200], trial.states[0], trial.disturbance
        )
        assert np.max(np.abs(again.states - trial.states[:200])) < 1e-5, name


class Seen:
    """One run of a rig with an effect."""

    def __init__(self, mechanism, effect, size):
        self.place = generate.world(0, single(mechanism, effect, "field", size=size))
        rig = self.place.rig([size])
        self.trial = generate.trial(self.place, rig, 0)
        self.recordings = twins.recordings_of(self.place, rig, [self.trial])
        self.size = self.recordings.size

    def from_(self, name):
        """Separation from an effect."""
        candidates = [c for c in twins.candidates_of(self.place, [self.trial]) if c.name == name]
        return twins.separations(self.recordings, candidates)[0][name]


def an_effect_is_its_own_twin():
    """What is simulated with events, contacts and further speeds is what a substitute does in steps."""
    for mechanism, effect, size, name in (
        ("carriage", "coulomb_friction@x", 0.3, "coulomb_friction@x"),
        ("carriage", "stribeck_friction@x", 0.3, "stribeck_friction@x"),
        ("cart_pole", "quadratic_drag@pole", 0.2, "quadratic_drag@pole"),
        ("double_pendulum", "mass_offset@link2", 0.5, "mass_offset@link2"),
        ("unicycle", "added_inertia@r", 2.0, "added_inertia@r"),
        ("pendulum", "parameter_error@l", 2.0, "parameter_error@l"),
        ("pendulum", "actuator_saturation@tau", 1.8, "actuator_saturation@tau"),
        ("carriage", "actuator_lag@F", 0.3, "actuator_lag@F"),
        ("carriage", "actuator_delay@F", 0.3, "actuator_delay@F"),
        ("carriage", "sensor_delay@x", 0.3, "sensor_delay@x"),
        ("euc_2dof", "longitudinal_slip@contact", 6.0, "longitudinal_slip@rolling"),
        ("unicycle", "lateral_slip@contact", 1.0, "lateral_slip@rolling"),
    ):
        seen = Seen(mechanism, effect, size)
        apart = seen.from_(name)
        assert seen.size > 3 and apart < SELF * seen.size, (effect, seen.size, apart)


def twins_are_mutual():
    """Two laws that are linear in their sizes take the same part of each other's gap."""
    for mechanism, first, second in (
        ("carriage", "viscous_friction@x", "quadratic_drag@carriage"),
        ("cart_pole", "ground_slope@gravity", "constant_force@pole"),
    ):
        both = [Seen(mechanism, one, 0.2) for one in (first, second)]
        shares = [seen.from_(other) / seen.size for seen, other in zip(both, (second, first))]
        assert abs(shares[0] - shares[1]) < 0.05 and 0.01 < shares[0] < 0.99, (first, second, shares)


def separations_are_those_of_a_filter_with_the_wrong_law():
    """A filter with the substitute's law, its size and the parameters fitted to a run without noise: what
    it is surprised by, against the projection of signatures."""
    for mechanism, effect, size, wrong in (
        ("pendulum", "coulomb_friction@theta", 0.3, "viscous_friction@theta"),
        ("carriage", "actuator_lag@F", 1.0, "actuator_delay@F"),
    ):
        seen = Seen(mechanism, effect, size)
        place, trial, filter = seen.place, seen.trial, seen.recordings.filters[0]
        stds = generate.tolerances(place)
        astray = [(place.true[name] - place.declared[name]) / std for name, std in stds.items()]

        def surprises(fitted):
            other = catalogue.make(place.mechanism, place.true, *wrong.split("@"), fitted[0])
            p = {
                **place.true,
                **{name: place.true[name] + s * z for (name, s), z in zip(stds.items(), fitted[1:])},
            }
            inputs, effects = oracle.held(trial.commands), [other]
            if isinstance(other, Actuator):
                inputs, effects = substitutes.acted(place.mechanism, other, trial.t, trial.commands), []
            x, out = trial.states[0], []
            for k, dt in enumerate(np.diff(trial.t)):
                e = trial.states[k, : filter.n] - x[: filter.n]
                out.append(filter.white[k] @ e)
                x = x + filter.K[k] @ e
                x = oracle.flow(place.mechanism, p, x, inputs[k], trial.disturbance[k], dt, 0.0, effects)
            return np.concatenate(out + [fitted[1:] + astray])

        start = np.append(size, np.zeros(len(stds)))
        fit = least_squares(surprises, start, diff_step=1e-3, ftol=1e-3, max_nfev=10)
        by_force = np.sqrt(2 * fit.cost - seen.recordings.own**2)
        projected = seen.from_(wrong)
        assert abs(by_force - projected) < 0.1 + 0.05 * by_force, (effect, wrong, by_force, projected)


def a_case_is_made_again_byte_for_byte():
    name = next(n for n, i in generate.names().items() if generate.CASES[i].mechanism == "carriage")
    with tempfile.TemporaryDirectory() as place:
        generate.make_case(generate.names()[name], name, Path(place))
        with tarfile.open(HERE / "cases.tar.xz") as archive:
            for path in sorted((Path(place) / "cases" / name).iterdir()):
                committed = archive.extractfile(f"cases/{name}/{path.name}").read()
                assert committed == path.read_bytes(), f"{name}/{path.name}"


def labels_and_cases_agree():
    """As many as planned, and no case tells its label."""
    labels = json.loads((HERE / "labels.json").read_text())["cases"]
    with tarfile.open(HERE / "cases.tar.xz") as archive:
        recordings = [m for m in archive.getnames() if m.endswith("recording.toml")]
        assert {m.split("/")[1] for m in recordings} == set(labels) == set(generate.names())
        for member in recordings:
            text = archive.extractfile(member).read().decode()
            label = labels[member.split("/")[1]]
            for word in label["effects"] + [
                label["kind"],
                label["off_kind"] or "@",
                label["null_kind"] or "@",
            ]:
                assert word.split("@")[0] not in text or not word.split("@")[0], (member, word)


def twins_are_made_again():
    """As the label has them; and no right answer is called a twin."""
    labels = json.loads((HERE / "labels.json").read_text())["cases"]
    for label in labels.values():
        right = [pattern for patterns in label["accept"] for pattern in patterns]
        assert ("twins" in label) == (label["kind"] in ("single", "mismatch"))
        assert not any(re.fullmatch(pattern, name) for pattern in right for name in label.get("twins", {}))
    name = next(
        n for n, label in sorted(labels.items()) if label["mechanism"] == "pendulum" and label.get("twins")
    )
    place, rig, _ = generate.sized_rig(generate.names()[name])
    trials = [generate.trial(place, rig, run) for run in range(generate.FIT_RUNS)]
    again, label = twins.twins_of(place, rig, trials, labels[name]["accept"]), labels[name]["twins"]
    assert again.keys() == label.keys(), (name, again, label)
    assert all(abs(again[one] - label[one]) < 0.02 for one in again), (name, again, label)


def rigs_stay_up():
    """No feedback of a drive lets a rig fall over."""
    most = {"phi": 0.6, "gamma": 0.6, "theta": 0.9}  # rad; the wheel's phi turns, the pendulums swing
    with tarfile.open(HERE / "cases.tar.xz") as archive:
        for name, number in generate.names().items():
            kind = generate.CASES[number].mechanism
            for run in range(1, generate.RUNS + 1) if kind in ("unicycle", "euc_2dof", "euc_3dof") else ():
                rows = np.genfromtxt(
                    archive.extractfile(f"cases/{name}/run{run}.csv"), delimiter=",", names=True
                )
                for angle in (
                    ("theta",)
                    if kind == "unicycle"
                    else ("phi", "gamma")[: 1 + ("gamma" in rows.dtype.names)]
                ):
                    assert np.nanmax(np.abs(rows[angle])) < most[angle], (name, run, angle)


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("--archive", action="store_true")
    ask = ask.parse_args()
    checks = [
        energy_is_conserved_without_forces,
        energy_grows_by_the_work_of_inputs,
        mujoco_and_scipy_agree,
        wheels_that_hardly_slip_roll,
        dry_friction_stops_and_holds,
        actuators_follow_their_differential_equations,
        delays_shift_the_command,
        lugre_and_play_lose_energy,
        innovations_of_the_true_filter_are_white,
        loops_have_no_gap,
        loops_move_as_by_the_other_integrator,
        an_effect_is_its_own_twin,
        twins_are_mutual,
        separations_are_those_of_a_filter_with_the_wrong_law,
    ]
    if ask.archive:
        checks += [
            labels_and_cases_agree,
            rigs_stay_up,
            twins_are_made_again,
            a_case_is_made_again_byte_for_byte,
        ]
    for check in checks:
        check()
        print("ok  ", check.__name__.replace("_", " "), flush=True)


if __name__ == "__main__":
    main()
