"""A mechanism with its equations of motion."""

from __future__ import annotations

import json
import re
import types
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, overload

import numpy as np

from . import _appell
from ._card import OnCard
from ._errors import EndsEarly, Unstable
from ._motion import Motion, Motions
from ._notebook import Page, Picture
from ._results import Appell, Design, Energies, InverseDynamics, Jacobians, Linear, OutputJacobians, SteadyMotion
from ._values import Vector, labelled, many, text, texts

Values = Mapping[str, Any]


@dataclass(frozen=True)
class Quantity:
    """A state, input, parameter or output of a spec."""

    name: str
    about: str
    unit: str
    """Unit of the spec."""
    scale: float
    """One of `unit` in SI."""
    value: float
    """Parameter value or initial value in SI."""
    low: float
    high: float
    """Declared range in SI."""


class Derivation(Page):
    """Equations, typeset in a notebook; `.latex` is a document, `.plain` is for terminals, `.text` a page."""

    def __init__(self, model: Model, stage: str):
        super().__init__(model._derivation(stage, "html"), 900)
        self._model, self._stage = model, stage

    @property
    def latex(self) -> str:
        """A document for LaTeX."""
        return self._model._derivation(self._stage, "latex")

    @property
    def plain(self) -> str:
        """Unicode for a terminal."""
        return self._model._derivation(self._stage, "text")

    def _repr_latex_(self) -> str:
        return self._model._derivation(self._stage, "formulas")

    def __repr__(self) -> str:
        return self.plain


