"""Calls the studies in their short form and reads the tables that they leave."""

import sys
from pathlib import Path

from cases import called, ended

STUDIES = Path(__file__).resolve().parent.parent / "bench" / "studies"


def run_quick(name, program, folder):
    """Calls a study with --quick; it checks its own references and must end with status 0. Returns standard output."""
    command = [sys.executable, str(STUDIES / name), "--quick", "--output", str(folder), "--jobs", "2", "--program", str(program)]
    done = ended(called(command))
    return done.stdout
