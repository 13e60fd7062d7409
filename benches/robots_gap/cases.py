"""Cases of robots: descriptions, recordings and labels."""

import csv
import json
import math
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

# Units of angles in radians.
ANGLES = {"rad": 1.0, "deg": math.pi / 180, "rad/s": 1.0, "deg/s": math.pi / 180}


@dataclass
class Case:
    """A robot file with its recordings, and what is known of the truth."""

    name: str
    folder: Path
    description: dict
    label: dict

    @property
    def robot(self):
        return self.folder / self.description["mechanism"]

    @property
    def runs(self):
        return self.description["runs"]

    def measured(self, of=""):
        """Joint -> (column, factor to SI, standard deviation of the noise) of positions, or of ".velocity" or ".torque"."""
        found = {}
        for column, channel in self.description["channels"].items():
            joint, dot, quantity = channel.get("measures", "").partition(".")
            if joint and dot + quantity == of:
                factor = ANGLES.get(channel.get("unit"), 1.0)
                noise = channel.get("noise_std")
                found[joint] = (column, factor, noise * factor if noise else None)
        return found

    def inputs(self):
        """Actuator -> (column, factor)."""
        channels = self.description["channels"].items()
        return {c["input"]: (column, ANGLES.get(c.get("unit"), 1.0)) for column, c in channels if "input" in c}

    def table(self, run):
        """The columns of a run; what is missing is NaN."""
        with open(self.folder / run, newline="") as file:
            rows = list(csv.reader(file))
        numbers = [[float(cell) if cell else math.nan for cell in row] for row in rows[1:]]
        return {name: [row[i] for row in numbers] for i, name in enumerate(rows[0])}


def described(folder, label=None):
    """A case from its folder."""
    return Case(folder.name, folder, tomllib.loads((folder / "recording.toml").read_text()), label or {})


def cases(folder, names=()):
    """The labelled cases of a folder that has `cases/` and `LABELS.json`."""
    labels = json.loads((folder / "LABELS.json").read_text())["cases"]
    ordered = sorted(labels, key=lambda name: [int(t) if t.isdigit() else t for t in re.split(r"(\d+)", name)])
    for name in ordered:
        if names and name not in names:
            continue
        yield described(folder / "cases" / name, labels[name])
