"""Scores of several sets of labelled cases together, by kind of cause. Standard library only.

    kinds.py --set LABELS.json REPORTS --set … [--write FILE.md]

`LABELS.json` has `cases`, each with `kind`, `effects` and `accept` (for each effect, patterns of the names that stand
for it); `REPORTS` has CASE.json of `appell diagnose --json`, and may have CASE.time with user, system and wall
seconds. A missing report counts as wrong, on a case without a gap as an alarm. The table replaces that between the
markers of FILE.md."""

import argparse
import collections
import itertools
import json
import re
import statistics
from pathlib import Path

from score import rate

BEGIN, END = "<!-- kinds of tests/blind: begin -->", "<!-- kinds of tests/blind: end -->"
SURE, MOST_TIED, LARGE = 0.95, 5, 7.4


def is_exact(effects, label):
    """Whether the effects are the truth, up to twins."""
    if label["kind"] == "null":
        return effects == []
    if label["kind"] == "off_library":
        return effects == ["unknown"]
    accepted = label["accept"]
    hits = lambda effect, patterns: any(re.fullmatch(p, effect, re.IGNORECASE) for p in patterns)
    return len(effects) == len(accepted) and any(
        all(map(hits, order, accepted)) for order in itertools.permutations(effects)
    )


class Judged:
    """What a report says about a case."""

    def __init__(self, label, report, seconds):
        self.label, self.seconds = label, seconds
        self.kind = label["kind"]
        self.count = len(label["accept"] or [])
        self.is_clear = self.kind != "single" or (label.get("dprime_data") or label["dprime"]) >= LARGE
        self.engine = None
        self.first = self.tied = self.three = self.none = False
        self.gap, self.sure, self.bare = True, False, False
        if report is None:
            return
        self.engine = report.get("engine")
        hypotheses = sorted(report["which"], key=lambda h: -h["probability"])
        leader = hypotheses[0]["effects"]
        members = lambda tie: [sorted(m.split("+") if isinstance(m, str) else m) for m in tie]
        ties = [members(tie) for tie in report.get("tied") or []]
        tie = next((tie for tie in ties if sorted(leader) in tie), [leader])
        self.first = is_exact(leader, label)
        self.tied = self.first or len(tie) <= MOST_TIED and any(is_exact(m, label) for m in tie)
        self.three = any(is_exact(h["effects"], label) for h in hypotheses[:3])
        self.none = leader == ["unknown"] or report["verdict"] == "unexplained"
        self.gap = report["verdict"] != "no_gap"
        self.sure = hypotheses[0]["probability"] >= SURE
        shares = report["how_far"].get("budget") or []
        material = any(share["material"] for share in shares if share["effect"] in leader)
        self.bare = report["verdict"] == "explained" and not material


def read(sets):
    for labels, reports in sets:
        for name, label in json.loads(Path(labels).read_text())["cases"].items():
            file, clock = Path(reports, f"{name}.json"), Path(reports, f"{name}.time")
            times = clock.read_text().split()[-3:] if clock.exists() else []
            seconds = float(times[0]) + float(times[1]) if len(times) == 3 else None
            try:
                report = json.loads(file.read_text())
            except (OSError, ValueError):
                report = None
            yield Judged(label, report, seconds)


def cause(case):
    """The kind of cause, for the lines of the table."""
    if case.kind != "single":
        return None
    return case.label["effects"][0].split("@")[0]


def table(cases):
    lines = []

    def line(name, chosen, *values):
        columns = [rate([value(case) for case in chosen]) if value else "–" for value in values]
        lines.append(f"| {name} | {' | '.join(columns)} |")

    of = lambda *kinds: [case for case in cases if case.kind in kinds]
    first, tied, three = (lambda c: c.first), (lambda c: c.tied), (lambda c: c.three)
    single = [case for case in of("single") if case.is_clear]
    lines += ["| development score | right first | in the leading tie | in the first three |", "|---|---|---|---|"]
    line("one effect, d′ 7.4 and more", single, first, tied, three)
    grouped = collections.defaultdict(list)
    for case in single:
        grouped[cause(case)].append(case)
    for name, chosen in sorted(grouped.items()):
        line(f"… {name.replace('_', ' ')}", chosen, first, tied, three)
    weak = [case for case in of("single") if not case.is_clear]
    line("one effect, d′ below 7.4", weak, first, tied, three)
    for count, word in [(2, "two"), (3, "three")]:
        chosen = [case for case in of("compound") if case.count == count]
        line(f"{word} effects", chosen, first, tied, three)
    line("another law than the library's", of("mismatch"), first, tied, three)
    line("off the library: “none of the library”", of("off_library"), lambda c: c.none, None, three)
    lines += ["", "| development score | cases |", "|---|---|"]
    known = of("single", "compound", "mismatch")
    line("false alarms on nulls", of("null"), lambda c: c.gap)
    line("in the library: wrongly “none”", known, lambda c: c.none)
    line("off the library: no gap seen", of("off_library"), lambda c: not c.gap)
    line("claims at 0.95 and more that are right", [c for c in cases if c.sure], first)
    line("explained without a material share", cases, lambda c: c.bare)
    line("no report within 400 s", cases, lambda c: c.engine is None)
    seconds = sorted(case.seconds for case in cases if case.seconds is not None)
    if seconds:
        at = lambda part: seconds[min(len(seconds) - 1, int(part * len(seconds)))]
        lines.append(f"| processor seconds: median, 90 %, largest | {at(0.5):.0f}, {at(0.9):.0f}, {at(1):.0f} |")
    return lines


def main():
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("--set", nargs=2, action="append", required=True, metavar=("LABELS", "REPORTS"))
    ask.add_argument("--write", type=Path, help="Markdown file with markers")
    options = ask.parse_args()
    cases = list(read(options.set))
    engines = sorted({case.engine for case in cases if case.engine is not None})
    probability = statistics.mean(case.sure for case in cases)
    head = (
        f"{len(cases)} cases; engine {', '.join(map(str, engines))}; "
        f"{100 * probability:.0f} % of the leaders have a probability of 0.95 and more."
    )
    text = "\n".join([head, "", *table(cases)])
    print(text)
    if options.write:
        old = options.write.read_text()
        before, rest = old.split(BEGIN)
        after = rest.split(END)[1]
        options.write.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}")


if __name__ == "__main__":
    main()
