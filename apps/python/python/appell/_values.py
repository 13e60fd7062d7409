"""Numbers with names: vectors of states, and values of a request."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np


class Vector(np.ndarray):
    """An array whose last axis has names: `x["theta"]` is a number, or one a row.

    >>> x = labelled([1.0, 2.0], ("omega", "theta"))
    >>> x["theta"]
    2.0
    >>> x["theta"] = 3.0
    >>> x
    Vector(omega=1.0, theta=3.0)
    """

    names: tuple[str, ...] | None

    def __array_finalize__(self, other: Any) -> None:
        # A view with other strides may have its columns in another order.
        names = getattr(other, "names", None)
        same = names is not None and self.shape == other.shape
        turned = same and self.strides != other.strides and np.may_share_memory(self, other)
        self.names = names if same and not turned else None

    def __reduce__(self) -> tuple[Any, ...]:
        if self.names is None:
            return np.asarray, (np.asarray(self),)
        return labelled, (np.asarray(self), self.names)

    def _place(self, name: str) -> int:
        names = self.names or ()
        if name not in names:
            there = ", ".join(names) or "no names"
            raise KeyError(f"there is no `{name}`; there are {there}")
        return names.index(name)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            column = np.asarray(self)[..., self._place(key)]
            return column.item() if column.ndim == 0 else column
        found = super().__getitem__(key)
        if isinstance(found, Vector):
            found.names = self.names if _keeps_columns(key, self.ndim) else None
        return found

    def __setitem__(self, key: Any, value: Any) -> None:
        if isinstance(key, str):
            np.asarray(self)[..., self._place(key)] = value
        else:
            super().__setitem__(key, value)

    def __repr__(self) -> str:
        if self.names is None or self.ndim != 1:
            return np.asarray(self).__repr__().replace("array", "Vector", 1)
        pairs = zip(self.names, np.asarray(self).tolist(), strict=True)
        return f"Vector({', '.join(f'{name}={value!r}' for name, value in pairs)})"

    __str__ = __repr__

    def to_dict(self) -> dict[str, Any]:
        """Values by name."""
        return {name: self[name] for name in self.names or ()}


def _keeps_columns(key: Any, ndim: int) -> bool:
    """Whether an index leaves the last axis as it is."""
    if isinstance(key, tuple):
        plain = all(isinstance(one, (int, slice, np.integer)) for one in key)
        return plain and (len(key) < ndim or key[-1] == slice(None))
    if isinstance(key, slice) and ndim == 1:
        return key == slice(None)
    return ndim > 1 and key is not None and key is not Ellipsis and np.ndim(key) <= 1


def contiguous(value: Any) -> np.ndarray:
    """An array of doubles, row by row."""
    if isinstance(value, dict):
        raise TypeError("a place is an array: `model.state(theta=0.1)` makes one")
    if hasattr(value, "columns"):
        raise TypeError("columns may be in another order: give `frame[list(model.states)].to_numpy()`")
    found = np.asarray(value)
    if np.iscomplexobj(found):
        raise TypeError("complex numbers have no meaning here; `jacobians` are exact")
    return np.asarray(found, dtype=np.float64, order="C")


def many(names: Any) -> list[Any]:
    """Names; a single one may stand alone."""
    return [names] if isinstance(names, (str, Path)) else list(names)


def labelled(numbers: Any, names: Iterable[str]) -> Vector:
    """An array with names for its last axis; not copied."""
    vector = np.asarray(numbers, dtype=float).view(Vector)
    vector.names = tuple(names)
    if vector.ndim == 0 or vector.shape[-1] != len(vector.names):
        raise ValueError(f"{len(vector.names)} names and the shape {vector.shape}")
    return vector


def texts(values: Mapping[str, Any] | None, scales: Mapping[str, float]) -> list[tuple[str, str]]:
    """Values of a request: texts have units or those of the spec, numbers are in SI."""
    return [(name, text(value, scales.get(name, 1.0))) for name, value in (values or {}).items()]


def text(value: Any, scale: float) -> str:
    """A value as the spec would write it."""
    if isinstance(value, str):
        return value
    number = float(value) / scale
    if not math.isfinite(number):
        raise ValueError(f"{value} is not a finite number")
    return repr(number)
