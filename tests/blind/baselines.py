"""Simpler methods on the same cases, with reports that the same scorer reads.

    finite_differences   accelerations by Savitzky and Golay, least squares, BIC; without scales and delays
                         of sensors, which this method fits to its own noise
    output_error         simulated runs fitted by Gauss and Newton (single shooting), one effect by one more
                         step, BIC; with pairs BIC would always choose two, as disturbances are not white there
    refitted             the declared model with its parameters fitted again, never an effect

They know the mechanisms of `mechanisms.py` and the laws of `effects.py`: the very ones of the rigs. They
read the recordings, not the labels."""

import argparse
import json
import os
import tempfile
import time
import tomllib
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from scipy.signal import butter, savgol_filter, sosfiltfilt

import catalogue
import mechanisms
from effects import Actuator, Parameter, Sensor
from mechanisms import times
from generate import archive
from score import unpack

PASS_HZ = 8.0  # what the smoothing keeps, of motions and inputs alike
WINDOW, ORDER = 5, 4  # of the derivatives
EDGE = 15  # samples at the ends that the smoothing spoils
STEPS = 3  # of Gauss and Newton
ONE_SIDED = """viscous_friction coulomb_friction rolling_resistance spin_friction quadratic_drag added_inertia
actuator_lag actuator_delay actuator_saturation actuator_dead_zone sensor_delay""".split()
TIED = 20  # odds below which hypotheses count as tied
HORIZON_S = 1.0


class Recording:
    def __init__(self, folder):
        told = tomllib.loads((folder / "recording.toml").read_text())
        self.mechanism = mechanisms.ALL[told["mechanism"]]
        self.p = {name: entry["value"] for name, entry in told["parameters"].items()}
        self.std = {name: entry["std"] for name, entry in told["parameters"].items() if entry["std"]}
        self.noise = np.array([told["channels"][name]["noise_std"] for name in self.mechanism.coordinates])
        self.fit = [self.run(folder / name) for name in told["runs"]["fit"]]
        self.test = [self.run(folder / name) for name in told["runs"]["test"]]
        inputs = [run[2] for run in self.fit if run[2].size]
        self.peak = np.max([np.max(np.abs(u), axis=0) for u in inputs], axis=0) if inputs else np.zeros(0)

    def run(self, path):
        """Times, positions without holes, inputs."""
        columns = np.genfromtxt(path, delimiter=",", names=True)
        t = columns["t"]
        y = np.stack([columns[name] for name in self.mechanism.coordinates], axis=1)
        for channel in y.T:
            hole = np.isnan(channel)
            channel[hole] = np.interp(t[hole], t[~hole], channel[~hole])
        u = [columns[name] for name in self.mechanism.inputs]
        return t, y, np.stack(u, axis=1) if u else np.zeros((len(t), 0))


def candidates(data):
    """Every effect that has one size, at every place; in units of what is typical."""
    m = data.mechanism
    names = [f"parameter_error@{name}" for name in data.std]
    moving = [c for c in m.coordinates if c in catalogue.MOTION[m.name]]
    friction = [c for c in moving if not (m.name in ("unicycle", "rolling_wheel") and c == "phi")]
    names += [f"coulomb_friction@{c}" for c in friction]
    names += [f"{kind}@{c}" for kind in ("viscous_friction", "spring") for c in moving]
    names += [f"{kind}@{body}" for kind in ("quadratic_drag", "constant_force") for body in m.bodies]
    names += ["ground_slope@gravity"]
    names += ["rolling_resistance@wheel"] if "wheel" in m.bodies else []
    names += ["spin_friction@wheel"] if m.name in ("unicycle", "rolling_wheel") else []
    names += [f"added_inertia@{c}" for c in friction if m.name != "unicycle" or c == "r"]
    names += [f"mass_offset@{list(m.bodies)[-1]}"] if "e" in m.defaults else []
    kinds = ("gain", "bias", "lag", "delay", "saturation", "dead_zone")
    names += [f"actuator_{kind}@{u}" for kind in kinds for u in m.inputs]
    names += [f"sensor_{kind}@{c}" for kind in ("bias", "scale", "delay") for c in m.coordinates]
    return names


