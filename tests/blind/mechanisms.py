"""Equations of motion of the rigs, from Lagrange's method on paper; the two with rolling wheels from
the corrected formulas of the papers. For one state, or for many at once along the first axis.

    M(q) v' + h(q, v) = B(q) u + f,    q' = N(q) v

h holds the weight. Forces f of any kind are given along the pseudo-velocities v."""

from dataclasses import dataclass
from typing import Callable

import numpy as np
from numpy import cos, sin, tan


def matrix(rows):
    """A matrix of scalars, or of arrays of states: the two matrix axes come last."""
    shape = np.broadcast_shapes(*{entry.shape for row in rows for entry in row if hasattr(entry, "shape")})
    if not shape:
        return np.array(rows, dtype=float)
    out = np.empty(shape + (len(rows), len(rows[0])))
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            out[..., i, j] = entry
    return out


def vector(entries):
    return matrix([entries])[..., 0, :]


def times(matrices, vectors):
    return (matrices @ vectors[..., None])[..., 0]


def identity(n):
    eye = np.eye(n)
    return lambda p, q: eye if q.ndim == 1 else np.broadcast_to(eye, q.shape[:-1] + (n, n))


@dataclass(frozen=True)
class Body:
    """Mass and velocity Jacobian of the centre: velocity = J v, in ground axes, forward first, up last."""

    mass: Callable
    jacobian: Callable


@dataclass(frozen=True)
class Mechanism:
    name: str
    coordinates: tuple
    speeds: tuple
    inputs: tuple
    mass: Callable  # M(p, q)
    bias: Callable  # h(p, q, v)
    input_map: Callable  # B(p, q)
    kinematics: Callable  # N(p, q)
    potential: Callable  # V(p, q)
    bodies: dict
    defaults: dict  # parameters that the declared model does not have, and their values there

    def split(self, x):
        n = len(self.coordinates)
        return x[..., :n], x[..., n : n + len(self.speeds)]

    def acceleration(self, p, q, v, force):
        M = self.mass(p, q)
        if M.shape[-1] == 1:
            return (force - self.bias(p, q, v)) / M[..., 0]
        return np.linalg.solve(M, (force - self.bias(p, q, v))[..., None])[..., 0]

    def energy(self, p, q, v):
        return np.einsum("...i,...ij,...j->...", v, self.mass(p, q), v) / 2 + self.potential(p, q)

    def row(self, p, q, coordinate):
        """∂q'/∂v of one coordinate: a force along the coordinate acts on v along this row."""
        return self.kinematics(p, q)[..., self.coordinates.index(coordinate), :]


def added(p, i):
    """Inertia that a coordinate carries besides."""
    return p.get(f"added_{i}", 0.0)


# Carriage on a rail.

carriage = Mechanism(
    name="carriage",
    coordinates=("x",),
    speeds=("v",),
    inputs=("F",),
    mass=lambda p, q: matrix([[p["m"] + added(p, 0) + 0 * q[..., 0]]]),
    bias=lambda p, q, v: 0 * v,
    input_map=identity(1),
    kinematics=identity(1),
    potential=lambda p, q: 0 * q[..., 0],
    bodies={"carriage": Body(lambda p: p["m"], lambda p, q: matrix([[1 + 0 * q[..., 0]], [0]]))},
    defaults={},
)


# Pendulum. Its centre of mass may lie aside of the rod by e, along the rod's x.


def pendulum_lever(p, q, angle=0):
    """∂(centre)/∂θ, forward and up."""
    s, c = sin(q[..., angle]), cos(q[..., angle])
    return p["l"] * c - p.get("e", 0) * s, p["l"] * s + p.get("e", 0) * c


def pendulum_mass(p, q):
    return matrix([[p["I"] + p["m"] * (p["l"] ** 2 + p.get("e", 0) ** 2) + added(p, 0) + 0 * q[..., 0]]])


def pendulum_jacobian(p, q):
    forward, up = pendulum_lever(p, q)
    return matrix([[forward], [up]])


