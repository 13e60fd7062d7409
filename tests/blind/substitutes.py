"""What an effect could be taken for: every effect of the library at every place of a rig, and what it
does along a true motion. Sizes are relative to what is typical of the rig, as those of `catalogue.make`."""

from copy import copy
from dataclasses import dataclass, replace
from typing import Callable

import numpy as np
from numpy import cos, sin

import catalogue
import oracle
import slip
from effects import Actuator, Effect, Parameter, Sensor
from mechanisms import times, turned
from oracle import SUBSTEPS, given, held

TURN = 1e-4  # step of directional derivatives, two of which may follow one another
PARTS = (0.3, 0.5, 0.7, 0.9)  # of the peak command, where a saturation may begin
ZONES = (0.02, 0.05, 0.1, 0.2)  # of the peak command, for the width of a dead zone
TIMES_S = (0.003, 0.01, 0.03, 0.1)  # for lags and delays of actuators
BENDS = (0.05, 0.2, 0.6)  # of the typical rate, where friction falls
LONGEST_S = 0.3


class Motion(oracle.Motion):
    """A true motion whose disturbance nobody knows. Another inertia answers to it in another way; a reader
    could see that by its level at most, so such changes are told without it."""

    def __init__(self, rig, trial):
        super().__init__(rig, trial)
        self.calm = oracle.Motion(rig, trial, disturbed=False)

    def changed(self, **more):
        """By how much another inertia or weight errs."""
        return self.calm.next(**more) - self.calm.declared, self.off()

    def gap(self, rig):
        return self.changed(p=rig.parameters) if rig.of(Parameter) else super().gap(rig)

    def imitations(self, tolerances):
        return self.calm.imitations(tolerances)

    def moved(self, p):
        """The same motion seen with other parameters, and by how much they err alone."""
        other = copy(self)
        other.p, other.calm = p, copy(self.calm)
        other.calm.p = p
        other.declared, other.calm.declared = other.next(), other.calm.next()
        return other, self.changed(p=p)


class Before(Motion):
    """A true motion of the rig before it had the effect: parameters alone tell of it."""

    def gap(self, rig):
        return self.nothing()

    def nothing(self):
        return 0 * self.declared, self.off()


def since(substitute):
    """The same effect, but not before."""

    def errors(motion, sizes):
        return motion.nothing() if isinstance(motion, Before) else substitute.errors(motion, sizes)

    return replace(substitute, errors=errors)


@dataclass
class Substitute:
    """An effect with sizes, and with shapes that follow them. `errors` is what it does along a motion."""

    name: str
    errors: Callable  # (motion, sizes) -> defects of the motion, what is shown besides
    low: tuple = (-np.inf,)
    high: tuple = (np.inf,)
    starts: tuple = ((1.0,),)
    straight: bool = True  # the errors grow in proportion to the only size
    scaled: int = 1  # leading sizes that may be scaled together to begin with


def acting(make, name, low=-np.inf, **more):
    """An effect of a size, as `make` gives it."""
    return Substitute(name, lambda motion, sizes: errors_of(motion, make(sizes[0])), (low,), **more)


def errors_of(motion, effect):
    if isinstance(effect, Parameter):
        p = dict(motion.p)
        effect.change(p)
        return motion.changed(p=p)
    inputs, effects, sensors = None, [], []
    if isinstance(effect, Actuator):
        inputs = acted(motion.mechanism, effect, motion.trial.t, motion.trial.commands)[:-1]
    elif isinstance(effect, Sensor):
        sensors = [effect]
    else:
        effects = [effect]
    return motion.next(inputs=inputs, effects=effects) - motion.declared, motion.off(sensors)


