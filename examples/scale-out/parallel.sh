#!/bin/sh
# Solves a planned folder with GNU parallel on several machines that can access it, with two processes per machine:
#   examples/scale-out/parallel.sh map/ one,two,three
# Without a list of machines, the script runs on this machine. If a machine fails, run the script again. Finally: bsm parts check map/
folder=$1
machines=${2:-:}
exec parallel --jobs 2 --sshlogin "$machines" --workdir . --retries 3 \
    bsm parts run "$folder" --only {}/16 --threads 2 --quiet ::: $(seq 0 15)
