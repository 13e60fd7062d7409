"""How the rigs are driven: multisines and steps in the open loop, feedback where a rig falls over.
A drive sees what its own sensors show at a sample and gives the command that is held."""

import numpy as np
from scipy.linalg import expm, solve_continuous_are, solve_discrete_are

from oracle import NUDGE


def multisine(rng, slowest, fastest, waves=5):
    """A sum of sines with an amplitude of about one."""
    f = np.exp(rng.uniform(np.log(slowest), np.log(fastest), waves))
    phase = rng.uniform(0, 2 * np.pi, waves)
    return lambda t: np.sum(np.sin(2 * np.pi * f * t + phase)) / np.sqrt(waves)


def plateaus(rng, duration, low, high, rise=0.8):
    """Levels that follow one another with smooth ramps."""
    starts = np.arange(0.0, duration, rng.uniform(2.0, 3.0))
    levels = rng.uniform(low, high, len(starts) + 1)

    def at(t):
        value = levels[0]
        for start, level, before in zip(starts[1:], levels[2:], levels[1:]):
            s = np.clip((t - start) / rise, 0, 1)
            value += (level - before) * s * s * (3 - 2 * s)
        return value

    return at


def regulator(A, B, states, effort):
    P = solve_continuous_are(A, B, np.diag(states), np.diag(effort))
    return np.linalg.solve(np.diag(effort), B.T @ P)


def sampled_regulator(A, B, states, effort, step):
    """The same for a command that is held over a step; a body that is light and fast needs it."""
    n, m = B.shape
    both = expm(np.block([[A, B], [np.zeros((m, n + m))]]) * step)
    F, G = both[:n, :n], both[:n, n:]
    P = solve_discrete_are(F, G, np.diag(states), np.diag(effort))
    return np.linalg.solve(np.diag(effort) + G.T @ P @ G, G.T @ P @ F)


def linearised(mechanism, p, kept, still=None):
    """A and B about standing still, of some of the states."""
    n = len(mechanism.coordinates)

    def rates(x, u):
        q, v = x[:n], x[n:]
        f = mechanism.input_map(p, q) @ u
        return np.concatenate([mechanism.kinematics(p, q) @ v, mechanism.acceleration(p, q, v, f)])[kept]

    size, inputs = n + len(mechanism.speeds), len(mechanism.inputs)
    still, idle = np.zeros(size) if still is None else still, np.zeros(inputs)
    A = np.stack(
        [
            (rates(still + NUDGE * e, idle) - rates(still - NUDGE * e, idle)) / (2 * NUDGE)
            for e in np.eye(size)[kept]
        ],
        axis=1,
    )
    B = np.stack(
        [(rates(still, NUDGE * e) - rates(still, -NUDGE * e)) / (2 * NUDGE) for e in np.eye(inputs)], axis=1
    )
    return A, B


def carriage(p, rng, duration, run):
    wave, force = multisine(rng, 0.15, 2.5), 1.5 * p["m"]
    return np.zeros(2), lambda k, t, x: force * wave(t) - p["m"] * (2.0 * x[0] + 0.4 * x[1])


def pendulum(p, rng, duration, run):
    weight = p["m"] * p["g"] * p["l"]
    if run == 1 and rng.random() < 0.5:
        return np.array([rng.uniform(0.8, 1.4), 0.0]), lambda k, t, x: 0.0  # swings out
    wave = multisine(rng, 0.15, 2.5)
    return np.array([rng.normal(0, 0.2), 0.0]), lambda k, t, x: 0.45 * weight * wave(t)


def cart_pole(p, rng, duration, run):
    mass = p["m_cart"] + p["m_pole"]
    wave = multisine(rng, 0.2, 2.5)
    start = np.array([0.0, rng.normal(0, 0.3), 0.0, 0.0])
    return start, lambda k, t, x: mass * (2.0 * wave(t) - 3.0 * x[0] - 0.8 * x[2])


