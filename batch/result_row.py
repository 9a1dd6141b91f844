"""Reads of one result file what a row of the gathered table holds, with few calls of the HDF5 library.

/summary with error estimates, /sweep of a dry contact with one load, the reference values of /scaling, numbers and words of
/report, the limits of the model in /adequacy/validity; root attributes say how the case ended. Whatever scalar is there is
taken, whatever its name.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from asperity.seal import DAMAGE, SealError, check_seal  # number_table has named its folder
from h5py import h5a, h5d, h5f, h5g, h5p, h5s, h5t
from number_table import PASSED, Row, RowError, read_row

NUMBER_BYTES = 8
# Group of a result -> what its columns begin with.
GROUPS = {b"summary": "", b"sweep": "", b"report": "report_", b"adequacy/validity": "validity_"}
EARLIER = "the result is that of an earlier form of this case; batch/run.py computes it again"
# Coordinates of arrays, of which one with a single value looks like a result.
COORDINATES = {"step", "report_cycle", "report_phase", "report_grid", "report_transform_column"}

_ACCESS = h5p.create(h5p.FILE_ACCESS)
_ACCESS.set_fclose_degree(h5f.CLOSE_STRONG)


class RowReader:
    """Reads results; keeps unit and meaning of each column from the first file that has it."""

    def __init__(self) -> None:
        """No file has been read."""
        self.units: dict[str, str] = {}
        self.meanings: dict[str, str] = {PASSED: "limits of the model beyond which the contact lies"}
        self._number = np.empty(())
        # columns of numbers, whose type is not asked for again
        self._numbers: set[str] = set()

    def read(self, path: Path, namelist: Path) -> Row:
        """The row of a result of the case `namelist`; raises RowError."""
        try:
            check_seal(path)
            if namelist.exists() and not namelist.is_file():  # to open a pipe may take for ever
                raise RowError("found a folder, pipe or device in place of the case, expected a file")
            file = h5f.open(bytes(path), h5f.ACC_RDONLY, _ACCESS)
            try:
                return self._read_open(file, namelist)
            finally:
                file.close()
        except FileNotFoundError as error:
            raise RowError("no result" if not path.exists() else f"the case cannot be read: {error.strerror}") from error
        except SealError as error:
            raise RowError(f"the result cannot be read: {error}") from error
        except DAMAGE as error:
            raise RowError(f"the result cannot be read: {' '.join(str(error).split())[:200]}") from error

    def read_table(self, table: Path, place: int, namelist: Path) -> Row:
        """The row of the case `namelist` at a place of a table; raises RowError."""
        try:
            row = read_row(table, place, self.units)
            is_same = row.is_of(namelist)
        except OSError as error:
            raise RowError(f"the table cannot be read: {error.strerror}") from error
        if not is_same:
            raise RowError(EARLIER)
        return row

    def _read_open(self, file: h5f.FileID, namelist: Path) -> Row:
        if self._text_attribute(file, b"program") != "asperity":
            raise RowError("no result of asperity")
        if self._value(h5d.open(file, b"/input/namelist")).encode() != namelist.read_bytes():
            raise RowError(EARLIER)
        words = [self._text_attribute(file, name) for name in (b"version", b"git_commit")]
        outcome = "converged" if self._attribute(file, b"converged") == 1.0 else "not converged"
        if h5a.exists(file, b"outcome"):  # not of earlier versions
            outcome = self._text_attribute(file, b"outcome")
        row = Row(outcome, self._text_attribute(file, b"reason"), " ".join(words))
        for name, prefix in GROUPS.items():
            if name.split(b"/")[0] in file and name in file:  # the second asks inside the first
                self._read_group(h5g.open(file, name), prefix, row.values)
        if b"scaling" in file:
            self._read_scaling(h5g.open(file, b"scaling"), row.values)
        return row

    def _read_group(self, group: h5g.GroupID, prefix: str, values: dict[str, float | str]) -> None:
        """All scalars of a group with their error estimates; of the limits, which are passed."""
        keys, passed = [], []
        h5g.iterate(group, keys.append)
        for key in keys:
            name = prefix + key.decode()
            if name in values or name in COORDINATES:
                continue
            item = h5d.open(group, key)
            # one number has 8 bytes, which is told faster than extents
            is_number = name in self._numbers and item.get_storage_size() == NUMBER_BYTES
            if not is_number and item.get_space().get_simple_extent_npoints() != 1:
                continue
            if name not in self.units:
                self._describe(name, item)
            values[name] = self._number_or_text(item) if is_number else self._value(item)
            if prefix == "validity_" and self._attribute(item, b"exceeded") == 1.0:
                passed.append(key.decode())
            if not prefix and h5a.exists(item, b"error_estimate"):
                values[f"{name}_error"] = self._attribute(item, b"error_estimate")
                if f"{name}_error" not in self.units:
                    self._describe(f"{name}_error", item, "estimated error of: ")
        if prefix == "validity_":
            values[PASSED] = " ".join(passed)

    def _read_scaling(self, group: h5g.GroupID, values: dict[str, float | str]) -> None:
        """The reference values: attributes NAME and NAME_units."""
        keys = []
        h5a.iterate(group, lambda key: None if key.endswith(b"_units") else keys.append(key))
        for key in keys:
            attribute, name = h5a.open(group, key), "scaling_" + key.decode()
            if attribute.get_type().get_class() == h5t.STRING:
                continue
            values[name] = self._attribute(group, key)
            if name not in self.units:
                unit = key + b"_units"
                self.units[name] = self._text_attribute(group, unit) if h5a.exists(group, unit) else ""
                self.meanings[name] = f"reference value {key.decode()}"

    def _describe(self, name: str, item: h5d.DatasetID, words: str = "") -> None:
        """Unit, meaning and kind of a new column."""
        if item.get_type().get_class() != h5t.STRING:
            self._numbers.add(name)
        found = [key for key in (b"units", b"si_units") if h5a.exists(item, key)]
        self.units[name] = self._text_attribute(item, found[0]) if found else ""
        meaning = self._text_attribute(item, b"long_name") if h5a.exists(item, b"long_name") else ""
        self.meanings[name] = words + meaning

    def _value(self, item: h5d.DatasetID) -> float | str:
        if item.get_space().get_simple_extent_npoints() != 1:
            raise ValueError("an array stands in the place of a single value")
        if item.get_type().get_class() != h5t.STRING:
            return self._number_of(item)
        text = np.empty(item.shape, item.dtype)
        item.read(h5s.ALL, h5s.ALL, text)
        return text.reshape(-1)[0].decode()

    def _number_or_text(self, item: h5d.DatasetID) -> float | str:
        """What is a number in other results."""
        try:
            return self._number_of(item)
        except OSError:  # no way from text to numbers
            return self._value(item)

    def _number_of(self, item: h5d.DatasetID) -> float:
        item.read(h5s.ALL, h5s.ALL, self._number, mtype=h5t.NATIVE_DOUBLE)
        return float(self._number)

    def _attribute(self, item: object, name: bytes) -> float:
        attribute = h5a.open(item, name)
        if attribute.get_space().get_simple_extent_npoints() != 1:  # read would write beyond the number
            raise ValueError(f"{name.decode()} is no single number")
        attribute.read(self._number, mtype=h5t.NATIVE_DOUBLE)
        return float(self._number)

    @staticmethod
    def _text_attribute(item: object, name: bytes) -> str:
        attribute = h5a.open(item, name)
        text = np.empty(attribute.shape, attribute.dtype)
        attribute.read(text)
        return text.reshape(-1)[0].decode()
