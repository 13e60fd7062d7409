#!/usr/bin/env python3
"""Processor seconds until a large robot is evaluated or moves, without and with the cache of derived equations.

    python3 benches/startup/run.py [--appell PROGRAM] [--before PROGRAM] [--peers PYTHON] [--write]

Robots are trees of LIMBS limbs of JOINTS hinges on a floating base, as MJCF files. --before is an earlier program, beside which
the same commands run; it has neither the key `quantities` nor a cache. --peers is a Python with MuJoCo and Pinocchio
(`pip install mujoco pin`), which load the same robot and compute the same once (peers.py). --write puts the table between its markers in
docs/performance.md.
"""

import argparse
import json
import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROBOTS = {31: (5, 5), 56: (5, 10), 72: (6, 11)}
AXES = ["1 0 0", "0 1 0", "0 0 1"]
BEGIN, END = "<!-- startup: written by benches/startup/run.py -->", "<!-- end startup -->"


def robot(limbs, joints):
    text = '<mujoco model="tree"><worldbody><body name="base" pos="0 0 1"><freejoint/>'
    text += '<inertial pos="0.01 0 0.02" mass="10" fullinertia="0.3 0.4 0.5 0.01 0.02 0.015"/>'
    for limb in range(limbs):
        for joint in range(joints):
            place = f"{0.2 if limb % 2 else -0.2} {0.1 * (limb - limbs / 2):.2f} 0" if joint == 0 else "0.02 0.01 -0.15"
            text += f'<body name="l{limb}_{joint}" pos="{place}">'
            text += f'<joint name="j{limb}_{joint}" axis="{AXES[(limb + joint) % 3]}" damping="0.{(limb + joint) % 7 + 1}"/>'
            text += f'<inertial pos="0.01 0.02 -0.08" mass="{1 / (1 + joint):.3f}" '
            text += 'fullinertia="0.005 0.006 0.003 0.0001 0.0002 -0.0001"/>'
        text += "</body>" * joints
    return text + "</body></worldbody></mujoco>"


def used(command, folder, cache):
    """Processor seconds of a command with its children, and its peak memory in MB."""
    environment = {**os.environ, "APPELL_CACHE": str(cache or "")}
    process = subprocess.Popen([str(part) for part in command], cwd=folder, env=environment, stdout=subprocess.DEVNULL)
    _, status, about = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{command}: failed")
    return about.ru_utime + about.ru_stime, about.ru_maxrss / 1000


def state(program, folder):
    """A state of the robot, as `evaluate` wants it."""
    subprocess.run([program, "import", "robot.xml", "-o", "robot.toml"], cwd=folder, check=True, capture_output=True)
    section, names = "", []
    for line in (folder / "robot.toml").read_text().splitlines():
        if line.startswith("["):
            section = line.strip("[]")
        elif section in ("coordinates", "pseudo_velocities") and "=" in line:
            names.append(line.split("=")[0].strip().strip('"'))
    return {name: 0.99 if name.endswith("_qw") else 0.1 for name in names}


def cells(program, folder, has_cache):
    """Seconds and memory: rates and M, with A and B, all, a first and a second simulation."""
    cases = [{"state": state(program, folder)}]
    wanted = {"rates": ["rates", "mass_matrix"], "slopes": ["rates", "mass_matrix", "A", "B"], "all": None}
    found = {}
    for name, quantities in wanted.items():
        if quantities and not has_cache:
            continue
        text = {"cases": cases, **({"quantities": quantities} if quantities else {})}
        (folder / f"{name}.json").write_text(json.dumps(text))
        command = [program, "evaluate", "robot.toml", "--cases", f"{name}.json", "--json", "out.json"]
        found[name] = used(command, folder, None)
    simulate = [program, "simulate", "robot.toml", "--t-end-s", "0.001", "--csv", "motion.csv"]
    found["simulate"] = used(simulate, folder, None)
    if has_cache:
        with tempfile.TemporaryDirectory() as cache:
            used(simulate, folder, cache)
            found["again"] = used(simulate, folder, cache)
    return found


def peer_cells(python, peer, folder):
    """The same for a peer, whose slopes are differences (MuJoCo) or derived (Pinocchio)."""
    script = Path(__file__).with_name("peers.py")
    return {what: used([python, script, peer, what], folder, None) for what in ("rates", "slopes", "simulate")}


def table(programs, peers):
    columns = {"rates": "rates, M", "slopes": "rates, M, A, B", "all": "all quantities", "simulate": "`simulate`",
               "again": "`simulate` again"}
    lines = ["| degrees of freedom | | " + " | ".join(columns.values()) + " |", "|---|---|" + "---|" * len(columns)]
    for freedoms, (limbs, joints) in ROBOTS.items():
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            (folder / "robot.xml").write_text(robot(limbs, joints))
            for name, (program, has_cache) in programs.items():
                lines.append(row(freedoms, name, cells(program, folder, has_cache), columns))
            for peer, name in (("mujoco", "MuJoCo"), ("pinocchio", "Pinocchio")) if peers else ():
                lines.append(row(freedoms, name, peer_cells(peers, peer, folder), columns))
    return lines


def row(freedoms, name, found, columns):
    told = [f"{found[key][0]:.2f} s, {found[key][1]:.0f} MB" if key in found else "" for key in columns]
    return f"| {freedoms} | {name} | " + " | ".join(told) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--appell", type=Path, default=Path("appell"))
    parser.add_argument("--before", type=Path)
    parser.add_argument("--peers")
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args()
    programs = {"before": (given.before.resolve(), False)} if given.before else {}
    lines = table({**programs, "appell": (given.appell.resolve(), True)}, given.peers)
    print("\n".join(lines))
    if given.write:
        page = ROOT / "docs/performance.md"
        text = page.read_text()
        begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
        page.write_text(text[:begin] + "\n\n" + "\n".join(lines) + "\n\n" + text[end:])


if __name__ == "__main__":
    main()
