"""Kernels by CasADi: expression graph, algorithmic differentiation, common sub-expressions, C."""

import json
import os
import sys
import time

import casadi as ca

import mechanisms


class Package:
    """CasADi's scalar graph; what is named is shared by itself."""

    sin, cos, sqrt = staticmethod(ca.sin), staticmethod(ca.cos), staticmethod(ca.sqrt)

    def __init__(self):
        self.defined = []

    @staticmethod
    def diff(expr, symbol):
        return ca.jacobian(ca.SX(expr), symbol)

    @staticmethod
    def symbols(names):
        return [ca.SX.sym(name) for name in names.split()]

    @staticmethod
    def let(expr):
        return expr

    def define(self, symbol, expr):
        self.defined.append((symbol, expr))

    @staticmethod
    def solve2(a, b, d, r, s):
        determinant = a * d - b * b
        return [(d * r - b * s) / determinant, (a * s - b * r) / determinant]

    @staticmethod
    def solve(matrix, right):
        matrix = ca.vertcat(*(ca.horzcat(*row) for row in matrix))
        return ca.vertsplit(ca.mtimes(ca.inv_minor(matrix), ca.vertcat(*right)))

    @staticmethod
    def inverse3(matrix):
        inverse = ca.inv_minor(ca.vertcat(*(ca.horzcat(*row) for row in matrix)))
        return [[inverse[i, j] for j in range(3)] for i in range(3)]


def build(kernel):
    mechanism, kind = kernel.split("_")[:2]
    n, m, k = mechanisms.SIZES[mechanism]
    x, u, p = (ca.SX.sym(a, count) for a, count in (("x", n), ("u", m), ("p", k)))
    package = Package()
    results = getattr(mechanisms, mechanism)(package, *(ca.vertsplit(v) for v in (x, u, p)))
    if kind == "equations":
        results = [e for row in results[0] for e in row] + results[1]
    elif mechanism == "bicycle":
        results = results[2]
    results = ca.vertcat(*results)
    for symbol, expr in package.defined:
        results = ca.substitute(results, symbol, expr)
    parts = [results]
    if kind in ("jacobians", "state"):
        # Transposed, because CasADi stores by columns.
        parts.append(ca.jacobian(results, ca.vertcat(x, u)).T)
    if kind == "parameters":
        # Together and forward: fewer operations than in reverse, and than A, B and P by themselves.
        whole = ca.jacobian(results, ca.vertcat(x, u, p), {"allow_reverse": False})
        parts += [whole[:, :n + m].T, whole[:, n + m:].T]
    function = ca.Function(f"cas_{kernel}", [x, u, p], ca.cse(parts))
    function.generate(f"cas_{kernel}.c", {"with_header": False})
    with open(f"cas_{kernel}.c") as file:
        code = file.read()
    os.remove(f"cas_{kernel}.c")
    places, results, slots, start = [], [], 0, 0
    for index in range(function.n_out()):
        sparsity = function.sparsity_out(index)
        rows, columns = sparsity.get_triplet()
        places += [start + column * sparsity.rows() + row for row, column in zip(rows, columns)]
        start += sparsity.numel()
        results.append(f"out + {slots}")
        slots += sparsity.nnz()
    code += (f"\nvoid casadi_{kernel}(const double *x, const double *u, const double *p, double *out) {{\n"
             f"const double *a[3] = {{x, u, p}};\ndouble *r[{len(results)}] = {{{', '.join(results)}}};\n"
             f"long long iw[8];\ndouble w[{max(1, function.sz_w())}];\n"
             f"cas_{kernel}(a, r, iw, w, 0);\n}}\n")
    count = function.n_instructions() - function.nnz_in() - function.nnz_out()
    return code, count, places


if __name__ == "__main__":
    folder, repetitions = sys.argv[1], int(sys.argv[2])
    os.chdir(folder)
    told = {"version": ca.__version__}
    for kernel in mechanisms.KERNELS:
        best = float("inf")
        for _ in range(repetitions):
            start = time.perf_counter()
            code, operations, places = build(kernel)
            best = min(best, time.perf_counter() - start)
        with open(f"casadi_{kernel}.c", "w") as file:
            file.write(code)
        told[kernel] = {"seconds": best, "operations": operations, "places": places}
        print(f"  casadi {kernel}: {best:.3f} s, {operations} operations", flush=True)
    with open("casadi.json", "w") as file:
        json.dump(told, file)
