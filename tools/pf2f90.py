#!/usr/bin/env python3
"""Translate pFUnit test files (.pf) for the small stand-in of tools/funit_lite.f90.

    pf2f90.py OUTPUT_FOLDER FILE.pf [FILE.pf ...]

Writes one NAME.f90 per NAME.pf (the test module and the module that runs it), funit.f90 (the assertions) and
pf_suites.f90 (the list of suites). A file whose name does not begin with test_ is a module that tests share: it holds plain
Fortran, no annotation, and is copied. Only the subset of pFUnit that the tests of this project use is accepted: everything
else, and everything that the real pFUnit drops or ignores silently, is refused as `file:line: reason`, exit status 1.
"""

import pathlib
import re
import sys
from dataclasses import dataclass, field

from funit_overloads import funit_module

MAX_NAME = 44  # longest test name that the real pFUnit takes
MAX_LINE = 120

# Assertions of the subset: name -> (least, most) number of arguments, message included.
ASSERTIONS = {
    "assertequal": (2, 4),
    "assertlessthan": (2, 4),
    "assertlessthanorequal": (2, 4),
    "assertgreaterthan": (2, 4),
    "assertgreaterthanorequal": (2, 4),
    "assertrelativelyequal": (3, 4),
    "asserttrue": (1, 2),
    "assertfalse": (1, 2),
    "assertisnan": (1, 2),
    "assertisfinite": (1, 2),
    "assertfail": (1, 1),
}
KEYWORDS = {"expected", "actual", "found", "lhs", "rhs", "condition", "conditions", "x", "tolerance", "message"}


class Refused(Exception):
    """A line that the subset does not contain."""


@dataclass
class Suite:
    """What one .pf file declares: names of its tests, and of what runs before each."""

    name: str
    tests: list = field(default_factory=list)
    before: str = ""


def code_only(line):
    """The line with comments removed and characters inside strings replaced by a dot."""
    out, quote = [], ""
    for char in line:
        if quote:
            out.append(char if char == quote else ".")
            if char == quote:
                quote = ""
        elif char in "'\"":
            quote = char
            out.append(char)
        elif char == "!":
            break
        else:
            out.append(char)
    return "".join(out)


def split_arguments(text):
    """The arguments of `(a, b, c)`, split at the commas of the outer level."""
    inner = text.strip()
    if not inner:
        return []
    code = code_only(inner)
    if not (code.startswith("(") and code.endswith(")")) or len(code) != len(inner):
        raise Refused("an annotation must be alone on one line: nothing may follow its closing parenthesis")
    depth, start, arguments = 0, 1, []
    for i, char in enumerate(code):
        if char in "([{":
            depth += 1
        elif char in ")]}":
            depth -= 1
            if depth == 0 and i != len(code) - 1:
                raise Refused("an annotation must be alone on one line: nothing may follow its closing parenthesis")
        elif char == "," and depth == 1:
            arguments.append(inner[start:i].strip())
            start = i + 1
    if depth != 0:
        raise Refused("parentheses of the annotation do not balance on this line (no continuation is possible)")
    arguments.append(inner[start:-1].strip())
    return [] if arguments == [""] else arguments


def fold(line):
    """The statement broken into lines that a compiler accepts (an ampersand on both sides may split anything)."""
    pieces = []
    while len(line) > MAX_LINE:
        pieces.append(line[:MAX_LINE] + "&")
        line = "&" + line[MAX_LINE:]
    return [*pieces, line]


def expand_assertion(name, text, file_name, number):
    """The Fortran lines for one assertion."""
    least, most = ASSERTIONS[name.lower()]
    arguments = split_arguments(text)
    if not least <= len(arguments) <= most:
        raise Refused(f"@{name} takes {least} to {most} arguments, found {len(arguments)}")
    for argument in arguments:
        match = re.match(r"(\w+)\s*=(?!=)", argument)
        if match and match[1].lower() not in KEYWORDS:
            raise Refused(f"@{name}: keyword '{match[1]}' is not in the subset")
    location = f"location=SourceLocation('{file_name}', {number})"
    call = f"call {name}({', '.join([*arguments, location])})"
    return [*fold(call), "if (anyExceptions()) return"]


