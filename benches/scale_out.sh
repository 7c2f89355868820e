#!/usr/bin/env bash
# Compares one `bsm sweep` on two threads with two processes of `bsm parts run` on one thread each. The results must be
# byte-identical, and both times are measured. Usage: benches/scale_out.sh [LOADS]; 10 000 loads result in 1e8 rows.
# The environment variable BSM contains the path of the program.
set -euo pipefail
cd "$(dirname "$0")/.."
loads=${1:-10000}
bsm=${BSM:-target/release/bsm}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
task=(sweep examples/feed_drive.json --set lead_mm=25 --model rigid --columns efficiency
    --vary "axial_load_N=2000:8000:$loads" --vary screw_speed_rpm=100:1500:10000)
seconds() { # Prints the time of a command.
    local begin=$EPOCHREALTIME
    "$@" >&2
    echo "$begin $EPOCHREALTIME" | awk '{ printf "%.2f", $2 - $1 }'
}
both() {
    "$bsm" parts run "$folder/two" --only 0/2 --threads 1 --quiet & first=$!
    "$bsm" parts run "$folder/two" --only 1/2 --threads 1 --quiet & second=$!
    wait "$first" && wait "$second"
    "$bsm" parts check "$folder/two"
}
# The two variants run alternately, so that other work on the machine affects both of them equally.
for round in 1 2; do
    rm -rf "${folder:?}"/*
    one=$(seconds "$bsm" "${task[@]}" -o "$folder/one/" --threads 2 --quiet)
    "$bsm" "${task[@]}" -o "$folder/two/" --plan >&2
    two=$(seconds both)
    diff -r "$folder/one" "$folder/two"
    echo "round $round: $((loads * 10000)) rows, same bytes; one sweep $one s, two processes $two s, with the check"
done
