"""Recursions of the peers in CasADi: Newton-Euler, composite bodies, articulated bodies, and their C."""

import casadi as ca
import numpy as np

import tree

SX = ca.SX
APART = (ca.OP_SIN, ca.OP_COS)
NOT_COUNTED = (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST)


def turned(axis, angle):
    """Rotation about an axis of the frame, forwards or backwards."""
    i = int(np.argmax(abs(axis)))
    j, k = (i + 1) % 3, (i + 2) % 3
    c, s = ca.cos(angle), ca.sin(angle) * float(axis[i])
    r = SX.eye(3)
    r[j, j] = r[k, k] = c
    r[j, k], r[k, j] = -s, s
    return r


def quaternion(q):
    w, x, y, z = ca.vertsplit(q)
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def symmetric(rotation, matrix):
    """R A R^T, each pair of equal entries once."""
    return mirrored(rotation @ matrix, rotation.T)


def mirrored(a, b):
    """A product that is known to be symmetric."""
    result = SX(3, 3)
    for i in range(3):
        for j in range(i, 3):
            result[i, j] = result[j, i] = ca.dot(a[i, :].T, b[:, j])
    return result


class Model:
    """The tree as symbols. Twists and forces of a link stand in its axes, at its origin: rotation, then translation."""

    def __init__(self, path, symbolic):
        symbols = {}
        made = tree.Tree(path, (lambda name: symbols.setdefault(name, SX.sym(name))) if symbolic else None)
        self.links, self.gravity = made.links, made.gravity
        self.parameters = ca.vertcat(*symbols.values()) if symbols else SX(0, 1)
        sizes = [6 if link.kind == "free" else 1 for link in self.links]
        starts = np.cumsum([0, *sizes])
        self.at = [slice(int(a), int(b)) for a, b in zip(starts, starts[1:])]
        n = int(starts[-1])
        self.v, self.a, self.tau = SX.sym("v", n), SX.sym("a", n), SX.sym("tau", n)
        self.q, rotations = [], []
        for link in self.links:
            self.q.append(SX.sym(link.name, (len(link.angles) or 4) if link.kind == "free" else 1))
            rotations.append(self.rotation(link, self.q[-1]))
        self.rotations = rotations
        self.subspaces = [self.subspace(link) for link in self.links]
        self.places = [
            ca.vertcat(*link.place) + (SX(link.rotation @ link.axis) * q if link.kind == "slide" else 0)
            for link, q in zip(self.links, self.q)
        ]
        self.inertias = [self.inertia(link) for link in self.links]

    @staticmethod
    def rotation(link, q):
        if link.kind == "slide":
            return SX(link.rotation)
        if link.kind == "turn":
            return SX(link.rotation) @ turned(link.axis, q)
        result = SX.eye(3) if link.angles else quaternion(q)
        for k, (axis, _) in enumerate(link.angles):
            result = result @ turned(axis, q[k])
        return result

    @staticmethod
    def subspace(link):
        if link.kind == "free":
            return SX.eye(6)
        zero = np.zeros(3)
        return SX(np.concatenate([link.axis, zero] if link.kind == "turn" else [zero, link.axis]))

    @staticmethod
    def inertia(link):
        """Moments about the origin of the link, first moments, mass."""
        if link.inertia is None:
            return SX(3, 3), SX(3, 1), SX(0)
        mass, centre = SX(link.mass), ca.vertcat(*map(SX, link.centre))
        lever = ca.skew(centre)
        moments = ca.vertcat(*(ca.horzcat(*map(SX, row)) for row in link.inertia))
        return moments - mass * mirrored(lever, lever), mass * centre, mass

    def momentum(self, i, twist):
        moments, first, mass = self.inertias[i]
        w, v = twist[:3], twist[3:]
        return ca.vertcat(moments @ w + ca.cross(first, v), mass * v + ca.cross(w, first))

    def to_child(self, i, twist):
        back = self.rotations[i].T
        return ca.vertcat(back @ twist[:3], back @ (twist[3:] + ca.cross(twist[:3], self.places[i])))

    def to_parent(self, i, force):
        turned_force = self.rotations[i] @ force[3:]
        return ca.vertcat(self.rotations[i] @ force[:3] + ca.cross(self.places[i], turned_force), turned_force)

    def velocities(self):
        """Twists, what velocities alone accelerate, and the forces that this takes."""
        twists, biases, forces = [], [], []
        for i, link in enumerate(self.links):
            own = self.subspaces[i] @ self.v[self.at[i]]
            twist = own if link.parent < 0 else self.to_child(i, twists[link.parent]) + own
            twists.append(twist)
            w, v = twist[:3], twist[3:]
            bias = ca.vertcat(ca.cross(w, own[:3]), ca.cross(v, own[:3]) + ca.cross(w, own[3:]))
            biases.append(SX(6, 1) if link.parent < 0 else bias)
            p = self.momentum(i, twist)
            forces.append(ca.vertcat(ca.cross(w, p[:3]) + ca.cross(v, p[3:]), ca.cross(w, p[3:])))
        return twists, biases, forces

    def base(self):
        return ca.vertcat(SX(3, 1), SX(2, 1), SX(self.gravity))

    def inverse_dynamics(self, accelerations):
        _, biases, forces = self.velocities()
        moved = []
        for i, link in enumerate(self.links):
            before = self.base() if link.parent < 0 else moved[link.parent]
            moved.append(self.to_child(i, before) + biases[i] + self.subspaces[i] @ accelerations[self.at[i]])
            forces[i] += self.momentum(i, moved[i])
        torques = [None] * len(self.links)
        for i in reversed(range(len(self.links))):
            torques[i] = self.subspaces[i].T @ forces[i]
            if self.links[i].parent >= 0:
                forces[self.links[i].parent] += self.to_parent(i, forces[i])
        return ca.vertcat(*torques)

    def mass_matrix(self):
        composite = list(self.inertias)
        mass = SX(self.v.numel(), self.v.numel())
        for i in reversed(range(len(self.links))):
            moments, first, m = composite[i]
            angular, linear = self.subspaces[i][:3, :], self.subspaces[i][3:, :]
            force = ca.vertcat(moments @ angular + ca.skew(first) @ linear, m * linear - ca.skew(first) @ angular)
            mass[self.at[i], self.at[i]] = self.subspaces[i].T @ force
            j = i
            while self.links[j].parent >= 0:
                force = self.to_parent(j, force)
                j = self.links[j].parent
                mass[self.at[j], self.at[i]] = self.subspaces[j].T @ force
                mass[self.at[i], self.at[j]] = mass[self.at[j], self.at[i]].T
            if self.links[i].parent >= 0:
                r, lever = self.rotations[i], ca.skew(self.places[i])
                turned_first = r @ first
                cross = lever @ ca.skew(turned_first)
                shift = cross + cross.T + m * mirrored(lever, lever)
                old = composite[self.links[i].parent]
                composite[self.links[i].parent] = (
                    old[0] + symmetric(r, moments) - shift, old[1] + turned_first + m * self.places[i], old[2] + m)
        return mass

    def forward_dynamics(self):
        """Articulated bodies, their inertias as three blocks: angular, coupling, linear."""
        _, biases, forces = self.velocities()
        inertias = [[moments, ca.skew(first), mass * SX.eye(3)] for moments, first, mass in self.inertias]
        columns, pivots, rests = ([None] * len(self.links) for _ in range(3))
        for i in reversed(range(len(self.links))):
            s, parent = self.subspaces[i], self.links[i].parent
            angular, coupling, linear = inertias[i]
            if self.links[i].kind == "free":
                continue
            columns[i] = ca.vertcat(angular @ s[:3] + coupling @ s[3:], coupling.T @ s[:3] + linear @ s[3:])
            pivots[i] = 1 / ca.dot(s, columns[i])
            rests[i] = self.tau[self.at[i]] - ca.dot(s, forces[i])
            if parent < 0:
                continue
            n, f = columns[i][:3], columns[i][3:]
            scaled = columns[i] * pivots[i]
            angular = angular - mirrored(n, scaled[:3].T)
            coupling = coupling - n @ scaled[3:].T
            linear = linear - mirrored(f, scaled[3:].T)
            bias = biases[i]
            force = forces[i] + ca.vertcat(
                angular @ bias[:3] + coupling @ bias[3:], coupling.T @ bias[:3] + linear @ bias[3:]) + scaled * rests[i]
            forces[parent] += self.to_parent(i, force)
            r, lever = self.rotations[i], ca.skew(self.places[i])
            coupling, linear = r @ coupling @ r.T, symmetric(r, linear)
            moved = coupling + lever @ linear
            half = lever @ coupling.T
            shifted = symmetric(r, angular) + half - moved @ lever
            inertias[parent][0] += mirrored(shifted, SX.eye(3))
            inertias[parent][1] = inertias[parent][1] + moved
            inertias[parent][2] = inertias[parent][2] + linear
        accelerations, moved = [], []
        for i, link in enumerate(self.links):
            before = self.to_child(i, self.base() if link.parent < 0 else moved[link.parent]) + biases[i]
            if link.kind == "free":
                angular, coupling, linear = inertias[i]
                whole = ca.vertcat(ca.horzcat(angular, coupling), ca.horzcat(coupling.T, linear))
                moved.append(solved(whole, self.tau[self.at[i]] - forces[i]))
                accelerations.append(moved[-1] - before)
            else:
                accelerations.append((rests[i] - ca.dot(columns[i], before)) * pivots[i])
                moved.append(before + self.subspaces[i] * accelerations[-1])
        return ca.vertcat(*accelerations)


