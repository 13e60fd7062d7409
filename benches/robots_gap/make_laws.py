"""Laws that MuJoCo's file format does not have, as torques at a joint."""

import math

import mujoco
import numpy as np

# Rates below which dry friction is not yet full, as a share of the typical rate of a joint.
SMOOTH = 0.02


class Law:
    """A torque at a joint from its position, its rate and the torque of its drive."""

    def __init__(self, joint, size, torque):
        self.joint, self.size, self.torque = joint, size, torque

    def on(self, model):
        """A function that adds the torque to the passive ones of a model."""
        position, rate = model.joint(self.joint).qposadr[0], model.joint(self.joint).dofadr[0]

        def act(_, data):
            data.qfrc_passive[rate] += self.size * self.torque(data.qpos[position], data.qvel[rate], data.qfrc_actuator[rate])

        return act


def sign(rate, slow):
    return math.tanh(rate / slow)


def where(joint, rng, slow, reach):
    """Dry friction that depends on the place."""
    waves, phase = rng.uniform(1.0, 2.0) / reach, rng.uniform(0, 6.28)
    return lambda q, v, f: -sign(v, slow) * (1 + math.sin(waves * q + phase))


def cogging(joint, rng, slow, reach):
    """Torque of the magnets of a motor."""
    waves, phase = rng.uniform(6, 12) / reach, rng.uniform(0, 6.28)
    return lambda q, v, f: math.sin(waves * q + phase)


def loaded(joint, rng, slow, reach):
    """Friction of a gear that grows with its load."""
    return lambda q, v, f: -sign(v, slow) * abs(f)


def stribeck(joint, rng, slow, reach):
    """Dry friction that falls with the rate."""
    return lambda q, v, f: -sign(v, slow) * (0.5 + math.exp(-((v / (8 * slow)) ** 2)))


UNKNOWN = {"place_friction": where, "cogging": cogging, "load_friction": loaded}


class acting:
    """Lets laws act in a model while the block runs."""

    def __init__(self, model, laws):
        self.acts = [law.on(model) for law in laws]

    def __enter__(self):
        if self.acts:
            mujoco.set_mjcb_passive(lambda model, data: [act(model, data) for act in self.acts])

    def __exit__(self, *_):
        mujoco.set_mjcb_passive(None)


def dead_zone(values, width):
    """What passes a dead zone."""
    return np.sign(values) * np.maximum(np.abs(values) - width, 0.0)
