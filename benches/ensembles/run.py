#!/usr/bin/env python3
"""Lane changes with scattered parameters by `appell ensemble` and by heyoka, on one core each.

    python3 run.py --appell PATH [--before PATH] [--cases 20000] [--write] [--million]

Prints a table; --before is an earlier program, --write puts the table between its markers in docs/performance.md, `--million`
runs a million motions on all cores as well and tells time and memory.
"""

import argparse
import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet

HERE = Path(__file__).resolve().parent
LAW = HERE.parent.parent / "docs/examples/feedback/lane_change_5_m_s.toml"
KEPT = ["x", "y", "psi", "theta", "r", "speed"]
ROWS = [("dop853", tolerance) for tolerance in ("1e-6", "1e-7", "3e-8", "1e-8", "1e-9", "1e-11")]
# What leaves errors up to 1e-8.
MILLION = ("dop853", "3e-8")
# Cases whose errors are looked at.
SAMPLE = 512
BEGIN, END = "<!-- ensembles: written by benches/ensembles/run.py -->", "<!-- end ensembles -->"


def study(folder, cases, method, tolerance):
    text = (HERE / "lane_change.toml").read_text().replace("[motion]\n", f'[motion]\nmethod = "{method}"\n')
    text = re.sub(r"cases = \d+", f"cases = {cases}", text)
    text = re.sub(r"([ra]tol +)= .*", rf"\1= {tolerance}", text)
    (folder / LAW.name).write_text(LAW.read_text())
    path = folder / f"study_{cases}_{method}_{tolerance}.toml"
    path.write_text(text)
    return path


def run(appell, folder, cases, method, tolerance, jobs):
    """Rows by name, and seconds without those that a single case takes."""
    seconds = {}
    for count in (1, cases):
        out = folder / f"out_{count}_{method}_{tolerance}_{jobs}"
        start = time.perf_counter()
        command = [appell, "ensemble", study(folder, count, method, tolerance), "--out", out]
        subprocess.run(command + (["--jobs", str(jobs)] if jobs else []), check=True, stdout=subprocess.DEVNULL)
        seconds[count] = time.perf_counter() - start
    tables = [parquet.read_table(part) for part in sorted(out.glob("*.parquet"))]
    rows = {name: np.concatenate([table[name].to_numpy() for table in tables]) for name in KEPT + ["case"]}
    order = np.argsort(rows.pop("case"))
    return {name: values[order] for name, values in rows.items()}, seconds[cases] - seconds[1]


def table(appell, before, cases):
    """Rows of the table: earlier program, this one, the peer, one after the other."""
    lines = ["| | tolerance | µs a motion, one core | largest error |", "|---|---|---|---|"]
    programs = {"appell before": before, "appell": appell} if before else {"appell": appell}
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        exact, _ = run(appell, folder, SAMPLE, "dop853", "1e-13", 1)
        for method, tolerance in ROWS:
            for name, program in programs.items():
                with tempfile.TemporaryDirectory() as own:
                    rows, seconds = run(program, Path(own), cases, method, tolerance, 1)
                error = max(abs(rows[kept][:SAMPLE] - exact[kept]).max() for kept in KEPT)
                lines.append(f"| {name}, {method} | {tolerance} | {seconds / cases * 1e6:.1f} | {error:.1e} |")
                print(lines[-1], flush=True)
        told = subprocess.run(["taskset", "-c", "0", sys.executable, HERE / "with_heyoka.py", "4000"], check=True,
                              capture_output=True, text=True)
        told = json.loads(told.stdout)
        for kind, name in (("batch", f"heyoka {told['heyoka']}, batches of {told['lanes']}"), ("one", "heyoka, one motion")):
            for row in told[kind]:
                lines.append(f"| {name} | {row['tolerance']:.0e} | {row['seconds'] * 1e6:.1f} | {row['error']:.1e} |")
                print(lines[-1], flush=True)
    return lines


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--appell", required=True)
    parser.add_argument("--before")
    parser.add_argument("--cases", type=int, default=20000)
    parser.add_argument("--million", action="store_true")
    parser.add_argument("--write", action="store_true")
    asked = parser.parse_args()
    lines = table(asked.appell, asked.before, asked.cases)
    if asked.write:
        page = HERE.parent.parent / "docs/performance.md"
        text = page.read_text()
        begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
        page.write_text(text[:begin] + "\n\n" + "\n".join(lines) + "\n\n" + text[end:])
    if asked.million:
        with tempfile.TemporaryDirectory() as folder:
            _, seconds = run(asked.appell, Path(folder), 1000000, *MILLION, 0)
            peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
            print(f"\nA million motions on {os.cpu_count()} cores: {seconds:.1f} s, at most {peak:.0f} MB.")


if __name__ == "__main__":
    main()
