#!/usr/bin/env python3
"""Check that no number is read by a list-directed read.

`read (text, *) x` takes `1/2` for 1, `2*3` for 3 and leaves x alone at `,`: input goes through `number_text` instead.
Prints `file:line: ...`; exit status 1 if anything is found.
"""

import pathlib
import re
import sys

from check_errors import statements


def arguments(text):
    """The arguments up to the bracket that closes them."""
    depth, found = 0, [""]
    for character in text:
        depth += (character in "([") - (character in ")]")
        if depth < 0:
            break
        if character == "," and depth == 0:
            found.append("")
        else:
            found[-1] += character
    return [argument.strip() for argument in found]


def is_list_directed(statement):
    """True if the statement holds `read (unit, *)`, `read (unit, fmt=*)` or `read *, ...`."""
    if re.search(r"\bread\s*\*\s*,", statement):
        return True
    for match in re.finditer(r"\bread\s*\(", statement):
        given = arguments(statement[match.end() :])
        if given[1:2] == ["*"] or any(re.fullmatch(r"fmt\s*=\s*\*", argument) for argument in given):
            return True
    return False


def main():
    """Check src/ and app/ of the folder given, else of this project."""
    root = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent
    paths = sorted([*root.glob("src/**/*.f90"), *root.glob("app/*.f90")])
    if not paths:
        print(f"{root}: found no source files")
    found = [
        f"{path}:{number}: found a list-directed read, expected read_real or read_integer of number_text"
        for path in paths
        for number, statement in statements(path)
        if is_list_directed(statement)
    ]
    print("".join(line + "\n" for line in found), end="")
    return 1 if found or not paths else 0


if __name__ == "__main__":
    sys.exit(main())
