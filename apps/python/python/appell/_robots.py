"""Robot files as models."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from . import _appell
from ._errors import Diagnostic
from ._model import Model
from ._values import many

if TYPE_CHECKING:
    from ._recordings import Diagnosis


@dataclass(frozen=True)
class LeftOut:
    """Elements of a robot file that have no counterpart in a spec."""

    what: str
    """Such as `actuator/motor`."""
    file: str
    lines: tuple[int, ...]
    effect: str | None
    """How the motion differs without them; None where it does not."""


@dataclass(frozen=True)
class Robot:
    """A robot file as a spec."""

    name: str
    format: str
    """`URDF` or `MJCF`."""
    spec: str
    """The text of the spec."""
    bodies: int
    """Links that are fixed together count once."""
    joints: int
    """Joints that move."""
    warnings: dict[str, tuple[Diagnostic, ...]]
    """By file."""
    left_out: tuple[LeftOut, ...]
    nearly_right_angles: int
    """Orientations and axes that `snap=True` makes right."""

    def model(self) -> Model:
        """The model."""
        return Model(self.spec, text=True)

    def save(self, file: str | Path) -> None:
        """Writes the spec."""
        Path(file).write_text(self.spec, encoding="utf-8")


def import_robot(
    file: str | Path,
    *,
    parameters: str | Iterable[str] = "none",
    without: str | Iterable[str] = (),
    lock: Mapping[str, float | None] | Iterable[str] = (),
    snap: bool = False,
    floating: bool = False,
    actuators: bool = False,
    root: str | Path | None = None,
) -> Robot:
    """A URDF or an MJCF file as a spec, with the files that it includes.

    `parameters` are the numbers that become parameters: `none`, `inertias`, `all`, names of links, joints and
    parameters, or names and patterns of numbers such as `elbow.damping` and `*.mass`. `without` leaves out `damping`,
    `armature`, `springs`, `friction`, `limits`, `couplings`, `compensation` or `points`. `lock` makes joints rigid, at
    values by their names or as the file draws them. `snap` makes angles right that are so within 1e-4 rad, `floating`
    frees the root of a URDF, `actuators` makes the actuators of an MJCF inputs, with their laws. Included files and
    meshes lie below the folder `root`, which is that of the file unless it is given.
    """
    chosen = ",".join(many(parameters))
    values = lock.items() if isinstance(lock, Mapping) else ((joint, None) for joint in many(lock))
    spec, fields = _appell.import_robot(Path(file), chosen, many(without), list(values), snap, floating, actuators, root and Path(root))
    fields = json.loads(fields)
    return Robot(
        spec=spec,
        warnings={one["file"]: tuple(Diagnostic(**found) for found in one["findings"]) for one in fields["warnings"]},
        left_out=tuple(LeftOut(one["what"], one["file"], tuple(one["lines"]), one["effect"]) for one in fields["left_out"]),
        **{key: fields[key] for key in ("name", "format", "bodies", "joints", "nearly_right_angles")},
    )


def corrected_robot(file: str | Path, report: str | Diagnosis, hypothesis: int | None = None) -> tuple[str, str]:
    """The text of an MJCF or URDF file with the leading hypothesis of a gap report, or with another one, numbered from 1,
    and a summary of the changes. `report` is a diagnosis or the text of its report.
    """
    if hypothesis is not None and hypothesis < 1:
        raise ValueError("hypotheses are numbered from 1")
    text = report if isinstance(report, str) else report.json
    return _appell.corrected_robot(Path(file), text, hypothesis)


def sample_robot(folder: str | Path) -> list[str]:
    """Writes an arm with four joints as URDF and as MJCF; returns the names of the files."""
    return _appell.sample_robot(Path(folder))
