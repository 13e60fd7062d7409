"""States of a robot in the layout of each tool, and what the tools return in the layout of Pinocchio."""

import sys

import numpy as np

# Largest difference between tools, relative to the largest entry: rounding, and the condition of the mass matrix.
AGREE = 1e-9


class Robot:
    """Layouts: appell has velocities (a free base: along the ground, then of rotation along itself) before coordinates,
    CasADi and Pinocchio have velocities of the base along itself, CasADi those of rotation first."""

    def __init__(self, name, made, states):
        self.name = name
        self.free = made.links[0].kind == "free"
        joints = [link.name for link in made.links if link.kind != "free"]
        assert joints == made.coordinates[7 if self.free else 0:], "links stand in the order of the coordinates"
        n = len(joints)
        draw = np.random.default_rng(1)
        q, v, tau = (draw.uniform(-1, 1, (states, n)) for _ in range(3))
        self.speeds, self.inputs = n, n
        self.states = n
        self.rows = dict.fromkeys(("casadi", "pinocchio"), np.hstack([q, v, tau]))
        if not self.free:
            self.rows["appell"] = np.hstack([v, q, tau])
            return
        self.speeds, self.states = n + 6, n + 7
        place, linear, angular = (draw.uniform(-1, 1, (states, 3)) for _ in range(3))
        turn = draw.normal(size=(states, 4))
        turn /= np.linalg.norm(turn, axis=1, keepdims=True)
        none = np.zeros((states, 6))
        self.turns, self.linear, self.angular = [rotation(row) for row in turn], linear, angular
        self.quaternions = turn
        along = np.array([r @ v for r, v in zip(self.turns, linear)])
        self.rows["appell"] = np.hstack([along, angular, v, place, turn, q, tau])
        self.rows["casadi"] = np.hstack([turn, q, angular, linear, v, none, tau])
        self.rows["pinocchio"] = np.hstack([place, turn[:, 1:], turn[:, :1], q, linear, angular, v, none, tau])

    def size(self, tool, function):
        """How many numbers a function returns, where it returns all entries."""
        n, all_states = self.speeds, self.speeds + self.states
        if tool == "appell":
            return all_states * (1 if function == "rates" else 1 + all_states + self.inputs)
        return n if function == "rates" else n * (1 + 3 * n)

    def same(self, tool, values, state, places):
        """Accelerations, and where given their derivatives by configuration, velocity and torque of joints."""
        return self.of_appell(values, state) if tool == "appell" else self.of_peer(tool, values, places)

    def of_peer(self, tool, values, places):
        n = self.speeds
        rates, rest = values[:n], values[n:]
        if tool == "casadi" and self.free:
            rates = np.concatenate([rates[3:6], rates[:3], rates[6:]])
        if not len(rest):
            return [rates]
        if tool == "casadi":
            whole = np.zeros((n, 3 * n))
            whole[places] = rest
            return [rates, *np.hsplit(whole, 3)]
        by_q, by_v, by_tau = rest.reshape(3, n, n)
        return [rates, by_q, by_v, by_tau[:, n - self.inputs:]]

    def of_appell(self, values, state):
        n, size = self.speeds, self.speeds + self.states
        rates, rest = values[:n], values[size:]
        a, b = rest[:size * size].reshape(-1, size)[:n], rest[size * size:].reshape(-1, self.inputs)[:n]
        if not self.free:
            return [rates, a[:, n:], a[:, :n], b] if len(rest) else [rates]
        r, v, w = self.turns[state], self.linear[state], self.angular[state]
        along = r.T @ rates[:3]
        own = np.concatenate([along - np.cross(w, v), rates[3:]])
        if not len(rest):
            return [own]
        # Directions of the state that move one of Pinocchio's variables: velocities of the base turn with it.
        by_q, by_v = np.zeros((size, n)), np.zeros((size, n))
        moved_q, moved_v = np.zeros((n, n)), np.zeros((n, n))
        by_v[:3, :3], by_v[3:n, 3:] = r, np.eye(n - 3)
        by_q[n:n + 3, :3], by_q[n + 7:, 6:] = r, np.eye(n - 6)
        q0, q = self.quaternions[state][0], self.quaternions[state][1:]
        for k, axis in enumerate(np.eye(3)):
            by_q[:3, 3 + k] = r @ np.cross(axis, v)
            by_q[n + 3:n + 7, 3 + k] = 0.5 * np.concatenate([[-q @ axis], q0 * axis + np.cross(q, axis)])
            moved_q[:3, 3 + k] = np.cross(axis, along)
            moved_v[:3, k], moved_v[:3, 3 + k] = np.cross(w, axis), np.cross(axis, v)
        back = np.eye(n)
        back[:3, :3] = r.T
        return [own, back @ a @ by_q - moved_q, back @ a @ by_v - moved_v, back @ b]


def rotation(quaternion):
    w, x, y, z = quaternion
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def agree(values, robots, kernels):
    """Every tool against appell, block by block, state by state; the largest difference."""
    worst = 0.0
    for (tool, name, function), numbers in values.items():
        if tool == "appell":
            continue
        robot = robots[name]
        ours = values["appell", name, function].reshape(-1, robot.size("appell", function))
        places = kernels[name, function]["places"] if tool == "casadi" else None
        for state, (own, theirs) in enumerate(zip(ours, numbers.reshape(len(ours), -1))):
            for a, b in zip(robot.same("appell", own, state, None), robot.same(tool, theirs, state, places), strict=True):
                difference = abs(a - b).max() / abs(b).max()
                if not difference <= AGREE:
                    sys.exit(f"{tool}'s {function} of {name} differ by {difference:.1e} of the largest entry")
                worst = max(worst, difference)
    return worst
