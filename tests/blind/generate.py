"""Makes the cases and their labels from a seed.

    generate.py --out FOLDER [--only NAME …] [--pack]

Writes FOLDER/cases (for `appell diagnose`) and FOLDER/labels.json (for the scorer alone). With --pack
both go beside this file, the cases as one archive."""

import argparse
import json
import lzma
import os
import shutil
import tarfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")  # matrices are small

import numpy as np

import catalogue
import drive
import mechanisms
import oracle
import rigid
import simulate
from effects import Rig, Sensor
from plan import CASES

HERE = Path(__file__).resolve().parent
SEED = 61803
RUNS = 5
FIT_RUNS = 3
RATE_HZ = 100
ROUNDS = 5  # of the search for a size


@dataclass
class World:
    """A rig as it is, before it is driven."""

    case: object
    mechanism: object
    declared: dict
    true: dict
    noise: np.ndarray
    disturbance_sd: np.ndarray
    seed: tuple
    peak: float = 1.0

    def rig(self, sizes):
        rng = np.random.default_rng((*self.seed, 77))
        effects = [
            catalogue.make(self.mechanism, self.true, kind, site, size, law, self.peak, rng)
            for (kind, site, law), size in zip(self.case.effects, sizes)
        ]
        return Rig(self.mechanism, dict(self.true), effects)


def rounded(value, digits=4):
    return float(f"{value:.{digits}g}")


def world(number, case):
    seed = (SEED, number)
    rng = np.random.default_rng(seed)
    mechanism = mechanisms.ALL[case.mechanism]
    about = catalogue.RIGS[case.mechanism]
    declared = {
        name: (
            value
            if name in catalogue.FIXED
            else rounded(value * np.exp(rng.normal(0, 0.12 if value < 50 else 0.05)))
        )
        for name, value in about["parameters"].items()
    }
    exact = case.null_kind == "clean"
    true = {
        name: value + (0.0 if exact else rng.normal(0, catalogue.tolerance(name, value)))
        for name, value in declared.items()
    }
    noise = np.array(list(about["noise"].values())) * np.exp(rng.normal(0, 0.3))
    level = 0.1 if case.null_kind == "disturbance" else np.exp(rng.uniform(np.log(0.002), np.log(0.03)))
    disturbance_sd = level * np.array(catalogue.forces(case.mechanism, declared))
    return World(case, mechanism, declared, true, noise, disturbance_sd, seed)


def times_of(case, rng):
    n = int(rng.uniform(8.0, 10.5) * RATE_HZ) if case.mechanism != "rolling_wheel" else 500
    if "slip" in str(case.effects):
        n = 600
    steps = np.full(n, 1.0 / RATE_HZ)
    if case.irregular:
        steps = np.round(steps * rng.uniform(0.75, 1.25, n), 4)
    return np.round(np.concatenate([[0.0], np.cumsum(steps)]), 4)


def disturbances(world, n, rng):
    """Random forces held over each sample; coloured ones fade within 50 ms and keep their intensity."""
    white = rng.normal(0, 1, (n, len(world.disturbance_sd))) * world.disturbance_sd
    if not world.case.colour:
        return white
    keep, coloured = np.exp(-1 / (RATE_HZ * 0.05)), np.zeros_like(white)
    for k in range(1, n):
        coloured[k] = keep * coloured[k - 1] + (1 - keep) * white[k]
    return coloured


def trial(world, rig, run):
    rng = np.random.default_rng((*world.seed, run))
    t = times_of(world.case, rng)
    start, law = drive.for_run(world.mechanism, world.declared, rng, t[-1], world.noise, run)
    run_one = rigid.run if world.case.simulator == "mujoco" else simulate.run
    return run_one(rig, law, t, start, disturbances(world, len(t), rng))


def tolerances(world):
    stds = {name: catalogue.tolerance(name, value) for name, value in world.declared.items()}
    return {name: std for name, std in stds.items() if std}


def dprime(world, rig, trials):
    parts = [
        oracle.signatures(rig, one, tolerances(world), world.noise, world.disturbance_sd) for one in trials
    ]
    return oracle.dprime(parts)


def sized(world):
    """Sizes that make the rung of each effect alone, found on the first run; d' of each."""
    case = world.case
    if case.kind == "null":
        return [], []
    if world.mechanism.inputs:
        bare = replace(world, case=replace(case, effects=()))
        commands = trial(bare, bare.rig([]), 0).commands
        site = case.effects[0][1]
        column = world.mechanism.inputs.index(site) if site in world.mechanism.inputs else 0
        world.peak = float(np.max(np.abs(commands[:, column])))
    if case.level == "field":
        return [case.size] * len(case.effects), []
    sizes, each = [], []
    for effect in case.effects:
        alone = replace(world, case=replace(case, effects=(effect,)))
        size, reached = 1.0, case.level
        for _ in range(ROUNDS):
            size *= float(np.clip(case.level / max(reached, 1e-9), 0.02, 30))
            rig = alone.rig([size])
            reached = dprime(alone, rig, [trial(alone, rig, 0)]) * np.sqrt(FIT_RUNS)
            if abs(reached / case.level - 1) < 0.05:
                break
        sizes.append(size)
        each.append(reached)
    return sizes, each


