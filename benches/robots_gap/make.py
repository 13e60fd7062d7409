#!/usr/bin/env python3
"""Makes labelled cases of robots: random files, recordings of robots that differ from them, labels.

    python3 benches/robots_gap/make.py OUT --seed N --cases K --nulls M

OUT gets `cases/NAME/` and `LABELS.json` in the form that run.py reads. A robot differs from its file within the stated
tolerances and by an effect that moves roll-outs of half a second by 3 to 100 times the noise as no numbers within tolerances
do; those of the nulls have none, half of them are pushed by gusts. No run reaches the range of a joint. Each case is made from a seed of its own. Needs numpy and mujoco.
"""

import argparse
import json
import math
from collections import Counter
from pathlib import Path

import mujoco
import numpy as np

import make_effects
import make_files
import make_kinds
import make_laws
import rollouts
from cases import described
from make_robots import KINDS
from make_runs import Recording
from make_sizes import Probe

RUNS = ("run1.csv", "run2.csv", "run3.csv", "run4.csv", "run5.csv")
# Tolerances alone move roll-outs by no more than about so many times the noise.
TOLERABLE = 15.0
# Ends of a joint's range that no run comes near, as a share of it.
NEAR = 0.02
# Effects in turn: one of the library, two, one that no kind describes.
GROUPS = ("single", "single", "pair", "single", "single", "unknown", "single", "single")


def sensors(robot, rng):
    """What is recorded of a robot, and how well."""
    joints = list(robot.root.iter("joint"))
    slides = np.array([joint.get("type") == "slide" for joint in joints if joint.get("name")])
    gauss = np.where(slides, 10 ** rng.uniform(-4.6, -4.1), 10 ** rng.uniform(-3.9, -3.3))
    quantum = gauss * rng.uniform(0.3, 2.0)
    rate = int(rng.choice([100, 125, 200, 250]))
    return {
        "slides": slides, "gauss": gauss, "quantum": quantum, "sd": np.sqrt(gauss**2 + quantum**2 / 12), "sd_v": gauss * rng.uniform(8, 25),
        "rate": rate, "irregular": bool(rng.random() < 0.2), "velocity": bool(rng.random() < 0.5), "torque": bool(rng.random() < 0.3),
        "degrees": bool(rng.random() < 0.3), "dropouts": bool(rng.random() < 0.25), "stated_factor": float(rng.choice([1.0, 1.0, 1.0, 0.5, 2.0])),
        "speed": rng.uniform(10, 16), "gusts": 0.0, "sd_t": 0.0,
    }


def chosen(kind, typical, probe, rng):
    """An effect of a kind with a size that shows, or none."""
    effect = make_kinds.draw(kind, typical, rng)
    if effect is None:
        return None
    found = probe.size(effect, 10 ** rng.uniform(math.log10(6), math.log10(70)))
    return (effect, *found) if found else None


def drawn(group, used, seed, typical, probe, rng):
    """Effects of a group and their kinds: of those that show, the kinds that were used least; none where none shows."""
    choices = {"pair": make_kinds.PAIRS, "unknown": [(kind,) for kind in make_kinds.UNKNOWN]}
    kinds = list(choices.get(group, [(kind,) for kind in make_kinds.SINGLE]))
    order = sorted(kinds, key=lambda choice: (used["+".join(choice)], (kinds.index(choice) - seed) % len(kinds)))
    for choice in 2 * order:
        found = [chosen(kind, typical, probe, rng) for kind in choice]
        if all(found):
            return found, "+".join(choice)
    return None


def gusts(robot, probe_case, typical, size):
    """Random torques that move a robot by about so many times the noise."""
    stiffness = np.array([900.0 if not robot.torques else 33.0] * len(typical.joints)) * typical.inertia
    return size * probe_case["sd"] * stiffness


def noisier(probe, nominal):
    """Raises the noise where tolerances alone would move roll-outs by many times it."""
    moved = np.sqrt(np.mean(((probe.rolled(nominal) - probe.plain) / probe.case["sd"]) ** 2, axis=(0, 1))).max()
    for name in ("gauss", "quantum", "sd", "sd_v"):
        probe.case[name] = probe.case[name] * min(max(moved / TOLERABLE, 1.0), 6.0)


