"""Calls the studies in their short form and reads the tables that they leave."""

import csv
import subprocess
import sys
from pathlib import Path

STUDIES = Path(__file__).resolve().parent.parent / "bench" / "studies"


def run_quick(name, program, folder):
    """Calls a study with --quick; it checks its own references and must end with status 0. Returns standard output."""
    command = [sys.executable, str(STUDIES / name), "--quick", "--output", str(folder), "--jobs", "2", "--program", str(program)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def rows(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))
