"""Simulated motions."""

import _thread
import pickle
import signal

import numpy as np
import pytest

import appell


def test_inputs_of_all_kinds_drive_alike(model):
    m = model("cart_pole")
    t = np.linspace(0, 1, 2001)
    kinds = [
        "2 [N]*sin(3 [1/s]*t)",
        lambda t, x: 2 * np.sin(3 * t),
        (t, 2 * np.sin(3 * (t + 0.00025))),
    ]
    expected, *others = [m.simulate(1, inputs={"F": kind}) for kind in kinds]
    np.testing.assert_allclose(others[0]["x"], expected["x"], atol=1e-9)
    np.testing.assert_allclose(others[1]["x"], expected["x"], atol=1e-6)
    whole = m.simulate(1, inputs=lambda t, x: [2 * np.sin(3 * t)])
    np.testing.assert_allclose(whole["x"], expected["x"], atol=1e-9)
    constant = m.simulate(1, inputs={"F": 2.0})
    assert set(constant["F"]) == {2.0}


def test_feedback_sees_the_state_by_name(model):
    m = model("cart_pole")
    law = m.control(poles=-3)
    assert np.all(law.poles.real < 0)
    by_law = m.simulate(4, initial={"theta": "5deg"}, feedback=law)
    gains = dict(zip(law.outputs, law.K[0], strict=True))
    by_hand = m.simulate(
        4, initial={"theta": "5deg"}, inputs={"F": lambda t, x: -sum(k * x[s] for s, k in gains.items())}
    )
    np.testing.assert_allclose(by_hand["theta"], by_law["theta"], atol=1e-8)
    assert abs(by_law["theta"][-1]) < 1e-3


def test_numbers_are_in_si_and_texts_in_units(model):
    m = model("pendulum")
    motions = [m.simulate(1, initial={"theta": value}) for value in (np.pi / 6, "30deg", m.state(theta="30deg")["theta"])]
    motions.append(m.simulate(1, initial=m.state(theta="30deg")))
    for motion in motions:
        np.testing.assert_allclose(motion["theta"], motions[0]["theta"], atol=1e-12)
    np.testing.assert_allclose(motions[0].x["theta"], motions[0]["theta"])


def test_an_exception_in_an_input_is_raised(model):
    def broken(t, x):
        if t > 0.5:
            raise LookupError("no more inputs")
        return 0.0

    with pytest.raises(LookupError, match="no more inputs"):
        model("cart_pole").simulate(5, inputs={"F": broken})
    with pytest.raises(ValueError, match="there are 1 inputs"):
        model("cart_pole").simulate(1, inputs=lambda t, x: [1, 2])


def test_an_interruption_ends_a_motion_at_once(model):
    calls = 0

    def interrupting(t, x):
        nonlocal calls
        calls += 1
        if calls == 50:
            _thread.interrupt_main()
        return 0.0

    # A shell starts what it puts into the background with interruptions ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            model("cart_pole").simulate(1000, initial={"theta": 1.0}, inputs={"F": interrupting})
    finally:
        signal.signal(signal.SIGINT, before)
    # Of some hundred thousand.
    assert calls < 20_000


@pytest.mark.parametrize(
    "request_, message",
    [
        ({"t_end": -1}, "positive"),
        ({"t_end": 1, "initial": {"thet": 1}}, "did you mean"),
        ({"t_end": 1, "inputs": {"G": 1.0}}, "G"),
        ({"t_end": 1, "inputs": {"G": lambda t, x: 1.0}}, "G"),
        ({"t_end": 1, "method": "euler"}, "dop853"),
        ({"t_end": 1, "record": ["all"]}, "reactions"),
        ({"t_end": 1, "inputs": {"F": ([0.0, 1.0], [1.0])}}, "2"),
        ({"t_end": 1, "initial": np.zeros(3)}, "4 values"),
    ],
)
def test_wrong_requests_are_refused(model, request_, message):
    with pytest.raises((appell.Error, ValueError), match=message):
        model("cart_pole").simulate(request_.pop("t_end"), **request_)