def solved(matrix, right):
    """L D L^T of a symmetric matrix."""
    n = matrix.shape[0]
    low, pivots, x = SX.eye(n), [], [right[i] for i in range(n)]
    scaled = SX(n, n)
    for j in range(n):
        pivots.append(matrix[j, j] - sum(low[j, k] * scaled[j, k] for k in range(j)))
        for i in range(j + 1, n):
            scaled[i, j] = matrix[i, j] - sum(scaled[i, k] * low[j, k] for k in range(j))
            low[i, j] = scaled[i, j] / pivots[j]
    for i in range(n):
        x[i] -= sum(low[i, k] * x[k] for k in range(i))
    x = [value / pivot for value, pivot in zip(x, pivots)]
    for i in reversed(range(n)):
        x[i] -= sum(low[k, i] * x[k] for k in range(i + 1, n))
    return ca.vertcat(*x)


def functions(path, symbolic, jacobian):
    """By its name, each function with shared subexpressions."""
    model = Model(path, symbolic)
    q = ca.vertcat(*model.q)
    driven, moved = ([q, model.v, last, model.parameters] for last in (model.tau, model.a))
    demand = model.inverse_dynamics(model.a)
    rates = model.forward_dynamics()
    wanted = {
        "mass_matrix_and_bias": [model.mass_matrix(), model.inverse_dynamics(SX(model.v.numel(), 1))],
        "rates": [rates],
        "inverse_dynamics": [demand],
    }
    if jacobian:
        wanted["inverse_dynamics_jacobians"] = [demand, ca.jacobian(demand, ca.vertcat(q, model.v))]
        wanted["jacobians"] = [rates, ca.jacobian(rates, ca.vertcat(q, model.v, model.tau))]
    return {
        name: ca.Function(name, moved if name.startswith("inverse") else driven, ca.cse(results))
        for name, results in wanted.items()
    }


