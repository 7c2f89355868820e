#!/bin/sh
# Solves a planned folder on some machines that see it, two processes each, with GNU parallel:
#   examples/scale-out/parallel.sh map/ one,two,three
# Without machines, on this one. A machine that is lost: run it again. Then: bsm parts check map/
folder=$1
machines=${2:-:}
exec parallel --jobs 2 --sshlogin "$machines" --workdir . --retries 3 \
    bsm parts run "$folder" --only {}/16 --threads 2 --quiet ::: $(seq 0 15)
