"""Runs `appell diagnose` over the cases and scores what it says. Standard library only.

    score.py --reports FOLDER --tool PATH        diagnoses every case into FOLDER/appell, then scores
    score.py --reports FOLDER --leave-one-out    the same without the effect that is there, in FOLDER/left_out
    score.py --reports FOLDER                    scores what lies in FOLDER, one column per subfolder; the
                                                 baselines' reports come from the archive beside this file
    score.py --reports FOLDER --write FILE.md    and writes the table between the markers of FILE.md

The tool gets a folder that holds one case and nothing else; no label is near it."""

import argparse
import itertools
import json
import math
import random
import re
import shutil
import statistics
import subprocess
import sys
import tarfile
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
BEGIN, END = "<!-- scores of tests/blind: begin -->", "<!-- scores of tests/blind: end -->"
VERDICTS = ("no_gap", "explained", "ambiguous", "unexplained")
LARGE = 7.4  # d' from which an effect should be found
MOST_TIED = 5  # a tie of more says nothing
SURE = 0.95
NAMED = 0.8  # probability at which a wrong name counts, in the leave-one-out check
TOLD = 3.3  # separation, in standard deviations, from which a recording tells two answers apart
TIME_LIMIT_S = 300
DRAWS = 2000  # of the bootstrap

# Sizes whose first reported parameter is the size itself, in the same unit.
SIZED = """viscous_friction coulomb_friction spring rolling_resistance spin_friction quadratic_drag
constant_force ground_slope mass_offset added_inertia actuator_gain actuator_bias actuator_lag actuator_delay
actuator_dead_zone sensor_bias sensor_delay""".split()

DOMAIN = {
    **dict.fromkeys("parameter_error mass_offset added_inertia".split(), "parameter"),
    **dict.fromkeys("lateral_slip longitudinal_slip".split(), "constraint"),
}


def domain_of(effect):
    kind = effect.split("@")[0]
    head = kind.split("_")[0]
    return DOMAIN.get(kind) or (head if head in ("actuator", "sensor") else "force")


# Running.


def unpack(folder):
    with tarfile.open(HERE / "cases.tar.xz") as archive:
        archive.extractall(folder, filter="data")
    return Path(folder) / "cases"


def bundled(folder):
    """Reports of the baselines as committed, where none lie in the folder."""
    archive = HERE / "baselines.tar.xz"
    if archive.exists() and not (folder / "output_error").exists():
        with tarfile.open(archive) as reports:
            reports.extractall(folder, filter="data")


def diagnose(tool, case, report, without=(), before=None, limit_s=TIME_LIMIT_S):
    """One report, and the seconds it took. The tool sees a copy that holds this case alone, and a copy of
    the recordings before."""
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as alone:
        data = Path(alone) / "data"
        shutil.copytree(case, data)
        written = Path(alone) / "report.json"
        command = [tool, "diagnose", "--data", str(data), "--json", str(written)]
        if before:
            command += ["--against", shutil.copytree(before, Path(alone) / "before")]
        for kind in without:
            command += ["--without", kind]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=limit_s)
            trouble = done.stderr.strip() if done.returncode else None
        except subprocess.TimeoutExpired:
            trouble = f"no answer in {limit_s} s"
        answer = {"trouble": trouble} if trouble or not written.exists() else json.loads(written.read_text())
    answer["seconds"] = time.monotonic() - began
    report.parent.mkdir(parents=True, exist_ok=True)
    report.write_text(json.dumps(answer))


def run(tool, folder, wanted, jobs, cases):
    """wanted: name of the case -> kinds to leave out; cases: their folder, else those of the archive."""
    with tempfile.TemporaryDirectory() as place:
        cases = cases or unpack(place)
        with ThreadPoolExecutor(jobs) as workers:
            tasks = {
                workers.submit(diagnose, tool, cases / name, folder / f"{name}.json", without): name
                for name, without in wanted.items()
            }
            for task in tasks:
                task.result()
                print(".", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)


# What a report says.


