"""Which other effects a recording can hardly tell from the true one.

    twins.py [--only NAME …]

The gap of a case, and what every effect of the library would do along the same true motion, go through
the filter that knows the true levels. Parameters move from their declared values at the price of their
tolerances, and each effect explains as much of the gap as it can. What it leaves, in standard deviations,
is its separation: the true law wins by half of its square in log-likelihood, on average.

Motions are made again from the seed and have to be those of the archive. Separations below CUT go into
labels.json, and pairs below TOLD of which neither effect is below it alone."""

import argparse
import itertools
import json
import os
import re
import tarfile
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")  # matrices are small

import numpy as np
from scipy.optimize import least_squares, lsq_linear

import generate
import oracle
import substitutes

CUT = 10.0  # separations that are kept
TOLD = 3.3  # from which a recording tells two effects apart
HOPELESS = 2.0 * CUT, 0.5  # what leaves more than this, and than this part of the gap, is not fitted
EXPLAINS = 0.98  # part of the gap; what leaves more explains nothing
NOTHING = 1e-3  # signatures below this do nothing
MOVED = 1.0  # standard deviations of a parameter, from which its effect is computed anew
MARGIN = 1e-6  # between sizes to begin with and their bounds


class Recordings:
    """The runs to fit, as the filter that knows the true levels sees them, and what is declared; and runs
    of the rig before it had the effect."""

    def __init__(self, rig, trials, declared, tolerances, noise, disturbance_sd, before=()):
        self.motions = [substitutes.Motion(rig, trial) for trial in trials]
        self.motions += [substitutes.Before(rig, trial) for trial in before]
        self.filters = [oracle.Filter(rig, trial, noise, disturbance_sd) for trial in [*trials, *before]]
        # Parameters are told twice, by the motion and by what is declared of them.
        imitations = self.whitened(lambda motion: motion.imitations(tolerances))
        self.true, self.stds = rig.unchanged, tolerances
        self.parameters = np.concatenate([imitations, -np.eye(len(tolerances))])
        self.basis, _ = np.linalg.qr(self.parameters)
        astray = [(self.true[name] - declared[name]) / std for name, std in tolerances.items()]
        gap = self.whitened(lambda motion: [motion.gap(rig)])[:, 0]
        self.told = np.append(gap, astray)
        self.gap = self.beyond(self.told)
        self.own = np.linalg.norm(self.beyond(np.append(0 * gap, astray)))
        self.size = self.separation(self.gap)

    def whitened(self, errors):
        parts = [oracle.whitened(f, errors(m)) for f, m in zip(self.filters, self.motions)]
        return np.concatenate(parts)

    def beyond(self, told):
        """What the parameters cannot do."""
        return told - self.basis @ (self.basis.T @ told)

    def columns(self, errors):
        columns = self.whitened(errors)
        spare = len(self.basis) - len(columns)
        return np.concatenate([columns, np.zeros((spare, columns.shape[1]))])

    def signatures(self, errors):
        return self.beyond(self.columns(errors))

    def left(self, effects, moves):
        """What substitutes of some sizes leave, with parameters moved by some standard deviations."""
        p = {**self.true}
        for (name, std), move in zip(self.stds.items(), moves):
            p[name] += std * move

        def errors(motion):
            other, alone = motion.moved(p)
            parts = [alone] + [substitute.errors(other, sizes) for substitute, sizes in effects]
            return [tuple(map(sum, zip(*parts)))]

        left = self.told - self.columns(errors)[:, 0]
        left[len(left) - len(moves) :] += moves
        return left

    def separation(self, left):
        """Beyond what the true law leaves: its parameters are not the declared ones either."""
        return float(np.sqrt(max(left @ left - self.own**2, 0.0)))


def factors_of(gap, columns, bounds):
    """By how much columns are scaled to explain a gap best."""
    if not np.all(np.linalg.norm(columns, axis=0) > NOTHING):
        return np.zeros(columns.shape[1])
    axes, parts = np.linalg.qr(columns)
    return lsq_linear(parts, axes.T @ gap, tuple(np.transpose(bounds))).x if len(bounds) else np.zeros(0)


