"""What a report names, against a label: first, in the leading tie, in the first three."""

import itertools
import re

# Members of a leading tie that are read.
TIE = 5


def matches(effect, pattern):
    return re.fullmatch(pattern, effect) is not None


def single(accept, effects):
    """Whether exactly these effects are one accepted answer: one of `any`, besides what may come with it."""
    for chosen in effects:
        if any(matches(chosen, p) for p in accept["any"]):
            rest = [e for e in effects if e != chosen]
            if all(any(matches(e, p) for p in accept.get("also", [])) for e in rest):
                return True
    return False


def at_all(accept, effects):
    """Whether these effects are the same kind at all drives."""
    if len(effects) == 1 and effects[0] in accept["word"]:
        return True
    return len(effects) == accept["n"] and all(any(matches(e, p) for p in accept["all"]) for e in effects)


def right(label, effects):
    """Whether a hypothesis is the truth."""
    accepts = label["accept"]
    if not accepts:
        return effects == (["unknown"] if label["effects"] == ["unknown"] else [])
    return parts(accepts, effects)


def parts(accepts, effects):
    """Whether effects divide into answers to each of the accepted ones."""
    if not accepts:
        return not effects
    first, *others = accepts
    answer = single if "any" in first else at_all
    for n in range(1, len(effects) + 1):
        for chosen in itertools.combinations(effects, n):
            left = [e for e in effects if e not in chosen]
            if answer(first, list(chosen)) and parts(others, left):
                return True
    return False


def members(group):
    """The hypotheses of a group of the report, `a@x+b@y` or lists."""
    return [sorted(m) if isinstance(m, list) else sorted(m.split("+")) if m else [] for m in group]


def tie(report):
    """The hypotheses that the report ties with the first."""
    first = sorted(report["which"][0]["effects"])
    for group in report.get("tied") or []:
        if first in members(group) and len(group) <= TIE:
            return members(group)
    return [first]


def most(label, moved):
    """Whether the numbers that moved most are the truth: as many as it has effects, drives together or one by one."""
    return any(right(label, moved[:n]) for n in range(1, 1 + sum(a.get("n", 1) for a in label["accept"])))


def judged(label, report):
    """First, in the tie, in the first three, alarm, claim at .95 and more."""
    which = report["which"]
    first = right(label, which[0]["effects"])
    sure = which[0]["probability"] >= 0.95
    return {
        "first": first,
        "tie": first or any(right(label, effects) for effects in tie(report)),
        "three": any(right(label, h["effects"]) for h in which[:3]),
        "alarm": label["kind"] == "null" and report["verdict"] != "no_gap",
        "claim": first if sure else None,
    }
