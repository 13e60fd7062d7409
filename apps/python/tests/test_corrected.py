"""Corrected MJCF files in MuJoCo against the spec of the robot with the same effect."""

import json
import tomllib

import numpy as np
import pytest

import appell

mujoco = pytest.importorskip("mujoco")

EXACT = 1e-9
"""Accelerations of some hundred rad/s², by two programs."""
ARM = """<?xml version="1.0"?>
<mujoco model="arm">
  <option timestep="0.001"/>  <!-- quick -->
  <default><default class="drive"><position kp="30" kv="1.5" forcerange="-6 4"/></default></default>
  <worldbody>
    <body name="upper" pos="0 0 1">
      <joint name="h" axis="0 1 0" damping="0.3" range="-90 80" springref="10" stiffness="2"/>
      <geom type="box" size="0.2 0.03 0.02" pos="0.2 0.01 0" density="900"/>
      <body name="fore" pos="0.4 0 0" euler="0 20 0">
        <joint name="k" axis="0 0.3 1" armature="0.02"/>
        <inertial pos="0.1 0 0.02" mass="0.3" quat="0.9 0.1 0 0.2" diaginertia="0.001 0.002 0.0025"/>
        <body name="hand" pos="0.2 0 0"><geom size="0.03"/></body>
        <body name="tip" pos="0.3 0 0.1">
          <joint name="s" type="slide" axis="1 0 1"/>
          <inertial pos="0.02 0.01 0" mass="0.2" diaginertia="0.001 0.001 0.001"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="servo" class="drive" joint="h" gear="2" armature="0.01" damping="0.05"/>
    <motor name="motor" joint="k" gear="3" ctrlrange="-2 2" armature="0.003"/>
    <general name="mix" joint="s" gainprm="4" biastype="affine" biasprm="0.5 -3 -0.7"/>
  </actuator>
</mujoco>
"""
JOINTS = {"h": 0.3, "k": -0.2, "s": 0.05}


def report(effects, sizes=(), items="", inputs=(), fitted=()):
    """A gap report with one hypothesis."""
    unit = {"unit": "1", "std": 0.01}
    return json.dumps({
        "schema": "gap-report/1",
        "mechanism": "arm",
        "which": [{
            "effects": effects,
            "probability": 1.0,
            "parameters": [{"name": name, "value": value, **unit} for name, value in sizes],
            "changes": {
                "items": items,
                "inputs": [{"input": name, "adds": adds} for name, adds in inputs],
                "parameters": [{"name": name, "stated": 0.0, "value": value, "unit": unit, "std": 0.01} for name, value, unit in fitted],
                "beside": [],
            },
        }],
    })  # fmt: skip


