"""Recordings of a robot: wanted motions, controllers, sensors; and how far an effect moves roll-outs."""

import copy
import math

import mujoco
import numpy as np

import make_laws
from make_robots import written

# Step of the recorded motion, in seconds.
FINE = 0.00025
# Time before a recording in which a robot comes to its first wanted place.
SETTLE = 1.0


def smooth(values, rows):
    kernel = np.hanning(max(rows, 1) + 2)
    padded = np.pad(values, ((rows, rows), (0, 0)), mode="edge")
    both = [np.convolve(column, kernel / kernel.sum(), mode="same") for column in padded.T]
    return np.column_stack(both)[rows:-rows]


def wanted(rng, kind, times, home, reach, soft):
    """Wanted positions at times: sines, steps or ramps about home."""
    home, reach = np.array(list(home)), np.array(list(reach))
    count, rate = len(home), 1 / np.median(np.diff(times))
    if kind == "sines":
        speeds, phases = rng.uniform(0.8, 6.0, (3, count)), rng.uniform(0, 2 * math.pi, (3, count))
        waves = sum(np.sin(np.outer(times, speeds[i]) + phases[i]) / (i + 1.5) for i in range(3))
        return home + 0.7 * reach * waves
    knots = np.arange(times[0], times[-1] + 1.5, rng.uniform(0.6, 1.1))
    levels = home + reach * rng.uniform(-1, 1, (len(knots), count))
    if kind == "steps":
        values = levels[np.searchsorted(knots, times, side="right") - 1]
        return smooth(values, round((0.5 if soft else 0.4) * rate))
    return smooth(np.column_stack([np.interp(times, knots, level) for level in levels.T]), round(0.15 * rate))


class Tracking:
    """Torques that track a wanted motion, from readings and the nominal file."""

    def __init__(self, robot, speed):
        self.model = mujoco.MjModel.from_xml_string(written(robot.root))
        self.data = mujoco.MjData(self.model)
        self.speed, self.rate, self.before = speed, None, None
        self.driven = [robot.joints().index(joint) for joint in robot.drives().values()]

    def commands(self, reading, rates, wanted, interval):
        """Commands after a reading; rates are filtered differences where none are measured."""
        if rates is None:
            raw = np.zeros_like(reading) if self.before is None else (reading - self.before) / interval
            share = math.exp(-60 * interval)
            self.rate = raw if self.rate is None else share * self.rate + (1 - share) * raw
            self.before, rates = reading.copy(), self.rate
        place, rate, acceleration = wanted
        driven = self.driven
        self.data.qpos[:], self.data.qvel[:], self.data.qacc[:] = reading, rates, 0.0
        self.data.qacc[driven] = acceleration + self.speed**2 * (place - reading[driven]) + 1.6 * self.speed * (rate - rates[driven])
        mujoco.mj_inverse(self.model, self.data)
        torque = self.data.qfrc_inverse[driven] / self.model.actuator_gear[:, 0]
        return np.clip(torque, *self.model.actuator_ctrlrange.T)


class Sensors:
    """Noise and steps of the readings."""

    def __init__(self, rng, case):
        self.rng, self.case = rng, case

    def positions(self, values):
        noisy = values + self.case["gauss"] * self.rng.normal(size=np.shape(values))
        return self.case["quantum"] * np.round(noisy / self.case["quantum"])

    def rates(self, values):
        return values + self.case["sd_v"] * self.rng.normal(size=np.shape(values))


def finer(root):
    """The model of a file with the step of the recorded motion; the memory of its delays holds such steps."""
    root = copy.deepcopy(root)
    root.find("option").set("timestep", str(FINE))
    for drive in root.find("actuator"):
        if drive.get("delay"):
            drive.set("nsample", str(math.ceil(float(drive.get("delay")) / FINE)))
    return mujoco.MjModel.from_xml_string(written(root))