def effect(data, name, size):
    """Saturation is of a size that cuts more of the peak the larger it is."""
    kind, site = name.split("@")
    column = data.mechanism.inputs.index(site) if site in data.mechanism.inputs else 0
    peak = float(data.peak[column]) if len(data.peak) else 1.0
    if kind == "actuator_saturation":
        size = 1 - 0.05 * abs(size)
    if kind in ("actuator_dead_zone", "actuator_lag", "actuator_delay", "sensor_delay"):
        size = max(size, 1e-6)
    return catalogue.make(data.mechanism, data.p, kind, site, size, "library", peak)


# Parts of models, for many variants at once.


class Variant:
    def __init__(self, data, p, sizes):
        """sizes: name of a candidate -> size."""
        made = [effect(data, name, size) for name, size in sizes.items()]
        self.sizes = tuple(sizes.items())
        self.p = dict(p)
        for one in made:
            one.change(self.p)
        self.actuators = [e for e in made if isinstance(e, Actuator)]
        self.sensors = [e for e in made if isinstance(e, Sensor)]
        self.forces = [e for e in made if not isinstance(e, (Actuator, Sensor, Parameter))]

    def given(self, data, t, u):
        """What the actuators give in the middle of each sample."""
        out = u.copy()
        for actuator in self.actuators:
            i = data.mechanism.inputs.index(actuator.site)
            actuator.reset()
            for k in range(len(t)):
                actuator.hold(t[k], u[k, i])
                middle = t[k] + (t[min(k + 1, len(t) - 1)] - t[k]) / 2
                actuator.enter(middle)
                out[k, i] = actuator.value(middle)
        return out

    def shown(self, data, t, states):
        n = len(data.mechanism.coordinates)
        q = states[:, :n].copy()
        rates = times(data.mechanism.kinematics(self.p, q), states[:, n:])
        for sensor in self.sensors:
            i = data.mechanism.coordinates.index(sensor.site)
            q[:, i] = sensor.shown(t, q[:, i], rates[:, i])
        return q


def stacked(variants):
    names = sorted({name for v in variants for name in v.p})
    return {name: np.array([v.p.get(name, 0.0) for v in variants]) for name in names}


def stepper(data, variants):
    """Runge-Kutta steps of a batch of states, one row a variant (or all rows of one variant)."""
    m, single = data.mechanism, len(variants) == 1
    p = variants[0].p if single else stacked(variants)
    groups = {}
    for row, variant in enumerate(variants):
        if variant.forces:
            groups.setdefault(variant.sizes, []).append(row)
    groups = [
        (
            variants[rows[0]].forces,
            *((p, slice(None)) if single else ({k: x[rows] for k, x in p.items()}, rows)),
        )
        for rows in groups.values()
    ]

    def rates(x, u):
        q, v = m.split(x)
        f = times(m.input_map(p, q), u) if m.inputs else 0 * v
        for forces, own, rows in groups:
            for force in forces:
                f[rows] = f[rows] + force.force(m, own, q[rows], v[rows], 0.0)
        return np.concatenate([times(m.kinematics(p, q), v), m.acceleration(p, q, v, f)], axis=-1)

    def step(x, u, h):
        k1 = rates(x, u)
        k2 = rates(x + h / 2 * k1, u)
        k3 = rates(x + h / 2 * k2, u)
        return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + rates(x + h * k3, u))

    return step


