#!/usr/bin/env python3
"""Places in lanes and motions, beside gcc's vectors and heyoka, in one run.

    python3 run.py --appell PATH [--out docs/lanes.md]

Needs heyoka, numpy and mpmath, gcc and cargo. Equations of the peers are those that `appell derive` writes, in C with
vectors in the place of numbers and in Python with heyoka's expressions, so that all compute the same. Errors are against
fifty digits (places) and against tighter tolerances (motions). `--out` replaces the tables of a document.
"""

import argparse
import importlib.util
import json
import multiprocessing
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import heyoka
import mpmath
import numpy

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SPECS = {name: ROOT / f"generated/mechanisms/{name}.toml" for name in ("unicycle", "euc_3dof", "bicycle")}
SPECS["arm_6"] = HERE / "arm_6.toml"
SECONDS = 1.0
ROUNDS = 200


class Names:
    """A namespace for emitted functions: elementary functions of a module, systems by elimination."""

    def __init__(self, module):
        for name in ("sin", "cos", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "sqrt"):
            if hasattr(module, name):
                setattr(self, name, getattr(module, name))
        self.pow = lambda a, b: a**b
        self.pi = module.mpf(numpy.pi) if module is mpmath else numpy.pi
        if module is mpmath:
            self.Rational = lambda n, d: mpmath.mpf(n) / d
            self.fabs = abs
            self.Piecewise = lambda *pairs: next(value for value, holds in pairs if holds)

    vertcat = staticmethod(lambda *rows: list(rows))
    horzcat = staticmethod(lambda *entries: list(entries))
    vertsplit = staticmethod(list)

    @staticmethod
    def solve(rows, right):
        """Elimination without pivoting: the systems are mass matrices."""
        rows, right = [list(row) for row in rows], list(right)
        for k in range(len(right)):
            for i in range(k + 1, len(right)):
                factor = rows[i][k] / rows[k][k]
                rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k])]
                right[i] = right[i] - factor * right[k]
        solution = [None] * len(right)
        for i in reversed(range(len(right))):
            known = sum((rows[i][j] * solution[j] for j in range(i + 1, len(right))), 0.0)
            solution[i] = (right[i] - known) / rows[i][i]
        return solution


def emitted(appell, spec, folder):
    """The equations of a spec as a Python module, and as C."""
    for ending in ("py", "c"):
        subprocess.run([appell, "derive", spec, "--out", folder / f"{spec.stem}.{ending}"], check=True,
                       stdout=subprocess.DEVNULL)
    place = importlib.util.spec_from_file_location(spec.stem, folder / f"{spec.stem}.py")
    module = importlib.util.module_from_spec(place)
    place.loader.exec_module(module)
    return module


def flat(numbers):
    return [entry for row in numbers for entry in (row if isinstance(row, (list, tuple)) else [row])]


def accuracy(module, samples):
    """Largest errors of rates and of A and B, relative to the largest entry of each."""
    mpmath.mp.dps = 50
    worst = [0.0, 0.0]
    for sample in samples:
        x, u, p = ([mpmath.mpf(v) for v in sample[key]] for key in "xup")
        rates, a, b = module.jacobians(Names(mpmath), mpmath.mpf(0), x, u, p)
        for place, (exact, found) in enumerate(((rates, sample["rates"]), (flat(a) + flat(b), sample["a"] + sample["b"]))):
            exact = flat(exact)
            size = max(abs(value) for value in exact)
            worst[place] = max(worst[place], *(float(abs(e - f) / size) for e, f in zip(exact, found)))
    return worst


def fastest(call, count, rounds=ROUNDS):
    best = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best * 1e9 / count


