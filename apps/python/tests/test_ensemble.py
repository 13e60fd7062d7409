"""Ensembles: rows as arrays, and chunks that several processes run."""

import multiprocessing
import pickle

import numpy as np
import pytest

import appell

STUDY = """
[study]
model = "pendulum"
cases = 60
chunk = 10
[motion]
t_end_s = 1
[vary]
theta = { uniform = ["-1rad", "1rad"] }
[keep]
reached = { end = "theta" }
path = { course = "theta" }
"""


def test_rows_are_arrays():
    swings = appell.ensemble(STUDY)
    assert swings.columns == ["theta", "reached"]
    assert swings["reached"].shape == (60,)
    times, path = swings.course("path")
    assert times.shape == (101,)
    assert path.shape == (60, 101)
    np.testing.assert_array_equal(path[:, -1], swings["reached"])
    np.testing.assert_array_equal(path[:, 0], swings["theta"])
    assert swings.to_dict()["kept"]["reached"]["count"] == 60
    assert set(swings.reasons) == {""}
    with pytest.raises(KeyError, match="there are theta, reached"):
        swings["tetha"]


def test_a_motion_of_a_case_is_the_motion_of_the_model():
    swings = appell.ensemble(STUDY)
    model = appell.load("pendulum")
    motion = model.simulate(1.0, initial={"theta": swings["theta"][7]})
    assert abs(motion["theta"][-1] - swings["reached"][7]) < 1e-8


def run(study, names):
    study.run(names, jobs=1)


def test_chunks_may_be_run_by_several_processes(tmp_path):
    study = appell.Ensemble(STUDY, tmp_path)
    missing = study.missing()
    assert len(missing) == 6
    assert missing == study.chunks()
    context = multiprocessing.get_context("spawn")
    with context.Pool(2) as pool:
        pool.starmap(run, [(study, missing[0::2]), (study, missing[1:4:2])])
    assert len(study.missing()) == 1
    whole = appell.ensemble(STUDY, tmp_path)
    assert whole.missing() == []
    np.testing.assert_array_equal(whole["reached"], appell.ensemble(STUDY)["reached"])
    again = pickle.loads(pickle.dumps(whole))
    np.testing.assert_array_equal(again["reached"], whole["reached"])


def test_mistakes_are_exceptions_with_places(tmp_path):
    with pytest.raises(appell.SpecError, match="did you mean `theta`") as error:
        appell.ensemble(STUDY.replace("theta = {", "thet = {"))
    assert error.value.diagnostics[0].line == 9
    study = appell.Ensemble(STUDY, tmp_path)
    with pytest.raises(appell.RequestError, match="no chunk of this study"):
        study.run(["other.parquet"])
