"""`asperity-heights FILE OUT.h5`: measured heights, as other programs write them, to the HDF5 file that shape = 'file' reads.

    asperity-heights trace.csv trace.h5                            columns x_mm, z_um, or X [mm];Y [mm];Z [um] with one Y
    asperity-heights trace.txt trace.h5 --unit mm,um               a file without units: positions in mm, heights in um
    asperity-heights trace.csv trace.h5 --columns "X,Z filtered"   columns by name or number: z, or x,z, or x,y,z
    asperity-heights matrix.txt area.h5 --spacing 2um --unit um    rows of heights: one column a profile, more an area
    asperity-heights area.xyz area.h5 --unit um                    a list x y z of a full grid, in any order
    asperity-heights scan.x3p area.h5 --fill                       the file of an instrument; missing points are interpolated

FILE is text (any encoding, line ends, separators, decimal mark; quoted or not), .npy, or the file of an instrument; these need the
library SurfaceTopography. What is in doubt is asked for in one line, with exit status 1; 3: OUT.h5 cannot be written.
"""

from __future__ import annotations

import argparse
import csv
import io
import os
import sys
import warnings
from pathlib import Path
from typing import Any, NoReturn

import h5py
import numpy as np
import pandas as pd

from .height_instruments import read_instrument
from .height_tables import (
    METRES,
    Floats,
    Heights,
    Refusal,
    Table,
    columns_by_name,
    columns_of,
    decoded,
    has_known_names,
    length_of,
    metres,
    read_npy,
    read_text,
    spacings_in_header,
    unit_of_matrix,
    unit_word,
)

PROGRAM = "asperity-heights"
# Largest error of a position, in spacings: positions are printed with few digits.
UNEVEN = 0.02


def places(x: Floats) -> tuple[int, float, np.ndarray[Any, np.dtype[np.int64]]] | None:
    """Number, spacing and index of evenly spaced positions that come in any order, more than once; None: they are uneven."""
    unique, inverse = np.unique(x, return_inverse=True)
    gaps = np.diff(unique)
    if not gaps.size or not np.all(np.isfinite(x)):
        return None
    step = np.median(gaps[gaps > UNEVEN * gaps.max()])
    index = np.concatenate([[0], np.cumsum(np.rint(gaps / step))]).astype(np.int64)
    if not 1 <= index[-1] < 4 * unique.size:
        return None
    spacing = float(unique[-1] - unique[0]) / int(index[-1])
    if np.any(np.abs(unique - unique[0] - index * spacing) > UNEVEN * spacing):
        return None
    return int(index[-1]) + 1, spacing, index[inverse]


def gridded(positions: list[Floats], z: Floats, names: str) -> tuple[Floats, list[float]]:
    """Heights (nx) or (ny, nx) in the order of rising positions, NaN where there is none; spacings."""
    found = [places(x) for x in positions]
    if any(axis is None for axis in found):
        raise Refusal(
            f"found positions that are not evenly spaced, {names}, expected those of a uniform grid (--columns, --spacing)"
        )
    axes = [axis for axis in found if axis is not None]
    shape = tuple(axis[0] for axis in reversed(axes))
    if np.prod(shape, dtype=float) > 2 * z.size:
        raise Refusal(f"found {z.size} positions on a grid of {' x '.join(map(str, shape[::-1]))}, {names}, expected a full grid")
    index = np.ravel_multi_index([axis[2] for axis in reversed(axes)], shape)
    count = np.bincount(index)
    if count.max() > 1:
        raise Refusal(f"found {int(np.sum(count > 1))} positions more than once, {names}, expected one height at each")
    grid = np.full(shape, np.nan)
    grid.ravel()[index] = z
    return grid, [axis[1] for axis in axes]


