"""What rigs of each kind are like: parameters with tolerances, sensors, typical forces and motions;
typical sizes of effects, and the answers that are right."""

import numpy as np

import truths
from effects import (
    Actuator,
    DryFriction,
    Force,
    Memory,
    Parameter,
    PointForce,
    Richer,
    Sensor,
    Slope,
    SpinFriction,
)

FIXED = ("g", "m_w", "J_w", "J_0", "h_0", "l_0")  # known exactly
TOLERANCE = {"m": 0.02, "l": 0.01, "r": 0.01, "h": 0.01, "I": 0.05, "J": 0.05, "R": 0.004}  # by first letter

RIGS = {
    "carriage": dict(
        about="carriage on a rail, linear encoder, force command logged",
        parameters=dict(m=1.6),
        noise=dict(x=3e-4),
    ),
    "pendulum": dict(
        about="driven pendulum, encoder at the pivot, torque command logged",
        parameters=dict(m=1.2, l=0.35, I=0.02, g=9.81),
        noise=dict(theta=8e-4),
    ),
    "cart_pole": dict(
        about="cart with hanging pole, encoders on cart and pole, force command logged",
        parameters=dict(m_cart=1.5, m_pole=0.35, l=0.4, I=0.012, g=9.81),
        noise=dict(x=3e-4, theta=9e-4),
    ),
    "double_pendulum": dict(
        about="two links with motors and encoders at both joints, torque commands logged",
        parameters=dict(m1=1.1, m2=0.8, l1=0.4, r1=0.2, r2=0.18, I1=0.016, I2=0.01, g=9.81),
        noise=dict(theta1=6e-4, theta2=8e-4),
    ),
    "euc_2dof": dict(
        about="electric unicycle with a rider, odometer and tilt of the rider, torque command logged",
        parameters=dict(m=70.0, m_0=13.0, m_w=3.0, J=12.0, J_w=0.12, R=0.2, h=0.7, g=9.81),
        noise=dict(x=2e-3, phi=1.5e-3),
    ),
    "euc_3dof": dict(
        about="electric unicycle with body and rider, odometer and both tilts, torque commands logged",
        parameters=dict(
            m=68.0, m_0=13.0, m_w=3.0, J=12.0, J_0=0.5, J_w=0.12, R=0.2, h=0.7, h_0=0.075, l_0=0.05, g=9.81
        ),
        noise=dict(x=2e-3, gamma=1.5e-3, phi=1.5e-3),
    ),
    "rolling_wheel": dict(
        about="disc that rolls freely, pose tracked by cameras",
        parameters=dict(m=6.0, R=0.3, g=9.81),
        noise=dict(x_G=1e-3, y_G=1e-3, psi=1e-3, theta=5e-4, phi=2e-3),
    ),
    "unicycle": dict(
        about="unicycle steered by a sliding mass, pose tracked by cameras, slider encoder, force command logged",
        parameters=dict(m=10.0, m0=5.0, R=0.3, g=9.81),
        noise=dict(x_G=1e-3, y_G=1e-3, psi=1e-3, theta=5e-4, phi=1.5e-3, r=2e-4),
    ),
}

UNITS = {
    **{name: "kg" for name in ("m", "m0", "m1", "m2", "m_cart", "m_pole", "m_0", "m_w")},
    **{name: "kg m^2" for name in ("I", "I1", "I2", "J", "J_0", "J_w")},
    **{name: "m" for name in ("l", "l1", "r1", "r2", "R", "h", "h_0", "l_0", "x", "x_G", "y_G", "r")},
    **{name: "rad" for name in ("theta", "theta1", "theta2", "phi", "gamma", "psi")},
    **{name: "N m" for name in ("tau", "tau1", "tau2", "M_d", "M_h")},
    **{"F": "N", "u": "N", "g": "m/s^2"},
}


def tolerance(name, value):
    return 0.0 if name in FIXED else TOLERANCE[name[0]] * value


def forces(name, p):
    """Typical force along each pseudo-velocity."""
    g = 9.81
    return {
        "carriage": lambda: [1.5 * p["m"]],
        "pendulum": lambda: [0.45 * p["m"] * g * p["l"]],
        "cart_pole": lambda: [2 * (p["m_cart"] + p["m_pole"]), 0.1 * p["m_pole"] * g * p["l"]],
        "double_pendulum": lambda: [
            0.4 * g * (p["m1"] * p["r1"] + p["m2"] * p["l1"]),
            0.35 * g * p["m2"] * p["r2"],
        ],
        "euc_2dof": lambda: [60.0, 15.0],
        "euc_3dof": lambda: [60.0, 3.0, 15.0],
        "rolling_wheel": lambda: [1.0, 1.0, 0.4],
        "unicycle": lambda: [1.5, 1.5, 0.6, 5.0],
    }[name]()


