#!/usr/bin/env python3
"""A sweep from its file to its figure: writes the cases, runs them, gathers the results, draws [plot]."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import gather
import plot
import run
import sweep
from case_folder import new_parser, status_of
from program_calls import INTERRUPTED
from sweep_file import read_sweep_file

PROGRAM = "all.py"
EPILOG = """example:
  all.py input/sweeps/film_over_speed.toml

The same command continues after an interruption; --replace takes up a changed sweep.

status: 0 all converged; 1 wrong sweep or usage; 2 some not converged or outside the model; 3 some failed, or a file
cannot be written; 4 interrupted"""


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = new_parser(PROGRAM, __doc__, EPILOG)
    sweep.add_options(parser)
    run.add_options(parser)
    options = parser.parse_args(arguments)
    return status_of(PROGRAM, lambda: do_all(options))


def do_all(options: argparse.Namespace) -> int:
    """All four steps; returns the exit status. Raises SweepError, OSError."""
    folder = options.output or Path(options.sweep.stem)
    found = read_sweep_file(options.sweep)
    print(f"{folder}: {sweep.write_sweep(found, folder, options)} cases, checked")
    status = run.run_folder(folder, options)
    if status == INTERRUPTED:
        return status
    gather.gather_folder(folder)
    return max(status, plot.main([str(folder)]) if found.plot else 0)


if __name__ == "__main__":
    sys.exit(main())
