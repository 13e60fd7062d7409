"""Closed loops without a gap: rigs whose declared model is right up to parameters within their tolerances,
under a digital controller that has only the recorded measurements. The command of a sample is computed from
the noisy, rounded measurements up to this sample and held until the next one. Half of the rigs are disturbed
by gusts. Any verdict other than `no_gap` is a false alarm.

    loops.py --out FOLDER [--only NAME …]                       makes the cases
    loops.py --out FOLDER --tool PATH --reports FOLDER          diagnoses them, then scores
    loops.py --reports FOLDER                                   scores the reports of the folder
    loops.py --reports FOLDER --write docs/gap-diagnosis.md     and writes the table between its markers

All numbers follow from the seed of `generate.py`."""

import argparse
from dataclasses import dataclass
from pathlib import Path

import generate  # first: it sets the number of threads

import numpy as np
from scipy.linalg import expm

import catalogue
import drive
import oracle
import score
from simulate import Trial

FIRST = 2000  # number of the first loop; other cases of this folder have smaller ones
BEGIN, END = "<!-- loops of tests/blind: begin -->", "<!-- loops of tests/blind: end -->"
RIGS = [  # mechanism, controller, sample time
    ("carriage", "pd", 0.002),
    ("carriage", "cascade", 0.005),
    ("carriage", "pi", 0.01),
    ("carriage", "observer", 0.02),
    ("pendulum", "pi", 0.004),
    ("pendulum", "pd", 0.01),
    ("pendulum", "observer", 0.005),
    ("cart_pole", "observer", 0.005),
    ("cart_pole", "pd", 0.01),
    ("cart_pole", "filtered", 0.01),
    ("cart_pole", "pi", 0.02),
    ("double_pendulum", "pd", 0.004),
    ("double_pendulum", "cascade", 0.01),
    ("double_pendulum", "pd", 0.016),
    ("euc_2dof", "filtered", 0.005),
    ("euc_2dof", "observer", 0.01),
    ("euc_3dof", "observer", 0.004),
    ("unicycle", "filtered", 0.004),
    ("unicycle", "filtered", 0.01),
    ("unicycle", "filtered", 0.016),
]
CONTROLLERS = {
    "pd": "PD position control",
    "pi": "PI velocity control",
    "cascade": "cascaded P position and PI velocity control",
    "observer": "LQR with an observer",
    "filtered": "state feedback with filtered derivatives",
}


@dataclass
class World(generate.World):
    """A rig and the correlation time of its gusts; zero for white ones."""

    correlation_s: float = 0.0


@dataclass(frozen=True)
class Loop:
    """What `generate.py` asks of a case, and how it is controlled."""

    mechanism: str
    controller: str
    step_s: float
    gusts: bool
    effects: tuple = ()

    @property
    def null_kind(self):
        return "disturbance" if self.gusts else "calm"


LOOPS = {
    f"loop_{2 * i + gusts + 1:02d}": Loop(*rig, bool(gusts)) for i, rig in enumerate(RIGS) for gusts in (0, 1)
}


# Controllers: from time and measurements of a sample to the command that is held until the next one.


class Rates:
    """Derivatives of measurements by backward differences and a low pass of first order."""

    def __init__(self, mechanism, step):
        self.step, self.last = step, None
        constant_s = 0.04 if mechanism.name == "euc_2dof" else 0.012  # an odometer is coarse
        self.keep = np.exp(-step / max(constant_s, 1.5 * step))
        self.value = np.zeros(len(mechanism.coordinates))

    def __call__(self, y):
        if self.last is not None:
            self.value = self.keep * self.value + (1 - self.keep) * (y - self.last) / self.step
        self.last = y
        return self.value


def sequence(rng, duration, reach):
    """A sequence of set points, with steps or ramps between them."""
    return drive.plateaus(rng, duration, -reach, reach, rise=rng.choice([0.02, 0.4, 0.8]))


