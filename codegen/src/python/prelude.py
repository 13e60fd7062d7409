import functools
import math


class _Namespace:
    """What the equations call, by the names that NumPy, JAX, CasADi and SymPy give it."""

    def __init__(self, xp):
        def first(*names):
            for name in names:
                if hasattr(xp, name):
                    return getattr(xp, name)

            def missing(*_):
                raise AttributeError(f"{xp!r} has none of {', '.join(names)}")

            return missing

        self.sin, self.cos = first("sin"), first("cos")
        self.asin = first("arcsin", "asin")
        self.acos = first("arccos", "acos")
        self.atan = first("arctan", "atan")
        self.atan2 = first("arctan2", "atan2")
        self.sinh, self.cosh, self.tanh = first("sinh"), first("cosh"), first("tanh")
        self.exp, self.log, self.sqrt = first("exp"), first("log"), first("sqrt")
        self.fabs, self.sign = first("fabs", "Abs", "abs"), first("sign")
        self.power = first("power", "Pow", "pow")
        self.pi = getattr(xp, "pi", math.pi)
        self.number = getattr(xp, "Rational", lambda n, d: n / d)
        self._xp = xp

    def where(self, condition, then, otherwise):
        xp = self._xp
        if hasattr(xp, "where"):
            return xp.where(condition, then, otherwise)
        if hasattr(xp, "if_else"):
            return xp.if_else(condition, then, otherwise)
        return xp.Piecewise((then, condition), (otherwise, True))

    def solve(self, rows, right):
        """The unknowns of a system of linear equations."""
        xp, n = self._xp, len(right)
        if hasattr(xp, "linalg"):
            flat = xp.broadcast_arrays(*[entry for row in rows for entry in row], *right)
            flat = [xp.asarray(entry, dtype=float) for entry in flat]
            matrix = xp.stack(flat[: n * n], axis=-1)
            matrix = matrix.reshape(matrix.shape[:-1] + (n, n))
            vector = xp.stack(flat[n * n :], axis=-1)[..., None]
            solved = xp.linalg.solve(matrix, vector)[..., 0]
            return [solved[..., k] for k in range(n)]
        if hasattr(xp, "Matrix"):
            return list(xp.Matrix(rows).LUsolve(xp.Matrix(right)))
        matrix = xp.vertcat(*[xp.horzcat(*row) for row in rows])
        return xp.vertsplit(xp.solve(matrix, xp.vertcat(*right)))


@functools.lru_cache(maxsize=None)
def _namespace(xp):
    return _Namespace(xp)
