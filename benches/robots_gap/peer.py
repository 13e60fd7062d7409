#!/usr/bin/env python3
"""The usual list of numbers of a robot file, fitted to its recordings by mujoco.sysid.

    python3 benches/robots_gap/peer.py CASE -o better.xml [--moved moved.json]

Roll-outs of half a second begin at smoothed readings of the fit runs; their positions are compared with the readings in
units of the noise. Commands are held from row to row and delayed by what is fitted. Needs mujoco[sysid].
"""

import argparse
import json
import math
from pathlib import Path

import mujoco
import numpy as np
from mujoco import sysid

import peer_list
from cases import described
from rollouts import WINDOW, Commands, filtered
from states import smoothed

# Step of the roll-outs of the fit, in seconds.
STEP = 0.002
# Commands before a window that a delay reaches, in seconds.
BEFORE = 0.2
ITERATIONS = 14
# Pull towards the numbers of the file, which decides where the recordings do not: a fifth of a number counts as one reading
# that is off by its noise. Without it masses, gains and frictions grow together and damping trades places with rate gains.
PULL = 5.0


class Window:
    """Half a second of a recording: its start, its commands, its readings."""

    def __init__(self, model, table, commands, joints, row, count):
        self.times = np.array(table["t"])[row : row + count + 1]
        self.begin = self.times[0]
        states = [joint.at(row) for joint in joints.values()]
        data = mujoco.MjData(model)
        for name, (position, rate) in zip(joints, states):
            data.qpos[model.joint(name).qposadr[0]] = position
            data.qvel[model.joint(name).dofadr[0]] = rate
        for actuator in range(model.nu):
            if model.actuator_actnum[actuator]:
                constant = model.actuator_dynprm[actuator, 0]
                data.act[model.actuator_actadr[actuator]] = filtered(commands, actuator, constant, self.begin)
        data.ctrl[:] = commands.at(self.begin)
        mujoco.mj_forward(model, data)
        self.torque, self.rate, self.inertia = data.qfrc_actuator.copy(), data.qvel.copy(), np.diag(mass_matrix(model, data))
        self.state = sysid.create_initial_state(model, data.qpos, data.qvel, data.act)
        self.state[0] = self.begin
        self.readings = np.column_stack([joint.position[row : row + count + 1] for joint in joints.values()])
        self.noise = np.array([joint.position_noise for joint in joints.values()])
        first = max(np.searchsorted(commands.times, self.begin - BEFORE) - 1, 0)
        self.rows = np.append(commands.times[first : row + count + 1], math.inf)
        self.values = commands.values[first : row + count + 1]

    def delayed(self, times, delays):
        """Commands after their delays, averaged over the steps between the times."""
        found = np.empty((len(times), self.values.shape[1]))
        lengths = np.append(np.diff(self.rows[:-1]), 10.0)
        edges = np.append(times, 2 * times[-1] - times[-2])
        for actuator, delay in enumerate(delays):
            held = self.values[:, actuator]
            sums = np.concatenate([[0.0], np.cumsum(held * lengths)])
            knots = np.concatenate([[self.rows[0]], self.rows[0] + np.cumsum(lengths)])
            at = edges - delay
            integral = np.interp(at, knots, sums) + np.minimum(at - knots[0], 0.0) * held[0]
            found[:, actuator] = np.diff(integral) / np.diff(edges)
        return found


def mass_matrix(model, data):
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def prepared(path):
    """The spec of a file with explicit masses and without contacts, and the delays that it states."""
    spec = mujoco.MjSpec.from_file(str(path))
    for body in spec.bodies[1:]:
        if not body.explicitinertial:
            sysid.apply_body_mass_ipos(spec, body.name)
    return spec, np.array([actuator.delay for actuator in spec.actuators])


