"""What a reader of the recordings who knows the true law could do at best.

Along a true motion the declared model errs by a defect in each sample. A Kalman filter that knows the
true disturbance and noise turns defects into innovations; what the parameters within their tolerances
cannot imitate of these is d', the size of the gap in standard deviations."""

import numpy as np

from effects import Actuator, Memory, Parameter, Richer, Sensor
from mechanisms import times

SUBSTEPS = 4
NUDGE = 1e-6  # relative step of differences
START = 1e3  # standard deviation of the initial state, in noise


def flow(mechanism, p, x, inputs, disturbance, dt, t=0.0, effects=()):
    """States one sample later, by four Runge-Kutta steps; many states at once.
    inputs: one value per substep, [..., substep, input]."""
    h = (np.asarray(dt) / SUBSTEPS)[..., None]

    def rates(x, u):
        q, v = mechanism.split(x)
        f = disturbance + times(mechanism.input_map(p, q), u)
        for effect in effects:
            f = f + effect.force(mechanism, p, q, v, t)
        return np.concatenate(
            [times(mechanism.kinematics(p, q), v), mechanism.acceleration(p, q, v, f)], axis=-1
        )

    for j in range(SUBSTEPS):
        u = inputs[..., j, :]
        k1 = rates(x, u)
        k2 = rates(x + h / 2 * k1, u)
        k3 = rates(x + h / 2 * k2, u)
        k4 = rates(x + h * k3, u)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        for effect in effects:
            x = effect.after(mechanism, p, x, h)
    return x


def held(commands):
    return np.repeat(commands[:, None, :], SUBSTEPS, axis=1)


def given(mechanism, actuators, t, commands):
    """What actuators give in the middle of each substep."""
    inputs = held(commands).copy()
    for actuator in actuators:
        i = mechanism.inputs.index(actuator.site)
        if not actuator.remembers:
            inputs[:, :, i] = actuator.static(inputs[:, :, i])
            continue
        actuator.reset()
        for k in range(len(t) - 1):
            actuator.hold(t[k], commands[k, i])
            step = (t[k + 1] - t[k]) / SUBSTEPS
            for j in range(SUBSTEPS):
                middle = t[k] + (j + 0.5) * step
                actuator.enter(middle)
                inputs[k, j, i] = actuator.value(middle)
    return inputs


def slopes(step, x, scale):
    """Derivatives of a function of states by central differences, [..., out, in]."""
    columns = []
    for i in range(x.shape[-1]):
        d = np.zeros(x.shape[-1])
        d[i] = NUDGE * scale[i]
        columns.append((step(x + d) - step(x - d)) / (2 * d[i]))
    return np.stack(columns, axis=-1)


class Filter:
    """The Kalman filter about a true motion, with the true levels."""

    def __init__(self, rig, trial, noise, disturbance_sd):
        mechanism, p = rig.mechanism, rig.unchanged
        x, dt = trial.states[:-1], np.diff(trial.t)
        self.n, u, w = len(noise), held(trial.commands)[:-1], trial.disturbance[: len(dt)]
        scale = np.maximum(np.std(trial.states, axis=0), 1e-3)
        self.A = slopes(lambda x: flow(mechanism, p, x, u, w, dt), x, scale)
        one = np.ones(len(disturbance_sd))
        self.G = slopes(lambda w: flow(mechanism, p, x, u, w, dt), w + 0 * one, one)
        self.Q = self.G @ np.diag(np.square(disturbance_sd)) @ np.swapaxes(self.G, -1, -2)
        self.R = np.diag(np.square(noise))
        self.gains()

    def gains(self):
        """Predicted and filtered covariances, gains, and roots that whiten the innovations."""
        n, size = self.n, self.A.shape[-1]
        start = np.full(size, 10.0)
        start[:n] = START * np.sqrt(np.diag(self.R))
        P = np.diag(start**2)
        self.K, self.white, self.filtered = [], [], []
        for k in range(len(self.A) + 1):
            S = P[:n, :n] + self.R
            K = np.linalg.solve(S, P[:n]).T
            self.K.append(K)
            self.white.append(np.linalg.inv(np.linalg.cholesky(S)))
            F = np.eye(size)
            F[:, :n] -= K
            P = F @ P @ F.T + K @ self.R @ K.T
            self.filtered.append(P)
            if k < len(self.A):
                P = self.A[k] @ P @ self.A[k].T + self.Q[k]
        self.K, self.white, self.filtered = map(np.array, (self.K, self.white, self.filtered))

    def innovations(self, defects, shown):
        """Whitened innovations of defects of the motion [sample, state, case] and of what is shown."""
        off = np.zeros(defects.shape[1:])
        out = []
        for k in range(len(self.A) + 1):
            e = off[: self.n] + shown[k]
            out.append(self.white[k] @ e)
            off = off - self.K[k] @ e
            if k < len(self.A):
                off = self.A[k] @ off + defects[k]
        return np.array(out).reshape(-1, defects.shape[-1])