class Joints:
    """The actuated coordinates, with the inertia and weight of the declared model."""

    def __init__(self, place):
        self.mechanism, self.p = place.mechanism, place.declared
        self.n = len(place.mechanism.inputs)

    def force(self, y, acceleration):
        """The force for an acceleration of each joint with the others locked, with gravity compensation."""
        still = np.zeros(len(self.mechanism.speeds))
        inertia = np.diag(self.mechanism.mass(self.p, y))[: self.n]
        return inertia * acceleration + self.mechanism.bias(self.p, y, still)[: self.n]

    def sequences(self, rng, duration, which):
        """Set points for each joint: 0 for positions, 1 for velocities."""
        reach = [catalogue.MOTION[self.mechanism.name][c][which] for c in self.mechanism.coordinates[: self.n]]
        set_points = [sequence(rng, duration, r) for r in reach]
        return lambda t: np.array([set_point(t) for set_point in set_points])


def at_rest(place):
    return np.zeros(len(place.mechanism.coordinates) + len(place.mechanism.speeds))


def pd(place, rng, duration, step):
    joints, rates = Joints(place), Rates(place.mechanism, step)
    set_point, bandwidth = joints.sequences(rng, duration, 0), rng.uniform(5, 8)

    def law(t, y):
        q, rate = y[: joints.n], rates(y)[: joints.n]
        return joints.force(y, bandwidth**2 * (set_point(t) - q) - 1.4 * bandwidth * rate)

    return at_rest(place), law


class VelocityLoop:
    """PI control of velocities, with gain and reset time."""

    def __init__(self, joints, step, gain, reset_s):
        self.joints, self.rates, self.step = joints, Rates(joints.mechanism, step), step
        self.gain, self.reset_s, self.sum = gain, reset_s, 0.0

    def __call__(self, y, wanted):
        off = wanted - self.rates(y)[: self.joints.n]
        self.sum = self.sum + off * self.step / self.reset_s
        return self.joints.force(y, self.gain * (off + self.sum))


def pi(place, rng, duration, step):
    joints = Joints(place)
    set_point = joints.sequences(rng, duration, 1)
    loop = VelocityLoop(joints, step, rng.uniform(6, 12), 0.5)
    return at_rest(place), lambda t, y: loop(y, set_point(t))


def cascade(place, rng, duration, step):
    joints = Joints(place)
    set_point = joints.sequences(rng, duration, 0)
    loop, stiff = VelocityLoop(joints, step, rng.uniform(10, 16), 0.5), rng.uniform(3, 4)
    return at_rest(place), lambda t, y: loop(y, stiff * (set_point(t) - y[: joints.n]))


UPRIGHT = {"pendulum": (np.pi,), "cart_pole": (0.0, np.pi)}
EFFORT = {"euc_2dof": (20.0,), "euc_3dof": (20.0, 10.0)}


def observer_gain(F, pushed, noise, samples=3000):
    """The stationary gain of the Kalman filter where the first states are measured."""
    n, P = len(noise), np.eye(len(F))
    for _ in range(samples):
        P = F @ P @ F.T + pushed @ pushed.T
        gain = np.linalg.solve(P[:n, :n] + np.diag(np.square(noise)), P[:n]).T
        P = P - gain @ P[:n]
        P = (P + P.T) / 2
    return gain


