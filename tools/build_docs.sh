#!/bin/sh
# The pages of the programming interface by ford. Ford warns but exits 0: a warning is an error here.
# Modules, types, procedures and programs must have a text, and every file must be understood. Arguments are described in
# the text of their procedure, and names that only bind, list or declare what has its text elsewhere need none,
# nor do the types of FFTW's interface.
set -eu
need_no_text="variable|boundprocedure|moduleprocedure|finalproc|interface|proc 'unknown'|type 'unknown' in file 'fftw.f90'"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
status=0
COLUMNS=1000 ford docs/ford.md > "$log" 2>&1 || status=$?
if [ "$status" != 0 ]; then
  cat "$log" >&2
  exit 1
fi
if grep -i -A 1 'warning' "$log" | grep -Ev "Undocumented ($need_no_text)|^--|^ *Parsing" >&2; then
  echo "docs: (a text that begins with \`word:\` is taken for metadata)" >&2
  echo "docs: ford found something to complain about" >&2
  exit 1
fi
echo "docs: docs/api/index.html"
