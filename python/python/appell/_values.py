"""Numbers with names: vectors of states, and values of a request."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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
        names = getattr(other, "names", None)
        fits = names is not None and self.ndim > 0 and self.shape[-1] == len(names)
        self.names = names if fits else None

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
        return super().__getitem__(key)

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

    def to_dict(self) -> dict[str, Any]:
        """Values by name."""
        return {name: self[name] for name in self.names or ()}


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
    return value if isinstance(value, str) else repr(float(value) / scale)