def simulated(data, variants, starts, runs):
    """What each variant shows along its run, [sample, channel] each. Runs that end early stand still."""
    longest = max(len(t) for t, _, _ in runs)
    pad = lambda values: np.concatenate([values, np.repeat(values[-1:], longest - len(values), axis=0)])
    given, known = [], {}
    for variant, (t, _, u) in zip(variants, runs):
        key = (id(t), tuple(entry for entry in variant.sizes if entry[0].startswith("actuator")))
        if key not in known:
            known[key] = pad(variant.given(data, t, u))
        given.append(known[key])
    inputs, clocks = np.stack(given, axis=1), np.stack([pad(t) for t, _, _ in runs], axis=1)
    step, x, states = stepper(data, variants), np.array(starts), []
    for k in range(longest):
        states.append(x)
        if k + 1 < longest:
            x = np.clip(step(x, inputs[k], (clocks[k + 1] - clocks[k])[:, None]), -1e4, 1e4)
    states = np.array(states)
    return [v.shown(data, t, states[: len(t), i]) for i, (v, (t, _, _)) in enumerate(zip(variants, runs))]


# Least squares and BIC.


def smooth(data, run):
    """Smoothed positions and speeds; accelerations of the speeds."""
    t, y, _ = run
    h = np.median(np.diff(t))
    even = np.arange(t[0], t[-1], h)
    grid = np.stack([np.interp(even, t, channel) for channel in y.T], axis=1)
    q = low_pass(grid, h)
    rate = savgol_filter(q, WINDOW, ORDER, deriv=1, delta=h, axis=0)
    N = data.mechanism.kinematics(data.p, q)
    v = np.einsum("kij,kj->ki", np.linalg.pinv(N), rate)
    acceleration = savgol_filter(v, WINDOW, ORDER, deriv=1, delta=h, axis=0)
    return even, q, v, acceleration


def low_pass(values, h):
    return sosfiltfilt(butter(4, PASS_HZ, fs=1 / h, output="sos"), values, axis=0)


def smoothed_input(u, t, even):
    """Held inputs through the same filter as the motion."""
    if not u.size:
        return np.zeros((len(even), 0))
    finer = 10
    h = (even[1] - even[0]) / finer
    fine = even[0] + h * np.arange(finer * len(even))
    held = u[np.clip(np.searchsorted(t, fine + h / 2, side="right") - 1, 0, len(t) - 1)]
    middles = low_pass(held, h)
    return (middles[::finer] + np.concatenate([middles[:1], middles[finer - 1 : -1 : finer]])) / 2


def allowed(names, sizes):
    """Friction, drag, play of time and limits have one sign."""
    return all(size > 0 or name.split("@")[0] not in ONE_SIDED for name, size in zip(names, sizes))


def compare(columns, target, nuisance, names, pairs=True):
    """BIC of every candidate beside the nuisance, and of pairs by forward selection."""
    n = len(target)
    ridge = np.eye(nuisance.shape[1])

    def rss(extra):
        """Also the coefficients of the extra columns. The nuisance has a standard deviation of one."""
        A = np.concatenate([nuisance] + [columns[name][:, None] for name in extra], axis=1)
        penalty = np.zeros((A.shape[1], A.shape[1]))
        penalty[: len(ridge), : len(ridge)] = ridge
        c = np.linalg.lstsq(A.T @ A + penalty, A.T @ target, rcond=None)[0]
        left = target - A @ c
        k = len(ridge)
        return float(left @ left + c[:k] @ c[:k]), c

    results = {(): rss(())}
    for name in names:
        results[(name,)] = rss((name,))
    singles = [key for key, (_, c) in results.items() if key and allowed(key, c[-1:])]
    best = min(singles, key=lambda key: results[key][0], default=())
    for name in names:
        if pairs and best and name not in best:
            results[tuple(sorted(best + (name,)))] = rss(tuple(sorted(best + (name,))))
    possible = {key: value for key, (value, c) in results.items() if allowed(key, c[len(c) - len(key) :])}
    bic = {key: n * np.log(value / n) + len(key) * np.log(n) for key, value in possible.items()}
    return bic, {key: c for key, (_, c) in results.items()}


def weighed(bic):
    """Probabilities of hypotheses."""
    lowest = min(bic.values())
    weights = {key: np.exp(-min((value - lowest) / 2, 700.0)) for key, value in bic.items()}
    total = sum(weights.values())
    return {key: weight / total for key, weight in weights.items()}


