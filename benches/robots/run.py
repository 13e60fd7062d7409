#!/usr/bin/env python3
"""Robot files through `appell import`, held against vectors of other programs.

    python3 benches/robots/run.py VECTORS [NAME.FORMAT ...] [--appell PROGRAM] [--env DIR] [--out FILE]

VECTORS is a folder of `NAME.FORMAT.json`. Each names the package and the path of a robot file, or a file beside it,
and holds states with M, bias, energies, positions and accelerations by another program, in the blocks `rigid`,
`as_written` and `mimic`. Packages are looked for in the virtual environment DIR. README.md tells how to make both.
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
    without = ALWAYS + ([] if block == "mimic" else ["couplings"]) + ([] if block == "as_written" else RIGID)
    imported = folder / "imported.toml"
    _, seconds = run([appell, "import", robot, "-o", imported, "--without", ",".join(without)])
    joints = [legal(joint["name"]) for joint in vectors["joints"]]
    states = vectors["states"]
    leaves = {leaf: legal(leaf) for leaf in states[0]["rigid"]["leaf_positions"]}
    spec = imported.read_text()
    points = [point for point in [*leaves.values(), legal(vectors["last_link"])] if re.search(rf"^{point} +=.*from", spec, re.M)]
    tested = folder / "tested.toml"
    tested.write_text(with_outputs(spec, sorted(set(points))))
    order = [joint for joint in re.findall(r'^v_\w+ += \{ value = "dot\((\w+)\)"', spec, re.M)]
    # In the block `mimic`, joints that follow others have no speed of their own.
    free = [joint for joint in joints if joint in order] if block == "mimic" else joints
    if sorted(order) != sorted(free):
        raise RuntimeError(f"joints are {order}, not {joints}")
    cases = []
    for state in states:
        q, v = dict(zip(joints, state["q"])), dict(zip(joints, state["v"]))
        values = {**q, **{f"v_{joint}": v[joint] for joint in free}}
        inputs = {}
        for joint, tau in zip(joints, state["tau"]):
            inputs[f"tau_{joint}" if f"tau_{joint} " in spec else f"force_{joint}"] = tau
        cases += [{"state": values}, {"state": values, "inputs": inputs}]
    (folder / "cases.json").write_text(json.dumps({"cases": cases}))
    answer, evaluation = run([appell, "evaluate", tested, "--cases", folder / "cases.json"])
    answers = json.loads(answer)["cases"]
    place = [order.index(joint) for joint in free]
    differences = Differences()
    # Some programs count the links that stand still, so that energies compare up to a constant.
    heights = [[at_rest["potential_energy"] for at_rest in answers[::2]], [state[block].get("potential_energy") for state in states]]
    if None not in heights[1]:
        ours, theirs = ([value - values[0] for value in values] for values in heights)
        differences.add("V", ours, theirs, largest(heights[1]))
    for state, at_rest, driven in zip(states, answers[::2], answers[1::2]):
        rigid, here = state["rigid"], state.get(block, {})
        mass = [[at_rest["mass_matrix"][i][j] for j in place] for i in place]
        theirs = [list(row) for row in here.get("mass_matrix_lower", rigid["mass_matrix_lower"])]
        for index, added in enumerate(here.get("mass_matrix_added_diagonal", [])):
            theirs[index][index] += added
        differences.add("M", [mass[i][j] for i in range(len(place)) for j in range(i + 1)], [x for row in theirs for x in row])
        bias = [at_rest["bias"][i] - at_rest["generalized_forces"][i] for i in place]
        differences.add("bias", bias, here["bias"])
        if "kinetic_energy" in here:
            differences.add("T", [at_rest["kinetic_energy"]], [here["kinetic_energy"]])
        differences.add("qdd", [driven["rates"][f"v_{joint}"] for joint in free], here["qdd"])
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
        if (options.names and path.stem not in options.names) or (not options.names and vectors["base"] != "fixed"):
            continue
        robot = robot_file(vectors, path.parent, options.env)
        for block in ["rigid", "as_written", *(["mimic"] if "mimic" in vectors["states"][0] else [])]:
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
