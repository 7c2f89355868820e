#!/usr/bin/env bash
# Solves random points of the traction model with this project's solver, SciPy and JAX.
# Usage: benches/peers/traction.sh [--count N] [--runs N]
# Requires cargo and python3. The packages are installed from benches/peers/requirements.txt.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
work="$here/../../target/peers"
mkdir -p "$work"
cargo run --quiet --release --locked --manifest-path "$here/../Cargo.toml" --features tools --bin traction-peers -- "$@" >"$work/traction.json"
python="$work/venv/bin/python"
[ -x "$python" ] || python3 -m venv "$work/venv"
"$python" -m pip install --quiet --requirement "$here/requirements.txt"
"$python" -B "$here/traction.py" "$work/traction.json"