class Motion:
    """A true motion, and by how much a model errs along it in each sample: in the state that it makes of
    the true one before, and in what the sensors show."""

    def __init__(self, rig, trial, disturbed=True):
        self.mechanism, self.p, self.trial = rig.mechanism, rig.unchanged, trial
        self.x, self.dt = trial.states[:-1], np.diff(trial.t)
        self.u, self.w = held(trial.commands)[:-1], trial.disturbance[: len(self.dt)] * disturbed
        self.declared = self.next()

    def next(self, mechanism=None, p=None, inputs=None, effects=()):
        """States one sample after the true ones, by the declared model or one that differs."""
        inputs = self.u if inputs is None else inputs
        return flow(
            mechanism or self.mechanism, p or self.p, self.x, inputs, self.w, self.dt, 0.0, effects=effects
        )

    def off(self, sensors=()):
        """What sensors show besides the positions."""
        n = len(self.mechanism.coordinates)
        q, v = self.mechanism.split(self.trial.states)
        rates, shown = times(self.mechanism.kinematics(self.p, q), v), np.zeros((len(q), n))
        for sensor in sensors:
            i = self.mechanism.coordinates.index(sensor.site)
            shown[:, i] = sensor.shown(self.trial.t, q[:, i], rates[:, i]) - q[:, i]
        return shown

    def gap(self, rig):
        """What the declared model lacks."""
        return self.trial.states[1:] - self.declared, self.off(rig.of(Sensor))

    def imitations(self, tolerances):
        """What a standard deviation of each uncertain parameter does."""
        defects = []
        for name, std in tolerances.items():
            up, down = dict(self.p), dict(self.p)
            up[name], down[name] = self.p[name] + 0.1 * std, self.p[name] - 0.1 * std
            defects.append((self.next(p=up) - self.next(p=down)) / 0.2)
        return [(defect, self.off()) for defect in defects]


def whitened(filter, errors):
    """Whitened innovations, a column for each (defects of the motion, what is shown)."""
    defects, shown = (np.stack(parts, axis=-1) for parts in zip(*errors))
    return filter.innovations(defects, shown)


def signatures(rig, trial, tolerances, noise, disturbance_sd):
    """Whitened innovations: the gap of the true motion, and one per uncertain parameter."""
    motion = Motion(rig, trial)
    filter = Filter(rig, trial, noise, disturbance_sd)
    return whitened(filter, [motion.gap(rig)] + motion.imitations(tolerances))


def dprime(parts):
    """Size of the gap beyond what parameters within tolerance can imitate, over several trials."""
    all = np.concatenate(parts)
    s, N = all[:, 0], all[:, 1:]
    a = N.T @ s
    absorbed = a @ np.linalg.solve(N.T @ N + np.eye(N.shape[1]), a)
    return float(np.sqrt(max(s @ s - absorbed, 0.0)))


# Predictions one second ahead.