def explained(gap, columns, bounds):
    """What columns explain of a gap, each scaled within its bounds."""
    return columns @ factors_of(gap, columns, bounds)


def room(substitute, sizes):
    """By how much a signature may be scaled so that its effect keeps within its bounds."""
    low, high = substitute.low[0], substitute.high[0]
    if not substitute.scaled:
        return 0.0, 1.0
    if np.isinf(high):
        return low, high
    return tuple(sorted((low / sizes[0], high / sizes[0])))


@dataclass
class Twin:
    """An effect at the sizes and shapes with which it comes closest to the gap."""

    substitute: object
    sizes: np.ndarray
    signature: np.ndarray
    bounds: tuple  # of a factor to its size
    separation: float

    @property
    def name(self):
        return self.substitute.name

    def scaled(self, factor):
        sizes = np.array(self.sizes, dtype=float)
        sizes[: self.substitute.scaled] *= factor
        return self.substitute, sizes


def at(recordings, substitute, sizes, signature):
    bounds = room(substitute, sizes)
    left = recordings.gap - explained(recordings.gap, signature[:, None], [bounds])
    return Twin(substitute, np.array(sizes), signature, bounds, recordings.separation(left))


def closest(recordings, substitute, columns):
    """columns: signatures of the starts."""
    gap, size = recordings.gap, recordings.size
    begun = [at(recordings, substitute, *start) for start in zip(substitute.starts, columns.T)]
    twin = min(begun, key=lambda twin: twin.separation)
    if twin.separation > min(max(HOPELESS[0], HOPELESS[1] * size), EXPLAINS * size):
        return twin
    if not substitute.straight:
        factor = gap @ twin.signature / (twin.signature @ twin.signature)
        twin = at(recordings, substitute, *fitted(recordings, *twin.scaled(factor)))
    return replace(twin, separation=settled(recordings, twin))


def fitted(recordings, substitute, start):
    """The best sizes and shapes near some, and their signature."""
    signature = lambda sizes: recordings.signatures(lambda motion: [substitute.errors(motion, sizes)])[:, 0]
    low, high = np.broadcast_arrays(substitute.low, substitute.high)
    best = fit(lambda sizes: recordings.gap - signature(sizes), start, low, high)
    return best.x, recordings.gap - best.fun


def fit(left, start, low, high):
    margin = MARGIN * np.maximum(1.0, np.abs(start))
    start = np.clip(start, low + margin, high - margin)
    rough = dict(diff_step=1e-5, ftol=1e-3, xtol=1e-3, max_nfev=20)
    return least_squares(left, start, bounds=(low, high), x_scale="jac", **rough)


def settled(recordings, twin=None):
    """The separation with what parameters really do, where they move so far that it is not in proportion;
    of the declared model itself without a twin."""
    effects = []
    if twin is not None:
        effects = [twin.scaled(factors_of(recordings.gap, twin.signature[:, None], [twin.bounds])[0])]
    errors = lambda motion: [substitute.errors(motion, sizes) for substitute, sizes in effects]
    left = recordings.told - (recordings.columns(errors)[:, 0] if effects else 0.0)
    moves = np.linalg.lstsq(recordings.parameters, left)[0]
    if np.max(np.abs(moves), initial=0.0) < MOVED:
        return twin.separation if twin else recordings.size
    spare = len(moves)

    def surprises(fitted):
        own = [(substitute, fitted[:-spare]) for substitute, _ in effects]
        return recordings.left(own, fitted[-spare:])

    free = np.full(spare, np.inf)
    start, low, high = moves, -free, free
    for substitute, sizes in effects:
        start = np.concatenate([sizes, moves])
        low = np.concatenate([substitute.low, low])
        high = np.concatenate([np.broadcast_to(substitute.high, len(sizes)), high])
    left = fit(surprises, start, low, high).fun
    return min(recordings.separation(left), recordings.size)


