# Recipes for developers. The commands in the recipes can also be run directly. CI runs `.ci/run`, as does `just check`.

_default:
    @just --list --unsorted

# Check formatting, lints, documentation and tests.
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

# Run the tests with all points of the test campaigns. Ordinary test runs use only a tenth of these points. Run this before a release.
campaigns *FLAGS:
    CAMPAIGNS=whole cargo test --workspace --locked {{FLAGS}}

# Store the screens, answers and schemas of the examples as new snapshots. `git diff` shows what has changed.
snapshots:
    INSTA_UPDATE=always cargo test --workspace --locked --test suite -- snapshots::

# List the twenty slowest tests with their times in seconds. Requires cargo-nextest.
slowest:
    cargo nextest run --workspace --locked 2>&1 | sed -n 's/^ *PASS \[ *//p' | sort -rn | head -20

# Build the program, the Python wheel, completions, licenses and checksums in target/dist. `just dist --try` installs them in a minimal Debian system.
dist *FLAGS:
    .ci/dist {{FLAGS}}

# Package the libraries as for a registry, and compile each library from its package. Requires Cargo 1.90 and network access.
package *FLAGS:
    cargo publish --workspace --dry-run --locked {{FLAGS}}

# Build and test the Python package in a virtual environment.
python:
    python/check

# Build the book in target/book, which can be read and searched offline. Notebooks that have changed are executed. Run `just python` first.
book:
    target/python/bin/sphinx-build -q -W --keep-going -d target/book-cache -c docs/book . target/book

# Test the page of `bsm view` in a real browser. `just page --pictures` writes the pictures of docs/guide/look.md.
page *FLAGS:
    crates/bsm-view/check {{FLAGS}}

# Build the solver that saved pages contain. Programs that are built afterwards include this solver. Requires rustup.
page-solver:
    crates/bsm-view/page-solver

# Run the Criterion benchmarks. `just bench rigid` runs the groups whose names contain "rigid".
bench *FILTER:
    cargo bench -p bsm-benches --locked -- {{FILTER}}

# Solve the same points with SciPy, JAX, plain Newton and this solver, and check that the results agree.
peers *FLAGS:
    benches/peers/run.sh {{FLAGS}}

# Compare the program with published results.
validate *FLAGS:
    cargo run --release --locked -p bsm-cli -- validate {{FLAGS}}

# Measure speed and accuracy on this machine.
tradeoff *FLAGS:
    cargo run --release --locked -p bsm-cli -- tradeoff {{FLAGS}}

# Solve random points in extreme ranges with every model, and check the results. Example: `just extremes 1000000 --model rigid`.
extremes *FLAGS:
    cargo run --release --locked -p bsm-validate --features tools --example extremes -- {{FLAGS}}

# Kill runs with four different signals at random moments, resume them, and compare the results bit by bit.
kills:
    cargo test --workspace --locked --test suite -- --include-ignored --nocapture resume::

# Kill processes and workers, damage files, and compare every byte of the results. Run `just python` first.
faults:
    cargo test --workspace --locked --test suite -- --include-ignored --nocapture parts::
    BSM_FAULTS=20 target/python/bin/pytest -c python/pyproject.toml -s -k killed python/tests/test_parts.py

# Run coverage-guided fuzzing with the stable toolchain. `just fuzz 600 parquet` fuzzes one target for ten minutes.
fuzz *FLAGS:
    fuzz/run.sh {{FLAGS}}

# Update the generated numbers in README and docs by running the commands that print them. `just remake --list` lists the commands.
remake *FLAGS:
    docs/remake {{FLAGS}}

# Update the pictures in README and docs. Requires `dot` from Graphviz. Run `just python` first.
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
