"""Robots of random dimensions as MJCF files."""

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

import mujoco
import numpy as np

# Step of the files, in seconds.
STEP = 0.0005


def text(values):
    return " ".join(f"{value:.4g}" for value in np.atleast_1d(values))


def written(root):
    """A file's text."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


@dataclass
class Robot:
    """A file and how it is moved: rest angles, amplitudes of the wanted motion, whether torques are commanded."""

    name: str
    description: str
    root: ET.Element
    home: dict
    reach: dict
    torques: bool
    tip: str
    links: list
    tolerances: dict = field(default_factory=dict)

    def joints(self):
        return [joint.get("name") for joint in self.root.iter("joint") if joint.get("name")]

    def drives(self):
        """Actuator -> its joint."""
        return {drive.get("name"): drive.get("joint") for drive in self.root.find("actuator")}


class Builder:
    """Puts a file together, body by body."""

    def __init__(self, rng, name):
        self.rng = rng
        self.root = ET.Element("mujoco", model=name)
        ET.SubElement(self.root, "compiler", angle="radian", autolimits="true")
        ET.SubElement(self.root, "option", timestep=str(STEP), integrator="RK4")
        default = ET.SubElement(self.root, "default")
        ET.SubElement(default, "geom", contype="0", conaffinity="0")
        ET.SubElement(default, "joint", solreffriction="0.004 1")
        self.world = ET.SubElement(self.root, "worldbody")
        self.actuator = ET.SubElement(self.root, "actuator")
        self.home, self.reach, self.links = {}, {}, []

    def link(self, parent, name, place, length, mass, along=(0, 0, 1)):
        """A rod from its origin along an axis, not quite straight."""
        rng, along = self.rng, np.array(along, float)
        body = ET.SubElement(parent, "body", name=name, pos=text(place))
        across, lengthwise = mass * length**2 / 11, mass * (0.16 * length) ** 2
        inertia = np.where(along > 0, lengthwise, across) * rng.uniform(0.9, 1.1, 3)
        centre = 0.5 * length * along * rng.uniform(0.8, 1.1) + 0.03 * length * rng.normal(size=3)
        ET.SubElement(body, "inertial", pos=text(centre), mass=text(mass), diaginertia=text(inertia))
        ET.SubElement(body, "geom", type="capsule", fromto=text([0, 0, 0, *(length * along)]), size=text(0.12 * length))
        self.links.append(name)
        return body

    def joint(self, body, name, axis, home, reach, kind="hinge", limits=(-2.9, 2.9)):
        first = list(body).index(body.find("inertial")) + 1
        joint = ET.Element("joint", name=name, type=kind, axis=axis, **({"range": text(limits)} if limits else {}))
        body.insert(first, joint)
        self.home[name], self.reach[name] = home, reach
        return joint

    def inertias(self):
        """Joint -> inertia at home, without drives; joint -> torque of gravity there."""
        model = mujoco.MjModel.from_xml_string(written(self.root))
        data = mujoco.MjData(model)
        for name, angle in self.home.items():
            data.qpos[model.joint(name).qposadr[0]] = angle
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        dofs = {name: model.joint(name).dofadr[0] for name in self.home}
        # About its own length a link has next to no inertia; its drive has some, and in other poses the arm has more.
        hinges = [d for d in dofs.values() if model.jnt_type[model.dof_jntid[d]] == mujoco.mjtJoint.mjJNT_HINGE]
        least = {d: 0.08 * full[hinges, hinges].max() if d in hinges else 0.0 for d in dofs.values()}
        return {n: max(full[d, d], least[d]) for n, d in dofs.items()}, {n: abs(data.qfrc_bias[d]) for n, d in dofs.items()}

    def drive(self, torques, passive=(), stiff=(22, 40)):
        """Armatures, dampings and frictions of the joints, and their motors or servos."""
        rng = self.rng
        inertia, weight = self.inertias()
        for joint in [j for j in self.root.iter("joint") if j.get("name")]:
            name = joint.get("name")
            typical = inertia[name] * self.reach[name] * 12 + 0.5 * weight[name]
            if name not in passive:
                joint.set("armature", text(rng.uniform(0.2, 0.9) * inertia[name]))
            if rng.random() < 0.6 or name in passive:
                joint.set("damping", text(rng.uniform(0.1, 0.6) * inertia[name] * (0.5 if name in passive else 1)))
            if rng.random() < 0.4 and name not in passive:
                joint.set("frictionloss", text(rng.uniform(0.02, 0.08) * typical))
            if name in passive:
                continue
            whole = inertia[name] + float(joint.get("armature"))
            limit = 2.5 * (weight[name] + typical) + 250 * whole * self.reach[name]
            if torques:
                gear = rng.choice([1.0, 6.0, 9.0, 30.0])
                ET.SubElement(self.actuator, "motor", name=f"{name}_motor", joint=name, gear=text(gear), ctrlrange=text([-limit / gear, limit / gear]))
            else:
                rate = rng.uniform(*stiff)
                kv = whole * rate * rng.uniform(1.0, 1.6)
                ET.SubElement(self.actuator, "position", name=f"{name}_servo", joint=name, kp=text(whole * rate**2), kv=text(kv), forcerange=text([-limit, limit]))

    def robot(self, description, torques, tip):
        return Robot(self.root.get("model"), description, self.root, self.home, self.reach, torques, tip, self.links)


def arm(rng, count, torques):
    """A serial arm."""
    kind = "torque" if torques else "servo"
    built = Builder(rng, f"{kind}_arm{count}")
    length, parent, place = rng.uniform(0.14, 0.4), built.world, [0, 0, 0.1]
    density, lean = rng.uniform(8, 30), 1 if rng.random() < 0.5 else -1
    for index in range(count):
        own = length * rng.uniform(0.8, 1.1) * (0.5 if index == 0 else 0.85 ** (index - 1))
        axis = "0 0 1" if index == 0 or (index >= 3 and index % 2) else "0 1 0"
        body = built.link(parent, f"link{index + 1}", place, own, density * own * 0.9**index)
        home = rng.uniform(0.3, 0.7) * lean if axis == "0 1 0" else rng.uniform(-0.4, 0.4)
        built.joint(body, f"j{index + 1}", axis, home, rng.uniform(0.3, 0.5))
        parent, place, lean = body, [0, 0, own], lean if rng.random() < 0.6 else -lean
    built.drive(torques)
    told = "motors commanded by a tracking controller" if torques else "goal positions logged"
    return built.robot(f"arm of {count} joints, {told}", torques, f"link{count}")


def gantry(rng):
    """Two slides, a wrist and a sliding finger."""
    built = Builder(rng, "gantry")
    mass, length = rng.uniform(0.8, 3), rng.uniform(0.15, 0.3)
    bridge = built.link(built.world, "bridge", [0, 0, 1], length, mass, (1, 0, 0))
    built.joint(bridge, "cross", "1 0 0", 0.0, rng.uniform(0.1, 0.2), "slide", (-0.6, 0.6))
    column = built.link(bridge, "column", [0.05, 0, 0], 0.8 * length, 0.6 * mass)
    built.joint(column, "lift", "0 0 1", 0.1, rng.uniform(0.08, 0.15), "slide", (-0.4, 0.6))
    hand = built.link(column, "hand", [0, 0, -0.1], 0.7 * length, 0.3 * mass, (1, 0, 0))
    built.joint(hand, "wrist", "0 1 0", 0.3, rng.uniform(0.4, 0.7))
    finger = built.link(hand, "finger", [0.7 * length, 0, 0], 0.4 * length, 0.12 * mass, (1, 0, 0))
    built.joint(finger, "jaw", "0 0 1", 0.02, 0.02, "slide", (-0.08, 0.1))
    built.drive(False)
    return built.robot("gantry with a gripper, goal positions logged", False, "finger")


def leg(rng):
    """Abduction, hip and knee with a foot."""
    built = Builder(rng, "leg")
    length, mass, torques = rng.uniform(0.16, 0.28), rng.uniform(0.5, 1.3), rng.random() < 0.5
    side = built.link(built.world, "side", [0.2, 0.05, 0.5], 0.4 * length, mass, (0, 1, 0))
    built.joint(side, "abduction", "1 0 0", 0.1, rng.uniform(0.2, 0.35))
    thigh = built.link(side, "thigh", [0, 0.4 * length, 0], length, mass)
    built.joint(thigh, "hip", "0 1 0", math.pi - 0.7, rng.uniform(0.3, 0.5), limits=(-1, 5))
    shank = built.link(thigh, "shank", [0, 0, length], length, 0.35 * mass)
    built.joint(shank, "knee", "0 1 0", 1.3, rng.uniform(0.3, 0.5))
    foot = ET.SubElement(shank, "body", name="foot", pos=text([0, 0, length]))
    small = 0.07 * mass
    ET.SubElement(foot, "inertial", pos="0 0 0.004", mass=text(small), diaginertia=text(small * 3e-4 * np.ones(3)))
    built.drive(torques)
    return built.robot("one leg on a stand", torques, "shank")


def crane(rng):
    """A cart with a hanging arm that is not driven, and a winch arm."""
    built = Builder(rng, "crane")
    mass, length = rng.uniform(1, 4), rng.uniform(0.2, 0.5)
    cart = built.link(built.world, "cart", [0, 0, 1.5], 0.2, mass, (1, 0, 0))
    built.joint(cart, "rail", "1 0 0", 0.0, rng.uniform(0.15, 0.25), "slide", (-1, 1))
    boom = built.link(cart, "boom", [0, 0, 0], length, 0.4 * mass)
    built.joint(boom, "boom_tilt", "0 1 0", math.pi - 0.5, rng.uniform(0.3, 0.5), limits=(0.5, 5.5))
    load = built.link(boom, "load", [0, 0, length], 0.7 * length, 0.2 * mass)
    built.joint(load, "swing", "0 1 0", 0.5, 0.3, limits=None)
    built.drive(rng.random() < 0.4, passive=("swing",))
    torques = built.actuator[0].tag == "motor"
    return built.robot("cart with a boom and a hanging load that nothing drives", torques, "load")


KINDS = [
    *(lambda rng, n=n: arm(rng, n, False) for n in (4, 2, 6, 3, 7, 5)),
    *(lambda rng, n=n: arm(rng, n, True) for n in (3, 2, 4, 6)),
    gantry, leg, crane, leg,
]
