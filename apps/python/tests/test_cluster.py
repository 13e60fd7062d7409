"""A Ray cluster: workers and machines are lost, rows are not."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import appell

try:
    import ray
    from ray.cluster_utils import Cluster
except ImportError:
    if os.environ.get("CI"):
        raise
    pytest.skip("needs Ray", allow_module_level=True)

STUDY = """
[study]
model = "double_pendulum"
cases = 9000
chunk = 150
[motion]
t_end_s = 20
rtol = 1e-11
[vary]
theta1 = { uniform = ["-2rad", "2rad"] }
theta2 = { uniform = ["-2rad", "2rad"] }
[keep]
reached = { end = "theta2" }
turned = { when = "abs(theta2) > 3" }
"""


@pytest.fixture(scope="module")
def cluster():
    """Three machines, each with a processor."""
    machine = {"num_cpus": 1, "object_store_memory": 100 * 2**20}
    cluster = Cluster(initialize_head=True, head_node_args={**machine, "include_dashboard": False})
    machines = [cluster.add_node(**machine) for _ in range(2)]
    ray.init(address=cluster.address, log_to_driver=False)
    yield cluster, machines
    ray.shutdown()
    cluster.shutdown()


def workers(function):
    """Processes that run a function."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            command = (folder / "cmdline").read_bytes()
        except OSError:
            continue
        if command.startswith(f"ray::{function}".encode()):
            found.append(int(folder.name))
    return found


def until(condition, seconds=120):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "nothing happens"
        time.sleep(0.01)


def rows(folder):
    """The files of the chunks, by their names."""
    return {path.name: path.read_bytes() for path in folder.glob("*.parquet")}


def test_a_lost_worker_and_a_lost_machine_change_no_bit(cluster, tmp_path):
    cluster, machines = cluster
    alone = appell.ensemble(STUDY, tmp_path / "alone")
    failures = []

    def run():
        try:
            appell.ensemble(STUDY, tmp_path / "spread", ray=cluster.address)
        except BaseException as failure:
            failures.append(failure)

    def written():
        return len(rows(tmp_path / "spread"))

    running = threading.Thread(target=run)
    running.start()
    until(lambda: written() >= 5 and workers("_run"))
    os.kill(workers("_run")[0], signal.SIGKILL)
    before = written()
    until(lambda: written() >= before + 5)
    cluster.remove_node(machines[0], allow_graceful=False)
    assert written() < 60, "all was over before the machine was lost"
    running.join(300)
    assert not running.is_alive()
    assert failures == []
    assert rows(tmp_path / "spread") == rows(tmp_path / "alone")
    assert len(rows(tmp_path / "alone")) == 60
    again = appell.ensemble(STUDY, tmp_path / "spread")
    assert again.to_dict() == alone.to_dict()


def test_the_command_runs_on_a_cluster(cluster, tmp_path):
    appell_command = os.environ.get("APPELL_COMMAND") or shutil.which("appell")
    if appell_command is None:
        pytest.skip("the command `appell` is not there; APPELL_COMMAND tells its path")
    study = tmp_path / "study.toml"
    study.write_text(STUDY.replace("cases = 9000", "cases = 300"))
    alone = appell.ensemble(study, tmp_path / "alone")
    command = [appell_command, "ensemble", study, "--out", tmp_path / "spread"]
    command += ["--ray", cluster[0].address]
    told = subprocess.run(
        command, env={**os.environ, "APPELL_PYTHON": sys.executable}, capture_output=True, text=True, check=True
    )
    assert str(alone).splitlines()[0] in told.stdout
    assert rows(tmp_path / "spread") == rows(tmp_path / "alone")
    refused = subprocess.run(
        command, env={**os.environ, "APPELL_PYTHON": "no-such-python"}, capture_output=True, text=True
    )
    assert refused.returncode == 0, "all chunks are there"
    command[4] = tmp_path / "other"
    refused = subprocess.run(
        command, env={**os.environ, "APPELL_PYTHON": "no-such-python"}, capture_output=True, text=True
    )
    assert refused.returncode != 0 and "pip install appell ray" in refused.stderr


def test_any_function_is_spread(cluster):
    def swing(angle):
        return float(appell.load("pendulum").simulate(1.0, initial={"theta": angle})["theta"][-1])

    angles = [0.1 * k for k in range(6)]
    found = dict(appell.spread(swing, [(angle,) for angle in angles], cluster[0].address))
    assert found == {number: swing(angle) for number, angle in enumerate(angles)}


def test_mistakes_in_a_call_are_raised(cluster):
    with pytest.raises(appell.RequestError, match="unicyle"):
        list(appell.spread(lambda: appell.load("unicyle"), [()], cluster[0].address))


def test_a_cluster_needs_a_folder_for_the_rows():
    with pytest.raises(ValueError, match="`out`"):
        appell.ensemble(STUDY, ray=True)
