#!/usr/bin/env python3
"""Lane changes of the steered unicycle in heyoka: one motion, and ensembles in batches.

    python3 with_heyoka.py RUNS

Prints JSON: seconds per motion on one core and the largest error of a final state, for each tolerance.
"""

import json
import sys
import time

import heyoka as hy
import numpy as np

K = [75.50716338484554, 777.2810626041376, 99.51698725252805, 405.60117235604173, 676.4036697247706,
     180.3743119266055]
w1, w2, w3, theta, sigma, r, psi, phi, x_g, y_g = STATES = hy.make_vars(
    "w1", "w2", "w3", "theta", "sigma", "r", "psi", "phi", "x_g", "y_g")
NOMINAL = np.array([10.0, 5.0, 0.3, 9.81])
SPANS = ((0.0, 2.0), (2.0, 7.0), (7.0, 10.0))


def rates(u):
    """Equations (33) to (35) of the paper, solved for the rates."""
    m, m0, R, g = (hy.par[i] for i in range(4))
    s, c = hy.sin(theta), hy.cos(theta)
    t = s / c
    d1 = 5.0 * m * R * R + 4.0 * m0 * r * r
    d2 = 3.0 * m * R * R + 2.0 * m0 * R * R + 12.0 * m0 * r * r
    tilt = (4.0 * m0 * R * r * w1 * w1 - (m * R * R + 4.0 * m0 * r * r) * t * w3 * w3 - 8.0 * m0 * r * w1 * sigma
            + 2.0 * R * (3.0 * m * R + 2.0 * m0 * r * t) * w2 * w3 - 4.0 * m0 * g * r * c + 4.0 * m * g * R * s
            + 4.0 * R * u) / d1
    return [
        tilt,
        2.0 * (-2.0 * m0 * R * r * w1 * w2 - (m * R * R + m0 * R * R + 4.0 * m0 * r * r) * w1 * w3
               + 2.0 * m0 * R * w3 * sigma) / d2,
        (-2.0 * (3.0 * m + 2.0 * m0) * R * R * w1 * w2
         + (3.0 * m * R * R * t + 2.0 * m0 * (R * R * t + 2.0 * R * r + 6.0 * r * r * t)) * w1 * w3
         - 24.0 * m0 * r * w3 * sigma) / d2,
        w1,
        R * tilt + r * w1 * w1 - R * w2 * w3 + r * w3 * w3 - g * s + u / m0,
        sigma,
        w3 / c,
        w2 - w3 * t,
        w1 * R * hy.sin(psi) * c + w2 * R * hy.cos(psi),
        -1.0 * w1 * R * hy.cos(psi) * c + w2 * R * hy.sin(psi),
    ]


def system(wanted):
    u = -1.0 * (K[0] * w1 + K[1] * theta + K[2] * sigma + K[3] * r + K[4] * psi + K[5] * (y_g - wanted))
    return list(zip(STATES, rates(u)))


def paths():
    return [0.0 * hy.time, 5.0 * (hy.cos(np.pi / 5.0 * (hy.time - 2.0)) - 1.0), -10.0 + 0.0 * hy.time]


def start(parameters):
    x = np.zeros((10,) + parameters.shape[1:])
    x[1] = 5.0 / parameters[2]
    return x


def moved(integrators, parameters):
    x = start(parameters)
    for integrator, (begin, end) in zip(integrators, SPANS):
        integrator.pars[:4] = parameters
        if parameters.ndim == 2:
            integrator.set_time(begin)
        else:
            integrator.time = begin
        integrator.state[:] = x
        integrator.propagate_until(end)
        x = integrator.state.copy()
    return x


def scattered(count, seed=3):
    p = np.tile(NOMINAL[:, None], (1, count))
    p[:3] *= np.random.default_rng(seed).uniform(0.95, 1.05, (3, count))
    return p


def main(runs):
    lanes = hy.recommended_simd_size()
    many = scattered(lanes * max(1, runs // lanes))
    exact = [hy.taylor_adaptive(system(path), np.zeros(10), tol=1e-16, pars=list(NOMINAL)) for path in paths()]
    sample = [moved(exact, many[:, i]) for i in range(64)]
    told = {"heyoka": hy.__version__, "lanes": lanes, "one": [], "batch": []}
    for tol in (1e-9, 1e-12):
        alone = [hy.taylor_adaptive(system(path), np.zeros(10), tol=tol, pars=list(NOMINAL)) for path in paths()]
        times = []
        for _ in range(40):
            begin = time.perf_counter()
            moved(alone, NOMINAL)
            times.append(time.perf_counter() - begin)
        error = max(abs(moved(alone, many[:, i]) - sample[i]).max() for i in range(64))
        told["one"].append({"tolerance": tol, "seconds": min(times), "error": error})
        zeros = np.zeros((10, lanes))
        batch = [hy.taylor_adaptive_batch(system(path), zeros, tol=tol, pars=np.tile(NOMINAL[:, None], (1, lanes)))
                 for path in paths()]
        error, best = 0.0, np.inf
        for _ in range(3):
            begin = time.perf_counter()
            ends = [moved(batch, many[:, i:i + lanes]) for i in range(0, many.shape[1], lanes)]
            best = min(best, (time.perf_counter() - begin) / many.shape[1])
        ends = np.concatenate(ends, axis=1)
        error = max(abs(ends[:, i] - sample[i]).max() for i in range(64))
        told["batch"].append({"tolerance": tol, "seconds": best, "error": error})
    print(json.dumps(told))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1600)