class Answer:
    """A report that obeys the contract; ValueError otherwise."""

    def __init__(self, report):
        if report.get("verdict") not in VERDICTS:
            raise ValueError("no verdict")
        ranked = sorted(report["which"], key=lambda h: -h["probability"])
        if not 0.9 < sum(h["probability"] for h in ranked) < 1.02:
            raise ValueError("probabilities do not sum to one")
        self.verdict = report["verdict"]
        self.sets = [sorted(h["effects"]) for h in ranked]
        self.probability = ranked[0]["probability"]
        self.parameters = ranked[0].get("parameters") or []
        self.domain = report.get("where", {}).get("domain", "none")
        self.equations = [
            e["name"] for e in sorted(report.get("where", {}).get("equations", []), key=lambda e: -e["share"])
        ]
        self.far = report.get("how_far") or {}
        self.seconds = report.get("seconds")
        self.engine = report.get("engine")
        groups = [
            [sorted(member.split("+")) if isinstance(member, str) else sorted(member) for member in g]
            for g in report.get("tied", [])
        ]
        self.tied = next((g for g in groups if self.sets[0] in g), [self.sets[0]])


def read(path):
    try:
        return Answer(json.loads(path.read_text()))
    except (OSError, ValueError, KeyError, TypeError):
        return None


# Whether it is right.


def is_truth(effects, label):
    """Whether a set of effects is the true one; twins that no recording can tell apart count as well."""
    if label["kind"] == "null":
        return effects == []
    if label["kind"] == "off_library":
        return effects == ["unknown"]
    wanted = label["accept"]
    if len(effects) != len(wanted):
        return False
    fits = lambda effect, patterns: any(re.fullmatch(p, effect) for p in patterns)
    return any(all(map(fits, order, wanted)) for order in itertools.permutations(effects))


def is_twin(effects, label):
    """Whether this recording cannot tell a set of effects from the truth. Pairs are listed where neither
    effect would do alone; sets of more are never listed, and count as told."""
    return label.get("twins", {}).get("+".join(sorted(effects)), math.inf) < TOLD


def has_twin(label):
    """Whether something that is left without the right kinds is a twin."""
    gone = kinds_of(label)
    kinds = lambda name: {effect.split("@")[0] for effect in name.split("+")}
    return any(left < TOLD and not kinds(name) & set(gone) for name, left in label.get("twins", {}).items())


def right_domains(label):
    twins = {domain_of(pattern) for patterns in label["accept"] for pattern in patterns}
    return set(label["domains"] or []) | twins


def covers(answer, label):
    """Whether the interval of the size holds the true one; None where there is no size to compare."""
    true = label["magnitude"][0]
    kind = true["effect"].split("@")[0]
    if (
        label["kind"] != "single"
        or kind not in SIZED
        or answer.sets[0] != [true["effect"]]
        or not answer.parameters
    ):
        return None
    first = answer.parameters[0]
    if not first.get("std"):
        return None
    return abs(abs(first["value"]) - abs(true["value"])) <= 1.96 * first["std"]


def closed(answer, label):
    """Part of the gap that is closed, over what the true law closes; 0 where nothing usable is said."""
    oracle = label["oracle"]
    if not oracle or not oracle["usable"]:
        return None
    far = answer.far if answer else {}
    try:
        same = abs(far["horizon_s"] - 1) < 0.05 and 1 / 3 < far["nominal"] / oracle["nominal"] < 3
        own = 1 - (far["with_effect"] ** 2 - far["noise_floor"] ** 2) / (
            far["nominal"] ** 2 - far["noise_floor"] ** 2
        )
        if not same or abs(own - far["closed"]) > 0.05:
            return 0.0
    except (KeyError, TypeError, ZeroDivisionError):
        return 0.0
    return max(0.0, min(far["closed"] / max(oracle["closed"], 0.05), 1.2))


# Scores with intervals.


def wilson(hits, n):
    if not n:
        return None
    p, z = hits / n, 1.96
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return p, max(0.0, middle - half), min(1.0, middle + half)


def rate(flags):
    flags = [flag for flag in flags if flag is not None]
    found = wilson(sum(map(bool, flags)), len(flags))
    if not found:
        return "–"
    return f"{100 * found[0]:.0f} % [{100 * found[1]:.0f}, {100 * found[2]:.0f}], n = {len(flags)}"


def middle(values, digits=2):
    """Median with the bootstrap's interval."""
    values = [value for value in values if value is not None]
    if not values:
        return "–"
    draw = random.Random(1)
    medians = sorted(statistics.median(draw.choices(values, k=len(values))) for _ in range(DRAWS))
    low, high = medians[int(0.025 * DRAWS)], medians[int(0.975 * DRAWS)]
    return f"{statistics.median(values):.{digits}f} [{low:.{digits}f}, {high:.{digits}f}], n = {len(values)}"


