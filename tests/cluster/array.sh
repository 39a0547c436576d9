#!/bin/bash
#SBATCH --job-name=snowlab-placement
#SBATCH --array=0-1
#SBATCH --cpus-per-task=2
#SBATCH --mem=1200M
#SBATCH --time=52
#SBATCH --signal=B:TERM@120
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH '--output=/home/ada/snow/my results/placement/full/slurm/element-%A-%a.log'
#SBATCH --chdir=/home/ada/snow
# One element: the cases of its line of the list, those that are missing.
# The program stands in for the shell, so that the signal before the limit reaches it: it puts its case away.
cases=()
for key in $(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" '/home/ada/snow/my results/placement/full/slurm/elements-0292d197a082.txt'); do cases+=(--case "$key"); done
if ((${#cases[@]} == 0)); then echo "element $SLURM_ARRAY_TASK_ID has no cases in" '/home/ada/snow/my results/placement/full/slurm/elements-0292d197a082.txt' >&2; exit 2; fi
exec /home/ada/bin/snowlab run studies/placement.toml --profile full --out 'my results' --jobs 1 --threads-per-case 2 "${cases[@]}"
