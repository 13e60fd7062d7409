"""The files of a case: tolerances, description, recordings, label."""

import copy
import csv
import math

import numpy as np

import rollouts
from make_robots import text, written

# Tolerances of the numbers of a file, as shares of their values.
SHARES = {"mass": 0.03, "inertia": 0.10, "kp": 0.02, "kv": 0.05, "gear": 0.02, "armature": 0.10, "damping": 0.15, "frictionloss": 0.15}


def numbers(root, centre):
    """Name -> element, attribute, entry of it and standard deviation: every number that has a tolerance."""
    found = {}

    def every(element, name, attribute, key=None):
        values = (element.get(key or attribute) or "").split()
        for entry, value in enumerate(values):
            found.setdefault(f"{name}.{attribute}", []).append((element, key or attribute, entry, SHARES[attribute] * float(value)))

    for body in root.iter("body"):
        own, name = body.find("inertial"), body.get("name")
        every(own, name, "mass")
        every(own, name, "inertia", "diaginertia")
        found |= {f"{name}.com.{axis}": [(own, "pos", entry, centre)] for entry, axis in enumerate("xyz")}
        for joint in body.findall("joint"):
            for attribute in ("armature", "damping", "frictionloss"):
                every(joint, joint.get("name"), attribute)
    for drive in root.find("actuator"):
        for attribute in ("kp", "kv", "gear"):
            every(drive, drive.get("name"), attribute)
    return found


def moved(places, deviations):
    """Moves a number by so many standard deviations."""
    for element, key, entry, deviation in places:
        words = element.get(key).split()
        words[entry] = f"{float(words[entry]) + deviations * deviation:.7g}"
        element.set(key, " ".join(words))


def perturbed(robot, rng):
    """A robot that differs from its file within tolerances; the offsets in standard deviations; the tolerances."""
    root = copy.deepcopy(robot.root)
    first = root.find(".//inertial").get("pos").split()
    centre = float(f"{0.02 * np.linalg.norm([float(word) for word in first]):.1g}")
    own = numbers(root, centre)
    offsets = {name: round(float(np.clip(rng.normal(0, 0.5), -1.2, 1.2)), 4) for name in own}
    for name, places in own.items():
        moved(places, offsets[name])
    used = {name.split(".")[1] for name in own} - {"com"}
    return root, offsets, {"com": centre} | {name: SHARES[name] for name in sorted(used)}


def units(robot, case):
    """Joint -> its unit and the factor from SI."""
    angle = ("deg", 180 / math.pi) if case["degrees"] else ("rad", 1.0)
    return {joint: ("m", 1.0) if slide else angle for joint, slide in zip(robot.joints(), case["slides"])}


def description(robot, case):
    """The text of recording.toml."""
    lines = ['mechanism   = "robot.xml"', f'description = "{robot.description}"', "", "[parameters]"]
    for name, share in robot.tolerances.items():
        std = f'{{ std = {share}, unit = "m" }}' if name == "com" else f'{{ std = "{100 * share:.0f} %" }}'
        lines.append(f'"*.{name}" = {std}')
    lines += ["", "[channels]"]
    for index, (joint, (unit, factor)) in enumerate(units(robot, case).items()):
        stated = case["stated_factor"] * factor
        lines.append(f'{joint}_pos = {{ measures = "{joint}", unit = "{unit}", noise_std = {stated * case["sd"][index]:.3g} }}')
        if case["velocity"]:
            lines.append(f'{joint}_vel = {{ measures = "{joint}.velocity", unit = "{unit}/s", noise_std = {stated * case["sd_v"][index]:.3g} }}')
        if case["torque"]:
            newton = "N" if unit == "m" else "N*m"
            lines.append(f'{joint}_eff = {{ measures = "{joint}.torque", unit = "{newton}", noise_std = {case["sd_t"][index]:.3g} }}')
    for name, joint in robot.drives().items():
        unit = "N*m" if robot.torques else units(robot, case)[joint][0]
        lines.append(f'{name} = {{ input = "{name}", unit = "{unit}" }}')
    lines += ["", "[runs]", 'fit  = ["run1.csv", "run2.csv", "run3.csv"]', 'test = ["run4.csv", "run5.csv"]']
    return "\n".join(lines) + "\n"


