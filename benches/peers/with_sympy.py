"""Kernels by SymPy: expressions, common sub-expressions, C."""

import json
import sys
import time

import sympy as sm
from sympy.codegen.rewriting import create_expand_pow_optimization

import mechanisms

POWERS = create_expand_pow_optimization(8)


class Package:
    """SymPy with intermediate symbols, as its users name what they want to keep small."""

    sin, cos, sqrt = staticmethod(sm.sin), staticmethod(sm.cos), staticmethod(sm.sqrt)

    def __init__(self):
        self.lets = []

    @staticmethod
    def diff(expr, symbol):
        return sm.diff(expr, symbol)

    @staticmethod
    def symbols(names):
        return sm.symbols(names)

    def let(self, expr):
        expr = sm.sympify(expr)
        if expr.is_Atom:
            return expr
        symbol = sm.Symbol(f"let{len(self.lets)}")
        self.define(symbol, expr)
        return symbol

    def define(self, symbol, expr):
        self.lets.append((symbol, sm.sympify(expr)))

    @staticmethod
    def solve2(a, b, d, r, s):
        return list(sm.Matrix([[a, b], [b, d]]).LUsolve(sm.Matrix([r, s])))

    @staticmethod
    def solve(matrix, right):
        return list(sm.Matrix(matrix).LUsolve(sm.Matrix(right)))

    def inverse3(self, matrix):
        adjugate = sm.Matrix(matrix).adjugate()
        factor = self.let(1 / sm.Matrix(matrix).det())
        return [[self.let(adjugate[i, j] * factor) for j in range(3)] for i in range(3)]


def in_order(pairs):
    """Definitions, each after those that it uses."""
    known, done, result = dict(pairs), set(), []

    def visit(symbol):
        if symbol in done or symbol not in known:
            return
        done.add(symbol)
        for part in sorted(known[symbol].free_symbols, key=str):
            visit(part)
        result.append((symbol, known[symbol]))

    for symbol, _ in pairs:
        visit(symbol)
    return result


def shared(lets, outputs):
    """Common sub-expressions of everything."""
    names = sm.numbered_symbols("c_")
    pairs, reduced = sm.cse([e for _, e in lets] + list(outputs), symbols=names, order="canonical")
    pairs += [(symbol, e) for (symbol, _), e in zip(lets, reduced)]
    return in_order(pairs), reduced[len(lets):]


def forward(lets, outputs, inputs):
    """Outputs and their Jacobian, differentiated along the shared sub-expressions."""
    pairs, outputs = shared(lets, outputs)
    slopes = {x: {x: sm.Integer(1)} for x in inputs}
    names = sm.numbered_symbols("d_")
    body = []

    def differentiate(expr):
        slope = {}
        for part in expr.free_symbols & slopes.keys():
            own = sm.diff(expr, part)
            for x, chain in slopes[part].items():
                slope[x] = slope.get(x, 0) + own * chain
        return slope

    for symbol, expr in pairs:
        body.append((symbol, expr))
        slopes[symbol] = {}
        for x, value in differentiate(expr).items():
            if value.is_Atom:
                slopes[symbol][x] = value
            elif value != 0:
                name = next(names)
                body.append((name, value))
                slopes[symbol][x] = name
    rows = [differentiate(expr) for expr in outputs]
    entries = [sm.sympify(row.get(x, 0)) for row in rows for x in inputs]
    return shared(body, list(outputs) + entries)


def write(name, pairs, outputs, x, u, p):
    """C, and the operations in it."""
    places = {s: sm.Symbol(f"{a}[{i}]") for a, all_ in (("x", x), ("u", u), ("p", p)) for i, s in enumerate(all_)}

    def c(expr):
        return sm.ccode(POWERS(expr).xreplace(places))

    lines = ["#include <math.h>", f"void sympy_{name}(const double *restrict x, const double *restrict u, "
             "const double *restrict p, double *restrict out) {"]
    lines += [f"const double {symbol} = {c(expr)};" for symbol, expr in pairs]
    lines += [f"out[{i}] = {c(expr)};" for i, expr in enumerate(outputs)]
    everything = [e for _, e in pairs] + list(outputs)
    return "\n".join(lines + ["}", ""]), int(sum(sm.count_ops(POWERS(e)) for e in everything))


def build(kernel):
    mechanism, kind = kernel.split("_")[:2]
    n, m, k = mechanisms.SIZES[mechanism]
    x, u, p = (sm.symbols(f"{a}0:{count}", real=True) for a, count in (("x", n), ("u", m), ("p", k)))
    package = Package()
    if kernel.endswith("hand"):
        results = mechanisms.unicycle_by_hand(package, x, u, p)
    else:
        results = getattr(mechanisms, mechanism)(package, x, u, p)
    if kind == "equations":
        results = [e for row in results[0] for e in row] + results[1]
    results = [sm.sympify(e) for e in results]
    if kind == "jacobians":
        pairs, outputs = forward(package.lets, results, list(x) + list(u))
    else:
        used = set().union(*(e.free_symbols for e in results))
        for symbol, expr in reversed(package.lets):
            if symbol in used:
                used |= expr.free_symbols
        lets = [(symbol, expr) for symbol, expr in package.lets if symbol in used]
        pairs, outputs = shared(lets, results)
    return write(kernel, pairs, outputs, x, u, p)


if __name__ == "__main__":
    folder, repetitions = sys.argv[1], int(sys.argv[2])
    told = {"version": sm.__version__}
    for kernel in ("unicycle_rates", "unicycle_jacobians", "unicycle_jacobians_hand", "euc_rates",
                   "euc_jacobians", "bicycle_equations"):
        best = float("inf")
        for _ in range(repetitions):
            sm.core.cache.clear_cache()
            start = time.perf_counter()
            code, operations = build(kernel)
            best = min(best, time.perf_counter() - start)
        with open(f"{folder}/sympy_{kernel}.c", "w") as file:
            file.write(code)
        told[kernel] = {"seconds": best, "operations": operations}
        print(f"  sympy {kernel}: {best:.3f} s, {operations} operations", flush=True)
    with open(f"{folder}/sympy.json", "w") as file:
        json.dump(told, file)