def acted(mechanism, actuator, t, commands):
    """What an actuator gives in each substep; a late command counts by its mean there, so that a delay can
    be fitted."""
    if actuator.kind != "actuator_delay":
        return given(mechanism, [actuator], t, commands)
    inputs, i = held(commands).copy(), mechanism.inputs.index(actuator.site)
    steps = np.append(np.diff(t), np.diff(t)[-1]) / SUBSTEPS
    edges = t[:, None] + steps[:, None] * np.arange(SUBSTEPS + 1) - actuator.size
    began = np.concatenate([[t[0] - 10.0], t, [t[-1] + 10.0]])
    level = np.concatenate([commands[:1, i], commands[:, i]])
    impulse = np.append(0.0, np.cumsum(level * np.diff(began)))
    inputs[:, :, i] = np.diff(np.interp(edges, began, impulse), axis=1) / steps[:, None]
    return inputs


def all_of(mechanism, p, tolerances, peaks):
    """peaks: largest command of each input."""
    out = []
    for coordinate in moving(mechanism):
        out += at_coordinate(mechanism, p, coordinate)
    for body in mechanism.bodies:
        out += at_body(mechanism, p, body)
    if "wheel" in mechanism.bodies:
        out += at_wheel(mechanism, p)
    for axis in range(directions(mechanism) - 1):
        out.append(library(mechanism, p, "ground_slope", "gravity", axis=axis))
    for name in tolerances:
        out.append(bent(within_half(library(mechanism, p, "parameter_error", name), 0.08)))
    for name, peak in zip(mechanism.inputs, peaks):
        out += at_input(mechanism, p, name, peak)
    for name in mechanism.coordinates:
        out += at_sensor(mechanism, p, name)
    return out


def wheeled(mechanism):
    return mechanism.name in ("unicycle", "rolling_wheel")


def moving(mechanism):
    """Coordinates whose rates are not those of others that roll."""
    return [q for q in mechanism.coordinates if q not in ("x_G", "y_G")]


def directions(mechanism):
    """Two in a plane, three in space; the last one is up."""
    return 3 if wheeled(mechanism) else 2


def library(mechanism, p, kind, site, low=-np.inf, axis=None, peak=1.0):
    def make(size):
        effect = catalogue.make(mechanism, p, kind, site, size, peak=peak)
        return effect if axis is None else replace(effect, axis=axis)

    return acting(make, f"{kind}@{site}", low)


def bent(substitute, **more):
    return replace(substitute, straight=False, **more)


def within_half(substitute, unit):
    """What is wrong by a part is wrong by half at most: a sensor that shows nothing explains everything."""
    return replace(substitute, low=(-0.5 / unit,), high=(0.5 / unit,))


def at_coordinate(mechanism, p, site):
    rubbing = dry(mechanism, p, site)
    shapes = [(share, 1.0, part) for part in BENDS for share in (0.0, 1.0)]
    return [
        library(mechanism, p, "viscous_friction", site, low=0.0),
        library(mechanism, p, "spring", site),
        bent(acting(lambda size: rubbing(size), f"coulomb_friction@{site}", low=0.0)),
        Substitute(
            f"stribeck_friction@{site}",
            lambda motion, sizes: errors_of(motion, rubbing(*sizes)),
            low=(0.0, 0.0, 0.01),
            high=(np.inf, np.inf, 2.0),
            starts=tuple(shapes),
            straight=False,
            scaled=2,
        ),
        bent(
            changing(f"added_inertia@{site}", with_inertia, site, low=0.0, unit=inertia(mechanism, p, site))
        ),
    ]


def at_body(mechanism, p, site):
    offsets = [
        changing(f"mass_offset@{site}", with_offset, site, axis, unit=0.002)
        for axis in range(len(AXES.get((mechanism.name, site), ())))
    ]
    pushes = [
        library(mechanism, p, "constant_force", site, axis=axis) for axis in range(directions(mechanism))
    ]
    return [library(mechanism, p, "quadratic_drag", site, low=0.0)] + pushes + offsets


