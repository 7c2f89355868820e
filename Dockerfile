# The program alone in a small image: `docker build -t bsm .`, then
# `docker run --rm -v "$PWD:/work" bsm solve examples/feed_drive.json`.
FROM rust:1-slim-bookworm AS build
WORKDIR /source
COPY . .
# The program contains the solver of saved pages.
RUN crates/bsm-view/page-solver && cargo build --release --locked

FROM debian:bookworm-slim
COPY --from=build /source/target/release/bsm /usr/local/bin/bsm
WORKDIR /work
ENTRYPOINT ["bsm"]
