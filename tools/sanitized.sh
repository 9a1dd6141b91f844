#!/bin/sh
# Runs a command of the build of `make sanitize`: a finding ends it with a message and a status of its own, leaks included.
set -eu
# One thread of OpenBLAS: those that sleep at the end keep memory that would look lost.
export OPENBLAS_NUM_THREADS=1
export ASAN_OPTIONS="detect_leaks=1:detect_stack_use_after_return=1:exitcode=99"
export UBSAN_OPTIONS="print_stacktrace=1:halt_on_error=1"
exec "$@"
