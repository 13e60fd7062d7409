"""Results that can be read as a dictionary."""

from __future__ import annotations

import warnings
from typing import Any


class Report:
    """Results that a command writes with `--json`."""

    _fields: dict[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """All results, as the command writes them with `--json`."""
        return self._fields

    @property
    def told(self) -> dict[str, Any]:
        """Deprecated: use `to_dict()`."""
        warnings.warn("`told` is deprecated: use `to_dict()`", DeprecationWarning, stacklevel=2)
        return self._fields
