"""Exceptions, with the positions of the findings."""

from __future__ import annotations

import json
from dataclasses import dataclass


@dataclass(frozen=True)
class Diagnostic:
    """A finding in a spec, or in an expression of a request."""

    severity: str
    """`error`, `warning` or `note`."""
    code: str | None
    message: str
    help: str | None
    """The suggested correction."""
    line: int
    column: int


class Error(Exception):
    """A request that cannot be answered."""

    def __init__(self, message: str, diagnostics: str = "[]", field: str | None = None):
        super().__init__(message)
        self.diagnostics: list[Diagnostic] = [Diagnostic(**found) for found in json.loads(diagnostics)]
        """The findings, with their positions."""
        self.field = field
        """The invalid part of the request."""


class SpecError(Error):
    """A spec, an effect or a description is invalid; `diagnostics` has the positions."""


class RequestError(Error, ValueError):
    """The request names something that does not exist, or is inconsistent."""


class DataError(Error):
    """A file is invalid or cannot be read."""


class ComputationError(Error):
    """The computation failed."""


class EndsEarly(UserWarning):
    """A motion ends before its final time."""


class Unstable(UserWarning):
    """A closed loop is unstable."""
