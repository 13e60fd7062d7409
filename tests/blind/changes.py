"""What changed: pairs of recordings of one rig, before and now, and how often `appell diagnose --against`
names what is different. Standard library only; `generate_changes.py` makes the pairs of this plan.

    changes.py --reports FOLDER --tool PATH              diagnoses every pair into FOLDER/pairs, then scores
    changes.py --reports FOLDER --tool PATH --halves …   and halves of recordings of one rig, where nothing
                                                         changed: rigs, or folders of cases with their labels
    changes.py --reports FOLDER                          scores what lies in FOLDER
    changes.py --reports FOLDER --write FILE.md          and writes the table between the markers of FILE.md
"""

import argparse
import json
import re
import sys
import tarfile
import tempfile
from dataclasses import dataclass
from pathlib import Path

import score
from halves import halves

HERE = Path(__file__).resolve().parent
BEGIN, END = "<!-- changes of tests/blind: begin -->", "<!-- changes of tests/blind: end -->"
RIG_LIMIT_S = 600


@dataclass(frozen=True)
class Pair:
    """A rig that has `before` from the beginning, and now `change` besides. Each is an effect and its rung
    of d' alone. The same effect twice has grown."""

    mechanism: str
    change: tuple = None
    before: tuple = None
    more: tuple = ()  # of `plan.Case`


PAIRS = [
    # The model of the rig was right, up to its parameters.
    Pair("carriage", ("parameter_error@m", 15)),  # payload
    Pair("pendulum", ("parameter_error@l", 15)),  # another length
    Pair("cart_pole", ("viscous_friction@theta", 8)),  # worn bearings
    Pair("double_pendulum", ("coulomb_friction@theta2", 15)),
    Pair("euc_2dof", ("rolling_resistance@wheel", 15)),  # another tyre
    Pair("unicycle", ("rolling_resistance@wheel", 8), more=("irregular",)),
    Pair("cart_pole", ("actuator_gain@F", 30)),  # another amplifier
    Pair("carriage", ("actuator_lag@F", 15), more=("dropouts",)),
    Pair("double_pendulum", ("parameter_error@m2", 30)),  # payload
    Pair("double_pendulum", ("sensor_bias@theta2", 8)),  # an encoder that was mounted again
    # The model lacked something already.
    Pair("carriage", ("actuator_gain@F", 15), ("coulomb_friction@x", 25)),
    Pair("pendulum", ("coulomb_friction@theta", 15), ("viscous_friction@theta", 25)),
    Pair("cart_pole", ("mass_offset@pole", 15), ("quadratic_drag@cart", 25)),
    Pair("double_pendulum", ("viscous_friction@theta1", 15), ("viscous_friction@theta1", 25)),
    Pair("carriage", ("coulomb_friction@x", 15), ("coulomb_friction@x", 25), more=("irregular",)),
    Pair("euc_2dof", ("rolling_resistance@wheel", 15), ("actuator_lag@M_d", 25)),
    Pair("unicycle", ("actuator_bias@u", 5), ("viscous_friction@r", 15)),
    Pair("cart_pole", ("spring@x", 15), ("ripple@x", 15)),
    Pair("pendulum", ("actuator_gain@tau", 15), ("cogging@theta", 25)),
    Pair("unicycle", ("viscous_friction@r", 15), ("sensor_bias@theta", 15), more=("dropouts",)),
    # Nothing changed.
    Pair("carriage"),
    Pair("double_pendulum", more=("colour",)),
    Pair("euc_2dof", more=("irregular",)),
    Pair("cart_pole", before=("coulomb_friction@x", 25)),
    Pair("pendulum", before=("hardening@theta", 25)),
    Pair("unicycle", before=("actuator_delay@u", 15)),
]


# Running.


def diagnose_pairs(tool, folder, names):
    with tempfile.TemporaryDirectory() as place:
        with tarfile.open(HERE / "changes.tar.xz") as archive:
            archive.extractall(place, filter="data")
        for name in names:
            pair = Path(place) / "changes" / name
            score.diagnose(tool, pair / "now", folder / f"{name}.json", before=pair / "before")
            print(".", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)


def rigs_of(folder):
    """The rig of a folder, or the cases of a folder in which the model lacks nothing."""
    if (folder / "recording.toml").exists():
        return "rigs", [folder]
    if not (folder / "LABELS.json").exists():
        sys.exit(f"{folder}: neither a recording.toml nor a LABELS.json")
    labels = json.loads((folder / "LABELS.json").read_text())
    labels = labels.get("cases", labels)
    return "nulls", [folder / name for name, label in sorted(labels.items()) if label["kind"] == "null"]


def diagnose_halves(tool, reports, folders):
    for folder in map(Path.absolute, folders):
        group, rigs = rigs_of(folder)
        for rig in rigs:
            with tempfile.TemporaryDirectory() as place:
                before, now = halves(rig, Path(place))
                report = reports / group / f"{rig.parent.name}_{rig.name}.json"
                score.diagnose(tool, now, report, before=before, limit_s=RIG_LIMIT_S)
            print(".", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)


# Scoring.


