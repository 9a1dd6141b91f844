"""The seal of a result: the line behind its last byte with the number of bytes before it and their checksum.

The program writes it (`src/system/file_bytes.f90`) and HDF5 does not see it. It is checked before the HDF5 library opens a file,
since some damaged files crash that library. A program that changes the file takes the line away.
"""

from __future__ import annotations

import re
import stat
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

# What h5py, numpy, xarray and matplotlib raise where the bytes of a file are damaged.
DAMAGE = (OSError, LookupError, ValueError, TypeError, AttributeError, RuntimeError, ArithmeticError, MemoryError)
# Length of the line, its end included [bytes].
SEAL_BYTES = 80
_LINE = re.compile(rb"asperity checksum ([0-9A-F]{16}) of the (\d+) bytes before *\n")
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
# As in src/system/checksum.f90: the largest prime below 2^32.
_MODULUS = 4294967291
# 32-bit words that are added at once: their sums stay below 2^64, and they in the cache.
_WORDS = 2**15
_WEIGHTS = np.arange(_WORDS, 0, -1, dtype=np.uint64)


class SealError(Exception):
    """A file that is not, byte for byte, a result as the program wrote it; the message is why, without the name."""


def check_seal(path: Path) -> str:
    """The checksum of a whole result, 16 digits. Raises SealError, FileNotFoundError, OSError."""
    # a pipe or a device would not end
    if not stat.S_ISREG(path.stat().st_mode):
        raise SealError("is a folder, expected a result file (.h5)" if path.is_dir() else "is no regular file")
    with path.open("rb") as file:
        size = file.seek(0, 2) - SEAL_BYTES
        file.seek(max(size, 0))
        found = _LINE.fullmatch(file.read())
        file.seek(0)
        if not found or int(found[2]) != size:
            if file.read(len(_SIGNATURE)) != _SIGNATURE:
                raise SealError("not an HDF5 file, or a damaged one")
            raise SealError("no result of asperity, or one that is not complete, or was changed: it does not end with its checksum")
        if checksum_of(file, size) != found[1].decode():
            raise SealError("damaged: its bytes are not those of its checksum")
    return found[1].decode()


def checksum_of(file: BinaryIO, size: int, before: str = "") -> str:
    """Fletcher's sums of the next `size` bytes, filled up with zeros to a multiple of 8, and of those `before`: 16 digits."""
    second, first = int(before[:8] or "0", 16), int(before[8:] or "0", 16)
    while size > 0 and (piece := file.read(min(size, 4 * _WORDS))):
        size -= len(piece)
        first, second = _added(first, second, np.frombuffer(piece + bytes(-len(piece) % 8), "<u4").astype(np.uint64))
    return f"{second:08X}{first:08X}"


def _added(first: int, second: int, words: npt.NDArray[np.uint64]) -> tuple[int, int]:
    """The sums after further words: the second one is that of all values of the first."""
    later = int(np.dot(words, _WEIGHTS[-len(words) :]))
    return (first + int(words.sum())) % _MODULUS, (second + len(words) * first + later) % _MODULUS
