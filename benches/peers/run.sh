#!/usr/bin/env bash
# The same points in this solver and in others: benches/peers/run.sh [--out FILE] [--count N] [--runs N]
# Takes cargo; with gcc, python3 and what pip installs here, the Python peers too.
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
    # One by one: what installs can run.
    while read -r package; do
        "$python" -m pip install --quiet "$package" || echo "$package: not installed" >&2
    done <"$here/requirements.txt"
    rm -f "$work/python.json"
    "$python" -B "$here/peers.py" "$work/points.json" "$work/python.json" &&
        set -- "$@" --python "$work/python.json"
fi
peers "$@"
