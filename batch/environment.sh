# shellcheck shell=bash
# What a job of this cluster needs before it can run the program: the modules with which it was built, for instance
#
#   module load gcc hdf5 fftw openblas
#
# array.sbatch and gather.sbatch read this file.