def with_heyoka(module, parameters, start):
    """Nanoseconds a place in the second cache; microseconds and errors of a motion."""
    variables = heyoka.make_vars(*(f"x{i}" for i in range(len(module.STATES))))
    inputs = heyoka.make_vars(*(f"u{i}" for i in range(len(module.INPUTS))))
    variables, inputs = (list(v) if isinstance(v, (list, tuple)) else [v] for v in (variables, inputs))
    p = [heyoka.par[i] for i in range(len(parameters))]
    names, places = Names(heyoka), 1024
    f = flat(module.rates(names, heyoka.time, variables, inputs, p))
    f = [entry if isinstance(entry, heyoka.expression) else heyoka.expression(float(entry)) for entry in f]
    numbers = numpy.random.default_rng(1)
    x = numpy.ascontiguousarray(
        numpy.concatenate([numpy.array(start)[:, None] + numbers.uniform(-0.05, 0.05, (len(start), places)),
                           numpy.full((len(inputs), places), 0.5)]))
    pars = numpy.ascontiguousarray(numpy.tile(numpy.array(parameters)[:, None], (1, places)))
    told = {}
    rates = heyoka.cfunc(f, vars=variables + inputs)
    out = numpy.zeros((len(f), places))
    told["rates"] = fastest(lambda: rates(inputs=x, pars=pars, outputs=out), places)
    jacobian = [heyoka.diff(e, v) for e in f for v in variables + inputs]
    both = heyoka.cfunc(f + jacobian, vars=variables + inputs)
    wide = numpy.zeros((len(f) + len(jacobian), places))
    told["rates, A, B"] = fastest(lambda: both(inputs=x, pars=pars, outputs=wide), places)
    free = flat(module.rates(names, heyoka.time, variables, [heyoka.expression(0.0)] * len(inputs), p))
    free = [entry if isinstance(entry, heyoka.expression) else heyoka.expression(float(entry)) for entry in free]

    def moved(tolerance):
        return heyoka.taylor_adaptive(list(zip(variables, free)), start, tol=tolerance, pars=parameters)

    exact = moved(1e-17)
    exact.propagate_until(SECONDS)
    told["motions"] = []
    for tolerance in (1e-9, 1e-12):
        ta = moved(tolerance)

        def run():
            ta.time = 0.0
            ta.state[:] = start
            ta.propagate_until(SECONDS)

        ns = fastest(run, 1, 40)
        told["motions"].append((tolerance, ns / 1e3, float(abs(ta.state - exact.state).max())))
    return told


def limited(function, *arguments, seconds=120):
    """What a function gives, or nothing where it takes longer."""
    results = multiprocessing.get_context("fork").Queue()
    process = multiprocessing.get_context("fork").Process(target=lambda: results.put(function(*arguments)))
    process.start()
    try:
        return results.get(timeout=seconds)
    except Exception:
        return None
    finally:
        process.terminate()


GCC = r"""
#include <math.h>
#include <stdio.h>
#include <time.h>
#define PLACES (1024 / N)
static double now(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return t.tv_sec * 1e9 + t.tv_nsec; }
static STATE x[PLACES] __attribute__((aligned(64)));
static INPUTS u; static PARAMETERS p; static RATES rates[PLACES]; static JACOBIANS
static const double start[] = {START}, given[] = {GIVEN};
int main(void) {
    unsigned seed = 1;
    double *all = (double *)x;
    const int n = sizeof(STATE) / sizeof(real);
    for (int i = 0; i < PLACES; i++) for (int k = 0; k < n; k++) for (int l = 0; l < N; l++) {
        seed = seed * 1664525u + 1013904223u;
        all[(i * n + k) * N + l] = start[k] + ((double)(seed >> 8) / (1 << 24) - 0.5) * 0.1;
    }
    for (unsigned k = 0; k < sizeof(PARAMETERS) / sizeof(double); k++) ((double *)&p)[k] = given[k / N];
    for (unsigned k = 0; k < sizeof(INPUTS) / sizeof(double); k++) ((double *)&u)[k] = 0.5;
    double best[2] = {1e30, 1e30};
    for (int round = 0; round < 400; round++) {
        double t = now();
        for (int i = 0; i < PLACES; i++) CALL_RATES;
        t = now() - t; if (t < best[0]) best[0] = t;
        t = now();
        for (int i = 0; i < PLACES; i++) CALL_JACOBIANS;
        t = now() - t; if (t < best[1]) best[1] = t;
    }
    printf("%f %f\n", best[0] / (PLACES * N), best[1] / (PLACES * N));
}
"""


