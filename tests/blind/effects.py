"""What the rigs have and the declared models lack. Each class is one way to act: a force, friction
that sticks, a force with a memory, an actuator, a sensor, a parameter, a richer mechanism."""

from dataclasses import dataclass, field

import numpy as np

from mechanisms import times

ROUNDED = 0.01  # part of the typical rate over which a sign is rounded where a filter follows it


class Effect:
    """Nothing; the kinds below override the one way in which they act."""

    kind = site = law = ""
    size = 0.0

    @property
    def name(self):
        return f"{self.kind}@{self.site}"

    def change(self, parameters):
        """True parameters."""

    def truth(self):
        """A richer mechanism, or none."""

    def force(self, mechanism, p, q, v, t):
        """Force along the pseudo-velocities; smooth, for one state or many."""
        return 0.0

    def after(self, mechanism, p, x, h):
        """States after a step of h, where the effect acts on states."""
        return x


@dataclass
class Force(Effect):
    """A force along a coordinate, of its position and rate."""

    kind: str
    site: str
    size: float
    law: str = "library"
    along_coordinate: str = None  # where the site is not a coordinate
    lever: float = 1.0
    pitch: float = 0.12
    teeth: float = 7.0

    def force(self, mechanism, p, q, v, t):
        coordinate = self.along_coordinate or self.site
        row = mechanism.row(p, q, coordinate)
        position = q[..., mechanism.coordinates.index(coordinate)]
        rate = np.einsum("...i,...i->...", row, v)
        return row * self.along(position, rate, t)[..., None]

    def along(self, position, rate, t):
        c = self.size * self.lever
        laws = {
            "viscous_friction": lambda: -c * rate,
            "spring": lambda: -c * position,
            "rolling_resistance": lambda: -c * np.tanh(rate / 0.05),
            "ripple": lambda: c * np.sin(2 * np.pi * position / self.pitch),
            "cogging": lambda: c
            * np.sign(np.sin(self.teeth * position))
            * np.abs(np.sin(self.teeth * position)) ** 0.7,
            "hardening": lambda: -c * position**3,
            "thermal_drift": lambda: -c * np.exp(-t / 4.0) * rate,
        }
        return laws[self.kind]()


@dataclass
class PointForce(Effect):
    """A force at the centre of a body: drag, a constant force, wind."""

    kind: str
    site: str
    size: float
    law: str = "library"
    wind: np.ndarray = None
    step: float = 0.01
    axis: int = 0  # of the ground, along which a constant force acts

    def force(self, mechanism, p, q, v, t):
        J = mechanism.bodies[self.site].jacobian(p, q)
        velocity = times(J, v)
        if self.kind == "constant_force":
            F = np.zeros_like(velocity)
            F[..., self.axis] = self.size
        else:
            if self.kind == "gust":
                velocity = velocity.copy()
                velocity[..., 0] -= np.interp(t / self.step, np.arange(len(self.wind)), self.wind)
            speed = np.linalg.norm(velocity, axis=-1, keepdims=True)
            power = 0.8 if self.law == "power_1.8" else 1.0
            F = -self.size * speed**power * velocity
        return times(np.swapaxes(J, -1, -2), F)


@dataclass
class Slope(Effect):
    """A ground that falls along an axis: part of the weight of every body acts along it."""

    size: float
    kind: str = "ground_slope"
    site: str = "gravity"
    law: str = "library"
    axis: int = 0

    def force(self, mechanism, p, q, v, t):
        total = 0.0
        for body in mechanism.bodies.values():
            forward = body.jacobian(p, q)[..., self.axis, :]
            total = total + np.asarray(body.mass(p) * 9.81 * self.size)[..., None] * forward
        return total


@dataclass
class SpinFriction(Effect):
    """A moment about the normal of the ground at the contact of a wheel."""

    size: float
    kind: str = "spin_friction"
    site: str = "wheel"
    law: str = "library"

    def force(self, mechanism, p, q, v, t):
        s, c = np.sin(q[..., 3]), np.cos(q[..., 3])
        moment = -self.size * np.tanh((v[..., 1] * s + v[..., 2] * c) / 0.02)
        f = np.zeros_like(v)
        f[..., 1], f[..., 2] = moment * s, moment * c
        return f


@dataclass
class DryFriction(Effect):
    """Friction that sticks. `simulate` switches it by events; `force` is the rounded form."""

    kind: str
    site: str
    size: float
    law: str = "library"
    stribeck_rate: float = 0.1
    typical_rate: float = 1.0
    asymmetry: float = 0.0

    def sliding(self, rate):
        """Friction force while sliding, positive against the rate."""
        level = self.size
        if self.kind == "stribeck_friction":
            level = self.size * (0.5 + np.exp(-((rate / self.stribeck_rate) ** 2)))
        return level * (1 + self.asymmetry * np.sign(rate))

    def breakaway(self, push):
        level = 1.5 * self.size if self.kind == "stribeck_friction" else self.size
        return level * (1 + self.asymmetry * np.sign(push))

    def force(self, mechanism, p, q, v, t):
        f = np.zeros_like(v)
        rate = v[..., self.speed(mechanism)]
        f[..., self.speed(mechanism)] = -self.sliding(rate) * np.tanh(rate / (ROUNDED * self.typical_rate))
        return f

    def speed(self, mechanism):
        """Speed that is the rate of the coordinate; friction that sticks sits on no other one."""
        wheel = mechanism.name in ("unicycle", "rolling_wheel")
        return {"theta": 0, "r": 3}[self.site] if wheel else mechanism.coordinates.index(self.site)


