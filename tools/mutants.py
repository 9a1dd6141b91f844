#!/usr/bin/env python3
"""Plants one-line faults into the sources, and tells which of them the tests notice.

    mutants.py [first | fresh --seed N --count N] [--only TEXT] [--check | --list] [--every]

`first` are the faults of tools/mutants.txt, each written by hand; `fresh` ones are made by rules from lines that the seed
chooses, except texts, declarations and the arguments of huge, tiny and epsilon, of which only the kind counts. Each is planted
into a copy of the tree, compiled alone (with what uses its module, if the module file changes) and linked; then what --judge
says is asked: exit status 0 means that nothing was noticed. If so the unit tests run. With --every both judge each fault.
The check of `make lint` for ignored errors is always asked; the share is told with it and without.
A fault that does not compile, or whose text is not exactly once in its file, is stale. --check only looks for stale texts.
Exit status 1 if a fault is stale or less than --asked of them are noticed.
"""

import argparse
import collections
import os
import pathlib
import random
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parent.parent
TABLE = ROOT / "tools" / "mutants.txt"
PROCESSOR_SECONDS = 150  # of one process; more is a fault that hangs
LONGEST = 900  # seconds of one judge
MEMORY = 6 << 30
LIBRARIES = "-lhdf5_fortran -lhdf5 -lfftw3f -lfftw3 -lopenblas"
NAME, ENDS = r"[a-z]\w*(?:%\w+)*", r"(?=[\s,)*/+:-]|$)"
# Kinds of fresh faults: what is searched in a line, what replaces it.
RULES = {
    "plus to minus": (r"(?<=[\w)]) ?\+ ?(?=[\w(])", " - "),
    "minus to plus": (r"(?<=[\w)]) ?(?<![ed])- ?(?=[\w(])", " + "),
    "index": (rf"(?<=\w\()([ijk])(?=\))|(?<=\w\()([ijk])(?=, )|(?<= )([ijk])(?=\){ENDS})", r"\g<0> - 1"),
    "error not returned": (r"^ *if \(allocated\(error\)\) return$", ""),
    "and to or": (r" \.and\. ", " .or. "),
    "or to and": (r" \.or\. ", " .and. "),
    "constant": (r"(?<!\btiny\()(?<!\bhuge\()(?<!\bepsilon\()\b(?!0\.0+_wp)\d+\.\d+(e[-+]?\d+)?_wp\b", r"(1.01_wp*\g<0>)"),
}


@dataclass
class Fault:
    """One line of a file that becomes another one."""

    file: str
    before: str
    after: str
    breaks: str

    def planted(self, text):
        """The file with its fault; nothing if the line is not there, or is there twice."""
        return text.replace(self.before, self.after) if text.count(self.before) == 1 else None


def stored():
    """The faults of the table: `file: what breaks`, `- text before`, `+ text after`."""
    lines = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
    for head, before, after in zip(lines[::3], lines[1::3], lines[2::3], strict=True):
        file, _, breaks = head.partition(": ")
        if not (before.startswith("- ") and after.startswith("+ ")):
            sys.exit(f"{TABLE.name}: {head}: `- before` and `+ after` must follow")
        yield Fault(file, before[2:], after[2:], breaks)


def fresh(seed, count):
    """Faults by rules, kinds in turn, on lines chosen by the seed."""
    found = collections.defaultdict(list)
    for path in sorted([*ROOT.glob("src/*/*.f90"), *ROOT.glob("app/*.f90")]):
        text = path.read_text(encoding="utf-8")
        for line in text.splitlines(keepends=True):
            if re.match(r" *(use|public|private|end|implicit|procedure)\b|.*['\"!]", line) or (
                "::" in line and "parameter" not in line
            ):
                continue
            for kind, (pattern, new) in RULES.items():
                for match in re.finditer(pattern, line.rstrip("\n")):
                    changed = line[: match.start()] + match.expand(new) + line[match.end() :]
                    found[kind].append((path.relative_to(ROOT).as_posix(), text, line, changed))
    chance = random.Random(seed)
    for number in range(count):
        kind = list(RULES)[number % len(RULES)]
        file, text, line, changed = found[kind].pop(chance.randrange(len(found[kind])))
        # The line alone may be there several times: as much as is needed before it makes it unique.
        start = chance.choice([m.start() for m in re.finditer("(?m)^" + re.escape(line), text)])
        begin = start
        while text.count(text[begin : start + len(line)]) > 1:
            begin = text.rfind("\n", 0, begin - 1) + 1
        where = text.count("\n", 0, start) + 1
        yield Fault(file, text[begin : start + len(line)], text[begin:start] + changed, f"line {where}, {kind}: {line.strip()}")


