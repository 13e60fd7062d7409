"""Effects by their names: how a file changes with a size, what counts as naming them, which numbers change."""

import copy
import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, field

import numpy as np

import make_laws
from make_robots import text


@dataclass
class Truth:
    """The robot that is recorded: its file, and what the file does not say."""

    root: ET.Element
    laws: list = field(default_factory=list)
    scales: dict = field(default_factory=dict)
    lags: dict = field(default_factory=dict)
    zones: dict = field(default_factory=dict)

    def with_effect(self, effect, size):
        changed = Truth(copy.deepcopy(self.root), list(self.laws), dict(self.scales), dict(self.lags), dict(self.zones))
        effect.apply(changed, size)
        return changed

    def find(self, tag, name):
        return next(element for element in self.root.iter(tag) if element.get("name") == name)

    def drive(self, name):
        return next(drive for drive in self.root.find("actuator") if drive.get("name") == name)


@dataclass
class Effect:
    """One effect: `apply(truth, size)`, the first size tried and the largest, its label."""

    name: str
    apply: object
    guess: float
    limit: float
    accept: dict
    written: list
    unit: str
    mjcf: bool = True
    named: bool = True


def number(element, attribute, default=0.0):
    return float(element.get(attribute, default))


def raise_by(element, attribute, size):
    element.set(attribute, f"{number(element, attribute) + size:.7g}")


def scale_by(element, attribute, factor):
    values = [float(word) for word in element.get(attribute).split()]
    element.set(attribute, " ".join(f"{factor * value:.7g}" for value in values))


def general(truth, name):
    """A drive as a general actuator."""
    drive = truth.drive(name)
    if drive.tag == "position":
        kp, kv = drive.attrib.pop("kp"), drive.attrib.pop("kv")
        drive.set("gainprm", kp)
        drive.set("biastype", "affine")
        drive.set("biasprm", f"0 -{kp} -{kv}")
    drive.tag = "general"
    return drive


def any_of(*patterns, also=()):
    return {"any": list(patterns), "also": list(also)}


def at_joint(kind, attribute, joint, drive, servo, guess, limit, unit):
    """A number of a joint that grows."""
    patterns = [f"{kind}@({joint}|{joint}_pos)", rf"parameter_error@{joint}\.{attribute}"]
    if attribute == "damping" and servo:
        patterns.append(rf"parameter_error@{drive}\.kv")
    return Effect(f"{kind}@{joint}", lambda truth, size: raise_by(truth.find("joint", joint), attribute, size), guess, limit,
                  any_of(*patterns), [["joint", joint, attribute]], unit)


def spring(joint, home, guess, limit):
    def apply(truth, size):
        truth.find("joint", joint).set("stiffness", f"{size:.7g}")
        truth.find("joint", joint).set("springref", f"{home:.5g}")

    written = [["joint", joint, "stiffness"], ["joint", joint, "springref"]]
    return Effect(f"spring@{joint}", apply, guess, limit, any_of(f"spring@{joint}", rf"parameter_error@{joint}\.(stiffness|springref)"),
                  written, "N*m/rad")


def backlash(joint):
    def apply(truth, size):
        body = next(b for b in truth.root.iter("body") if any(j.get("name") == joint for j in b.findall("joint")))
        own = truth.find("joint", joint)
        play = ET.Element("joint", name=f"{joint}_play", type=own.get("type"), axis=own.get("axis"), range=f"{-size / 2:.7g} {size / 2:.7g}",
                          solreflimit="0.002 1", armature="0", damping="0", frictionloss="0")
        body.insert(list(body).index(own) + 1, play)

    return Effect(f"backlash@{joint}", apply, 0.004, 0.05, any_of(f"backlash@{joint}"), [["joint", joint, "backlash"]], "rad")


def drive_gain(name, servo, sign):
    def apply(truth, size):
        for attribute in ("kp", "kv", "forcerange") if servo else ("gear",):
            scale_by(truth.drive(name), attribute, 1 + sign * size)

    accept = any_of(f"actuator_gain@{name}", *([] if servo else [rf"parameter_error@{name}\.(gear|gain)"]))
    written = [["actuator", name, a] for a in (("kp", "kv") if servo else ("gear",))]
    return Effect(f"actuator_gain@{name}", apply, 0.1, 0.4, accept, written, "relative")


def drive_bias(name, guess, limit, sign):
    def apply(truth, size):
        drive = general(truth, name)
        drive.set("biastype", "affine")
        words = drive.get("biasprm", "0 0 0").split()
        drive.set("biasprm", " ".join([f"{sign * size:.7g}", *words[1:]]))

    return Effect(f"actuator_bias@{name}", apply, guess, limit, any_of(f"actuator_bias@{name}", rf"parameter_error@{name}\.bias"),
                  [["actuator", name, "bias"]], "N*m")


def lag(name):
    def apply(truth, size):
        drive = general(truth, name)
        drive.set("dyntype", "filterexact")
        drive.set("dynprm", f"{size:.7g}")

    return Effect(f"actuator_lag@{name}", apply, 0.02, 0.12, any_of(f"actuator_lag@{name}", rf"parameter_error@{name}\.timeconst"),
                  [["actuator", name, "timeconst"]], "s")


