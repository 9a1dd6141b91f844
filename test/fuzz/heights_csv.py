"""Tables of heights with one field, row or header that is not what it should be: refused with the command that converts them."""

import random
from pathlib import Path

from surfaces import judged, solved

TITLE = "tables of heights: fields, rows, headers, positions, marks of missing points"
CASES = 200

FIELDS = ["0.1 um", "1e-7/3", "3*1e-7", "1e-7 2e-7", "1;5", "/", "", " ", "NaN", "nan", "inf", "-Infinity", "1,5", "0,1", "1e300"]
FIELDS += ["1e-320", "1e400", "1_000", "0x1p3", "'1e-7'", "one", "1e", "e5", ".", "+", "--1", "1.2.3", "(1,2)", "T", "1e-7!"]
FIELDS += ["1e-7\x00", "\xb5", "1e-7\t2", "&", "1e-7,", "2*", "1e+-5", "\u221e", "9" * 70, "=1", "#N/A", "-", "1e5000000000"]
HEADERS = ["0,1e-7", "x;z", "x", "x z", "1.0,2.0", "x,z,more", "x,"]
GOOD = [(" ", ","), ("", ", "), ("\t", ",")]
MARKS = ["-999", "99.99", "-32.768", "1e3"]
GOOD_HEADERS = ["x,z", "", "# x,z", "x_m,z_m", "x [m], z [m]"]


def rows_of(source: random.Random) -> list[list[str]]:
    return [[repr(i * 1e-6), repr(source.gauss(0.0, 1e-7))] for i in range(32)]


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    rows, header, ends = rows_of(source), "x,z", "\n"
    kind = source.choice(["field", "field", "field", "header", "row", "position", "mark", "equal", "falls", "good", "good"])
    row = source.randrange(len(rows))
    before, comma = "", ","
    is_good = kind == "good"
    if kind == "field":
        column, field = source.randrange(2), source.choice(FIELDS)
        rows[row][column] = field
        is_good = None if column == 0 and field.startswith("#") else False  # a comment
    elif kind == "header":
        header = source.choice(HEADERS)
        is_good = None if header == "x," else False  # a column without a name has its numbers
    elif kind == "mark":
        mark = source.choice(MARKS)
        for i in range(row, min(row + source.choice([1, 1, 5]), len(rows))):
            rows[i][1] = mark
    elif kind == "equal":
        rows = [[x, "1e-7"] for x, _ in rows]
    elif kind == "falls":
        rows.reverse()
    elif kind == "row":
        rows[row] = source.choice([rows[row][:1], [*rows[row], "0.0"], [], ["", ""], rows[row] * 2, ["1 2"]]) or [","]
    elif kind == "position":
        rows[row][0] = source.choice([rows[row - 1][0] if row else "5.0", "1e300", "-1.0", "1.5e-6", "1e-3"])
    else:
        before, comma = source.choice(GOOD)
        ends = source.choice(["\n", "\r\n", "\r", "\n\n"])
        header = source.choice(GOOD_HEADERS)
        before = " " if before == "\t" and header in ("", "# x,z") else before
        rows = [[source.choice([x, x.replace("e", "D"), x.replace("e", "E")]), z] for x, z in rows]
    text = ends.join([header, *(before + comma.join(row) for row in rows)]) + ends
    (folder / "z.csv").write_bytes(text.encode("utf-8"))
    run = solved(program, folder, source.choice(["line", "oil"]), "z.csv")
    if run.status == 1 and not run.err.endswith("; to convert it: asperity-heights z.csv z.h5\n"):
        return f"no command: {run.err.strip()[-200:]}"
    return judged(run, folder, "z.csv", is_good=is_good)
