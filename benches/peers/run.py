#!/usr/bin/env python3
"""SymPy, CasADi and appell side by side: generation, operations, time per call.

    python3.11 benches/peers/run.py [--build DIR] [--layouts 5] [--rounds 41] [--out docs/performance.md]

Makes a virtual environment in DIR, generates C with the peers and Rust with appell, links everything
into one program per code layout and times the functions in turn. All functions of one row must give the
same numbers, else nothing is written. Needs Python 3.11, gcc, cargo.
"""

import argparse
import datetime
import json
import os
import platform
import random
import re
import subprocess
import sys
from pathlib import Path

import mechanisms
import table

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PACKAGES = ["sympy==1.14.0", "casadi==3.8.2"]
FLAGS = ["-O3", "-march=native", "-fPIC"]
# Largest relative difference between tools: rounding, and the condition of the mass matrix.
AGREE = 1e-9


def call(*command, **options):
    return subprocess.run([str(part) for part in command], check=True, **options)


def environment(build):
    python = build / "venv/bin/python"
    if not python.exists():
        call(sys.executable, "-m", "venv", build / "venv")
    call(python, "-m", "pip", "install", "--quiet", *PACKAGES)
    return python


def generated(build, python, repetitions):
    """What each tool tells about its kernels, and the objects to link."""
    code = build / "code"
    code.mkdir(exist_ok=True)
    told = {}
    for tool in ("sympy", "casadi"):
        call(python, HERE / f"with_{tool}.py", code, repetitions)
        told[tool] = json.loads((code / f"{tool}.json").read_text())
    (code / "hand.c").write_text((HERE / "hand.c").read_text())
    objects = []
    for source in sorted(code.glob("*.c")):
        print(f"  gcc {source.name}", flush=True)
        call("gcc", *FLAGS, "-c", source, "-o", source.with_suffix(".o"))
        objects.append(source.with_suffix(".o"))
    rust = dict(os.environ, CARGO_TARGET_DIR=str(build / "target"), RUSTFLAGS="-C target-cpu=native",
                PEERS_RUN=datetime.datetime.now().isoformat())
    print("  cargo", flush=True)
    call("cargo", "build", "--release", "--quiet", cwd=HERE / "appell", env=rust)
    written = max((build / "target/release/build").glob("peers-appell-*/out/told.tsv"), key=os.path.getmtime)
    told["appell"] = {}
    for line in written.read_text().splitlines():
        kernel, seconds, operations = line.split("\t")
        told["appell"][kernel] = {"seconds": float(seconds), "operations": operations}
    objects.append(build / "target/release/libpeers_appell.a")
    return told, objects


def kernels(objects):
    """(tool, kernel) of everything that is linked."""
    found = [tuple(o.stem.split("_", 1)) for o in objects if o.suffix == ".o" and o.stem != "hand"]
    found += [("appell", kernel) for kernel in mechanisms.KERNELS] + [("hand", "unicycle_rates")]
    order = list(mechanisms.KERNELS)
    return sorted(found, key=lambda k: (order.index(k[1].removesuffix("_hand")), k))


def header(build, found):
    names = list(mechanisms.SIZES)
    entries = []
    for tool, kernel in found:
        mechanism = kernel.split("_")[0]
        n, m, k = mechanisms.SIZES[mechanism]
        size = mechanisms.outputs(kernel)
        entries.append(f"X({tool}, {kernel}, {n}, {m}, {k}, {size}, {names.index(mechanism)})")
    text = f"#define MECHANISMS {len(names)}\n#define KERNELS \\\n    " + " \\\n    ".join(entries) + "\n"
    (build / "kernels.h").write_text(text)


def states():
    draw = random.Random(1)
    lines = []
    for mechanism, (n, m, k) in mechanisms.SIZES.items():
        lines.append(f"{n} {m} {k} " + " ".join(map(repr, mechanisms.PARAMETERS[mechanism])))
        for _ in range(256):
            widths = [w for group in mechanisms.SPREAD[mechanism] for w in group]
            lines.append(" ".join(repr(draw.uniform(-w, w)) for w in widths))
    return "\n".join(lines) + "\n"


