"""The same rigs in MuJoCo: bodies and joints, no equations of ours. Friction, damping, springs and
rotor inertia of joints are MuJoCo's own; other forces act as generalised ones."""

import mujoco
import numpy as np

from effects import Actuator, Parameter
from simulate import Trial

SUBSTEPS = 10

HEAD = '<mujoco><option gravity="0 0 -9.81" integrator="RK4" timestep="0.001"><flag contact="disable"/></option><worldbody>'
TAIL = "</worldbody></mujoco>"


def joint(name, kind, own):
    axis = "1 0 0" if kind == "slide" else "0 -1 0"
    return f'<joint name="{name}" type="{kind}" axis="{axis}" {own.get(name, "")}/>'


def inertial(mass, I, forward=0.0, down=0.0):
    return f'<inertial pos="{forward} 0 {-down}" mass="{mass}" diaginertia="{I} {I} {I}"/>'


def text(mechanism, p, own):
    """The rig as MuJoCo reads it. own: attributes of joints."""
    if mechanism.name == "carriage":
        return HEAD + f'<body>{joint("x", "slide", own)}{inertial(p["m"], 1)}</body>' + TAIL
    if mechanism.name == "pendulum":
        return (
            HEAD
            + f'<body>{joint("theta", "hinge", own)}{inertial(p["m"], p["I"], p.get("e", 0), p["l"])}</body>'
            + TAIL
        )
    if mechanism.name == "cart_pole":
        pole = f'<body>{joint("theta", "hinge", own)}{inertial(p["m_pole"], p["I"], p.get("e", 0), p["l"])}</body>'
        return HEAD + f'<body>{joint("x", "slide", own)}{inertial(p["m_cart"], 1)}{pole}</body>' + TAIL
    if mechanism.name == "double_pendulum":
        lower = inertial(p["m2"], p["I2"], p.get("e", 0), p["r2"])
        link2 = f'<body pos="0 0 {-p["l1"]}">{joint("theta2", "hinge", own)}{lower}</body>'
        return (
            HEAD
            + f'<body>{joint("theta1", "hinge", own)}{inertial(p["m1"], p["I1"], 0, p["r1"])}{link2}</body>'
            + TAIL
        )
    raise KeyError(f"no rigid bodies for {mechanism.name}")


def attributes(effect):
    """What a joint of MuJoCo's has for an effect of ours, or nothing."""
    if effect.kind == "viscous_friction":
        return f'damping="{effect.size}"'
    if effect.kind == "spring":
        return f'stiffness="{effect.size}"'
    if effect.kind == "coulomb_friction":
        return f'frictionloss="{effect.size}" solreffriction="0.004 1"'
    if effect.kind == "added_inertia":
        return f'armature="{effect.size}"'
    return None


def mean(actuator, begin, end):
    """What an actuator gives on average over a step."""
    times = [begin] + actuator.breaks(begin, end) + [end]
    total = 0.0
    for left, right in zip(times, times[1:]):
        middle = (left + right) / 2
        actuator.enter(middle)
        total += actuator.value(middle) * (right - left)
    return total / (end - begin)


def run(rig, drive, t, start, disturbance):
    """A trial as `simulate.run` makes one."""
    mechanism, p = rig.mechanism, rig.parameters
    native = {}
    for effect in rig.effects:
        if attributes(effect):
            native[effect.site] = f"{native.get(effect.site, '')} {attributes(effect)}"
    model = mujoco.MjModel.from_xml_string(text(mechanism, p, native))
    data = mujoco.MjData(model)
    n = len(mechanism.coordinates)
    data.qpos[:], data.qvel[:] = start[:n], start[n:]
    actuators = {mechanism.inputs.index(a.site): a for a in rig.of(Actuator)}
    forces = [e for e in rig.effects if not attributes(e) and not isinstance(e, (Actuator, Parameter))]
    for actuator in actuators.values():
        actuator.reset()
    states, commands = [], []
    for k, now in enumerate(t):
        states.append(np.concatenate([data.qpos, data.qvel]))
        commands.append(np.atleast_1d(drive(k, now, states[-1])))
        if k + 1 == len(t):
            break
        model.opt.timestep = (t[k + 1] - now) / SUBSTEPS
        for i, actuator in actuators.items():
            actuator.hold(now, commands[-1][i])
        for j in range(SUBSTEPS):
            begin = now + j * model.opt.timestep
            given = commands[-1].copy()
            for i, actuator in actuators.items():
                given[i] = mean(actuator, begin, begin + model.opt.timestep)
            q, v = data.qpos.copy(), data.qvel.copy()
            extra = sum((e.force(mechanism, p, q, v, begin) for e in forces), 0.0)
            data.qfrc_applied[:] = disturbance[k] + mechanism.input_map(p, q) @ given + extra
            mujoco.mj_step(model, data)
    return Trial(t, np.array(states), np.array(commands), disturbance)
