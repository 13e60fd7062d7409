"""Ensembles on a graphics card: the same rows as on processors. A processor takes the place of the card, as the libraries
of `tests/card` have its calls; NVRTC compiles the same sources."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import appell
from test_cuda import ptx

HERE = Path(__file__).resolve().parents[3]

SWITCHED = """
[study]
model = "pendulum"
cases = 70
[motion]
t_end_s = 4
rtol = 1e-10
atol = 1e-10
METHOD
input.tau = "-0.2[N*m*s]*omega - SWITCHED + push*exp(-((t - when)/(0.02[s]))^2)"
[vary]
theta = { uniform = ["-2rad", "2rad"] }
a = { uniform = [-0.3, 0.3], unit = "rad" }
push = { uniform = [0, 3], unit = "N*m" }
when = { uniform = [1, 3], unit = "s" }
[keep]
end = { end = "theta" }
middle = { end = "omega", at_s = 1.7 }
most = { max = "tau" }
least = { min = "omega*omega - theta*1[1/s^2]" }
mean = { mean = "abs(theta)" }
over = { when = "theta > 30[deg]" }
fast = { when = "omega > 5[1/s]", stop = true }
also = { when = "omega > 5[1/s]" }
path = { course = "theta" }
"""
SWITCHED = SWITCHED.replace("SWITCHED", "if(theta > a, 0.3[N*m], -0.2[N*m])*if(abs(omega) > 1[1/s], 1, 0.5)")
NOISE = """
[study]
model = "pendulum"
cases = 30
[motion]
t_end_s = 2
input.tau = "-0.2[N*m*s]*omega - 0.5[N*m]*theta + gust"
[vary]
theta = { uniform = ["-1rad", "1rad"] }
[noise]
theta = { deviation = "0.5deg", every_s = 0.01 }
gust = { deviation = 0.3, every_s = 0.05, unit = "N*m" }
[keep]
end = { end = "theta" }
most = { max = "tau" }
mean = { mean = "gust*theta" }
"""
FALLS = """
[study]
model = "unicycle"
cases = 60
[motion]
t_end_s = 4
initial.omega_2 = "1[m/s]/R"
[vary]
theta = { normal = ["0deg", "8deg"] }
R = { scatter = "5%" }
[keep]
most = { max = "abs(theta)" }
fell = { when = "abs(theta) > 40[deg]" }
path = { course = "theta" }
"""
LAWS = """
[study]
model = "unicycle"
cases = 40
[motion]
t_end_s = 10
rtol = 6e-8
atol = 6e-8
feedback = "lane_change_5_m_s.toml"
[vary]
m = { uniform = ["9.5kg", "10.5kg"] }
R = { uniform = ["0.285m", "0.315m"] }
[keep]
y = { end = "y_G" }
speed = { end = "omega_2" }
"""
LOOP = """
[study]
model = "four_bar"
cases = 20
[motion]
t_end_s = 3
rtol = 1e-12
atol = 1e-12
input.tau = "if(t < 1, 2, -1)*torque"
[vary]
theta1 = { uniform = ["0.8rad", "1.2rad"] }
torque = { uniform = [0, 2], unit = "N*m" }
[keep]
end = { end = "theta3" }
mean = { mean = "theta2" }
high = { when = "theta3 > 1.7[rad]" }
"""
SPECS = """
[study]
cases = 20
[motion]
t_end_s = 2
[vary]
model = { choice = ["pendulum", "pendulum"] }
theta = { uniform = ["-1rad", "1rad"] }
[keep]
end = { end = "theta" }
"""
STUDIES = {
    "switched": SWITCHED.replace("METHOD", ""),
    "switched_5": SWITCHED.replace("METHOD", 'method = "dopri5"'),
    "noise": NOISE,
    "falls": FALLS,
    "laws": LAWS,
    "loop": LOOP,
    "specs": SPECS,
}
# Of the largest value of a column: what the tolerances of the study leave.
TOLERANCE = {"switched": 1e-6, "switched_5": 1e-6}

RUN = """
import sys, numpy, appell
study, folder, out = sys.argv[1:]
rows = appell.ensemble(open(study).read(), folder=folder, device="cuda")
numpy.savez(out, reasons=rows.reasons, **{name: rows[name] for name in rows.columns})
"""


@pytest.fixture(scope="module")
def card(tmp_path_factory):
    """The environment of a process that finds a card."""
    folder = tmp_path_factory.mktemp("card")
    for name in ("cuda", "nvrtc"):
        source = HERE / f"tests/card/{name}.c"
        built = folder / f"lib{name}.so"
        subprocess.run(["cc", "-O1", "-Wall", "-shared", "-fPIC", str(source), "-o", str(built), "-ldl"], check=True)
    return {**os.environ, "LD_LIBRARY_PATH": str(folder), "CARD_FOLDER": str(folder)}


def on_card(card, folder, text, **more):
    """The rows of a study, from a process with a card."""
    study, out = folder / "study.txt", folder / "rows.npz"
    study.write_text(text)
    command = [sys.executable, "-c", RUN, str(study), str(HERE / "docs/examples/feedback"), str(out)]
    subprocess.run(command, check=True, env={**card, **more})
    return np.load(out)


def same(rows, expected, tolerance):
    np.testing.assert_array_equal(rows["reasons"], expected.reasons)
    for name in expected.columns:
        own, wanted = rows[name], expected[name]
        size = np.nanmax(np.abs(wanted), initial=0.0)
        np.testing.assert_allclose(own, wanted, rtol=0, atol=tolerance * max(size, 1e-9), err_msg=name)


@pytest.mark.parametrize("name", STUDIES)
def test_rows_are_those_of_processors(card, tmp_path, name):
    text = STUDIES[name]
    expected = appell.ensemble(text, folder=HERE / "docs/examples/feedback")
    same(on_card(card, tmp_path, text), expected, TOLERANCE.get(name, 1e-7))


def test_cases_that_do_not_fit_into_memory_come_in_parts(card, tmp_path):
    text = SPECS.replace("cases = 20", "cases = 600")
    same(on_card(card, tmp_path, text, CARD_MEMORY="8000"), appell.ensemble(text), 1e-7)


@pytest.mark.parametrize("name", STUDIES)
def test_motions_compile_for_graphics_cards(name):
    study = appell.Ensemble(STUDIES[name], folder=HERE / "docs/examples/feedback")
    for source in study.cuda():
        assert ".visible .entry motion_cases(" in ptx(source, (b"--gpu-architecture=compute_80",))


def test_what_a_card_cannot_compute_is_said(tmp_path):
    law = (HERE / "docs/examples/feedback/lane_change_5_m_s.toml").read_text()
    (tmp_path / "lane_change_5_m_s.toml").write_text(law.replace("gains", "sampled_ms = 10\ngains", 1))
    study = appell.Ensemble(LAWS, folder=tmp_path)
    with pytest.raises(appell.Error, match="discrete time"):
        study.cuda()


ARRAYS = """
import sys, numpy as np, appell
m = appell.load("cart_double_pendulum")
card = m.on_card("rates", "jacobians", "inverse_dynamics")
draw = np.random.default_rng(1)
x, u = draw.standard_normal((5, len(m.states))), draw.standard_normal((5, len(m.inputs)))
p = np.asarray(m.parameter_values()) * (1 + 0.05 * draw.standard_normal((5, len(m.parameters))))
near = dict(rtol=1e-12, atol=1e-12)
rates = card.rates(x, u)
assert rates.shape == (5, len(m.states))
np.testing.assert_allclose(rates, m.rates(x, u), **near)
both = card.jacobians(x, u, p, 0.0)
for name, own in zip(("rates", "a", "b"), m.jacobians(x, u, p)):
    np.testing.assert_allclose(getattr(both, name), own, **near)
# An array on the card is read where it lies.
again = card.rates(rates, u=u)
np.testing.assert_allclose(again, m.rates(np.asarray(rates), u), **near)
np.testing.assert_array_equal(np.from_dlpack(rates, device="cpu"), rates.numpy())
accelerations = draw.standard_normal((5, 3))
demand = card.inverse_dynamics(accelerations, x, u=u)
np.testing.assert_allclose(demand, m.inverse_dynamics(accelerations, x, u), **near)
from appell import _card
import gc
capsule = rates.__dlpack__()
assert len(_card._lent) == 1
del capsule
gc.collect()
assert not _card._lent
for wrong, words in (((x[:, :3],), "needs (N, 6)"), ((x, u[:2]), "needs (5, 1)"), ((both.a,), "the shape")):
    try:
        card.rates(*wrong)
    except ValueError as error:
        assert words in str(error), error
    else:
        raise AssertionError(words)
try:
    card.outputs(x)
except AttributeError as error:
    assert "on_card" in str(error)
"""


def test_arrays_on_the_card(card):
    subprocess.run([sys.executable, "-c", ARRAYS], check=True, env=card)