def double_pendulum(p, rng, duration, run):
    upper = p["g"] * (p["m1"] * p["r1"] + p["m2"] * p["l1"])
    lower = p["g"] * p["m2"] * p["r2"]
    first, second = multisine(rng, 0.15, 2.0), multisine(rng, 0.2, 2.0)
    start = np.concatenate([rng.normal(0, 0.2, 2), np.zeros(2)])
    return start, lambda k, t, x: np.array(
        [0.4 * upper * first(t), 0.35 * lower * second(t) - 0.05 * lower * x[3]]
    )


def euc_2dof(p, rng, duration, run):
    from mechanisms import euc_2dof as mechanism

    A, B = linearised(mechanism, p, [1, 2, 3])
    K = regulator(A, B, [200.0, 20.0, 20.0], [2e-3])
    speed, wave = plateaus(rng, duration, 1.2, 3.2), multisine(rng, 0.3, 2.0)
    start = np.array([0.0, 0.0, speed(0.0), 0.0])
    return start, lambda k, t, x: -K @ np.array([x[1], x[2] - speed(t), x[3]]) + 4.0 * wave(t)


def euc_3dof(p, rng, duration, run):
    from mechanisms import euc_3dof as mechanism

    A, B = linearised(mechanism, p, [1, 2, 3, 4, 5])
    K = sampled_regulator(A, B, [300.0, 200.0, 20.0, 20.0, 20.0], [2e-2, 4e-2], 0.0125)
    speed = plateaus(rng, duration, 1.2, 3.0)
    first, second = multisine(rng, 0.3, 2.5), multisine(rng, 0.3, 2.5)
    start = np.array([0.0, 0.0, 0.0, speed(0.0), 0.0, 0.0])

    def law(k, t, x):
        off = np.array([x[1], x[2], x[3] - speed(t), x[4], x[5]])
        return -K @ off + np.array([3.0 * first(t), 3.0 * second(t)])

    return start, law


def rolling_wheel(p, rng, duration, run):
    """It rolls freely, fast enough not to fall over."""
    spin = rng.uniform(2.2, 3.2) / p["R"]
    return (
        np.array(
            [
                0,
                0,
                rng.normal(0, 0.3),
                rng.uniform(0.03, 0.15),
                0,
                rng.normal(0, 0.1),
                spin,
                rng.normal(0, 0.1),
            ]
        ),
        None,
    )


def unicycle(p, rng, duration, run):
    """Keeps the lane by the linear model of straight rolling."""
    m, m0, R, g = p["m"], p["m0"], p["R"], p["g"]
    speed = rng.uniform(1.6, 2.6)
    F = speed / R
    A = np.zeros((6, 6))  # states ω1, θ, σ, r, ψ, y_G
    A[0, 1], A[0, 3] = 4 * g / (5 * R) - 12 / 5 * F**2, -4 * m0 * g / (5 * m * R**2)
    A[1, 0] = A[3, 2] = 1.0
    A[2, 1], A[2, 3] = -(g / 5 + 2 * R / 5 * F**2), -4 * m0 * g / (5 * m * R)
    A[4, 1], A[5, 0], A[5, 4] = -2 * F, -R, R * F
    B = np.array([[4 / (5 * m * R)], [0], [(5 * m + 4 * m0) / (5 * m * m0)], [0], [0], [0]])
    K = regulator(A, B, [1.0, 20.0, 1.0, 40.0, 4.0, 4.0], [0.02])
    lane, wave = plateaus(rng, duration, -0.5, 0.5, rise=2.0), multisine(rng, 0.3, 2.5)
    start = np.zeros(10)
    start[7] = F

    def law(k, t, x):
        return -K @ np.array([x[6], x[3], x[9], x[5], x[2], x[1] - lane(t)]) + 1.5 * wave(t)

    return start, law


def for_run(mechanism, p, rng, duration, noise, run):
    """Start and drive of a run. The drive's own sensors are not those that are recorded."""
    start, law = globals()[mechanism.name](p, rng, duration, run)
    own = np.random.default_rng(rng.integers(2**32))
    sd = np.concatenate([0.3 * np.asarray(noise), np.full(len(mechanism.speeds), 0.003)])

    def drive(k, t, x):
        command = np.atleast_1d(law(k, t, x + own.normal(0, sd)))
        return np.array([float(f"{c:.4g}") for c in command])  # as it is logged

    return start, drive
