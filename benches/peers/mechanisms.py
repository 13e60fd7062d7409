"""The mechanisms of the comparison, for any package that multiplies, adds and differentiates.

Velocities are written in moving frames, as an engineer writes them for Kane's method: partial
velocities are derivatives by the speeds, accelerations are derivatives along the motion. State, inputs
and parameters stand in the order of appell's specs.
"""

KERNELS = {
    "unicycle_rates": "unicycle: rates",
    "unicycle_jacobians": "unicycle: rates, A, B",
    "euc_rates": "EUC: rates",
    "euc_jacobians": "EUC: rates, A, B",
    "bicycle_equations": "bicycle: M, bias",
    "bicycle_state": "bicycle: rates, A, B",
    "bicycle_parameters": "bicycle: rates, A, B, P",
}
SIZES = {  # state, inputs, parameters
    "unicycle": (10, 1, 4),
    "euc": (6, 2, 11),
    "bicycle": (11, 2, 26),
}
PARAMETERS = {
    "unicycle": (10, 5, 0.3, 9.81),
    "euc": (65, 13, 3, 16.6, 0.5, 0.12, 0.2, 0.61, 0.075, 0.05, 9.81),
    "bicycle": (1.02, 0.08, 0.3141592653589793, 9.81, 0.3, 2, 0.0603, 0.12, 0.3, -0.9, 85, 9.2, 11, 2.8,
                2.4, 0.9, -0.7, 4, 0.05892, 0.06, 0.00708, -0.00756, 0.35, 3, 0.1405, 0.28),
}
# Half widths of random states and inputs.
SPREAD = {
    "unicycle": ((1, 5, 1, 1, 1, 1, 3, 1, 3, 0.3), (10,)),
    "euc": ((2, 1, 1, 1, 0.5, 0.5), (20, 20)),
    "bicycle": ((1, 1, 10, 1, 1, 3, 0.5, 0.3, 0.5, 3, 3), (5, 5)),
}


def outputs(kernel):
    """How many numbers a kernel writes."""
    n, m, k = SIZES[kernel.split("_")[0]]
    kind = kernel.split("_")[1]
    return {"rates": n, "jacobians": n + n * (n + m), "equations": 12,
            "state": n + n * (n + m), "parameters": n + n * (n + m) + n * k}[kind]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def scale(s, a):
    return [s * x for x in a]


class Body:
    """A body in a frame that turns with `turning`: velocity, force, and of a rigid one angular velocity,
    angular momentum and torque."""

    def __init__(self, mass, turning, velocity, force, spin=None, momentum=None, torque=None):
        self.mass, self.turning, self.velocity, self.force = mass, turning, velocity, force
        self.spin, self.momentum, self.torque = spin, momentum, torque


def kane(package, bodies, speeds, motion):
    """M and (forces, bias) of Kane's equations; `motion` are pairs of coordinates and rates."""
    diff = package.diff

    def along(vector):
        return [sum(diff(c, q) * rate for q, rate in motion) for c in vector]

    count = range(len(speeds))
    mass = [[0 for _ in count] for _ in count]
    forces, bias = [0 for _ in count], [0 for _ in count]
    for body in bodies:
        partial = [[diff(c, s) for c in body.velocity] for s in speeds]
        inertial = add(along(body.velocity), cross(body.turning, body.velocity))
        for i in count:
            forces[i] += dot(partial[i], body.force)
            bias[i] += body.mass * dot(partial[i], inertial)
            for j in count:
                mass[i][j] += body.mass * dot(partial[i], partial[j])
        if body.spin is None:
            continue
        turns = [[diff(c, s) for c in body.spin] for s in speeds]
        momenta = [[diff(c, s) for c in body.momentum] for s in speeds]
        rate = add(along(body.momentum), cross(body.turning, body.momentum))
        for i in count:
            forces[i] += dot(turns[i], body.torque)
            bias[i] += dot(turns[i], rate)
            for j in count:
                mass[i][j] += dot(turns[i], momenta[j])
    return mass, forces, bias


