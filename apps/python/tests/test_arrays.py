"""Equations at one place and at many."""

import gc
import resource

import numpy as np
import pytest

import appell
from conftest import places


@pytest.mark.parametrize("name", ["unicycle", "euc_3dof", "bicycle", "four_bar"])
def test_many_places_have_the_values_of_single_ones(model, name):
    m = model(name)
    x, u, p = places(m, 5)
    for function in (m.rates, m.outputs, m.mass_matrix, m.bias, m.forces, m.parameter_jacobian, m.constraint_forces):
        many = function(x, u, p)
        for row, value in enumerate(many):
            np.testing.assert_array_equal(value, function(x[row], u[row], p[row]))
    for function in (m.jacobians, m.appell, m.energies):
        many = function(x, u, p)
        for row in range(5):
            for part, one in zip(many, function(x[row], u[row], p[row]), strict=True):
                np.testing.assert_array_equal(part[row], one)


def test_single_arguments_hold_for_all_rows(model):
    m = model("cart_pole")
    x, u, _ = places(m, 4)
    np.testing.assert_array_equal(m.rates(x, u[0]), m.rates(x, np.tile(u[0], (4, 1))))
    np.testing.assert_array_equal(m.rates(x)[2], m.rates(x[2], np.zeros(len(m.inputs)), m.parameter_values()))


