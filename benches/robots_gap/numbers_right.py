"""Whether the numbers of a robot file that had to change are right."""

import mujoco
import numpy as np

# The largest error of a number that counts as right, as a share of its true change.
WITHIN = 0.25


def fixed_to(model, body):
    """A body and those that are fixed to it."""
    return [other for other in range(model.nbody) if model.body_weldid[other] == model.body_weldid[body]]


def of_body(model, name, attribute):
    together = fixed_to(model, model.body(name).id)
    masses = model.body_mass[together]
    if attribute == "mass":
        return masses.sum()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    body = model.body(name).id
    centre = masses @ data.xipos[together] / masses.sum()
    if attribute == "com":
        return data.xmat[body].reshape(3, 3).T @ (centre - data.xpos[body])
    return model.body_inertia[body]


def of_joint(model, name, attribute):
    joint = model.joint(name)
    index, dof = joint.id, joint.dofadr[0]
    if attribute == "damping":
        return model.dof_damping[dof] + sum(rate_gain(model, a) * model.actuator_gear[a, 0] ** 2 for a in drives(model, index))
    if attribute == "backlash":
        after = index + 1
        same = after < model.njnt and model.jnt_bodyid[after] == model.jnt_bodyid[index]
        return np.ptp(model.jnt_range[after]) if same else 0.0
    # Springs are compared by their stiffness and by their torque at zero.
    stiffness = np.ravel(model.jnt_stiffness[index])[0]
    springref = model.qpos_spring[joint.qposadr[0]]
    return {
        "armature": model.dof_armature[dof],
        "frictionloss": model.dof_frictionloss[dof],
        "stiffness": stiffness,
        "springref": stiffness * springref,
        "ref": model.qpos0[joint.qposadr[0]],
    }[attribute]


def drives(model, joint):
    return [a for a in range(model.nu) if model.actuator_trnid[a, 0] == joint]


def rate_gain(model, actuator):
    return -model.actuator_biasprm[actuator, 2] if model.actuator_biastype[actuator] else 0.0


def of_actuator(model, name, attribute):
    index = model.actuator(name).id
    gain, gear = model.actuator_gainprm[index, 0], model.actuator_gear[index, 0]
    joint = model.actuator_trnid[index, 0]
    limits = model.actuator_forcerange[index] if model.actuator_forcelimited[index] else np.array([-np.inf, np.inf])
    filtered = model.actuator_dyntype[index] != mujoco.mjtDyn.mjDYN_NONE
    # Damping of the joint and rate gain of the servo are one number, as are gear and gain of a motor.
    return {
        "kp": -model.actuator_biasprm[index, 1],
        "kv": rate_gain(model, index) * gear**2 + model.dof_damping[model.jnt_dofadr[joint]],
        "gear": gear * gain,
        "gain": gear * gain,
        "bias": model.actuator_biasprm[index, 0] if model.actuator_biastype[index] else 0.0,
        "timeconst": model.actuator_dynprm[index, 0] if filtered else 0.0,
        "delay": model.actuator_delay[index],
        "forcerange": limits,
    }[attribute]


def number(model, kind, name, attribute):
    if kind == "option":
        return model.opt.gravity
    return {"body": of_body, "joint": of_joint, "actuator": of_actuator}[kind](model, name, attribute)


def close(found, nominal, true):
    """Whether the change of a number is right: a limit that was not stated counts from zero."""
    nominal = np.where(np.isfinite(nominal), nominal, 0.0)
    with np.errstate(invalid="ignore"):
        missed = np.linalg.norm(np.atleast_1d(found - np.asarray(true)))
    return bool(missed <= WITHIN * np.linalg.norm(np.atleast_1d(true - nominal)))


def right(text, case):
    """How many of the numbers that must change are right, and how many there are."""
    files = (text, case.robot.read_text(), case.label["true_xml"])
    models = [mujoco.MjModel.from_xml_string(file) for file in files]
    judged = [close(*(number(model, *place) for model in models)) for place in case.label["written"]]
    return {"right": sum(judged), "numbers": len(judged)}
