"""Slip of a contact that follows the force on it, to first order in the creep: the declared motion with a
sliding velocity besides, which has its inertia but no state of its own."""

from dataclasses import dataclass

import numpy as np

from mechanisms import times
from truths import slipping_unicycle

NUDGE = 1e-4


@dataclass
class Contact:
    """What sliding does at each of many states."""

    coupling: np.ndarray  # inertia that sliding shares with the speeds
    bias: np.ndarray  # force along the sliding at rest against the ground
    stirred: np.ndarray  # change of the forces along the speeds with the sliding velocity
    drift: np.ndarray  # rates of the coordinates per sliding velocity
    flexible: np.ndarray  # velocity of travel over load: sliding per force and creep


def sideways(mechanism, p, q, v):
    """A wheel in space, from the unicycle with a fifth speed; without a slider that one has no mass."""
    p = {"m0": 0.0, **p}
    wheel = slipping_unicycle(1.0).mechanism
    own = list(range(len(mechanism.speeds)))
    parts = []
    for positions, speeds in zip(q, v):
        positions = np.append(positions, np.zeros(6 - len(positions)))
        bias = lambda s: wheel.bias(p, positions, np.concatenate([speeds, np.zeros(4 - len(speeds)), [s]]))
        stirred = (bias(NUDGE) - bias(-NUDGE)) / (2 * NUDGE)
        drift = wheel.kinematics(p, positions)[: len(mechanism.coordinates), 4]
        parts.append((wheel.mass(p, positions)[4, own], bias(0.0)[4], stirred[own], drift))
    travel = np.maximum(np.abs(p["R"] * v[:, 1]), 0.3)
    return Contact(*map(np.array, zip(*parts)), -travel / ((p["m"] + p["m0"]) * p["g"]))


def along(mechanism, p, q, v):
    """A wheel in a plane whose turns are counted: sliding leaves the axle behind its rim."""
    rest = -mechanism.mass(p, q)[:, :, 0]
    rest[:, 0] += p["J_w"] / p["R"] ** 2
    travel = np.maximum(np.abs(v[:, 0]), 0.3)
    load = (p["m"] + p["m_0"] + p["m_w"]) * p["g"]
    return Contact(rest, -mechanism.bias(p, q, v)[:, 0], 0 * v, 0 * q, -travel / load)


def defects(motion, creep, contact_of):
    """What slip does to the state in each sample. Forces jump with the commands, and sliding with them."""
    mechanism, p, dt = motion.mechanism, motion.p, motion.dt[:, None]
    q, v = mechanism.split(motion.x)
    contact = contact_of(mechanism, p, q, v)
    push = motion.w + times(mechanism.input_map(p, q), motion.u[:, 0])

    def sliding(force):
        reaction = np.sum(contact.coupling * mechanism.acceleration(p, q, v, force), axis=-1) + contact.bias
        return creep * contact.flexible * reaction

    after, before = sliding(push), sliding(np.vstack([push[:1], push[:-1]]))
    before[0] = 0.0  # at rest against the ground
    then = np.append(before[1:], after[-1])
    inverse = np.linalg.inv(mechanism.mass(p, q))
    jump = -times(inverse, contact.coupling * (after - before)[:, None])
    mean = (after + then)[:, None] / 2
    rest = -times(inverse, contact.coupling * (then - after)[:, None] + contact.stirred * mean * dt)
    moved = times(mechanism.kinematics(p, q), dt * jump + dt / 2 * rest) + contact.drift * mean * dt
    return np.concatenate([moved, jump + rest], axis=-1)