class Fit:
    """The recordings of a case, and residuals of the roll-outs of a robot file."""

    def __init__(self, case):
        self.case = case
        self.spec, self.delays = prepared(case.robot)
        for actuator in self.spec.actuators:
            actuator.delay, actuator.nsample = 0.0, 0
        self.spec.option.timestep = STEP
        self.spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        self.model = self.spec.compile()
        self.windows = [window for run in case.runs["fit"] for window in self.cut(case.table(run))]
        self.joints = list(case.measured())
        self.addresses = [self.model.joint(joint).qposadr[0] for joint in self.joints]
        length = max(window.times[-1] - window.begin for window in self.windows)
        self.grid = STEP * np.arange(math.ceil(length / STEP) + 2)
        self.trajectories = [self.trajectory(window) for window in self.windows]

    def cut(self, table):
        times = np.array(table["t"])
        count = round(WINDOW / np.median(np.diff(times)))
        commands, joints = Commands(self.case, table, self.model), smoothed(self.case, table)
        for row in range(count // 2, len(times) - count, count):
            yield Window(self.model, table, commands, joints, row, count)

    def trajectory(self, window):
        times = window.begin + self.grid
        control = sysid.TimeSeries(times, window.delayed(times, self.delays))
        return sysid.SystemTrajectory(self.model, control, sysid.TimeSeries(window.times, window.readings), window.state, None)

    def rollout(self, models, control_signal, param_dicts, **others):
        """Rolls out with the commands delayed by each parameter set."""
        delayed = []
        for parameters in param_dicts:
            delay = self.delays + peer_list.DELAY_UNIT * parameters[peer_list.DELAY].value[0]
            times = (window.begin + self.grid for window in self.windows)
            delayed += [sysid.TimeSeries(t, window.delayed(t, delay)) for t, window in zip(times, self.windows)]
        return sysid.sysid_rollout(models, control_signal=delayed, **{k: others[k] for k in others if k != "param_dicts"})

    def compared(self, parameters, predicted, measured, model, every, state, **_):
        """Positions at the times of the readings, less the readings, in units of the noise."""
        columns = [np.interp(measured.times[1:], state[:, 0], state[:, 1 + address]) for address in self.addresses]
        at = sysid.TimeSeries(measured.times[1:], np.column_stack(columns))
        read = sysid.TimeSeries(measured.times[1:], measured.data[1:])
        return np.nan_to_num((at.data - read.data) / self.windows[0].noise).ravel(), at, read

    def residual(self, x, parameters):
        """Residuals of all windows; a column for each column of x."""
        def build(values):
            return sysid.apply_param_modifiers(values, self.spec)

        found, predicted, measured = sysid.model_residual(
            x, parameters, build, self.trajectories, modify_residual=self.compared, custom_rollout=self.rollout, n_threads=1)
        if x.ndim > 1:
            found = found.T.reshape(x.shape[1], -1).T
        pull = PULL * (x.T - parameters.as_nominal_vector()).T
        return [found, pull], predicted, measured

    def scales(self):
        """What is typical of each joint over the starts of the windows."""
        def typical(name, index):
            return float(np.sqrt(np.mean([getattr(window, name)[index] ** 2 for window in self.windows])))

        dofs = {joint: self.model.joint(joint).dofadr[0] for joint in self.joints}
        return {joint: peer_list.Scale(typical("inertia", d), typical("torque", d), typical("rate", d)) for joint, d in dofs.items()}


def corrected(path, parameters):
    """The file with fitted numbers, written by MuJoCo."""
    spec, delays = prepared(path)
    sysid.apply_param_modifiers_spec(parameters, spec)
    delays += peer_list.DELAY_UNIT * parameters[peer_list.DELAY].value[0]
    for actuator, delay in zip(spec.actuators, delays):
        actuator.delay = float(delay)
        actuator.nsample = max(actuator.nsample, math.ceil(delay / spec.option.timestep))
    spec.compile()
    return spec.to_xml()


def moved(parameters, nominal, jacobian):
    """Fitted numbers, those first that change the roll-outs most: with old and new value and rms change in units of the noise."""
    shift = parameters.as_vector() - nominal.as_nominal_vector()
    motion = jacobian[: -len(shift)]
    changes = np.abs(shift) * np.linalg.norm(motion, axis=0) / math.sqrt(len(motion))
    found = []
    for (name, parameter), change in zip(parameters.items(), changes):
        values = parameter.unit * np.array([parameter.nominal[0], parameter.value[0]])
        found.append({"effect": name, "nominal": values[0], "fitted": values[1], "change": float(change)})
    return sorted(found, key=lambda one: -one["change"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--moved", type=Path)
    given = parser.parse_args()
    case = described(given.case)
    fit = Fit(case)
    start = peer_list.usual(fit.model, fit.scales())
    # Its default optimiser stops early on a few of these recordings; this one of its choices does not.
    fitted, result = sysid.optimize(start, fit.residual, optimizer="scipy_parallel_fd", max_iters=ITERATIONS, diff_step=1e-3,
                                    x_scale="jac", ftol=1e-4)
    given.output.write_text(corrected(case.robot, fitted))
    if given.moved:
        given.moved.write_text(json.dumps(moved(fitted, start, result.jac), indent=1))


if __name__ == "__main__":
    main()
