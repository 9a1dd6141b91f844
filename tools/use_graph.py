#!/usr/bin/env python3
"""How deep the modules hang from each other by their `use` lines: the longest chain, and the number of modules and edges.

    use_graph.py [--most N]

Without arguments prints the longest chain, from the main program down. With --most: status 1 if it has more than N modules.
"""

import argparse
import functools
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def used_modules():
    """Our modules that each module uses, by name."""
    paths = [*ROOT.glob("src/**/*.f90"), *ROOT.glob("app/*.f90")]
    lines = {path.stem: path.read_text(encoding="utf-8").lower() for path in paths}
    uses = {name: set(re.findall(r"^\s*use\b\s*(?:::)?\s*(\w+)", text, re.MULTILINE)) for name, text in lines.items()}
    return {name: sorted((used & set(uses)) - {name}) for name, used in uses.items()}


def longest_chain(uses):
    """Names from the top of the longest chain to its end."""

    @functools.cache
    def chain(name):
        return (name, *max((chain(other) for other in uses[name]), key=len, default=()))

    return max((chain(name) for name in uses), key=len)


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=int, help="most modules in a chain")
    most = parser.parse_args().most
    uses = used_modules()
    names = longest_chain(uses)
    if most is None:
        print(f"{len(uses)} modules, {sum(map(len, uses.values()))} edges, depth {len(names)}")
        print("\n".join(names))
    elif len(names) > most:
        print(f"src: the chain of use lines {' -> '.join(names)} has {len(names)} modules, expected at most {most}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