def with_gcc(folder, name, module, parameters, start):
    """The emitted C with vectors in the place of numbers; nothing where it solves systems by pivoting."""
    header, source = ((folder / f"{name}.{ending}").read_text() for ending in "hc")
    body = source[source.index('#include "'):]
    used = "\n".join(re.search(rf"^void \w*_{kind}\(.*?^}}", body, re.S | re.M).group(0) for kind in ("rates", "jacobians"))
    if "solve" in used:
        return None
    wide = "avx512f" in Path("/proc/cpuinfo").read_text()
    count, prefix = (8, "_ZGVeN8v_") if wide else (4, "_ZGVdN4v_")
    prelude = (f"typedef double real __attribute__((vector_size({8 * count})));\n#define N {count}\n"
               + "".join(f"real {prefix}{f}(real);\n" for f in ("sin", "cos", "exp", "log")))
    text = re.sub(r"\bdouble\b", "real", header.replace("double t", "real t")) + "\n" + re.sub(r"\bdouble\b", "real", used)
    text = re.sub(r"const real (\w+) = (-?[\d.]+(?:e-?\d+)?(?: / [\d.]+)?);", r"const real \1 = (real){} + \2;", text)
    text = re.sub(r"\b(sin|cos|exp|log)\(", rf"{prefix}\1(", text)
    text = re.sub(r"#include <math.h>", "", text)
    kinds = dict(re.findall(r"\} (\w+?(State|Inputs|Parameters|Rates));", text))
    types = {kind: next(full for full, k in kinds.items() if k == kind and not full.endswith("CoordinateRates"))
             for kind in ("State", "Inputs", "Parameters", "Rates") if kind in kinds.values()}
    calls = {}
    outputs = []
    for kind in ("rates", "jacobians"):
        found = re.search(rf"void (\w*_{kind})\((.*?)\)", text, re.S)
        arguments = []
        for declared in found.group(2).split(","):
            declared = " ".join(declared.split())
            if declared == "real t":
                arguments.append("(real){}")
            elif "Parameters" in declared:
                arguments.append("&p")
            elif "State" in declared:
                arguments.append("&x[i]")
            elif "Inputs" in declared:
                arguments.append("&u")
            elif kind == "rates" or re.search(r"\*to_rates$", declared):
                arguments.append("&rates[i]")
            elif array := re.match(r"real \w+\[\]((?:\[\d+\])+)$", declared):
                # A and B: a row for each state.
                name_of = f"out{len(outputs)}"
                outputs.append(f"static real {name_of}[PLACES][{len(start)}]{array.group(1)};")
                arguments.append(f"{name_of}[i]")
            else:
                held = declared.split(" *")[0].replace("(", "").strip()
                name_of = f"out{len(outputs)}"
                outputs.append(f"static {held} {name_of}[PLACES];")
                arguments.append(f"&{name_of}[i]")
        calls[kind] = f"{found.group(1)}({', '.join(arguments)})"
    main = GCC.replace("static JACOBIANS", "\n".join(outputs)).replace("CALL_RATES", calls["rates"])
    main = main.replace("CALL_JACOBIANS", calls["jacobians"])
    for kind in ("State", "Inputs", "Parameters", "Rates"):
        main = main.replace(kind.upper(), types.get(kind, "struct {int none;}"))
    main = main.replace("{START}", "{" + ", ".join(map(repr, start)) + "}")
    main = main.replace("{GIVEN}", "{" + ", ".join(map(repr, parameters)) + "}")
    (folder / f"{name}_vectors.c").write_text(prelude + text + main)
    program = folder / f"{name}_vectors"
    built = subprocess.run(["gcc", "-O3", "-march=native", "-fno-math-errno", "-w", folder / f"{name}_vectors.c", "-o",
                            program, "-lmvec", "-lm"], capture_output=True, text=True)
    if built.returncode:
        print(f"gcc does not take {name}: {built.stderr.splitlines()[:3]}", file=sys.stderr)
        return None
    rates, both = map(float, subprocess.run([program], check=True, capture_output=True, text=True).stdout.split())
    return {"rates": rates, "rates, A, B": both}