def size_of_ties(pairs):
    sizes = [len(a.tied) for _, a in pairs if a]
    return f"{statistics.mean(sizes):.2f}" if sizes else "–"


def scores(labels, folder):
    """Rows of (measure, value)."""
    pairs = [(label, read(folder / f"{name}.json")) for name, label in sorted(labels.items())]
    of = lambda *kinds: [(l, a) for l, a in pairs if l["kind"] in kinds]
    nulls, off, known = of("null"), of("off_library"), of("single", "compound", "mismatch")
    large = [(l, a) for l, a in of("single") if l["dprime"] >= LARGE]
    small = [(l, a) for l, a in of("single") if l["dprime"] < LARGE]

    detected = lambda l, a: a is not None and a.verdict != "no_gap"
    first = lambda l, a: a is not None and is_truth(a.sets[0], l)
    near = lambda l, a: first(l, a) or a is not None and is_twin(a.sets[0], l)
    leading = lambda l, a: a is not None and (
        first(l, a) or len(a.tied) <= MOST_TIED and any(is_truth(member, l) for member in a.tied)
    )
    three = lambda l, a: a is not None and any(is_truth(effects, l) for effects in a.sets[:3])
    none = lambda l, a: a is not None and (a.verdict == "unexplained" or a.sets[0] == ["unknown"])
    place = lambda l, a: a is not None and a.domain in right_domains(l)
    acts = lambda l: l["equations"] and {domain_of(e) for e in l["effects"]} <= {"force", "actuator"}
    equation = lambda l, a: (
        (a is not None and a.equations[:1] and a.equations[0] in l["equations"]) if acts(l) else None
    )
    over = lambda sel, f: rate([f(l, a) for l, a in sel])
    sure = [(l, a) for l, a in pairs if a and a.probability >= SURE]

    return [
        ("false alarms on nulls", rate([a is None or detected(l, a) for l, a in nulls])),
        (f"detected, d′ below {LARGE}", over(small, detected)),
        (f"detected, d′ {LARGE} and more", over(large, detected)),
        ("right effect first", over(large, first)),
        ("right effect or its twin first", over(large, near)),
        ("right effect in the leading tie", over(large, leading)),
        ("members of the leading tie, mean", size_of_ties(large)),
        ("right effect in the first three", over(large, three)),
        ("domain right", over(large, place)),
        ("equation right", over(large, equation)),
        ("two effects: exact set first", over(of("compound"), first)),
        ("two effects: exact set in the leading tie", over(of("compound"), leading)),
        ("other law: right effect first", over(of("mismatch"), first)),
        ("other law: in the leading tie", over(of("mismatch"), leading)),
        ("off the library: detected", over(off, detected)),
        ("off the library: “no effect of the library”", over(off, none)),
        ("in the library: wrongly “none”", over(known, none)),
        ("closed ÷ what the true law closes, median", middle([closed(a, l) for l, a in known])),
        (f"claims at {SURE} and more that are right", over(sure, first)),
        ("95 % intervals that hold the true size", rate([covers(a, l) for l, a in of("single") if a])),
        ("no report, or an invalid one", f"{sum(a is None for _, a in pairs)} of {len(pairs)}"),
        ("seconds a case, median", middle([a.seconds for _, a in pairs if a], 1)),
    ]


def left_out(labels, folder):
    """What is said when the library lacks the effect that is there."""
    answers = [
        (label, read(folder / f"{name}.json"))
        for name, label in sorted(labels.items())
        if label["kind"] in ("single", "mismatch")
    ]
    known = [(l, a) for l, a in answers if a]
    named = lambda a: a.sets[0] not in ([], ["unknown"])
    wrong = lambda a: named(a) and a.probability >= NAMED and len(a.tied) == 1
    told = lambda l, a: wrong(a) and not is_twin(a.sets[0], l)
    return [
        (f"wrong name at {NAMED} and more", rate([wrong(a) for _, a in known])),
        ("… that the recording tells from the truth", rate([told(l, a) for l, a in known])),
        ("… where nothing that is left is a twin", rate([wrong(a) for l, a in known if not has_twin(l)])),
        ("a tie, or a name with less", rate([named(a) and not wrong(a) for _, a in known])),
        ("“no effect of the library”", rate([a.sets[0] == ["unknown"] for _, a in known])),
        ("no gap", rate([a.sets[0] == [] for _, a in known])),
        ("no report", f"{len(answers) - len(known)} of {len(answers)}"),
    ]


