"""Roll-outs in MuJoCo on held-out runs: how far a robot file closes the gap."""

import math

import mujoco
import numpy as np

from states import smoothed

# Length of a window in seconds.
WINDOW = 0.5
# Commands before a window that filters and delays remember, in seconds.
MEMORY = 1.0
# Length of the roll-out before a window in which joints that were added come to their states, in seconds.
SETTLING = 0.15


class Commands:
    """Recorded commands, each held from its row to the next."""

    def __init__(self, case, table, model):
        self.times = np.array(table["t"])
        self.values = np.zeros((len(self.times), model.nu))
        for name, (column, factor) in case.inputs().items():
            self.values[:, model.actuator(name).id] = factor * np.array(table[column])

    def at(self, time):
        return self.values[max(np.searchsorted(self.times, time + 1e-9) - 1, 0)]


def filtered(commands, actuator, constant, time):
    """The output of a first-order filter of a command at a time, from rest at the first remembered one."""
    first = max(np.searchsorted(commands.times, time - MEMORY) - 1, 0)
    state = commands.values[first, actuator]
    for row in range(first, len(commands.times)):
        begin = commands.times[row]
        if begin >= time:
            break
        end = min(commands.times[row + 1], time) if row + 1 < len(commands.times) else time
        held = commands.values[row, actuator]
        state = held + (state - held) * math.exp(-(end - begin) / constant)
    return state


def remember(model, data, commands, begin):
    """States of filters and delays at the begin of a window, from the commands before."""
    for actuator in range(model.nu):
        if model.actuator_actnum[actuator]:
            constant = model.actuator_dynprm[actuator, 0]
            data.act[model.actuator_actadr[actuator]] = filtered(commands, actuator, constant, begin)
        count = model.actuator_history[actuator, 0]
        if count:
            before = begin + model.opt.timestep * np.arange(-count, 0)
            rows = np.maximum(np.searchsorted(commands.times, before + 1e-9) - 1, 0)
            mujoco.mj_initCtrlHistory(model, data, actuator, before, commands.values[rows, actuator][:, None])


def started(model, states, commands, begin):
    """Data with joints in their states (name, position, rate) at a time."""
    data = mujoco.MjData(model)
    for joint, q, v in states:
        own = model.joint(joint)
        data.qpos[own.qposadr[0]] = q
        data.qvel[own.dofadr[0]] = v
    data.time = begin
    remember(model, data, commands, begin)
    return data


def earlier(times, start):
    """The row at which the roll-out before a window begins."""
    return int(np.searchsorted(times, times[start] - SETTLING))


def settling(case, table, starts):
    """States from which added joints settle: those of the label, or from smoothed readings."""
    joints = case.label["joints"]
    if "earlier" in starts:
        return [list(zip(joints, *states)) for states in starts["earlier"]]
    readings, times = smoothed(case, table), np.array(table["t"])
    return [[(joint, *readings[joint].at(earlier(times, row))) for joint in joints] for row in starts["rows"]]


def settled(model, joints, states, commands, start):
    """Joints that are not recorded, in their states after a roll-out before a window, from states (name, position, rate)."""
    times = commands.times
    data = started(model, states, commands, times[earlier(times, start)])
    while data.time < times[start] - 1e-9:
        data.ctrl[:] = commands.at(data.time)
        mujoco.mj_step(model, data)
    added = [model.joint(joint) for joint in range(model.njnt) if model.joint(joint).name not in joints]
    return [(joint.name, data.qpos[joint.qposadr[0]], data.qvel[joint.dofadr[0]]) for joint in added]


def window(model, case, table, commands, start, states):
    """Squared errors of positions in units of the noise over a window from a row."""
    joints = case.label["joints"]
    times = np.array(table["t"])
    begin = times[start]
    data = started(model, states, commands, begin)
    measured = case.measured()
    addresses = [model.joint(joint).qposadr[0] for joint in joints]
    noise = np.array(case.label["sd"])
    errors = []
    before_time, before_q = data.time, data.qpos[addresses].copy()
    row = start + 1
    while row < len(times) and times[row] <= begin + WINDOW:
        while data.time < times[row] - 1e-9:
            before_time, before_q = data.time, data.qpos[addresses].copy()
            data.ctrl[:] = commands.at(data.time)
            mujoco.mj_step(model, data)
        part = (times[row] - before_time) / (data.time - before_time) if data.time > before_time else 1.0
        predicted = before_q + part * (data.qpos[addresses] - before_q)
        read = np.array([measured[j][1] * table[measured[j][0]][row] for j in joints])
        errors.append(((predicted - read) / noise) ** 2)
        row += 1
    return np.array(errors)


def error(text, case):
    """The rms error of the positions on the held-out runs, in units of the noise."""
    return error_of(mujoco.MjModel.from_xml_string(text), case)


def error_of(model, case):
    """The same of a model that is read."""
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    squares = []
    for run, starts in case.label["starts"].items():
        table = case.table(run)
        commands = Commands(case, table, model)
        joints = case.label["joints"]
        before = settling(case, table, starts) if model.njnt > len(joints) else []
        for index, (start, q, v) in enumerate(zip(starts["rows"], starts["q"], starts["v"])):
            states = list(zip(joints, q, v))
            if before:
                states += settled(model, joints, before[index], commands, start)
            found = window(model, case, table, commands, start, states)
            # Windows with a joint that was not recorded count with the others.
            squares.append(found[np.isfinite(found)])
    every = np.concatenate(squares)
    return math.sqrt(every.mean()) if np.isfinite(every).all() else math.inf


def closed(text, case, references={}):
    """1 - (e^2 - e_true^2) / (e_nominal^2 - e_true^2), with the three errors."""
    if case.folder not in references:
        references[case.folder] = (error(case.robot.read_text(), case), error(case.label["true_xml"], case))
    nominal, true = references[case.folder]
    own = error(text, case)
    gap = nominal**2 - true**2
    return {"closed": 1 - (own**2 - true**2) / gap if gap > 0 else math.nan, "error": own, "nominal": nominal, "true": true}