def has_axis(matrix: Floats) -> bool:
    """Whether the first column or row, but not the second, counts evenly: positions or numbers, no heights."""

    def counts(line: Floats) -> bool:
        found = places(line) if len(line) >= 8 else None
        return found is not None and found[0] == len(line)

    lines = [(m[k:, 0], m[k:, 1]) for m in (matrix, matrix.T) if m.shape[1] > 1 for k in (0, 1)]
    return any(counts(first) and not counts(second) for first, second in lines)


def heights_of_table(table: Table, options: argparse.Namespace) -> Heights:
    """The profile or area of columns with positions, or of a matrix."""
    units = [unit.strip() for unit in (options.unit or "").split(",")]
    if options.unit and (len(units) > 2 or not all(map(unit_word, units))):
        raise Refusal(f"--unit: found {options.unit!r}, expected one or two of {', '.join(METRES)}, as in mm,um")
    spacings = [length_of(text, units[0], "--spacing") for text in (options.spacing or "").split(",") if text]
    columns = columns_of(table, options.columns) if options.columns else columns_by_name(table)
    is_doubtful = len(columns) == 2 and not table.names and not options.columns
    if not columns and table.values.shape[1] == 3 and not has_known_names(table):
        axes = [places(column) for column in table.values.T[:2]]
        if np.prod([axis[0] if axis else 0 for axis in axes]) == len(table.values):
            columns = [0, 1, 2]
    has_positions = len(columns) > 1 and not (is_doubtful and spacings)
    if not has_positions and not options.columns:
        columns = []
    if options.missing is not None:
        z = table.values[:, columns[-1:] or slice(None)]
        mark = pd.to_numeric(options.missing.replace(",", "."), errors="coerce")
        table.values[:, columns[-1:] or slice(None)] = np.where(z == mark, np.nan, z)
    return (heights_at_positions if has_positions else heights_of_matrix)(table, columns, units, spacings)


def heights_at_positions(table: Table, columns: list[int], units: list[str], spacings: list[float]) -> Heights:
    """Heights at positions in `columns`: x, z or x, y, z. An x or y that does not vary is left out."""
    *axes, last = columns
    table.values = table.values[~np.all(np.isnan(table.values), axis=1)]  # spreadsheets end with blank rows
    stated, names = table.units or [""] * table.values.shape[1], table.listing()
    z = table.values[:, last] * metres(stated[last], units[-1], "heights")
    axes = [i for i in axes if np.ptp(table.values[:, i]) != 0] or axes[:1]
    scales = [metres(stated[i] or stated[columns[0]], units[0], "positions") for i in axes]
    grid, steps = gridded([table.values[:, i] for i in axes], z, names)
    found = [step * scale for step, scale in zip(steps, scales, strict=True)]
    for said in (spacings * (2 if len(spacings) == 1 else 1), spacings_in_header(table, False)):
        if said and not np.allclose(found, said[: len(found)], rtol=UNEVEN):
            raise Refusal(
                f"found positions {found[0]:.6g} m apart, columns {names}, but a spacing of {said[0]:.6g} m, expected one"
            )
    return Heights(grid, tuple(found), f"columns {table.listing([*axes, last])}")


def heights_of_matrix(table: Table, columns: list[int], units: list[str], spacings: list[float]) -> Heights:
    """Heights in rows, one column a profile, more an area; in all columns, or in one."""
    rows, width = table.values.shape
    stated = spacings_in_header(table, True)
    if not spacings + stated:
        raise Refusal(
            f"found {rows} rows without known positions, columns {table.listing()}, expected --columns of positions and heights "
            "by name or number, or --spacing S if there are only heights"
        )
    if len(spacings) > 2:
        raise Refusal(f"--spacing: found {len(spacings)} lengths, expected one, or those in x and y")
    spacings = spacings * 2 if len(spacings) == 1 else spacings or stated
    if stated and not np.allclose(stated, (spacings * 2)[:2], rtol=1e-6):
        raise Refusal(f"found a spacing of {stated[0]:.6g} m in the file, but {spacings[0]:.6g} m in --spacing, expected the same")
    if not columns and (has_axis(table.values) or has_known_names(table, "xy")):
        raise Refusal(f"found positions or numbers of rows, columns {table.listing()}, expected heights only, or --columns")
    columns = columns or list(range(width))
    z = table.values[:, columns] * metres(unit_of_matrix(table, columns), units[-1], "heights")
    return Heights(z.ravel(), (spacings[0],)) if 1 in z.shape else Heights(z, tuple(spacings))


