"""A spec of a tree of links as peers want it: joints one after the other, each with what stands behind it."""

import math
import re
import tomllib
from dataclasses import dataclass, field

import numpy as np

AXES = {"x": 0, "y": 1, "z": 2}
ROUNDING = 1e-12


@dataclass
class Link:
    """A joint and the body behind it. Values are numbers, or symbols of the parameters."""

    name: str
    kind: str  # "turn", "slide" or "free"
    parent: int  # -1 for the ground
    rotation: np.ndarray  # from this link to its parent at joint coordinate zero
    place: list  # of the joint in the parent
    axis: np.ndarray = None
    angles: list = field(default_factory=list)  # of a free joint: axes and coordinates, none for a quaternion
    mass: object = 0.0
    centre: list = field(default_factory=lambda: [0.0] * 3)
    inertia: list = None  # about the centre, in the axes of the link


def about(axis, angle):
    """The rotation about a unit axis, its rounding taken off."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return clean(np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross)


def clean(matrix):
    nearest = np.round(matrix)
    return np.where(abs(matrix - nearest) < ROUNDING, nearest, matrix)


def unit(axis):
    vector = np.zeros(3)
    vector[AXES[axis[-1]]] = -1.0 if axis.startswith("-") else 1.0
    return vector


def plus(a, b):
    return [x + y for x, y in zip(a, b)]


def rotated(rotation, vector):
    return [sum(r * v for r, v in zip(row, vector) if r != 0) for row in rotation]


class Tree:
    """The links of a spec; `symbol` turns names of parameters into values, else their numbers are taken."""

    def __init__(self, path, symbol=None):
        spec = tomllib.loads(path.read_text())
        self.frames, self.points = spec["frames"], spec["points"]
        self.coordinates = list(spec["coordinates"])
        given = spec.get("parameters", {})
        self.parameters = {name: symbol(name) if symbol else entry["value"] for name, entry in given.items()}
        self.gravity = self.value(spec["loads"]["weight"]["acceleration"])
        self.links = []
        for body in spec["bodies"].values():
            self.attach(body)

    def value(self, text, **coordinates):
        """An expression of the spec, units left off, other coordinates zero."""
        if not isinstance(text, str):
            return text
        names = {**dict.fromkeys(self.coordinates, 0.0), **self.parameters, **coordinates, "pi": math.pi}
        return eval(re.sub(r"\[.*?\]", "", text), {"__builtins__": {}}, names)  # specs are our own

    def named(self, text):
        found = re.findall(r"[A-Za-z_]\w*", re.sub(r"\[.*?\]", "", text)) if isinstance(text, str) else []
        return [name for name in found if name in self.coordinates]

    def joint(self, link):
        """The number of a joint, which is new the first time that a body is reached through it."""
        for index, known in enumerate(self.links):
            if known.name == link.name:
                assert known.parent == link.parent and np.allclose(known.rotation, link.rotation), link.name
                return index
        self.links.append(link)
        return len(self.links) - 1

    def attach(self, body):
        """Walks from the ground to the body along its points, through the frames in which these are placed."""
        at, frame, rotation, place = -1, "ground", np.eye(3), [0.0] * 3
        chain = []
        point = body["centre"]
        while point != "O":
            chain.append(self.points[point])
            point = chain[-1]["from"]
        steps = [*reversed(chain), {"in": body["frame"], "at": [0, 0, 0]}]
        for step, following in zip(steps, [*steps[1:], None]):
            inner = step["in"]
            if sum(len(self.named(text)) for text in step["at"]) == 3:
                frame = following["in"]
                at = self.joint(Link("free", "free", -1, np.eye(3), place, angles=self.angles(frame)))
                rotation, place = np.eye(3), [0.0] * 3
                continue
            for turn in self.turns(frame, inner):
                axis, names = unit(turn["about_axis"]), self.named(turn["by"])
                rotation = clean(rotation @ about(axis, self.value(turn["by"])))
                if names:
                    at = self.joint(Link(names[0], "turn", at, rotation, place, axis))
                    rotation, place = np.eye(3), [0.0] * 3
            frame = inner
            place = plus(place, rotated(rotation, [self.value(text) for text in step["at"]]))
            for axis, text in zip("xyz", step["at"]):
                for name in self.named(text):
                    sign = self.value(text, **{name: 1.0}) - self.value(text)
                    at = self.joint(Link(name, "slide", at, rotation, place, sign * unit(axis)))
                    rotation, place = np.eye(3), [0.0] * 3
        link = self.links[at]
        assert link.inertia is None and np.array_equal(rotation, np.eye(3)), "a body for each joint, its frame behind it"
        link.mass, link.centre, link.inertia = self.value(body["mass"]), place, self.inertia(body["inertia"])

    def turns(self, outer, inner):
        """The turns from one frame to another that stands behind it."""
        found = []
        while inner != outer:
            frame = self.frames[inner]
            found = frame.get("turns", [frame]) + found
            inner = frame["parent"]
        return found

    def angles(self, frame):
        """Axes and coordinates of the turns to a free frame; a quaternion has none."""
        if "quaternion" in self.frames[frame]:
            return []
        return [(unit(turn["about_axis"]), turn["by"]) for turn in self.turns("ground", frame)]

    def inertia(self, inertia):
        if "matrix" in inertia:
            return [[self.value(text) for text in row] for row in inertia["matrix"]]
        diagonal = [self.value(text) for text in inertia.get("diagonal") or inertia["moments"]]
        xy, xz, yz = (self.value(text) for text in inertia.get("products", [0, 0, 0]))
        return [[diagonal[0], xy, xz], [xy, diagonal[1], yz], [xz, yz, diagonal[2]]]