class Tree:
    """A copy of the tree with a build of its own, which stays from one call to the next."""

    def __init__(self, place):
        """Brings the copy up to date and builds program and unit tests with the flags of `make build`."""
        self.place = place
        names = subprocess.check_output(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, text=True).split("\n")[:-1]
        for folder in ("src", "app", "test"):
            for path in (place / folder).rglob("*"):
                if path.is_file() and "generated" not in path.parts and path.relative_to(place).as_posix() not in names:
                    path.unlink()
        for name in names:
            old, new = ROOT / name, place / name
            if old.is_file() and not (new.is_file() and new.read_bytes() == old.read_bytes()):
                new.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(old, new)
        self.environment = os.environ | {
            "PATH": f"{ROOT}/.venv/bin:{os.environ['PATH']}",
            "PKG_CONFIG_PATH": f"{place}/.pc:{os.environ.get('PKG_CONFIG_PATH', '')}",
            "FPM_LDFLAGS": "-Lbuild/static -static-libgfortran -static-libgcc -Wl,--as-needed",
            "OPENBLAS_NUM_THREADS": "1",
        }
        rules = self.call("make", "-pn", "help")
        release = re.search(r"^RELEASE := (.*)$", rules, re.M)[1]
        self.flags = shlex.split(release)
        self.call("make", "prepare", "generate")
        if not list((place / "build").glob("gfortran_*/asperity/app_main.f90.o")):
            self.call("sh", "tools/fpm_build.sh", "--tests", "--flag", release)
        self.objects = next((place / "build").glob("gfortran_*/asperity/app_main.f90.o")).parent
        self.modules = self.objects.parent
        self.uses, self.of_module = {}, {}
        for file in [path for pattern in ("src/*/*.f90", "app/*.f90", "test/**/*.f90") for path in place.glob(pattern)]:
            text, name = file.read_text(encoding="utf-8"), file.relative_to(place).as_posix()
            self.uses[name] = set(re.findall(r"(?mi)^ *use (\w+)", text))
            self.of_module |= dict.fromkeys(re.findall(r"(?mi)^module (?!procedure)(\w+)", text), name)
        for path in set(self.objects.glob("*.o")) - {self.object_of(file) for file in self.uses}:
            path.unlink()
        if not self.catch_up({file for file in self.uses if self.is_late(file)}, {}):
            sys.exit("the sources do not compile")

    def call(self, *command):
        """Output of a command in the copy; an error ends the tool."""
        done = subprocess.run(command, cwd=self.place, env=self.environment, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"{shlex.join(command)}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done.stdout

    def object_of(self, file):
        """Object file of a source."""
        return self.objects / f"{file.replace('/', '_')}.o"

    def is_late(self, file):
        """Whether a source is newer than its object."""
        place = self.object_of(file)
        return not place.exists() or place.stat().st_mtime < (self.place / file).stat().st_mtime

    def compile(self, file, kept):
        """Compiles a source; returns what has to be compiled again, or None if it fails. Overwritten files go to `kept`."""
        modules = [self.modules / f"{module}.mod" for module, where in self.of_module.items() if where == file]
        old = {path: path.read_bytes() if path.exists() else b"" for path in [self.object_of(file), *modules]}
        for path, content in old.items():
            kept.setdefault(path, content)
        folders = ["-Ibuild/info", "-Itools", "-I/usr/include/hdf5/serial", f"-I{self.modules}", "-J", self.modules]
        command = ["gfortran", "-c", file, *self.flags, "-w", *folders, "-o", self.object_of(file)]
        if subprocess.run(command, cwd=self.place, capture_output=True, check=False).returncode:
            return None
        changed = {path.stem for path in modules if path.read_bytes() != old[path]}
        return {name for name, used in self.uses.items() if used & changed}

    def catch_up(self, late, kept):
        """Compiles sources and what uses them, if their module files change; returns whether that worked."""
        while late:
            ready = [file for file in sorted(late) if not {self.of_module.get(name) for name in self.uses[file]} & (late - {file})]
            for file in ready:
                users = self.compile(file, kept)
                if users is None:
                    return False
                late = (late - {file}) | users
        return True

    def link(self, name, *patterns):
        """Links `program` or `unit` in the copy."""
        objects = [path for pattern in patterns for path in sorted(self.objects.glob(f"{pattern}.o"))]
        folders = shlex.split(self.call("pkg-config", "--libs-only-L", "hdf5-serial", "openblas"))
        libraries = [*shlex.split(self.environment["FPM_LDFLAGS"]), *folders, *LIBRARIES.split()]
        self.call("gfortran", *self.flags, "-o", name, *map(str, objects), *libraries)

    def notices(self, command, folder):
        """Whether a judge ends with another status than 0, or does not end."""

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (PROCESSOR_SECONDS, PROCESSOR_SECONDS + 5))
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "start_new_session": True}
        with subprocess.Popen(command, cwd=folder, env=self.environment, preexec_fn=limit, **quiet) as running:  # noqa: PLW1509
            try:
                return running.wait(LONGEST) != 0
            except subprocess.TimeoutExpired:
                os.killpg(running.pid, signal.SIGKILL)
                return True

    def verdict(self, judge, every, has_units):
        """Which judges notice what is built."""
        found = ["lint"] * self.notices([sys.executable, "tools/check_errors.py"], self.place)
        self.link("program", "src_*", "app_*")
        found += ["golden"] * self.notices(shlex.split(judge.format(program=self.place / "program")), ROOT)
        if has_units and (every or "golden" not in found):
            self.link("unit", "src_*", "test_*")
            found += ["unit"] * self.notices(["./unit"], self.place)
        return found

    def judge(self, fault, judge, every):
        """`stale`, or which judges notice a fault."""
        path, kept = self.place / fault.file, {}
        text = path.read_text(encoding="utf-8")
        planted = fault.planted(text)
        if planted is None:
            return "stale"
        try:
            path.write_text(planted, encoding="utf-8")
            if not self.catch_up({fault.file}, kept):
                return "stale"
            return ", ".join(self.verdict(judge, every, has_units=fault.file.startswith("src/"))) or "SURVIVED"
        finally:
            path.write_text(text, encoding="utf-8")
            for file, content in kept.items():
                file.write_bytes(content)