# Typical amplitudes of coordinates and of their rates.
MOTION = {
    "carriage": dict(x=(0.3, 0.5)),
    "pendulum": dict(theta=(0.5, 2.0)),
    "cart_pole": dict(x=(0.2, 0.5), theta=(0.4, 2.0)),
    "double_pendulum": dict(theta1=(0.4, 1.5), theta2=(0.4, 2.0)),
    "euc_2dof": dict(x=(10.0, 2.0), phi=(0.1, 0.3)),
    "euc_3dof": dict(x=(10.0, 2.0), gamma=(0.2, 1.0), phi=(0.1, 0.3)),
    "rolling_wheel": dict(phi=(30.0, 9.0), theta=(0.1, 0.3)),
    "unicycle": dict(phi=(30.0, 7.0), theta=(0.05, 0.3), r=(0.03, 0.2)),
}


def coordinate_of(mechanism, site):
    """The coordinate at which an effect on a wheel or a body is felt most."""
    if site in mechanism.coordinates:
        return site
    return (
        "phi"
        if mechanism.name in ("unicycle", "rolling_wheel")
        else mechanism.coordinates[-1 if site in ("pole", "link2") else 0]
    )


def make(mechanism, p, kind, site, size, law="library", peak=1.0, rng=None):
    """An effect. Sizes are relative to what is typical of the rig: 1 is small and to be noticed."""
    at = coordinate_of(mechanism, site)
    amplitude, rate = MOTION[mechanism.name].get(at, (1.0, 1.0))
    index = min(mechanism.coordinates.index(at), len(mechanism.speeds) - 1)
    index = (
        {"r": 3, "phi": 1, "theta": 0}.get(at, 0)
        if mechanism.name in ("unicycle", "rolling_wheel")
        else index
    )
    force = 0.02 * forces(mechanism.name, p)[index]
    inertia = mechanism.mass(p, np.zeros(len(mechanism.coordinates)))[index, index]
    wheel = mechanism.name in ("unicycle", "rolling_wheel")
    name = mechanism.name

    if kind.startswith("actuator"):
        unit = {
            "gain": 0.03,
            "bias": 0.02 * peak,
            "lag": 0.01,
            "delay": 0.005,
            "saturation": peak,
            "dead_zone": 0.02 * peak,
        }
        return Actuator(kind, site, size * unit[kind[9:]], law)
    if kind.startswith("sensor"):
        unit = {
            "sensor_bias": 2 * RIGS[name]["noise"].get(site, 1e-3),
            "sensor_scale": 0.005,
            "sensor_delay": 0.003,
        }
        return Sensor(kind, site, size * unit[kind])
    if kind in ("parameter_error", "added_inertia", "mass_offset"):
        unit = {"parameter_error": 0.08, "added_inertia": 0.05 * inertia, "mass_offset": 0.002}
        return Parameter(kind, site, size * unit[kind], mechanism)
    if law == "lugre" or kind == "hysteresis":
        width = 0.01 * amplitude if law == "lugre" else 0.3 * amplitude
        return Memory(kind, site, size * force, law, width)
    if kind in ("coulomb_friction", "stribeck_friction"):
        asymmetry = 0.3 if law == "asymmetric" else 0.0
        return DryFriction(kind, site, size * force, law, 0.2 * rate, rate, asymmetry)
    if kind == "ground_slope":
        return Slope(0.002 * size)
    if kind == "spin_friction":
        return SpinFriction(0.02 * size)
    if kind in ("quadratic_drag", "constant_force", "gust"):
        speed = rate * (p["R"] if wheel else 1.0 if UNITS[at] == "m" else p.get("l", p.get("l1", 1.0)))
        drag = force / (p["R"] if wheel else 1.0 if UNITS[at] == "m" else p.get("l", p.get("l1", 1.0)))
        unit = drag if kind == "constant_force" else drag / speed**2
        wind = gusts(rng) if kind == "gust" else None
        return PointForce(kind, site, size * unit, law, wind)
    if kind == "backlash":
        return Richer(kind, site, size * 0.01 * amplitude, play(mechanism, p, site, inertia))
    if kind == "longitudinal_slip":
        return Richer(kind, site, size * 0.01, truths.slipping_euc)
    if kind == "lateral_slip":
        return Richer(kind, site, size * 0.03, truths.slipping_unicycle)
    if kind == "payload":
        return Richer(kind, site, size * 0.06, lambda share: truths.swinging(share, 0.3, 0.002 * p["m"]))
    lever = 1 / p["R"] if kind == "rolling_resistance" and name == "euc_2dof" else 1.0
    unit = {
        "viscous_friction": force / rate,
        "thermal_drift": force / rate,
        "spring": force / amplitude,
        "hardening": force / amplitude**3,
        "rolling_resistance": force / lever,
    }.get(kind, force)
    felt = at if site not in mechanism.coordinates else None
    return Force(kind, site, size * unit, law, felt, lever, pitch=0.4 * amplitude)