def recorded(world, rig, one, run):
    """What the sensors show, with noise; a copy without rounding."""
    rng = np.random.default_rng((*world.seed, run, 5))
    n = len(world.noise)
    shown = one.states[:, :n].copy()
    rates = mechanisms.times(world.mechanism.kinematics(world.true, shown), one.states[:, n:])
    for sensor in rig.of(Sensor):
        i = world.mechanism.coordinates.index(sensor.site)
        shown[:, i] = sensor.shown(one.t, shown[:, i], rates[:, i])
    measured = shown + rng.normal(0, world.noise, shown.shape)
    if world.case.dropouts:
        measured[rng.random(shown.shape) < 0.01] = np.nan
        gap = int(rng.integers(100, len(measured) - 100))
        measured[gap : gap + 15, rng.integers(n)] = np.nan
    return measured


def resolution(noise):
    """Step of the sensor and its decimals: 1, 2 or 5 of some decimal, at most half of the noise."""
    decade = int(np.floor(np.log10(noise / 2)))
    lead = max(step for step in (1, 2, 5) if step * 10.0**decade <= noise / 2)
    return lead * 10.0**decade, max(-decade, 0)


def write_run(path, world, one, measured):
    names = list(world.mechanism.coordinates) + list(world.mechanism.inputs)
    sensors = [resolution(noise) for noise in world.noise]
    rows = ["t," + ",".join(names)]
    for t, y, u in zip(one.t, measured, one.commands):
        cells = [
            "" if np.isnan(value) else f"{np.round(value / step) * step:.{digits}f}"
            for value, (step, digits) in zip(y, sensors)
        ]
        rows.append(",".join([f"{t:g}"] + cells + [f"{value:g}" for value in u]))
    path.write_text("\n".join(rows) + "\n")


def write_recording(folder, world, stated, count=RUNS):
    about = catalogue.RIGS[world.case.mechanism]
    lines = [
        f'mechanism   = "{world.case.mechanism}"',
        f'description = "{about["about"]}"',
        "",
        "[parameters]",
    ]
    for name, value in world.declared.items():
        std = rounded(catalogue.tolerance(name, value))
        lines.append(f'{name} = {{ value = {value:g}, unit = "{catalogue.UNITS[name]}", std = {std:g} }}')
    lines += ["", "[channels]"]
    for name, noise in zip(world.mechanism.coordinates, world.noise):
        lines.append(
            f'{name} = {{ measures = "{name}", unit = "{catalogue.UNITS[name]}", noise_std = {stated * noise:.4g} }}'
        )
    for name in world.mechanism.inputs:
        lines.append(f'{name} = {{ input = "{name}", unit = "{catalogue.UNITS[name]}" }}')
    runs = [f'"run{i + 1}.csv"' for i in range(count)]
    lines += [
        "",
        "[runs]",
        f"fit  = [{', '.join(runs[:FIT_RUNS])}]",
        f"test = [{', '.join(runs[FIT_RUNS:])}]",
        "",
    ]
    (folder / "recording.toml").write_text("\n".join(lines))


def magnitude(world, rig):
    out = []
    for effect in rig.effects:
        value, unit = effect.size, "SI"
        if effect.kind == "actuator_saturation":
            value, unit = 1 - effect.size / world.peak, "fraction of the peak clipped"
        elif effect.kind in ("parameter_error", "actuator_gain", "sensor_scale"):
            unit = "relative"
        out.append({"effect": effect.name, "value": float(value), "unit": unit, "law": effect.law})
    return out


