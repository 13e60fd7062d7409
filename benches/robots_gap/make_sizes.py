"""How far an effect moves roll-outs of half a second, in units of the noise; sizes that move them so far."""

import copy
import math
from dataclasses import replace
from types import SimpleNamespace

import mujoco
import numpy as np

import make_files
import make_laws
import rollouts
from make_robots import written

# Effects move roll-outs by so much.
LEAST, MOST = 3.0, 100.0
# An effect shows beside the tolerances if the best values within them explain it worse by so many nats in one run and leave
# such a part of what it moves.
DECIDABLE = 25.0
LEFT = 0.05


class Probe:
    """Roll-outs of the robot without an effect, and how far others are from them."""

    def __init__(self, robot, truth, recording, case, centre):
        self.robot, self.truth, self.recording, self.case, self.centre = robot, truth, recording, case, centre
        self.slopes = None
        every = round(rollouts.WINDOW * case["rate"])
        self.starts = range(every, len(recording.times) - every - 1, every)
        self.every = every
        self.plain = self.rolled(truth)

    def rolled(self, truth):
        """Positions in all windows."""
        model = mujoco.MjModel.from_xml_string(written(truth.root))
        with make_laws.acting(model, truth.laws):
            return np.array([self.window(model, truth, start) for start in self.starts])

    def window(self, model, truth, start):
        recording, data = self.recording, mujoco.MjData(model)
        own = [model.joint(joint) for joint in recording.joints]
        places = [joint.qposadr[0] for joint in own]
        # The same readings at the start.
        scales = np.array([1 + truth.scales.get(joint, 0.0) for joint in recording.joints])
        data.qpos[places] = recording.true_q[start] / scales
        data.qvel[[joint.dofadr[0] for joint in own]] = recording.true_v[start] / scales
        data.time = recording.times[start]
        zones = [truth.zones.get(name, 0.0) for name in self.robot.drives()]
        values = np.column_stack([make_laws.dead_zone(u, zone) for u, zone in zip(recording.u.T, zones)])
        rollouts.remember(model, data, SimpleNamespace(times=recording.times, values=values, at=None), recording.times[start])
        found = []
        for row in range(start, start + self.every):
            data.ctrl[:] = values[row]
            mujoco.mj_step(model, data, nstep=round((recording.times[row + 1] - recording.times[row]) / model.opt.timestep))
            found.append(scales * data.qpos[places])
        return found

    def difference(self, effect, size):
        """Differences of an effect from what is without it in units of the noise, as it is read; none where it has no motion."""
        truth = self.truth.with_effect(effect, size)
        try:
            difference = (self.rolled(truth) - self.plain) / self.case["sd"]
        except mujoco.FatalError:
            return None
        lags = [truth.lags.get(joint, 0.0) for joint in self.recording.joints]
        rates = self.recording.true_v[list(self.starts)][:, None, :]
        difference = difference - lags * rates / self.case["sd"]
        return difference if np.isfinite(difference).all() else None

    def moved(self, effect, size):
        """The largest over the joints of the rms difference in units of the noise."""
        difference = self.difference(effect, size)
        return math.inf if difference is None else float(np.sqrt(np.mean(difference**2, axis=(0, 1))).max())

    def tolerated(self):
        """Differences by one standard deviation of each number that has a tolerance, a column each."""
        if self.slopes is None:
            columns = []
            for name in make_files.numbers(self.truth.root, self.centre):
                root = copy.deepcopy(self.truth.root)
                make_files.moved(make_files.numbers(root, self.centre)[name], 1.0)
                columns.append(((self.rolled(replace(self.truth, root=root)) - self.plain) / self.case["sd"]).ravel())
            self.slopes = np.column_stack(columns)
        return self.slopes

    def decidable(self, effect, size):
        """Whether no values within the tolerances move the robot as the effect does."""
        slopes, difference = self.tolerated(), self.difference(effect, size).ravel()
        values = np.linalg.solve(slopes.T @ slopes + np.eye(slopes.shape[1]), slopes.T @ difference)
        left = np.sum((difference - slopes @ values) ** 2)
        return 0.5 * (left + values @ values) > DECIDABLE and left > LEFT * np.sum(difference**2)

    def size(self, effect, target):
        """A size that moves roll-outs by about so much; none where that takes too large a one."""
        size = effect.guess
        for _ in range(9):
            moved = self.moved(effect, size)
            if 0.85 < moved / target < 1.18:
                break
            factor = (target / moved) ** 0.8 if 0 < moved < math.inf else (4.0 if moved == 0 else 0.2)
            larger = size * min(max(factor, 0.15), 5.0)
            if larger >= effect.limit and size >= effect.limit:
                break
            size = min(larger, effect.limit)
        moved = self.moved(effect, size)
        return (size, moved) if LEAST <= moved <= MOST and self.decidable(effect, size) else None
