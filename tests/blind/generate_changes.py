"""Makes the pairs of `changes.py` and their labels from a seed.

    generate_changes.py --out FOLDER [--only NAME …]
    generate_changes.py --out FOLDER [--only NAME …] --twins
    generate_changes.py --out FOLDER --pack

Writes FOLDER/changes/NAME/before and /now, and FOLDER/changes.json. The second line adds to the labels what
the recordings, before and now, hardly tell from the change. With --pack both go beside this file. `dprime`
is that of other cases. `dprime_told` is what the recordings before tell as well: these know parameters far
better than their tolerances do. Both, and twins, are of the change alone."""

import argparse
import json
import shutil
import time
from dataclasses import replace
from pathlib import Path

import generate  # first: it sets the number of threads

import catalogue
import twins
from changes import PAIRS
from effects import Rig
from plan import Case

FIRST = 1000  # number of the first pair; those of `generate.py` begin with zero
RUNS = {"before": range(3), "now": range(3, 3 + generate.RUNS)}


def sized(place, rung):
    """The effect of a rung of d' alone, its label, and the d' that it reaches."""
    (kind, site), level = rung[0].split("@"), rung[1]
    alone = replace(place, case=replace(place.case, kind="single", effects=((kind, site, "library"),), level=level))
    sizes, reached = generate.sized(alone)
    rig = alone.rig(sizes)
    return rig, generate.magnitude(alone, rig)[0], reached[0]


def merged(before, change):
    """Effects of now: one that was there before has grown."""
    if before and change and before[0].name == change[0].name:
        return [replace(before[0], size=before[0].size + change[0].size)]
    return before + change


def accepted(mechanism, pair):
    """Right answers. What was there before is a parameter of the model by now."""
    name = pair.change[0]
    patterns = catalogue.accept(mechanism, *name.split("@"), "library")
    if pair.before and pair.before[0] == name:
        patterns.append(f"parameter_error@{name.replace('@', '_')}_[^@]*")
    return [patterns]


class Made:
    """A pair: the rig before, the rig now, and the change alone."""

    def __init__(self, number):
        self.pair = pair = PAIRS[number]
        case = Case(pair.mechanism, "null", null_kind="unchanged", **dict.fromkeys(pair.more, True))
        self.place = generate.world(FIRST + number, case)
        nothing = (None, None, 0.0)
        had, self.before, _ = sized(self.place, pair.before) if pair.before else nothing
        self.changed, self.change, self.reached = sized(self.place, pair.change) if pair.change else nothing
        own, new = had.effects if had else [], self.changed.effects if self.changed else []
        self.rigs = {"before": self.rig(own), "now": self.rig(merged(own, new))}

    def rig(self, effects):
        return Rig(self.place.mechanism, dict(self.place.true), effects)

    def accept(self):
        return accepted(self.place.mechanism, self.pair) if self.pair.change else []

    def write(self, folder):
        for part, rig in self.rigs.items():
            own = folder / part
            own.mkdir(parents=True, exist_ok=True)
            for count, run in enumerate(RUNS[part], start=1):
                one = generate.trial(self.place, rig, run)
                measured = generate.recorded(self.place, rig, one, run)
                generate.write_run(own / f"run{count}.csv", self.place, one, measured)
            generate.write_recording(own, self.place, 1.0, len(RUNS[part]))

    def alone(self):
        """The change alone: its rig, the runs of now to fit, and those before."""
        now = [generate.trial(self.place, self.changed, run) for run in RUNS["now"][: generate.FIT_RUNS]]
        before = [generate.trial(self.place, self.rig([]), run) for run in RUNS["before"]]
        return self.place, self.changed, now, before

    def label(self):
        return {
            "mechanism": self.pair.mechanism,
            "kind": "single" if self.pair.change else "null",
            "effects": [self.change["effect"]] if self.change else [],
            "before": [self.before["effect"]] if self.before else [],
            "accept": self.accept(),
            "level": self.pair.change and self.pair.change[1],
            "level_before": self.pair.before and self.pair.before[1],
            "magnitude": [self.change] if self.change else [],
            "magnitude_before": [self.before] if self.before else [],
            "dprime": self.reached,
        }

    def told(self):
        """What the recordings before and now tell of the change."""
        if not self.change:
            return {}
        place, rig, now, before = self.alone()
        return {
            "dprime_told": twins.recordings_of(place, rig, now, before).size,
            "twins": twins.twins_of(place, rig, now, self.accept(), before),
        }


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("--out", type=Path, required=True)
    ask.add_argument("--only", nargs="*")
    ask.add_argument("--twins", action="store_true")
    ask.add_argument("--pack", action="store_true")
    ask = ask.parse_args()
    path = ask.out / "changes.json"
    labels = json.loads(path.read_text())["cases"] if path.exists() else {}
    for number in range(0 if ask.pack else len(PAIRS)):
        name = f"pair_{number + 1:02d}"
        if ask.only and name not in ask.only:
            continue
        began = time.time()
        made = Made(number)
        if ask.twins:
            label = labels[name]
            label.update(made.told())
        else:
            made.write(ask.out / "changes" / name)
            label = labels[name] = made.label()
        print(
            f"{name} {label['mechanism']:15} {'+'.join(label['before']):26} {'+'.join(label['effects']):26}"
            f" d' {label['dprime']:6.1f}  {next(iter(label.get('twins', {}).items()), '')}  {time.time() - began:.0f} s",
            flush=True,
        )
        generate.write_labels(path, labels)
    if ask.pack:
        generate.archive(ask.out, "changes/*/*/*", "changes")
        shutil.copy(path, generate.HERE / "changes.json")


if __name__ == "__main__":
    main()
