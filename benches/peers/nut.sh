#!/usr/bin/env bash
# Solves nuts with 100, 1000 and 10 000 balls with this project's solver and with SciPy.
# Usage: benches/peers/nut.sh
# Requires cargo and python3. The packages are installed from benches/peers/requirements.txt.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
work="$here/../../target/peers"
mkdir -p "$work"
cargo run --quiet --release --locked --manifest-path "$here/../../Cargo.toml" -p bsm-nut --features tools --example times >"$work/nut.json"
python="$work/venv/bin/python"
[ -x "$python" ] || python3 -m venv "$work/venv"
grep -E "^(numpy|scipy)=" "$here/requirements.txt" | xargs "$python" -m pip install --quiet
"$python" -B "$here/nut.py" "$work/nut.json"