def knows_law(rig):
    """Whether the true law can be put into a filter of the declared states."""
    return not (rig.of(Memory) or rig.of(Richer))


def track(rig, p, trial, measured, filter, inputs, effects, shown):
    """Filtered states with a model: parameters p, inputs, effects, and what the sensors add."""
    n, x = filter.n, np.array(trial.states[0])
    x[:n] = np.where(np.isnan(measured[0]), x[:n], measured[0])
    out = []
    dt = np.diff(trial.t)
    still = np.zeros(trial.disturbance.shape[1])
    for k in range(len(trial.t)):
        e = np.nan_to_num(measured[k] - x[:n] - shown[k])
        x = x + filter.K[k] @ e
        out.append(x)
        if k < len(dt):
            x = flow(rig.mechanism, p, x, inputs[k], still, dt[k], trial.t[k], effects)
    return np.array(out)


def ahead(rig, p, trial, states, inputs, effects, horizon, starts):
    x, dt = states[starts], np.diff(trial.t)
    still = np.zeros(trial.disturbance.shape[1])
    for j in range(horizon):
        k = starts + j
        x = flow(rig.mechanism, p, x, inputs[k], still, dt[k], 0.0, effects)
    return x


def floor_ahead(filter, horizon, starts):
    """Covariance of what the best filter predicts."""
    P = filter.filtered[starts]
    for j in range(horizon):
        A = filter.A[starts + j]
        P = A @ P @ np.swapaxes(A, -1, -2) + filter.Q[starts + j]
    return P[:, : filter.n, : filter.n] + filter.R


def how_far(rig, declared, trials, recorded, noise, disturbance_sd, law):
    """Root-mean-square errors one second ahead in noise: declared model, true law if wanted, floor."""
    squares = {"nominal": [], "with_effect": [], "floor": []}
    for trial, measured in zip(trials, recorded):
        filter = Filter(rig, trial, noise, disturbance_sd)
        horizon = int(round(1.0 / np.median(np.diff(trial.t))))
        starts = np.arange(50, len(trial.t) - horizon - 1, 7)
        target = measured[starts + horizon]
        plain = np.zeros_like(measured)
        models = {"nominal": (dict(declared), held(trial.commands), [], plain)}
        if law and knows_law(rig):
            shown = plain.copy()
            n = len(noise)
            for sensor in rig.of(Sensor):
                i = rig.mechanism.coordinates.index(sensor.site)
                rates = times(
                    rig.mechanism.kinematics(rig.parameters, trial.states[:, :n]), trial.states[:, n:]
                )
                shown[:, i] = sensor.shown(trial.t, trial.states[:, i], rates[:, i]) - trial.states[:, i]
            effects = [e for e in rig.effects if not isinstance(e, (Actuator, Sensor, Parameter))]
            models["with_effect"] = (
                rig.parameters,
                given(rig.mechanism, rig.of(Actuator), trial.t, trial.commands),
                effects,
                shown,
            )
        for name, (p, inputs, effects, shown) in models.items():
            states = track(rig, p, trial, measured, filter, inputs, effects, shown)
            predicted = ahead(rig, p, trial, states, inputs, effects, horizon, starts)[:, : len(noise)]
            squares[name].append(((target - predicted - shown[starts + horizon]) / noise) ** 2)
        covariance = floor_ahead(filter, horizon, starts)
        squares["floor"].append(np.diagonal(covariance, axis1=-2, axis2=-1) / np.square(noise))
    rms = {name: float(np.sqrt(np.nanmean(np.concatenate(s)))) if s else None for name, s in squares.items()}
    e0, e, n = rms["nominal"], rms["with_effect"], rms["floor"]
    closed = None if e is None else 1 - (e**2 - n**2) / (e0**2 - n**2)
    usable = closed is not None and e0**2 > 2 * n**2 and 0.6 <= closed <= 1.3
    return {
        "horizon_s": 1.0,
        "nominal": e0,
        "with_effect": e,
        "noise_floor": n,
        "closed": closed,
        "usable": usable,
    }