def at_input(mechanism, p, site, peak):
    own = lambda kind, **more: library(mechanism, p, kind, site, peak=peak, **more)
    starting = lambda values, unit: tuple((value / unit,) for value in values)
    return [
        within_half(own("actuator_gain"), 0.03),
        own("actuator_bias"),
        *(
            bent(own(kind, low=1e-4), high=(LONGEST_S / unit,), starts=starting(TIMES_S, unit), scaled=0)
            for kind, unit in (("actuator_lag", 0.01), ("actuator_delay", 0.005))
        ),
        bent(own("actuator_saturation", low=0.05), high=(1.0,), starts=starting(PARTS, 1.0), scaled=0),
        bent(own("actuator_dead_zone", low=0.0), high=(25.0,), starts=starting(ZONES, 0.02), scaled=0),
    ]


def at_sensor(mechanism, p, site):
    return [
        library(mechanism, p, "sensor_bias", site),
        within_half(library(mechanism, p, "sensor_scale", site), 0.005),
        bent(library(mechanism, p, "sensor_delay", site, low=0.0), high=(LONGEST_S / 0.003,)),
    ]


def at_wheel(mechanism, p):
    """Wheels in space turn about the normal and slide sideways, those in a plane slide along their travel."""
    kind, contact = ("longitudinal_slip", slip.along)
    if wheeled(mechanism):
        kind, contact = ("lateral_slip", slip.sideways)
    errors = lambda motion, sizes: (slip.defects(motion, 0.01 * sizes[0], contact), motion.off())
    spin = [library(mechanism, p, "spin_friction", "wheel", low=0.0)] if wheeled(mechanism) else []
    rolling = library(mechanism, p, "rolling_resistance", "wheel", low=0.0)
    return [rolling, *spin, Substitute(f"{kind}@rolling", errors, (0.0,))]


# Dry friction: it takes what rate it can over a step, and no more than all of it.


@dataclass
class Rubbing(Effect):
    site: str
    sliding: float = 0.0
    excess: float = 0.0
    rate: float = 1.0

    def after(self, mechanism, p, x, h):
        q, v = mechanism.split(x)
        row = mechanism.row(p, q, self.site)
        answer = np.linalg.solve(mechanism.mass(p, q), row[..., None])[..., 0]  # rates per impulse
        rate = np.einsum("...i,...i->...", row, v)
        most = (self.sliding + self.excess * np.exp(-((rate / self.rate) ** 2))) * h[..., 0]
        needed = rate / np.einsum("...i,...i->...", row, answer)
        kick = -np.clip(needed, -most, most)[..., None] * answer
        return np.concatenate([q + h / 2 * times(mechanism.kinematics(p, q), kick), v + kick], axis=-1)


def dry(mechanism, p, site):
    unit = catalogue.make(mechanism, p, "coulomb_friction", site, 1.0)

    def rubbing(sliding, excess=0.0, part=1.0):
        return Rubbing(site, sliding * unit.size, excess * unit.size, part * unit.typical_rate)

    return rubbing


# Inertia besides and centres of mass aside, for any coordinate and body.


def changing(name, change, *place, low=-np.inf, unit):
    def errors(motion, sizes):
        return motion.changed(mechanism=change(motion.mechanism, *place, sizes[0] * unit))

    return Substitute(name, errors, (low,))


def inertia(mechanism, p, site):
    """A typical inertia to be added to a coordinate."""
    at = np.zeros(len(mechanism.coordinates))
    row = mechanism.row(p, at, site)
    return 0.05 / (row @ np.linalg.solve(mechanism.mass(p, at), row))


def along(function, mechanism, p, q, v):
    """Derivative of a function of positions along a motion."""
    rate = times(mechanism.kinematics(p, q), v)
    return (function(q + TURN * rate) - function(q - TURN * rate)) / (2 * TURN)