class Model(_appell.Model):
    """A mechanism with its equations of motion ẋ = f(t, x, u, p), all in SI.

    The state x has the pseudo-velocities first, then the coordinates. `x`, `u`, `p` and `t` of every function may be
    left out for the values of the spec; each is one place, (n,), or one a row, (N, n). Arrays of doubles that are
    contiguous are not copied, and the interpreter goes on while N places are evaluated. `out` takes the results.

    >>> import appell, numpy as np
    >>> m = appell.load("pendulum")
    >>> m.states
    ('omega', 'theta')
    >>> m.rates(np.zeros((1000, 2))).shape
    (1000, 2)
    """

    @cached_property
    def _all(self) -> tuple[tuple[Quantity, ...], ...]:
        return tuple(tuple(Quantity(*told) for told in group) for group in self._quantities())

    @property
    def name(self) -> str:
        """Name of the mechanism."""
        return self._about()[0]

    @property
    def title(self) -> str:
        """One line about it."""
        return self._about()[1]

    @property
    def source(self) -> str:
        """Source of the model."""
        return self._about()[2]

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """States, declared inputs, parameters and outputs by name."""
        states, inputs, parameters, outputs = self._all
        declared = inputs[: len(self.inputs)]
        return {quantity.name: quantity for quantity in (*states, *declared, *parameters, *outputs)}

    @cached_property
    def states(self) -> tuple[str, ...]:
        """Names of the states: pseudo-velocities, then coordinates."""
        return tuple(quantity.name for quantity in self._all[0])

    @cached_property
    def speeds(self) -> tuple[str, ...]:
        """Names of the pseudo-velocities, the first part of the state."""
        return self.states[: self._structure()[0]]

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates, the last part of the state."""
        return self.states[self._structure()[0] :]

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Names of the declared inputs."""
        return tuple(quantity.name for quantity in self._all[1][: self._structure()[1]])

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters."""
        return tuple(quantity.name for quantity in self._all[2])

    @cached_property
    def output_names(self) -> tuple[str, ...]:
        """Names of the outputs of the spec."""
        return tuple(quantity.name for quantity in self._all[3])

    @property
    def constraint_rows(self) -> tuple[str, ...]:
        """Names of the velocity constraints, row by row."""
        return tuple(self._structure()[2])

    @property
    def reactions(self) -> tuple[str, ...]:
        """Points and constraints of `constraint_forces`, in its order."""
        return tuple(self._structure()[3])

    @cached_property
    def units(self) -> dict[str, str]:
        """Units of the spec by name; arrays are in SI."""
        return {name: quantity.unit for name, quantity in self.quantities.items()}

    @cached_property
    def _scales(self) -> dict[str, float]:
        """SI units in one of the spec, by name; a rate, `psi_dot` or `dot(psi)`, has that of its coordinate."""
        scales = {name: quantity.scale for name, quantity in self.quantities.items()}
        rates = {rate: scales[q] for q in self.coordinates for rate in (f"{q}_dot", f"dot({q})")}
        return rates | scales

    # Vectors

    def state(self, **values: Any) -> Vector:
        """The initial state of the spec with other values: numbers in SI, or texts such as `"20deg"`.

        >>> import appell
        >>> appell.load("pendulum").state(theta="180deg")["theta"]
        3.141592653589793
        """
        return labelled(self._state(texts(values, self._scales)), self.states)

    def input(self, **values: Any) -> Vector:
        """The declared inputs, zero but for these: numbers in SI, or texts such as `"2N"`."""
        u = labelled(np.zeros(len(self.inputs)), self.inputs)
        for name, value in values.items():
            u[name] = self._input(name, text(value, self._scales.get(name, 1.0)))
        return u

    def parameter_values(self, **values: Any) -> Vector:
        """The parameters of the spec with other values: numbers in SI, or texts such as `"30cm"`."""
        return labelled(self._parameters(texts(values, self._scales)), self.parameters)

    # Equations

    def rates(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: np.ndarray | None = None, threads: int | None = None) -> np.ndarray:
        """ẋ, (n,) or (N, n).

        From 64 places on, functions of arrays are evaluated eight places at a time, with the bits of single places; `threads`
        is the number of threads, by default all processors where there are thousands of places. `out` takes the results.
        """
        return self._evaluate("rates", x, u, p, t, None if out is None else [out], threads=threads)[0]

    def jacobians(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: Sequence[np.ndarray] | None = None, threads: int | None = None) -> Jacobians:
        """ẋ, A = ∂ẋ/∂x and B = ∂ẋ/∂u."""
        return Jacobians(*self._evaluate("jacobians", x, u, p, t, None if out is None else list(out), threads=threads))

    def parameter_jacobian(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: np.ndarray | None = None, threads: int | None = None) -> np.ndarray:
        """P = ∂ẋ/∂p, (n, k) or (N, n, k)."""
        return self._evaluate("parameter_jacobian", x, u, p, t, None if out is None else [out], threads=threads)[0]

    def appell(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: Sequence[np.ndarray] | None = None, threads: int | None = None) -> Appell:
        """Appell's equations M ω̇ + b = Π."""
        return Appell(*self._evaluate("appell", x, u, p, t, None if out is None else list(out), threads=threads))

    def mass_matrix(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None) -> np.ndarray:
        """M of Appell's equations M ω̇ + b = Π, (s, s) or (N, s, s)."""
        return self._evaluate("appell", x, u, p, t, None)[0]

    def bias(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None) -> np.ndarray:
        """b of Appell's equations M ω̇ + b = Π, (s,) or (N, s)."""
        return self._evaluate("appell", x, u, p, t, None)[1]

    def forces(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None) -> np.ndarray:
        """The pseudo-forces Π of Appell's equations M ω̇ + b = Π, (s,) or (N, s)."""
        return self._evaluate("appell", x, u, p, t, None)[2]

    def inverse_dynamics(self, accelerations: Any = None, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: np.ndarray | None = None, threads: int | None = None) -> np.ndarray:
        """The pseudo-forces M ω̇ + b − Π that pseudo-accelerations ω̇ take beyond the loads, (s,) or (N, s).

        With inputs of zero they are what drives along the pseudo-velocities have to bring.

        >>> import appell
        >>> m = appell.load("pendulum")
        >>> bool(abs(m.inverse_dynamics(m.rates()[:1])[0]) < 1e-12)
        True
        """
        return self._evaluate("inverse_dynamics", x, u, p, t, None if out is None else [out], accelerations, threads)[0]

    def inverse_dynamics_jacobians(self, accelerations: Any = None, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: Sequence[np.ndarray] | None = None, threads: int | None = None) -> InverseDynamics:
        """The same with its Jacobians."""
        results = None if out is None else list(out)
        return InverseDynamics(*self._evaluate("inverse_dynamics_jacobians", x, u, p, t, results, accelerations, threads))

    def energies(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None) -> Energies:
        """Kinetic, potential and acceleration energy, and the power of the non-conservative loads; numbers or (N,)."""
        values = self._evaluate("energies", x, u, p, t, None)
        return Energies(*(value if value.ndim else value.item() for value in values))

    def outputs(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: np.ndarray | None = None, threads: int | None = None) -> np.ndarray:
        """The outputs y of the spec, (l,) or (N, l); names: `output_names`."""
        return self._evaluate("outputs", x, u, p, t, None if out is None else [out], threads=threads)[0]

    def output_jacobians(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: Sequence[np.ndarray] | None = None, threads: int | None = None) -> OutputJacobians:
        """y, C = ∂y/∂x and D = ∂y/∂u."""
        return OutputJacobians(*self._evaluate("output_jacobians", x, u, p, t, None if out is None else list(out), threads=threads))

    def constraint_forces(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None, *, out: np.ndarray | None = None, threads: int | None = None) -> np.ndarray:
        """Forces of the constraints in the ground in N, (r, 3) or (N, r, 3); names: `reactions`."""
        return self._evaluate("constraint_forces", x, u, p, t, None if out is None else [out], threads=threads)[0]

    def linearise(self, x: Any = None, u: Any = None, p: Any = None, t: Any = None) -> Linear:
        """The linear equations about a point of the state space, or about a `SteadyMotion`."""
        if isinstance(x, SteadyMotion):
            x, u, p = x.x, x.u if u is None else u, x.p if p is None else p
        count = len(self.inputs)
        _, a, b = self.jacobians(x, u, p, t)
        _, c, d = self.output_jacobians(x, u, p, t)
        return Linear(a, b[..., :count], c, d[..., :count], self.states, self.inputs, self.output_names)

    # Motions

    def simulate(
        self,
        t_end: float,
        *,
        dt: float | None = None,
        initial: Values | np.ndarray | None = None,
        parameters: Values | np.ndarray | None = None,
        inputs: Mapping[str, Any] | Callable[[float, Vector], Any] | None = None,
        feedback: Design | str | Path | Sequence[Design | str | Path] = (),
        recorded: str | Path | None = None,
        interpolation: str | None = None,
        method: str = "dop853",
        step: float | None = None,
        rtol: float | None = None,
        atol: float | None = None,
        max_steps: int | None = None,
        record: Iterable[str] = (),
    ) -> Any:
        """Integrates the equations of motion from 0 to `t_end` in s; returns a `Motion`.

        With an array (N, n) of initial states the N motions are integrated eight at a time, and come as `Motions`.

        `inputs` gives each input a number in SI, a text (an expression in t, states and parameters, in units of the
        spec), a function of t and x, or a pair of arrays: times in s and values in SI; or it is one function of t and
        x that returns all inputs. `feedback` takes designs of `control`, and the texts and
        paths of feedback files. `recorded` is a table of inputs, or a run of a data set such as
        `rig/recording.toml:run1.csv`. Rows of tables are held until the next, as a drive does with a command;
        `interpolation="linear"` joins them by lines, `"cubic"` by a spline, right for samples of a continuous signal. `record` adds columns: `reactions`, `contacts`, `conditions`, `residuals`.
        A function sees the state before a step is accepted too, and should be smooth. `method` is `dop853`,
        `dopri5`, or `rk4` with its `step`.

        >>> import appell, math
        >>> m = appell.load("cart_pole")
        >>> m.simulate(1, inputs={"F": lambda t, x: math.sin(3 * t)})["F"][-1].item() == math.sin(3)
        True
        """
        if not (inputs is None or callable(inputs) or isinstance(inputs, Mapping)):
            raise TypeError("inputs is a dict by name, or a function of t and x")
        expressions: list[tuple[str, str]] = []
        tables: list[tuple[str, np.ndarray, np.ndarray]] = []
        functions: list[tuple[str, Callable[[float, np.ndarray], float]]] = []
        if callable(inputs):
            functions = self._functions(inputs)
            inputs = None
        for name, given in (inputs or {}).items():
            if callable(given):
                functions.append((name, self._seen(given)))
            elif isinstance(given, str) or np.ndim(given) == 0:
                expressions.append((name, text(given, self._scales.get(name, 1.0))))
            else:
                tables.append((name, *_table(name, given)))
        laws = [feedback] if isinstance(feedback, Design) else many(feedback)
        starts = None
        if isinstance(initial, (np.ndarray, list, tuple)) and np.ndim(initial) == 2:
            starts = np.ascontiguousarray(initial, dtype=float)
            if starts.shape[1] != len(self.states) or not len(starts):
                raise ValueError(f"initial: {len(self.states)} values a row are needed, not the shape {starts.shape}")
            initial = None
        natives = _appell.simulate(
            self,
            float(t_end),
            starts=starts,
            dt=dt,
            parameters=self._given(parameters, self.parameters),
            initial=self._given(initial, self.states),
            expressions=expressions,
            tables=tables,
            functions=functions,
            recorded=None if recorded is None else str(recorded),
            interpolated=interpolation,
            laws=[_law(law) for law in laws],
            method=method,
            step=step,
            tolerances=[rtol, atol],
            max_steps=max_steps,
            extras=many(record),
        )
        for number, native in enumerate(natives):
            which = "the motion" if starts is None else f"motion {number}"
            if native.failure is not None:
                reason = native.failure.partition("; state:")[0]
                warnings.warn(f"{which} ends early: {reason}", EndsEarly, stacklevel=2)
            if native.smooth is not None:
                warnings.warn(native.smooth, RuntimeWarning, stacklevel=2)
            if native.undefined is not None:
                warnings.warn(f"{which}: {native.undefined}", RuntimeWarning, stacklevel=2)
        motions = [Motion(native, self) for native in natives]
        return motions[0] if starts is None else Motions(motions)

    def _given(self, values: Values | np.ndarray | None, names: tuple[str, ...]) -> list[tuple[str, str]]:
        if values is None or isinstance(values, Mapping):
            return texts(values, self._scales)
        numbers = np.asarray(values, dtype=float)
        if numbers.shape != (len(names),):
            raise ValueError(f"{len(names)} values are needed, not the shape {numbers.shape}")
        return texts(dict(zip(names, numbers.tolist(), strict=True)), self._scales)

    def _seen(self, function: Callable[[float, Vector], Any]) -> Callable[[float, np.ndarray], float]:
        states = self.states
        return lambda t, x: _number(function(t, labelled(x, states)))

    def _functions(self, function: Callable[[float, Vector], Any]) -> list[tuple[str, Callable[[float, np.ndarray], float]]]:
        """One function of all inputs, called once per state."""
        last: tuple[Any, Any] = (None, None)
        states, count = self.states, len(self.inputs)

        def values(t: float, x: np.ndarray) -> np.ndarray:
            nonlocal last
            place = (t, x.tobytes())
            if last[0] != place:
                told = function(t, labelled(x, states))
                if told is None:
                    raise TypeError("inputs returns None; it returns one number for each input")
                found = np.asarray(told, dtype=float).reshape(-1)
                if found.shape != (count,):
                    raise ValueError(f"inputs returns {found.size} values; there are {count} inputs")
                last = (place, found)
            return last[1]

        def one(index: int) -> Callable[[float, np.ndarray], float]:
            return lambda t, x: float(values(t, x)[index])

        return [(name, one(index)) for index, name in enumerate(self.inputs)]

    # Questions

    @overload
    def steady(
        self,
        fix: Values | None = None,
        *,
        free: str | Sequence[str] = (),
        along: None = None,
        require: Values | None = None,
        parameters: Values | None = None,
        starts: int | None = None,
    ) -> list[SteadyMotion]: ...

    @overload
    def steady(
        self,
        fix: Values | None = None,
        *,
        free: str | Sequence[str] = (),
        along: tuple[str, Any, Any] | str,
        require: Values | None = None,
        parameters: Values | None = None,
        starts: int | None = None,
    ) -> list[list[SteadyMotion]]: ...

    def steady(
        self,
        fix: Values | None = None,
        *,
        free: str | Sequence[str] = (),
        along: tuple[str, Any, Any] | str | None = None,
        require: Values | None = None,
        parameters: Values | None = None,
        starts: int | None = None,
    ) -> list[SteadyMotion] | list[list[SteadyMotion]]:
        """Steady motions with their stability: isolated ones, or branches `along` a quantity.

        `fix` prescribes states, inputs, outputs, or rates of ignorable coordinates such as `dot(psi)`; inputs that
        are not fixed are zero. `free` names inputs or parameters to solve for. Where the conditions leave a family of
        motions, such as those at every speed, the error names what to prescribe.

        >>> import appell
        >>> sorted({motion.verdict for motion in appell.load("pendulum").steady()})
        ['neutral', 'unstable']
        """
        if isinstance(along, str):
            name, _, span = along.partition("=")
            along = (name.strip(), *span.split(".."))
            if len(along) != 3:
                raise ValueError("write along as NAME=FROM..TO, such as speed=0.5..10")
        span = None
        if along is not None:
            name, *ends = along
            low, high = (text(end, self._scales.get(name, 1.0)) for end in ends)
            span = (name, low, high)
        told = self._steady(
            texts(parameters, self._scales),
            texts(fix, self._scales),
            many(free),
            span,
            texts(require, self._scales),
            starts,
        )
        answer = json.loads(told)
        names = (self.states, self.inputs, self.parameters)
        if "branches" in answer:
            branches = [branch["points"] for branch in answer["branches"]]
            return [[SteadyMotion(point, names) for point in points] for points in branches]
        return [SteadyMotion(motion, names) for motion in answer["motions"]]

    def control(
        self,
        at: Values | None = None,
        *,
        poles: str | complex | Sequence[complex] | None = None,
        weights: str | float | None = None,
        inputs: str | Sequence[str] = (),
        outputs: str | Sequence[str] = (),
        sampled_ms: float | None = None,
        delay_ms: float | None = None,
        parameters: Values | None = None,
    ) -> Design:
        """Controllability about a steady motion, and gains by `poles` in 1/s (`-8`, `[-8, -2+3j, -2-3j]`) or by
        `weights` of a linear-quadratic regulator (`1`, `"Q=1,10,R=0.1"`).

        >>> import appell
        >>> m = appell.load("cart_pole")
        >>> law = m.control(poles=-3)
        >>> m.simulate(5, initial={"theta": "10deg"}, feedback=law).failure is None
        True
        """
        sampled = None if sampled_ms is None and delay_ms is None else [sampled_ms or 0.0, delay_ms or 0.0]
        told, law = self._control(
            texts(parameters, self._scales),
            texts(at, self._scales),
            many(inputs),
            many(outputs),
            _poles(poles),
            None if weights is None else str(weights),
            sampled,
        )
        design = Design(json.loads(told), law)
        if design.stable is False:
            warnings.warn(f"the closed loop is unstable: its poles are {design.poles}", Unstable, stacklevel=2)
        return design

    # To read

    @property
    def equations(self) -> Derivation:
        """The equations of motion."""
        return Derivation(self, "motion")

    @property
    def derivation(self) -> Derivation:
        """The derivation, from the frames to the energies."""
        return Derivation(self, "equations")

    def draw(self, parameters: Values | None = None, **initial: Any) -> Picture:
        """The mechanism at its initial state, or at another one."""
        return Picture(self._drawing(texts(parameters, self._scales), texts(initial, self._scales)))

    @cached_property
    def module(self) -> str:
        """The text of a Python module with the equations as functions over an array namespace."""
        return self._module()

    def cuda(self, *, single: bool = False, integrator: bool = False) -> str:
        """The equations as CUDA C++ in one source: functions for processor and graphics card, and kernels such as
        `pendulum_rates_places` that evaluate them at many places, one thread each. Its head tells the layout of the arrays.

        With CuPy, for n places whose states are the columns of `x`:

            code = cupy.RawModule(code=m.cuda(), options=("--fmad=false",))
            rates = cupy.empty_like(x)
            code.get_function("pendulum_rates_places")((n // 256 + 1,), (256,), (n, 0.0, p, 0, x, u, rates))
        """
        return self._cuda(single, integrator)

    def on_card(self, *functions: str) -> OnCard:
        """Functions at many places on the first NVIDIA graphics card of this machine, `rates` unless others are named.

            x = torch.zeros((len(m.states), 10**6), dtype=torch.float64, device="cuda").T
            rates = torch.from_dlpack(m.on_card().rates(x))
        """
        return OnCard(self, functions or ("rates",))

    @cached_property
    def regressor_module(self) -> str:
        """The text of a Python module with one function, `regressor(xp, t, x, u, p, accelerations)`: Y, r and π of inverse
        dynamics as a linear function of inertial and load parameters, M ω̇ + b − Π = Y π + r."""
        return self._regressor()

    def functions(self, xp: Any) -> types.SimpleNamespace:
        """The equations as functions of (t, x, u, p) over a namespace of arrays: `numpy`, `jax.numpy`, `casadi` or
        `sympy`. They return lists, row by row.

        >>> import appell, math
        >>> f = appell.load("pendulum").functions(math)
        >>> f.rates(0.0, [0.0, 0.0], [0.0], f.DEFAULT_PARAMETERS)
        [0.0, 0.0]
        """
        module: dict[str, Any] = {"__name__": f"appell_{self.name}"}
        exec(compile(self.module, f"<equations of {self.name}>", "exec"), module)
        public = {
            name: value
            for name, value in module.items()
            if not name.startswith("_") and not isinstance(value, types.ModuleType)
        }
        bound = {name: partial(value, xp) if callable(value) else value for name, value in public.items()}
        return types.SimpleNamespace(**bound)

    def compare(self, equations: Mapping[str, Any]) -> dict[str, str]:
        """Compares equations of motion that you derived with appell's: rates by the names of states, as texts in the
        language of specs or as SymPy expressions with the names of the spec.

        The answer for each: `identical` as functions, by an identity test with a bounded error probability; `equal` at
        random points, where that test cannot tell; `different`; or `undefined` at all points.

        >>> import appell
        >>> appell.load("pendulum").compare({"omega": "(tau - m*g*l*sin(theta))/(I + m*l^2)", "theta": "-omega"})
        {'omega': 'identical', 'theta': 'different'}
        """
        typed = [(name, _typed(expression)) for name, expression in equations.items()]
        compared = json.loads(self._compare(typed))["equations"]
        return {equation["rate"]: equation["result"] for equation in compared}

    def __reduce__(self) -> tuple[Any, ...]:
        reference = self._reference
        return _restored, (self.spec if reference is None else reference, reference is None)

    def __repr__(self) -> str:
        return f"<{self.name}: {self.title}; states {', '.join(self.states)}; inputs {', '.join(self.inputs) or 'none'}>"


