#!/bin/sh
# fpm build, with the arguments given, and never on top of an incomplete build.
# After a failed or interrupted build, fpm 0.12 does not compile again what uses a changed module: old and new objects would
# be linked together. So its notes of what is up to date are removed then.
set -eu
mark=build/incomplete
mkdir -p build
if [ -e "$mark" ]; then
  rm -f build/gfortran_*/*/*.digest
fi
touch "$mark"
fpm build "$@"
rm -f "$mark"
