"""docs/performance.md from the results of one run."""

import re
import statistics

import mechanisms

NAMES = {"appell": "appell", "casadi": "CasADi", "sympy": "SymPy", "hand": "typed by hand"}

TEXT = """# Performance compared with SymPy and CasADi

<!-- Written by benches/peers/run.py. -->

One run of

```sh
{command}
```

on {date}, commit {commit}. {processor}, {cores} cores, load up to {load:.1f}; {gcc}; {rustc}; Python {python},
SymPy {sympy}, CasADi {casadi}. C with `-O3 -march=native`, Rust with `-C target-cpu=native`, everything in
one program.

- **time** is the median time of a call, parameters at run time, over 256 states in turn; the median of
  {layouts} code layouts: shuffled order of linking, random padding between the functions.
- **appell / this** is the number to compare; below 1, appell is faster. Each round calls all functions in
  turn, so that both of a pair see the same machine; the ratio is formed in every round. Given are the median
  of the layouts and the range of the layouts' medians. On a busy machine times grow, but ratios persist;
  those of the large functions scatter more.
- **operations** are counted after elimination of common subexpressions. SymPy: `count_ops`, integer powers
  multiplied out, a function counts one. CasADi: instructions without loads and stores. appell: additions,
  multiplications, divisions and signs; sine-cosine pairs, functions and linear systems are listed separately,
  and operations inside a linear system (up to 3 × 3, pivoted) are not counted.
- **generation** is the fastest of some repetitions in a warm process: from the formulation to C for the
  peers, from the text of the spec to Rust for appell, which derives S, all constraints and M on the way.
  The C or Rust compiler is not counted.

SymPy and CasADi are given an efficient formulation (`benches/peers/mechanisms.py`): Kane's method in
moving frames, the rolling of the rear wheel solved by hand, 2 × 2 blocks by formula. SymPy's Jacobians are
differentiated forward along the shared subexpressions. All functions in a table give the same numbers.

"""


def operations(tool, told, kernel):
    if tool == "hand":
        return ""
    count = told[tool][kernel]["operations"]
    if tool != "appell":
        return f"{count:,}"
    total = sum(int(n) for n in re.findall(r"(?:^|\+ )(\d+) \(", count))
    rest = {}
    count = re.sub(r"sine or cosine of (\d+) angles?", r"\1 sine-cosine pair", count)
    for n, what in re.findall(r", (\d+) (sine-cosine pair|function|linear system)s?", count):
        rest[what] = rest.get(what, 0) + int(n)
    return ", ".join([f"{total:,}"] + [f"{n} {what}{'s' if n > 1 else ''}" for what, n in rest.items()])


def seconds(tool, told, kernel):
    return "" if tool == "hand" else f"{1e3 * told[tool][kernel]['seconds']:,.1f} ms"


def page(about, told, found, times):
    text = TEXT.format(sympy=told["sympy"]["version"], casadi=told["casadi"]["version"], layouts=len(times), **about)
    for kernel, title in mechanisms.KERNELS.items():
        text += f"## {title[0].upper()}{title[1:]}\n\n"
        text += "| | time | appell / this | operations | generation |\n|---|---|---|---|---|\n"
        rows = [k for k in found if k[1].removesuffix("_hand") == kernel]
        rows.sort(key=lambda k: (list(NAMES).index(k[0]), k[1]))
        for tool, name in rows:
            own = [layout[f"{tool}.{name}"] for layout in times]
            ours = [layout[f"appell.{kernel}"] for layout in times]
            time = statistics.median(statistics.median(layout) for layout in own)
            ratios = [statistics.median(a / b for a, b in zip(x, y)) for x, y in zip(ours, own)]
            ratio = "" if tool == "appell" else (
                f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})")
            label = NAMES[tool] + (", from the closed form" if name.endswith("_hand") else "")
            text += (f"| {label} | {time:,.1f} ns | {ratio} | {operations(tool, told, name)} | "
                     f"{seconds(tool, told, name)} |\n")
        text += "\n"
    return text.rstrip() + "\n"
