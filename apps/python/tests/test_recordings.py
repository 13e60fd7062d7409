"""From recordings to causes."""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
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
    assert json.loads((tmp_path / "gap.json").read_text()) == diagnosis.to_dict()
    with pytest.warns(DeprecationWarning, match="to_dict"):
        assert diagnosis.told == diagnosis.to_dict()
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
    # A diagnosis may be over before the interruption comes.
    script = f"import appell; print('begin', flush=True)\nwhile True: appell.diagnose({str(rig)!r}, progress=False)"
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


SWING = """
mechanism = "pendulum"
[parameters]
m = { value = 1.2, unit = "kg", std = 0.1 }
[channels]
angle = { measures = "theta", unit = "deg" }
motor = { input = "tau", unit = "N m", interpolation = "linear" }
clock = { time = true, unit = "ms" }
[runs]
fit = ["first"]
test = ["second"]
"""


def swing(phase):
    t = np.arange(0, 3, 0.01)
    angle = np.degrees(0.3 * np.sin(3 * t + phase)) + 0.05 * np.sin(1e4 * t)
    return {"clock": 1e3 * t, "angle": angle, "motor": 0.2 * np.cos(2 * t)}


def test_frames_are_recordings():
    frames = {"first": swing(0), "second": swing(1)}
    found = appell.Recordings(frames, description=SWING)
    assert found.runs == ["first", "second"]
    first = found["first"]
    assert np.allclose(first["t"], np.arange(0, 3, 0.01), atol=1e-12)
    assert np.allclose(first["angle"], np.radians(frames["first"]["angle"]))
    with pytest.raises(appell.DataError, match="no run of this name"):
        appell.Recordings({"first": swing(0)}, description=SWING)
    with pytest.raises(ValueError, match="one length, not 2, 3"):
        appell.Recordings({"t": [0, 1], "theta": [1, 2, 3]}, "pendulum")


class Frame:
    """What a frame of any library has: columns by name."""

    def __init__(self, columns):
        self._columns = columns
        self.columns = list(columns)

    def __getitem__(self, name):
        return self._columns[name]


def test_frames_of_any_library_are_runs_by_name():
    frames = {"first": Frame(swing(0)), "second": Frame(swing(1))}
    found = appell.Recordings.from_frames(frames, description=SWING)
    assert found.runs == ["first", "second"]
    assert np.allclose(found["second"]["angle"], np.radians(swing(1)["angle"]))
    untimed = {name: {"theta": frame["angle"], "tau": frame["motor"]} for name, frame in frames.items()}
    found = appell.Recordings.from_frames(untimed, "pendulum", rate_hz=100)
    assert np.allclose(found["first"]["t"], np.arange(300) / 100)
    for rate in (0, -1, float("nan")):
        with pytest.raises(ValueError, match="rows per second"):
            appell.Recordings.from_frames(untimed, "pendulum", rate_hz=rate)
    with pytest.raises(ValueError, match="first has no columns"):
        appell.Recordings.from_frames({"first": [1, 2, 3]}, "pendulum")
    with pytest.raises(ValueError, match="column `t`"):
        appell.Recordings.from_frames({"first": {"t": [0, 1], "theta": [0, 1]}}, "pendulum", rate_hz=10)


def test_frames_are_drafted_and_the_draft_reads_them(tmp_path):
    frames = {}
    for name, phase in [("first", 0.0), ("second", 0.7)]:
        t = np.arange(0, 3, 0.01)
        frames[name] = {"t": t, "theta": 0.1 * np.cos(3 * t + phase), "tau": np.sign(np.sin(2 * t + phase))}
    draft = appell.Recordings.draft(frames, "pendulum", path=tmp_path / "recording.toml")
    assert "theta" in draft.text
    assert appell.Recordings(frames, description=draft.text).channels == ["theta", "tau"]
    assert draft.write().read_text() == draft.text
    with pytest.raises(FileExistsError):
        draft.write()
    untimed = {name: {"theta": frame["theta"], "tau": frame["tau"]} for name, frame in frames.items()}
    draft = appell.Recordings.draft(untimed, "pendulum", rate_hz=100)
    assert np.allclose(appell.Recordings(untimed, description=draft.text)["first"]["t"], np.arange(300) / 100)


def test_a_frame_of_pandas_is_a_run():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(swing(0))
    found = appell.Recordings.from_frames({"first": frame, "second": frame}, description=SWING)
    assert np.allclose(found["first"]["angle"], np.radians(swing(0)["angle"]))


def test_frames_of_pandas_and_polars_are_recordings():
    columns = {"theta": 0.3 * np.sin(3 * np.arange(0, 3, 0.01)), "note": ["as planned"] * 300}
    pandas = pytest.importorskip("pandas")
    stamps = pandas.date_range("2026-01-01", periods=300, freq="10ms")
    frame = pandas.DataFrame(columns, index=pandas.Index(stamps, name="timestamp"))
    frame.loc[frame.index[7], "theta"] = None
    run = appell.Recordings([frame, frame], "pendulum")["run1"]
    assert run["t"][-1] == pytest.approx(2.99, abs=1e-9)
    assert np.isnan(run["theta"][7]) and not np.isnan(run["theta"][8])
    # Dates with a time zone, and those of the standard library, are objects to numpy.
    zoned = stamps.tz_localize("UTC")
    for times in [zoned, zoned.tz_convert("Europe/Berlin"), stamps, stamps - stamps[0]]:
        for column in [times, pandas.Series(list(times), dtype=object)]:
            frame = pandas.DataFrame({"t": column, "theta": columns["theta"]})
            assert np.allclose(appell.Recordings([frame], "pendulum")["run1"]["t"], 0.01 * np.arange(300), atol=1e-9)
    polars = pytest.importorskip("polars")
    frame = polars.DataFrame({"time": 0.01 * np.arange(300), "theta": columns["theta"]})
    run = appell.Recordings({"a": frame, "b": frame}, "pendulum")["b"]
    assert np.array_equal(run["theta"], columns["theta"])
