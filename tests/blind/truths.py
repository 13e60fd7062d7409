"""Rigs with more freedom than the model that is declared: gears with play, slipping wheels, a load
that swings. Their first coordinates and speeds are those of the declared mechanism."""

from dataclasses import dataclass
from typing import Callable

import numpy as np
from numpy import cos, sin

from mechanisms import Mechanism, cart_pole, euc_2dof, euc_2dof_bias, unicycle

TURN = 1e-6  # step of the directional derivative of Jacobians; its error is some 1e-10


@dataclass(frozen=True)
class Truth:
    mechanism: Mechanism
    internal: Callable  # force along the speeds of contacts inside, f(p, q, v)
    start: Callable  # values of the further coordinates and speeds at rest against the declared ones


def plain(mechanism):
    zero = np.zeros(len(mechanism.speeds))
    return Truth(mechanism, lambda p, q, v: zero, lambda p, q, v: (q, v))


# A motor behind a gear with play: it carries part of the inertia, and meets the joint across a gap.


def geared(base, coordinate, share, half_gap, stiffness, damping):
    i, n = base.coordinates.index(coordinate), len(base.coordinates)

    def mass(p, q):
        M = np.zeros((n + 1, n + 1))
        M[:n, :n] = base.mass(p, q[:n])
        motor = share * M[i, i]
        M[i, i] -= motor
        M[n, n] = motor
        return M

    def bias(p, q, v):
        return np.append(base.bias(p, q[:n], v[:n]), 0.0)

    def input_map(p, q):
        B = np.vstack([base.input_map(p, q[:n]), np.zeros(len(base.inputs))])
        B[[i, n]] = B[[n, i]]
        return B

    def mesh(p, q, v):
        """The teeth push where the gap is closed; they never pull."""
        twist = q[n] - q[i]
        excess = twist - np.clip(twist, -half_gap, half_gap)
        push = stiffness * excess + damping * (v[n] - v[i]) if excess else 0.0
        push = push if push * excess > 0 else 0.0
        f = np.zeros(n + 1)
        f[i], f[n] = push, -push
        return f

    gear = Mechanism(
        name=f"{base.name} with play",
        coordinates=base.coordinates + ("motor",),
        speeds=base.speeds + ("motor_rate",),
        inputs=base.inputs,
        mass=mass,
        bias=bias,
        input_map=input_map,
        kinematics=lambda p, q: np.eye(n + 1),
        potential=lambda p, q: base.potential(p, q[..., :n]),
        bodies={},
        defaults=base.defaults,
    )
    return Truth(gear, mesh, lambda p, q, v: (np.append(q, q[i]), np.append(v, v[i])))


# Electric unicycle whose wheel slips along its path: the force follows the slip. The odometer counts
# the turns of the wheel, so the declared x is that of the wheel's rim; the axle comes last.


def slipping_euc(compliance):
    rim = [2, 1]  # places of axle and rider among the speeds (rim, rider, axle)

    def mass(p, q):
        M = np.zeros((3, 3))
        M[np.ix_(rim, rim)] = euc_2dof.mass(p, q[rim])
        M[0, 0] = p["J_w"] / p["R"] ** 2
        M[2, 2] -= M[0, 0]
        return M

    def bias(p, q, v):
        h = np.zeros(3)
        h[rim] = euc_2dof_bias(p, q[rim], v[rim])
        return h

    def creep(p, q, v):
        ground_speed = max(abs(v[2]), 0.3)
        load = (p["m"] + p["m_0"] + p["m_w"]) * p["g"]
        force = load * (v[0] - v[2]) / (compliance * ground_speed)
        return np.array([-force, 0.0, force])

    slipping = Mechanism(
        name="euc_2dof that slips",
        coordinates=("rim", "phi", "x"),
        speeds=("rim_speed", "phi_dot", "v"),
        inputs=("M_d",),
        mass=mass,
        bias=bias,
        input_map=lambda p, q: np.array([[1 / p["R"]], [-1.0], [0.0]]),
        kinematics=lambda p, q: np.eye(3),
        potential=lambda p, q: euc_2dof.potential(p, q[..., :2]),
        bodies={},
        defaults=euc_2dof.defaults,
    )
    return Truth(slipping, creep, lambda p, q, v: (np.append(q, q[0]), np.append(v, v[0])))


# Unicycle whose wheel slips sideways: the lateral velocity of the contact is a fifth speed. Derived
# from the Jacobians of bodies, without the formulas of the papers.


