#!/usr/bin/env python3
"""Check that every public procedure and constant of src/ is used outside its module.

A name that only the unit tests use passes; `--tests` lists those. Derived types pass: they are the types of components.
Prints `file:line: what is wrong`; exit status 1 if anything is.
"""

import argparse
import pathlib
import re
import sys

from check_errors import statements


def public_names(path):
    """(line, name) of everything that a module makes public by name, but for derived types."""
    found, types = [], set()
    for number, statement in statements(path):
        declared = re.match(r"(public\s*::|.*,\s*public\b[^:]*::)(.*)", statement)
        is_type = re.match(r"type\b(?!\s*\()[^:]*::\s*(\w+)", statement)
        if is_type:
            types.add(is_type[1])
        elif declared and not re.match(r"(procedure|generic)\b", statement):
            flat = declared[2]
            while flat != (flat := re.sub(r"[(\[][^()\[\]]*[)\]]", "", flat)):
                pass
            found += [(number, name) for name in re.findall(r"(?:^|,)\s*(\w+)", flat)]
    return [(number, name) for number, name in found if name not in types]


def main():
    """Check src/ of the folder given, else of this project."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", nargs="?", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("--tests", action="store_true", help="list the names that only tests use too")
    wanted = parser.parse_args()
    files = {
        path: {word for _, statement in statements(path) for word in re.findall(r"\w+", statement)}
        for pattern in ("src/**/*.f90", "app/*.f90", "test/**/*.pf")
        for path in sorted(wanted.root.glob(pattern))
    }
    sources = [path for path in files if path.relative_to(wanted.root).parts[0] == "src"]
    found = [] if sources else [f"{wanted.root}: found no source files"]
    for path in sources:
        for number, name in public_names(path):
            users = [user for user in files if user != path and name in files[user]]
            if not users:
                found.append(f"{path}:{number}: {name} is public, but no other module uses it")
            elif wanted.tests and all(user.suffix == ".pf" for user in users):
                found.append(f"{path}:{number}: {name} is used by tests only")
    sys.stdout.writelines(f"{finding}\n" for finding in found)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
