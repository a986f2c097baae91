"""Stores of which something is lost or damaged: it is named, never read as data, and computed again where it can be."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from ensembles.small import resumed, same, swept

import nonholo as nh
from nonholo.ensembles import standing_of

ARRAYS = {"total": "c/1/0", "noise": "c/1/0/0", "outcome": "c/1/0"}


def _damage(file: Path, how: str) -> None:
    content = bytearray(file.read_bytes())
    if how == "missing":
        file.unlink()
        return
    content[len(content) // 2] ^= 1
    file.write_bytes({"flipped": content, "cut": content[:-3], "empty": b""}[how])


@pytest.mark.parametrize("array", ARRAYS)
@pytest.mark.parametrize("damage", ["missing", "flipped", "cut", "empty"])
def test_damaged_chunk_is_named_and_computed_again(array: str, damage: str, tmp_path: Path) -> None:
    """A missing, changed or cut chunk is never read: it is named, refused by `load_sweep`, and computed again."""
    path = tmp_path / "run.zarr"
    whole = swept(path)
    _damage(path / array / ARRAYS[array], damage)
    named = f"chunk {ARRAYS[array]} of the array {array}"
    with pytest.raises(ValueError, match=named):
        nh.load_sweep(path)
    with pytest.warns(RuntimeWarning, match=f"{named}. Block 1 is computed again"):
        assert same(resumed(path), whole)
    assert same(nh.load_sweep(path), whole)
    assert same(resumed(path), whole), "a sound store is opened in silence"


@pytest.mark.parametrize("name", ["x", "restricted_velocity"])
def test_damaged_draws_are_computed_again(name: str, tmp_path: Path) -> None:
    """What a random design drew is kept beside the results, and is as safe; also in a last chunk that is not full."""
    path, design = tmp_path / "run.zarr", nh.RandomDesign(5, {name: nh.Uniform(0.0, 1.0)}, seed=2)
    task: Callable[[nh.MemberBlock], Any] = lambda block: block[name] ** 2  # noqa: E731
    whole = nh.sweep(task, design, path, block=2).load()
    _damage(path / name / "c" / "2", "flipped")
    with pytest.warns(RuntimeWarning, match=f"chunk c/2 of the array {name}"):
        assert same(nh.resume(path, task=task).load(), whole)


@pytest.mark.parametrize("damage", ["flipped", "cut", "empty"])
def test_damaged_mark_is_named_and_its_block_computed_again(damage: str, tmp_path: Path) -> None:
    """A block whose mark cannot be trusted is computed again."""
    path = tmp_path / "run.zarr"
    whole = swept(path)
    _damage(path / "run" / "blocks" / "2.json", damage)
    assert standing_of(path).done == 4
    with pytest.warns(RuntimeWarning, match=r"the mark 2\.json is damaged. Block 2 is computed again"):
        assert same(resumed(path), whole)
    assert standing_of(path).done == 6


def test_lost_mark_is_a_block_to_do(tmp_path: Path) -> None:
    """A block without a mark is one that was not finished, and is done in silence."""
    path = tmp_path / "run.zarr"
    whole = swept(path)
    _damage(path / "run" / "blocks" / "0.json", "missing")
    _damage(path / "total" / "c" / "0" / "0", "cut")
    assert same(resumed(path), whole)


@pytest.mark.parametrize("damage", ["missing", "flipped", "cut", "empty"])
@pytest.mark.parametrize("axis", ["x", "start"])
def test_lost_axis_is_refused(axis: str, damage: str, tmp_path: Path) -> None:
    """Where the values along an axis are gone, nothing is invented."""
    path = tmp_path / "run.zarr"
    swept(path)
    _damage(path / axis / ("c/0" if axis == "x" else "c/0/0"), damage)
    with pytest.raises(ValueError, match=f"hold the axis {axis}.*Run the sweep again"):
        resumed(path)


@pytest.mark.parametrize("damage", ["missing", "cut", "empty"])
@pytest.mark.parametrize(
    ("place", "match"), [("", "zarr.json"), ("noise", "hold the array noise"), ("x", "hold the array x")]
)
def test_lost_metadata_are_refused(place: str, match: str, damage: str, tmp_path: Path) -> None:
    """Where metadata are gone, what they are of is named."""
    path = tmp_path / "run.zarr"
    swept(path)
    _damage(path / place / "zarr.json", damage)
    with pytest.raises(ValueError, match=match):
        resumed(path)
    with pytest.raises(ValueError, match=match if place else "must be a store of a sweep"):
        swept(path, resume=True)