def compared(recordings, candidates):
    """Each candidate at its best."""
    every = lambda motion: [c.errors(motion, start) for c in candidates for start in c.starts]
    columns = recordings.signatures(every)
    ends = np.cumsum([len(candidate.starts) for candidate in candidates])
    groups = np.split(columns, ends[:-1], axis=1)
    return [closest(recordings, candidate, group) for candidate, group in zip(candidates, groups)]


def together(recordings, first, second):
    """Separation of two effects at once, to first order about the best sizes of each alone."""
    both = np.stack([first.signature, second.signature], axis=1)
    left = recordings.gap - explained(recordings.gap, both, [first.bounds, second.bounds])
    return recordings.separation(left)


def separations(recordings, candidates):
    """Of each name, that of its best variant; of pairs, those that only both together bring below TOLD."""
    twins, alone, pairs = compared(recordings, candidates), {}, {}
    for twin in twins:
        alone[twin.name] = min(alone.get(twin.name, np.inf), twin.separation)
    told = [twin for twin in twins if alone[twin.name] >= TOLD]
    for first, second in itertools.combinations(told, 2):
        left = together(recordings, first, second) if first.name != second.name else np.inf
        if left < TOLD:
            name = "+".join(sorted((first.name, second.name)))
            pairs[name] = min(pairs.get(name, np.inf), left)
    return alone, pairs


def candidates_of(world, trials):
    peaks = np.max([np.max(np.abs(one.commands), axis=0) for one in trials], axis=0, initial=0.0)
    return substitutes.all_of(world.mechanism, world.true, generate.tolerances(world), peaks)


def recordings_of(world, rig, trials, before=()):
    tolerances = generate.tolerances(world)
    return Recordings(rig, trials, world.declared, tolerances, world.noise, world.disturbance_sd, before)


def twins_of(world, rig, trials, accept, before=()):
    """What the label says: effects that explain something of the gap and are no right answers."""
    right = lambda name: any(re.fullmatch(pattern, name) for patterns in accept for pattern in patterns)
    recordings = recordings_of(world, rig, trials, before)
    candidates = [substitutes.since(c) for c in candidates_of(world, trials) if not right(c.name)]
    alone, pairs = separations(recordings, candidates)
    most = min(CUT, EXPLAINS * settled(recordings))
    near = {name: left for name, left in alone.items() if left < most} | pairs
    return {name: round(left, 2) for name, left in sorted(near.items(), key=lambda item: (item[1], item[0]))}


def same_as_archived(name, world, rig, trials, archive):
    with tempfile.TemporaryDirectory() as place:
        for run, one in enumerate(trials):
            path = Path(place) / f"run{run + 1}.csv"
            generate.write_run(path, world, one, generate.recorded(world, rig, one, run))
            if archive.extractfile(f"cases/{name}/{path.name}").read() != path.read_bytes():
                raise SystemExit(f"{name}/{path.name} is not what the archive holds")


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("--only", nargs="*")
    ask = ask.parse_args()
    path = generate.HERE / "labels.json"
    labels = json.loads(path.read_text())["cases"]
    with tarfile.open(generate.HERE / "cases.tar.xz") as archive:
        for name, number in generate.names().items():
            label = labels[name]
            if ask.only and name not in ask.only or label["kind"] not in ("single", "mismatch"):
                continue
            began = time.time()
            world, rig, _ = generate.sized_rig(number)
            trials = [generate.trial(world, rig, run) for run in range(generate.FIT_RUNS)]
            same_as_archived(name, world, rig, trials, archive)
            label["twins"] = twins_of(world, rig, trials, label["accept"])
            nearest = next(iter(label["twins"].items()), "none")
            print(
                f"{name} {'+'.join(label['effects']):28} {nearest}  {time.time() - began:.0f} s", flush=True
            )
            generate.write_labels(path, labels)


if __name__ == "__main__":
    main()