def report(data, probabilities, far, began):
    ranked = sorted(probabilities.items(), key=lambda entry: -entry[1])
    ranked = [(key, p / sum(p for _, p in ranked[:10])) for key, p in ranked[:10]]
    best, top = ranked[0]
    tied = [key for key, p in ranked if len(key) == len(best) and top < TIED * p]
    verdict = "no_gap" if not best else "ambiguous" if len(tied) > 1 else "explained"
    kind = best[0].split("@")[0] if best else None
    head = kind.split("_")[0] if kind else "none"
    family = {None: "none"}.get(kind) or (head if head in ("actuator", "sensor") else catalogue.family(kind))
    where = {"domain": family, "equations": []}
    if best:
        site = best[0].split("@")[1]
        names = catalogue.equations(data.mechanism, kind, site) or []
        where["equations"] = [{"name": name, "share": 1 / len(names)} for name in names]
    return {
        "verdict": verdict,
        "where": where,
        "which": [{"effects": list(key), "probability": float(p), "parameters": []} for key, p in ranked],
        "tied": [["+".join(key) for key in tied]] if len(tied) > 1 else [],
        "how_far": far,
        "seconds": time.monotonic() - began,
    }


def how_far(data, plain, fitted):
    """Errors one second ahead on the runs to test, from smoothed states; the floor is the sensor's noise."""
    squares = {"nominal": [], "with_effect": []}
    for run in data.test:
        even, q, v, _ = smooth(data, run)
        h = even[1] - even[0]
        ahead = int(round(HORIZON_S / h))
        starts = np.arange(EDGE, len(even) - ahead - 1, 10)
        y = np.stack([np.interp(even, run[0], channel) for channel in run[1].T], axis=1)
        u = run[2][np.clip(np.searchsorted(run[0], even, side="right") - 1, 0, len(run[0]) - 1)]
        for name, variant in (("nominal", plain), ("with_effect", fitted)):
            given, step = variant.given(data, even, u), stepper(data, [variant])
            x = np.concatenate([q, v], axis=1)[starts]
            off = variant.shown(data, even, np.concatenate([q, v], axis=1)) - q
            x[:, : q.shape[1]] -= off[starts]
            for j in range(ahead):
                x = step(x, given[starts + j], h)
            e = y[starts + ahead] - x[:, : q.shape[1]] - off[starts + ahead]
            squares[name].append((e / data.noise) ** 2)
    e0, e = (float(np.sqrt(np.mean(np.concatenate(squares[name])))) for name in ("nominal", "with_effect"))
    closed = 1 - (e**2 - 1) / (e0**2 - 1) if e0 != 1 else 0.0
    return {"horizon_s": HORIZON_S, "nominal": e0, "with_effect": e, "noise_floor": 1.0, "closed": closed}


def fitted_variant(data, best, coefficients):
    """The winner of a linear comparison as a model."""
    p = {name: value for name, value in data.p.items()}
    for name, c in zip(data.std, coefficients):
        p[name] += float(np.clip(c, -4, 4)) * data.std[name]
    sizes = dict(zip(best, coefficients[len(coefficients) - len(best) :]))
    return Variant(data, p, sizes)


# Finite differences.