def _restored(spec: str, text: bool) -> Model:
    return Model(spec, text=text)


def _typed(expression: Any) -> str:
    """An expression in the language of specs; SymPy writes some functions and powers otherwise."""
    if isinstance(expression, str):
        return expression
    written = str(expression).replace("**", "^")
    return re.sub(r"\b(Abs|log)\(", lambda found: {"Abs": "abs(", "log": "ln("}[found[0][:-1]], written)


def _number(value: Any) -> float:
    """A number, or an array of one."""
    return value.item() if isinstance(value, np.ndarray) and value.size == 1 else float(value)


def _table(name: str, given: Any) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of a pair of arrays, or of a series over the times."""
    if hasattr(given, "index") and hasattr(given, "to_numpy"):
        given = (given.index.to_numpy(), given.to_numpy())
    if not (isinstance(given, (tuple, list)) and len(given) == 2):
        raise ValueError(f"{name}: a table is a pair (times, values)")
    times, values = (np.ascontiguousarray(column, dtype=float) for column in given)
    if times.ndim != 1 or times.shape != values.shape:
        raise ValueError(f"{name}: the times have the shape {times.shape}, the values {values.shape}")
    return times, values


def _poles(poles: Any) -> str | None:
    if poles is None or isinstance(poles, str):
        return poles
    return ",".join(f"{p.real!r}{p.imag:+}i" if p.imag else repr(p.real) for p in map(complex, np.ravel(poles)))


def _law(law: Design | str | Path) -> str:
    if isinstance(law, Design):
        if law.law is None:
            raise ValueError("the design has no law: give `control` poles or weights")
        return law.law
    is_file = isinstance(law, Path) or "\n" not in law
    return Path(law).read_text(encoding="utf-8") if is_file else law