def test_a_motion_becomes_tables_and_pictures(model, tmp_path):
    motion = model("unicycle").simulate(1, dt=0.1, record=["reactions", "contacts"])
    assert any(name.startswith("reaction_") for name in motion.columns)
    frame = pytest.importorskip("pandas") and motion.to_pandas()
    assert frame.shape == (11, len(motion.columns))
    set_ = pytest.importorskip("xarray") and motion.to_xarray()
    assert set_["theta"].shape == (11,)
    page = motion._repr_html_()
    assert page.startswith("<iframe") and "sandbox" in page
    motion.to_csv(tmp_path / "motion.csv")
    assert (tmp_path / "motion.csv").read_text().splitlines()[-1].startswith("1")
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    axes = motion.plot("theta", "psi")
    assert "theta" in axes[0].get_ylabel()
    assert motion.figure.svg.startswith("<svg")
    assert motion.statistics["steps"] > 0


def test_steady_motions_have_their_stability(model):
    m = model("rolling_wheel")
    motions = m.steady({"theta": 0, "omega_2": "20rad/s"})
    assert motions and all(len(motion.x) == len(m.states) for motion in motions)
    np.testing.assert_allclose(m.rates(motions[0].x, motions[0].u, motions[0].p)[: len(m.speeds)], 0, atol=1e-9)
    branches = m.steady({"theta": 0}, along=("omega_2", 1.0, 20.0))
    assert len({motion.verdict for motion in branches[0]}) > 1


def test_linear_equations_fit_other_packages(model):
    signal = pytest.importorskip("scipy.signal")
    m = model("cart_pole")
    upright = m.steady({"theta": 0, "v": 0})[0]
    linear = m.linearise(upright)
    system = signal.StateSpace(*linear[:4])
    assert system.A.shape == (4, 4)
    np.testing.assert_array_equal(linear.A, m.jacobians(upright.x, upright.u).A)


def test_equations_are_typeset(model):
    m = model("pendulum")
    assert m.equations._repr_latex_().startswith("\\begin{align*}")
    assert "<math" in m.equations.text and "\\documentclass" in m.equations.latex
    assert "Acceleration energy" in m.derivation.plain
    assert m.draw(theta="30deg").svg.startswith("<svg")


def test_a_batch_of_initial_states_has_the_motions_of_a_loop():
    m = appell.load("cart_pole")
    starts = np.tile(m.state(), (11, 1))
    starts[:, m.states.index("theta")] = np.linspace(-0.2, 0.2, len(starts))
    motions = m.simulate(1, initial=starts, inputs={"F": "2*sin(3*t)"})
    assert motions["theta"].shape == (11, len(motions.t))
    assert motions.failures == (None,) * 11
    for number, start in enumerate(starts):
        alone = m.simulate(1, initial=start, inputs={"F": "2*sin(3*t)"})
        # The elementary functions of lanes differ from those of the library in last digits.
        assert np.allclose(motions.x[number], alone.x, rtol=0, atol=1e-8)
        assert motions[number].columns == alone.columns


def test_motions_travel_by_pickle():
    m = appell.load("cart_pole")
    motion = m.simulate(1, initial={"theta": 0.1}, inputs={"F": lambda t, x: -x["theta"]}, record=["reactions"])
    again = pickle.loads(pickle.dumps(motion))
    assert again.columns == motion.columns
    assert np.array_equal(again.values, motion.values) and np.array_equal(again.t, motion.t)
    assert again.summary == motion.summary and again.statistics == motion.statistics
    assert again.failure is None and again.page.text == motion.page.text


def test_errors_name_arguments_of_python():
    m = appell.load("cart_pole")
    with pytest.raises(appell.RequestError, match="^t_end: "):
        m.simulate(-1)
    with pytest.raises(appell.RequestError, match="^dt: "):
        m.simulate(1, dt=1e-12)
    with pytest.raises(appell.RequestError, match="^parameters: "):
        m.simulate(1, parameters={"nothing": 1})