def linked(build, objects, number):
    """The program with the objects in another order and at other distances."""
    draw = random.Random(number)
    order = list(objects)
    draw.shuffle(order)
    parts = []
    for index, part in enumerate(order):
        padding = build / f"padding_{index}.s"
        padding.write_text(f'.text\n.skip {16 * draw.randrange(256)}, 0x90\n.section .note.GNU-stack,"",@progbits\n')
        parts += [padding, part]
    program = build / f"measure_{number}"
    call("gcc", *FLAGS, "-I", build, HERE / "measure.c", *parts, "-o", program, "-lm", "-lpthread", "-ldl")
    return program


def run(program, rounds, text):
    done = call(program, rounds, input=text, capture_output=True, text=True)
    rows = (line.split("\t") for line in done.stdout.splitlines())
    return {name: [float(value) for value in values] for name, *values in rows}


def check(values, told):
    """Every tool against appell, entry by entry, state by state."""
    for name, all_got in values.items():
        tool, kernel = name.split(".")
        all_wanted = values["appell." + kernel.removesuffix("_hand")]
        size = mechanisms.outputs(kernel)
        for start in range(0, len(all_wanted), size):
            got, wanted = (all_[start:start + size] for all_ in (all_got, all_wanted))
            if tool == "casadi":
                dense = [0.0] * size
                for place, value in zip(told["casadi"][kernel]["places"], got):
                    dense[place] = value
                got = dense
            worst = max(abs(a - b) for a, b in zip(got, wanted)) / max(map(abs, wanted))
            if not worst <= AGREE:
                sys.exit(f"{name} is off by {worst:.1e} of the largest entry")
    print(f"  {len(values)} functions give the same numbers", flush=True)


def machine():
    info = Path("/proc/cpuinfo").read_text() if Path("/proc/cpuinfo").exists() else ""
    model = re.search(r"model name\s*:\s*(.*)", info)

    def version(*command):
        return subprocess.run(command, capture_output=True, text=True).stdout.splitlines()[0]

    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    return {
        "processor": model.group(1) if model else platform.processor(),
        "cores": os.cpu_count(),
        "gcc": version("gcc", "--version"),
        "rustc": version("rustc", "--version"),
        "python": platform.python_version(),
        "commit": commit.stdout.strip(),
        "date": datetime.date.today().isoformat(),
        "load": os.getloadavg()[0],
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    arguments.add_argument("--build", type=Path, default=ROOT / "target/peers")
    arguments.add_argument("--layouts", type=int, default=5)
    arguments.add_argument("--rounds", type=int, default=41)
    arguments.add_argument("--repetitions", type=int, default=5, help="of each generation; the fastest counts")
    arguments.add_argument("--out", type=Path, default=ROOT / "docs/performance.md")
    chosen = arguments.parse_args()
    build = chosen.build.resolve()
    build.mkdir(parents=True, exist_ok=True)
    about = machine()
    print("generating", flush=True)
    told, objects = generated(build, environment(build), chosen.repetitions)
    found = kernels(objects)
    header(build, found)
    text = states()
    times = []
    for number in range(chosen.layouts):
        program = linked(build, objects, number)
        if number == 0:
            check(run(program, 0, text), told)
        print(f"measuring layout {number + 1} of {chosen.layouts}", flush=True)
        times.append(run(program, chosen.rounds, text))
    about["load"] = max(about["load"], os.getloadavg()[0])
    about["command"] = f"python3.11 benches/peers/run.py --layouts {chosen.layouts} --rounds {chosen.rounds}"
    # The block of benches/scaling stands at the end.
    block = "".join(chosen.out.read_text().partition("\n<!-- scaling:")[1:]) if chosen.out.exists() else ""
    chosen.out.write_text(table.page(about, told, found, times) + block)
    print(f"wrote {chosen.out}")


if __name__ == "__main__":
    main()
