"""From evidence to probabilities that hold: finds the four numbers of gap/diagnosis/src/diagnose/calibration.rs.

    calibrate.py --collect REPORTS --labels LABELS   takes from reports what is needed: calibration.json
    calibrate.py                                     finds the numbers, tells how well claims hold
    calibrate.py --across [--write PAGE]             the same by cross-validation: what is said of a kind of
                                                     law is said with numbers found without that kind
    calibrate.py --check                             fails where the tool has other numbers, or the data
                                                     are of another engine

REPORTS has a subfolder `appell` of reports with the whole library, and `left_out` of reports with a
library that lacks the effect; --collect replaces the rows of that set of cases. The numbers make the true answers most probable. Cases whose cause is not
in the library count so much that they are a tenth of all gaps."""

import argparse
import json
import math
import random
import re
from pathlib import Path

from score import is_truth, rate, write

HERE = Path(__file__).resolve().parent
DATA = HERE / "calibration.json"
TOOL = HERE / "../../gap/diagnosis/src/diagnose/calibration.rs"
ENGINE = HERE / "../../gap/diagnosis/src/diagnose.rs"
NAMES = ["TEMPERATURE", "MIMICKED", "INEXACT", "LEFT"]
RANGES = {"TEMPERATURE": (1.0, 4.0), "MIMICKED": (0.02, 0.9), "INEXACT": (0.02, 0.9), "LEFT": (0.02, 0.5)}
MARKS = "<!-- calibration of tests/blind: begin -->", "<!-- calibration of tests/blind: end -->"
LEAST = 1e-3  # one answer that is wrong for certain must not outweigh all others
MOST = 300.0
UNKNOWN = ["unknown"]


def constants():
    """The numbers of the tool."""
    found = re.findall(r"const (\w+): f64 = ([\d.]+);", TOOL.read_text())
    return {name: float(value) for name, value in found}


def engine():
    """The version of the engine."""
    return int(re.search(r"const ENGINE: u32 = (\d+);", ENGINE.read_text())[1])


# What is needed of a report.


def label_kinds(label):
    """Kinds of law that a case is of."""
    if label["kind"] in ("single", "compound", "mismatch"):
        return sorted({effect.split("@")[0] for effect in label["effects"]})
    return [label["kind"] if label["kind"] == "null" else str(label.get("off_kind") or label["effects"])]


def row(case, report, label, left_out, temperature):
    """Case and engine; log odds against the best hypothesis and number of members of each, with whether it is true."""
    listed = [h for h in report["which"] if h["effects"] != UNKNOWN]
    best = max(h["probability"] for h in listed)
    if not best:  # beside certainty that it is none of them the first one is left
        listed, best = [{**listed[0], "probability": 1.0}], 1.0
    odds = lambda h: max(temperature * math.log(max(h["probability"], 1e-300) / best), -50.0)
    true = lambda h: not left_out and is_truth(sorted(h["effects"]), label)
    left, independent = report.get("left"), report.get("independent", 1.0)
    return {
        "case": case,
        "kinds": label_kinds(label),
        "engine": report.get("engine"),
        "listed": [[round(odds(h), 3), len(h["effects"]), true(h)] for h in listed if odds(h) > -40],
        "left": left
        and [round(independent * left["log_bayes_factor"], 3), round(left["gain"], 3), round(left["explained"], 3)],
        "unlisted": left_out or label["kind"] == "off_library",
        "left_out": left_out,
    }


def collect(reports, labels, cases):
    """Rows of the reports on a set of cases."""
    temperature = constants()["TEMPERATURE"]
    rows = []
    for folder in ("appell", "left_out"):
        for name, label in sorted(labels.items()):
            path = reports / folder / f"{name}.json"
            if not path.exists() or folder == "left_out" and label["kind"] not in ("single", "mismatch"):
                continue
            report = json.loads(path.read_text())
            if report.get("which"):
                rows.append(row(f"{cases}/{name}", report, label, folder == "left_out", temperature))
    return rows


# The probabilities, as in calibration.rs.


def probabilities(row, numbers):
    """Those of the listed hypotheses, and of none of them."""
    weights = [math.exp(odds / numbers["TEMPERATURE"]) for odds, _, _ in row["listed"]]
    listed = [weight / sum(weights) for weight in weights]
    best = max(range(len(listed)), key=listed.__getitem__)
    members = row["listed"][best][1]
    log, gain, explained = row["left"] or (-math.inf, 0.0, 1.0)
    factor = math.exp(min(log, MOST))
    unlisted = numbers["UNLISTED"]
    if members:
        size = math.sqrt(gain / max(gain + max(explained, 0.0), 1e-300)) / numbers["LEFT"]
        density = 2 / (math.sqrt(math.tau) * numbers["LEFT"]) * math.exp(-0.5 * size * size)
        mimicked, inexact = numbers["MIMICKED"], numbers["INEXACT"]
        odds = unlisted / (1 - unlisted) * (mimicked + (1 - mimicked) * factor)
        odds /= 1 + inexact * density * factor
    else:
        odds = unlisted * factor
    weight = odds * sum(p for p, (_, own, _) in zip(listed, row["listed"]) if own == members)
    unknown = weight / (1 + weight)
    return [p * (1 - unknown) for p in listed], unknown


def claim(row, numbers):
    """The first answer's probability, and whether it is true."""
    listed, unknown = probabilities(row, numbers)
    if unknown >= max(listed):
        return unknown, row["unlisted"]
    best = max(range(len(listed)), key=listed.__getitem__)
    return listed[best], row["listed"][best][2]


