"""A simulated motion."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._notebook import Page, Picture, framed
from ._values import Vector, labelled

from . import _appell

if TYPE_CHECKING:
    from ._model import Model


class Motion:
    """Columns over time, in SI. `motion["theta"]` is a column, `motion.t` the times in s.

    >>> import appell
    >>> motion = appell.load("pendulum").simulate(2, initial={"theta": "30deg"})
    >>> motion["theta"].shape == motion.t.shape
    True
    >>> motion.failure is None
    True
    """

    def __init__(self, native: _appell.Simulated, model: Model):
        self._native = native
        self._model = model
        self._summary: str | None = None
        told = native.columns()
        self.columns: tuple[str, ...] = tuple(name for name, *_ in told)
        """Names of the columns: states, inputs, outputs, energies and requested extra columns."""
        self.units: dict[str, str] = {name: unit for name, _, unit, _ in told}
        """Units of the spec, by column."""
        self.about: dict[str, str] = {name: about for name, about, _, _ in told}
        """Meanings, by column."""
        self._scales = {name: scale for name, _, _, scale in told}
        self.t: np.ndarray = native.times()
        """Times in s, (N,)."""
        self.values: Vector = labelled(native.values(), self.columns)
        """All columns in SI, (N, columns)."""
        self._states = model.states

    @property
    def x(self) -> Vector:
        """The states in SI, (N, n)."""
        return labelled(np.asarray(self.values)[:, : len(self._states)], self._states)

    @property
    def failure(self) -> str | None:
        """Why the motion ends early; None if it does not."""
        return self._native.failure

    @property
    def undefined(self) -> str | None:
        """The first non-finite inputs, outputs and energies, with their times; None if all are finite."""
        return self._native.undefined

    @property
    def held_from(self) -> float | None:
        """The time in s from which the last values of recorded inputs are held."""
        return self._native.held_from

    @property
    def statistics(self) -> dict[str, int]:
        """Steps, rejected steps and evaluations of the rates."""
        return self._native.statistics()

    @property
    def summary(self) -> dict[str, Any]:
        """First and last values, extrema and events."""
        return json.loads(self._native.summary() if self._summary is None else self._summary)

    def __getitem__(self, column: str) -> np.ndarray:
        return self.values[column]

    def __len__(self) -> int:
        return len(self.t)

    def in_unit(self, column: str) -> np.ndarray:
        """A column in the unit of the spec."""
        return self[column] / self._scales[column]

    def to_pandas(self) -> Any:
        """A `DataFrame` in SI over the time; needs pandas."""
        import pandas

        index = pandas.Index(self.t, name="t")
        return pandas.DataFrame(np.asarray(self.values), index=index, columns=list(self.columns))

    def to_xarray(self) -> Any:
        """A `Dataset` in SI with the dimension `t`; needs xarray."""
        import xarray

        def variable(name: str) -> tuple[str, np.ndarray, dict[str, str]]:
            attributes = {"long_name": self.about[name], "unit_of_spec": self.units[name]}
            return ("t", self[name], attributes)

        time = ("t", self.t, {"units": "s"})
        return xarray.Dataset({name: variable(name) for name in self.columns}, coords={"t": time})

    def plot(self, *columns: str, axes: Any = None) -> Any:
        """Plots columns, all states by default, in the units of the spec; needs matplotlib. Returns the axes."""
        import matplotlib.pyplot as plt

        columns = columns or self._states
        if axes is None:
            size = (6.4, 1.2 + 1.3 * len(columns))
            axes = plt.subplots(len(columns), sharex=True, squeeze=False, figsize=size, layout="constrained")[1][:, 0]
        for ax, column in zip(np.ravel(axes), columns, strict=True):
            ax.plot(self.t, self.in_unit(column))
            unit = self.units[column]
            ax.set_ylabel(f"{column} [{unit}]" if unit not in ("", "1") else column)
            ax.grid(alpha=0.3)
        np.ravel(axes)[-1].set_xlabel("t [s]")
        return axes

    @property
    def page(self) -> Page:
        """The moving mechanism, with plots."""
        return Page(self._native.page(), 560)

    @property
    def figure(self) -> Picture:
        """States and inputs over time."""
        return Picture(self._native.figure())

    def to_csv(self, path: str | Path) -> None:
        """Writes the columns in the units of the spec, as `appell simulate --out` does."""
        Path(path).write_bytes(self._native.csv())

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._model, self._native.parts(), json.dumps(self.summary))

    def _repr_html_(self) -> str:
        return framed(self._native.page(), 560)

    def __repr__(self) -> str:
        last = f"{self.t[-1]:g} s" if len(self.t) else "nothing"
        ended = f"; ended early: {self.failure}" if self.failure else ""
        return f"<motion of {last}, {len(self)} rows: {', '.join(self.columns)}{ended}>"


def _restored(model: Model, parts: tuple[Any, ...], summary: str) -> Motion:
    motion = Motion(_appell.restored(model, *parts), model)
    motion._summary = summary
    return motion


class Motions:
    """Motions that differ in their initial states, over the same times. `motions["theta"]` has a row a motion, and
    `motions[3]` is a `Motion`.

    >>> import appell, numpy as np
    >>> m = appell.load("pendulum")
    >>> motions = m.simulate(2, initial=np.array([[0.0, 0.1], [0.0, 0.2], [0.0, 0.3]]))
    >>> len(motions), motions["theta"].shape == (3, len(motions.t))
    (3, True)
    """

    def __init__(self, motions: Sequence[Motion]):
        self._motions = tuple(motions)
        longest = max(self._motions, key=len)
        self.columns: tuple[str, ...] = longest.columns
        """Names of the columns, as those of a `Motion`."""
        self.t: np.ndarray = longest.t
        """Times in s, (K,)."""
        values = np.full((len(self._motions), *longest.values.shape), np.nan)
        for rows, motion in zip(values, self._motions, strict=True):
            # A motion that ends early has its last row where it ends, which is no time of the others.
            same = int(np.argmin(np.append(motion.t == self.t[: len(motion)], False)))
            rows[:same] = motion.values[:same]
        self.values: Vector = labelled(values, self.columns)
        """All columns in SI, (N, K, columns); NaN after the end of a motion that ends early."""
        self._states = longest._states

    @property
    def x(self) -> Vector:
        """The states in SI, (N, K, n)."""
        return labelled(np.asarray(self.values)[..., : len(self._states)], self._states)

    @property
    def failures(self) -> tuple[str | None, ...]:
        """Why each motion ends early; None if it does not."""
        return tuple(motion.failure for motion in self._motions)

    def __getitem__(self, which: str | int) -> Any:
        return self.values[which] if isinstance(which, str) else self._motions[which]

    def __len__(self) -> int:
        return len(self._motions)

    def __repr__(self) -> str:
        return f"<{len(self)} motions, {len(self.t)} rows each: {', '.join(self.columns)}>"
