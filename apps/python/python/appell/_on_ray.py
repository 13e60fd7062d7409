"""Entry point of `appell ensemble --ray`: `python -m appell._on_ray STUDY FOLDER ADDRESS SHARD CHUNK`.

Tells a line at a time: `version`, then `chunk K of N` as they are finished; `error` and why it ends.
"""

import sys

from . import __version__
from ._ensemble import Ensemble


def main(study: str, out: str, address: str, shard: str, chunk: str) -> int:
    def tell(line: str) -> None:
        print(line, flush=True)

    tell(f"version {__version__}")
    try:
        made = Ensemble(study, out)
        made.spread(address, shard=shard or None, chunk=int(chunk) if chunk else None, progress=tell)
    except KeyboardInterrupt:
        return 130
    except Exception as failure:  # Whatever it is, the caller tells it.
        tell(f"error {' '.join(str(failure).split())}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
