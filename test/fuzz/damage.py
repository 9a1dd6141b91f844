"""Damage to the bytes of a file, as disks, copies and editors do it."""

import random


def damaged(content: bytes, source: random.Random) -> bytes:
    """`content` with bytes flipped, zeroed, cut off or swapped, in one to four places; never the same as before."""
    while True:
        result = bytearray(content)
        for _ in range(source.choice([1, 1, 2, 4])):
            change_once(result, source)
        if result != content:
            return bytes(result)


def change_once(content: bytearray, source: random.Random) -> None:
    """One change, anywhere or among the first bytes, where the structure of an HDF5 file is."""
    if not content:
        return
    length = min(source.choice([1, 8, 64, 512, 4096]), len(content))
    place = source.randrange(source.choice([len(content), min(len(content), 2048)]))
    piece = content[place : place + length]
    kind = source.choice(["bit", "byte", "zero", "ones", "cut", "swap"])
    if kind == "bit":
        content[place] ^= 1 << source.randrange(8)
    elif kind == "byte":
        content[place] = source.randrange(256)
    elif kind in ("zero", "ones"):
        content[place : place + len(piece)] = (b"\0" if kind == "zero" else b"\xff") * len(piece)
    elif kind == "cut":
        del content[source.choice([place, len(content) - min(length, len(content))]) :]
    else:
        other = source.randrange(len(content) - len(piece) + 1)
        content[place : place + len(piece)] = content[other : other + len(piece)]
        if abs(other - place) >= len(piece):
            content[other : other + len(piece)] = piece
