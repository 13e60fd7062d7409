"""Equations of motion from a declarative mechanism spec, by the Gibbs-Appell method.

>>> import appell
>>> m = appell.load("cart_pole")
>>> m.simulate(1.0, initial={"theta": "5deg"})["theta"].shape
(1001,)

Arrays are in SI. Texts such as `"5deg"` have their unit, or that of the spec.
"""

from __future__ import annotations

from importlib.metadata import version as _version
from pathlib import Path as _Path

from . import _appell
from ._cluster import spread
from ._ensemble import Ensemble, ensemble
from ._errors import ComputationError, DataError, Diagnostic, EndsEarly, Error, RequestError, SpecError, Unstable
from ._model import Derivation, Model, Quantity
from ._motion import Motion, Motions
from ._notebook import Page, Picture
from ._recordings import Diagnosis, Draft, Identification, Recordings, base_parameters, diagnose, identify, sample_rig
from ._results import Appell, Design, Energies, InverseDynamics, Jacobians, Linear, OutputJacobians, SteadyMotion
from ._robots import LeftOut, Robot, corrected_robot, import_robot, sample_robot
from ._values import Vector, labelled

__version__ = _version("appell")

__all__ = [
    "Appell", "ComputationError", "DataError", "Derivation", "Design", "Diagnosis", "Diagnostic", "Draft", "EndsEarly", "Energies",
    "Ensemble", "Error",
    "Identification", "InverseDynamics", "Jacobians", "LeftOut", "Linear", "Model", "Motion", "Motions", "OutputJacobians", "Page", "Picture", "Quantity", "Recordings",
    "RequestError", "Robot", "SpecError", "SteadyMotion", "Unstable", "Vector", "base_parameters", "corrected_robot", "diagnose", "ensemble", "identify", "import_robot", "labelled", "load", "sample_rig",
    "sample_robot", "shipped", "spread",
]  # fmt: skip


def load(spec: str | _Path) -> Model:
    """The model of a shipped mechanism, of the spec in a file, or of a text with line breaks.

    >>> import appell
    >>> appell.load("unicyle")
    Traceback (most recent call last):
        ...
    appell._errors.RequestError: model: there is no shipped mechanism and no file `unicyle`; did you mean `unicycle`?
      shipped: ...
    """
    if not isinstance(spec, (str, _Path)):
        raise TypeError(f"a spec is a name, a path or a text, not {type(spec).__name__}")
    spec = str(spec)
    return Model(spec, text="\n" in spec)


def shipped() -> list[str]:
    """Names of the shipped mechanisms.

    >>> import appell
    >>> "unicycle" in appell.shipped()
    True
    """
    return _appell.shipped()


del annotations