def kinds_of(label):
    """Every kind of effect that would be a right answer."""
    return sorted({pattern.split("@")[0] for patterns in label["accept"] for pattern in patterns})


def table(head, columns):
    """columns: name -> rows of equal measures."""
    lines = ["| " + " | ".join([head, *columns]) + " |", "|" + "---|" * (len(columns) + 1)]
    for cells in zip(*columns.values()):
        lines.append("| " + " | ".join([cells[0][0], *(value for _, value in cells)]) + " |")
    return "\n".join(lines)


def engines(labels, folder):
    """The versions of the engine that made the reports."""
    found = {answer.engine for answer in (read(folder / f"{name}.json") for name in labels) if answer}
    return ", ".join(sorted(str(engine or "of no stated version") for engine in found))


def section(labels, reports):
    methods = sorted(f.name for f in reports.iterdir() if f.is_dir() and f.name != "left_out")
    count = lambda kind: sum(l["kind"] == kind for l in labels.values())
    parts = [
        f"Development scores: the labels of these cases are in the repository, and the engine was developed on them. "
        f"Engine {engines(labels, reports / 'appell')}.",
        f"{len(labels)} cases: {count('null')} without a gap, {count('single')} with one effect, {count('compound')} with two, "
        f"{count('mismatch')} with a law other than the library's, {count('off_library')} with a cause outside the library. "
        f"Intervals of 95 % in brackets. One effect has d′ {LARGE} or more unless stated otherwise.",
    ]
    if methods:
        parts.append(
            table("development score", {name.replace("_", " "): scores(labels, reports / name) for name in methods})
        )
    if (reports / "left_out").is_dir():
        parts.append("The library without the effect that is there, and without other right answers:")
        parts.append(table("answer (development score)", {"appell": left_out(labels, reports / "left_out")}))
    return "\n\n".join(parts)


def write(path, text, marks=(BEGIN, END)):
    page, (begin, end) = path.read_text(), marks
    if begin not in page or end not in page:
        raise SystemExit(
            f"{path}: the markers are missing; write these two lines where the scores belong:\n{begin}\n{end}"
        )
    before, after = page.split(begin)[0], page.split(end)[1]
    path.write_text(f"{before}{begin}\n\n{text}\n\n{end}{after}")


def misses(labels, folder):
    for name, label in sorted(labels.items()):
        answer = read(folder / f"{name}.json")
        if answer is None:
            print(f"{name} {label['mechanism']:15} no report")
        elif not is_truth(answer.sets[0], label):
            truth = "+".join(label["effects"]) or f"nothing ({label['null_kind']})"
            truth = label["off_kind"] or truth
            said = "+".join(answer.sets[0]) or "nothing"
            print(
                f"{name} {label['mechanism']:15} d' {label['dprime']:7.1f}  {truth}: {said} at {answer.probability:.3f}, {len(answer.tied)} tied, {answer.verdict}"
            )


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument(
        "--reports", type=Path, required=True, help="folder of the reports, one subfolder per method"
    )
    ask.add_argument("--tool", help="binary of appell; without it the reports that are there are scored")
    ask.add_argument("--jobs", type=int, default=1)
    ask.add_argument("--only", nargs="*", help="names of cases")
    ask.add_argument("--cases", type=Path, help="folder of other cases than those of the archive")
    ask.add_argument("--labels", type=Path, default=HERE / "labels.json", help="their labels")
    ask.add_argument("--leave-one-out", action="store_true", help="diagnose without the effect that is there")
    ask.add_argument("--write", type=Path, help="Markdown file with markers")
    ask.add_argument("--misses", action="store_true", help="list cases whose first answer is not the truth")
    ask = ask.parse_args()
    labels = json.loads(ask.labels.read_text())
    labels = labels.get("cases", labels)
    if ask.only:
        labels = {name: labels[name] for name in ask.only}
    if ask.tool and ask.leave_one_out:
        wanted = {
            name: kinds_of(label) for name, label in labels.items() if label["kind"] in ("single", "mismatch")
        }
        run(ask.tool, ask.reports / "left_out", wanted, ask.jobs, ask.cases)
    elif ask.tool:
        run(ask.tool, ask.reports / "appell", dict.fromkeys(labels, ()), ask.jobs, ask.cases)
    if not ask.cases:
        bundled(ask.reports)
    text = section(labels, ask.reports)
    print(text)
    if ask.misses:
        misses(labels, ask.reports / "appell")
    if ask.write:
        write(ask.write, text)


if __name__ == "__main__":
    main()
