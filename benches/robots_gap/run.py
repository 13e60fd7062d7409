#!/usr/bin/env python3
"""From a robot file and logs to a corrected file, judged by MuJoCo.

    python3 benches/robots_gap/run.py FOLDER [CASE ...] [--appell PROGRAM] [--jobs N] [--reports DIR] [--out FILE]

FOLDER holds `cases/NAME/` (a recording.toml with its robot file and recordings) and `LABELS.json`. appell diagnoses a case
and corrects the file, which is rolled out in MuJoCo on held-out runs beside the nominal file and the true one. Needs numpy
and mujoco. README.md tells more.
"""

import argparse
import json
import math
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import naming
import rollouts
from cases import cases


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--appell", default="appell")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=1800)
    parser.add_argument("--reports", type=Path, help="keep reports and corrected files there")
    parser.add_argument("--out", type=Path, help="write all numbers there as JSON")
    return parser.parse_intermixed_args()


def measured(command, folder, timeout):
    """Runs a command in a folder; returns its outcome and its processor seconds."""
    with subprocess.Popen(["time", "-f", "%U %S", "-o", "seconds", *map(str, command)], cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        try:
            output, _ = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.terminate()
            subprocess.run(["pkill", "-P", str(process.pid)], check=False)
            output, _ = process.communicate()
    words = (Path(folder) / "seconds").read_text().split() if (Path(folder) / "seconds").exists() else []
    try:
        seconds = sum(map(float, words[-2:]))
    except ValueError:
        seconds = math.nan
    return process.returncode, output, seconds


def by_appell(case, program, keep, timeout):
    """The report on a case, and the corrected file."""
    with tempfile.TemporaryDirectory() as folder:
        place = keep / case.name if keep else Path(folder)
        place.mkdir(parents=True, exist_ok=True)
        report, better = place.resolve() / "report.json", place.resolve() / "better.xml"
        for old in (report, better):
            old.unlink(missing_ok=True)
        code, told, seconds = measured([program, "diagnose", "--data", case.folder, "--json", report], folder, timeout)
        found = {"seconds": seconds}
        if code or not report.exists():
            return found | {"failed": told[-2000:]}
        read = json.loads(report.read_text())
        found |= naming.judged(case.label, read) | {"which": read["which"][0]["effects"], "p": read["which"][0]["probability"]}
        code, told, _ = measured([program, "apply", case.robot, "--report", report, "-o", better], folder, timeout)
        if code or not better.exists():
            return found | {"failed": told[-2000:]}
        text = better.read_text()
        if case.label["kind"] == "null":
            return found | {"same": text == case.robot.read_text()}
        return found | rollouts.closed(text, case)


def share(values):
    known = [v for v in values if v is not None]
    return f"{sum(known)} of {len(known)}"


def table(found):
    """The lines of a table of all cases and their sums."""
    lines = ["| case | true | named first | p | first | tie | closed | s |", "|---|---|---|---|---|---|---|---|"]
    for case, own in found:
        closed = f"{own['closed']:.3f}" if "closed" in own else "–"
        named = " + ".join(own.get("which", ["failed"])) or "nothing"
        truth = " + ".join(case.label["effects"]) or "nothing"
        first, tied = own.get("first", False), own.get("tie", False)
        lines.append(f"| {case.name} | {truth} | {named} | {own.get('p', math.nan):.2f} | {first} | {tied} | {closed} | {own['seconds']:.0f} |")
    gaps = [own for case, own in found if case.label["kind"] != "null"]
    nulls = [own for case, own in found if case.label["kind"] == "null"]
    closed = [own.get("closed", 0.0) for own in gaps]
    if closed:
        lines.append("")
        lines.append(
            f"first {share([o.get('first', False) for o in gaps])}, tie {share([o.get('tie', False) for o in gaps])}, "
            f"three {share([o.get('three', False) for o in gaps])}, alarms {share([o.get('alarm', True) for o in nulls])}, "
            f"closed median {statistics.median(closed):.3f} mean {statistics.mean(closed):.3f}, "
            f"seconds median {statistics.median([o['seconds'] for _, o in found]):.0f}"
        )
    return lines


def main():
    given = arguments()
    wanted = list(cases(given.folder, given.names))

    def one(case):
        began = time.time()
        own = by_appell(case, given.appell, given.reports, given.timeout)
        print(case.name, json.dumps(own), f"{time.time() - began:.0f} s", file=sys.stderr, flush=True)
        return case, own

    with ThreadPoolExecutor(given.jobs) as pool:
        found = list(pool.map(one, wanted))
    lines = table(found)
    print("\n".join(lines))
    if given.out:
        given.out.write_text(json.dumps({case.name: own for case, own in found}, indent=1))


if __name__ == "__main__":
    main()
