"""Steady motions, linear equations, designs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ._report import Report
from ._values import Vector, labelled


class Jacobians(NamedTuple):
    """ẋ = f(x, u) and its derivatives at one place, or at N: (n,), (n, n), (n, m)."""

    rates: np.ndarray
    A: np.ndarray
    B: np.ndarray


class OutputJacobians(NamedTuple):
    """y = g(x, u) and its derivatives at one place, or at N: (l,), (l, n), (l, m)."""

    outputs: np.ndarray
    C: np.ndarray
    D: np.ndarray


class Appell(NamedTuple):
    """Appell's equations M ω̇ + b = Π: (s, s), (s,), (s,), or N of them."""

    M: np.ndarray
    b: np.ndarray
    forces: np.ndarray


class InverseDynamics(NamedTuple):
    """M ω̇ + b − Π, its derivatives with respect to state and inputs, and M, that with respect to ω̇: (s,), (s, n),
    (s, m), (s, s), or N of them."""

    demand: np.ndarray
    by_state: np.ndarray
    by_inputs: np.ndarray
    M: np.ndarray


class Energies(NamedTuple):
    """Kinetic and potential energy in J, power in W of the non-conservative loads, acceleration energy in W/s."""

    kinetic: Any
    potential: Any
    power: Any
    acceleration: Any


class Linear(NamedTuple):
    """δẋ = A δx + B δu, δy = C δx + D δu. `control.StateSpace(*linear[:4])` and
    `scipy.signal.StateSpace(*linear[:4])` take it."""

    A: np.ndarray
    B: np.ndarray
    C: np.ndarray
    D: np.ndarray
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def _complex(pairs: Sequence[Sequence[float]]) -> np.ndarray:
    return np.array([complex(*pair) for pair in pairs])


class SteadyMotion(Report):
    """A steady motion with its stability, in SI."""

    def __init__(self, fields: dict[str, Any], names: tuple[tuple[str, ...], tuple[str, ...], tuple[str, ...]]):
        self._fields = fields
        states, inputs, parameters = names
        values = fields["state"]
        self.x: Vector = labelled([values[name] for name in states], states)
        """The state; components that the steady motion leaves free have the value of the spec."""
        self.u: Vector = labelled([fields["inputs"][name] for name in inputs], inputs)
        """The declared inputs."""
        self.p: Vector = labelled([fields["parameters"][name] for name in parameters], parameters)
        """The parameters."""

    @property
    def verdict(self) -> str:
        """`asymptotic`, `neutral`, `unstable` or `critical`."""
        return self._fields["verdict"]

    @property
    def stable(self) -> bool:
        """Whether no disturbance of the essential states grows in the linear equations. A steady motion may drift along
        its family, and in ignorable coordinates such as the place on the ground."""
        return self.verdict in ("asymptotic", "neutral")

    @property
    def eigenvalues(self) -> np.ndarray:
        """Eigenvalues of the essential states in 1/s."""
        return _complex(self._fields["eigenvalues"])

    def __repr__(self) -> str:
        return f"<steady motion, {self.verdict}: {self.x!r}>"


class Design(Report):
    """Controllability about a steady motion, and the gains of a law u = u₀ - K (x - x₀)."""

    def __init__(self, fields: dict[str, Any], law: str | None):
        self._fields = fields
        self.law = law
        """The law as the text of a feedback file, for `simulate(feedback=...)`."""

    @property
    def A(self) -> np.ndarray:
        """Of the linear equations, in the order of `states`."""
        return np.array(self._fields["A"])

    @property
    def B(self) -> np.ndarray:
        """Of the linear equations, (states, inputs)."""
        return np.array(self._fields["B"])

    @property
    def states(self) -> tuple[str, ...]:
        """The order of A and B."""
        return tuple(self._fields["state_order"])

    @property
    def outputs(self) -> tuple[str, ...]:
        """The states that are fed back: the columns of K."""
        return tuple(self._fields["outputs"]["order"])

    @property
    def inputs(self) -> tuple[str, ...]:
        """The rows of K."""
        return tuple(self._fields["input_order"])

    @property
    def rank(self) -> int:
        """Rank of the controllability matrix."""
        return self._fields["controllability"]["rank"]

    @property
    def K(self) -> np.ndarray | None:
        """The gains, (inputs, outputs)."""
        law = self._fields["law"]
        return None if law is None else np.array(law["gains"])

    @property
    def stable(self) -> bool | None:
        """Whether the closed loop is stable; None without a law."""
        law = self._fields["law"]
        return None if law is None else law["stable"]

    @property
    def poles(self) -> np.ndarray | None:
        """Poles of the closed loop in 1/s; of a sampled law in the z plane."""
        law = self._fields["law"]
        return None if law is None else _complex(law["poles"])

    def __repr__(self) -> str:
        if self.K is None:
            return f"<controllability: rank {self.rank} of {len(self.outputs)}>"
        return f"<law of {', '.join(self.inputs)} from {', '.join(self.outputs)}; poles {self.poles}>"