def unicycle(package, x, u, p):
    w1, w2, w3, s, _, _, psi, theta, _, r = x
    m, m0, R, g = p
    sin, cos = package.sin(theta), package.cos(theta)
    tan = sin / cos
    turning = [w1, w3 * tan, w3]
    spin = [w1, w2, w3]
    v_G = [R * w2, -R * w1, 0]
    v_A = add(add(v_G, [0, s, 0]), cross(turning, [0, r, 0]))
    momentum = [m * R**2 / 4 * w1, m * R**2 / 2 * w2, m * R**2 / 4 * w3]
    bodies = [
        Body(m, turning, v_G, [0, -u[0] - m * g * sin, -m * g * cos], spin, momentum, [0, 0, 0]),
        Body(m0, turning, v_A, [0, u[0] - m0 * g * sin, -m0 * g * cos]),
    ]
    mass, forces, bias = kane(package, bodies, [w1, w2, w3, s], [(theta, w1), (r, s)])
    right = [f - b for f, b in zip(forces, bias)]
    a = [None] * 4
    for i, j in ((0, 3), (1, 2)):  # no other entries couple
        a[i], a[j] = package.solve2(mass[i][i], mass[i][j], mass[j][j], right[i], right[j])
    sp, cp = package.sin(psi), package.cos(psi)
    return a + [w1 * R * sp * cos + w2 * R * cp, -w1 * R * cp * cos + w2 * R * sp, w3 / cos, w1,
                w2 - w3 * tan, s]


def unicycle_by_hand(package, x, u, p):
    """Equations (36) and (86) of the steering paper; σ' by the shorter of two relations."""
    w1, w2, w3, s, _, _, psi, theta, _, r = x
    m, m0, R, g = p
    u = u[0]
    sin, cos = package.sin(theta), package.cos(theta)
    tan = sin / cos
    d1 = 5 * m * R**2 + 4 * m0 * r**2
    d2 = 3 * m * R**2 + 2 * m0 * R**2 + 12 * m0 * r**2
    a1 = (4 * m0 * R * r * w1**2 - (m * R**2 + 4 * m0 * r**2) * tan * w3**2 - 8 * m0 * r * w1 * s
          + 2 * R * (3 * m * R + 2 * m0 * r * tan) * w2 * w3 - 4 * m0 * g * r * cos + 4 * m * g * R * sin
          + 4 * R * u) / d1
    a2 = 2 * (-2 * m0 * R * r * w1 * w2 - (m * R**2 + m0 * R**2 + 4 * m0 * r**2) * w1 * w3
              + 2 * m0 * R * w3 * s) / d2
    a3 = (-2 * (3 * m + 2 * m0) * R**2 * w1 * w2
          + (3 * m * R**2 * tan + 2 * m0 * (R**2 * tan + 2 * R * r + 6 * r**2 * tan)) * w1 * w3
          - 24 * m0 * r * w3 * s) / d2
    a4 = R * a1 + r * w1**2 - R * w2 * w3 + r * w3**2 - g * sin + u / m0
    sp, cp = package.sin(psi), package.cos(psi)
    return [a1, a2, a3, a4, w1 * R * sp * cos + w2 * R * cp, -w1 * R * cp * cos + w2 * R * sp, w3 / cos, w1,
            w2 - w3 * tan, s]


def euc(package, x, u, p):
    v, dg, df, _, gamma, phi = x
    m, m0, mw, J, J0, Jw, R, h, h0, l0, g = p
    sg, cg, sf, cf = (f(a) for a in (gamma, phi) for f in (package.sin, package.cos))
    v_A = [v - l0 * cg * dg, 0, l0 * sg * dg]
    still = [0, 0, 0]

    def spin(w):
        return [0, w, 0]

    bodies = [
        Body(mw, still, [v, 0, 0], [0, 0, 0], spin(v / R), spin(Jw * v / R), spin(u[0])),
        Body(m0, still, [v + h0 * cg * dg, 0, -h0 * sg * dg], [0, 0, -m0 * g], spin(dg), spin(J0 * dg),
             spin(u[1] - u[0])),
        Body(m, still, add(v_A, [h * cf * df, 0, -h * sf * df]), [0, 0, -m * g], spin(df), spin(J * df),
             spin(-u[1])),
    ]
    mass, forces, bias = kane(package, bodies, [v, dg, df], [(gamma, dg), (phi, df)])
    return package.solve(mass, [f - b for f, b in zip(forces, bias)]) + [v, dg, df]