pendulum = Mechanism(
    name="pendulum",
    coordinates=("theta",),
    speeds=("omega",),
    inputs=("tau",),
    mass=pendulum_mass,
    bias=lambda p, q, v: vector([p["m"] * p["g"] * pendulum_lever(p, q)[1]]),
    input_map=identity(1),
    kinematics=identity(1),
    potential=lambda p, q: p["m"] * p["g"] * (p.get("e", 0) * sin(q[..., 0]) - p["l"] * cos(q[..., 0])),
    bodies={"rod": Body(lambda p: p["m"], pendulum_jacobian)},
    defaults={"e": 0.0},
)


# Cart with a hanging pole.


def cart_pole_mass(p, q):
    forward, _ = pendulum_lever(p, q, 1)
    coupling = p["m_pole"] * forward
    return matrix(
        [
            [p["m_cart"] + p["m_pole"] + added(p, 0), coupling],
            [coupling, p["I"] + p["m_pole"] * (p["l"] ** 2 + p.get("e", 0) ** 2) + added(p, 1)],
        ]
    )


def cart_pole_bias(p, q, v):
    _, up = pendulum_lever(p, q, 1)
    return vector([-p["m_pole"] * up * v[..., 1] ** 2, p["m_pole"] * p["g"] * up])


def pole_jacobian(p, q):
    forward, up = pendulum_lever(p, q, 1)
    return matrix([[1, forward], [0, up]])


cart_pole = Mechanism(
    name="cart_pole",
    coordinates=("x", "theta"),
    speeds=("v", "omega"),
    inputs=("F",),
    mass=cart_pole_mass,
    bias=cart_pole_bias,
    input_map=lambda p, q: matrix([[1 + 0 * q[..., 0]], [0]]),
    kinematics=identity(2),
    potential=lambda p, q: p["m_pole"] * p["g"] * (p.get("e", 0) * sin(q[..., 1]) - p["l"] * cos(q[..., 1])),
    bodies={
        "cart": Body(lambda p: p["m_cart"], lambda p, q: matrix([[1 + 0 * q[..., 0], 0], [0, 0]])),
        "pole": Body(lambda p: p["m_pole"], pole_jacobian),
    },
    defaults={"e": 0.0},
)


# Double pendulum; the second angle is relative, so the elbow's torque works on it alone.


def elbow(p, q):
    """k = (upper arm's direction) · (lever of link 2), and its slope in θ2."""
    s, c, e = sin(q[..., 1]), cos(q[..., 1]), p.get("e", 0)
    return p["r2"] * c - e * s, -(p["r2"] * s + e * c)


def double_mass(p, q):
    k, _ = elbow(p, q)
    own = p["I2"] + p["m2"] * (p["r2"] ** 2 + p.get("e", 0) ** 2)
    upper = p["I1"] + p["m1"] * p["r1"] ** 2 + p["m2"] * p["l1"] ** 2
    coupling = p["m2"] * p["l1"] * k
    return matrix(
        [[upper + own + 2 * coupling + added(p, 0), own + coupling], [own + coupling, own + added(p, 1)]]
    )


def double_jacobian(p, q):
    s1, c1 = sin(q[..., 0]), cos(q[..., 0])
    s, c, e = sin(q[..., 0] + q[..., 1]), cos(q[..., 0] + q[..., 1]), p.get("e", 0)
    forward, up = p["r2"] * c - e * s, p["r2"] * s + e * c
    return matrix([[p["l1"] * c1 + forward, forward], [p["l1"] * s1 + up, up]])


def double_bias(p, q, v):
    _, slope = elbow(p, q)
    turn = p["m2"] * p["l1"] * slope
    up = double_jacobian(p, q)[..., 1, :]
    return vector(
        [
            turn * (2 * v[..., 0] + v[..., 1]) * v[..., 1]
            + p["g"] * (p["m1"] * p["r1"] * sin(q[..., 0]) + p["m2"] * up[..., 0]),
            -turn * v[..., 0] ** 2 + p["g"] * p["m2"] * up[..., 1],
        ]
    )


