"""The common command line of the figure scripts: options, names of the files, messages, status."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from result_file import DAMAGE, Result, ResultError, check_result

FORMATS = ("png", "pdf", "svg")


class FigureParser(argparse.ArgumentParser):
    """A parser that ends with status 1 on bad usage, as the program does."""

    def error(self, message: str) -> NoReturn:
        """Usage errors: one line and status 1."""
        self.exit(1, f"{self.prog}: {message} (see --help)\n")


def new_parser(program: str, description: str, example: str) -> FigureParser:
    """Parser with the options that all scripts share; `example` is shown by --help."""
    parser = FigureParser(
        prog=program,
        description=description,
        epilog=f"example:\n  {example}\n\nstatus: 0 drawn, 1 wrong file or usage, 3 cannot write",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("results", nargs="+", metavar="RESULT.h5", help="result files of asperity")
    parser.add_argument(
        "--output",
        default=".",
        metavar="DIR",
        help="folder for the figures (made if missing; default: the current one), or a file name when a single figure is drawn",
    )
    parser.add_argument("--si", action="store_true", help="SI units instead of dimensionless")
    parser.add_argument(
        "--format",
        nargs="+",
        choices=FORMATS,
        default=["png", "pdf"],
        metavar="EXT",
        help="one or more of png, pdf, svg (default: png pdf)",
    )
    return parser


def add_window(parser: argparse.ArgumentParser) -> None:
    """The option that limits the shown X."""
    parser.add_argument(
        "--window",
        nargs=2,
        type=float,
        metavar=("FROM", "TO"),
        help="part of X to show, in half-widths (default: the loaded part with room around it)",
    )


def add_time(parser: argparse.ArgumentParser) -> None:
    """The option that chooses a stored time of a passage."""
    parser.add_argument(
        "--time",
        type=float,
        metavar="T",
        help="dimensionless time of a transient result (default: the last)",
    )


def groups_of_time(options: argparse.Namespace) -> tuple[str, ...]:
    """What a result must have for the time that is asked for."""
    return ("solution",) if options.time is None else ("solution", "transient")


def run(
    parser: FigureParser,
    options: argparse.Namespace,
    draw: Callable[[Path, argparse.Namespace], list[Path]],
    needs: tuple[str, ...] = ("solution",),
) -> int:
    """Checks all result files, then draws one after another; returns the exit status.

    A bad one, and none is drawn; what only drawing finds out does not keep the others from being drawn.
    """
    paths = [Path(name) for name in options.results]
    findings = [finding for path in paths if (finding := _finding(path, needs))]
    stems = [path.stem for path in paths]
    twice = sorted({stem for stem in stems if stems.count(stem) > 1})
    if twice:
        findings.append(f"two results are named '{twice[0]}': draw them into different folders")
    if findings:
        return _complain(parser.prog, findings, 1)
    return max(guarded(parser.prog, draw, path, options) for path in paths)


def guarded(program: str, work: Callable[..., list[Path]], *arguments: object) -> int:
    """Calls `work`, names on standard output what it wrote, turns errors into message and status."""
    try:
        for target in work(*arguments):
            print(target)
    except ResultError as error:
        return _complain(program, [str(error)], 1)
    except OSError as error:
        reason = error.strerror or str(error)
        return _complain(program, [f"{error.filename or 'output'}: cannot write: {reason}"], 3)
    except DAMAGE as error:
        reason = " ".join(str(error).split())[:200]
        return _complain(program, [f"{_names(arguments)}: cannot be drawn, damaged? ({type(error).__name__}: {reason})"], 1)
    return 0


def targets(options: argparse.Namespace, stem: str, kind: str) -> list[Path]:
    """Names of one figure: OUTPUT/STEM_KIND.EXT, or OUTPUT itself where it is a file name."""
    output = Path(options.output)
    if output.suffix[1:] in FORMATS:
        if len(options.results) > 1 and kind not in ("compare", "regime"):
            raise ResultError(f"{output}: one file name for several results; give a folder")
        output.parent.mkdir(parents=True, exist_ok=True)
        return [output]
    output.mkdir(parents=True, exist_ok=True)
    return [output / f"{stem}_{kind}.{extension}" for extension in options.format]


def warn_not_converged(program: str, result: Result) -> None:
    """Says on standard error that a result is drawn although it is marked not converged."""
    if not result.converged:
        reason = result.reason or "no reason given"
        print(f"{program}: {result.path}: not converged: {reason} (drawn and marked)", file=sys.stderr)


def _finding(path: Path, needs: tuple[str, ...]) -> str:
    try:
        check_result(path, needs)
    except ResultError as error:
        return str(error)
    return ""


def _names(arguments: tuple[object, ...]) -> str:
    """The results that a script was drawing: its first argument, or all of its command line."""
    return str(arguments[0]) if isinstance(arguments[0], Path) else ", ".join(arguments[0].results)


def _complain(program: str, findings: list[str], status: int) -> int:
    for finding in findings:
        print(f"{program}: {finding}", file=sys.stderr)
    return status