def surprise(rows, numbers):
    """The mean of the negative logarithm of the true answer's probability."""
    alike = sum(row["unlisted"] for row in rows)
    weight = numbers["UNLISTED"] / (1 - numbers["UNLISTED"]) * (len(rows) - alike) / max(alike, 1)
    total, weights = 0.0, 0.0
    for row in rows:
        listed, unknown = probabilities(row, numbers)
        true = sum(p for p, (_, _, is_true) in zip(listed, row["listed"]) if is_true)
        own = weight if row["unlisted"] else 1.0
        total -= own * math.log(max(unknown if row["unlisted"] else true, LEAST))
        weights += own
    return total / weights


def found(rows, numbers, grids=(8, 16, 32, 64), rounds=4):
    """The numbers that surprise least, by turns along each on finer and finer grids."""
    numbers = dict(numbers)
    for parts in grids:
        for _ in range(rounds):
            for name in NAMES:
                low, high = RANGES[name]
                grid = [low * (high / low) ** (i / parts) for i in range(parts + 1)]
                numbers[name] = min(grid, key=lambda value: surprise(rows, {**numbers, name: value}))
    return numbers


def across(rows, numbers):
    """Claims about each kind of law with numbers that were found without that kind."""
    claims = {}
    for kinds in sorted({tuple(row["kinds"]) for row in rows}):
        others = [row for row in rows if not set(row["kinds"]) & set(kinds)]
        own = found(others, numbers, grids=(32,), rounds=2)
        for row in rows:
            if tuple(row["kinds"]) == kinds and not row["left_out"]:
                claims[row["case"]] = claim(row, own)
    return claims


def calibration_error(claims):
    """Expected difference between what is claimed and what is right, in ten parts of the probability."""
    error = 0.0
    for part in range(10):
        own = [(p, right) for p, right in claims if part == min(int(10 * p), 9)]
        error += abs(sum(p for p, _ in own) - sum(right for _, right in own)) / len(claims)
    return error


def chance(claims, draws=2000):
    """The median of that error where every claim is as probable as it says: cases are few."""
    draw = random.Random(1).random
    errors = sorted(calibration_error([(p, draw() < p) for p, _ in claims]) for _ in range(draws))
    return errors[draws // 2]


def table_across(rows, now, best):
    """The error of calibration of each set of cases: with the numbers of the tool, with those found on all, and
    across kinds of law."""
    said = across(rows, best)
    engines = ", ".join(sorted({str(row["engine"]) for row in rows}))
    whole = [row for row in rows if not row["left_out"]]
    yield (
        "Mean difference between the stated probability of the first answer and its frequency, in ten equal "
        f"bins (engine {engines}, one-step evidence): with the constants of the tool, with those found on all "
        "cases, and with those found without the kind of law that is judged. By chance: its median if "
        "every claim were exact. Development scores."
    )
    yield "\n| cases | number | tool | found on all | across kinds | by chance |\n|---|---|---|---|---|---|"
    for cases in sorted({row["case"].split("/")[0] for row in whole}):
        own = [row for row in whole if row["case"].startswith(f"{cases}/")]
        claims = [claim(row, now) for row in own]
        errors = [
            calibration_error(claims),
            calibration_error([claim(row, best) for row in own]),
            calibration_error([said[row["case"]] for row in own]),
            chance(claims),
        ]
        yield f"| {cases} | {len(own)} | " + " | ".join(f"{error:.3f}" for error in errors) + " |"


def reliability(rows, numbers):
    claims = [claim(row, numbers) for row in rows if not row["left_out"]]
    for low, high in ((0.0, 0.8), (0.8, 0.9), (0.9, 0.95), (0.95, 1.01)):
        own = [(p, right) for p, right in claims if low <= p < high]
        if own:
            mean = sum(p for p, _ in own) / len(own)
            yield f"| {low} to {min(high, 1)} | {mean:.2f} | {rate([right for _, right in own])} |"


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("--collect", type=Path, help="folder of reports")
    ask.add_argument("--labels", type=Path, default=HERE / "labels.json")
    ask.add_argument("--data", type=Path, default=DATA)
    ask.add_argument("--across", action="store_true")
    ask.add_argument("--write", type=Path, help="Markdown file with markers")
    ask.add_argument("--check", action="store_true")
    ask = ask.parse_args()
    if ask.collect:
        labels = json.loads(ask.labels.read_text())
        cases = ask.labels.resolve().parent.name
        kept = [row for row in json.loads(ask.data.read_text()) if not row["case"].startswith(f"{cases}/")]
        rows = kept + collect(ask.collect, labels.get("cases", labels), cases)
        ask.data.write_text("[\n" + ",\n".join(map(json.dumps, rows)) + "\n]\n")
        return
    rows, now = json.loads(ask.data.read_text()), constants()
    best = found(rows, now)
    for name in NAMES:
        print(f"{name}: {best[name]:.2f}, in the tool {now[name]}")
    print(f"surprise: {surprise(rows, best):.3f}, with the numbers of the tool {surprise(rows, now):.3f}")
    print("| claimed | mean | right |\n|---|---|---|")
    print("\n".join(reliability(rows, now)))
    if ask.across:
        table = "\n".join(table_across(rows, now, best))
        print(table)
        if ask.write:
            write(ask.write, table, MARKS)
    stale = [row for row in rows if row.get("engine") != engine()]
    if stale:
        cases = sorted({row.get("case", "no case") for row in stale})
        some = ", ".join(cases[:5])
        print(f"{len(stale)} of {len(rows)} rows are not of engine {engine()}: {some}, ...")
    if ask.check and stale:
        raise SystemExit("the data are stale: diagnose the cases anew, then --collect")
    if ask.check and surprise(rows, now) > surprise(rows, best) + 0.02:
        raise SystemExit("the numbers of the tool are not those of the data")


if __name__ == "__main__":
    main()