def with_inertia(mechanism, site, size):
    """T grows by size·q'²/2."""

    def mass(p, q):
        row = mechanism.row(p, q, site)
        return mechanism.mass(p, q) + size * row[..., :, None] * row[..., None, :]

    def bias(p, q, v):
        turning = along(lambda q: mechanism.row(p, q, site), mechanism, p, q, v)
        pull = np.einsum("...i,...i->...", turning, v)[..., None]
        return mechanism.bias(p, q, v) + size * mechanism.row(p, q, site) * pull

    return replace(mechanism, mass=mass, bias=bias)


def with_offset(mechanism, body, axis, size):
    """The centre of mass lies aside along an axis of the body; to first order in the distance."""
    jacobian, body_mass = mechanism.bodies[body].jacobian, mechanism.bodies[body].mass
    direction = AXES[mechanism.name, body][axis]

    def aside(p, q):
        """Jacobian of the axis."""
        columns = np.swapaxes(mechanism.kinematics(p, q), -1, -2)
        ahead, behind = (
            direction(p, q[..., None, :] + step * columns) for step in (TURN, -TURN)
        )  # one per speed
        return np.swapaxes(ahead - behind, -1, -2) / (2 * TURN)

    def mass(p, q):
        cross = np.swapaxes(jacobian(p, q), -1, -2) @ aside(p, q)
        return mechanism.mass(p, q) + size * body_mass(p) * (cross + np.swapaxes(cross, -1, -2))

    def bias(p, q, v):
        J, D = jacobian(p, q), aside(p, q)
        J_v = times(along(lambda q: jacobian(p, q), mechanism, p, q, v), v)
        D_v = times(along(lambda q: aside(p, q), mechanism, p, q, v), v)
        J_v[..., -1] += p.get("g", 9.81)
        force = times(np.swapaxes(J, -1, -2), D_v) + times(np.swapaxes(D, -1, -2), J_v)
        return mechanism.bias(p, q, v) + size * body_mass(p) * force

    return replace(mechanism, mass=mass, bias=bias)


def pair(first, second):
    return np.stack([first, second], axis=-1)


def swings(angle):
    """x of a body that hangs: an angle turns it forward and up."""
    return lambda p, q: pair(cos(angle(q)), sin(angle(q)))


def leans(angle):
    """x of a body that stands: an angle leans it forward and down."""
    return lambda p, q: pair(cos(angle(q)), -sin(angle(q)))


def of_wheel(x, y, z):
    """An axis of a wheel that rolls in space, from its parts in the tilted frame."""

    def direction(p, q):
        phi = q[..., 4]
        parts = [[x * cos(phi) + z * sin(phi)], [y + 0 * phi], [z * cos(phi) - x * sin(phi)]]
        return turned(p, q, parts)[..., 0]

    return direction


WHEEL = (of_wheel(1, 0, 0), of_wheel(0, 1, 0), of_wheel(0, 0, 1))
UPRIGHT = (
    lambda p, q: pair(cos(q[..., 0] / p["R"]), -sin(q[..., 0] / p["R"])),
    lambda p, q: pair(sin(q[..., 0] / p["R"]), cos(q[..., 0] / p["R"])),
)

# Axes along which the drawing does not already place a centre of mass.
AXES = {
    ("pendulum", "rod"): (swings(lambda q: q[..., 0]),),
    ("cart_pole", "pole"): (swings(lambda q: q[..., 1]),),
    ("double_pendulum", "link1"): (swings(lambda q: q[..., 0]),),
    ("double_pendulum", "link2"): (swings(lambda q: q[..., 0] + q[..., 1]),),
    ("euc_2dof", "wheel"): UPRIGHT,
    ("euc_2dof", "rider"): (leans(lambda q: q[..., 1]),),
    ("euc_3dof", "wheel"): UPRIGHT,
    ("euc_3dof", "body"): (leans(lambda q: q[..., 1]),),
    ("euc_3dof", "rider"): (leans(lambda q: q[..., 2]),),
    ("rolling_wheel", "wheel"): WHEEL,
    ("unicycle", "wheel"): WHEEL,
}
