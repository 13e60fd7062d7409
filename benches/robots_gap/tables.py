"""Tables of cases and tools, and their place in docs/performance.md."""

import math
import statistics


def marks(folder):
    """The lines about the block of a folder."""
    return f"<!-- robots, {folder}: written by benches/robots_gap/run.py -->", f"<!-- end robots, {folder} -->"


def gaps(found):
    return [(case, own) for case, own in found if case.label["kind"] != "null"]


def nulls(found):
    return [own for case, own in found if case.label["kind"] == "null"]


def share(values):
    known = [v for v in values if v is not None]
    return f"{sum(known)} of {len(known)}"


def closings(found):
    """What was closed of the gaps that MJCF expresses; a failure closes nothing."""
    return [own.get("closed", 0.0) for case, own in gaps(found) if case.label["mjcf"]]


def worse(found):
    """Files with larger errors than before. Where the format cannot express the gap, errors are mostly those of the gap."""
    judged = [own for case, own in found if case.label["mjcf"] or case.label["kind"] == "null"]
    return share([own.get("error", 0.0) > own.get("nominal", 0.0) for own in judged])


def changed(found):
    """Files of robots without a gap that were changed; whether for the worse, errors tell."""
    return share([not own.get("same", True) for own in nulls(found)])


def numbers(found):
    every = [(own.get("right", 0), len(case.label["written"])) for case, own in gaps(found)]
    return f"{sum(right for right, _ in every)} of {sum(count for _, count in every)}"


def cells(case, own):
    closed = f"{own['closed']:.3f}" if "closed" in own and case.label["mjcf"] else "–"
    right = f"{own['right']}/{own['numbers']}" if own.get("numbers") else "–"
    return f"{closed} | {right} | {own['seconds']:.0f}"


def rows(found, peers):
    """The lines of a table of all cases."""
    head = "| case | true | named first | p | first | tie | closed | numbers | s |"
    if peers:
        head += " sysid: found | closed | numbers | s |"
    lines = [head, "|" + "---|" * (head.count("|") - 1)]
    for case, own in found:
        named = " + ".join(own.get("which", ["failed"])) or "nothing"
        truth = " + ".join(case.label["effects"]) or "nothing"
        line = (f"| {case.name} | {truth} | {named} | {own.get('p', math.nan):.2f} | {own.get('first', False)} | "
                f"{own.get('tie', False)} | {cells(case, own)} |")
        if peers:
            peer = peers[case.name]
            line += f" {peer.get('first', False)} | {cells(case, peer)} |"
        lines.append(line)
    return lines


def sums(found):
    """What is summed up of a tool: name -> text."""
    closed = closings(found)
    every = [own for _, own in gaps(found)]
    texts = {"first": share([own.get("first", False) for own in every])}
    if any("tie" in own for own in every):
        texts["leading tie"] = share([own.get("tie", False) for own in every])
        texts["first three"] = share([own.get("three", False) for own in every])
    texts["alarms on rigs without a gap"] = share([own.get("alarm", True) for own in nulls(found)])
    if closed:
        texts["closed, median"] = f"{statistics.median(closed):.3f}"
        texts["closed, mean"] = f"{statistics.mean(closed):.3f}"
    texts["numbers right within 25 %"] = numbers(found)
    texts["files made worse"] = worse(found)
    texts["files changed without a gap"] = changed(found)
    texts["processor seconds, median"] = f"{statistics.median([own['seconds'] for _, own in found]):.0f}"
    return texts


def summary(found, peers):
    """The lines of a table of the sums of the tools."""
    own = sums(found)
    if not peers:
        return ["| | appell |", "|---|---|", *(f"| {name} | {text} |" for name, text in own.items())]
    other = sums([(case, peers[case.name]) for case, _ in found])
    lines = ["| | appell | mujoco.sysid, usual list |", "|---|---|---|"]
    return lines + [f"| {name} | {text} | {other.get(name, '–')} |" for name, text in own.items()]


def block(about, found, peers):
    """The block of docs/performance.md."""
    begin, end = marks(about["folder"])
    text = [begin, "",
            f"One run of `{about['command']}` on {about['date']}, commit {about['commit']}. MuJoCo {about['mujoco']}."]
    if peers:
        text += ["`mujoco.sysid` fits all armatures, dampings, dry frictions, masses, gains and one delay; it names no cause: it",
                 "counts as right where the true cause moved most."]
    text.append("")
    return "\n".join([*text, *summary(found, peers), "", *rows(found, peers), "", end])


def replaced(page, folder, text):
    """A page with the block between the markers replaced."""
    begin, last = marks(folder)
    before, _, rest = page.partition(begin)
    _, end, after = rest.partition(last)
    if not end:
        raise SystemExit(f"no lines {begin!r} and {last!r} in the page")
    return before + text + after
