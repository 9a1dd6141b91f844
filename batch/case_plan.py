"""From a sweep file to its cases: the combinations of the parameters, and the namelist of each."""

from __future__ import annotations

import copy
import itertools
import os
import re
import subprocess
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import f90nml
from formulas import FormulaError, evaluate
from sweep_file import Parameter, Sample, SweepError, SweepFile, Value, read_text

Groups = dict[str, dict[str, object]]


@dataclass(frozen=True)
class Factor:
    """Parameters that go from value to value together; the cases are the product of all factors."""

    parameters: list[Parameter]
    sample: Sample | None = None

    @property
    def count(self) -> int:
        """How many values they take."""
        return self.sample.count if self.sample else self.parameters[0].count

    def rows(self) -> list[tuple[Value, ...]]:
        """The values, a tuple for each step."""
        if self.sample:
            points = sample_points(self.sample, len(self.parameters))
            return [tuple(p.between(share) for p, share in zip(self.parameters, point, strict=True)) for point in points]
        return [tuple(parameter.value(i) for parameter in self.parameters) for i in range(self.count)]


def sample_points(sample: Sample, dimensions: int) -> list[list[float]]:
    """Points of the unit cube."""
    try:
        from scipy.stats import qmc  # noqa: PLC0415 (takes a second, and only samples need it)
    except ImportError as error:
        raise SweepError("samples are drawn by scipy, which is not here: .venv/bin/pip install scipy") from error

    if sample.method == "sobol":
        engine = qmc.Sobol(dimensions, rng=sample.seed)
        return engine.random_base2(sample.count.bit_length() - 1).tolist()
    return qmc.LatinHypercube(dimensions, rng=sample.seed).random(sample.count).tolist()


@dataclass(frozen=True)
class Plan:
    """All cases of a sweep."""

    sweep: SweepFile
    base: Groups
    factors: list[Factor]

    @property
    def count(self) -> int:
        """How many cases there are."""
        total = 1
        for factor in self.factors:
            total *= factor.count
        return total

    @property
    def parameters(self) -> list[str]:
        """Columns of the index: the parameters in the order of the file, then formulas with a name of their own."""
        return [p.name for p in self.sweep.parameters] + [name for name in self.sweep.formulas if "." not in name]

    def name(self, number: int) -> str:
        """Name of case `number`, from 1."""
        return f"case_{number:0{max(4, len(str(self.count)))}d}"

    def cases(self) -> Iterator[tuple[str, list[object], Groups]]:
        """Name, values of the parameters and namelist of each case; the last parameter of the file runs fastest."""
        columns = [parameter.name for factor in self.factors for parameter in factor.parameters]
        for number, parts in enumerate(itertools.product(*(factor.rows() for factor in self.factors)), start=1):
            values = dict(zip(columns, itertools.chain(*parts), strict=True))
            groups = self.namelist(values, self.name(number))
            yield self.name(number), [values[name] for name in self.parameters], groups

    def namelist(self, values: dict[str, object], case: str) -> Groups:
        """The groups of one case; adds the named formulas to `values`. Raises SweepError."""
        groups = copy.deepcopy(self.base)
        for name, value in (*self.sweep.constants.items(), *values.items()):
            put(groups, name, value)

        def look_up(name: str) -> object:
            if "." not in name:
                return values.get(name)
            group, key = name.lower().split(".")
            return groups.get(group, {}).get(key)

        for name, formula in self.sweep.formulas.items():
            try:
                value = evaluate(formula, look_up)
            except FormulaError as error:
                line = self.sweep.line_of("formula", *name.split("."))
                raise SweepError(f"{self.sweep.path}:{line}: {name}: {error} ({case})") from error
            put(groups, name, value)
            if "." not in name:
                values[name] = value
        return groups


def put(groups: Groups, name: str, value: object) -> None:
    """Sets `group.key`; a name without a dot is no key."""
    if "." in name:
        group, key = name.lower().split(".")
        groups.setdefault(group, {})[key] = value