class Recording:
    """Readings and true states at the rows of one run."""

    def __init__(self, robot, truth, rng, case, kind, seconds):
        self.joints = robot.joints()
        self.model = finer(truth.root)
        self.steps = self.rows(rng, case, seconds)
        self.drive(robot, truth, rng, case, kind)

    def rows(self, rng, case, seconds):
        each = round(1 / (case["rate"] * FINE))
        count = round(seconds * case["rate"])
        spread = each // 8 if case["irregular"] else 0
        return np.cumsum(np.append(0, each + 2 * rng.integers(-spread, spread + 1, count))) if spread else each * np.arange(count + 1)

    def drive(self, robot, truth, rng, case, kind):
        model, sensors = self.model, Sensors(rng, case)
        data = mujoco.MjData(model)
        own = [model.joint(joint) for joint in self.joints]
        places, dofs = [j.qposadr[0] for j in own], [j.dofadr[0] for j in own]
        self.times = FINE * self.steps
        before = -np.arange(round(SETTLE * case["rate"]), 0, -1) / case["rate"]
        grid = np.append(before, self.times)
        driven = list(robot.drives().values())
        aims = wanted(rng, kind, grid, [robot.home[j] for j in driven], [robot.reach[j] for j in driven], robot.torques)
        aims[: len(before)] = aims[len(before)]
        rates = np.gradient(aims, grid, axis=0)
        tracker = Tracking(robot, case["speed"]) if robot.torques else None
        data.qpos[places] = [robot.home[joint] for joint in self.joints]
        data.qpos[[places[self.joints.index(joint)] for joint in driven]] = aims[0]
        scale = np.array([1 + truth.scales.get(joint, 0.0) for joint in self.joints])
        gust, memory = np.zeros(len(dofs)), math.exp(-1 / (0.1 * case["rate"]))
        if not tracker:
            self.fill(data, aims[0])
        states, torques, self.u = [], [], []
        with make_laws.acting(model, truth.laws):
            for row, begin in enumerate(grid):
                command = aims[row]
                if tracker:
                    reading = sensors.positions(scale * data.qpos[places])
                    rate = sensors.rates(scale * data.qvel[dofs]) if case["velocity"] else None
                    aim = aims[row], rates[row], np.gradient(rates, grid, axis=0)[row] if row == 0 else (rates[row] - rates[row - 1]) * case["rate"]
                    command = tracker.commands(reading, rate, aim, 1 / case["rate"])
                    if row == 0:
                        self.fill(data, command)
                self.u.append(command)
                passed = [make_laws.dead_zone(value, truth.zones.get(name, 0.0)) for name, value in zip(robot.drives(), command)]
                data.ctrl[:] = passed
                gust = memory * gust + math.sqrt(1 - memory**2) * case["gusts"] * rng.normal(size=len(dofs))
                data.qfrc_applied[dofs] = gust
                end = grid[row + 1] if row + 1 < len(grid) else begin + 1 / case["rate"]
                for _ in range(round((end - begin) / FINE)):
                    states.append((data.qpos[places], data.qvel[dofs]))
                    mujoco.mj_step(model, data)
                    torques.append(data.qfrc_actuator[dofs])
        settled = sum(round((b - a) / FINE) for a, b in zip(grid[: len(before)], grid[1:]))
        self.q, self.v = (np.array(values) for values in zip(*states))
        self.torque = np.array(torques)
        self.u = np.array(self.u[len(before) :])
        self.sample(settled, sensors, truth, case, scale)

    def fill(self, data, command):
        """Delays and filters remember the first command."""
        for index in range(self.model.nu):
            if self.model.actuator_actnum[index]:
                data.act[self.model.actuator_actadr[index]] = command[index]
            count = self.model.actuator_history[index, 0]
            if count:
                times = FINE * np.arange(-count, 0)
                mujoco.mj_initCtrlHistory(self.model, data, index, times, np.full((count, 1), command[index]))

    def sample(self, settled, sensors, truth, case, scale):
        """Readings at the rows; torques are means over a sample interval."""
        at = settled + self.steps
        late = [at - round(truth.lags.get(joint, 0.0) / FINE) for joint in self.joints]
        columns = range(len(self.joints))
        self.readings = sensors.positions(np.column_stack([scale[i] * self.q[late[i], i] for i in columns]))
        self.rates = sensors.rates(np.column_stack([scale[i] * self.v[late[i], i] for i in columns]))
        half = round(0.5 / (case["rate"] * FINE))
        sums = np.cumsum(np.vstack([np.zeros(len(columns)), self.torque]), axis=0)
        high = np.minimum(at + half, len(self.torque))
        mean = (sums[high] - sums[at - half]) / (high - at + half)[:, None]
        self.torques = mean + case["sd_t"] * sensors.rng.normal(size=mean.shape)
        self.true_q, self.true_v = self.q[at], self.v[at]