def delayed(names, step):
    def apply(truth, size):
        for name in names:
            truth.drive(name).set("delay", f"{size:.7g}")
            truth.drive(name).set("nsample", str(math.ceil(size / step)))

    written = [["actuator", name, "delay"] for name in names]
    if len(names) == 1:
        accept = any_of(f"actuator_delay@{names[0]}", rf"parameter_error@{names[0]}\.delay")
        return Effect(f"actuator_delay@{names[0]}", apply, 0.01, 0.06, accept, written, "s")
    accept = {"all": ["(actuator_delay@.*|sensor_delay@.*)"], "n": len(names), "word": ["actuator_delay@drives", "sensor_delay@drives"]}
    return Effect("actuator_delay@drives", apply, 0.01, 0.05, accept, written, "s")


def everywhere(kind, attribute, joints, typical, limit):
    """The same law at all drives, of a size that goes with each joint."""
    def apply(truth, size):
        for joint, own in zip(joints, typical):
            raise_by(truth.find("joint", joint), attribute, size * own)

    accept = {"all": [rf"({kind}@.*|parameter_error@.*\.{attribute})"], "n": len(joints), "word": [f"{kind}@drives"]}
    return Effect(f"{kind}@drives", apply, 0.03, limit, accept, [["joint", j, attribute] for j in joints], "of what is typical of each joint")


def saturation(name, strongest):
    """A limit of the force that is lower, the more so the larger the size."""
    def apply(truth, size):
        limit = strongest * (1 - size)
        truth.drive(name).set("forcerange", f"{-limit:.7g} {limit:.7g}")

    return Effect(f"actuator_saturation@{name}", apply, 0.2, 0.6, any_of(f"actuator_saturation@{name}", rf"parameter_error@{name}\.forcerange"),
                  [["actuator", name, "forcerange"]], "share of the largest force")


def reading_bias(joint, sign):
    def apply(truth, size):
        own = truth.find("joint", joint)
        raise_by(own, "ref", sign * size)
        own.set("range", text([float(word) + sign * size for word in own.get("range").split()]))

    return Effect(f"sensor_bias@{joint}", apply, 0.01, 0.12, any_of(f"sensor_bias@({joint}|{joint}_pos)", rf"parameter_error@{joint}\.ref"),
                  [["joint", joint, "ref"]], "rad")


def mass_names(body):
    return rf"(mass_offset@{body}|parameter_error@{body}\.(com.*|inertia.*|mass)|payload@{body})"


def payload(body, place, mass):
    def apply(truth, size):
        held = ET.SubElement(truth.find("body", body), "body", name="held", pos=text(place))
        ET.SubElement(held, "inertial", pos="0 0 0", mass=f"{size:.7g}", diaginertia=text(size * 4e-4 * np.ones(3)))

    accept = any_of(f"payload@{body}", rf"parameter_error@{body}\.mass", also=[mass_names(body)])
    return Effect(f"payload@{body}", apply, 0.2 * mass, 2.5 * mass, accept, [["body", body, "mass"]], "kg")


def mass_offset(body, direction, limit):
    def apply(truth, size):
        own = truth.find("body", body).find("inertial")
        place = np.array([float(word) for word in own.get("pos").split()]) + size * direction
        own.set("pos", " ".join(f"{value:.7g}" for value in place))

    accept = any_of(f"mass_offset@{body}", rf"parameter_error@{body}\.com.*", also=[rf"parameter_error@{body}\.(com.*|inertia.*)"])
    return Effect(f"mass_offset@{body}", apply, 0.2 * limit, limit, accept, [["body", body, "com"]], "m")


def relative(name, attribute, sign):
    """A number of an element that is wrong by a share."""
    body = attribute == "mass"

    def apply(truth, size):
        element = truth.find("body", name).find("inertial") if body else truth.drive(name)
        scale_by(element, attribute, 1 + sign * size)

    patterns, also = [rf"parameter_error@{name}\.{attribute}"], []
    if body:
        patterns, also = [*patterns, f"payload@{name}"], [mass_names(name)]
    if attribute == "kv":
        patterns.append(f"viscous_friction@{name.removesuffix('_servo')}")
    return Effect(f"parameter_error@{name}.{attribute}", apply, 0.2, 0.65, any_of(*patterns, also=also),
                  [["body" if body else "actuator", name, attribute]], "relative")


def slope(direction):
    def apply(truth, size):
        x, y = 9.81 * math.sin(size) * np.array([math.cos(direction), math.sin(direction)])
        truth.root.find("option").set("gravity", f"{x:.7g} {y:.7g} {-9.81 * math.cos(size):.7g}")

    return Effect("ground_slope@gravity", apply, 0.02, 0.2, any_of("ground_slope@gravity"), [["option", "option", "gravity"]], "rad")


def of_law(name, law, guess, limit):
    """A torque that the file format cannot say."""
    joint = law.joint

    def apply(truth, size):
        truth.laws.append(make_laws.Law(joint, size, law.torque))

    if name == "stribeck_friction":
        accept, named = any_of(f"stribeck_friction@{joint}"), True
    else:
        accept, named = None, False
    return Effect(f"{name}@{joint}", apply, guess, limit, accept, [], "N*m", mjcf=False, named=named)