class Translator:
    """Reads one .pf file line by line; `pending` holds an annotation that waits for the statement it belongs to."""

    def __init__(self, path):
        """Start with the file name; nothing is read yet."""
        self.path = path
        self.suite = Suite(path.stem)
        self.output = []
        self.pending = ""
        self.has_module = False

    def translate(self):
        """Translate the whole file; raises Refused with file:line."""
        number = 0
        try:
            for number, line in enumerate(self.path.read_text(encoding="utf-8").splitlines(), 1):
                self.take_line(line, number)
            if self.pending:
                raise Refused(f"@{self.pending} at the end of the file has nothing that it belongs to")
            self.check_suite()
        except Refused as reason:
            raise Refused(f"{self.path}:{number}: {reason}") from None
        return self.suite

    def take_line(self, line, number):
        """Translate one line."""
        code = code_only(line)
        match = re.fullmatch(r"\s*@(\w+)\s*(.*?)\s*", line)
        if line.startswith("#"):
            raise Refused("preprocessor lines are not in the subset")
        if match:
            self.output += self.annotation(match[1], match[2], number)
            return
        if "@" in code:
            raise Refused("an annotation must be alone on its line, nothing before it")
        if self.pending:
            self.add_procedure(line)
        self.check_module(code)
        self.output.append(line)

    def check_module(self, code):
        """The file must hold the module of its own name."""
        match = re.fullmatch(r"\s*module\s+(\w+)\s*", code, re.I)
        if match and match[1].lower() != "procedure":
            if match[1].lower() != self.suite.name.lower():
                raise Refused(f"the module must be called {self.suite.name}, found {match[1]}")
            if self.has_module:
                raise Refused("one module per file")
            self.has_module = True

    def annotation(self, name, text, number):
        """Handle `@name text`; returns the lines that replace it."""
        if "&" in code_only(text) or ";" in code_only(text) or len(code_only(text)) != len(text):
            raise Refused("an annotation must be alone on one line: no '&', ';' or trailing comment")
        if self.pending:
            raise Refused(f"@{self.pending} must be followed by the statement it belongs to, found @{name}")
        if name.lower() in ASSERTIONS:
            return expand_assertion(name, text, self.path.name, number)
        if name.lower() not in {"test", "before"}:
            raise Refused(f"@{name} is not in the subset of pFUnit that this project uses")
        if text:
            raise Refused(f"@{name} does not take '{text}' here")
        self.pending = name.lower()
        return []

    def add_procedure(self, line):
        """A test, or what runs before each, in the statement right after its annotation."""
        match = re.fullmatch(r"\s*subroutine\s+(\w+)\s*(?:\(\s*\))?\s*", line, re.I)
        if not match:
            raise Refused(f"the line after @{self.pending} must be `subroutine name()` without prefix, argument, bind or comment")
        name, suite = match[1], self.suite
        if len(name) > MAX_NAME:
            raise Refused(f"the name {name} has {len(name)} characters, at most {MAX_NAME} are possible")
        if self.pending == "before" and suite.before:
            raise Refused("two procedures are marked @before")
        if self.pending == "before":
            suite.before = name
        elif name.lower() in map(str.lower, suite.tests):
            raise Refused(f"two tests are called {name}")
        else:
            suite.tests.append(name)
        self.pending = ""

    def check_suite(self):
        """What can only be judged at the end of the file."""
        suite = self.suite
        if not self.has_module:
            raise Refused(f"no module {suite.name} in this file")
        if not suite.tests:
            raise Refused("no @test in this file")


def run_test(suite, test):
    """Lines that run one test."""
    return [
        f"if (pf_runner%starts('{suite.name}_suite.{test}')) then",
        *([f"call {suite.before}()"] if suite.before else []),
        f"if (.not. anyExceptions()) call {test}()",
        "call pf_runner%ends()",
        "end if",
    ]


