"""Robot files."""

import os
import shutil
import subprocess

import numpy as np
import pytest

import appell


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("robot")
    assert appell.sample_robot(folder) == ["arm.urdf", "arm.xml"]
    return folder


@pytest.mark.parametrize(("name", "format"), [("arm.urdf", "URDF"), ("arm.xml", "MJCF")])
def test_the_spec_is_that_of_the_command(folder, name, format):
    robot = appell.import_robot(folder / name)
    assert (robot.name, robot.format, robot.joints) == ("arm", format, 4)
    assert np.linalg.eigvalsh(robot.model().mass_matrix()).min() > 0
    command = os.environ.get("APPELL_COMMAND") or shutil.which("appell")
    if command is None:
        pytest.skip("the command `appell` is not there; APPELL_COMMAND tells its path")
    told = subprocess.run([command, "import", str(folder / name), "-o", "-"], capture_output=True, check=True)
    assert told.stdout.decode() == robot.spec


def test_numbers_become_parameters(folder, tmp_path):
    robot = appell.import_robot(folder / "arm.urdf", parameters=["elbow", "m_turret"], without=["limits", "friction"])
    model = robot.model()
    assert "m_turret" in model.parameters
    robot.save(tmp_path / "arm.toml")
    assert appell.load(tmp_path / "arm.toml").states == model.states


def test_what_is_left_out_has_its_lines(folder):
    left_out = {one.what: one for one in appell.import_robot(folder / "arm.urdf").left_out}
    assert left_out["transmission"].lines
    assert left_out["transmission"].file.endswith("arm.urdf")
    left_out = {one.what: one for one in appell.import_robot(folder / "arm.xml").left_out}
    assert all("input of the joint" in one.effect for what, one in left_out.items() if what.startswith("actuator/"))


def test_locked_joints_have_no_coordinate(folder):
    whole = appell.import_robot(folder / "arm.xml").model()
    stiff = appell.import_robot(folder / "arm.xml", lock={"elbow": 0.5, "reach": None})
    assert stiff.joints == 2
    model = stiff.model()
    assert set(model.states) == {name for name in whole.states if "elbow" not in name and "reach" not in name}
    state = {name: 0.1 for name in whole.states}
    state |= {"elbow": 0.5, "v_elbow": 0, "reach": 0, "v_reach": 0}
    free = [name for name in whole.states if name in model.states and name.startswith("v_")]
    speeds = [name for name in whole.states if name.startswith("v_")]
    kept = [speeds.index(name) for name in free]
    mass = whole.mass_matrix([state[name] for name in whole.states])
    reduced = model.mass_matrix([state[name] for name in model.states])
    assert np.allclose(reduced, mass[np.ix_(kept, kept)], rtol=1e-12, atol=1e-12)
    with pytest.raises(appell.RequestError, match="did you mean `elbow`"):
        appell.import_robot(folder / "arm.xml", lock=["elbw"])


def test_what_is_wrong_has_its_place(folder, tmp_path):
    (tmp_path / "bad.urdf").write_text("<robot>\n  <link/>\n</robot>")
    with pytest.raises(appell.SpecError) as caught:
        appell.import_robot(tmp_path / "bad.urdf")
    assert caught.value.diagnostics[0].line == 2
    with pytest.raises(ValueError, match="did you mean `damping`"):
        appell.import_robot(folder / "arm.urdf", without="dampng")
    with pytest.raises(appell.RequestError, match="m_turret"):
        appell.import_robot(folder / "arm.urdf", parameters="m_turet")
    with pytest.raises(appell.DataError, match="absent"):
        appell.import_robot(tmp_path / "absent.urdf")