def own(specs):
    """What `cargo bench` tells of our own code."""
    command = ["cargo", "bench", "-q", "-p", "appell-tests", "--bench", "lanes", "--", "--json", "--seconds", str(SECONDS)]
    told = subprocess.run(command + [str(spec) for spec in specs], check=True, capture_output=True, text=True, cwd=ROOT)
    return json.loads(told.stdout.splitlines()[-1])


def number(value):
    return "" if value is None else f"{value:.1f}"


def tables(appell):
    told = own(SPECS.values())
    lines = [f"{processor()}, {told['level']}, one core; heyoka {heyoka.__version__}, "
             f"gcc {subprocess.check_output(['gcc', '-dumpfullversion'], text=True).strip()}. Fastest of many rounds; "
             "empty where a peer takes no such system, or more than two minutes to prepare it.", "",
             "| ns a place, second cache | rates | gcc | heyoka | error | rates, A, B | gcc | heyoka | error |",
             "|---|---|---|---|---|---|---|---|---|"]
    motions = ["| one motion of 1 s | tolerance | µs | error | heyoka: tolerance | µs | error |", "|---|---|---|---|---|---|---|"]
    places = ["| ns a place | rates, first cache | from memory | copy, from memory | one place, own functions | standard |",
              "|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for mechanism, spec in zip(told["mechanisms"], SPECS.values()):
            module = emitted(appell, spec, folder)
            sample = mechanism["samples"][0]
            start = mechanism["start"]
            errors = limited(accuracy, module, mechanism["samples"][:4]) or [None, None]
            peers = limited(with_heyoka, module, sample["p"], start) or {"motions": []}
            gcc = with_gcc(folder, spec.stem, module, sample["p"], start) or {}
            rows = {(row["row"], row.get("where")): row.get("ns") for row in mechanism["rows"] if "ns" in row}
            cells = []
            for kind, error in zip(("rates", "rates, A, B"), errors):
                cells += [number(rows[f"{kind} in lanes", "L2"]), number(gcc.get(kind)), number(peers.get(kind)),
                          "" if error is None else f"{error:.0e}"]
            lines.append(f"| {spec.stem} | " + " | ".join(cells) + " |")
            places.append(f"| {spec.stem} | " + " | ".join(number(rows[key]) for key in (
                ("rates in lanes", "L1"), ("rates in lanes", "memory"), ("copy in lanes", "memory"),
                ("rates, one place, own functions", "L1"), ("rates, one place, standard functions", "L1"))) + " |")
            theirs = iter(peers["motions"])
            for row in mechanism["rows"]:
                if row["row"] != "motion":
                    continue
                cells = [spec.stem, f"{row['tolerance']:.0e}", number(row["us"]),
                         f"{row['error']:.0e}"]
                tolerance, us, error = next(theirs, (None, None, None))
                cells += [f"{tolerance:.0e}", number(us), f"{error:.0e}"] if tolerance else [""] * 3
                motions.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines + [""] + places + [""] + motions)


def processor():
    names = re.findall(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    return names[0] if names else "unknown processor"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--appell", required=True)
    parser.add_argument("--out", type=Path)
    asked = parser.parse_args()
    text = tables(asked.appell)
    print(text)
    if asked.out:
        document = asked.out.read_text()
        begin, end = "<!-- tables -->\n", "<!-- end of tables -->"
        document = document[: document.index(begin) + len(begin)] + text + "\n" + document[document.index(end):]
        asked.out.write_text(document)


if __name__ == "__main__":
    main()
