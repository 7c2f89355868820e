#!/usr/bin/env bash
# Runs coverage-guided fuzzing on the stable toolchain: fuzz/run.sh SECONDS [TARGET...]
# Requires cargo and a C++ compiler. Failing inputs are written to target/fuzz/<target>/found, new inputs to .../corpus.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds="${1:-60}"
shift || true
[ $# -gt 0 ] || set -- case nut solve words csv json-lines parquet requirement catalog

# These are the flags of cargo-fuzz without the sanitizers, which need a nightly toolchain. Because of --target, the
# flags do not apply to build scripts.
host="$(rustc -vV | sed -n 's/host: //p')"
coverage="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
    -Cllvm-args=-sanitizer-coverage-trace-compares"
RUSTFLAGS="$(echo $coverage)" cargo build --profile fuzz --locked -p bsm-fuzz --features libfuzzer \
    --target "$host" --target-dir target/fuzz/build

for target in "$@"; do
    work="target/fuzz/$target"
    mkdir -p "$work/corpus" "$work/found"
    seeds=("fuzz/corpus/$target")
    case "$target" in case | nut) seeds+=(examples) ;; esac
    [ "$target" != requirement ] || seeds+=(examples/requirements)
    # There is only one thread, because memory is measured per thread.
    RAYON_NUM_THREADS=1 BSM_FUZZ="$target" "target/fuzz/build/$host/fuzz/fuzz" -max_total_time="$seconds" \
        -timeout=20 -rss_limit_mb=4096 -max_len=8192 -len_control=0 -print_final_stats=1 \
        -artifact_prefix="$work/found/" "$work/corpus" "${seeds[@]}"
done
