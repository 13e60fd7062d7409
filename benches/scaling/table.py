"""The block of docs/performance.md about growth, from the results of one run."""

from dataclasses import dataclass

import numpy as np

BEGIN = "<!-- scaling: written by benches/scaling/run.py -->"
END = "<!-- end scaling -->"
SIZES = {"arm": (3, 4, 5, 6, 7, 10, 14, 18, 24, 30), "chain": (6, 12, 20, 30)}
FUNCTIONS = {"mass_matrix_and_bias": "M, bias", "rates": "rates", "jacobians": "rates, A, B"}
INVERSE = {"inverse_dynamics": "forces", "inverse_dynamics_jacobians": "forces and Jacobians"}
ARMS = ("ur5e_mjcf", "so101_urdf", "iiwa14_mjcf", "xarm7_mjcf", "xarm7_urdf", "panda_mjcf")
# Exponents are fitted to mechanisms with at least so many joints.
LARGE = 12
# Bounds of the time of a function, relative to Pinocchio's.
TIMES = {
    "rates": {"arms": 0.33, "go1_mjcf": 0.6, "g1_mjcf": 0.8},
    "jacobians": {"arms": 0.5, "go1_mjcf": 0.8, "g1_mjcf": 1.0},
}

TEXT = """## Growth with the number of joints

One run of `{command}` on {date}, commit {commit}. {processor}, {cores} cores, load up to {load:.1f}; {gcc}; {rustc};
CasADi {casadi}, Pinocchio {pinocchio}. C and C++ with `-O3 -march=native`, Rust with `-C target-cpu=native`.

- **Operations** are additions, multiplications, divisions and signs after elimination of common subexpressions. Sines and
  cosines are not among them. The rates of appell include those of the quaternion of a base, the peers' do not.
- **CasADi**: composite bodies and Newton-Euler for M and bias, articulated bodies for the rates, each in SX with
  `casadi.cse` (`benches/scaling/with_casadi.py`), symmetric blocks computed once, zeros and right angles of the
  placements dropped; derivatives by its automatic differentiation. The base of a robot has a quaternion and its
  velocities along itself.
- `armN` is a spatial arm of N joints, with symbols for ten inertial numbers and the offset of each link; `chainN` a planar
  chain, four symbols a link; `float4x3` a floating base with four limbs of three joints each, like those of arms
  (`benches/scaling/specs.py`).

"""


INVERSE_DYNAMICS = """### Inverse dynamics

Forces of given motions; with their Jacobians with respect to coordinates and velocities by CasADi's automatic
differentiation, for up to seven joints. Those of appell hold M, the Jacobian with respect to accelerations, as well.

"""


DERIVATION = """### Derivation

Processor time from the text of the spec to the schedule of one function, and of all emitted functions (up to 14 joints and
for robot files), with derivatives by parameters where there are at most 64. rustc takes {compiled:.1f} s for the whole model of arm7.

"""

TIMING = """### Times

Median time of a call over 256 states in turn, numbers folded, everything in one program. Pinocchio runs `aba` and
`computeABADerivatives`, CasADi its generated C of articulated bodies and of their Jacobian, for arms. Every round calls all
functions in turn; a ratio is the median of the ratios of the rounds, below 1 appell is faster. All tools give the same
numbers (largest difference {worst:.0e} of the largest entry).

"""


def number(value):
    return "" if value is None else f"{value:,}"


def seconds(value):
    return f"{value:.3f} s" if value < 1 else f"{value:.1f} s"


def rows(header, lines):
    table = [header, ["---"] * len(header), *lines]
    return "\n".join("| " + " | ".join(line) + " |" for line in table) + "\n\n"


def is_file(name):
    """Whether a spec is imported from a robot file."""
    return name.endswith(("_mjcf", "_urdf"))


@dataclass
class Target:
    """A bound of a measured value."""

    what: str
    value: float
    bound: float
    form: str = "{:,}"

    def line(self):
        met = "yes" if self.value <= self.bound else "**no**"
        return [self.what, self.form.format(self.value), "≤ " + self.form.format(self.bound), met]


def operations(costs, counts, names):
    lines = []
    for name in names:
        ours = [costs[name, function]["operations"] for function in FUNCTIONS]
        theirs = [counts.get((name, function), [None])[0] for function in FUNCTIONS]
        ratio = f"{ours[1] / theirs[1]:.2f}" if theirs[1] else ""
        lines.append([name, *map(number, ours), *map(number, theirs), ratio])
    return rows(["", *FUNCTIONS.values(), *(f"CasADi: {title}" for title in FUNCTIONS.values()), "rates: appell / CasADi"], lines)


def inverse_dynamics(costs, counts, names):
    lines = []
    for name in names:
        cells = [name]
        for function in INVERSE:
            ours, theirs = costs[name, function]["operations"], counts.get((name, function), [None])[0]
            cells += [number(ours), number(theirs), f"{ours / theirs:.2f}" if theirs else ""]
        lines.append(cells)
    titles = (f"{tool}{title}" for title in INVERSE.values() for tool in ("", "CasADi: ", "ratio: "))
    return rows(["", *titles], lines)