def columns(robot, case, run):
    """Name -> texts of a column of a recording."""
    found = {"t": [f"{time:.6g}" for time in run.times]}
    for index, (joint, (_, factor)) in enumerate(units(robot, case).items()):
        found[f"{joint}_pos"] = [f"{value:.7g}" for value in factor * run.readings[:, index]]
        if case["velocity"]:
            found[f"{joint}_vel"] = [f"{value:.5g}" for value in factor * run.rates[:, index]]
        if case["torque"]:
            found[f"{joint}_eff"] = [f"{value:.5g}" for value in run.torques[:, index]]
    for index, (name, joint) in enumerate(robot.drives().items()):
        factor = 1.0 if robot.torques else units(robot, case)[joint][1]
        found[name] = [f"{value:.7g}" for value in factor * run.u[:, index]]
    return found


def write(folder, robot, case, runs, rng):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.xml").write_text(f"<!-- {robot.description} -->\n" + written(robot.root))
    (folder / "recording.toml").write_text(description(robot, case))
    for name, run in runs.items():
        table = columns(robot, case, run)
        if case["dropouts"]:
            for column in [c for c in table if c.endswith(("_pos", "_vel", "_eff"))]:
                for row in rng.choice(len(run.times), len(run.times) // 60, replace=False):
                    table[column][row] = ""
        with open(folder / name, "w", newline="") as file:
            lines = csv.writer(file, lineterminator="\n")
            lines.writerow(table)
            lines.writerows(zip(*table.values()))


def starts(run, case):
    """True states at rows about half a second apart, and those from which added joints settle."""
    every = round(0.5 * case["rate"])
    rows = list(range(every, len(run.times) - every - 2, every))
    before = [rollouts.earlier(run.times, row) for row in rows]
    earlier = np.stack([run.true_q[before], run.true_v[before]], axis=1).round(7).tolist()
    return {"rows": rows, "q": np.round(run.true_q[rows], 7).tolist(), "v": np.round(run.true_v[rows], 6).tolist(), "earlier": earlier}


def named(found):
    """The effects as a report says them: what no kind describes is unknown."""
    if any(not effect.named for effect, _, _ in found):
        return ["unknown"]
    return [effect.name for effect, _, _ in found]


def label(robot, case, runs, found, base, truth, group, null_kind, offsets):
    effects, kind = named(found), "null" if null_kind else "compound" if len(found) > 1 else "single"
    sited = [effect.name.split("@")[1] for effect, _, _ in found]
    listed = {name: [f"{joint}_{end}" for joint in robot.joints()] for name, end in (("q", "pos"), ("v", "vel"), ("tau", "eff"))}
    recorded = {"q": True, "v": case["velocity"], "tau": case["torque"]}
    return {
        "robot": robot.name, "kind": kind, "null_kind": null_kind, "group": group, "effects": effects,
        "place": sited if effects != ["unknown"] else [], "accept": [effect.accept for effect, _, _ in found if effect.accept],
        "laws": [effect.name for effect, _, _ in found],
        "magnitude": [{"effect": effect.name, "value": float(size), "unit": effect.unit} for effect, size, _ in found],
        "mjcf": all(effect.mjcf for effect, _, _ in found),
        "written": [place for effect, _, _ in found for place in effect.written],
        "not_in_mjcf": [effect.name for effect, _, _ in found if not effect.mjcf],
        "dprime": max([moved for _, _, moved in found], default=0.0), "dprime_each": [moved for _, _, moved in found],
        "base_xml": written(base.root), "true_xml": written(truth.root), "tolerance_z": offsets,
        "joints": robot.joints(), "actuators": list(robot.drives()),
        "columns": {name: listed[name] if recorded[name] else None for name in listed} | {"u": list(robot.drives())},
        "degrees": case["degrees"], "sd": case["sd"].tolist(), "sd_v": case["sd_v"].tolist() if case["velocity"] else None,
        "quantum": case["quantum"].tolist(), "stated_factor": case["stated_factor"], "noise_stated": True, "rate": case["rate"],
        "irregular": case["irregular"], "dropouts": case["dropouts"],
        "starts": {name: starts(run, case) for name, run in runs.items() if name in ("run4.csv", "run5.csv")},
    }
