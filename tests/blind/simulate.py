"""The motion of a rig between samples, by SciPy's integrators. Friction sticks and slips at events;
commands and disturbances are held over each sample."""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from effects import Actuator, DryFriction, Memory
from truths import plain

TOLERANCES = dict(rtol=1e-8, atol=1e-10)
MOST_SWITCHES = 200  # within one sample; more would be an error of the model


@dataclass
class Trial:
    """True states of the declared coordinates and speeds at the samples, commands, disturbances."""

    t: np.ndarray
    states: np.ndarray
    commands: np.ndarray
    disturbance: np.ndarray


class Integrator:
    def __init__(self, rig):
        self.rig, self.mechanism, self.p = rig, rig.mechanism, rig.parameters
        self.truth = rig.truth() or plain(rig.mechanism)
        self.n, self.m = len(self.truth.mechanism.coordinates), len(self.truth.mechanism.speeds)
        self.own_n, self.own_m = len(rig.mechanism.coordinates), len(rig.mechanism.speeds)
        self.dry = next(iter(rig.of(DryFriction)), None)
        self.memories = rig.of(Memory)
        self.actuators = {rig.mechanism.inputs.index(a.site): a for a in rig.of(Actuator)}
        self.smooth = [e for e in rig.effects if not isinstance(e, (DryFriction, Memory, Actuator))]
        self.method = "LSODA" if rig.truth() else "DOP853"  # contacts are stiff
        self.sliding = 0  # direction of dry friction; 0 sticks

    def start(self, q, v):
        q, v = self.truth.start(self.p, q, v)
        for actuator in self.actuators.values():
            actuator.reset()
        if self.dry:
            self.sliding = int(np.sign(v[self.dry.speed(self.mechanism)]))
        return np.concatenate([q, v, np.zeros(len(self.memories))])

    def declared(self, x):
        """Coordinates and speeds of the declared mechanism."""
        return np.concatenate([x[: self.own_n], x[self.n : self.n + self.own_m]])

    def force(self, t, x, command, disturbance):
        """All forces but dry friction, along the speeds of the truth."""
        q, v = x[: self.n], x[self.n : self.n + self.m]
        own_q, own_v = q[: self.own_n], v[: self.own_m]
        own = disturbance + sum((e.force(self.mechanism, self.p, own_q, own_v, t) for e in self.smooth), 0.0)
        for memory, z in zip(self.memories, x[self.n + self.m :]):
            i = self.mechanism.coordinates.index(memory.site)
            own = own + np.eye(self.own_m)[i] * memory.pull(own_v[i], z)
        given = np.array(
            [self.actuators[i].value(t) if i in self.actuators else u for i, u in enumerate(command)],
            dtype=float,
        )
        f = np.zeros(self.m)
        f[: self.own_m] = own
        return f + self.truth.mechanism.input_map(self.p, q) @ given + self.truth.internal(self.p, q, v)

    def holding(self, t, x, command, disturbance):
        """The force that keeps the sticking joint at rest, and the accelerations with it."""
        q, v = x[: self.n], x[self.n : self.n + self.m]
        i = self.dry.speed(self.mechanism)
        inverse = np.linalg.inv(self.truth.mechanism.mass(self.p, q))
        free = inverse @ (self.force(t, x, command, disturbance) - self.truth.mechanism.bias(self.p, q, v))
        hold = -free[i] / inverse[i, i]
        return hold, free + inverse[:, i] * hold

    def rates(self, t, x, command, disturbance):
        q, v, z = x[: self.n], x[self.n : self.n + self.m], x[self.n + self.m :]
        mechanism = self.truth.mechanism
        if self.dry and self.sliding == 0:
            _, acceleration = self.holding(t, x, command, disturbance)
        else:
            f = self.force(t, x, command, disturbance)
            if self.dry:
                i = self.dry.speed(self.mechanism)
                f[i] -= self.sliding * self.dry.sliding(self.sliding * max(self.sliding * v[i], 1e-12))
            acceleration = mechanism.acceleration(self.p, q, v, f)
        indices = [self.mechanism.coordinates.index(memory.site) for memory in self.memories]
        slopes = [memory.slope(v[i], one) for memory, i, one in zip(self.memories, indices, z)]
        return np.concatenate([mechanism.kinematics(self.p, q) @ v, acceleration, slopes])

    def settle(self, t, x, command, disturbance):
        """Whether the joint that rests sticks, and which way it leaves otherwise."""
        hold, _ = self.holding(t, x, command, disturbance)
        self.sliding = 0 if abs(hold) <= self.dry.breakaway(-hold) else int(np.sign(-hold))

    def event(self, command, disturbance):
        """Zero where the present kind of friction ends."""
        i = self.n + self.dry.speed(self.mechanism)
        if self.sliding:
            crossing = lambda t, x: self.sliding * x[i]
        else:

            def crossing(t, x):
                hold, _ = self.holding(t, x, command, disturbance)
                return self.dry.breakaway(-hold) - abs(hold)

        crossing.terminal, crossing.direction = True, -1
        return crossing

    def across(self, begin, end, x, command, disturbance):
        """The state at the end of a time over which nothing jumps."""
        t = begin
        for _ in range(MOST_SWITCHES):
            if self.dry and self.sliding == 0:
                x[self.n + self.dry.speed(self.mechanism)] = 0.0
                self.settle(t, x, command, disturbance)
            events = [self.event(command, disturbance)] if self.dry else None
            solved = solve_ivp(
                lambda s, y: self.rates(s, y, command, disturbance),
                (t, end),
                x,
                method=self.method,
                first_step=end - t,
                events=events,
                **TOLERANCES,
            )
            if not solved.success:
                raise ArithmeticError(f"{self.truth.mechanism.name} at {t:.4f} s: {solved.message}")
            t, x = solved.t[-1], solved.y[:, -1].copy()
            if solved.status == 0:
                return x
            self.sliding = 0
            if end - t < 1e-12:
                return x
        raise ArithmeticError(f"friction of {self.mechanism.name} switches without end at {t:.4f} s")

    def sample(self, begin, end, x, command, disturbance):
        """The state one sample later."""
        for i, actuator in self.actuators.items():
            actuator.hold(begin, command[i])
        jumps = sorted({t for a in self.actuators.values() for t in a.breaks(begin, end)})
        for left, right in zip([begin] + jumps, jumps + [end]):
            if right - left > 1e-12:
                for actuator in self.actuators.values():
                    actuator.enter(left)
                x = self.across(left, right, x, command, disturbance)
        return x


def run(rig, drive, t, start, disturbance):
    """A trial: the drive sees the state at each sample and gives the command that is held."""
    integrator = Integrator(rig)
    n = len(rig.mechanism.coordinates)
    x = integrator.start(start[:n], start[n:])
    states, commands = [], []
    for k, now in enumerate(t):
        own = integrator.declared(x)
        states.append(own)
        commands.append(np.atleast_1d(drive(k, now, own)) if rig.mechanism.inputs else np.zeros(0))
        if k + 1 < len(t):
            x = integrator.sample(now, t[k + 1], x, commands[-1], disturbance[k])
    return Trial(t, np.array(states), np.array(commands), disturbance)
