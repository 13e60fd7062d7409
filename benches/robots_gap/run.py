#!/usr/bin/env python3
"""From a robot file and logs to a corrected file, judged by MuJoCo.

    python3 benches/robots_gap/run.py FOLDER [CASE ...] [--appell PROGRAM] [--peer | --peer-of FILE] [--jobs N] [--reports DIR] [--out FILE] [--write]

FOLDER holds `cases/NAME/` (a recording.toml with its robot file and recordings) and `LABELS.json`. appell diagnoses a case
and corrects the file, which is rolled out in MuJoCo on held-out runs beside the nominal file and the true one; with --peer
so does mujoco.sysid; --peer-of takes its results from the --out of an earlier run with --peer. --write puts the table between its markers in docs/performance.md. Needs numpy and mujoco, for
--peer mujoco[sysid]. README.md tells more.
"""

import argparse
import datetime
import json
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import mujoco

import tables
import tools
from cases import cases

ROOT = Path(__file__).resolve().parents[2]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", metavar="CASE")
    parser.add_argument("--appell", default="appell")
    parser.add_argument("--peer", action="store_true", help="run mujoco.sysid beside")
    parser.add_argument("--peer-of", type=Path, metavar="FILE", help="the results of mujoco.sysid in an earlier --out")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=1800)
    parser.add_argument("--reports", type=Path, help="keep reports and corrected files there")
    parser.add_argument("--out", type=Path, help="write all numbers there as JSON")
    parser.add_argument("--write", action="store_true", help="write the table into the page")
    parser.add_argument("--page", type=Path, default=ROOT / "docs/performance.md")
    return parser.parse_intermixed_args()


def about(given):
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    folder = given.folder.name
    command = f"benches/robots_gap/run.py {folder}" + " --peer" * given.peer
    if given.peer_of:
        day = datetime.date.fromtimestamp(given.peer_of.stat().st_mtime).isoformat()
        command += f" --peer-of {given.peer_of.name}, a run of {day} on the same machine"
    return {"folder": folder, "command": command, "date": datetime.date.today().isoformat(), "commit": commit.stdout.strip(),
            "mujoco": mujoco.__version__}


def main():
    given = arguments()
    wanted = list(cases(given.folder, given.names))
    earlier = json.loads(given.peer_of.read_text()) if given.peer_of else {}
    begun = about(given)  # the tree may change while the cases run

    def one(case):
        began = time.time()
        own = tools.by_appell(case, given.appell, given.reports, given.timeout)
        peer = tools.by_peer(case, given.reports, given.timeout) if given.peer else earlier.get(case.name, {}).get("peer")
        print(case.name, json.dumps(own), json.dumps(peer), f"{time.time() - began:.0f} s", file=sys.stderr, flush=True)
        return case, own, peer

    with ThreadPoolExecutor(given.jobs) as pool:
        results = list(pool.map(one, wanted))
    found = [(case, own) for case, own, _ in results]
    peers = {case.name: peer for case, _, peer in results} if given.peer or given.peer_of else {}
    print("\n".join([*tables.rows(found, peers), "", *tables.summary(found, peers)]))
    if given.out:
        given.out.write_text(json.dumps({case.name: {"appell": own, "peer": peer} for case, own, peer in results}, indent=1))
    if given.write:
        given.page.write_text(tables.replaced(given.page.read_text(), given.folder.name, tables.block(begun, found, peers)))


if __name__ == "__main__":
    main()