def suite_module(suite):
    """The module that runs the tests of one file, one procedure per test."""
    lines = [f"module {suite.name}_suite", "use funit, only: anyExceptions, pf_runner_t", f"use {suite.name}"]
    lines += ["implicit none (type, external)", "private", f"public :: run_{suite.name}", "contains"]
    lines += [f"subroutine run_{suite.name}(pf_runner)", "type(pf_runner_t), intent(inout) :: pf_runner"]
    lines += [f"call pf_{i}(pf_runner)" for i, _ in enumerate(suite.tests, 1)]
    lines += [f"end subroutine run_{suite.name}"]
    for i, test in enumerate(suite.tests, 1):
        lines += [f"subroutine pf_{i}(pf_runner)", "type(pf_runner_t), intent(inout) :: pf_runner"]
        lines += [*run_test(suite, test), f"end subroutine pf_{i}"]
    lines.append(f"end module {suite.name}_suite")
    return [piece for line in lines for piece in fold(line)]


def list_module(suites):
    """The module that runs all suites."""
    lines = ["module pf_suites", "use funit, only: pf_runner_t"]
    lines += [f"use {s.name}_suite, only: run_{s.name}" for s in suites]
    lines += ["implicit none (type, external)", "private", "public :: run_suites", "contains", "subroutine run_suites()"]
    lines += ["type(pf_runner_t) :: runner", "call runner%begin()"]
    lines += [f"call run_{s.name}(runner)" for s in suites]
    lines += ["call runner%finish()", "end subroutine run_suites", "end module pf_suites"]
    return lines


def shared_module(path):
    """The lines of a module that tests share; raises Refused with file:line."""
    lines = path.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines, 1):
        if "@" in code_only(line) or line.startswith("#"):
            raise Refused(f"{path}:{number}: a file that is not called test_... holds plain Fortran only")
    if not any(re.fullmatch(rf"\s*module\s+{path.stem}\s*", code_only(line), re.I) for line in lines):
        raise Refused(f"{path}:{len(lines)}: no module {path.stem} in this file")
    return lines


def write_if_changed(path, lines):
    """Write the file only where its text changes, so that nothing is compiled for nothing."""
    text = "\n".join(lines) + "\n"
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def main(arguments):
    """Translate all files, or none."""
    if len(arguments) < 2:
        sys.stderr.write(__doc__)
        return 1
    folder = pathlib.Path(arguments[0])
    paths = [pathlib.Path(name) for name in sorted(arguments[1:])]
    translators = [Translator(path) for path in paths if path.stem.startswith("test_")]
    refused, stems, shared = [], set(), {}
    for path in paths:
        try:
            if not path.stem.startswith("test_"):
                shared[path.stem] = shared_module(path)
        except Refused as reason:
            refused.append(str(reason))
    for translator in translators:
        try:
            if translator.path.stem in stems:
                raise Refused(f"{translator.path}:1: two test files have this name")
            stems.add(translator.path.stem)
            translator.translate()
        except Refused as reason:
            refused.append(str(reason))
    if refused:
        sys.stderr.write("\n".join(refused) + "\n")
        return 1
    folder.mkdir(parents=True, exist_ok=True)
    header = "! Generated by tools/pf2f90.py: do not edit."
    written = {"funit_lite.f90", "funit.f90", "pf_suites.f90", *(f"{stem}.f90" for stem in shared)}
    runtime = pathlib.Path(__file__).with_name("funit_lite.f90").read_text(encoding="utf-8").splitlines()
    write_if_changed(folder / "funit_lite.f90", runtime)
    write_if_changed(folder / "funit.f90", [header, *funit_module()])
    for stem, lines in shared.items():
        write_if_changed(folder / f"{stem}.f90", [header, *lines])
    for translator in translators:
        written.add(f"{translator.suite.name}.f90")
        lines = [header, *translator.output, *suite_module(translator.suite)]
        write_if_changed(folder / f"{translator.suite.name}.f90", lines)
    write_if_changed(folder / "pf_suites.f90", [header, *list_module([t.suite for t in translators])])
    for stale in folder.glob("*.f90"):
        if stale.name not in written:
            stale.unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