def play(mechanism, p, site, inertia):
    """A gear whose teeth are stiff: a contact rings at some 60 Hz and dies within two periods."""
    motor = 0.12 * inertia
    stiffness = motor * (2 * np.pi * 60) ** 2
    damping = 0.25 * 2 * np.sqrt(stiffness * motor)
    return lambda half_gap: truths.geared(mechanism, site, 0.12, half_gap, stiffness, damping)


def gusts(rng):
    """Wind that comes and goes within seconds."""
    wind = np.zeros(2000)
    for k in range(1, len(wind)):
        wind[k] = 0.99 * wind[k - 1] + rng.normal(0, 0.3)
    return wind


# Answers.

FAMILY = {
    "rolling_resistance": "force",
    "spin_friction": "force",
    "quadratic_drag": "force",
    "constant_force": "force",
    "ground_slope": "force",
    "spring": "force",
    "backlash": "joint",
    "added_inertia": "parameter",
    "mass_offset": "parameter",
    "parameter_error": "parameter",
    "lateral_slip": "constraint",
    "longitudinal_slip": "constraint",
}


def family(kind):
    head = kind.split("_")[0]
    return FAMILY.get(kind) or {"actuator": "actuator", "sensor": "sensor"}.get(head, "force")


def domains(kind):
    return ["actuator", "constraint", "force"] if kind == "backlash" else [family(kind)]


# What no recording can tell apart, by mechanism and effect, and other names of the same law.
TWINS = {
    ("carriage", "actuator_bias"): ["constant_force@[^@]*", "ground_slope@gravity"],
    ("pendulum", "sensor_bias"): ["ground_slope@gravity", "mass_offset@[^@]*", "constant_force@[^@]*"],
    ("cart_pole", "mass_offset"): ["sensor_bias@theta"],
    ("double_pendulum", "mass_offset"): ["sensor_bias@theta2"],
    ("euc_2dof", "sensor_bias"): ["mass_offset@rider"],
    ("euc_2dof", "rolling_resistance"): ["coulomb_friction@(x|v)", "constant_force@(wheel|body)"],
    ("unicycle", "rolling_resistance"): ["coulomb_friction@(phi|omega_2)"],
    ("rolling_wheel", "rolling_resistance"): ["coulomb_friction@(phi|omega_2)"],
    ("double_pendulum", "added_inertia"): ["parameter_error@I1"],
}
LAWS = {
    "lugre": ["stribeck_friction"],
    "asymmetric": ["stribeck_friction"],
    "second_order": ["actuator_delay"],
}
ONE_PLACE = ("rolling_resistance", "spin_friction", "lateral_slip", "longitudinal_slip", "backlash")


def accept(mechanism, kind, site, law):
    """Regular expressions of the right answers."""
    sites = {site}
    if site in mechanism.coordinates:
        rate = coordinate_equation(mechanism, site)
        sites |= {rate, "joint[^@]*"} if not kind.startswith("sensor") else set()
    where = "[^@]*" if kind in ONE_PLACE else "(" + "|".join(sorted(sites)) + ")"
    kinds = [kind] + LAWS.get(law, [])
    return [f"{k}@{where}" for k in kinds] + TWINS.get((mechanism.name, kind), [])


def coordinate_equation(mechanism, coordinate):
    if mechanism.name in ("unicycle", "rolling_wheel"):
        return {"theta": "omega_1", "phi": "omega_2", "psi": "omega_3", "r": "sigma"}[coordinate]
    return mechanism.speeds[mechanism.coordinates.index(coordinate)]


def equations(mechanism, kind, site):
    """Equations in which the effect acts, if it acts as a force there."""
    if family(kind) == "actuator":
        column = mechanism.input_map({"R": 1.0}, np.zeros(len(mechanism.coordinates)))[
            :, mechanism.inputs.index(site)
        ]
        return [speed for speed, entry in zip(mechanism.speeds, column) if entry]
    if family(kind) not in ("force", "joint"):
        return None
    if site in mechanism.coordinates:
        return [coordinate_equation(mechanism, site)]
    if kind in ("rolling_resistance", "spin_friction") or mechanism.name == "unicycle":
        both = {"rolling_resistance": ["omega_2"], "spin_friction": ["omega_2", "omega_3"]}
        return both.get(kind, ["omega_1", "omega_2"]) if mechanism.name != "euc_2dof" else ["v"]
    if site in ("carriage", "cart"):
        return ["v"]
    return list(mechanism.speeds)
