# Every recipe is one line that also works typed by hand. CI runs `.ci/run`, which is `just check`.

_default:
    @just --list --unsorted

# Format, lint, docs, tests.
check:
    bash .ci/run

fmt:
    cargo fmt --all

lint *FLAGS:
    cargo clippy --workspace --all-targets --features tools --locked {{FLAGS}} -- -D warnings

doc:
    cargo doc --workspace --no-deps --locked

test *FLAGS:
    cargo test --workspace --locked {{FLAGS}}

# The campaigns of the tests with all their points, of which the ordinary tests draw a tenth; before a release.
campaigns *FLAGS:
    CAMPAIGNS=whole cargo test --workspace --locked {{FLAGS}}

# The twenty slowest tests with their seconds; needs cargo-nextest.
slowest:
    cargo nextest run --workspace --locked 2>&1 | sed -n 's/^ *PASS \[ *//p' | sort -rn | head -20

# The program, the Python wheel, completions, licenses and checksums in target/dist; `just dist --try` installs them in a bare Debian.
dist *FLAGS:
    .ci/dist {{FLAGS}}

# Packs the libraries as a registry would receive them and compiles each from its package; needs Cargo 1.90 and a network.
package *FLAGS:
    cargo publish --workspace --dry-run --locked {{FLAGS}}

# The Python package, in an environment of its own.
python:
    python/check

# The book in target/book, to read and search without a network; after `just python`. It executes notebooks that have changed.
book:
    target/python/bin/sphinx-build -q -W --keep-going -d target/book-cache -c docs/book . target/book

# The page in a real browser; `just page --pictures` makes those of docs/guide/look.md.
page *FLAGS:
    crates/bsm-view/check {{FLAGS}}

# Criterion groups; `just bench rigid` runs those whose name contains "rigid".
bench *FILTER:
    cargo bench -p bsm-benches --locked -- {{FILTER}}

# The same points in SciPy, JAX, plain Newton and this solver; agreement is checked.
peers *FLAGS:
    benches/peers/run.sh {{FLAGS}}

# The published checks.
validate *FLAGS:
    cargo run --release --locked -p bsm-cli -- validate {{FLAGS}}

# Speed against accuracy on this machine.
tradeoff *FLAGS:
    cargo run --release --locked -p bsm-cli -- tradeoff {{FLAGS}}

# Random points of extreme ranges in every model, checked; `just extremes 1000000 --model rigid`.
extremes *FLAGS:
    cargo run --release --locked -p bsm-validate --features tools --example extremes -- {{FLAGS}}

# Runs killed at random moments by four signals, gone on with, and compared bit by bit.
kills:
    cargo test --workspace --locked --test suite -- --include-ignored --nocapture resume::

# Processes, workers and a scheduler killed, raced and damaged, and every byte compared; the second line after `just python`.
faults:
    cargo test --workspace --locked --test suite -- --include-ignored --nocapture parts::
    BSM_FAULTS=20 target/python/bin/pytest -c python/pyproject.toml -s -k killed python/tests/test_parts.py

# Coverage-guided fuzzing on the stable toolchain; `just fuzz 600 parquet` takes ten minutes for one target.
fuzz *FLAGS:
    fuzz/run.sh {{FLAGS}}

# The numbers of README and docs, from the commands behind them; `just remake --list`.
remake *FLAGS:
    docs/remake {{FLAGS}}

# The pictures of README and docs; `dot` is that of Graphviz. Needs `just python`.
pictures: book (validate "--figures" "target/report") (tradeoff "--figures" "target/tradeoff")
    python3 docs/book/pictures.py
    cargo run --release --locked -p bsm-cli -- axis examples/axis.json --figures target/axis
    cp target/axis/figures/size-limits.svg docs/img/axis-limits.svg
    cargo run --release --locked -p bsm-cli -- solve examples/dong2020.json --show jam --model raceway-control --figures target/jam
    cp target/jam/jam-margin-speed.svg docs/img/
    cargo run --release --locked -p bsm-validate --features tools --example sketches -- docs/img
    for name in architecture ways; do dot -Tsvg docs/img/$name.dot -o docs/img/$name.svg; done
    cp target/report/figures/{transition,lin-efficiency-lead-angle}.svg target/tradeoff/figures/pareto-single.svg docs/img/
    cargo run --release --locked -p bsm-cli -- sweep examples/feed_drive_oil.json --vary screw_speed_rpm=10,20,50,100,200,500,1000,2000,4000 --vary lubricant_temperature_C=20,40,60 --columns equivalent_friction_coefficient -o docs/img/stribeck.svg
    cargo run --release --locked -p bsm-cli -- sweep examples/nut_double.json --vary friction_coefficient=0.02:0.14:25 --vary axial_play_um=0:40:17 --set screw_speed_rpm=100 --columns running_preload_torque_over_rule -o docs/img/drag.map.svg