def label(world, rig, trials, measured, each, stated):
    case, mechanism = world.case, world.mechanism
    known = case.kind in ("single", "compound", "mismatch")
    total = dprime(world, rig, trials[:FIT_RUNS]) if case.effects else 0.0
    kinds = [(kind, site, law) for kind, site, law in case.effects]
    families = [catalogue.family(kind) for kind, _, _ in kinds]
    far = None
    if case.effects:
        far = oracle.how_far(
            rig,
            world.declared,
            trials[FIT_RUNS:],
            measured[FIT_RUNS:],
            world.noise,
            world.disturbance_sd,
            known,
        )
    equations = [catalogue.equations(mechanism, kind, site) for kind, site, _ in kinds]
    acts = sorted({name for names in equations if names for name in names})
    return {
        "mechanism": mechanism.name,
        "kind": case.kind,
        "null_kind": case.null_kind,
        "level": case.level,
        "effects": [f"{kind}@{site}" for kind, site, _ in kinds] if known else ["unknown"] if kinds else [],
        "accept": [catalogue.accept(mechanism, *kind) for kind in kinds] if known else [],
        "family": (
            None if not kinds else "off_library" if not known else families if len(kinds) > 1 else families[0]
        ),
        "off_kind": f"{kinds[0][0]}@{kinds[0][1]}" if case.kind == "off_library" else None,
        "domains": (
            sorted({d for kind, _, _ in kinds for d in catalogue.domains(kind)})
            if known
            else None if kinds else []
        ),
        "equations": acts or None,
        "magnitude": magnitude(world, rig),
        "law": kinds[0][2] if kinds else "library",
        "dprime": total,
        "dprime_each": each if len(kinds) > 1 else [total] * len(kinds),
        "dprime_data": total if kinds else None,
        "simulator": case.simulator,
        "noise": list(map(float, world.noise)),
        "stated_factor": stated,
        "disturbance_sd": list(map(float, world.disturbance_sd)),
        "disturbance_colour": case.colour,
        "irregular": case.irregular,
        "dropouts": case.dropouts,
        "parameters_true": {name: float(value) for name, value in world.true.items()},
        "oracle": far,
    }


def sized_rig(number):
    """The rig of a case, and d' of each of its effects."""
    place = world(number, CASES[number])
    sizes, each = sized(place)
    return place, place.rig(sizes), each


def make_case(number, name, out):
    place, rig, each = sized_rig(number)
    case = place.case
    trials = [trial(place, rig, run) for run in range(RUNS)]
    measured = [recorded(place, rig, one, run) for run, one in enumerate(trials)]
    stated = {"noise_x0.5": 0.5, "noise_x2": 2.0}.get(case.null_kind, 1.0)
    folder = out / "cases" / name
    folder.mkdir(parents=True, exist_ok=True)
    for run, one in enumerate(trials):
        write_run(folder / f"run{run + 1}.csv", place, one, measured[run])
    write_recording(folder, place, stated)
    return label(place, rig, trials, measured, each, stated)


def names():
    """Names in an order that tells nothing."""
    order = np.random.default_rng(SEED).permutation(len(CASES))
    return {f"case_{place + 1:03d}": int(number) for place, number in enumerate(order)}


def write_labels(path, labels):
    """One line a case."""
    lines = ",\n".join(f'"{name}": {json.dumps(label)}' for name, label in sorted(labels.items()))
    path.write_text(f'{{"schema": "gap-labels/1", "seed": {SEED}, "cases": {{\n{lines}\n}}}}\n')


def archive(root, pattern, name):
    """Files below a folder as one archive beside this file, with the same bytes each time."""

    def plain(entry):
        entry.uid = entry.gid = entry.mtime = 0
        entry.uname = entry.gname = ""
        entry.mode = 0o755 if entry.isdir() else 0o644
        return entry

    with lzma.open(HERE / f"{name}.tar.xz", "wb", preset=9 | lzma.PRESET_EXTREME) as file:
        with tarfile.open(fileobj=file, mode="w", format=tarfile.USTAR_FORMAT) as packed:
            for path in sorted(root.glob(pattern)):
                packed.add(path, path.relative_to(root), filter=plain)


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("--out", type=Path, required=True)
    ask.add_argument("--only", nargs="*")
    ask.add_argument("--skip-done", action="store_true", help="keep cases that have a label already")
    ask.add_argument("--pack", action="store_true")
    ask = ask.parse_args()
    path = ask.out / "labels.json"
    labels = json.loads(path.read_text())["cases"] if path.exists() else {}
    for name, number in names().items():
        if ask.only and name not in ask.only or ask.skip_done and name in labels:
            continue
        began = time.time()
        labels[name] = make_case(number, name, ask.out)
        l = labels[name]
        closed = (l["oracle"] or {}).get("closed")
        print(
            f"{name} {l['mechanism']:15} {l['kind']:11} {l['null_kind'] or '+'.join(f'{k}@{s}' for k, s, _ in CASES[number].effects):44}"
            f" d' {l['dprime']:7.1f}  closed {closed if closed is None else round(closed, 3)}  {time.time() - began:.0f} s",
            flush=True,
        )
        write_labels(path, labels)
    if ask.pack:
        archive(ask.out, "cases/*/*", "cases")
        shutil.copy(path, HERE / "labels.json")


if __name__ == "__main__":
    main()
