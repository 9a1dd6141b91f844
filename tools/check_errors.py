#!/usr/bin/env python3
"""Check that every call which can fail is followed by a look at its error.

After `call anything(..., error)` the next statement must hold `allocated(error)`, or the procedure must end there
(also through the end of the block that holds the call, or by `return`). The next procedure that takes the error clears
it, so a forgotten test loses it. Where that is meant, a comment `! error: reason` behind the call says so.
Prints `file:line: ...`; exit status 1 if anything is found.
"""

import pathlib
import re
import sys

OPENS = re.compile(r"(\w+\s*:\s*)?(if\b.*\bthen$|select\b|do\b|block\b(?!\s*data)|associate\b)")
CLOSES = re.compile(r"end\s*(if|select|do|block|associate)\b")
LEAVES = re.compile(r"return$|end\s*(subroutine|function|program)\b|contains$")


def statements(path):
    """(line number, statement) with continuations joined, comments and strings removed, in lower case."""
    joined, first = "", 0
    for number, line in enumerate(path.read_text(encoding="utf-8").lower().splitlines(), 1):
        stated = re.sub(r"!\s*error:", "; stated !", line)
        code = re.sub(r"'[^']*'|\"[^\"]*\"", "''", stated).split("!")[0].strip().lstrip("&").strip()
        if not code:
            continue
        first = first if joined else number
        joined += code.rstrip("&").strip() + " "
        if not code.endswith("&"):
            yield first, joined.strip()
            joined = ""


def is_tested(rest, name):
    """True if the statements after a call look at the error `name` or leave the procedure."""
    depth = 0  # of the blocks that are skipped because the call is in another branch
    skipping = False
    for _, statement in rest:
        if skipping:
            depth += bool(OPENS.match(statement))
            if CLOSES.match(statement):
                depth -= 1
                skipping = depth >= 0
            continue
        if LEAVES.match(statement) or re.search(rf"\ballocated\s*\(\s*{name}\s*\)", statement):
            return True
        if re.match(r"(else|case\b|type is\b|class (is|default)\b|end\s*(if|select|block|associate)\b)", statement):
            skipping = not statement.startswith("end")
            depth = 0
            continue
        return False
    return False


def findings_of(path):
    """The calls of one file whose error nobody looks at."""
    lines = list(statements(path))
    declared = [s.split("::")[1] for _, s in lines if re.match(r"type\s*\(\s*error_t\s*\)\s*,.*allocatable.*::", s)]
    names = {name.strip() for names in declared for name in names.split(",")}
    for i, (number, statement) in enumerate(lines):
        call = re.search(r"\bcall\s+([\w%() ,]*?\w+)\s*\((.*)\)$", statement)
        last = re.search(r"(?:,|^|=)\s*(\w+)\s*$", call[2]) if call else None
        if last and last[1] in names and not is_tested(lines[i + 1 :], last[1]):
            yield f"{path}:{number}: the call can fail, but `{last[1]}` is not looked at after it"


def main(findings_of):
    """Check every Fortran file under src/ and app/ of the given folder by `findings_of(path)`."""
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    paths = sorted([*root.glob("src/**/*.f90"), *root.glob("app/**/*.f90")])
    findings = [finding for path in paths for finding in findings_of(path)]
    findings += [] if paths else ["no source files found"]
    sys.stdout.writelines(f"{finding}\n" for finding in findings)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(findings_of))
