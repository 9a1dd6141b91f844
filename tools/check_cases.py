#!/usr/bin/env python3
"""Check that no law passes for another: a `select case` over named constants names all it knows.

Its `case default` is there and stops the program (`error stop`), or says in a comment on its line which others it means.
Prints `file:line: ...`; exit status 1 if anything is found.
"""

import re
import sys

from check_errors import main, statements

NAMES = re.compile(r"case\s*\(\s*[a-z]\w*(\s*,\s*[a-z]\w*)*\s*\)$")


def findings_of(path):
    """The selections of one file that take what they do not know for something else."""
    lines = path.read_text(encoding="utf-8").splitlines()
    open_ones = []  # first line, whether all cases are names so far, whether there is a default that will do
    after_default = False
    for number, statement in statements(path):
        if after_default:
            open_ones[-1][2] = open_ones[-1][2] or statement.startswith("error stop")
            after_default = False
        if statement.startswith("select"):
            open_ones.append([number, statement.startswith("select case"), False])
        elif statement.startswith("case default"):
            open_ones[-1][2] = "!" in lines[number - 1]
            after_default = True
        elif re.match(r"case\s*\(", statement):
            open_ones[-1][1] = open_ones[-1][1] and bool(NAMES.match(statement))
        elif re.match(r"end\s*select", statement):
            first, is_named, is_closed = open_ones.pop()
            if is_named and not is_closed:
                yield f"{path}:{first}: a select case over named constants without a default that stops"


if __name__ == "__main__":
    sys.exit(main(findings_of))
