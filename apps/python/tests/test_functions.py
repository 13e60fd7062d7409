"""The same functions over other namespaces: symbols, graphs, tracers."""

import numpy as np
import pytest

from conftest import places

NAMES = ["unicycle", "euc_3dof", "bicycle", "four_bar", "cart_pole"]


def place(m):
    return tuple(place[0] for place in places(m, 1))


@pytest.mark.parametrize("name", NAMES)
def test_numpy_has_the_values_of_the_model(model, name):
    m = model(name)
    x, u, p = place(m)
    f = m.functions(np)
    np.testing.assert_allclose(f.rates(0.0, x, u, p), m.rates(x, u, p), rtol=1e-12, atol=1e-12)
    many, inputs, _ = places(m, 7)
    rates = np.array(f.rates(0.0, many.T, inputs.T, p)).T
    np.testing.assert_allclose(rates, m.rates(many, inputs, p), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_casadi_has_the_values_and_the_slopes(model, name):
    casadi = pytest.importorskip("casadi")
    m = model(name)
    x, u, p = place(m)
    symbols = [casadi.SX.sym(letter, len(values)) for letter, values in zip("xup", (x, u, p), strict=True)]
    rates = casadi.vertcat(*m.functions(casadi).rates(0.0, *(casadi.vertsplit(s) for s in symbols)))
    slopes = [casadi.jacobian(rates, s) for s in symbols[:2]]
    value, a, b = casadi.Function("f", symbols, [rates, *slopes])(x, u, p)
    expected = m.jacobians(x, u, p)
    np.testing.assert_allclose(value.full().ravel(), expected.rates, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(a.full(), expected.A, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(b.full().reshape(expected.B.shape), expected.B, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("name", NAMES)
def test_jax_has_the_values_and_the_slopes(model, name):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    m = model(name)
    x, u, p = place(m)
    f = m.functions(jax.numpy)

    def rates(x, u):
        return jax.numpy.stack([jax.numpy.asarray(rate, dtype=float) for rate in f.rates(0.0, x, u, p)])

    expected = m.jacobians(x, u, p)
    np.testing.assert_allclose(jax.jit(rates)(x, u), expected.rates, rtol=1e-12, atol=1e-12)
    a, b = jax.jacfwd(rates, argnums=(0, 1))(x, u)
    np.testing.assert_allclose(a, expected.A, rtol=1e-10, atol=1e-10)
    np.testing.assert_allclose(b, expected.B, rtol=1e-10, atol=1e-10)


@pytest.mark.parametrize("name", ["unicycle", "rolling_wheel", "cart_pole"])
def test_sympy_has_the_same_expressions(model, name):
    """The identity test: expressions that agree to 40 digits at random points of 60 digits are equal."""
    sympy = pytest.importorskip("sympy")
    m = model(name)
    f = m.functions(sympy)
    x, u, p = (sympy.symbols([f"{letter}{k}" for k in range(len(names))], real=True) for letter, names in
               (("x", m.states), ("u", m.inputs), ("p", m.parameters)))  # fmt: skip
    rates = sympy.Matrix(f.rates(sympy.Integer(0), x, u, p))
    _, a, _ = f.jacobians(sympy.Integer(0), x, u, p)
    slopes = rates.jacobian(x)
    draw = np.random.default_rng(2)
    for _ in range(2):
        at = {s: sympy.Rational(int(draw.integers(50, 150)), 100) for s in (*x, *u, *p)}
        for emitted, derived in zip(np.ravel(np.array(a, dtype=object)), slopes, strict=True):
            difference = sympy.N((emitted - derived).subs(at), 60, maxn=200)
            size = 1 + abs(sympy.N(derived.subs(at), 20))
            assert abs(difference) < sympy.Float("1e-40") * size


@pytest.mark.parametrize("name", ["unicycle", "rolling_wheel", "cart_pole", "euc_3dof"])
def test_sympy_expressions_are_the_derived_ones(model, name):
    """By the identity test of the derivation, over a finite field."""
    sympy = pytest.importorskip("sympy")
    m = model(name)
    x, u, p = (sympy.symbols(list(names), real=True) for names in (m.states, m.inputs, m.parameters))
    rates = m.functions(sympy).rates(sympy.Integer(0), x, u, p)
    compared = m.compare(dict(zip(m.states, rates, strict=True)))
    assert set(compared.values()) == {"identical"}
    wrong = m.compare({m.states[0]: rates[0] + sympy.Rational(1, 1000) * x[0]})
    assert wrong == {m.states[0]: "different"}


def test_sympy_derives_what_a_hand_derives(model):
    sympy = pytest.importorskip("sympy")
    m = model("pendulum")
    theta, g, length, mass, inertia = sympy.symbols("theta g l m I", positive=True)
    omega = sympy.Symbol("omega")
    p = [sympy.Symbol(name, positive=True) for name in m.parameters]
    rates = m.functions(sympy).rates(0, [omega, theta], [0] * len(m.inputs), p)
    assert rates[1] == omega
    assert sympy.simplify(rates[0] + mass * g * length * sympy.sin(theta) / (inertia + mass * length**2)) == 0