def operations(function):
    """Operations, and sines and cosines apart."""
    kinds = [function.instruction_id(k) for k in range(function.n_instructions())]
    apart = sum(kind in APART for kind in kinds)
    return sum(kind not in NOT_COUNTED for kind in kinds) - apart, apart


def source(function, name, folder):
    """The C of a function behind the calling convention of measure.cpp; its results and where they stand."""
    path = folder / f"{name}.c"
    code = ca.CodeGenerator(f"{name}_inner.c", {"with_header": False})
    code.add(ca.Function(f"{name}_inner", function.sx_in(), function.call(function.sx_in())))
    starts = np.cumsum([0, *(function.nnz_in(k) for k in range(function.n_in()))])
    ends = np.cumsum([0, *(function.nnz_out(k) for k in range(function.n_out()))])
    arguments = ", ".join(f"x + {start}" for start in starts[:-1])
    results = ", ".join(f"out + {start}" for start in ends[:-1])
    text = f"""{code.dump()}
void {name}(const double *x, double *out) {{
    static double work[{max(1, function.sz_w())}];
    const double *arguments[{function.sz_arg()}] = {{{arguments}}};
    double *results[{function.sz_res()}] = {{{results}}};
    {name}_inner(arguments, results, 0, work, 0);
}}
"""
    path.write_text(text)
    last = function.sparsity_out(function.n_out() - 1)
    return {"source": path, "size": int(ends[-1]), "places": (last.row(), last.get_col())}