def checked(heights: Heights, options: argparse.Namespace) -> str:
    """Refuses heights that are none; fills missing points if that is wanted, and says how."""
    z = heights.z
    known = z[np.isfinite(z)]
    levels, counts = np.unique(known, return_counts=True)
    if z.size < 2 or levels.size < 2 or not np.all(np.isfinite(levels[[0, -1]])):
        raise Refusal(f"found {known.size} heights, all equal or none, expected those of a surface")
    if not all(1e-15 <= step <= 1e6 for step in heights.spacing) or np.abs(known).max() > 1e3:
        raise Refusal(f"found {told(heights)}, expected heights up to 1000 m and spacings from 1e-15 to 1e6 m")
    for rest, lone, number in ((levels[:-1], levels[-1], counts[-1]), (levels[1:], levels[0], counts[0])):
        gap = min(abs(lone - rest[0]), abs(lone - rest[-1]))
        is_lone = number < known.size / 2 and gap > (rest[-1] - rest[0]) * max(1, 100 / known.size)  # few points know no range
        if options.missing is None and rest.size > 2 and is_lone:
            raise Refusal(
                f"found {number} heights of {lone * 1e6:.6g} um far from all others, "
                f"{rest[0] * 1e6:.6g} to {rest[-1] * 1e6:.6g} um, "
                "expected --missing VALUE if that marks missing points, else --missing none"
            )
    gaps = np.argwhere(~np.isfinite(z))
    if not len(gaps):
        return ""
    where = ", ".join(f"{name} = {i * s * 1e6:.6g} um" for name, i, s in zip("xy", gaps[0][::-1], heights.spacing, strict=False))
    words = f"{len(gaps)} of {z.size} points are missing, the first {where} from the first point"
    if not options.fill:
        raise Refusal(f"found that {words}, expected all, or --fill to interpolate them")
    frame = pd.DataFrame(np.atleast_2d(z))
    ways = [frame.interpolate(axis=axis, limit_direction="both").to_numpy() for axis in ((1,) if z.ndim == 1 else (0, 1))]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a row and column without any
        heights.z = np.where(np.isfinite(z), z, np.nanmean(ways, axis=0).reshape(z.shape))
    if not np.all(np.isfinite(heights.z)):
        raise Refusal(f"found that {words}, whole rows and columns among them, expected some to interpolate between")
    return f"; {words}, filled by linear interpolation" + (" along x and y, the mean of both" if z.ndim == 2 else "")


def is_ours(output: Path) -> bool:
    """Whether this program wrote a file."""
    try:
        with h5py.File(output) as file:
            return bool(file.attrs.get("creator") == PROGRAM)
    except OSError:
        return False


