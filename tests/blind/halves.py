"""Splits the recordings of a rig in two halves, before and now: nothing has changed between them.
Standard library only.

Every second run is one of now. A rig with one run is split in time. Now has a run to fit and one to test
at least; where one run is left for both, its last third is held out."""

import csv
import re
import shutil
import tomllib
from pathlib import Path

PAUSE = 0.02  # part of a run that is left out where it is cut
HELD_OUT = 1 / 3


def cut(rows, at):
    """The rows before and after a part of a run, apart from each other."""
    first, second = int(len(rows) * (at - PAUSE / 2)), int(len(rows) * (at + PAUSE / 2))
    return rows[:first], rows[second:]


def halves(rig, folder):
    """Folders of the halves, with all that lies beside the recordings."""
    text = (rig / "recording.toml").read_text()
    runs = tomllib.loads(text)["runs"]
    names = [name for part in ("fit", "test") for name in runs.get(part, [])]
    recorded = {}
    for name in names:
        with open(rig / name, newline="") as file:
            header, *rows = csv.reader(file)
        recorded[name] = header, rows
    split = {"before": {}, "now": {}}
    if len(names) == 1:
        header, rows = recorded[names[0]]
        for half, own in zip(split, cut(rows, 0.5)):
            split[half][names[0]] = header, own
    else:
        for place, name in enumerate(names):
            split[["before", "now"][place % 2]][name] = recorded[name]
    for half, own in split.items():
        if half == "now" and len(own) == 1:
            ((name, (header, rows)),) = own.items()
            stem = Path(name).stem
            parts = cut(rows, 1 - HELD_OUT)
            own = {f"{stem}_{part}.csv": (header, rows) for part, rows in zip(("fit", "test"), parts)}
        fit = list(own) if half == "before" else list(own)[: len(own) // 2]
        place = folder / half
        shutil.copytree(rig, place, ignore=shutil.ignore_patterns("*.csv"))
        for name, (header, rows) in own.items():
            with open(place / name, "w", newline="") as file:
                csv.writer(file).writerows([header, *rows])
        listed = f"[runs]\nfit = {fit}\ntest = {list(own)[len(fit) :]}\n\n".replace("'", '"')
        (place / "recording.toml").write_text(re.sub(r"(?ms)^\[runs\].*?(?=^\[|\Z)", listed, text))
    return folder / "before", folder / "now"