def main():
    """Judges the faults one by one and prints the shares."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("set", nargs="?", default="first", choices=("first", "fresh"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=60, help="how many fresh ones")
    parser.add_argument("--only", default="", help="only those whose file or text fits this regular expression")
    parser.add_argument("--check", action="store_true", help="only look for texts that are no longer there")
    parser.add_argument("--list", action="store_true", help="only list them")
    parser.add_argument("--every", action="store_true", help="both judges for each fault")
    parser.add_argument("--judge", default=f"{sys.executable} test/golden.py --first --program {{program}}", help="the first judge")
    parser.add_argument("--tree", type=pathlib.Path, default=pathlib.Path("/tmp/asperity-mutants"), help="place of the copy")
    parser.add_argument("--asked", type=float, default=85, help="percent that must be noticed")
    chosen = parser.parse_args()
    faults = list(stored() if chosen.set == "first" else fresh(chosen.seed, chosen.count))
    faults = [fault for fault in faults if re.search(chosen.only, f"{fault.file}: {fault.breaks}")]
    if chosen.list:
        print(*(f"{fault.file}: {fault.breaks}" for fault in faults), sep="\n")
        return 0
    stale = [fault for fault in faults if fault.planted((ROOT / fault.file).read_text(encoding="utf-8")) is None]
    print(*(f"stale: {fault.file}: {fault.breaks}" for fault in stale), sep="\n", end="\n" if stale else "")
    if chosen.check:
        return 1 if stale else 0
    tree = Tree(chosen.tree)
    if tree.verdict(chosen.judge, every=True, has_units=True):
        sys.exit("without any fault the tests fail already")
    found = collections.Counter()
    for fault in faults:
        start = time.monotonic()
        verdict = tree.judge(fault, chosen.judge, chosen.every)
        found[verdict] += 1
        print(f"{verdict:12}  {time.monotonic() - start:4.0f} s  {fault.file}: {fault.breaks}", flush=True)
    judged = len(faults) - found["stale"]
    share, by_tests = (100 * (1 - missed / max(judged, 1)) for missed in (found["SURVIVED"], found["SURVIVED"] + found["lint"]))
    print(*(f"{verdict:12}  {number}" for verdict, number in sorted(found.items())), sep="\n")
    print(f"{share:.0f} % of {judged} faults noticed, {by_tests:.0f} % by golden and unit tests")
    return 1 if found["stale"] or share < chosen.asked else 0


if __name__ == "__main__":
    sys.exit(main())