def observer(place, rng, duration, step):
    """LQR about an equilibrium, upright where there is one, with a Kalman filter of the linear model. The first
    coordinate follows set points."""
    mechanism, p = place.mechanism, place.declared
    n, size = len(mechanism.coordinates), len(mechanism.coordinates) + len(mechanism.speeds)
    typical, known = np.array(catalogue.forces(mechanism.name, p)), catalogue.MOTION[mechanism.name]
    still = np.zeros(size)
    still[:n] = UPRIGHT.get(mechanism.name, np.zeros(n))
    A, B = drive.linearised(mechanism, p, list(range(size)), still)
    amplitudes = np.array([known[c] for c in mechanism.coordinates]).T.ravel()
    amplitudes[0] = min(amplitudes[0], 0.5)  # position control
    effort = np.array(EFFORT.get(mechanism.name, typical[: B.shape[1]]))
    K = drive.sampled_regulator(A, B, amplitudes**-2, effort**-2.0, step)
    both = expm(np.block([[A, B], [np.zeros((B.shape[1], size + B.shape[1]))]]) * step)
    F, G = both[:size, :size], both[:size, size:]
    pushed = np.linalg.inv(mechanism.mass(p, still[:n])) * (0.3 * typical * step)  # velocities after a sample
    L = observer_gain(F, np.concatenate([0.5 * step * pushed, pushed]), place.noise)
    reach = 0.2 if mechanism.name == "pendulum" else 0.4
    set_point = drive.plateaus(rng, duration, -reach, reach, rise=rng.uniform(0.4, 1.2))
    wanted, expected = np.zeros(size), np.zeros(size)

    def law(t, y):
        nonlocal expected
        seen = expected + L @ (y - still[:n] - expected[:n])
        wanted[0] = set_point(t)
        u = -K @ (seen - wanted)
        expected = F @ seen + G @ u
        return u

    start = still.copy()
    start[:n] += rng.normal(0, 0.02, n)
    return start, law


def filtered(place, rng, duration, step):
    """The state feedback of `drive.py`, from measurements and their filtered derivatives."""
    mechanism, p = place.mechanism, place.declared
    start, feedback = getattr(drive, mechanism.name)(p, rng, duration, 0)
    rates = Rates(mechanism, step)
    rates.value = mechanism.kinematics(p, start[: len(mechanism.coordinates)]) @ start[len(mechanism.coordinates) :]

    def law(t, y):
        v = np.linalg.pinv(mechanism.kinematics(p, y)) @ rates(y)
        return feedback(0, t, np.concatenate([y, v]))

    return start, law


# Cases.


def gusts(place, n, rng):
    """Random forces held over each sample: white ones, or of first order with a correlation time."""
    sd, step = place.disturbance_sd, place.case.step_s
    white = rng.normal(0, 1, (n, len(sd))) * sd
    if not place.case.gusts:
        return 0 * white
    if not place.correlation_s:
        return white
    keep = np.exp(-step / place.correlation_s)
    forces = white.copy()
    for k in range(1, n):
        forces[k] = keep * forces[k - 1] + np.sqrt(1 - keep**2) * white[k]
    return forces


def world(name):
    place = generate.world(FIRST + list(LOOPS).index(name), LOOPS[name])
    rng = np.random.default_rng((*place.seed, 91))
    place.disturbance_sd = place.disturbance_sd * np.exp(rng.uniform(np.log(0.1), 0.0))
    correlation_s = rng.choice([0.0, *np.exp(rng.uniform(np.log(0.1), 0.0, 3))])
    return World(**vars(place), correlation_s=correlation_s)


def sensors(place, rng):
    """The measurements of a state: noisy and rounded, as they are recorded."""
    steps = np.array([generate.resolution(noise)[0] for noise in place.noise])
    noise = lambda: rng.normal(0, place.noise)
    return lambda x: np.round((x[: len(steps)] + noise()) / steps) * steps


def trials(place):
    """The runs of a rig, integrated together, and their measurements."""
    step = place.case.step_s
    rngs = [np.random.default_rng((*place.seed, run)) for run in range(generate.RUNS)]
    rows = [int(rng.uniform(6.0, 10.0) / step) for rng in rngs]
    control = globals()[place.case.controller]
    starts, laws = zip(*(control(place, rng, n * step, step) for n, rng in zip(rows, rngs)))
    show = [sensors(place, rng) for rng in rngs]
    x, t = np.array(starts), np.round(np.arange(max(rows)) * step, 4)
    forces = np.stack([gusts(place, len(t), rng) for rng in rngs], axis=1)
    states, shown, commands = [], [], []
    for now, force in zip(t, forces):
        states.append(x)
        shown.append([see(one) for see, one in zip(show, x)])
        given = [np.atleast_1d(law(now, y)) for law, y in zip(laws, shown[-1])]
        commands.append([[float(f"{u:.4g}") for u in each] for each in given])  # as it is logged
        x = oracle.flow(place.mechanism, place.true, x, oracle.held(np.array(commands[-1])), force, step)
    states, shown, commands = map(np.array, (states, shown, commands))
    cut = lambda values, run: values[: rows[run], run]
    runs = range(generate.RUNS)
    whole = [Trial(t[: rows[r]], cut(states, r), cut(commands, r), cut(forces, r)) for r in runs]
    return whole, [cut(shown, r) for r in runs]


