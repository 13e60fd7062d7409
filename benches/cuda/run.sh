#!/usr/bin/env bash
# Builds, measures on the card of this machine, writes benches/cuda/table.md. Further arguments are those of run.py.
set -euo pipefail
cd "$(dirname "$0")/../.."
target="${CARGO_TARGET_DIR:-target}"
python3 -m venv "$target/cuda-bench"
python="$target/cuda-bench/bin/python"
"$python" -m pip install -q numpy pyarrow maturin nvidia-cuda-nvrtc-cu12
cargo build --release -p appell-cli --features cuda
(cd apps/python && "$OLDPWD/$python" -m maturin develop --release -q)
nvrtc="$("$python" -c 'import nvidia.cuda_nvrtc as package; print(package.__path__[0])')/lib"
export LD_LIBRARY_PATH="$nvrtc${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
exec "$python" benches/cuda/run.py --appell "$target/release/appell" --write "$@"