def double_potential(p, q):
    both = q[..., 0] + q[..., 1]
    height = p.get("e", 0) * sin(both) - p["r2"] * cos(both) - p["l1"] * cos(q[..., 0])
    return p["g"] * (p["m2"] * height - p["m1"] * p["r1"] * cos(q[..., 0]))


double_pendulum = Mechanism(
    name="double_pendulum",
    coordinates=("theta1", "theta2"),
    speeds=("omega1", "omega2"),
    inputs=("tau1", "tau2"),
    mass=double_mass,
    bias=double_bias,
    input_map=identity(2),
    kinematics=identity(2),
    potential=double_potential,
    bodies={
        "link1": Body(
            lambda p: p["m1"],
            lambda p, q: matrix([[p["r1"] * cos(q[..., 0]), 0], [p["r1"] * sin(q[..., 0]), 0]]),
        ),
        "link2": Body(lambda p: p["m2"], double_jacobian),
    },
    defaults={"e": 0.0},
)


# Electric unicycle with a rider, two degrees of freedom. The rider's centre may lie forward by e.


def rider_lever(p, q):
    s, c = sin(q[..., 1]), cos(q[..., 1])
    return p["h"] * c - p.get("e", 0) * s, -p["h"] * s - p.get("e", 0) * c


def euc_2dof_mass(p, q):
    forward, _ = rider_lever(p, q)
    coupling = p["m"] * forward
    return matrix(
        [
            [p["m"] + p["m_0"] + p["m_w"] + p["J_w"] / p["R"] ** 2 + added(p, 0), coupling],
            [coupling, p["J"] + p["m"] * (p["h"] ** 2 + p.get("e", 0) ** 2) + added(p, 1)],
        ]
    )


def euc_2dof_bias(p, q, v):
    _, up = rider_lever(p, q)
    return vector([p["m"] * up * v[..., 1] ** 2, p["m"] * p["g"] * up])


def rider_jacobian(p, q):
    forward, up = rider_lever(p, q)
    return matrix([[1, forward], [0, up]])


euc_2dof = Mechanism(
    name="euc_2dof",
    coordinates=("x", "phi"),
    speeds=("v", "phi_dot"),
    inputs=("M_d",),
    mass=euc_2dof_mass,
    bias=euc_2dof_bias,
    input_map=lambda p, q: matrix([[1 / p["R"] + 0 * q[..., 0]], [-1]]),
    kinematics=identity(2),
    potential=lambda p, q: p["m"] * p["g"] * (p["h"] * cos(q[..., 1]) - p.get("e", 0) * sin(q[..., 1])),
    bodies={
        "wheel": Body(lambda p: p["m_w"], lambda p, q: matrix([[1 + 0 * q[..., 0], 0], [0, 0]])),
        "body": Body(lambda p: p["m_0"], lambda p, q: matrix([[1 + 0 * q[..., 0], 0], [0, 0]])),
        "rider": Body(lambda p: p["m"], rider_jacobian),
    },
    defaults={"e": 0.0},
)


# The same with a body that pitches by itself, three degrees of freedom.


def euc_3dof_mass(p, q):
    ga, ph = q[..., 1], q[..., 2]
    lean = p["m"] * p["l_0"] - p["m_0"] * p["h_0"]
    m12 = -lean * cos(ga)
    m13 = p["m"] * p["h"] * cos(ph)
    m23 = -p["m"] * p["h"] * p["l_0"] * cos(ph - ga)
    return matrix(
        [
            [p["m"] + p["m_0"] + p["m_w"] + p["J_w"] / p["R"] ** 2 + added(p, 0), m12, m13],
            [m12, p["J_0"] + p["m_0"] * p["h_0"] ** 2 + p["m"] * p["l_0"] ** 2 + added(p, 1), m23],
            [m13, m23, p["J"] + p["m"] * p["h"] ** 2 + added(p, 2)],
        ]
    )


