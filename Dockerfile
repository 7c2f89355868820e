# Builds a small image that contains only the program. Build the image with `docker build -t bsm .`, and then solve an example with
# `docker run --rm -v "$PWD:/work" bsm solve examples/feed_drive.json`.
FROM rust:1-slim-bookworm AS build
WORKDIR /source
COPY . .
# The solver of saved pages is built first, because the program contains it.
RUN crates/bsm-view/page-solver && cargo build --release --locked

FROM debian:bookworm-slim
COPY --from=build /source/target/release/bsm /usr/local/bin/bsm
WORKDIR /work
ENTRYPOINT ["bsm"]