@dataclass
class Memory(Effect):
    """A force with a state of its own: LuGre's bristles, the hysteresis of Bouc and Wen."""

    kind: str
    site: str
    size: float
    law: str = "library"
    width: float = 0.02

    def slope(self, rate, z):
        if self.law == "lugre":
            level = self.size * (0.8 + 0.4 * np.exp(-((rate / 0.05) ** 2)))
            return rate - np.abs(rate) * z * self.size / (self.width * level)
        wen = 0.6 * np.abs(rate) * z + 0.4 * rate * np.abs(z)
        return (rate - wen) / self.width

    def pull(self, rate, z):
        if self.law == "lugre":
            bristles = self.size / self.width
            return -(bristles * z + 0.05 * np.sqrt(bristles) * self.slope(rate, z))
        return -self.size * z


class Actuator(Effect):
    """What an input gives of its command. `hold` begins a sample; `value` is what comes at a time."""

    def __init__(self, kind, site, size, law="library", peak=1.0):
        self.kind, self.site, self.size, self.law, self.peak = kind, site, size, law, peak
        self.reset()

    def reset(self):
        self.history, self.given, self.slope, self.due = [], 0.0, 0.0, 0.0

    def hold(self, t, command):
        if self.history:
            self.given, self.slope = self.state(t)
        self.history.append((t, command))

    def breaks(self, start, end):
        """Times inside a sample where the value jumps."""
        if self.kind != "actuator_delay":
            return []
        jumps = [t + self.size for t, _ in self.history[-20:]]
        return [t for t in jumps if start < t < end]

    def enter(self, t):
        """Begins a piece without jumps."""
        due = [value for began, value in self.history[-20:] if began + self.size <= t + 1e-12]
        self.due = due[-1] if due else self.history[0][1]

    def state(self, t):
        """Value and slope at a time of the present sample."""
        began, u = self.history[-1]
        since = t - began
        if self.law == "second_order":
            damping, pulse = 0.6, 1.2 / self.size
            swing = pulse * np.sqrt(1 - damping**2)
            decay, c, s = np.exp(-damping * pulse * since), np.cos(swing * since), np.sin(swing * since)
            off, rate = self.given - u, self.slope
            along = (rate + damping * pulse * off) / swing
            value = u + decay * (off * c + along * s)
            slope = decay * (
                (along * swing - damping * pulse * off) * c - (off * swing + damping * pulse * along) * s
            )
            return value, slope
        if self.kind == "actuator_lag":
            return u + (self.given - u) * np.exp(-since / self.size), 0.0
        if self.kind == "actuator_delay":
            return self.due, 0.0
        return self.static(u), 0.0

    def value(self, t):
        return self.state(t)[0]

    @property
    def remembers(self):
        return self.kind in ("actuator_lag", "actuator_delay")

    def static(self, u):
        """What comes of a command at once, or of many."""
        d = self.size
        if self.law == "soft":
            return d * np.tanh(u / d)
        return {
            "actuator_gain": (1 + d) * u,
            "actuator_bias": u + d,
            "actuator_saturation": np.clip(u, -d, d),
            "actuator_dead_zone": np.sign(u) * np.maximum(np.abs(u) - d, 0.0),
        }[self.kind]


@dataclass
class Sensor(Effect):
    kind: str
    site: str
    size: float
    law: str = "library"

    def shown(self, t, positions, rates):
        """What the sensor shows at the samples; between samples the motion is a cubic."""
        if self.kind == "sensor_bias":
            return positions + self.size
        if self.kind == "sensor_scale":
            return positions * (1 + self.size)
        return hermite(t, positions, rates, np.maximum(t - self.size, t[0]))


def hermite(t, y, dy, at):
    """The cubic through values and slopes."""
    i = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    h = t[i + 1] - t[i]
    s = (at - t[i]) / h
    return (
        y[i] * (1 + 2 * s) * (1 - s) ** 2
        + y[i + 1] * s**2 * (3 - 2 * s)
        + h * (dy[i] * s * (1 - s) ** 2 + dy[i + 1] * s**2 * (s - 1))
    )


@dataclass
class Parameter(Effect):
    """A parameter out of its tolerance, inertia besides, a centre of mass that lies aside."""

    kind: str
    site: str
    size: float
    mechanism: object = None
    law: str = "library"

    def change(self, p):
        if self.kind == "parameter_error":
            p[self.site] *= 1 + self.size
        elif self.kind == "added_inertia":
            p[f"added_{self.mechanism.coordinates.index(self.site)}"] = self.size
        else:
            p["e"] = self.size


@dataclass
class Richer(Effect):
    """A gear with play, a wheel that slips, a load that swings."""

    kind: str
    site: str
    size: float
    build: object = None
    law: str = "library"

    def truth(self):
        return self.build(self.size)


@dataclass
class Rig:
    """A real mechanism: the declared one, the true parameters, what acts besides. `unchanged` are the
    parameters before an effect changed them."""

    mechanism: object
    parameters: dict
    effects: list = field(default_factory=list)

    def __post_init__(self):
        self.unchanged = dict(self.parameters)
        for effect in self.effects:
            effect.change(self.parameters)

    def of(self, kind):
        return [effect for effect in self.effects if isinstance(effect, kind)]

    def truth(self):
        richer = [effect.truth() for effect in self.of(Richer)]
        return richer[0] if richer else None
