"""Which effects a robot may have, drawn at random."""

import math

import mujoco
import numpy as np

import make_effects as effects
import make_laws
import make_sensors
from make_robots import STEP, written


class Typical:
    """What is typical of the joints of a robot in a recording."""

    def __init__(self, robot, truth, recording):
        self.robot = robot
        model = mujoco.MjModel.from_xml_string(written(truth.root))
        data = mujoco.MjData(model)
        mujoco.mj_setConst(model, data)
        data.qpos[:] = recording.true_q.mean(axis=0)
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        self.joints = recording.joints
        self.rate = np.sqrt(np.mean(recording.true_v**2, axis=0))
        self.inertia = np.diag(full)
        self.torque = np.maximum(np.sqrt(np.mean(recording.torque**2, axis=0)), 4 * self.inertia * self.rate)
        self.drives = robot.drives()
        self.gear = dict(zip(self.drives, model.actuator_gear[:, 0]))
        self.strongest = {name: 0.9 * np.abs(recording.torque[:, self.joints.index(j)]).max() / self.gear[name] for name, j in self.drives.items()}

    def of(self, joint):
        index = self.joints.index(joint)
        return self.inertia[index], self.torque[index], self.rate[index]


def at_joint(kind, typical, rng):
    """An effect at one of the joints."""
    robot, servo = typical.robot, not typical.robot.torques
    joint = str(rng.choice(typical.joints if kind in ("coulomb_friction", "viscous_friction") else list(typical.drives.values())))
    inertia, torque, rate = typical.of(joint)
    drive, reach, slow = f"{joint}_servo", robot.reach[joint], make_laws.SMOOTH * rate
    sign = 1 if rng.random() < 0.5 else -1
    if kind == "coulomb_friction":
        return effects.at_joint(kind, "frictionloss", joint, drive, servo, 0.05 * torque, 0.5 * torque, "N*m")
    if kind == "viscous_friction":
        return effects.at_joint(kind, "damping", joint, drive, servo, 0.05 * torque / rate, torque / rate, "N*m*s/rad")
    if kind == "added_inertia":
        return effects.at_joint(kind, "armature", joint, drive, servo, 0.2 * inertia, 2 * inertia, "kg*m^2")
    if kind == "spring":
        return effects.spring(joint, robot.home[joint] + reach * rng.uniform(-0.5, 0.5), 0.1 * torque / reach, 3 * torque / reach)
    if kind == "backlash":
        return effects.backlash(joint)
    if kind == "sensor_bias":
        return effects.reading_bias(joint, sign)
    if kind == "stribeck_friction":
        return effects.of_law(kind, make_laws.Law(joint, 0, make_laws.stribeck(joint, rng, slow, reach)), 0.05 * torque, 0.5 * torque)
    law = make_laws.Law(joint, 0, make_laws.UNKNOWN[kind](joint, rng, slow, reach))
    scale = 1.0 if kind == "load_friction" else torque
    return effects.of_law(kind, law, 0.1 * scale, 0.6 * scale)


def at_drive(kind, typical, rng):
    """An effect at one of the actuators, or at all."""
    robot = typical.robot
    name = str(rng.choice(list(typical.drives)))
    sign = 1 if rng.random() < 0.5 else -1
    if kind == "actuator_gain":
        return effects.drive_gain(name, not robot.torques, sign)
    if kind == "actuator_bias":
        torque = typical.of(typical.drives[name])[1] / typical.gear[name]
        return effects.drive_bias(name, 0.05 * torque, 0.5 * torque, sign)
    if kind == "actuator_lag":
        return effects.lag(name)
    if kind == "actuator_saturation":
        return effects.saturation(name, typical.strongest[name])
    if kind == "actuator_delay@drives":
        return effects.delayed(list(typical.drives), STEP)
    return effects.delayed([name], STEP)


def at_body(kind, typical, rng):
    """An effect on a body or on the base."""
    robot = typical.robot
    tip = next(body for body in robot.root.iter("body") if body.get("name") == robot.tip)
    own = tip.find("inertial")
    place = np.array([float(word) for word in own.get("pos").split()])
    length = 2 * np.linalg.norm(place)
    if kind == "payload":
        return effects.payload(robot.tip, place * rng.uniform(0.8, 1.8), float(own.get("mass")))
    if kind == "mass_offset":
        direction = rng.normal(size=3)
        return effects.mass_offset(str(rng.choice(robot.links[1:])), direction / np.linalg.norm(direction), 0.5 * length)
    if kind == "mass":
        return effects.relative(str(rng.choice(robot.links[1:])), "mass", 1 if rng.random() < 0.7 else -1)
    return effects.slope(rng.uniform(0, 2 * math.pi))


def at_sensor(kind, typical, rng):
    """An effect on readings or commands; a controller that sees late readings is not made."""
    name = str(rng.choice(list(typical.drives)))
    joint, torques = typical.drives[name], typical.robot.torques
    if kind == "sensor_scale":
        return make_sensors.reading_scale(joint, None if torques else name, 1 if rng.random() < 0.5 else -1)
    if kind == "sensor_delay":
        return None if torques else make_sensors.reading_delay(joint)
    torque = typical.of(joint)[1] / typical.gear[name]
    return make_sensors.dead_zone(name, 0.05 * torque, 0.4 * torque) if torques else None


def draw(kind, typical, rng):
    """An effect of a kind; none where the robot cannot have it."""
    robot = typical.robot
    if kind in ("kp", "kv"):
        return None if robot.torques else effects.relative(str(rng.choice(list(typical.drives))), kind, 1 if rng.random() < 0.5 else -1)
    if kind.endswith("@drives") and kind != "actuator_delay@drives":
        law, attribute = kind.removesuffix("@drives"), {"coulomb": "frictionloss", "viscous": "damping"}[kind.split("_")[0]]
        own = list(typical.drives.values())
        sizes = [typical.of(joint)[1] / (1 if attribute == "frictionloss" else typical.of(joint)[2]) for joint in own]
        return effects.everywhere(law, attribute, own, sizes, 0.4)
    if kind == "backlash" and (typical.robot.name == "gantry" or len(typical.joints) > 6):
        return None
    if kind in ("sensor_scale", "sensor_delay", "actuator_dead_zone"):
        return at_sensor(kind, typical, rng)
    if kind.startswith("actuator"):
        return at_drive(kind, typical, rng)
    if kind in ("payload", "mass_offset", "mass", "ground_slope"):
        return at_body(kind, typical, rng)
    return at_joint(kind, typical, rng)


UNKNOWN = tuple(make_laws.UNKNOWN)
SINGLE = ("coulomb_friction", "payload", "actuator_delay@drives", "kp", "viscous_friction", "sensor_bias", "actuator_gain", "backlash",
          "mass", "actuator_saturation", "coulomb_friction@drives", "added_inertia", "actuator_lag", "spring", "mass_offset", "kv",
          "actuator_bias", "ground_slope", "viscous_friction@drives", "sensor_scale", "stribeck_friction", "actuator_delay", "sensor_delay", "actuator_dead_zone")
PAIRS = (("coulomb_friction", "payload"), ("coulomb_friction@drives", "sensor_bias"), ("actuator_delay@drives", "added_inertia"),
         ("actuator_gain", "viscous_friction"), ("mass", "actuator_lag"), ("spring", "actuator_delay@drives"))