def slipping_kinematics(p, q):
    """q' from (ω1, ω2, ω3, σ, slip)."""
    N = np.zeros((6, 5))
    N[:, :4] = unicycle.kinematics(p, q)
    N[0, 4], N[1, 4] = -sin(q[2]), cos(q[2])
    return N


def body_jacobians(p, q):
    """Velocities of wheel centre and slider in the ground, turning of the wheel in the tilted frame."""
    psi, theta, r = q[2], q[3], q[5]
    axle = np.array([-sin(psi) * cos(theta), cos(psi) * cos(theta), sin(theta)])
    centre = np.zeros((3, 6))
    centre[0, 0] = centre[1, 1] = 1.0
    centre[2, 3] = -p["R"] * sin(theta)
    slider = centre.copy()
    slider[:, 2] += r * np.array([-cos(psi) * cos(theta), -sin(psi) * cos(theta), 0.0])
    slider[:, 3] += r * np.array([sin(psi) * sin(theta), -cos(psi) * sin(theta), cos(theta)])
    slider[:, 5] += axle
    turning = np.zeros((3, 6))
    turning[0, 3] = turning[1, 4] = 1.0
    turning[1, 2], turning[2, 2] = sin(theta), cos(theta)
    N = slipping_kinematics(p, q)
    return centre @ N, slider @ N, turning @ N


def slipping_unicycle(compliance):
    def inertia(p):
        return p["m"] * p["R"] ** 2 / 4 * np.diag([1.0, 2.0, 1.0])

    def mass(p, q):
        centre, slider, turning = body_jacobians(p, q)
        M = p["m"] * centre.T @ centre + p["m0"] * slider.T @ slider + turning.T @ inertia(p) @ turning
        M[3, 3] += p.get("added_5", 0.0)
        return M

    def bias(p, q, v):
        rate = slipping_kinematics(p, q) @ v
        here = body_jacobians(p, q)
        ahead, behind = body_jacobians(p, q + TURN * rate), body_jacobians(p, q - TURN * rate)
        extra = [(a - b) @ v / (2 * TURN) for a, b in zip(ahead, behind)]
        frame = np.array([rate[3], rate[2] * sin(q[3]), rate[2] * cos(q[3])])
        momentum = inertia(p) @ here[2] @ v
        weight = p["g"] * (p["m"] * here[0][2] + p["m0"] * here[1][2])
        return (
            p["m"] * here[0].T @ extra[0]
            + p["m0"] * here[1].T @ extra[1]
            + here[2].T @ (inertia(p) @ extra[2] + np.cross(frame, momentum))
            + weight
        )

    def creep(p, q, v):
        ground_speed = max(abs(p["R"] * v[1]), 0.3)
        load = (p["m"] + p["m0"]) * p["g"]
        return np.array([0.0, 0.0, 0.0, 0.0, -load * v[4] / (compliance * ground_speed)])

    slipping = Mechanism(
        name="unicycle that slips",
        coordinates=unicycle.coordinates,
        speeds=unicycle.speeds + ("slip",),
        inputs=unicycle.inputs,
        mass=mass,
        bias=bias,
        input_map=lambda p, q: np.array([[0.0], [0.0], [0.0], [1.0], [0.0]]),
        kinematics=slipping_kinematics,
        potential=unicycle.potential,
        bodies={},
        defaults={},
    )
    return Truth(slipping, creep, lambda p, q, v: (q, np.append(v, 0.0)))


# A carriage below which part of its mass swings on a rope.


def swinging(share, rope, damping):
    def own(p):
        load = share * p["m"]
        return dict(m_cart=p["m"] - load, m_pole=load, l=rope, I=0.0, g=9.81)

    swung = Mechanism(
        name="carriage with a swinging load",
        coordinates=("x", "swing"),
        speeds=("v", "swing_rate"),
        inputs=("F",),
        mass=lambda p, q: cart_pole.mass(own(p), q),
        bias=lambda p, q, v: cart_pole.bias(own(p), q, v),
        input_map=cart_pole.input_map,
        kinematics=cart_pole.kinematics,
        potential=lambda p, q: cart_pole.potential(own(p), q),
        bodies={},
        defaults={},
    )
    return Truth(
        swung,
        lambda p, q, v: np.array([0.0, -damping * v[1]]),
        lambda p, q, v: (np.append(q, 0.0), np.append(v, 0.0)),
    )
