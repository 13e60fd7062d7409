"""What people who write Python try."""

import copy
import math
import pickle

import numpy as np
import pytest

import appell


def test_a_scalar_time_is_one_place(model):
    m = model("cart_pole")
    assert m.rates(m.state(), m.input(), m.parameter_values(), 0.0).shape == (4,)
    assert m.jacobians(t=1).A.shape == (4, 4)
    assert m.rates(np.zeros((3, 4)), t=0.0).shape == (3, 4)
    assert m.rates(t=np.zeros(3)).shape == (3, 4)


def test_names_stay_with_their_columns(model):
    m = model("double_pendulum")
    x = m.simulate(1, dt=0.25).x
    assert x.names == m.states
    assert x[1:3].names == x[1].names == x[:, :].names == (2 * x).names == x.copy().names == m.states
    for turned in (x[:, ::-1], x[1][::-1], x[:4].T, x[:, [1, 0, 2, 3]], x[:4].reshape(-1)):
        assert turned.names is None


def test_models_and_vectors_travel(model):
    m = model("pendulum")
    x = m.state(theta=0.3)
    for travel in (copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))):
        assert travel(x)["theta"] == 0.3
        np.testing.assert_array_equal(travel(m).rates(x), m.rates(x))
    own = appell.load(m.spec.replace("pendulum", "swing", 1))
    assert pickle.loads(pickle.dumps(own)).name == own.name


def test_a_series_is_a_table(model):
    pandas = pytest.importorskip("pandas")
    series = pandas.Series([0.2, 0.7], index=[0.0, 0.5])
    motion = model("cart_pole").simulate(1, dt=0.25, inputs={"F": series})
    assert motion["F"].tolist() == [0.2, 0.2, 0.7, 0.7, 0.7]
    with pytest.raises(ValueError, match=r"F: a table is a pair \(times, values\)"):
        model("cart_pole").simulate(1, inputs={"F": np.zeros((2, 2))})


def test_functions_may_return_arrays_of_one(model):
    m = model("cart_pole")
    one, whole = (m.simulate(1, inputs=inputs) for inputs in ({"F": lambda t, x: np.array([t])}, lambda t, x: t))
    np.testing.assert_array_equal(one["x"], whole["x"])


def test_names_and_poles_stand_alone_or_in_lists(model):
    m = model("cart_pole")
    expected = m.control(poles="-3,-3,-4+1i,-4-1i").K
    np.testing.assert_allclose(m.control(poles=[-3, -3, -4 + 1j, -4 - 1j], inputs="F").K, expected)
    assert m.simulate(1, record="conditions").columns
    assert m.input(F="2N")["F"] == 2.0


def test_what_is_doubtful_warns(model):
    m = model("cart_pole")
    with pytest.warns(appell.Unstable, match="the closed loop is unstable"):
        m.control(poles=1)
    with pytest.warns(appell.EndsEarly, match="theta.* leaves its range"):
        model("unicycle").simulate(5, initial={"theta": "5deg"})


@pytest.mark.parametrize(
    "call, error, message",
    [
        (lambda m: m.rates({"theta": 0.1}), TypeError, "model.state"),
        (lambda m: m.rates(m.state() + 1e-20j), TypeError, "complex"),
        (lambda m: m.rates(out=np.zeros(4, dtype=int)), TypeError, "out needs an array of float64"),
        (lambda m: m.rates(np.zeros((3, 4)), out=np.zeros((4, 3)).T), ValueError, "not contiguous"),
        (lambda m: m.simulate(1, inputs=1.0), TypeError, "inputs is a dict"),
        (lambda m: m.simulate(1, inputs=lambda t, x: None), TypeError, "inputs returns None"),
        (lambda m: m.simulate(1, initial={"theta": math.nan}), ValueError, "not a finite number"),
        (lambda m: appell.load(None), TypeError, "not NoneType"),
        (lambda m: m.input(G=1), appell.RequestError, "G"),
    ],
)
def test_mistakes_are_told(model, call, error, message):
    with pytest.raises(error, match=message):
        call(model("cart_pole"))


def test_too_much_is_a_memory_error(model):
    places = np.broadcast_to(np.zeros(4), (2, 4))
    with pytest.raises((MemoryError, ValueError)):
        model("cart_pole").jacobians(np.broadcast_to(places[0], (1 << 46, 4)))


def test_a_model_of_a_text_follows_a_recording(rig):
    recorded = f"{rig}/recording.toml:run1.csv"
    of_text = appell.load((rig / "my_rig.toml").read_text()).simulate(2, recorded=recorded)
    of_file = appell.load(rig / "my_rig.toml").simulate(2, recorded=recorded)
    np.testing.assert_array_equal(of_text["x"], of_file["x"])


def test_rows_of_tables_are_held_or_joined(model):
    carriage = model("cart_pole")
    times = np.linspace(0, 1, 101)
    force = {"F": (times, np.sin(3 * times))}
    exact = carriage.simulate(1, inputs={"F": lambda t, x: math.sin(3 * t)})["x"][-1]
    ends = [carriage.simulate(1, inputs=force, interpolation=how)["x"][-1] for how in ("linear", "hold", "cubic")]
    # Lines miss a sine by h^2/12 of its curvature, rows that are held by half a row.
    assert abs(ends[0] - exact) < 1e-4 * abs(exact)
    assert abs(ends[1] - exact) > 1e-3 * abs(exact)
    # A spline misses it by h^4, but for the ends, where its curvature is taken to be zero.
    assert abs(ends[2] - exact) < 1e-6 * abs(exact)
    with pytest.raises(ValueError, match="hold"):
        carriage.simulate(1, inputs=force, interpolation="quintic")


def test_options_out_of_range_are_refused(rig):
    for option in ({"tolerance": 5}, {"horizon": -1}):
        with pytest.raises(ValueError, match="part of one|positive number"):
            appell.diagnose(rig, progress=False, **option)
