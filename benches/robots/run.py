#!/usr/bin/env python3
"""Robot files through `appell import`, held against vectors of other programs.

    python3 benches/robots/run.py VECTORS [NAME.FORMAT ...] [--appell PROGRAM] [--env DIR] [--out FILE]

VECTORS is a folder of `NAME.FORMAT.json`. Each names the package and the path of a robot file, or a file beside it,
and holds states with M, bias, energies, positions and accelerations by another program, in the blocks `rigid`,
`as_written`, `mimic` and `constrained`. Packages are looked for in the virtual environment DIR. README.md tells how to make both.
"""

import argparse
import json
import math
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# Largest admissible differences, relative to the largest entry.
TOLERANCE = {"qdd": 1e-9}
DEFAULT_TOLERANCE = 1e-12
# What other programs leave out of both blocks.
ALWAYS = ["friction", "limits"]
RIGID = ["damping", "armature", "springs", "compensation"]
# Where joints follow others.
BOUND = ["mimic", "constrained"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("vectors", type=Path)
    parser.add_argument("names", nargs="*", metavar="NAME.FORMAT")
    parser.add_argument("--appell", default="appell")
    parser.add_argument("--env", type=Path, default=Path("."))
    parser.add_argument("--out", type=Path, help="write the table there as well")
    return parser.parse_intermixed_args()


def robot_file(vectors, folder, env):
    """The file that a set of vectors is about."""
    source = vectors["source"]
    if "file" in source:
        return folder / source["file"]
    found = list(env.glob(f"lib/python*/site-packages/{source['path']}"))
    if not found:
        sys.exit(f"{source['path']} is not below {env}: install {source['package']}")
    return found[0]


def run(command):
    """Runs a command; returns what it printed and the seconds it took."""
    began = time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True)
    seconds = time.perf_counter() - began
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))}: {done.stderr.strip()}")
    return done.stdout, seconds


def legal(name):
    return re.sub("[^A-Za-z0-9_]", "_", name)


def with_outputs(spec, points):
    """The spec with the positions of points as outputs in place of its own."""
    spec = re.sub(r"\n\[outputs\]\n(?:[^\n#]+\n)*", "\n", spec)
    rows = [
        f'pos_{axis}_{point} = {{ value = "position({point}, {axis})", unit = "m" }}' for point in points for axis in "xyz"
    ]
    return f"{spec}\n[outputs]\n" + "\n".join(rows) + "\n" if rows else spec


class Joint:
    """A joint of the vectors by the names of the spec: its coordinates, speeds and inputs."""

    def __init__(self, joint, spec):
        self.q = slice(joint["idx_q"], joint["idx_q"] + joint["nq"])
        self.v = slice(joint["idx_v"], joint["idx_v"] + joint["nv"])
        name = legal(joint["name"] or "")
        if joint["nq"] == 7:
            # A free joint may be called otherwise, or not at all.
            frame, begin = re.search(r'^(\w+) += \{ parent = "ground", quaternion = \["(\w+)_qw"', spec, re.M).groups()
            self.coordinates = [f"{begin}_{end}" for end in ("x", "y", "z", "qw", "qx", "qy", "qz")]
            self.speeds = [f"v_{begin}_{axis}" for axis in "xyz"] + [f"w_{begin}_{axis}" for axis in "xyz"]
            self.inputs = [f"{kind}_tested_{axis}" for kind in ("force", "torque") for axis in "xyz"]
            self.added = "".join(f'[inputs.{name}]\nunit = "{"N" if name[0] == "f" else "N*m"}"\n' for name in self.inputs)
            wrench = [self.inputs[:3], self.inputs[3:]]
            self.added += f'[loads.force_tested]\nkind = "force"\non = "{frame}"\nin = "ground"\nvector = {json.dumps(wrench[0])}\n'
            self.added += f'[loads.torque_tested]\nkind = "torque"\non = "{frame}"\nin = "{frame}"\nvector = {json.dumps(wrench[1])}\n'
        elif joint["nq"] == 4:
            self.coordinates = [f"{name}_{end}" for end in ("qw", "qx", "qy", "qz")]
            self.speeds, self.inputs = ([f"{kind}_{name}_{axis}" for axis in "xyz"] for kind in ("w", "tau"))
            self.added = ""
        else:
            self.coordinates, self.speeds, self.added = [name], [f"v_{name}"], ""
            self.inputs = [f"tau_{name}" if f"tau_{name} " in spec else f"force_{name}"]


def largest(values):
    return max((abs(value) for value in values), default=0.0)


class Differences(dict):
    """Largest differences by quantity, relative to the largest entry."""

    def add(self, what, ours, theirs, scale=None):
        ours, theirs = list(ours), list(theirs)
        scale = scale or largest(theirs) or 1.0
        finite = all(value is not None and math.isfinite(value) for value in ours)
        error = largest(a - b for a, b in zip(ours, theirs, strict=True)) / scale if finite else math.inf
        self[what] = max(self.get(what, 0.0), error)


