#!/bin/sh
# fpm build, with the arguments given, and never on top of an incomplete build.
# fpm 0.12 compiles again what uses a changed module only in the call that compiles the module. So its notes of what is up to
# date are removed after a failed or interrupted build, and those of the tests after a build that left the tests out:
# otherwise old and new objects would be linked together.
set -eu
mark=build/incomplete
mkdir -p build
if [ -e "$mark" ]; then
  rm -f build/gfortran_*/*/*.digest
fi
touch "$mark"
fpm build "$@"
case " $* " in
*" --tests "*) ;;
*)
  if [ -n "$(find build -name '*.o' -newer "$mark" | head -n 1)" ]; then
    rm -f build/gfortran_*/*/test_*.digest
  fi
  ;;
esac
rm -f "$mark"
