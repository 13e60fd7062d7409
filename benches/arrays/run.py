#!/usr/bin/env python3
"""Nanoseconds of processor time a state, for arrays of states from Python: appell, and peers with the same equations.

    python3 benches/arrays/run.py [--package FOLDER] [--before FOLDER] [--states 100000] [--write]

--package and --before are folders with the package `appell`, of this and of an earlier commit. Each measurement is a process of
its own, so that packages and their threads do not meet.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- arrays: written by benches/arrays/run.py -->", "<!-- end arrays -->"
ROUNDS = 7
MODELS = ("unicycle", "arm of 7 joints")
PEERS = {
    "before": "appell before",
    "appell_1": "appell, one thread",
    "appell": "appell",
    "casadi": "CasADi, `map`",
    "jax": "JAX, `vmap`",
    "mujoco": "MuJoCo, `rollout`",
}
AXES = ["0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1", "0 1 0"]


def arm():
    """An arm of seven joints, as MJCF."""
    text = '<mujoco model="arm"><option timestep="1e-3" gravity="0 0 -9.81"/><worldbody>'
    for joint, axis in enumerate(AXES):
        text += f'<body name="link{joint}" pos="0.02 0 {0.1 if joint == 0 else 0.2}">'
        text += f'<joint name="q{joint}" axis="{axis}" damping="0.{joint + 1}"/>'
        text += f'<inertial pos="0.01 0.02 0.1" mass="{3 - 0.3 * joint:.1f}" '
        text += 'fullinertia="0.02 0.025 0.01 0.001 0.002 -0.001"/>'
    return text + "</body>" * len(AXES) + "</worldbody></mujoco>"


def places(model, count):
    """States near the initial one, and inputs."""
    import numpy as np

    draw = np.random.default_rng(1)
    x = np.asarray(model.state()) + 0.1 * draw.standard_normal((count, len(model.states)))
    return x, np.zeros((count, len(model.inputs)))


def loaded(name):
    import appell

    return appell.load(name if name == "unicycle" else "arm.xml")


def timed(call):
    """Processor seconds of a call, the fewest of some rounds, and its result."""
    result, best = call(), float("inf")
    for _ in range(ROUNDS):
        start = time.process_time()
        result = call()
        best = min(best, time.process_time() - start)
    return best, result


def with_appell(model, x, u, slopes, threads):
    more = {} if threads is None else {"threads": threads}
    call = model.jacobians if slopes else model.rates
    return lambda: [call(x, u, **more)] if not slopes else list(call(x, u, **more))


def with_casadi(model, x, u, slopes):
    import casadi
    import numpy as np

    equations = model.functions(casadi)
    states, inputs = casadi.SX.sym("x", x.shape[1]), casadi.SX.sym("u", u.shape[1])
    parameters = list(map(float, model.parameter_values()))
    split = casadi.vertsplit
    rates = casadi.vertcat(*equations.rates(0.0, split(states), split(inputs) if u.shape[1] else [], parameters))
    results = [rates] + ([casadi.jacobian(rates, states), casadi.jacobian(rates, inputs)] if slopes else [])
    results = [casadi.densify(one) for one in casadi.cse(results)]
    function = casadi.Function("f", [states, inputs], results)
    function.generate("f.c")
    subprocess.run(["cc", "-O3", "-march=native", "-shared", "-fPIC", "f.c", "-o", "f.so", "-lm"], check=True)
    mapped = casadi.external("f", "./f.so").map(len(x))
    columns = [np.asfortranarray(x.T), np.asfortranarray(u.T)]
    return lambda: [np.asarray(one).T for one in casadi_list(mapped(*columns))[:1]]


def casadi_list(found):
    return list(found) if isinstance(found, (list, tuple)) else [found]


def with_jax(model, x, u, slopes):
    import jax

    jax.config.update("jax_enable_x64", True)
    equations = model.functions(jax.numpy)
    parameters = list(map(float, model.parameter_values()))

    def one(x, u):
        return jax.numpy.stack(equations.rates(0.0, list(x), list(u), parameters))

    def all_of_one(x, u):
        return (one(x, u), *jax.jacfwd(one, (0, 1))(x, u))

    function = jax.jit(jax.vmap(all_of_one if slopes else one))
    return lambda: [jax.block_until_ready(jax.tree.leaves(function(x, u))[0])]


def with_mujoco(x, threads):
    import mujoco
    import numpy as np
    from mujoco import rollout

    model = mujoco.MjModel.from_xml_path("arm.xml")
    data = [mujoco.MjData(model) for _ in range(threads)]
    count = len(x)
    initial = np.zeros((count, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    half = x.shape[1] // 2
    # appell's states are speeds, then coordinates.
    initial[:, 1 : 1 + half], initial[:, 1 + half : 1 + 2 * half] = x[:, half:], x[:, :half]
    return lambda: [rollout.rollout(model, data, initial, nstep=1, persistent_pool=True)[0]]


def measure(peer, name, slopes, count):
    """Nanoseconds a state; what the rates add up to, to be compared."""
    import numpy as np

    model = loaded(name)
    x, u = places(model, count)
    if peer in ("appell", "appell_1", "before"):
        call = with_appell(model, x, u, slopes, 1 if peer == "appell_1" else None)
    elif peer == "mujoco":
        call = with_mujoco(x, os.cpu_count() or 1)
    else:
        call = {"casadi": with_casadi, "jax": with_jax}[peer](model, x, u, slopes)
    seconds, found = timed(call)
    sums = None if peer == "mujoco" else np.abs(np.asarray(found[0])).sum(0).tolist()
    print(json.dumps({"ns": seconds / count * 1e9, "sums": sums}))


def table(package, before, count):
    lines = ["| ns of processor time a state | " + " | ".join(f"{name}: rates | with A, B" for name in MODELS) + " |",
             "|---|" + "---|---|" * len(MODELS)]
    expected = {}
    for peer in sorted(PEERS, key=list(PEERS).index):
        if peer == "before" and not before:
            continue
        cells = []
        for name in MODELS:
            for slopes in (False, True):
                if peer == "mujoco" and (slopes or name == "unicycle"):
                    cells.append("")
                    continue
                found = child(peer, name, slopes, count, before if peer == "before" else package)
                cells.append(f"{found['ns']:.1f}")
                if found["sums"] is not None:
                    known = expected.setdefault(name, found["sums"])
                    off = max(abs(a - b) / max(abs(b), 1e-300) for a, b in zip(found["sums"], known, strict=True))
                    assert off < 1e-9, (peer, name, off)
        lines.append(f"| {PEERS[peer]} | " + " | ".join(cells) + " |")
    return lines


def child(peer, name, slopes, count, package):
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "arm.xml").write_text(arm())
        environment = {**os.environ, "PYTHONPATH": str(package)}
        command = [sys.executable, __file__, "--one", peer, name, str(int(slopes)), "--states", str(count)]
        done = subprocess.run(command, cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, text=True)
        return json.loads(done.stdout.splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--package", type=Path, default=ROOT / "apps/python/python")
    parser.add_argument("--before", type=Path)
    parser.add_argument("--states", type=int, default=100000)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.one:
        peer, name, slopes = given.one
        return measure(peer, name, slopes == "1", given.states)
    before = given.before and given.before.resolve()
    lines = table(given.package.resolve(), before, given.states)
    print("\n".join(lines))
    if given.write:
        page = ROOT / "docs/performance.md"
        text = page.read_text()
        begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
        page.write_text(text[:begin] + "\n\n" + "\n".join(lines) + "\n\n" + text[end:])


if __name__ == "__main__":
    main()
