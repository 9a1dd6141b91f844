"""Bad input: each case of the tables in bad_input/ ends with status 1 and exactly the findings that stand below it.

`= NAME` names the namelist NAME.nml, or nothing, that the next cases change. A case is its changes in the order in which they are
made, `8 TEXT` (line 8 becomes TEXT), `+8 TEXT` (a new line 8), `-8` (without line 8), `| TEXT` (one more line at the end), and its
findings, `! LINE: MESSAGE`, in the order of the report; the next change begins the next case.
Values that no usual contact has are told: what is shipped is silent, slips of a unit are not.
"""

import os
import pathlib
import random
import re

import h5py
import pytest
from cases import AT_REST, ROOT, STEADY, called, ended, members, text, write

FOLDER = pathlib.Path(__file__).parent / "bad_input"
BASES = {path.stem: path.read_text(encoding="utf-8").splitlines() for path in sorted(FOLDER.glob("*.nml"))}
SECONDS = 10  # of processor time


def run(asperity, *arguments, seconds=SECONDS):
    """Findings, one a list item; the program must end in time, with status 1, without a backtrace."""
    done = asperity("--check", *arguments, seconds=seconds)
    assert done.returncode == 1, done.stderr[-2000:]
    assert "Backtrace" not in done.stderr
    assert done.stdout == ""
    return done.stderr.splitlines()


def findings_of(asperity, folder, content):
    path = folder / "bad.nml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
    return [line.removeprefix(f"{path}:").replace(f"{folder}/", "") for line in run(asperity, path)]


def changed(lines, change):
    mark, number, text = re.fullmatch(r"([|+-]?)(\d*) ?(.*)", change).groups()
    place = int(number) - 1 if number else len(lines)
    return lines[:place] + ([] if mark == "-" else [text]) + lines[place + (mark != "+") :]


