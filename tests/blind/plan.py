"""The cases: which rig, what it has that the model lacks, and how large that is.

A size is a rung of d', sized by the oracle, or `field`: as rigs have it, whatever d' it makes."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    mechanism: str
    kind: str  # null, single, compound, mismatch, off_library
    effects: tuple = ()  # (kind, site, law)
    level: object = None  # rung of d', or "field"
    null_kind: str = None
    size: float = None  # in units of `catalogue.typical`, for the level "field"
    simulator: str = "scipy"
    colour: bool = False
    irregular: bool = False
    dropouts: bool = False


def null(mechanism, null_kind, **more):
    return Case(mechanism, "null", null_kind=null_kind, **more)


def single(mechanism, effect, level, **more):
    kind, site = effect.split("@")
    return Case(mechanism, "single", ((kind, site, "library"),), level, **more)


def mismatch(mechanism, effect, law, level, **more):
    kind, site = effect.split("@")
    return Case(mechanism, "mismatch", ((kind, site, law),), level, **more)


def off(mechanism, effect, level, **more):
    kind, site = effect.split("@")
    return Case(mechanism, "off_library", ((kind, site, "library"),), level, **more)


def pair(mechanism, first, second, level=25, **more):
    effects = tuple((*e.split("@"), "library") for e in (first, second))
    return Case(mechanism, "compound", effects, level, **more)


NULLS = [
    null("carriage", "clean"),
    null("pendulum", "clean", simulator="mujoco"),
    null("unicycle", "clean"),
    null("euc_3dof", "clean", irregular=True),
    null("cart_pole", "nominal_off", simulator="mujoco"),
    null("double_pendulum", "nominal_off"),
    null("euc_2dof", "nominal_off"),
    null("rolling_wheel", "nominal_off"),
    null("carriage", "disturbance", colour=True),
    null("cart_pole", "disturbance"),
    null("unicycle", "disturbance"),
    null("euc_2dof", "disturbance", dropouts=True),
    null("pendulum", "noise_x0.5"),
    null("double_pendulum", "noise_x0.5", simulator="mujoco"),
    null("euc_2dof", "noise_x0.5", irregular=True),
    null("cart_pole", "noise_x2", dropouts=True),
    null("double_pendulum", "noise_x2"),
    null("unicycle", "noise_x2"),
]

FORCES = [
    single("cart_pole", "viscous_friction@x", 5),
    single("double_pendulum", "viscous_friction@theta2", 40, simulator="mujoco"),
    single("unicycle", "viscous_friction@r", 15),
    single("carriage", "coulomb_friction@x", 40, irregular=True),
    single("pendulum", "coulomb_friction@theta", 8, simulator="mujoco"),
    single("double_pendulum", "coulomb_friction@theta1", 15),
    single("carriage", "stribeck_friction@x", "field", size=4.0),
    single("pendulum", "stribeck_friction@theta", 40),
    single("cart_pole", "spring@x", 15, simulator="mujoco"),
    single("double_pendulum", "spring@theta2", 8),
    single("unicycle", "rolling_resistance@wheel", 15),
    single("rolling_wheel", "rolling_resistance@wheel", 40),
    single("euc_2dof", "rolling_resistance@wheel", 15),
    single("unicycle", "spin_friction@wheel", 8),
    single("rolling_wheel", "spin_friction@wheel", 15),
    single("carriage", "quadratic_drag@carriage", 8),
    single("euc_2dof", "quadratic_drag@rider", 15),
    single("cart_pole", "quadratic_drag@cart", 40, dropouts=True),
    single("double_pendulum", "constant_force@link2", 15),
    single("cart_pole", "ground_slope@gravity", 8),
    single("euc_3dof", "ground_slope@gravity", 15),
]

PARAMETERS = [
    single("pendulum", "parameter_error@l", 15),
    single("cart_pole", "parameter_error@m_pole", 40, simulator="mujoco"),
    single("euc_2dof", "parameter_error@h", 8),
    single("unicycle", "parameter_error@m0", 15),
    single("cart_pole", "mass_offset@pole", 8),
    single("double_pendulum", "mass_offset@link2", 15),
    single("double_pendulum", "added_inertia@theta1", 15, simulator="mujoco"),
    single("unicycle", "added_inertia@r", 15),
]

ACTUATORS = [
    single("cart_pole", "actuator_gain@F", 15),
    single("double_pendulum", "actuator_gain@tau2", 8, irregular=True),
    single("pendulum", "actuator_bias@tau", 15, simulator="mujoco"),
    single("unicycle", "actuator_bias@u", 5),
    single("carriage", "actuator_lag@F", 40),
    single("euc_2dof", "actuator_lag@M_d", 15),
    single("double_pendulum", "actuator_delay@tau1", 15),
    single("unicycle", "actuator_delay@u", "field", size=1.5),
    single("carriage", "actuator_saturation@F", "field", size=0.85, simulator="mujoco"),
    single("double_pendulum", "actuator_saturation@tau1", "field", size=0.8),
    single("cart_pole", "actuator_dead_zone@F", 8),
    single("euc_3dof", "actuator_dead_zone@M_h", 15),
]

JOINTS_AND_CONTACTS = [
    single("pendulum", "backlash@theta", "field", size=1.0),
    single("cart_pole", "backlash@x", "field", size=1.0),
    single("euc_2dof", "longitudinal_slip@contact", "field", size=6.0),
    single("unicycle", "lateral_slip@contact", "field", size=1.0),
]

SENSORS = [
    single("carriage", "sensor_delay@x", 15),
    single("double_pendulum", "sensor_delay@theta2", 8),
    single("pendulum", "sensor_bias@theta", 8),
    single("euc_2dof", "sensor_bias@phi", 15),
    single("unicycle", "sensor_scale@theta", 15),
    single("double_pendulum", "sensor_scale@theta1", 15, simulator="mujoco"),
]

PAIRS = [
    pair("carriage", "coulomb_friction@x", "actuator_bias@F"),
    pair("pendulum", "viscous_friction@theta", "actuator_dead_zone@tau"),
    pair("cart_pole", "coulomb_friction@x", "viscous_friction@theta"),
    pair("cart_pole", "actuator_delay@F", "spring@theta", simulator="mujoco"),
    pair("double_pendulum", "viscous_friction@theta1", "actuator_bias@tau2"),
    pair("unicycle", "viscous_friction@r", "sensor_bias@theta"),
]

MISMATCHES = [
    mismatch("carriage", "coulomb_friction@x", "lugre", 40),
    mismatch("pendulum", "coulomb_friction@theta", "lugre", 15),
    mismatch("double_pendulum", "coulomb_friction@theta1", "asymmetric", 25),
    mismatch("carriage", "quadratic_drag@carriage", "power_1.8", 25),
    mismatch("euc_2dof", "quadratic_drag@rider", "power_1.8", 25),
    mismatch("cart_pole", "actuator_lag@F", "second_order", 25),
    mismatch("unicycle", "actuator_lag@u", "second_order", 25),
    mismatch("pendulum", "actuator_saturation@tau", "soft", "field", size=0.9),
]

OFF_LIBRARY = [
    off("carriage", "ripple@x", 25),
    off("cart_pole", "ripple@x", 15),
    off("pendulum", "cogging@theta", 25),
    off("double_pendulum", "cogging@theta1", 15),
    off("carriage", "hysteresis@x", 40),
    off("pendulum", "hardening@theta", 25),
    off("carriage", "payload@carriage", "field", size=0.2),
    off("euc_2dof", "gust@rider", 25),
    off("double_pendulum", "hysteresis@theta2", 25),
    off("cart_pole", "thermal_drift@x", 25),
]

CASES = (
    NULLS + FORCES + PARAMETERS + ACTUATORS + JOINTS_AND_CONTACTS + SENSORS + PAIRS + MISMATCHES + OFF_LIBRARY
)
