"""Roll-outs in MuJoCo on held-out runs: how far a robot file closes the gap."""

import math

import mujoco
import numpy as np

# Length of a window in seconds.
WINDOW = 0.5
# Commands before a window that filters and delays remember, in seconds.
MEMORY = 1.0


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


def window(model, case, table, commands, start, position, rate):
    """Squared errors of positions in units of the noise over a window from a row."""
    data = mujoco.MjData(model)
    joints = case.label["joints"]
    for joint, q, v in zip(joints, position, rate):
        own = model.joint(joint)
        data.qpos[own.qposadr[0]] = q
        data.qvel[own.dofadr[0]] = v
    times = np.array(table["t"])
    begin = times[start]
    data.time = begin
    for actuator in range(model.nu):
        if model.actuator_actnum[actuator]:
            constant = model.actuator_dynprm[actuator, 0]
            data.act[model.actuator_actadr[actuator]] = filtered(commands, actuator, constant, begin)
        count = model.actuator_history[actuator, 0]
        if count:
            before = begin + model.opt.timestep * np.arange(-count, 0)
            values = np.array([[commands.at(t)[actuator]] for t in before])
            mujoco.mj_initCtrlHistory(model, data, actuator, before, values)
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
    model = mujoco.MjModel.from_xml_string(text)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    squares = []
    for run, starts in case.label["starts"].items():
        table = case.table(run)
        commands = Commands(case, table, model)
        for start, q, v in zip(starts["rows"], starts["q"], starts["v"]):
            found = window(model, case, table, commands, start, q, v)
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
