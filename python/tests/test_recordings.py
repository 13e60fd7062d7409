"""From recordings to causes."""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

import appell


@pytest.fixture(scope="module")
def diagnosis(rig):
    stages = []
    found = appell.diagnose(rig, progress=stages.append)
    assert len(set(stages)) > 3
    return found


def command():
    """The command line, if it is built."""
    return os.environ.get("APPELL_COMMAND") or shutil.which("appell")


def test_the_report_is_that_of_the_command(diagnosis, rig):
    if command() is None:
        pytest.skip("the command `appell` is not there; APPELL_COMMAND tells its path")
    told = subprocess.run([command(), "diagnose", "--data", str(rig), "--json", "-"], capture_output=True, check=True)
    assert told.stdout.decode() == diagnosis.json


def test_a_gap_gets_a_cause_and_a_better_model(diagnosis, rig, tmp_path):
    assert diagnosis.hypotheses[0]["effects"]
    assert "friction" in diagnosis.sentence
    text, changed = diagnosis.improved()
    assert changed.startswith("improved.toml: my_rig")
    better = diagnosis.apply()
    assert better.spec == text
    assert text != (rig / "my_rig.toml").read_text()
    with pytest.raises(appell.RequestError, match="there is no hypothesis 99"):
        diagnosis.apply(99)
    diagnosis.save(tmp_path / "gap.html")
    diagnosis.save(tmp_path / "gap.json")
    assert json.loads((tmp_path / "gap.json").read_text()) == diagnosis.told
    assert diagnosis._repr_html_().startswith("<iframe")


def test_parameters_are_estimated(rig):
    found = appell.identify(rig, rig / "my_rig.toml", progress=False)
    for name, one in found.parameters.items():
        assert one["interval95"][0] <= found.values[name] <= one["interval95"][1]
    assert found.page.text.startswith("<!")


def test_recordings_are_described(rig):
    recordings = appell.Recordings(rig)
    assert recordings.runs == ["run1.csv", "run2.csv", "run3.csv"]
    run = recordings["run1.csv"]
    assert set(run) == {"t", *recordings.channels} and all(len(column) == len(run["t"]) for column in run.values())
    with pytest.raises(KeyError, match="there is no run `run9`"):
        recordings["run9"]
    with pytest.raises(appell.RequestError, match="there is no folder or file"):
        appell.Recordings(rig / "missing")
    with pytest.raises(ValueError, match="there is no column `nothing`"):
        appell.diagnose(recordings, limits={"nothing": (0, 1)}, progress=False)


def test_an_interruption_ends_a_diagnosis_at_once(rig):
    script = f"import appell; print('begin', flush=True); appell.diagnose({str(rig)!r}, progress=False)"
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.readline()
    time.sleep(0.5)
    start = time.monotonic()
    process.send_signal(subprocess.signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert time.monotonic() - start < 10
    assert b"KeyboardInterrupt" in errors


def test_an_exception_of_the_progress_is_raised(rig):
    def full(stage):
        raise OSError("no space")

    with pytest.raises(OSError, match="no space"):
        appell.diagnose(rig, progress=full)


def test_effects_of_ones_own_are_taken(rig, tmp_path):
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("kind = 3\n")
    with pytest.raises(appell.SpecError) as failure:
        appell.diagnose(rig, effects=[wrong], progress=False)
    assert failure.value.diagnostics