def cases_of(table):
    """{table:line: (lines, findings)} of the cases of a table."""
    cases, base, name = {}, [], ""
    for number, line in enumerate(table.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("= "):
            base = BASES.get(line[2:], [])
        elif line.startswith("! "):
            cases[name][1].append(line[2:])
        else:
            name = f"{table.stem}:{number}" if not name or cases[name][1] else name
            cases[name] = (changed(cases[name][0] if name in cases else base, line), [])
    return cases


CORPUS = {name: case for table in sorted(FOLDER.glob("*.txt")) for name, case in cases_of(table).items()}


def test_corpus_is_large():
    assert len(CORPUS) >= 280


@pytest.mark.parametrize("name", BASES)
def test_bases_are_good(asperity, name):
    assert asperity("--check", FOLDER / f"{name}.nml").returncode == 0


@pytest.mark.parametrize(("lines", "expected"), CORPUS.values(), ids=CORPUS)
def test_corpus(asperity, tmp_path, lines, expected):
    assert expected
    assert findings_of(asperity, tmp_path, "".join(f"{line}\n" for line in lines)) == expected


def test_all_findings_of_all_files(asperity, tmp_path):
    two = dict(zip("ab", list(CORPUS.values())[:2], strict=True))
    for name, (lines, _) in two.items():
        (tmp_path / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert run(asperity, "b", "a") == [f"{name}:{finding}" for name in "ba" for finding in two[name][1]]


def test_a_grid_that_is_too_fine_for_its_method_is_found_by_check(asperity, tmp_path):
    """Also where the program chooses it: not late, in the middle of a batch."""
    waves = "&surface_1 shape = 'sinusoid', amplitude = 1e-9, wavelength = 1e-6 /\n"
    case = AT_REST.replace(", intervals = 256", "") + waves + "&solver method = 'newton_dense' /\n"
    (found,) = findings_of(asperity, tmp_path, case)
    assert "&domain intervals: found " in found
    assert "which the program chooses, expected at most 8192 with method = 'newton_dense'" in found


def test_what_is_no_namelist(asperity, tmp_path, program):
    assert run(asperity, tmp_path / "none.nml") == [f"{tmp_path}/none.nml: no such file"]
    assert run(asperity, tmp_path) == [f"{tmp_path}: found a folder, expected a file"]
    os.mkfifo(tmp_path / "pipe.nml")
    for path in ("pipe.nml", "/dev/zero", "/dev/null"):
        assert run(asperity, path) == [f"{path}: found a pipe, a device or a socket, expected a file"]
    (tmp_path / "large.nml").write_bytes(b"! comment\n" * 2_000_000)
    assert "expected a namelist of at most 16 MB" in run(asperity, tmp_path / "large.nml")[0]
    assert len(run(asperity, program)) == 1
    (line,) = findings_of(asperity, tmp_path, random.Random(1).randbytes(100_000))
    assert "found the byte 0x" in line
    assert "expected a text file in UTF-8" in line


def test_unreadable_file(asperity, tmp_path):
    if os.geteuid() == 0:
        pytest.skip("not applicable: root reads every file")
    path = tmp_path / "secret.nml"
    path.write_text(STEADY, encoding="utf-8")
    path.chmod(0)
    assert "cannot be opened" in run(asperity, path)[0]


NO_TEXT, LONG, PART = ", expected a text file in UTF-8", "x" * 1_000_000, "x" * 48 + "..."
CONTENTS = {
    "empty": ("", "1: found no group, expected &case ... / and others; see asperity --template ehl_line"),
    "zero_byte": ("! a\n! b\0\n" + STEADY, f"2: found the byte 0x00{NO_TEXT}"),
    "utf_16": (STEADY.encode("utf-16"), f"1: found UTF-16{NO_TEXT}"),
    "latin_1": (STEADY.encode("latin-1"), f"1: found the byte 0xD6{NO_TEXT}"),
    "cut_off_utf_8": (STEADY.encode() + b"! \xc3", f"8: found the byte 0xC3{NO_TEXT}"),
    "long_line": (STEADY + f"&time transient = {LONG} /\n", f"8: &time transient: found {PART}, expected .true. or .false."),
    "long_string": (
        STEADY.replace("'ehl_line'", f"'{LONG}'"),
        f"1: &case problem: found '{PART}', expected 'ehl_line', 'ehl_point', 'dry_line' or 'dry_area'",
    ),
    "long_title": (STEADY.replace("Öl, smooth", "t" * 10_001), "1: &case title: found 10001 bytes, expected at most 10000"),
}


@pytest.mark.parametrize(("content", "finding"), CONTENTS.values(), ids=CONTENTS)
def test_content(asperity, tmp_path, content, finding):
    assert findings_of(asperity, tmp_path, content) == [finding]


# Content, and how many findings there are, at least and at most.
HUGE = {
    "name": (STEADY + f"&{LONG}\n/\n", 1, 1),
    "values": (STEADY.replace("1e5", "1, " * 1_000_000), 1, 1),
    "quotes": (STEADY.replace("'ehl_line'", "'\"" * 100_001), 1, 3),
    "brackets": (STEADY.replace("1e5", "(" * 100_000 + ")" * 100_000), 1, 51),
    "findings": ("rubbish\n" * 100_000, 51, 51),
    "keys": (STEADY + "&time\n" + "".join(f"k{i} = 1\n" for i in range(100_000)) + "/\n", 51, 51),
    "groups": ("".join(f"&g{i} /\n" for i in range(100_000)), 51, 51),
}


@pytest.mark.parametrize("name", HUGE)
def test_huge_content(asperity, tmp_path, name):
    content, least, most = HUGE[name]
    lines = findings_of(asperity, tmp_path, content)
    assert least <= len(lines) <= most
    assert name != "name" or len(lines[0]) < 300
    assert name != "findings" or lines[-1] == " ... and 99950 more findings"


def written(source, count):
    """Entries of `mean_pressure` with random subscripts, and whether they state elements 1 to n once each."""
    odd = [0, -1, 1, 2, 3, 1999, 2000, 2001, 2**31 - 1, 2**31, 2**63 - 1, 10**30]
    lines, places, is_good = [], [], True
    first = 1
    for _ in range(count):
        size = source.randint(1, 4)
        start = first if source.random() < 0.8 else source.choice(odd)
        last = start + size - 1 if source.random() < 0.8 else source.choice([start, start - 1, 2000, 2**31 - 1, 2**63, 10**30])
        place = f"{start}:{last}"
        if source.random() < 0.5:
            place, last = start, start + size - 1
        lines.append(f"mean_pressure({place}) = " + ", ".join(["1e7"] * size))
        is_good = is_good and start >= 1 and last == start + size - 1
        places += range(start, start + size)
        first += size
    is_good = is_good and sorted(places) == list(range(1, len(places) + 1))
    source.shuffle(lines)
    return " ".join(lines), is_good


@pytest.mark.path
def test_random_subscripts(asperity, tmp_path):
    """Elements and ranges, up to numbers that no memory holds: read, or refused at once."""
    source = random.Random(31)
    verdicts = {}
    for number in range(60):
        entries, verdicts[f"{number}.nml"] = written(source, source.randint(1, 4))
        (tmp_path / f"{number}.nml").write_text(
            "&case problem = 'dry_line' /\n&bodies reduced_modulus = 2e11 /\n&load " + entries + " /\n"
            "&surface_1 shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-3 /\n&domain length = 1e-3, intervals = 64 /\n"
        )
    assert 10 < sum(verdicts.values()) < 50
    done = ended(asperity("--check", *verdicts, seconds=5), 1)
    assert "Error" not in done.stderr
    for name, is_good in verdicts.items():
        assert (f"\n{name}:3: &load mean_pressure: found " in f"\n{done.stderr}") != is_good, (tmp_path / name).read_text()


def test_a_mistyped_key_is_named(asperity, tmp_path):
    """Every key with a letter too many, too few or two exchanged: the key, not what its letters remind of (load_per_lenght)."""
    source, count, group = random.Random(20261126), 0, ""
    for line in asperity("--template", "ehl_line").stdout.splitlines():
        if head := re.match(r"(?:! )?(&\w+)", line):
            group = head[1]
        elif found := re.match(r"!?  +(\w{6,}) += ", line):
            key, i = found[1], source.randrange(1, len(found[1]) - 2)
            typed = {key[:i] + key[i - 1 :], key[:i] + key[i + 1 :], key[:i] + key[i + 1] + key[i] + key[i + 2 :]} - {key}
            write(tmp_path, "a.nml", "\n".join([group, *(f"{name} = 1" for name in typed), "/", ""]))
            told = [line.endswith(f"; did you mean {key}?") for line in run(asperity, "a.nml") if "unknown key" in line]
            assert told == [True] * len(typed), (group, typed)
            count += len(typed)
    assert count > 200


SHIPPED = sorted((ROOT / "input").glob("*.nml")) + sorted((ROOT / "input" / "scenes").glob("*.nml"))
SLIPS = 1e3, 1e-3, 1e6
WORDS = "is unusual, typical is"
MINIMAL = (ROOT / "input" / "minimal.nml").read_text()
NUMBER = r"[-+]?[0-9.]+(?:e[-+]?[0-9]+)?"


@pytest.mark.parametrize("path", [*SHIPPED, *(ROOT / "input" / "duty").glob("*.nml")], ids=lambda path: path.stem)
def test_shipped_inputs_are_silent(asperity, path):
    assert asperity("--check", path).stdout == f"{path}: no findings\n"


@pytest.mark.path
@pytest.mark.parametrize("problem", ["ehl_line", "ehl_point", "dry_line", "dry_area"])
def test_templates_are_silent(ranges, asperity, tmp_path, problem):
    """Their comments too: every example of a key is a typical value of it."""
    template = asperity("--template", problem).stdout
    write(tmp_path, "case.nml", template)
    assert asperity("--check", "case.nml").stdout == "case.nml: no findings\n"
    group = ""
    for line in template.splitlines():
        group = (re.findall(r"^(?:! )?&(\w+)$", line) or [group])[0]
        entry = re.match(rf"!?  +(\w+) = ({NUMBER}(?:, {NUMBER})*)(?: |$)", line)
        lowest, largest = ranges.get((group, entry[1]) if entry else None, (0.0, 1e99))
        for value in re.findall(NUMBER, entry[2]) if entry else []:
            assert float(value) == 0 or lowest <= abs(float(value)) <= largest, line


@pytest.fixture(scope="module", name="ranges")
def _ranges(program):
    """{(group, key): (lowest, largest)} of the page of keys."""
    found, group = {}, ""
    for line in called([program, "--keys-markdown"]).stdout.splitlines():
        group = (re.findall(r"^## &(\w+)", line) or [group])[0]
        if row := re.match(r"\| `(\w+)`.*, typical ([0-9.e+-]+) to ([0-9.e+-]+) \|", line):
            found[group, row[1]] = float(row[2]), float(row[3])
    return found | {("surface_2", key): limits for (group, key), limits in found.items() if group == "surface_1"}


def slips(ranges):
    """Every physical key of every shipped input, with each slip: (file, text, group, key, values)."""
    for path in SHIPPED:
        group = ""
        lines = path.read_text().splitlines(keepends=True)
        for i, line in enumerate(lines):
            group = (re.findall(r"^ *&(\w+)", line) or [group])[0]
            entry = re.match(rf" *(\w+) = ({NUMBER}(?:, {NUMBER})*)", line)
            if not entry or (group, entry[1]) not in ranges:
                continue
            for factor in SLIPS:
                values = [factor * float(value) for value in entry[2].split(",")]
                changed = f"   {entry[1]} = {', '.join(map(repr, values))}\n"
                whole = "".join([*lines[:i], changed, *lines[i + 1 :]])
                yield path, re.sub(r"file = '", f"file = '{path.parent}/", whole), group, entry[1], values


def told(asperity, folder, ranges, slip):
    """'told', 'refused' or 'silent': what the program says of a slip; it must be told if it leaves the typical range."""
    path, content, group, key, values = slip
    write(folder, "slip.nml", content)
    done = asperity("--check", "slip.nml")
    if done.returncode == 1:
        return "refused"
    lowest, largest = ranges[group, key]
    is_typical = all(value == 0 or lowest <= abs(value) <= largest for value in values)
    is_told = f"&{group} {key}: " in done.stdout and WORDS in done.stdout
    assert is_told != is_typical, (path.name, group, key, values, done.stdout)
    return "told" if is_told else "silent"


def test_slips_of_a_unit_are_told(ranges, asperity, tmp_path):
    """Random ones, all of them by night."""
    every = list(slips(ranges))
    sample = random.Random(17).sample(every, members(100, len(every)))
    outcomes = [told(asperity, tmp_path, ranges, slip) for slip in sample]
    print({outcome: outcomes.count(outcome) for outcome in set(outcomes)})
    assert outcomes.count("told") > 10
    assert outcomes.count("told") + outcomes.count("refused") > 0.6 * len(sample)


@pytest.mark.path
def test_unusual_values_stand_in_log_and_result(asperity, tmp_path):
    write(tmp_path, "case.nml", MINIMAL.replace("= 0.01 ", "= 12.0 ").replace("viscosity = 0.14", "viscosity = 30"))
    line = "case.nml:7: &bodies reduced_radius: 12 m is unusual, typical is 1e-4 to 5 m; is it in mm?\n"
    assert line in ended(asperity("case.nml")).stderr
    assert asperity("case.nml", "--quiet").stderr == ""
    with h5py.File(tmp_path / "case.h5") as file:
        note = text(file["report/note"][()])
    assert note.startswith("&bodies reduced_radius: 12 m is unusual, typical is 1e-4 to 5 m; &lubricant viscosity: 30 Pa s is")
    content = (ROOT / "input" / "dry_sphere.nml").read_text().replace("hertz_pressure = 1e9", "hertz_pressure = 3e4")
    write(tmp_path, "case.nml", content.replace("reduced_radius = 0.005", "reduced_radius = 8"))
    assert "&bodies reduced_radius: 8 m is unusual, typical is 1e-4 to 5 m; is it in mm?" in asperity("case.nml").stderr
    with h5py.File(tmp_path / "case.h5") as file:
        assert "&load hertz_pressure: 30000 Pa is unusual" in text(file["report/note"][()])
    content = (ROOT / "input" / "dry_area.nml").read_text()
    changed = re.sub(r"mean_pressure = [^!\n]*", "mean_pressure = 1,5e8 ", content)
    assert changed != content
    write(tmp_path, "case.nml", changed)
    line = "&load mean_pressure: 1 Pa is unusual, typical is 1e4 to 1e10 Pa; numbers have a decimal point, not a comma\n"
    assert line in asperity("--check", "case.nml").stdout


@pytest.mark.parametrize("signed", ["speed_1 = 0.0", "speed_1 = -0.3"])
def test_sign_and_nothing_are_usual(asperity, tmp_path, signed):
    write(tmp_path, "case.nml", MINIMAL.replace("speed_1 = 0.6", signed))
    assert asperity("--check", "case.nml").stdout == "case.nml: no findings\n"
