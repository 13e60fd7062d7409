"""Ensembles: many motions of a study, in independent chunks."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from . import _appell
from ._cluster import spread
from ._notebook import Page, framed
from ._report import Report


# Chunks in one call on a cluster, and the minimum number of calls.
GROUP, FEWEST_CALLS = 16, 64
# What computes motions: the processors, or the first NVIDIA graphics card.
DEVICES = ("cpu", "cuda")


class Ensemble(Report):
    """The rows of a study, as far as they are computed; a page in a notebook.

    It can be sent to other processes, which then find the rows where they are kept.
    """

    def __init__(
        self,
        study: str | Path,
        out: str | Path | None = None,
        *,
        folder: str | Path | None = None,
        device: str = "cpu",
    ):
        study = str(study)
        if "\n" in study and folder is None:
            folder = "."
        if device not in DEVICES:
            raise ValueError(f"device is one of {', '.join(DEVICES)}, not {device!r}")
        self._made = (study, None if out is None else str(out), None if folder is None else str(folder), device)
        self._native = _appell.Study(study, self._made[2], self._made[1], device == "cuda")

    def __reduce__(self):
        return _restored, self._made

    def cuda(self) -> list[str]:
        """The CUDA sources of the motions, one for each spec and law."""
        return self._native.cuda()

    @property
    def cases(self) -> int:
        """Number of all cases."""
        return self._native.cases

    def chunks(self, chunk: int | None = None) -> list[str]:
        """Names of all chunks, of `chunk` cases each."""
        return self._native.chunks(chunk)

    def missing(self, *, shard: str | None = None, chunk: int | None = None) -> list[str]:
        """Names of the missing chunks."""
        return self._native.missing(shard, chunk)

    def run(
        self,
        chunks: Sequence[str] | None = None,
        *,
        jobs: int | None = None,
        shard: str | None = None,
        chunk: int | None = None,
        progress: Callable[[str], Any] | None = None,
    ) -> Ensemble:
        """Runs chunks by their names, or the missing ones, on `jobs` threads."""
        self._native.run(None if chunks is None else list(chunks), jobs, shard, chunk, progress)
        self._forget()
        return self

    def spread(
        self,
        address: str | None = None,
        *,
        shard: str | None = None,
        chunk: int | None = None,
        progress: Callable[[str], Any] | None = None,
    ) -> Ensemble:
        """Runs the missing chunks on a Ray cluster, see `appell.spread`.

        Rows do not pass through this process: every worker writes the chunks that it finishes to `out`, a folder that
        all machines see under this path, as they see the study. A chunk whose worker or machine is lost is run again.
        """
        study, out, folder, device = self._made
        if out is None:
            raise ValueError("a cluster needs a folder for the rows, `out`, that all machines see")
        missing = self.missing(shard=shard, chunk=chunk)
        # A call has chunks for some seconds, and each processor gets several calls.
        group = max(1, min(GROUP, len(missing) // FEWEST_CALLS))
        groups = [missing[first : first + group] for first in range(0, len(missing), group)]
        done = 0
        made = (study if "\n" in study else _absolute(study), _absolute(out), folder and _absolute(folder), device)
        for number, _ in spread(_run, [(made, names, chunk) for names in groups], address):
            done += len(groups[number])
            if progress is not None:
                progress(f"chunk {done} of {len(missing)}")
        self._forget()
        return self

    def _forget(self) -> None:
        for kept in ("_rows", "_all"):
            self.__dict__.pop(kept, None)

    @cached_property
    def _rows(self) -> tuple[np.ndarray, list[np.ndarray], np.ndarray, list[str]]:
        return self._native.rows()

    @cached_property
    def _all(self) -> tuple[str, str, str]:
        return self._native.summary()

    @property
    def columns(self) -> list[str]:
        """Names of the factors and of the kept quantities; `course` has the courses."""
        return [name for name, _, _, _, course in self._native.columns() if course is None]

    @property
    def courses(self) -> list[str]:
        """Names of the courses."""
        return list(dict.fromkeys(course[0] for *_, course in self._native.columns() if course))

    def __getitem__(self, name: str) -> np.ndarray:
        """A column in SI, a number a case."""
        for index, (own, *_, course) in enumerate(self._native.columns()):
            if own == name and course is None:
                return self._rows[1][index]
        raise KeyError(f"there is no column `{name}`; there are {', '.join(self.columns)}")

    def course(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """The times of a course in s, and its values in SI, a row a case; nan from an early end on."""
        columns = enumerate(self._native.columns())
        found = [(index, course[1]) for index, (*_, course) in columns if course and course[0] == name]
        if not found:
            raise KeyError(f"there is no course `{name}`; there are {', '.join(self.courses)}")
        times = np.array([t for _, t in found])
        return times, np.column_stack([self._rows[1][index] for index, _ in found])

    @property
    def case(self) -> np.ndarray:
        """Numbers of the completed cases."""
        return self._rows[0].astype(np.int64)

    @property
    def t_end(self) -> np.ndarray:
        """End time of each motion in s."""
        return self._rows[2]

    @property
    def reasons(self) -> list[str]:
        """Why each motion ended early; empty if it did not."""
        return self._rows[3]

    def to_dict(self) -> dict[str, Any]:
        """The statistics in SI, as `appell ensemble --json` writes them."""
        return self._fields

    @property
    def _fields(self) -> dict[str, Any]:
        return json.loads(self._all[0])

    @property
    def page(self) -> Page:
        """Statistics and figures."""
        return Page(self._all[2], 1000)

    def _repr_html_(self) -> str:
        return framed(self._all[2], 1000)

    def __repr__(self) -> str:
        return self._all[1]


# The ensemble that a worker compiled last.
_compiled: dict[tuple[Any, ...], Ensemble] = {}


def _run(made: tuple[str, str | None, str | None, str], names: Sequence[str], chunk: int | None) -> int:
    """Runs chunks in a worker, except those completed by a lost worker; returns how many."""
    if made not in _compiled:
        _compiled.clear()
        _compiled[made] = _restored(*made)
    study = _compiled[made]
    left = set(names).intersection(study.missing(chunk=chunk))
    for name in names:
        if name in left:
            study.run([name], jobs=1)
    return len(left)


def _absolute(path: str) -> str:
    return str(Path(path).absolute())


def _restored(study: str, out: str | None, folder: str | None, device: str) -> Ensemble:
    return Ensemble(study, out, folder=folder, device=device)


def ensemble(
    study: str | Path,
    out: str | Path | None = None,
    *,
    folder: str | Path | None = None,
    chunks: Sequence[str] | None = None,
    jobs: int | None = None,
    shard: str | None = None,
    chunk: int | None = None,
    progress: Callable[[str], Any] | None = None,
    ray: str | bool | None = None,
    device: str = "cpu",
) -> Ensemble:
    """Runs a study: the path of a study file, or its text, whose files lie in `folder`.

    Rows go to the folder `out` in chunks, or stay in memory. What is there already is not run again; `chunks` names
    those to run, as `Ensemble.missing` lists them. `ray` is the address of a Ray cluster that runs them, or `True` for
    the one that this machine belongs to or for this machine alone; see `Ensemble.spread`. With `device="cuda"` the first
    NVIDIA graphics card computes the motions, a thread each; their rows have chunks of their own.

    >>> import appell
    >>> swings = appell.ensemble('''
    ... [study]
    ... model = "pendulum"
    ... cases = 50
    ... [motion]
    ... t_end_s = 1
    ... [vary]
    ... theta = { normal = ["20deg", "2deg"] }
    ... [keep]
    ... reached = { end = "theta" }
    ... ''')
    >>> swings["reached"].shape
    (50,)
    """
    made = Ensemble(study, out, folder=folder, device=device)
    if ray is None or ray is False:
        return made.run(chunks, jobs=jobs, shard=shard, chunk=chunk, progress=progress)
    if chunks is not None or jobs is not None:
        raise ValueError("a cluster runs all chunks that are missing, on all of its processors: leave out chunks and jobs")
    return made.spread(None if ray is True else ray, shard=shard, chunk=chunk, progress=progress)