def euc_3dof_bias(p, q, v):
    ga, ph, dga, dph = q[..., 1], q[..., 2], v[..., 1], v[..., 2]
    lean = p["m"] * p["l_0"] - p["m_0"] * p["h_0"]
    arm = p["m"] * p["h"] * p["l_0"] * sin(ph - ga)
    return vector(
        [
            -p["m"] * p["h"] * dph**2 * sin(ph) + lean * dga**2 * sin(ga),
            arm * dph**2 + lean * p["g"] * sin(ga),
            -arm * dga**2 - p["m"] * p["g"] * p["h"] * sin(ph),
        ]
    )


def euc_3dof_potential(p, q):
    ga, ph = q[..., 1], q[..., 2]
    return p["g"] * (p["m_0"] * p["h_0"] * cos(ga) + p["m"] * (p["h"] * cos(ph) - p["l_0"] * cos(ga)))


def euc_3dof_rider(p, q):
    ga, ph = q[..., 1], q[..., 2]
    return matrix([[1, -p["l_0"] * cos(ga), p["h"] * cos(ph)], [0, p["l_0"] * sin(ga), -p["h"] * sin(ph)]])


euc_3dof = Mechanism(
    name="euc_3dof",
    coordinates=("x", "gamma", "phi"),
    speeds=("v", "gamma_dot", "phi_dot"),
    inputs=("M_d", "M_h"),
    mass=euc_3dof_mass,
    bias=euc_3dof_bias,
    input_map=lambda p, q: matrix([[1 / p["R"] + 0 * q[..., 0], 0], [-1, 1], [0, -1]]),
    kinematics=identity(3),
    potential=euc_3dof_potential,
    bodies={
        "wheel": Body(lambda p: p["m_w"], lambda p, q: matrix([[1 + 0 * q[..., 0], 0, 0], [0, 0, 0]])),
        "body": Body(
            lambda p: p["m_0"],
            lambda p, q: matrix([[1, p["h_0"] * cos(q[..., 1]), 0], [0, -p["h_0"] * sin(q[..., 1]), 0]]),
        ),
        "rider": Body(lambda p: p["m"], euc_3dof_rider),
    },
    defaults={},
)


# Thin disc that rolls, and the unicycle: the disc with a mass that slides along its axle.


def rolling_kinematics(p, q, slider):
    psi, theta = q[..., 2], q[..., 3]
    o, R = 0 * psi, p["R"]
    rows = [
        [R * sin(psi) * cos(theta), R * cos(psi), o],
        [-R * cos(psi) * cos(theta), R * sin(psi), o],
        [o, o, 1 / cos(theta)],
        [1 + o, o, o],
        [o, 1, -tan(theta)],
    ]
    if slider:
        rows = [row + [o] for row in rows] + [[o, o, o, 1]]
    return matrix(rows)


def wheel_mass(p, q):
    k = p["m"] * p["R"] ** 2 / 4 + 0 * q[..., 0]
    return matrix([[5 * k, 0, 0], [0, 6 * k, 0], [0, 0, k]])


def wheel_bias(p, q, v):
    w1, w2, w3, theta = v[..., 0], v[..., 1], v[..., 2], q[..., 3]
    k = p["m"] * p["R"] ** 2 / 4
    return vector(
        [
            k * (w3**2 * tan(theta) - 6 * w2 * w3) - p["m"] * p["g"] * p["R"] * sin(theta),
            4 * k * w1 * w3,
            k * (2 * w1 * w2 - w1 * w3 * tan(theta)),
        ]
    )


def turned(p, q, columns):
    """Vectors given in the tilted frame, one per pseudo-velocity, in ground axes."""
    psi, theta = q[..., 2], q[..., 3]
    to_ground = matrix(
        [
            [cos(psi), -sin(psi) * cos(theta), sin(psi) * sin(theta)],
            [sin(psi), cos(psi) * cos(theta), -cos(psi) * sin(theta)],
            [0, sin(theta), cos(theta)],
        ]
    )
    return to_ground @ matrix(columns)