def read(path):
    """A report with what it says of changes; none where there is no valid one."""
    answer = score.read(path)
    change = json.loads(path.read_text()).get("change") if answer else None
    if not change:
        return None
    answer.is_changed = change["changed"]
    return answer


def names_before(effects, label):
    """Whether an answer names what the rig had before."""
    said = [name for effect in effects for name in (effect, effect.replace("parameter_error@", ""))]
    return any(re.match(re.sub("[@_]", "[@_]", own), name) for own in label["before"] for name in said)


def scores(labels, folder):
    """Rows of (measure, value)."""
    pairs = [(label, read(folder / f"{name}.json")) for name, label in sorted(labels.items())]
    changed = [(l, a) for l, a in pairs if l["kind"] != "null"]
    lacking = [(l, a) for l, a in changed if l["before"]]
    others = [(l, a) for l, a in lacking if l["before"] != l["effects"]]
    nulls = [(l, a) for l, a in pairs if l["kind"] == "null"]
    seen = lambda l, a: a is not None and a.is_changed
    first = lambda l, a: seen(l, a) and score.is_truth(a.sets[0], l)
    near = lambda l, a: first(l, a) or seen(l, a) and score.is_twin(a.sets[0], l)
    tied = lambda l, a: seen(l, a) and any(score.is_truth(member, l) for member in a.tied)
    leading = lambda l, a: first(l, a) or tied(l, a) and len(a.tied) <= score.MOST_TIED
    alone = lambda l, a: first(l, a) and len(a.tied) == 1
    old = lambda l, a: seen(l, a) and names_before(a.sets[0], l)
    over = lambda chosen, f: score.rate([f(l, a) for l, a in chosen])
    return [
        ("a change that is there: noticed", over(changed, seen)),
        ("right change first", over(changed, first)),
        ("… and tied with no other", over(changed, alone)),
        ("right change or its twin first", over(changed, near)),
        ("right change in the leading tie", over(changed, leading)),
        ("right change first where the model lacked something before", over(lacking, first)),
        ("what it lacked before named as the change", over(others, old)),
        ("false alarms where nothing changed", over(nulls, lambda l, a: a is None or a.is_changed)),
        ("no report, or an invalid one", f"{sum(a is None for _, a in pairs)} of {len(pairs)}"),
        ("seconds a pair, median", score.middle([a.seconds for _, a in pairs if a], 1)),
    ]


def alarms(folder):
    """Rows about halves of recordings of one rig."""
    rows = []
    for group, text in (("rigs", "real rigs"), ("nulls", "simulated rigs without a gap")):
        answers = [read(path) for path in sorted((folder / group).glob("*.json"))]
        if answers:
            rows.append((f"halves of {text}: alarms", score.rate([a.is_changed for a in answers if a])))
            rows.append((f"halves of {text}: no report", f"{answers.count(None)} of {len(answers)}"))
    return rows


def section(labels, reports):
    changed = [label for label in labels.values() if label["kind"] != "null"]
    lacking = sum(bool(label["before"]) for label in changed)
    text = (
        f"Development scores of engine {score.engines(labels, reports / 'pairs')} on pairs of simulated recordings "
        f"([tests/blind](../tests/blind)), {len(changed)} with one change and {len(labels) - len(changed)} with none. "
        f"In {lacking} of the changed ones the model lacked something before. Intervals of 95 % in brackets."
    )
    rows = scores(labels, reports / "pairs") + alarms(reports)
    return text + "\n\n" + score.table("development score", {"appell": rows})


def misses(labels, folder):
    for name, label in sorted(labels.items()):
        answer = read(folder / f"{name}.json")
        if answer is None:
            print(f"{name} {label['mechanism']:15} no report")
            continue
        right = answer.is_changed and score.is_truth(answer.sets[0], label)
        if answer.is_changed if label["kind"] == "null" else not right:
            truth = "+".join(label["effects"]) or "nothing"
            said = "+".join(answer.sets[0]) or "nothing"
            print(
                f"{name} {label['mechanism']:15} d' {label['dprime']:6.1f}  {truth} (before: {'+'.join(label['before']) or 'nothing'}): "
                f"{'' if answer.is_changed else 'unchanged, '}{said} at {answer.probability:.3f}, {len(answer.tied)} tied"
            )


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("--reports", type=Path, required=True, help="folder of the reports")
    ask.add_argument("--tool", help="binary of appell; without it the reports that are there are scored")
    ask.add_argument("--only", nargs="*", help="names of pairs")
    ask.add_argument("--halves", type=Path, nargs="+", help="rigs whose recordings are split, not the pairs")
    ask.add_argument("--write", type=Path, help="Markdown file with markers")
    ask.add_argument("--misses", action="store_true", help="list pairs whose first answer is not the truth")
    ask = ask.parse_args()
    labels = json.loads((HERE / "changes.json").read_text())["cases"]
    if ask.tool and ask.halves:
        diagnose_halves(ask.tool, ask.reports, ask.halves)
    elif ask.tool:
        diagnose_pairs(ask.tool, ask.reports / "pairs", ask.only or labels)
    text = section(labels, ask.reports)
    print(text)
    if ask.misses:
        misses(labels, ask.reports / "pairs")
    if ask.write:
        score.write(ask.write, text, (BEGIN, END))


if __name__ == "__main__":
    main()