def derivation(costs, names):
    kinds = (*FUNCTIONS, "all")
    lines = [[name, *(seconds(costs[name, kind]["seconds"]) if (name, kind) in costs else "" for kind in kinds)] for name in names]
    return rows(["", *FUNCTIONS.values(), "all functions"], lines)


def exponent(costs, family, function):
    sizes = large(family)
    operations = [costs[f"{family}{n}", function]["operations"] for n in sizes]
    return float(np.polyfit(np.log(sizes), np.log(operations), 1)[0])


def large(family):
    return [n for n in SIZES[family] if n >= LARGE]


def growth(costs):
    lines = []
    for family in SIZES:
        title = f"{family}s, {large(family)[0]} to {large(family)[-1]} joints"
        lines.append([title, *(f"{exponent(costs, family, function):.2f}" for function in FUNCTIONS)])
    return rows(["growth, exponent of", *FUNCTIONS.values()], lines)


def ratios(times, one, other):
    return float(np.median(times[one] / times[other]))


def timing(times, robots):
    lines = []
    for function in ("rates", "jacobians"):
        for robot in robots:
            tools = [(tool, robot, function) for tool in ("appell", "pinocchio", "casadi")]
            cells = [f"{np.median(times[tool]):,.0f} ns" if tool in times else "" for tool in tools]
            cells += [f"{ratios(times, tools[0], tool):.2f}" if tool in times else "" for tool in tools[1:]]
            lines.append([f"{robot}: {FUNCTIONS[function]}", *cells])
    return rows(["", "appell", "Pinocchio", "CasADi", "appell / Pinocchio", "appell / CasADi"], lines)


def targets(costs, counts, times, timed, compiled):
    def count(name, function):
        return costs[name, function]["operations"]

    found = [
        Target("arm7: M, bias", count("arm7", "mass_matrix_and_bias"), 1800),
        Target("arm7: rates", count("arm7", "rates"), 2300),
        Target("arm7: rates, A, B", count("arm7", "jacobians"), 9000),
        Target("float4x3: rates", count("float4x3", "rates"), 5000),
        Target("float4x3: rates, A, B", count("float4x3", "jacobians"), 22000),
    ]
    for family in SIZES:
        for function, bound in (("rates", 1.3), ("jacobians", 2.2)):
            found.append(Target(f"{family}s: growth of {FUNCTIONS[function]}", exponent(costs, family, function), bound, "{:.2f}"))
    files = {name: count(name, "rates") / counts[name, "rates"][0] for name, function in counts if function == "rates" and is_file(name)}
    worst = max(files, key=files.get)
    found.append(Target(f"robot files: rates / CasADi's, largest ({worst})", files[worst], 0.85, "{:.2f}"))
    function = "inverse_dynamics_jacobians"
    files = {name: count(name, function) / counts[name, function][0] for name in ARMS if (name, function) in counts}
    worst = max(files, key=files.get)
    found.append(Target(f"arms from robot files: inverse dynamics, Jacobians / CasADi's, largest ({worst})", files[worst], 0.6, "{:.2f}"))
    for name, bound in (("arm7", 0.2), ("float4x3", 2.0), ("go1_mjcf", 2.0), ("g1_mjcf", 10.0)):
        found.append(Target(f"{name}: derivation of all functions, s", costs[name, "all"]["seconds"], bound, "{:.2f}"))
    found.append(Target("arm7: rustc on its model, s", compiled, 20.0, "{:.1f}"))
    for function, bounds in TIMES.items():
        for tool, title in (("pinocchio", "Pinocchio"), ("casadi", "CasADi")):
            against = {name: ratios(times, ("appell", name, function), (tool, name, function)) for name in timed if (tool, name, function) in times}
            groups = {}
            for name, ratio in against.items():
                group = name if name in bounds else "arms"
                groups.setdefault(group if tool == "pinocchio" else "robots", []).append(ratio)
            for group, found_ratios in groups.items():
                bound = bounds[group] if tool == "pinocchio" else 1.0
                what = f"{group}: time of {FUNCTIONS[function]} / {title}'s" + (", largest" if len(found_ratios) > 1 else "")
                found.append(Target(what, max(found_ratios), bound, "{:.2f}"))
    return rows(["", "measured", "target", "met"], [target.line() for target in found])


def block(about, names, costs, counts, times, compiled, refused, worst):
    families = [name for name in names if not is_file(name)]
    robots = [name for name in names if is_file(name)]
    text = TEXT.format(**about) + "### Operations\n\n" + operations(costs, counts, families) + growth(costs)
    text += "### Robot files\n\nImported by `appell import`, numbers folded, the rigid tree alone.\n\n" + operations(costs, counts, robots)
    text += "".join(f"Left out: {name}, {reason}.\n\n" for name, reason in refused.items())
    text += INVERSE_DYNAMICS + inverse_dynamics(costs, counts, [*families, *robots])
    text += DERIVATION.format(compiled=compiled) + derivation(costs, names)
    text += TIMING.format(worst=worst) + timing(times, about["timed"])
    text += "### Targets\n\n" + targets(costs, counts, times, about["timed"], compiled)
    return f"{BEGIN}\n\n{text.rstrip()}\n\n{END}\n"


def replaced(page, text):
    """The page with another block at its end."""
    return page.partition(BEGIN)[0].rstrip() + "\n\n" + text
