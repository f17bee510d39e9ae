#!/bin/sh
#SBATCH --job-name=ramp
#SBATCH --array=1-5
#SBATCH --cpus-per-task=1
#SBATCH --mem=2G
#SBATCH --time=00:30:00

# One seed of each goal for each task of the array. The first argument names the goals or the class, the others
# are options of `ramp bench`:
#
#     sbatch examples/clusters/slurm.sh easy --track state
#     ramp report results/array/* -o report.html
set -eu
seed=$SLURM_ARRAY_TASK_ID
exec ramp bench "$@" --first-seed "$seed" --repeats 1 -o "results/array/$seed"
