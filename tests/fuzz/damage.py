"""Damage to the files of a store, and edits of its JSON, drawn at random; nothing here knows what a store holds."""

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

HOSTILE: list[Any] = [
    *(None, True, 0, -1, 7, 1e30, 10**15, 10**400, -0.5, float("nan"), float("inf"), "", "abc"),
    *("../victim.zarr/time", "/tmp/../etc", "a\x1b]0;gone\x07b"),  # noqa: S108  # a name that leaves the store
    *("fuzz.marker:touch", "subprocess:call", [], {}, [1, 2, 3], ["abc"] * 3, {"a": 1}, "deep"),
]
_DEPTH = 20_000


def damage_file(store: Path, chance: random.Random) -> str:
    """Damage one file of a store, or swap two; say what was done."""
    files = sorted(path for path in store.rglob("*") if path.is_file())
    file = chance.choice(files)
    kind = chance.choice(sorted(_DAMAGES))
    if kind == "swap":
        other = chance.choice(files)
        one, two = file.read_bytes(), other.read_bytes()
        file.write_bytes(two)
        other.write_bytes(one)
        return f"swap {file.relative_to(store)} and {other.relative_to(store)}"
    _DAMAGES[kind](file, chance)
    return f"{kind} {file.relative_to(store)}"


def _flip(file: Path, chance: random.Random) -> None:
    data = bytearray(file.read_bytes())
    for _ in range(chance.choice([1, 1, 3, 50]) if data else 0):
        data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    file.write_bytes(data)


def _cut(file: Path, chance: random.Random) -> None:
    data = file.read_bytes()
    file.write_bytes(data[: chance.randrange(len(data) + 1)])


def _zero(file: Path, chance: random.Random) -> None:
    data = bytearray(file.read_bytes())
    begin = chance.randrange(len(data) + 1)
    file.write_bytes(data[:begin] + bytes(len(data) - begin))


_DAMAGES: dict[str, Callable[[Path, random.Random], Any]] = {
    "flip": _flip,
    "cut": _cut,
    "zero": _zero,
    "empty": lambda file, _: file.write_bytes(b""),
    "delete": lambda file, _: file.unlink(),
    "append": lambda file, chance: file.write_bytes(file.read_bytes() + chance.randbytes(chance.choice([1, 8, 4096]))),
    "random": lambda file, chance: file.write_bytes(chance.randbytes(len(file.read_bytes()))),
    "swap": lambda file, chance: None,  # noqa: ARG005
}


def edit_json(store: Path, chance: random.Random) -> str:
    """Remove, replace or add one entry of one JSON file of a store; say what was done."""
    files = [path for path in sorted(store.rglob("*.json")) if _has_entries(path)]
    file = store / "zarr.json" if chance.random() < 0.6 else chance.choice(files)
    data = json.loads(file.read_text())
    place, where = chance.choice(list(_places(data))), ""
    parent = data
    for key in place[:-1]:
        parent, where = parent[key], f"{where}.{key}"
    where = f"{file.relative_to(store)} {where}.{place[-1]}"
    if chance.random() < 0.25:
        del parent[place[-1]]
        done = f"remove {where}"
    else:
        parent[place[-1]] = value = _other(parent[place[-1]], chance)
        done = f"set {where} = {str(value)[:40]!r}"
    file.write_text(json.dumps(data).replace('"deep"', "[" * _DEPTH + "]" * _DEPTH))
    return done


def _has_entries(file: Path) -> bool:
    """Tell whether a file is JSON with entries; marks of blocks have a sum before it."""
    try:
        return isinstance(json.loads(file.read_text()), dict)
    except ValueError:
        return False


def _other(value: Any, chance: random.Random) -> Any:
    """Return a hostile value, or one like that which stands there."""
    if isinstance(value, int | float) and not isinstance(value, bool) and chance.random() < 0.5:
        return chance.choice([value + 1, 7 * value + 1, -value, value * 1e6, str(value), [value]])
    if isinstance(value, str) and chance.random() < 0.3:
        return chance.choice([value + "x", value[:-1], value.upper(), "../" + value])
    if isinstance(value, list) and value and chance.random() < 0.5:
        return chance.choice([value[:-1], value[::-1], [*value, value[0]], [value]])
    return chance.choice(HOSTILE)


def _places(data: Any, before: tuple[Any, ...] = ()) -> Any:
    """Yield the keys to each entry of nested data."""
    entries = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in entries:
        yield [*before, key]
        yield from _places(value, (*before, key))
