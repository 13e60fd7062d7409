"""The usual list: armatures, dampings, dry frictions, masses, gains of a robot file as parameters of mujoco.sysid, and one delay."""

import mujoco
import numpy as np
from mujoco import sysid

# The longest delay that is added to those of the file, in seconds, and its unit.
LONGEST_DELAY = 0.05
DELAY_UNIT = 0.01
DELAY = "actuator_delay@drives"


class Scale:
    """What is typical of a joint in a recording: inertia, torque, rate."""

    def __init__(self, inertia, torque, rate):
        self.inertia, self.rate = inertia, max(rate, 1e-3)
        # A joint that nothing drives has torques that stop it in a quarter of a second.
        self.torque = max(torque, 4 * self.inertia * self.rate)


def add(found, name, value, unit, low, high, modifier):
    """A number in a unit of its own, so that steps of all parameters are of a size."""
    def write(spec, parameter):
        modifier(spec, unit * parameter.value[0])

    parameter = sysid.Parameter(name, value / unit, low / unit, high / unit, modifier=write)
    parameter.unit = unit
    found.add(parameter)


def set_first(element, attribute, value):
    getattr(element, attribute)[0] = value


def joints(found, model, scales):
    for joint, scale in scales.items():
        dof = model.joint(joint).dofadr[0]
        armature, damping, friction = model.dof_armature[dof], model.dof_damping[dof], model.dof_frictionloss[dof]
        inertia, resistance, torque = scale.inertia, scale.torque / scale.rate, scale.torque
        add(found, f"added_inertia@{joint}", armature, armature or 0.1 * inertia, 0, 3 * armature + inertia,
            lambda spec, value, j=joint: setattr(spec.joint(j), "armature", value))
        add(found, f"viscous_friction@{joint}", damping, damping or 0.1 * resistance, 0, 3 * damping + resistance,
            lambda spec, value, j=joint: set_first(spec.joint(j), "damping", value))
        add(found, f"coulomb_friction@{joint}", friction, friction or 0.1 * torque, 0, 3 * friction + torque,
            lambda spec, value, j=joint: setattr(spec.joint(j), "frictionloss", value))


def masses(found, model):
    for body in range(1, model.nbody):
        name, mass = model.body(body).name, model.body_mass[body]
        if mass > 0 and model.body_weldid[body]:
            add(found, f"parameter_error@{name}.mass", mass, mass, 0.3 * mass, 3 * mass,
                lambda spec, value, b=name: setattr(spec.body(b), "mass", value))


def gains(found, model):
    for index in range(model.nu):
        actuator, name = model.actuator(index), model.actuator(index).name
        gain, bias = model.actuator_gainprm[index], model.actuator_biasprm[index]
        servo = model.actuator_biastype[index] == mujoco.mjtBias.mjBIAS_AFFINE
        if servo and bias[1] and np.isclose(gain[0], -bias[1]):
            add(found, f"parameter_error@{name}.kp", gain[0], gain[0], gain[0] / 3, 3 * gain[0],
                lambda spec, value, a=name: sysid.apply_pgain(spec, a, value))
            rate = -bias[2]
            add(found, f"parameter_error@{name}.kv", rate, rate or 0.01 * gain[0], 0, 3 * rate + 0.1 * gain[0],
                lambda spec, value, a=name: sysid.apply_dgain(spec, a, value))
        elif servo and bias[2]:
            add(found, f"parameter_error@{name}.kv", gain[0], gain[0], gain[0] / 3, 3 * gain[0],
                lambda spec, value, a=name: velocity_gain(spec.actuator(a), value))
        else:
            gear = actuator.gear[0]
            low, high = sorted((gear / 3, 3 * gear))
            add(found, f"parameter_error@{name}.gear", gear, abs(gear), low, high,
                lambda spec, value, a=name: set_first(spec.actuator(a), "gear", value))


def velocity_gain(actuator, value):
    actuator.gainprm[0] = value
    actuator.biasprm[2] = -value


def usual(model, scales):
    """All parameters, started from the numbers of the file."""
    found = sysid.ParameterDict()
    joints(found, model, scales)
    masses(found, model)
    gains(found, model)
    add(found, DELAY, 0.0, DELAY_UNIT, 0.0, LONGEST_DELAY, lambda spec, value: None)
    return found.move_off_bounds(fraction=0.005)