def bicycle(package, x, u, p):
    """(M, bias, rates) of the Whipple-Carvallo bicycle; lean, steer and rear wheel are independent."""
    wf, wd, wR, _, _, psi, phi, theta, delta, _, _ = x
    (w, c, lam, g, rR, mR, IRx, IRy, xB, zB, mB, IBx, IBy, IBz, IBxz, xH, zH, mH, IHx, IHy, IHz, IHxz, rF, mF,
     IFx, IFy) = p
    sin, cos = package.sin, package.cos
    dpsi, dtheta, dF = package.symbols("dpsi dtheta dF")
    speeds = [wf, wd, wR, dpsi, dtheta, dF]
    motion = [(phi, wf), (theta, dtheta), (delta, wd)]

    def about_y(s, c, v):
        return [c * v[0] - s * v[2], v[1], s * v[0] + c * v[2]]

    sf, cf, st, ct, sd, cd = (f(a) for a in (phi, theta, delta) for f in (sin, cos))
    sl, cl = sin(lam), cos(lam)
    w_L = [wf, dpsi * sf, dpsi * cf]
    w_W = add(w_L, [0, dtheta + wR, 0])
    v_R = cross(w_W, [0, 0, -rR])
    w_B = about_y(st, ct, add(w_L, [0, dtheta, 0]))
    v_R_B = about_y(st, ct, v_R)
    down = about_y(st, ct, [0, sf, cf])
    v_B = add(v_R_B, cross(w_B, [xB, 0, zB + rR]))
    v_S = add(v_R_B, cross(w_B, [w + c, 0, rR]))

    def to_steered(v):
        v = about_y(sl, cl, v)
        return [cd * v[0] + sd * v[1], cd * v[1] - sd * v[0], v[2]]

    w_S = add(to_steered(w_B), [0, 0, wd])
    w_H, v_S, down_H = (about_y(-sl, cl, v) for v in (w_S, to_steered(v_S), to_steered(down)))
    v_H = add(v_S, cross(w_H, [xH - w - c, 0, zH]))
    v_F = add(v_S, cross(w_H, [-c, 0, -rF]))
    w_F = add(w_H, [0, dF, 0])
    # The rear wheel is axisymmetric: the leaned frame does as well as the rear frame.
    bodies = [
        Body(mR, w_L, v_R, scale(mR * g, [0, sf, cf]), w_W, [IRx * w_W[0], IRy * w_W[1], IRx * w_W[2]],
             [0, 0, 0]),
        Body(mB, w_B, v_B, scale(mB * g, down), w_B,
             [IBx * w_B[0] + IBxz * w_B[2], IBy * w_B[1], IBxz * w_B[0] + IBz * w_B[2]], [0, 0, 0]),
        Body(mH, w_H, v_H, scale(mH * g, down_H), w_H,
             [IHx * w_H[0] + IHxz * w_H[2], IHy * w_H[1], IHxz * w_H[0] + IHz * w_H[2]], [0, 0, 0]),
        Body(mF, w_H, v_F, scale(mF * g, down_H), w_F, [IFx * w_F[0], IFy * w_F[1], IFx * w_F[2]], [0, 0, 0]),
    ]
    mass, forces, bias = kane(package, bodies, speeds, motion)
    # The front wheel touches with its lowest point, which rests.
    low = to_steered(down)
    size = package.sqrt(low[0]**2 + low[2]**2)
    arm = [rF * low[0] / size, 0, rF * low[2] / size]
    steered = add([cl * v_F[0] - sl * v_F[2], v_F[1], sl * v_F[0] + cl * v_F[2]],
                  cross(add(w_S, [0, dF, 0]), arm))
    rows = [[package.let(package.diff(row, s)) for s in speeds] for row in steered]
    drift = [package.let(sum(package.diff(row, q) * rate for q, rate in motion)) for row in steered]
    inverse = package.inverse3([row[3:] for row in rows])
    W = [[package.let(-sum(inverse[i][k] * rows[k][j] for k in range(3))) for j in range(3)] for i in range(3)]
    for i, speed in enumerate((dpsi, dtheta, dF)):
        package.define(speed, dot(W[i], [wf, wd, wR]))
    rest = [package.let(-dot(inverse[i], drift)) for i in range(3)]
    mass = [[package.let(mass[i][j]) for j in range(6)] for i in range(6)]
    total = [package.let(bias[i] + sum(mass[i][3 + k] * rest[k] for k in range(3))) for i in range(6)]
    pull = [package.let(f) for f in forces]

    def reduce(v, i):
        return v[i] + sum(W[k][i] * v[3 + k] for k in range(3))

    columns = [[reduce(row, j) for j in range(3)] for row in mass]
    M = [[reduce([package.let(row[j]) for row in columns], i) for j in range(3)] for i in range(3)]
    b = [reduce(total, i) for i in range(3)]
    right = [reduce(pull, i) - b[i] for i in range(3)]
    right[0] += u[0]
    right[1] += u[1]
    forward = -rR * (dtheta + wR)
    rates = package.solve(M, right) + [forward * cos(psi), forward * sin(psi), dpsi, wf, dtheta, wd, wR, dF]
    return M, b, rates