def make(name, out):
    place = world(name)
    folder = out / name
    folder.mkdir(parents=True, exist_ok=True)
    for number, (trial, shown) in enumerate(zip(*trials(place)), start=1):
        generate.write_run(folder / f"run{number}.csv", place, trial, shown)
    generate.write_recording(folder, place, 1.0)


# Scores.


def is_alarm(answer):
    return answer is None or answer.verdict != "no_gap"


def winds():
    """Kinds of gusts, and the loops that have them."""
    kinds = {"no gusts": [], "white gusts": [], "coloured gusts": []}
    for name, loop in LOOPS.items():
        kind = "no gusts" if not loop.gusts else "coloured gusts" if world(name).correlation_s else "white gusts"
        kinds[kind].append(name)
    return kinds


def table(reports):
    answers = {name: score.read(reports / f"{name}.json") for name in LOOPS}
    mechanisms = dict.fromkeys(loop.mechanism for loop in LOOPS.values())
    rows = {text: (lambda loop, kind=kind: loop.controller == kind) for kind, text in CONTROLLERS.items()}
    rows |= {f"`{name}`": (lambda loop, name=name: loop.mechanism == name) for name in mechanisms}
    columns = {}
    for wind, names in (winds() | {"all": list(LOOPS)}).items():
        alarms = {name: is_alarm(answers[name]) for name in names}
        columns[wind] = [("all loops", score.rate(alarms.values()))]
        for text, chosen in rows.items():
            own = [alarm for name, alarm in alarms.items() if chosen(LOOPS[name])]
            columns[wind].append((text, f"{sum(own)} of {len(own)}" if own else "–"))
    return score.table("false alarms (development score)", columns)


def section(reports):
    text = (
        f"Development scores of engine {score.engines(LOOPS, reports)} on {len(LOOPS)} simulated closed loops without a gap: "
        "a digital controller computes each command from the noisy measurements up to the same sample. "
        "Sample times are 2 to 20 ms, correlation times of coloured gusts 0.1 to 1 s. Intervals of 95 % in brackets."
    )
    return text + "\n\n" + table(reports)


def list_alarms(reports):
    for name, loop in LOOPS.items():
        answer = score.read(reports / f"{name}.json")
        if not is_alarm(answer):
            continue
        said = "no report"
        if answer:
            said = f"{answer.verdict}, {'+'.join(answer.sets[0]) or 'nothing'} at {answer.probability:.3f}"
        wind = f"gusts of {world(name).correlation_s:.2f} s" if loop.gusts else "no gusts"
        print(f"{name} {loop.mechanism:15} {loop.controller:8} {1e3 * loop.step_s:2.0f} ms, {wind}: {said}")


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("--out", type=Path, help="folder of the cases")
    ask.add_argument("--only", nargs="*", help="names of loops")
    ask.add_argument("--reports", type=Path, help="folder of the reports")
    ask.add_argument("--tool", help="binary of appell; without it the reports that are there are scored")
    ask.add_argument("--jobs", type=int, default=1)
    ask.add_argument("--write", type=Path, help="Markdown file with markers")
    ask = ask.parse_args()
    names = ask.only or list(LOOPS)
    if ask.out:
        for name in names:
            if not (ask.out / name / "recording.toml").exists():
                make(name, ask.out)
    if ask.tool:
        score.run(ask.tool, ask.reports, dict.fromkeys(names, ()), ask.jobs, ask.out)
    if ask.reports:
        print(section(ask.reports))
        list_alarms(ask.reports)
    if ask.write:
        score.write(ask.write, section(ask.reports), (BEGIN, END))


if __name__ == "__main__":
    main()
