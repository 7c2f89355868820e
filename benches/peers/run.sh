#!/usr/bin/env bash
# Solves the same points with this project's solver and with other solvers.
# Usage: benches/peers/run.sh [--out FILE] [--count N] [--runs N]
# Requires cargo. The Python solvers also require gcc, python3 and pip. A solver is skipped if its packages cannot be
# installed.
set -euo pipefail
here="$(cd "$(dirname "$0")" && pwd)"
work="$here/../../target/peers"
mkdir -p "$work"

peers() {
    cargo run --quiet --release --locked --manifest-path "$here/../Cargo.toml" --features tools --bin peers -- "$@"
}

peers "$@" --write-points "$work/points.json"

python="$work/venv/bin/python"
[ -x "$python" ] || python3 -m venv "$work/venv" || echo "no venv: Python peers left out" >&2
if [ -x "$python" ]; then
    # Packages are installed one by one, so that a package that fails does not affect the others.
    while read -r package; do
        "$python" -m pip install --quiet "$package" || echo "$package: not installed" >&2
    done <"$here/requirements.txt"
    rm -f "$work/python.json"
    "$python" -B "$here/peers.py" "$work/points.json" "$work/python.json" &&
        set -- "$@" --python "$work/python.json"
fi
peers "$@"
