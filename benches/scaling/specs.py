"""Specs of families of mechanisms: spatial arms, planar chains, a floating base with limbs."""

# Axes of the joints of an arm from the base on, and again from the start.
ARM = "zyyxyxyzyxyz"
LIMB = "xyyzxy"
LINK = {"cx": 0.01, "cy": 0.02, "cz": 0.15, "px": 0.02, "py": 0.01, "pz": 0.3}
INERTIA = {"Ixx": 0.05, "Iyy": 0.06, "Izz": 0.03, "Ixy": 0.001, "Ixz": 0.002, "Iyz": -0.001}


class Spec:
    """A spec that grows by joints."""

    def __init__(self, name, title):
        self.sections = {"mechanism": [f'name = "{name}"', f'title = "{title}"']}
        for section in ("parameters", "coordinates", "inputs", "frames", "points", "bodies", "pseudo_velocities", "loads"):
            self.sections[section] = []
        self.parameter("g", 9.81, "m/s^2")
        self.add("loads", 'weight = { kind = "gravity", down = "-z", acceleration = "g" }')

    def add(self, section, line):
        self.sections[section].append(line)

    def parameter(self, name, value, unit):
        self.add("parameters", f'{name} = {{ value = {value}, unit = "{unit}" }}')

    def joint(self, name, parent, axis):
        """A frame that turns about an axis of its parent, and what drives it."""
        self.add("coordinates", f'q{name} = {{ unit = "rad", initial = 0.3 }}')
        self.add("inputs", f'tau{name} = {{ unit = "N*m" }}')
        self.add("frames", f'link{name} = {{ parent = "{parent}", about_axis = "{axis}", by = "q{name}" }}')
        self.add("pseudo_velocities", f'v{name} = {{ value = "dot(q{name})", unit = "rad/s" }}')
        torque = ", ".join(f'"tau{name}"' if axis == a else "0" for a in "xyz")
        other = "" if parent == "ground" else f'reaction_on = "{parent}", '
        self.add("loads", f'motor{name} = {{ kind = "torque", on = "link{name}", {other}in = "link{name}", vector = [{torque}] }}')

    def point(self, name, start, frame, at):
        self.add("points", f'{name} = {{ from = "{start}", in = "{frame}", at = [{", ".join(at)}] }}')

    def link(self, name, start, mass, length=1):
        """A body with ten inertial parameters in the frame of a joint; returns its end."""
        self.parameter(f"m{name}", mass, "kg")
        for symbol, value in LINK.items():
            self.parameter(symbol + name, length * value, "m")
        for symbol, value in INERTIA.items():
            self.parameter(symbol + name, value, "kg*m^2")
        for point, symbol in (("G", "c"), ("E", "p")):
            self.point(point + name, start, f"link{name}", [f'"{symbol}{axis}{name}"' for axis in "xyz"])
        rows = ", ".join("[" + ", ".join(f'"I{"".join(sorted(a + b))}{name}"' for b in "xyz") + "]" for a in "xyz")
        self.add("bodies", f'link{name} = {{ frame = "link{name}", centre = "G{name}", mass = "m{name}", '
                           f'inertia = {{ in = "link{name}", matrix = [{rows}] }} }}')
        return f"E{name}"

    def text(self):
        return "\n\n".join(f"[{section}]\n" + "\n".join(lines) for section, lines in self.sections.items()) + "\n"


def arm(n):
    spec = Spec(f"arm{n}", f"spatial arm of {n} joints")
    frame, end = "ground", "O"
    for i in range(1, n + 1):
        spec.joint(f"{i}", frame, ARM[(i - 1) % len(ARM)])
        frame, end = f"link{i}", spec.link(f"{i}", end, round(3 - 2 * i / n, 3))
    return spec.text()


def chain(n):
    spec = Spec(f"chain{n}", f"planar chain of {n} links")
    frame, end = "ground", "O"
    for i in range(1, n + 1):
        for name, value, unit in (("m", 1, "kg"), ("l", 0.4, "m"), ("r", 0.2, "m"), ("I", 0.015, "kg*m^2")):
            spec.parameter(f"{name}{i}", value, unit)
        spec.joint(f"{i}", frame, "y")
        frame = f"link{i}"
        spec.point(f"G{i}", end, frame, ["0", "0", f'"-r{i}"'])
        spec.point(f"E{i}", end, frame, ["0", "0", f'"-l{i}"'])
        moments = ", ".join([f'"I{i}"'] * 3)
        spec.add("bodies", f'{frame} = {{ frame = "{frame}", centre = "G{i}", mass = "m{i}", inertia = {{ in = "{frame}", diagonal = [{moments}] }} }}')
        end = f"E{i}"
    return spec.text()


def floating(limbs, joints):
    """Yaw, pitch and roll as coordinates, velocities of the centre along the ground, of rotation along the base."""
    spec = Spec(f"float{limbs}x{joints}", f"floating base with {limbs} limbs of {joints} joints")
    spec.parameter("m0", 10, "kg")
    for axis, moment in zip("xyz", (0.3, 0.5, 0.6)):
        spec.parameter(f"I0{axis}", moment, "kg*m^2")
        spec.add("coordinates", f'{axis} = {{ unit = "m" }}')
    frame = "ground"
    for angle, axis, child, limits in (("yaw", "z", "by_yaw", ""), ("pitch", "y", "by_pitch", ", range = [-1.5, 1.5]"), ("roll", "x", "base", "")):
        spec.add("coordinates", f'{angle} = {{ unit = "rad"{limits} }}')
        spec.add("frames", f'{child} = {{ parent = "{frame}", about_axis = "{axis}", by = "{angle}" }}')
        frame = child
    spec.point("B", "O", "ground", ['"x"', '"y"', '"z"'])
    spec.add("bodies", 'base = { frame = "base", centre = "B", mass = "m0", inertia = { in = "base", diagonal = ["I0x", "I0y", "I0z"] } }')
    for axis in "xyz":
        spec.add("pseudo_velocities", f'v{axis} = {{ value = "dot({axis})", unit = "m/s" }}')
    for axis in "xyz":
        spec.add("pseudo_velocities", f'w{axis} = {{ value = "angular_velocity(base, {axis}, base)", unit = "rad/s" }}')
    for limb in range(1, limbs + 1):
        for axis, value in zip("xy", (0.2 if limb % 2 else -0.2, 0.1 if limb < 3 else -0.1)):
            spec.parameter(f"h{axis}{limb}", value, "m")
        end, frame = f"H{limb}", "base"
        spec.point(end, "B", "base", [f'"hx{limb}"', f'"hy{limb}"', "0"])
        for i in range(1, joints + 1):
            spec.joint(f"{limb}_{i}", frame, LIMB[(i - 1) % len(LIMB)])
            frame, end = f"link{limb}_{i}", spec.link(f"{limb}_{i}", end, round(1 / i, 3), -0.7)
    return spec.text()
