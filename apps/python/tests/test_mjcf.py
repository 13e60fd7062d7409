"""MJCF against MuJoCo: its whole schema is known, and what changes the motion there is read, listed or refused."""

import itertools
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import appell

mujoco = pytest.importorskip("mujoco")

NO_MJCF = re.compile(r"has no attribute|holds no element")
ROUNDING = 1e-9
"""Accelerations of some hundred rad/s², by two programs."""


def schema():
    """Paths of elements with their attributes."""
    path, found = [], {}
    for line in mujoco.mj_printSchema(False, False).splitlines():
        begins = re.match(r"( *)(\S+) \((.)\) *(.*)$", line)
        if begins:
            indent, name, _, rest = begins.groups()
            path = path[: len(indent) // 3] + ["body" if name == "(world)body" else name]
            found[tuple(path)] = rest.split()
        elif path:
            found[tuple(path)] += line.split()
    return found


SCHEMA = schema()


def file_with(path, attributes):
    """A file with an element and its attributes, and what holds it."""
    path = list(path)
    if "body" in path and "worldbody" not in path:
        path.insert(path.index("body"), "worldbody")
    outer = element = ET.Element(path[0])
    for name in path[1:]:
        element = ET.SubElement(element, name)
    element.attrib.update(dict.fromkeys(attributes, "1"))
    return outer


def wrong(file, element):
    """Messages about a file, with its warnings."""
    file.write_text(ET.tostring(element, encoding="unicode"))
    try:
        robot = appell.import_robot(file)
    except appell.SpecError as error:
        return [one.message for one in error.diagnostics]
    return [one.message for all in robot.warnings.values() for one in all]


def test_the_schema_is_that_of_a_release():
    assert len(SCHEMA) > 100
    assert "gravcomp" in SCHEMA[("mujoco", "body")]
    assert "gravity" in SCHEMA[("mujoco", "option", "flag")]


@pytest.mark.parametrize("path", SCHEMA, ids="/".join)
def test_every_attribute_of_the_schema_is_known(tmp_path, path):
    told = wrong(tmp_path / "robot.xml", file_with(path, SCHEMA[path]))
    assert not [message for message in told if NO_MJCF.search(message)]


def test_what_is_not_in_the_schema_is_refused(tmp_path):
    for path in [("mujoco", "option"), ("mujoco", "body", "joint"), ("mujoco", "default", "geom")]:
        told = wrong(tmp_path / "robot.xml", file_with(path, ["nonesuch"]))
        assert [message for message in told if "has no attribute `nonesuch`" in message]
    told = wrong(tmp_path / "robot.xml", file_with(("mujoco", "nonesuch"), []))
    assert [message for message in told if "holds no element `nonesuch`" in message]


ROBOT = """
<mujoco model="robot">
  <compiler/>
  <option><flag/></option>
  <default><joint/><geom/><site/><tendon/><general/></default>
  <worldbody>
    <body name="a" pos="0 0 1"><joint name="h" axis="0 1 0" stiffness="2" damping="0.3" springref="20"/>
      <geom type="box" size="0.2 0.03 0.02" pos="0.2 0.01 0"/><site name="p" pos="0.3 0 0.1"/>
      <body name="b" pos="0.4 0 0"><joint name="k" axis="0 0.3 1"/>
        <inertial pos="0.1 0 0.02" mass="0.3" diaginertia="0.001 0.002 0.0025"/>
        <frame><body name="c" pos="0.2 0 0"><joint name="s" type="slide" axis="1 0 0"/><geom size="0.05"/></body></frame>
        <site name="q" pos="0 0.1 0"/></body></body>
    <site name="o" pos="0 0.1 2"/>
  </worldbody>
  <tendon>
    <fixed name="t"><joint joint="h" coef="1"/><joint joint="k" coef="-2"/></fixed>
    <spatial name="u"><site site="o"/><site site="p"/></spatial>
  </tendon>
  <actuator><general joint="h"/><motor tendon="t"/><position joint="k"/></actuator>
</mujoco>
"""
"""One of most elements that move something."""
STATE = {"h": 0.3, "k": -0.2, "s": 0.05, "v_h": 0.7, "v_k": -1.1, "v_s": 0.4}
NUMBERS = ["1", "0.3", "0.4 0.2", "0.3 0.1 0.2", "0.9 0.1 0.3 0.2", "0.3 0.1 0.2 0.1 0.02 0.03"]
VALUES = ["true", "false", "disable", "enable", "radian", "zyx", "capsule", "p", *NUMBERS]


def accelerations(text):
    """Those of MuJoCo without constraints and without forces of actuators, or none where it refuses the file."""
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError:
        return None
    data = mujoco.MjData(model)
    for off in (mujoco.mjtDisableBit.mjDSBL_CONTACT, mujoco.mjtDisableBit.mjDSBL_ACTUATION):
        model.opt.disableflags |= int(off)
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, joint) for joint in range(model.njnt)]
    if names != ["h", "k", "s"] or model.nq != model.nv:
        return None
    data.qpos[:] = [STATE[name] for name in names]
    data.qvel[:] = [STATE["v_" + name] for name in names]
    mujoco.mj_forward(model, data)
    return data.qacc_smooth.copy()