def compare(vectors, block, robot, appell, folder):
    """Imports a robot and evaluates it at the states of a block."""
    without = ALWAYS + ([] if block in BOUND else ["couplings"]) + ([] if block == "as_written" else RIGID)
    imported = folder / "imported.toml"
    floating = ["--floating"] if vectors["base"] == "floating" and robot.suffix == ".urdf" else []
    _, seconds = run([appell, "import", robot, "-o", imported, "--without", ",".join(without), *floating])
    states = vectors["states"]
    leaves = {leaf: legal(leaf) for leaf in states[0]["rigid"]["leaf_positions"]}
    spec = imported.read_text()
    points = [point for point in [*leaves.values(), legal(vectors["last_link"])] if re.search(rf"^{point} +=.*from", spec, re.M)]
    joints = [Joint(joint, spec) for joint in vectors["joints"]]
    tested = folder / "tested.toml"
    tested.write_text(with_outputs(spec, sorted(set(points))) + "".join(joint.added for joint in joints))
    section = spec[spec.index("[pseudo_velocities]"):].split("\n[", 2)[0]
    order = re.findall(r"^(\w+) += \{", section, re.M)
    names = [name for joint in joints for name in joint.speeds]
    # Joints that follow others have no speed of their own.
    free = [name for name in names if name in order] if block in BOUND else names
    if sorted(order) != sorted(free):
        raise RuntimeError(f"speeds are {order}, not {names}")
    cases = []
    for state in states:
        values, inputs = {}, {}
        for joint in joints:
            values.update(zip(joint.coordinates, state["q"][joint.q]))
            values.update((name, v) for name, v in zip(joint.speeds, state["v"][joint.v]) if name in free)
            inputs.update(zip(joint.inputs, state["tau"][joint.v]))
        cases += [{"state": values}, {"state": values, "inputs": inputs}]
    (folder / "cases.json").write_text(json.dumps({"cases": cases}))
    answer, evaluation = run([appell, "evaluate", tested, "--cases", folder / "cases.json"])
    answers = json.loads(answer)["cases"]
    place = [order.index(name) for name in free]
    differences = Differences()
    # Some programs count the links that stand still, so that energies compare up to a constant.
    heights = [[at_rest["potential_energy"] for at_rest in answers[::2]], [state[block].get("potential_energy") for state in states]]
    if None not in heights[1]:
        ours, theirs = ([value - values[0] for value in values] for values in heights)
        differences.add("V", ours, theirs, largest(heights[1]))
    for state, at_rest, driven in zip(states, answers[::2], answers[1::2]):
        rigid, here = state["rigid"], state.get(block, {})
        if block == "constrained":
            theirs = dict(zip(names, here["qdd"]))
            differences.add("qdd", [driven["rates"][name] for name in free], [theirs[name] for name in free], largest(here["qdd"]))
            continue
        mass = [[at_rest["mass_matrix"][i][j] for j in place] for i in place]
        theirs = [list(row) for row in here.get("mass_matrix_lower", rigid["mass_matrix_lower"])]
        for index, added in enumerate(here.get("mass_matrix_added_diagonal", [])):
            theirs[index][index] += added
        differences.add("M", [mass[i][j] for i in range(len(place)) for j in range(i + 1)], [x for row in theirs for x in row])
        bias = [at_rest["bias"][i] - at_rest["generalized_forces"][i] for i in place]
        differences.add("bias", bias, here["bias"])
        if "kinetic_energy" in here:
            differences.add("T", [at_rest["kinetic_energy"]], [here["kinetic_energy"]])
        differences.add("qdd", [driven["rates"][name] for name in free], here["qdd"])
        positions = {**rigid["leaf_positions"], vectors["last_link"]: rigid["last_link_position"]}
        for name, position in positions.items():
            if legal(name) in points:
                ours = [at_rest["outputs"][f"pos_{axis}_{legal(name)}"] for axis in "xyz"]
                differences.add("positions", ours, position)
    return differences, seconds, evaluation, len(joints)


def main():
    options = arguments()
    found = sorted(path for path in options.vectors.glob("*.json"))
    lines = ["| robot | block | joints | M | bias | T | V | positions | qdd | import | evaluate |", "|---|---|---|---|---|---|---|---|---|---|---|"]
    print("\n".join(lines))
    failed = 0
    for path in found:
        vectors = json.loads(path.read_text())
        if "states" not in vectors:
            continue
        if options.names and path.stem not in options.names:
            continue
        robot = robot_file(vectors, path.parent, options.env)
        for block in ["rigid", "as_written", *(block for block in BOUND if block in vectors["states"][0])]:
            with tempfile.TemporaryDirectory() as folder:
                try:
                    differences, seconds, evaluation, joints = compare(vectors, block, robot, options.appell, Path(folder))
                except RuntimeError as error:
                    failed += 1
                    print(f"{path.stem} {block}: {error}", flush=True)
                    continue
            cells = []
            for what in ["M", "bias", "T", "V", "positions", "qdd"]:
                value = differences.get(what)
                wrong = value is not None and not value <= TOLERANCE.get(what, DEFAULT_TOLERANCE)
                failed += wrong
                cells.append("" if value is None else f"{value:.1e}" + (" WRONG" if wrong else ""))
            row = [path.stem, block, str(joints), *cells, f"{seconds:.2f} s", f"{evaluation:.1f} s"]
            lines.append("| " + " | ".join(row) + " |")
            print(lines[-1], flush=True)
    if options.out:
        options.out.write_text("\n".join(lines) + "\n")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
