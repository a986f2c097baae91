"""Damage to the files of a store."""

from pathlib import Path

DAMAGE = ("missing", "flipped", "cut", "empty")


def damage(file: Path, how: str) -> None:
    """Take a file away, change a bit in its middle, cut its end off, or leave nothing in it."""
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.unlink()
    if how != "missing":
        file.write_bytes({"flipped": content, "cut": content[:-3], "empty": b""}[how])


def swap(store: Path, one: str, other: str) -> None:
    """Let two files of a store change places."""
    first, second = (store / one).read_bytes(), (store / other).read_bytes()
    assert first != second
    (store / one).write_bytes(second)
    (store / other).write_bytes(first)