def finite_differences(data):
    began, m, delta = time.monotonic(), data.mechanism, 0.2
    names = [n for n in candidates(data) if not n.startswith(("sensor_scale", "sensor_delay"))]

    def residual(run, variant):
        """Accelerations beyond the model's. Forces would shrink with the masses and gains to be found."""
        t, y, u = run
        bias = np.zeros(y.shape[1])
        for sensor in variant.sensors:
            bias[m.coordinates.index(sensor.site)] = sensor.size
        run = (t, y - bias, u)
        even, q, v, a = smooth(data, run)
        given = smoothed_input(variant.given(data, t, u), t, even)
        f = times(m.input_map(variant.p, q), given) if m.inputs else 0 * v
        for force in variant.forces:
            f = f + force.force(m, variant.p, q, v, 0.0)
        return (a - m.acceleration(variant.p, q, v, f))[EDGE:-EDGE]

    def over_runs(variant):
        return np.concatenate([residual(run, variant) for run in data.fit])

    base = over_runs(Variant(data, data.p, {}))
    tangents = []
    for name, std in data.std.items():
        tangents.append(over_runs(Variant(data, {**data.p, name: data.p[name] + 0.1 * std}, {})) - base)
    nuisance = -np.stack(tangents, axis=-1) / 0.1
    columns = {name: -(over_runs(Variant(data, data.p, {name: delta})) - base) / delta for name in names}
    flat = lambda values, scale: (values / scale).reshape(-1, *values.shape[2:])
    scale = np.std(base, axis=0)
    for _ in range(2):  # the second time with what the nuisance leaves
        N, target = flat(nuisance, scale[:, None]), flat(base, scale)
        c = np.linalg.solve(N.T @ N + np.eye(N.shape[1]), N.T @ target)
        scale = scale * np.std((target - N @ c).reshape(base.shape), axis=0)
    N, target = flat(nuisance, scale[:, None]), flat(base, scale)
    bic, coefficients = compare({k: flat(c, scale) for k, c in columns.items()}, target, N, names)
    best = min(bic, key=bic.get)
    far = how_far(data, Variant(data, data.p, {}), fitted_variant(data, best, coefficients[best]))
    return report(data, weighed(bic), far, began)


# Output error.


class OutputError:
    """Whole runs from a fitted start. Unknowns: parameters in standard deviations, starts, sizes."""

    def __init__(self, data):
        self.data, self.names = data, list(data.std)
        self.starts = []
        for run in data.fit:
            _, q, v, _ = smooth(data, run)
            self.starts.append(np.concatenate([q[0], v[0]]))
        self.shift = np.zeros(len(self.names))

    def parameters(self, shift):
        p = dict(self.data.p)
        for name, s in zip(self.names, shift):
            p[name] = p[name] + s * self.data.std[name]
        return p

    def linear(self, shift, starts, sizes, wanted):
        """Residuals, and their derivatives in shifts, starts and the wanted sizes."""
        data, d = self.data, 1e-3
        make = lambda shift, sizes: Variant(data, self.parameters(shift), sizes)
        eye = np.eye(len(shift))
        steps = {name: 0.2 if not sizes.get(name) else 0.02 * max(abs(sizes[name]), 0.1) for name in wanted}
        variants = [make(shift, sizes)] + [make(shift + d * row, sizes) for row in eye]
        variants += [make(shift, {**sizes, name: sizes.get(name, 0.0) + steps[name]}) for name in wanted]
        size, each = len(starts[0]), len(variants) + len(starts[0])
        scale = np.concatenate([data.noise, np.full(size - len(data.noise), 0.01)])
        rows, begin, runs = [], [], []
        for start, run in zip(starts, data.fit):
            rows += variants + variants[:1] * size
            begin += [start] * len(variants) + [start + d * scale[j] * np.eye(size)[j] for j in range(size)]
            runs += [run] * each
        shown = simulated(data, rows, begin, runs)
        residuals, derivatives = [], []
        for i, run in enumerate(data.fit):
            own = np.stack([(y / data.noise).ravel() for y in shown[i * each : (i + 1) * each]], axis=1)
            own = np.nan_to_num(own, nan=1e4)
            change = own[:, 1:] - own[:, :1]
            k, w = len(shift), len(wanted)
            J = np.zeros((len(own), k + w + size * len(starts)))
            J[:, :k] = change[:, :k] / d
            J[:, k : k + w] = change[:, k : k + w] / np.array([steps[name] for name in wanted])
            J[:, k + w + i * size : k + w + (i + 1) * size] = change[:, k + w :] / d
            residuals.append((run[1] / data.noise).ravel() - own[:, 0])
            derivatives.append(J)
        return np.concatenate(residuals), np.concatenate(derivatives), scale

    def step(self, r, J, k):
        """Gauss-Newton with the tolerances of the parameters; shifts stay within four of them."""
        A = J.T @ J
        A[range(k), range(k)] += 1
        A[range(len(A)), range(len(A))] *= 1 + 1e-9
        g = J.T @ r
        return np.linalg.lstsq(A, g, rcond=None)[0]

    def fit(self, sizes, steps):
        """Fits shifts, starts and the sizes that are given; the sum of squares and all of them."""
        shift, starts, sizes = self.shift.copy(), [s.copy() for s in self.starts], dict(sizes)
        best = (np.inf, shift, starts, sizes)
        for _ in range(steps + 1):
            r, J, scale = self.linear(shift, starts, sizes, list(sizes))
            cost = float(r @ r + shift @ shift)
            if cost < best[0]:
                best = (cost, shift, starts, dict(sizes))
            elif not cost < 4 * best[0]:
                break
            k, w = len(shift), len(sizes)
            c = self.step(r + J[:, :k] @ shift, J, k)  # the prior is about no shift
            shift = np.clip(c[:k], -4, 4)
            sizes = {name: size + c[k + i] for i, (name, size) in enumerate(sizes.items())}
            starts = [
                s + c[k + w + i * len(s) : k + w + (i + 1) * len(s)] * scale for i, s in enumerate(starts)
            ]
        return best


