# Every recipe is one line that also works typed by hand. CI runs `.ci/run`, which is `just check`.

_default:
    @just --list --unsorted

# Format, lint, docs, tests.
check:
    bash .ci/run

fmt:
    cargo fmt --all

lint *FLAGS:
    cargo clippy --workspace --all-targets --locked {{FLAGS}} -- -D warnings

doc:
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked

test *FLAGS:
    cargo test --workspace --locked {{FLAGS}}

# Criterion groups; `just bench rigid` runs those whose name contains "rigid".
bench *FILTER:
    cargo bench -p bsm-benches --locked -- {{FILTER}}

# The same points in SciPy, JAX, plain Newton and this solver; agreement is checked.
peers *FLAGS:
    benches/peers/run.sh {{FLAGS}}

# The published checks.
validate *FLAGS:
    cargo run --release --locked -p bsm-cli -- validate {{FLAGS}}

# The picture of the README.
picture:
    cargo run --release --locked -p bsm-cli -- sweep examples/lin1994.json --vary lead_angle_deg=2:45:130 --vary contact_angle_deg=30,45,60,75 -o target/picture.csv --plot docs/img/efficiency-lead-angle.svg
