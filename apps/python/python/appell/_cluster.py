"""Calls on a Ray cluster. Calls lost with a worker or a machine are repeated."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

# Calls queued for each processor in addition to the running one.
AHEAD = 2


def spread(
    function: Callable[..., Any],
    calls: Iterable[Sequence[Any]],
    address: str | None = None,
    *,
    cpus: float = 1,
) -> Iterator[tuple[int, Any]]:
    """Calls a function on a Ray cluster, once for each tuple of arguments: yields the number of a call and its result,
    as they come.

    `address` is that of a running cluster, `"auto"` the one that this machine belongs to; without it, and where Ray is
    not running yet, a cluster of this machine alone is started. A call takes `cpus` processors. It is repeated when its
    worker or its machine is lost, so the function must be one that may run twice; its exceptions are raised here.

    Function, arguments and results travel by pickle: recordings and results by their paths, large ones to a folder that
    all machines see:

    ```python
    def diagnosed(folder):
        return appell.diagnose(f"{folder}/recording.toml", progress=False).to_dict()

    rigs = ["rigs/a", "rigs/b", "rigs/c"]
    for number, report in appell.spread(diagnosed, [(rig,) for rig in rigs], "auto"):
        print(rigs[number], report["verdict"])
    ```
    """
    ray = _ray()
    if not ray.is_initialized():
        ray.init(address=address, include_dashboard=False, log_to_driver=False, configure_logging=False)
    remote = ray.remote(num_cpus=cpus, max_retries=-1)(function)
    queue = enumerate(calls)
    running: dict[Any, int] = {}

    def fill() -> None:
        # Machines may join and leave while calls run.
        room = max(1, int(AHEAD * ray.cluster_resources().get("CPU", 1) / cpus))
        for number, arguments in queue:
            running[remote.remote(*arguments)] = number
            if len(running) >= room:
                break

    fill()
    try:
        while running:
            done, _ = ray.wait(list(running), num_returns=1)
            for reference in done:
                number = running.pop(reference)
                yield number, ray.get(reference)
            fill()
    finally:
        for reference in running:
            ray.cancel(reference, force=True)


def _ray() -> Any:
    try:
        import ray
    except ImportError:
        raise ImportError("a cluster needs Ray: pip install ray") from None
    return ray
