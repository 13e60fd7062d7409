"""What the tests share."""

import os

import numpy as np
import pytest

# Tests keep nothing in the cache of the user.
os.environ["APPELL_CACHE"] = ""

import appell  # noqa: E402


@pytest.fixture(scope="session")
def model():
    """Loads models once."""
    known = {}

    def load(name):
        if name not in known:
            known[name] = appell.load(name)
        return known[name]

    return load


@pytest.fixture(scope="session")
def rig(tmp_path_factory):
    """Recordings of a rig with effects that its spec lacks."""
    folder = tmp_path_factory.mktemp("rig")
    appell.sample_rig(folder)
    return folder


def places(model, count, seed=1):
    """States, inputs and parameters near those of the spec."""
    draw = np.random.default_rng(seed)
    x = np.asarray(model.state()) + 0.2 * draw.standard_normal((count, len(model.states)))
    u = 0.3 * draw.standard_normal((count, len(model.inputs)))
    p = np.asarray(model.parameter_values()) * (1 + 0.05 * draw.standard_normal((count, len(model.parameters))))
    return x, u, p