rolling_wheel = Mechanism(
    name="rolling_wheel",
    coordinates=("x_G", "y_G", "psi", "theta", "phi"),
    speeds=("omega_1", "omega_2", "omega_3"),
    inputs=(),
    mass=wheel_mass,
    bias=wheel_bias,
    input_map=lambda p, q: np.zeros(q.shape[:-1] + (3, 0)),
    kinematics=lambda p, q: rolling_kinematics(p, q, slider=False),
    potential=lambda p, q: p["m"] * p["g"] * p["R"] * cos(q[..., 3]),
    bodies={
        "wheel": Body(
            lambda p: p["m"],
            lambda p, q: turned(p, q, [[0 * q[..., 0], p["R"], 0], [-p["R"], 0, 0], [0, 0, 0]]),
        )
    },
    defaults={},
)


def unicycle_mass(p, q):
    m, m0, R, r = p["m"], p["m0"], p["R"], q[..., 5]
    return matrix(
        [
            [(5 * m * R**2 + 4 * m0 * (R**2 + r**2)) / 4, 0, 0, -m0 * R],
            [0, (3 * m + 2 * m0) * R**2 / 2, -m0 * R * r, 0],
            [0, -m0 * R * r, (m * R**2 + 4 * m0 * r**2) / 4, 0],
            [-m0 * R, 0, 0, m0 + added(p, 5)],
        ]
    )


def unicycle_bias(p, q, v):
    m, m0, R, g, theta, r = p["m"], p["m0"], p["R"], p["g"], q[..., 3], q[..., 5]
    w1, w2, w3, s = (v[..., i] for i in range(4))
    t = tan(theta)
    b1 = (
        2 * w1 * s * m0 * r
        + w3**2 * (m0 * r**2 * t + m0 * R * r + m * R**2 * t / 4)
        - w2 * w3 * (1.5 * m * R**2 + m0 * R**2 + m0 * R * r * t)
    )
    b2 = w1 * w3 * (m * R**2 + m0 * R**2 + m0 * R * r * t) - 2 * w3 * s * m0 * R
    b3 = (
        w1 * w2 * m * R**2 / 2
        - w1 * w3 * (m * R**2 / 4 + m0 * r**2) * t
        - w1 * w3 * m0 * R * r
        + 2 * w3 * s * m0 * r
    )
    b4 = -m0 * (w1**2 * r - w2 * w3 * R + w3**2 * r)
    weight_1 = (m + m0) * g * R * sin(theta) - m0 * g * r * cos(theta)
    return vector([b1 - weight_1, b2, b3, b4 + m0 * g * sin(theta)])


def slider_jacobian(p, q):
    R, r = p["R"], q[..., 5]
    return turned(p, q, [[0 * r, R, -r, 0], [-R, 0, 0, 1], [r, 0, 0, 0]])


unicycle = Mechanism(
    name="unicycle",
    coordinates=("x_G", "y_G", "psi", "theta", "phi", "r"),
    speeds=("omega_1", "omega_2", "omega_3", "sigma"),
    inputs=("u",),
    mass=unicycle_mass,
    bias=unicycle_bias,
    input_map=lambda p, q: matrix([[0 * q[..., 0]], [0], [0], [1]]),
    kinematics=lambda p, q: rolling_kinematics(p, q, slider=True),
    potential=lambda p, q: p["g"]
    * ((p["m"] + p["m0"]) * p["R"] * cos(q[..., 3]) + p["m0"] * q[..., 5] * sin(q[..., 3])),
    bodies={
        "wheel": Body(
            lambda p: p["m"],
            lambda p, q: turned(p, q, [[0 * q[..., 0], p["R"], 0, 0], [-p["R"], 0, 0, 0], [0, 0, 0, 0]]),
        ),
        "slider": Body(lambda p: p["m0"], slider_jacobian),
    },
    defaults={},
)

ALL = {
    m.name: m
    for m in (carriage, pendulum, cart_pole, double_pendulum, euc_2dof, euc_3dof, rolling_wheel, unicycle)
}
