"""The tools on a case: appell, and mujoco.sysid with the usual list."""

import json
import math
import os
import signal
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

import naming
import numbers_right
import rollouts


def measured(command, folder, timeout):
    """Runs a command in a folder; returns its outcome and its processor seconds."""
    with subprocess.Popen(["time", "-f", "%U %S", "-o", "seconds", *map(str, command)], cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          start_new_session=True) as process:
        try:
            output, _ = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            output, _ = process.communicate()
    words = (Path(folder) / "seconds").read_text().split() if (Path(folder) / "seconds").exists() else []
    try:
        seconds = sum(map(float, words[-2:]))
    except ValueError:
        seconds = math.nan
    return process.returncode, output, seconds


@contextmanager
def place(keep, case, *names):
    """Paths of fresh files, kept in a folder or thrown away."""
    with tempfile.TemporaryDirectory() as folder:
        own = (keep / case.name if keep else Path(folder)).resolve()
        own.mkdir(parents=True, exist_ok=True)
        files = [own / name for name in names]
        for old in files:
            old.unlink(missing_ok=True)
        yield folder, *files


def judged(text, case):
    """A corrected file: whether it is as it was, what it closes, which numbers are right."""
    found = {"same": text == case.robot.read_text()}
    if case.label["kind"] == "null":
        return found | rollouts.closed(text, case)
    return found | rollouts.closed(text, case) | numbers_right.right(text, case)


def by_appell(case, program, keep, timeout):
    """The report on a case, and the corrected file."""
    with place(keep, case, "report.json", "better.xml") as (folder, report, better):
        command = [program, "diagnose", "--data", case.folder.resolve(), "--json", report]
        code, told, seconds = measured(command, folder, timeout)
        found = {"seconds": seconds}
        if code or not report.exists():
            return found | {"failed": told[-2000:]}
        read = json.loads(report.read_text())
        found |= naming.judged(case.label, read) | {"which": read["which"][0]["effects"], "p": read["which"][0]["probability"]}
        code, told, _ = measured([program, "apply", case.robot.resolve(), "--report", report, "-o", better], folder, timeout)
        if code or not better.exists():
            return found | {"failed": told[-2000:]}
        return found | judged(better.read_text(), case)


def by_peer(case, keep, timeout):
    """The file with the usual list fitted, and what moved most."""
    with place(keep, case, "peer.xml", "moved.json") as (folder, better, moved):
        script = Path(__file__).with_name("peer.py")
        command = [sys.executable, script, case.folder.resolve(), "-o", better, "--moved", moved]
        code, told, seconds = measured(command, folder, timeout)
        if code or not better.exists():
            return {"seconds": seconds, "failed": told[-2000:]}
        effects = [number["effect"] for number in json.loads(moved.read_text())]
        return {"seconds": seconds, "first": naming.most(case.label, effects)} | judged(better.read_text(), case)