def theirs(text, places, shift=0.0):
    """Accelerations of MuJoCo; readings of the first joint are shifted."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT)
    for q, w, u in places:
        data.qpos[:] = q + [shift, 0, 0]
        data.qvel[:] = w
        data.ctrl[:] = u
        data.act[:] = u[: model.na]
        mujoco.mj_forward(model, data)
        yield data.qacc.copy()


def ours(text, places):
    model = appell.load(text)
    for q, w, u in places:
        values = dict(zip(JOINTS, q)) | {f"v_{name}": rate for name, rate in zip(JOINTS, w)}
        inputs = dict(zip(["servo", "motor", "mix"], u))
        x = [values[name] for name in model.states]
        rates = model.rates(x, [inputs[name] for name in model.inputs])
        rates = dict(zip(model.states, rates))
        yield np.array([rates[f"v_{name}"] for name in JOINTS])


@pytest.fixture
def compared(tmp_path):
    """Demands that the corrected file moves as the spec with the same effect; returns its text."""
    file = tmp_path / "robot.xml"
    draw = np.random.default_rng(7)
    places = [(draw.uniform(-1, 1, 3), draw.uniform(1, 4, 3) * draw.choice([-1, 1], 3), draw.uniform(-3, 3, 3)) for _ in range(20)]

    def compare(effects, sizes=(), items="", inputs=(), fitted=(), shift=0.0, file_text=ARM):
        file.write_text(file_text)
        letters = [name for name, *_ in fitted] or "none"
        spec = appell.import_robot(file, actuators=True, parameters=letters).spec
        stated = {name: load.get("force") for name, load in tomllib.loads(spec)["loads"].items()}
        for name, force in stated.items():
            items = items.replace(f"<{name}>", force or "")
        of_spec = report(effects, (), items, inputs, [(own, value, unit) for _, own, value, unit in fitted])
        better_spec, _ = appell._appell.apply("robot.toml", spec, of_spec, None, "better.toml")
        of_file = report(effects, sizes, items, inputs, [(name, value, unit) for name, _, value, unit in fitted])
        better, _ = appell.corrected_robot(file, of_file)
        for a, b in zip(theirs(better, places, shift), ours(better_spec, places), strict=True):
            np.testing.assert_allclose(a, b, rtol=EXACT, atol=EXACT)
        if not shift:
            before = np.array(list(theirs(file_text, places)))
            assert abs(np.array(list(theirs(better, places))) - before).max() > 1e-3
        return better

    return compare


def parameter(name, value, unit):
    return f'[parameters]\n{name} = {{ value = {value}, unit = "{unit}" }}\n'


def force(joint, force):
    return f'[loads]\ne = {{ kind = "generalized", coordinate = "{joint}", force = "{force}" }}\n'


@pytest.mark.parametrize("joint, unit", [("h", "N*m*s/rad"), ("s", "N*s/m")])
def test_viscous_friction(compared, joint, unit):
    items = parameter("e_c", 0.4, unit) + force(joint, f"-e_c*dot({joint})")
    compared([f"viscous_friction@{joint}"], [(f"viscous_friction@{joint}.coefficient", 0.4)], items)


def test_coulomb_friction_at_all_drives(compared):
    names, sizes, loads = [], [], "[loads]\n"
    for joint, unit in [("h", "rad/s"), ("k", "rad/s"), ("s", "m/s")]:
        of = "N" if joint == "s" else "N*m"
        loads += f'e_{joint} = {{ kind = "generalized", coordinate = "{joint}", force = "-0.2 [{of}]*smooth_sign(dot({joint}), 1e-7 [{unit}])" }}\n'
        sizes.append((f"coulomb_friction@drives.{joint}_force", 0.2))
        names.append(joint)
    better = compared(["coulomb_friction@drives"], sizes, loads)
    assert better.count('frictionloss="0.2"') == 3


def test_spring(compared):
    items = force("h", "-1.5 [N*m/rad]*h")
    compared(["spring@h"], [("spring@h.stiffness", 1.5)], items)


def test_payload_at_a_body_whose_axes_differ(compared):
    items = """[points]
    payload_fore = { from = "G_fore", in = "fore", at = ["0.1 [m]", "0.02 [m]", "-0.05 [m]"] }
    [bodies]
    payload_fore = { centre = "payload_fore", mass = "0.4 [kg]" }
    """
    sizes = [(f"payload@fore.{name}", value) for name, value in [("mass", 0.4), ("x", 0.1), ("y", 0.02), ("z", -0.05)]]
    compared(["payload@fore"], sizes, items)


def test_mass_offset(compared):
    items = """[parameters]
    mass_offset_fore_1_distance = { value = 0.02, unit = "m" }
    mass_offset_fore_3_distance = { value = -0.01, unit = "m" }
    [points]
    mass_offset_fore_1 = { from = "G_fore", in = "fore", at = ["1*mass_offset_fore_1_distance", "0*mass_offset_fore_1_distance", "0*mass_offset_fore_1_distance"] }
    mass_offset_fore_3 = { from = "mass_offset_fore_1", in = "fore", at = ["0*mass_offset_fore_3_distance", "0*mass_offset_fore_3_distance", "1*mass_offset_fore_3_distance"] }
    [bodies]
    fore = { centre = "mass_offset_fore_3" }
    """
    compared(["mass_offset@fore", "mass_offset@fore"], (), items)


def test_ground_slope(compared):
    items = """[parameters]
    ground_slope_gravity_1_angle = { value = 0.02, unit = "rad" }
    ground_slope_gravity_2_angle = { value = -0.01, unit = "rad" }
    [loads]
    ground_slope_gravity_1 = { kind = "gravity", down = "x", acceleration = "9.81 [m/s^2]*ground_slope_gravity_1_angle" }
    ground_slope_gravity_2 = { kind = "gravity", down = "y", acceleration = "9.81 [m/s^2]*ground_slope_gravity_2_angle" }
    """
    better = compared(["ground_slope@gravity"], (), items)
    assert 'gravity="0.1962 -0.0981 -9.81"' in better


def test_gain(compared):
    # All the force is larger, beyond the bounds of the command too.
    file = ARM.replace(' ctrlrange="-2 2"', "")
    sizes = [("actuator_gain@motor.gain", 0.1)]
    compared(["actuator_gain@motor"], sizes, inputs=[("motor", "0.1*motor")], file_text=file)
    for servo in ["servo", "mix"]:
        items = f'[loads]\n{servo} = {{ force = "1.1*(<{servo}>)" }}\n'
        compared([f"actuator_gain@{servo}"], [(f"actuator_gain@{servo}.gain", 0.1)], items)


def test_bias(compared):
    sizes = [("actuator_bias@motor.bias", 0.3)]
    file = ARM.replace(' ctrlrange="-2 2"', "")
    compared(["actuator_bias@motor"], sizes, inputs=[("motor", "0.3 [N*m]")], file_text=file)
    # The bias of a servo is not within the bounds of its force.
    file = ARM.replace(' forcerange="-6 4"', "")
    for servo, unit in [("servo", "N*m"), ("mix", "N")]:
        items = f'[loads]\n{servo} = {{ force = "<{servo}> + 0.3 [{unit}]" }}\n'
        compared([f"actuator_bias@{servo}"], [(f"actuator_bias@{servo}.bias", 0.3)], items, file_text=file)


def test_saturation_before_the_gear(compared):
    items = '[loads]\nservo = { force = "min(max(<servo>, -9 [N*m]), 9 [N*m])" }\n'
    better = compared(["saturation@servo"], [("saturation@servo.limit", 9.0)], items)
    assert 'forcerange="-4.5 4"' in better
    inputs = [("motor", "(min(max(motor, -1.5 [N*m]), 1.5 [N*m]) - motor)")]
    better = compared(["actuator_saturation@motor"], [("actuator_saturation@motor.limit", 1.5)], inputs=inputs)
    assert 'forcerange="-1.5 1.5"' in better


def test_bias_of_an_encoder(compared):
    file = ARM.replace('name="servo" class="drive"', 'name="servo" class="drive" kp="0" kv="0"')
    sizes = [("sensor_bias@h.bias", 0.05)]
    better = compared(["sensor_bias@h"], sizes, shift=0.05, file_text=file)
    assert 'range="-87.1352110243 82.8647889757"' in better


def test_lag_and_delay(compared, tmp_path):
    file = tmp_path / "robot.xml"
    file.write_text(ARM)
    for actuator in ["servo", "motor", "mix"]:
        effects = [f"actuator_lag@{actuator}", f"actuator_delay@{actuator}"]
        sizes = [(f"{effects[0]}.time_constant", 0.02), (f"{effects[1]}.delay", 0.005)]
        better, _ = appell.corrected_robot(file, report(effects, sizes))
        model = mujoco.MjModel.from_xml_string(better)
        own = model.actuator(actuator)
        assert own.dyntype[0] == mujoco.mjtDyn.mjDYN_FILTEREXACT
        assert own.dynprm[0] == 0.02
        # What it exerts once its command has come through is as before.
        place = [(np.array([0.1, 0.2, 0.1]), np.array([0.3, 0.1, 0.2]), np.array([0.4, 0.4, 0.4]))]
        model = better.replace(' delay="0.005" nsample="5"', "")
        assert model != better
        np.testing.assert_allclose(list(theirs(model, place)), list(theirs(ARM, place)), rtol=1e-12)


def test_fitted_numbers(compared):
    fitted = [
        ("upper.mass", "m_upper", 1.4, "kg"),
        ("fore.mass", "m_fore", 0.5, "kg"),
        ("fore.com.x", "cx_fore", 0.12, "m"),
        ("fore.com.y", "cy_fore", 0.01, "m"),
        ("upper.inertia", "inertia_upper", 1.2, "1"),
        ("h.damping", "damping_h", 0.6, "N*m*s/rad"),
        ("h.armature", "armature_h", 0.05, "kg*m^2"),
        ("k.armature", "armature_k", 0.03, "kg*m^2"),
        ("h.stiffness", "stiffness_h", 2.5, "N*m/rad"),
        ("servo.kp", "kp_servo", 25.0, "N*m/rad"),
        ("servo.kv", "kv_servo", 1.0, "N*m*s/rad"),
        ("servo.gear", "gear_servo", 2.1, "1"),
        ("servo.forcerange", "forcerange_servo", 1.2, "1"),
        ("motor.gear", "gear_motor", 2.8, "1"),
        ("option.gravity", "g", 9.7, "m/s^2"),
    ]
    for one in fitted:
        compared([], fitted=[one])
    compared([], fitted=fitted)


def test_armature_of_the_drive_alone(compared):
    # Less than what the actuator carries: the rest is taken from there.
    compared([], fitted=[("h.armature", "armature_h", 0.03, "kg*m^2")])


def test_without_changes_the_bytes_stay(tmp_path):
    file = tmp_path / "robot.xml"
    file.write_bytes(ARM.replace("\n", "\r\n").encode())
    better, summary = appell.corrected_robot(file, report([]))
    assert better.encode() == file.read_bytes()
    assert summary == ""