def ours(robot):
    model = robot.model()
    rates = dict(zip(model.states, model.rates([STATE[name] for name in model.states])))
    return np.array([rates["v_" + name] for name in "hks"])


def schema_of(element, holders):
    """The attributes of an element of the robot."""
    path = tuple(name for name in (*holders, element.tag) if name not in ("worldbody", "frame"))
    path = tuple(name for name, after in itertools.zip_longest(path, path[1:]) if not name == after == "body")
    return SCHEMA.get(path, [])


def variants():
    """The robot with each attribute of each of its elements, at values of all kinds."""
    outer = ET.fromstring(ROBOT)
    open = [(outer, ())]
    while open:
        element, holders = open.pop()
        open += [(inner, (*holders, element.tag)) for inner in element]
        for key in schema_of(element, holders):
            before = dict(element.attrib)
            for value in VALUES:
                element.set(key, value)
                if before.get(key) != value and key not in ("name", "joint", "tendon"):
                    yield f"{element.tag} {key}={value}", key, element.tag, ET.tostring(outer, encoding="unicode")
            element.attrib.clear()
            element.attrib.update(before)


def test_what_changes_the_motion_is_read_or_listed_or_refused(tmp_path):
    file = tmp_path / "robot.xml"
    plain = accelerations(ROBOT)
    assert plain is not None
    matched, missed = 0, []
    seen = {}
    for what, key, tag, text in variants():
        theirs = accelerations(text)
        if theirs is None or np.allclose(theirs, plain, rtol=1e-12, atol=1e-12):
            continue
        # Two values of an attribute suffice.
        seen[tag, key] = seen.get((tag, key), 0) + 1
        if seen[tag, key] > 2:
            continue
        file.write_text(text)
        try:
            robot = appell.import_robot(file)
        except appell.SpecError:
            continue
        listed = {one.what for one in robot.left_out if one.effect}
        told = [one.message for all in robot.warnings.values() for one in all]
        if any(what.endswith(f"/{key}") for what in listed) or any(f"`{key}`" in words for words in told):
            continue
        # Spatial tendons are listed as a whole, and so are actuators, except what they add to a joint.
        # The defaults of tendons are those of the spatial one as well.
        kind = "spatial" if tag == "tendon" else tag
        if f"tendon/{kind}" in listed or (f"actuator/{tag}" in listed and key not in ("armature", "damping", "gear")):
            continue
        if np.allclose(ours(robot), theirs, rtol=ROUNDING, atol=ROUNDING):
            matched += 1
        else:
            missed.append(what)
    assert not missed
    assert matched > 40