def reaches_range(robot, runs):
    """Whether a joint comes near an end of its range."""
    ranges = {joint.get("name"): joint.get("range") for joint in robot.root.iter("joint") if joint.get("range")}
    for index, joint in enumerate(robot.joints()):
        low, high = (float(word) for word in ranges.get(joint, "-inf inf").split())
        places = np.concatenate([run.true_q[:, index] for run in runs.values()])
        if places.min() < low + NEAR * (high - low) or places.max() > high - NEAR * (high - low):
            return True
    return False


def made(folder, seed, index, group, used, null_kind):
    """Writes one case; returns its label and the robot that was recorded."""
    for attempt in range(20):
        rng = np.random.default_rng([seed, index, attempt])
        found = tried(folder, rng, index, seed, group, used, null_kind)
        if found:
            return found
    raise SystemExit(f"no robot of kind {index % len(KINDS)} shows an effect away from the ends of its joints")


def tried(folder, rng, index, seed, group, used, null_kind):
    """One case, or nothing where no effect shows or a run reaches the range of a joint."""
    robot = KINDS[index % len(KINDS)](rng)
    case = sensors(robot, rng)
    root, offsets, robot.tolerances = make_files.perturbed(robot, rng)
    base = make_effects.Truth(root)
    first = Recording(robot, base, rng, case, "sines", 8.0)
    typical = make_kinds.Typical(robot, base, first)
    case["sd_t"] = 0.02 * typical.torque
    probe = Probe(robot, base, first, case, robot.tolerances["com"])
    noisier(probe, make_effects.Truth(robot.root))
    drawn_effects = ([], "") if null_kind else drawn(group, used, seed, typical, probe, rng)
    if not drawn_effects:
        return None
    found, kinds = drawn_effects
    truth = base
    for effect, size, _ in found:
        truth = truth.with_effect(effect, size)
    if null_kind == "disturbance":
        case["gusts"] = gusts(robot, case, typical, rng.uniform(2, 4))
    seconds = rng.uniform(8, 12 if len(typical.joints) > 4 else 15)
    motions = ["sines", "steps", *rng.choice(["sines", "ramps"], 2), str(rng.choice(["steps", "ramps"]))]
    runs = {name: Recording(robot, truth, rng, case, kind, seconds) for name, kind in zip(RUNS, motions)}
    if reaches_range(robot, runs):
        return None
    make_files.write(folder, robot, case, runs, rng)
    label = make_files.label(robot, case, runs, found, base, truth, group, null_kind, offsets)
    return label | {"drawn": kinds, "excitation": [str(motion) for motion in motions]}, truth


def checked(folder, label, truth):
    """Errors of the nominal file, and of the true one with what it does not say, on the held-out runs."""
    case = described(folder, label)
    model = mujoco.MjModel.from_xml_string(label["true_xml"])
    with make_laws.acting(model, truth.laws):
        true = rollouts.error_of(model, case)
    return rollouts.error(case.robot.read_text(), case), true


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--cases", type=int, default=24)
    parser.add_argument("--nulls", type=int, default=6)
    given = parser.parse_args()
    path = given.out / "LABELS.json"
    labels = json.loads(path.read_text()) if path.exists() else {"schema": "robots-gap-labels/1", "cases": {}}
    names = [f"case_{n + 1}" for n in range(given.cases)] + [f"null_{n + 1}" for n in range(given.nulls)]
    for index, name in enumerate(names):
        null = index >= given.cases
        group = "null" if null else GROUPS[index % len(GROUPS)]
        if name in labels["cases"]:
            continue
        null_kind = (("plain", "disturbance")[index % 2]) if null else None
        used = Counter(labels["cases"][earlier]["drawn"] for earlier in names[:index])
        label, truth = made(given.out / "cases" / name, given.seed, index, group, used, null_kind)
        labels["cases"][name] = label
        nominal, true = checked(given.out / "cases" / name, label, truth)
        path.write_text(json.dumps(labels, indent=1))
        sizes = ", ".join(f"{moved:.0f}" for moved in label["dprime_each"])
        print(f"{name} {label['robot']}: {' + '.join(label['effects']) or 'nothing'} ({sizes}); errors {nominal:.2f}, true {true:.2f}", flush=True)


if __name__ == "__main__":
    main()
