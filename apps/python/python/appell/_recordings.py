"""Recordings of a rig: identification and diagnosis."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from . import _appell
from ._model import Model
from ._notebook import Page, Picture, Progress, framed, reporter
from ._report import Report
from ._values import many

Paths = str | Path | Sequence[str | Path]
# A folder or files; or data frames, and mappings of columns, one or several.
Data = Any


@dataclass(frozen=True)
class Draft:
    """A drafted description of recordings."""

    text: str
    """The text of a `recording.toml`, for `description` or for a file."""
    questions: list[str]
    """What the recordings do not tell, a sentence each."""
    path: Path
    """Where it belongs."""

    def write(self, *, force: bool = False) -> Path:
        """Writes the file; without `force` an existing one is left as it is."""
        with self.path.open("w" if force else "x", encoding="utf-8") as file:
            file.write(self.text)
        return self.path


class Recordings(_appell.DataSet, Report):
    """Recordings: a folder with a `recording.toml`, or CSV files of a mechanism; or data frames.

    A frame is one of pandas or polars, or a mapping of arrays by the name of the column; several are a list, or a
    mapping by the name of the run. Without a `description` columns have the names and units of the mechanism, and the
    last third of the frames is held out, or of a single one its last third. `description` is the text or the path of a
    `recording.toml`, whose `[runs]` name the frames: `run1`, `run2` … in a list.

    >>> import appell, numpy as np
    >>> t = np.arange(0, 3, 0.01)
    >>> columns = {"time": t, "theta": 0.1 * np.cos(3 * t), "tau": np.sign(np.sin(t))}
    >>> appell.Recordings(columns, "pendulum").channels
    ['theta', 'tau']
    """

    def __new__(
        cls, data: Data, model: Model | str | Path | None = None, *, description: str | Path | None = None
    ) -> Recordings:
        frames = _frames(data)
        if frames is not None:
            return super().__new__(cls, [], _name(model), frames, _described(description))
        if description is not None:
            raise ValueError("description: a folder or a file has its own recording.toml")
        paths = [data] if isinstance(data, (str, Path)) else list(data)
        return super().__new__(cls, [str(path) for path in paths], _name(model))

    @classmethod
    def from_frames(
        cls,
        frames: Mapping[str, Any],
        model: Model | str | Path | None = None,
        *,
        description: str | Path | None = None,
        rate_hz: float | None = None,
    ) -> Recordings:
        """Recordings of frames by the names of the runs. With `rate_hz`, rows per second, no column is the time.

        >>> import appell, numpy as np
        >>> rows = np.arange(300)
        >>> run = {"theta": 0.1 * np.cos(0.03 * rows), "tau": np.sign(np.sin(rows))}
        >>> appell.Recordings.from_frames({"day1": run, "day2": run}, "pendulum", rate_hz=100).runs
        ['day1', 'day2']
        """
        wrong = [str(name) for name, frame in frames.items() if not _is_frame(frame)]
        if wrong:
            raise ValueError(f"frames: {', '.join(wrong)} has no columns; give a frame for each run")
        if rate_hz is None:
            return cls(frames, model, description=description)
        if not rate_hz > 0:
            raise ValueError(f"rate_hz is the number of rows per second, not {rate_hz}")
        timed = {name: _timed(frame, rate_hz) for name, frame in frames.items()}
        return cls(timed, model, description=description)

    @staticmethod
    def draft(
        data: Data,
        model: str | Path,
        *,
        path: str | Path = "recording.toml",
        rate_hz: float | None = None,
    ) -> Draft:
        """Drafts the description of frames or files of a mechanism: a shipped one, a spec or a robot file.

        Columns are found by their names and by their motion. `path` is where the description will be; models are named
        relative to it.

        >>> import appell, numpy as np
        >>> t = np.arange(0, 3, 0.01)
        >>> swing = {"time": t, "theta": 0.1 * np.cos(3 * t), "tau": np.sign(np.sin(t))}
        >>> draft = appell.Recordings.draft({"day1": swing, "day2": swing}, "pendulum")
        >>> appell.Recordings({"day1": swing, "day2": swing}, description=draft.text).channels
        ['theta', 'tau']
        """
        frames = _frames(data)
        paths = [] if frames is not None else [data] if isinstance(data, (str, Path)) else list(data)
        text, questions = _appell.DataSet._draft([str(own) for own in paths], frames, str(model), str(path), rate_hz)
        return Draft(text, questions, Path(path))

    @cached_property
    def _fields(self) -> dict[str, Any]:
        return json.loads(self.json())

    def to_dict(self) -> dict[str, Any]:
        """Runs, channels, noise and findings, as `appell recording --json` writes them."""
        return self._fields

    @property
    def runs(self) -> list[str]:
        """Names of the runs; `to_dict()["findings"]` has the findings about them."""
        return [run["run"] for run in self._fields["runs"]]

    @property
    def channels(self) -> list[str]:
        """Names of the columns."""
        return [channel["channel"] for channel in self._fields["channels"]]

    def __getitem__(self, run: str) -> dict[str, np.ndarray]:
        """The columns of a run in SI, with the times `t` in s."""
        found = self._run(run)
        if found is None:
            raise KeyError(f"there is no run `{run}`; there are {', '.join(self.runs)}")
        times, columns = found
        return {"t": times, **dict(zip(self.channels, columns, strict=True))}

    def __repr__(self) -> str:
        return f"<recordings {', '.join(self.runs)}: {', '.join(self.channels)}>"


class Identification(Report):
    """Estimated parameters with their intervals; a page in a notebook."""

    def __init__(self, native: _appell.Identified):
        self._native = native

    @cached_property
    def _fields(self) -> dict[str, Any]:
        return json.loads(self._native.json())

    def to_dict(self) -> dict[str, Any]:
        """All results, as `appell identify --json` writes them."""
        return self._fields

    @property
    def parameters(self) -> dict[str, dict[str, Any]]:
        """By name: `value`, `std`, `interval95`, `nominal`, `unit` …, in SI."""
        return {one["name"]: one for one in self._fields["parameters"]}

    @property
    def values(self) -> dict[str, float]:
        """Estimates in SI by name, for `simulate(parameters=...)`."""
        return {name: one["value"] for name, one in self.parameters.items()}

    @property
    def figure(self) -> Picture:
        """The held-out runs with their predictions."""
        return Picture(self._native.figure())

    @property
    def page(self) -> Page:
        """The report."""
        return Page(self._native.page(), 1000)

    def _repr_html_(self) -> str:
        return framed(self._native.page(), 1000)

    def __repr__(self) -> str:
        return self._native.text()


class Diagnosis(Report):
    """A diagnosed gap: where it lies, what causes it, how far it closes. A page in a notebook."""

    def __init__(self, native: _appell.Gap):
        self._native = native

    @cached_property
    def json(self) -> str:
        """The gap report, byte for byte as `appell diagnose --json -` writes it."""
        return self._native.json()

    @cached_property
    def _fields(self) -> dict[str, Any]:
        return json.loads(self.json)

    def to_dict(self) -> dict[str, Any]:
        """The gap report."""
        return self._fields

    @property
    def sentence(self) -> str:
        """The diagnosis in one sentence, with its probability and the alternatives."""
        return self._native.sentence()

    @property
    def hypotheses(self) -> list[dict[str, Any]]:
        """Hypotheses, the most probable one first, each with `effects`, `probability`, `log_bayes_factor` and
        `parameters`. The effect `unknown` stands for the part that no effect of the library explains."""
        return self._fields["which"]

    @property
    def page(self) -> Page:
        """The report."""
        return Page(self._native.page(), 1000)

    @property
    def experiment(self) -> str | None:
        """Inputs of the most informative next experiment, as CSV."""
        return self._native.experiment()

    def apply(self, hypothesis: int | None = None) -> Model:
        """The model with the leading hypothesis applied, or with another one, numbered from 1; of a spec."""
        if self._native._robot() is not None:
            raise ValueError("the mechanism is a robot file: `improved` has its text with the changes")
        return Model(self.improved(hypothesis)[0], text=True)

    def improved(self, hypothesis: int | None = None, file: str = "improved.toml") -> tuple[str, str]:
        """The text of the spec or the robot file with that effect, and a summary of the changes."""
        if hypothesis is not None and hypothesis < 1:
            raise ValueError("hypotheses are numbered from 1")
        if (robot := self._native._robot()) is not None:
            return _appell.corrected_robot(Path(robot), self.json, hypothesis)
        spec, text = self._native._spec()
        return _appell.apply(spec, text, self.json, hypothesis, file)

    def save(self, path: str | Path) -> None:
        """Writes the gap report: as a page to `.html`, else as JSON."""
        path = Path(path)
        text = self._native.page() if path.suffix == ".html" else self.json
        path.write_text(text, encoding="utf-8")

    def _repr_html_(self) -> str:
        return framed(self._native.page(), 1000)

    def __repr__(self) -> str:
        return self.sentence


def identify(
    data: Recordings | Data,
    model: Model | str | Path | None = None,
    *,
    free: Sequence[str] | None = None,
    also: Sequence[str] = (),
    drifting: Mapping[str, float] | None = None,
    start: str = "nominal",
    progress: Progress | bool = True,
) -> Identification:
    """Estimates parameters by maximum likelihood, with intervals and errors on held-out runs.

    `free` names parameters; by default those with a tolerance in the data set. `also` names lags, delays, biases and
    scales such as `tau.delay` and `theta.bias`; `drifting` gives parameters that drift the standard deviation of their
    change in one second. `start` is `nominal`, or `shooting` if the nominal values are far off.
    """
    if start not in ("nominal", "shooting"):
        raise ValueError(f"start is `nominal` or `shooting`, not `{start}`")
    set_ = _read(data, model)
    with reporter(progress) as tell:
        rates = list((drifting or {}).items())
        free = None if free is None else many(free)
        native = set_._identify(free, many(also), rates, start == "shooting", tell)
    return Identification(native)


def base_parameters(model: Model | str | Path, data: Recordings | Data | None = None) -> dict[str, Any]:
    """The identifiable combinations of inertial and load parameters, as
    `appell base --json` writes them; with recordings of a motion and of all inputs, their values with intervals.

    >>> import appell
    >>> [base["text"] for base in appell.base_parameters("pendulum")["base"]]
    ['mx_rod', 'mz_rod', 'Iyy_rod']
    """
    set_ = None if data is None else _read(data, model)
    model = model if isinstance(model, Model) else Model(str(model))
    return json.loads(model._base(set_))


def diagnose(
    data: Recordings | Data,
    model: Model | str | Path | None = None,
    *,
    effects: Sequence[str | Path] = (),
    without: Sequence[str] = (),
    horizon: float | None = None,
    tolerance: float | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    alternatives: Sequence[str | Path] = (),
    against: Recordings | Data | None = None,
    progress: Progress | bool = True,
) -> Diagnosis:
    """Diagnoses the gap between recordings and their model: where it lies, which unmodelled effect causes it, and how
    far it closes on held-out runs once the effect is added.

    `effects` are files of your own effects, `without` kinds of shipped ones to leave out, `horizon` the horizon of
    predictions in s, `tolerance` the part of the gap below which an effect names no cause, `limits` by column those of
    the next experiment in the column's unit, `alternatives` other specs of the same rig, `against` earlier recordings.
    `progress` shows the stages, is silent if false, and is called with each if it is a function. Ctrl-C ends it.
    """
    set_ = _read(data, model)
    before = None if against is None else _read(against, model)
    scaled = []
    for column, ends in (limits or {}).items():
        scale = set_._scale(column)
        if scale is None:
            raise ValueError(f"limits: there is no column `{column}`; the columns are {', '.join(set_.channels)}")
        low, high = (scale * end for end in ends)
        scaled.append((column, [low, high]))
    with reporter(progress) as tell:
        native = set_._diagnose(
            [str(path) for path in many(effects)],
            many(without),
            horizon,
            tolerance,
            scaled,
            [str(path) for path in many(alternatives)],
            before,
            tell,
        )
    return Diagnosis(native)


def sample_rig(folder: str | Path) -> list[str]:
    """Writes the spec of a simulated rig, three recordings and their description; returns the names of the files.

    The rig has effects that its spec lacks: `diagnose(folder)` finds them.
    """
    return _appell.sample(str(folder))


def _is_frame(data: Any) -> bool:
    """Whether it has columns by name."""
    if hasattr(data, "columns") and hasattr(data, "__getitem__"):
        return True
    return isinstance(data, Mapping) and not any(_is_frame(value) for value in data.values())


def _frames(data: Any) -> list[tuple[str, list[tuple[str, np.ndarray]]]] | None:
    """Names of runs with their columns; nothing for paths."""
    if isinstance(data, (str, Path)):
        return None
    if _is_frame(data):
        return [("run1", _columns(data))]
    if isinstance(data, Mapping):
        return [(str(name), _columns(frame)) for name, frame in data.items()]
    several = list(data)
    if not several or not all(_is_frame(frame) for frame in several):
        return None
    return [(f"run{number}", _columns(frame)) for number, frame in enumerate(several, 1)]


def _columns(frame: Any) -> list[tuple[str, np.ndarray]]:
    """The columns of numbers, and an index with a name or with times."""
    columns = []
    index = getattr(frame, "index", None)
    if index is not None and hasattr(index, "to_numpy"):
        values = _numbers(index)
        is_rows = index.name is None and values is not None and np.array_equal(values, np.arange(len(values)))
        if values is not None and not is_rows:
            columns.append((str(index.name or "t"), values))
    for name in frame if isinstance(frame, Mapping) else frame.columns:
        values = _numbers(frame[name])
        if values is not None:
            columns.append((str(name), values))
    lengths = {len(values) for _, values in columns}
    if len(lengths) > 1:
        raise ValueError(f"the columns of a frame have one length, not {', '.join(map(str, sorted(lengths)))}")
    return columns


def _timed(frame: Any, rate_hz: float) -> dict[str, np.ndarray]:
    """The columns of numbers with times at a rate, which no other column may have."""
    columns = {str(name): frame[name] for name in (frame if isinstance(frame, Mapping) else frame.columns)}
    if "t" in columns:
        raise ValueError("rate_hz: the frame has a column `t` of times already")
    rows = max((len(values) for values in columns.values()), default=0)
    return {"t": np.arange(rows) / rate_hz, **columns}


def _numbers(column: Any) -> np.ndarray | None:
    """The numbers of a column, dates in s from the first one on; None for texts."""
    values = np.asarray(column)
    if values.dtype.kind in "mM":
        unit = np.timedelta64(1, "ns")
        passed = (values - (values[:1] if values.dtype.kind == "M" else np.timedelta64(0, "ns"))) / unit
        return np.ascontiguousarray(1e-9 * passed)
    try:
        if values.dtype.kind == "O":
            first = next((value for value in values if not _is_missing(value)), None)
            values = np.array([np.nan if _is_missing(value) else _passed(value, first) for value in values], dtype=object)
        numbers = np.ascontiguousarray(values, dtype=float)
    except (TypeError, ValueError):
        return None
    return numbers if numbers.ndim == 1 else None


def _passed(value: Any, first: Any) -> Any:
    """Seconds of a date with a time zone from the first one on, and of a span of time; other values as they are."""
    span = value - first if hasattr(value, "timestamp") else value
    return span.total_seconds() if hasattr(span, "total_seconds") else value


def _is_missing(value: Any) -> bool:
    return value is None or type(value).__name__ in ("NAType", "NaTType")


def _described(description: str | Path | None) -> tuple[str, str] | None:
    """Path and text of a description."""
    if description is None:
        return None
    if isinstance(description, Path) or "\n" not in description:
        return str(description), Path(description).read_text(encoding="utf-8")
    return "description", description


def _read(data: Recordings | Data, model: Model | str | Path | None) -> Recordings:
    if not isinstance(data, Recordings):
        return Recordings(data, model)
    if model is not None and not _is_of(data._file(), model):
        raise ValueError("these recordings have another mechanism: give this one where they are read")
    return data


def _is_of(file: str, model: Model | str | Path) -> bool:
    """Whether a model is that of a file, or has none."""
    name = model._reference if isinstance(model, Model) else str(model)
    if name is None or name in (file, Path(file).stem):
        return True
    return Path(name).exists() and Path(file).exists() and Path(name).samefile(file)


def _name(model: Model | str | Path | None) -> str | None:
    if isinstance(model, Model):
        if model._reference is None:
            raise ValueError("the model of a text has no file: give recordings the path of a spec")
        return model._reference
    return None if model is None else str(model)