def plan_sweep(sweep: SweepFile, folder: Path) -> Plan:
    """The plan of a sweep whose cases will be in `folder`/cases; raises SweepError."""
    together = {name: i for i, names in enumerate(sweep.together) for name in names}
    members: dict[object, list[Parameter]] = {}
    for parameter in sweep.parameters:
        key = "sample" if parameter.count is None else together.get(parameter.name, parameter.name)
        members.setdefault(key, []).append(parameter)
    factors = [Factor(found, sweep.sample if key == "sample" else None) for key, found in members.items()]
    for factor in factors:
        if all(parameter.values for parameter in factor.parameters):
            _refuse_repeats(sweep, factor)
    sweep.refuse()
    return Plan(sweep, read_base(sweep, folder), factors)


def _refuse_repeats(sweep: SweepFile, factor: Factor) -> None:
    """Two steps with the same values would be one case with two names."""
    first: dict[str, int] = {}
    for step, row in enumerate(factor.rows(), start=1):
        earlier = first.setdefault(repr(row), step)
        if earlier != step:
            names = ", ".join(parameter.name for parameter in factor.parameters)
            value = ", ".join(map(str, row))
            sweep.find(factor.parameters[-1].line, f"{names}: found {value} as value {earlier} and {step}, expected it once")


def read_base(sweep: SweepFile, folder: Path) -> Groups:
    """The groups of the base case. Its files of heights are found from the new place, its results are named by the sweep."""
    line = sweep.line_of("base")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # what f90nml leaves out it only warns of
            groups = f90nml.reads(read_text(sweep.base)).todict()
    except SweepError as error:
        raise SweepError(f"{sweep.path}:{line}: {error}") from error
    except Exception as error:  # f90nml raises what comes: ValueError, KeyError, AssertionError, StopIteration
        raise SweepError(f"{sweep.path}:{line}: {sweep.base} cannot be read as a namelist: {error}") from error
    repeated = [name for name, keys in groups.items() if not isinstance(keys, dict)]
    if repeated or not groups:
        words = f"has &{repeated[0]} twice" if repeated else "holds no group"
        raise SweepError(f"{sweep.path}:{line}: {sweep.base} {words}; asperity --check says more")
    for keys in groups.values():
        # amplitude(1) = ..., amplitude(2) = ... is one list; a list that begins later is for the program to refuse
        for name, first in keys.pop("_start_index", {}).items():
            if first != [1]:
                keys.setdefault("_start_index", {})[name] = first
    groups.get("case", {}).pop("output", None)
    for name in sweep.leave_out:
        group, _, key = str(name).lower().partition(".")
        if groups.get(group, {}).pop(key, None) is None:
            sweep.find(sweep.line_of("leave_out"), f"found {name} in leave_out, expected group.key of the base case")
    sweep.refuse()
    for keys in groups.values():
        if isinstance(name := keys.get("file"), str) and not Path(name).is_absolute():
            keys["file"] = os.path.relpath(Path(os.path.realpath(sweep.base.parent), name), Path(os.path.realpath(folder), "cases"))
    return groups


def units_of_keys(program: Path, problem: str) -> dict[str, str]:
    """Unit of every `group.key` of a problem, as the program knows them; 1: a pure number."""
    done = subprocess.run([program, "--keys-markdown"], capture_output=True, encoding="utf-8", errors="replace", check=False)
    units, group = {}, ""
    for line in done.stdout.splitlines():
        if line.startswith("## &"):
            group = line[4:]
        elif row := re.match(r"\| `(\w+)` \|[^|]*\| ?([^|]*?) ?\|.*\| (.*) \|$", line):
            problems = re.search(r"\(((?:ehl|dry)[\w ]*)\)$", row[3])
            if not problems or problem in problems[1].split():
                units[f"{group}.{row[1]}"] = {"-": "1"}.get(row[2], row[2])
    return units