def output_error(data):
    """(report with effects, report of the model with parameters fitted again)"""
    began = time.monotonic()
    fits = OutputError(data)
    _, fits.shift, fits.starts, _ = fits.fit({}, STEPS)
    plain = Variant(data, data.p, {})
    again = Variant(data, fits.parameters(fits.shift), {})
    refitted = report(data, {(): 1.0}, how_far(data, plain, again), began)
    names = candidates(data)
    r, J, _ = fits.linear(fits.shift, fits.starts, {}, names)
    k = len(fits.shift)
    nuisance = np.hstack([J[:, :k], J[:, k + len(names) :]])
    columns = {name: J[:, k + i] for i, name in enumerate(names)}
    bic, coefficients = compare(columns, r, nuisance, names, pairs=False)
    best = min(bic, key=bic.get)
    c = coefficients[best]
    model = Variant(
        data, fits.parameters(np.clip(fits.shift + c[:k], -4, 4)), dict(zip(best, c[len(c) - len(best) :]))
    )
    return report(data, weighed(bic), how_far(data, plain, model), began), refitted


def pack(reports):
    """The reports alone, without the seconds, which differ from run to run."""
    with tempfile.TemporaryDirectory() as place:
        for method in ("finite_differences", "output_error", "refitted"):
            for path in sorted((reports / method).glob("*.json")):
                made = json.loads(path.read_text())
                made.pop("seconds", None)
                target = Path(place) / method / path.name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(json.dumps(made))
        archive(Path(place), "*/*.json", "baselines")


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("--reports", type=Path, required=True)
    ask.add_argument("--cases", type=Path, help="a folder of cases instead of the archive")
    ask.add_argument("--only", nargs="*")
    ask.add_argument("--pack", action="store_true", help="put the reports beside this file, for the scorer")
    ask = ask.parse_args()
    np.seterr(all="ignore")
    with tempfile.TemporaryDirectory() as place:
        for folder in sorted((ask.cases or unpack(place)).iterdir()):
            if ask.only and folder.name not in ask.only:
                continue
            data, reports = Recording(folder), {}
            for name, method in (("finite_differences", finite_differences), ("output_error", output_error)):
                try:
                    made = method(data)
                except (ArithmeticError, np.linalg.LinAlgError, ValueError) as trouble:
                    made = {"trouble": str(trouble)}
                if name == "output_error" and isinstance(made, tuple):
                    made, reports["refitted"] = made
                reports[name] = made
            for name, made in reports.items():
                path = ask.reports / name / f"{folder.name}.json"
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(json.dumps(made))
            said = {
                name: (
                    ("+".join(made["which"][0]["effects"]) or "nothing")
                    if "which" in made
                    else made["trouble"]
                )
                for name, made in reports.items()
            }
            print(folder.name, data.mechanism.name, said, flush=True)
    if ask.pack:
        pack(ask.reports)


if __name__ == "__main__":
    main()
