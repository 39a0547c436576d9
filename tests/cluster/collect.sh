#!/bin/bash
#SBATCH --job-name=snowlab-placement-collect
#SBATCH --cpus-per-task=1
#SBATCH --mem=350M
#SBATCH --time=60
#SBATCH --open-mode=append
#SBATCH '--output=/home/ada/snow/my results/placement/full/slurm/collect.log'
#SBATCH --chdir=/home/ada/snow
exec /home/ada/bin/snowlab collect studies/placement.toml --profile full --out 'my results'