def test_jacobians_are_the_slopes_of_the_rates(model):
    m = model("unicycle")
    x, u, p = (place[0] for place in places(m, 1))
    _, a, b = m.jacobians(x, u, p)
    step = 1e-6

    def slopes(function, at):
        around = at + step * np.vstack([np.eye(len(at)), -np.eye(len(at))])
        values = function(around)
        return (values[: len(at)] - values[len(at) :]).T / (2 * step)

    np.testing.assert_allclose(a, slopes(lambda x: m.rates(x, u, p), x), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(b, slopes(lambda u: m.rates(x, u, p), u), rtol=1e-6, atol=1e-6)
    by_p = m.parameter_jacobian(x, u, p)
    np.testing.assert_allclose(by_p, slopes(lambda p: m.rates(x, u, p), p), rtol=1e-4, atol=1e-4)


def test_appells_equations_hold(model):
    m = model("bicycle")
    x, u, p = (place[0] for place in places(m, 1))
    mass, bias, forces = m.appell(x, u, p)
    speeds = len(m.speeds)
    np.testing.assert_allclose(mass @ m.rates(x, u, p)[:speeds] + bias, forces, atol=1e-9 * np.abs(mass).max())


def test_inverse_dynamics_takes_the_accelerations_of_the_motion_and_no_more(model):
    m = model("bicycle")
    x, u, p = places(m, 4)
    accelerations = m.rates(x, u, p)[:, : len(m.speeds)]
    scale = np.abs(m.mass_matrix(x, u, p)).max()
    np.testing.assert_allclose(m.inverse_dynamics(accelerations, x, u, p), 0, atol=1e-9 * scale)
    demand, by_state, by_inputs, mass = m.inverse_dynamics_jacobians(2 * accelerations, x, u, p)
    np.testing.assert_allclose(demand, np.einsum("nij,nj->ni", mass, accelerations), atol=1e-9 * scale)
    a, b = (m.jacobians(x, u, p)[i][:, : len(m.speeds)] for i in (1, 2))
    by_state, by_inputs = m.inverse_dynamics_jacobians(accelerations, x, u, p)[1:3]
    np.testing.assert_allclose(by_state, -np.einsum("nij,njk->nik", mass, a), rtol=1e-7, atol=1e-7 * scale)
    np.testing.assert_allclose(by_inputs, -np.einsum("nij,njk->nik", mass, b), rtol=1e-7, atol=1e-7 * scale)


def test_results_go_where_they_are_wanted(model):
    m = model("cart_pole")
    x, u, _ = places(m, 6)
    out = np.empty((6, len(m.states)))
    assert m.rates(x, u, out=out) is out
    np.testing.assert_array_equal(out, m.rates(x, u))
    with pytest.raises(ValueError, match="out has the shape"):
        m.rates(x, u, out=np.empty((5, len(m.states))))
    with pytest.raises(ValueError, match="out"):
        m.rates(x, u, out=x)


def test_arrays_of_other_kinds_are_taken(model):
    m = model("pendulum")
    expected = m.rates([0.5, 1.0])
    for x in ((0.5, 1), np.array([[0.5, 9.0], [1.0, 9.0]])[:, 0], np.array([0.5, 1.0], dtype=np.float32)):
        np.testing.assert_array_equal(m.rates(x), expected)


@pytest.mark.parametrize(
    "x, message",
    [(np.zeros(3), r"x has the shape \[3\]; it needs \(2,\) or \(N, 2\)"), (np.zeros((1, 2, 2)), "x has the shape"), ("a", "could not convert")],
)
def test_wrong_shapes_are_refused(model, x, message):
    with pytest.raises((ValueError, TypeError), match=message):
        model("pendulum").rates(x)


def test_different_numbers_of_rows_are_refused(model):
    m = model("cart_pole")
    with pytest.raises(ValueError, match="x has 2 rows, and u has 3"):
        m.rates(np.zeros((2, len(m.states))), np.zeros((3, 1)))


def test_vectors_have_names(model):
    m = model("pendulum")
    x = m.state(theta="90deg")
    assert x["theta"] == np.pi / 2
    x["theta"] = 1.0
    assert x.to_dict() == {"omega": 0.0, "theta": 1.0}
    assert (2 * x)["theta"] == 2.0
    with pytest.raises(KeyError, match="there is no `phi`; there are omega, theta"):
        x["phi"]
    assert x.sum() == 1.0


def test_energy_is_that_of_the_motion(model):
    m = model("double_pendulum")
    motion = m.simulate(2, initial={m.coordinates[0]: "40deg"})
    energies = m.energies(motion.x)
    total = energies.kinetic + energies.potential
    assert np.ptp(total) < 1e-8 * np.abs(total).max()
    np.testing.assert_array_equal(energies.kinetic, motion["kinetic_energy"])


def test_a_hundred_thousand_calls_leave_nothing_behind(model):
    m = model("unicycle")
    x, u, p = (place[0].copy() for place in places(m, 1))

    def calls(count):
        for _ in range(count):
            m.rates(x, u, p)
            m.jacobians(x, u, p)
        gc.collect()

    calls(1000)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    calls(100_000)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 4096


def test_wrong_specs_tell_their_places():
    text = appell.load("pendulum").spec.replace('unit = "m"', 'unit = "mm/"', 1)
    with pytest.raises(appell.SpecError) as failure:
        appell.load(text)
    found = failure.value.diagnostics[0]
    assert found.severity == "error"
    line = text.splitlines()[found.line - 1]
    assert line[: found.column - 1].endswith('unit = "mm/')
    with pytest.raises(appell.RequestError, match="did you mean `theta`"):
        appell.load("pendulum").state(thet=1)
    with pytest.raises(appell.DataError):
        appell.load("/nowhere/spec.toml")


@pytest.mark.parametrize("name", ["unicycle", "bicycle", "four_bar", "cart_pole"])
@pytest.mark.parametrize("threads", [1, 3])
def test_blocks_of_places_have_the_bits_of_single_ones(model, name, threads):
    m = model(name)
    x, u, p = places(m, 101)
    acceleration = np.random.default_rng(2).standard_normal((101, len(m.speeds)))
    t = np.linspace(0, 1, 101)

    def same(many, single):
        for row in range(101):
            for part, one in zip(many, single(row), strict=True):
                assert part[row].tobytes() == one.tobytes()

    for function in (m.rates, m.outputs, m.parameter_jacobian, m.constraint_forces):
        same([function(x, u, p, t, threads=threads)], lambda row, f=function: [f(x[row], u[row], p[row], t[row])])
    for function in (m.jacobians, m.output_jacobians, m.appell):
        same(function(x, u, p, t, threads=threads), lambda row, f=function: f(x[row], u[row], p[row], t[row]))
    same([m.inverse_dynamics(acceleration, x, threads=threads)], lambda row: [m.inverse_dynamics(acceleration[row], x[row])])
    same(m.inverse_dynamics_jacobians(acceleration, x), lambda row: m.inverse_dynamics_jacobians(acceleration[row], x[row]))
