"""Robot files against MuJoCo 4.0, and robot files with damage."""

import json
import random
import re
from pathlib import Path

import numpy as np
import pytest

import appell

ROBOTS = Path(__file__).parent / "robots"
RATES = json.loads((ROBOTS / "rates.json").read_text())
"""States, and accelerations of `mj_forward` without contacts and limits, of robots without equality constraints."""
ROUNDING = 1e-11
"""Of both programs, and of the difference by which the rate of the Jacobian was taken."""
VALUES = ["0", "-1", "1e-9", "1e9", "-1e-20", "1e308", "0 0 0", "0 0 1", "1 0 0 0", "true", "disable", "ball", "slide"]
DAMAGED = 60
"""Files with damage: a model each, some hundredths of a second."""


@pytest.mark.parametrize("name", RATES)
def test_robots_move_as_mujoco_says(name):
    model = appell.import_robot(ROBOTS / f"{name}.xml").model()
    for case in RATES[name]:
        rates = dict(zip(model.states, model.rates([case["state"][state] for state in model.states])))
        for state, expected in case["rates"].items():
            assert np.isclose(rates[state], expected, rtol=ROUNDING, atol=ROUNDING), state


def damaged(text, chance):
    """The text with another value in place of one, with one of another place, or without an element."""
    places = [found.span(1) for found in re.finditer(r'"([^"]*)"', text)]
    start, end = chance.choice(places)
    kind = chance.randrange(4)
    if kind == 0:
        other = chance.choice(places)
        return text[:start] + text[slice(*other)] + text[end:]
    if kind == 1:
        end = chance.choice([found.end() for found in re.finditer("/>", text)])
        return text[: text.rfind("<", 0, end)] + text[end:]
    return text[:start] + chance.choice(VALUES) + text[end:]


def test_whatever_is_imported_is_a_model(tmp_path):
    chance = random.Random(46)
    file = tmp_path / "robot.xml"
    imported = 0
    for _ in range(DAMAGED):
        text = chance.choice(sorted(ROBOTS.glob("*.xml"))).read_text()
        for _ in range(chance.randint(1, 2)):
            text = damaged(text, chance)
        file.write_text(text)
        try:
            robot = appell.import_robot(file)
        except appell.SpecError:
            continue
        imported += 1
        # An error names the file with its damage.
        assert robot.model().states, text
    assert imported > 10
