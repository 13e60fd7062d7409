#!/usr/bin/env python3
"""Motions and rates on the graphics card of this machine and on its processors.

    python3 run.py --appell PATH [--cases 1000000] [--states 1000000] [--write]

Prints a table; `--write` writes table.md beside this file. `run.sh` builds what it needs.
"""

import argparse
import importlib.util
import platform
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

import appell

HERE = Path(__file__).resolve().parent
# Leaves errors up to 1e-8.
METHOD, TOLERANCE = "dop853", "3e-8"
# Motions on processors: enough to tell the time of one.
FEW = 20000
ROUNDS = 20


def sibling(folder, name):
    """A module of another bench."""
    told = importlib.util.spec_from_file_location(f"{folder}_{name}", HERE.parent / folder / f"{name}.py")
    module = importlib.util.module_from_spec(told)
    told.loader.exec_module(module)
    return module


def motions(program, folder, cases):
    """Seconds of studies, and the largest difference of a final state."""
    ensembles = sibling("ensembles", "run")
    few = min(cases, FEW)
    rows, seconds = ensembles.run(program, folder, few, METHOD, TOLERANCE, 0)
    study = ensembles.study(folder, cases, METHOD, TOLERANCE)
    start = time.perf_counter()
    command = [program, "ensemble", study, "--out", folder / "card", "--device", "cuda"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    whole = time.perf_counter() - start
    # The motions alone: rows in memory, without files, statistics and the compiler.
    made = appell.Ensemble(str(study), device="cuda")
    start = time.perf_counter()
    made.run()
    alone = time.perf_counter() - start
    off = max(np.abs(made[name][:few] - rows[name]).max() for name in ensembles.KEPT)
    return [
        (f"{few} lane changes on all processors", seconds, seconds / few * 1e6, None),
        (f"{cases} lane changes on the card, the whole command", whole, whole / cases * 1e6, off),
        (f"{cases} lane changes on the card, rows in memory", alone, alone / cases * 1e6, off),
    ]


def rates(count):
    """Seconds for the rates of an arm of seven joints at many states."""
    model = appell.load(sibling("scaling", "specs").arm(7))
    draw = np.random.default_rng(1)
    x = draw.uniform(-1, 1, (count, len(model.states)))
    u = np.zeros((count, len(model.inputs)))
    model.rates(x[:1000], u[:1000])
    start = time.perf_counter()
    expected = model.rates(x, u)
    processors = time.perf_counter() - start
    card = model.on_card("rates")
    there = [card.array(values) for values in (x, u)]
    found = card.rates(*there)
    off = np.abs(found.numpy() - expected).max()
    start = time.perf_counter()
    for _ in range(ROUNDS):
        card.rates(*there)
    on_card = (time.perf_counter() - start) / ROUNDS
    return [
        (f"rates of an arm of 7 joints at {count} states on all processors", processors, processors / count * 1e6, None),
        (f"the same on the card, arrays there", on_card, on_card / count * 1e6, off),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--appell", required=True)
    parser.add_argument("--cases", type=int, default=10**6)
    parser.add_argument("--states", type=int, default=10**6)
    parser.add_argument("--write", action="store_true")
    asked = parser.parse_args()
    name = "no name"
    if shutil.which("nvidia-smi"):
        query = ["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"]
        name = subprocess.run(query, check=True, capture_output=True, text=True).stdout.splitlines()[0]
    lines = [
        f"One run on {time.strftime('%Y-%m-%d')}: {name}; {platform.processor() or platform.machine()}.",
        "",
        "| | seconds | µs each | largest difference from processors |",
        "|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        for what, seconds, each, off in motions(asked.appell, Path(folder), asked.cases) + rates(asked.states):
            lines.append(f"| {what} | {seconds:.4f} | {each:.4f} | {'' if off is None else f'{off:.1e}'} |")
    text = "\n".join(lines) + "\n"
    print(text)
    if asked.write:
        (HERE / "table.md").write_text(text)


if __name__ == "__main__":
    main()