def write_heights(output: Path, heights: Heights, source: str, force: bool) -> None:
    """The file that shape = 'file' reads: complete, or not at all."""
    if output.exists() and not force and not is_ours(output):
        raise Refusal(f"{output}: found a file that {PROGRAM} did not write, expected another name, or --force")
    part = output.with_name(f"{output.name}.{os.getpid()}.part")
    try:
        with h5py.File(part, "x") as file:
            file.attrs["creator"] = PROGRAM
            dataset = file.create_dataset("z", data=heights.z)
            for attribute, value in zip(("spacing_x", "spacing_y"), heights.spacing, strict=False):
                dataset.attrs[attribute] = value
            dataset.attrs.update({"long_name": "measured height", "si_units": "m", "si_scale": 1.0, "source": source})
        part.replace(output)
    except FileExistsError:  # not the one of this process
        raise
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def convert(options: argparse.Namespace) -> str:
    """Reads and writes; returns the line that says what was read."""
    path, output = options.file, options.output
    if output.suffix.lower() not in (".h5", ".hdf5"):
        raise Refusal(f"{output}: expected a name that ends in .h5")
    if not path.is_file():
        raise Refusal(f"{path}: no such file" if not path.exists() else f"{path}: no regular file")
    if output.exists() and (output.samefile(path) or not output.is_file()):
        raise Refusal(f"{output}: found FILE itself or no regular file, expected another name")
    try:
        data = path.read_bytes()
        is_array, text = data.startswith(b"\x93NUMPY"), decoded(data)
        for name in ("channel",) if is_array or text is not None else ("spacing", "columns", "decimal"):
            if getattr(options, name) is not None:
                raise Refusal(f"found --{name}, expected it for {'an instrument' if name == 'channel' else 'a table'} only")
        if is_array:
            heights = heights_of_table(read_npy(path), options)
        elif text is not None:
            heights = heights_of_table(read_text(text, options.decimal, options.missing), options)
        else:
            heights = read_instrument(path, options.channel, options.unit)
        filled = checked(heights, options)
    except (Refusal, OSError, ValueError, MemoryError, csv.Error) as error:
        raise Refusal(f"{path}: {error}") from error
    write_heights(output, heights, path.name.encode("utf-8", "replace").decode(), options.force)
    return f"{output}: {told(heights)}{filled}"


def told(heights: Heights) -> str:
    """What was read, so that wrong units or columns are seen."""
    z, counts, steps = heights.z * 1e6, heights.z.shape[::-1], [step * 1e6 for step in heights.spacing]
    size = " x ".join(map(str, counts))
    spacing = " x ".join(f"{step:.6g}" for step in steps)
    length = " x ".join(f"{(count - 1) * step:.6g}" for count, step in zip(counts, steps, strict=True))
    extent = f"heights {np.nanmin(z):.6g} to {np.nanmax(z):.6g} um, Rq {np.nanstd(z):.4g} um"
    return f"{size} points, spacing {spacing} um, length {length} um, {extent}" + (f"; {heights.origin}" if heights.origin else "")


class Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, with exit status 1."""

    def error(self, message: str) -> NoReturn:
        """As for every other input."""
        self.exit(1, f"{self.prog}: {message} ({self.prog} --help)\n")


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = Parser(prog=PROGRAM, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)
    parser.add_argument("file", type=Path, metavar="FILE", help="what was measured")
    parser.add_argument("output", type=Path, metavar="OUT.h5", help="HDF5 file to write, with the heights in dataset z")
    parser.add_argument("--unit", metavar="X[,Z]", help="units of positions and heights, or one of both, where the file says none")
    parser.add_argument("--spacing", metavar="S[,SY]", help="distance of points without positions, as in 2um")
    parser.add_argument("--columns", metavar="X,Z", help="the columns to take: z, or x,z, or x,y,z")
    parser.add_argument("--decimal", choices=(".", ",", ".,"), help="the decimal mark (.,: both), where it is in doubt")
    parser.add_argument("--missing", metavar="VALUE", help="marks points that were not measured (none: nothing does)")
    parser.add_argument("--fill", action="store_true", help="interpolate missing points linearly, in areas along x and y")
    parser.add_argument("--channel", type=int, metavar="N", help="of an instrument's file with several channels of heights")
    parser.add_argument("--force", action="store_true", help=f"replace a file that {PROGRAM} did not write")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if isinstance(sys.stdout, io.TextIOWrapper):
                sys.stdout.reconfigure(errors="backslashreplace")  # names that the terminal cannot show
            print(convert(parser.parse_args(arguments)))
    except Refusal as error:
        print(f"{PROGRAM}: {' '.join(str(error).split())}", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"{PROGRAM}: {error.filename or ''}: {error.strerror or error}", file=sys.stderr)
        return 3
    return 0


if __name__ == "__main__":
    sys.exit(main())
