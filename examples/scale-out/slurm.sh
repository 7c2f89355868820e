#!/bin/sh
#SBATCH --job-name=bsm
#SBATCH --array=0-99
#SBATCH --cpus-per-task=4
#SBATCH --requeue
# Solves a planned folder that all nodes can access, in 100 tasks: sbatch examples/scale-out/slurm.sh map/
# If task 17 fails, run sbatch --array=17 examples/scale-out/slurm.sh map/, or `bsm parts run map/` on any node.
# Finally: bsm parts check map/
exec srun bsm parts run "$1" --only "$SLURM_ARRAY_TASK_ID/100" --threads "$SLURM_CPUS_PER_TASK" --quiet
