"""`dataset`: the folder of a data set."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from nonholo import io
from nonholo.base import checks
from nonholo.base.checks import array, choice, count, error, flags, number, refuse_former_names, scale, seed, text
from nonholo.ensembles._names import function_name
from nonholo.ensembles._sweep import sweep
from nonholo.ensembles.datasets import DEFINITIONS, SPLITS, DatasetTask, card, family_of, record_of, write_tables
from nonholo.ensembles.designs import RandomDesign
from nonholo.ensembles.stores import open_store

STORE, METADATA, CARD = "orbits.zarr", "metadata.json", "README.md"
_REMEDY = "`nonholo dataset --list` describes them; a function may be your own."


@refuse_former_names("dataset", seed="rng")
def dataset(
    name: str | Callable[..., Any],
    folder: str | Path,
    *,
    orbits: int = 1000,
    steps: int = 500,
    time_step: float | None = None,
    rng: int | np.random.Generator = 0,
    noise: float = 0.0,
    split: Any = (0.8, 0.1, 0.1),
    file_format: str = "zarr",
    license_name: str = "CC0-1.0",
    progress: bool = False,
) -> Path:
    """Write a data set of orbits of a ready system or your own, for people who train models.

    First configurations and kinetic energies, or arguments of a function that makes systems with their starts, are
    drawn from the distributions of the definition, which has a version.
    Orbit i is the same in every data set with this `rng`, time step and version, however many there are. Each row is a
    state; the row after it is the next one. An orbit that ends early has NaN in its later rows, and `outcome` has the
    reason.

    The folder gets `orbits.zarr`, which `xarray.open_zarr` opens, or tables `train.csv`, `validation.csv`, `test.csv`;
    `metadata.json` with the SHA-256 of every array; and `README.md`, a data card. A call that was stopped is resumed by
    the same call.

    Args:
        name: A data set; `nonholo dataset --list` lists them. Or a custom function: its result has a `system`, a
            `configuration` and a `body_velocity`, as an `nh.examples.Example` has, and its arguments whose default is a
            distribution are drawn for each orbit, of the start, of inputs, of `parameters`. Its version is 0.
        folder: A new folder, or that of the same call, stopped.
        orbits: How many.
        steps: Number of steps N; there are N + 1 states.
        time_step: h; by default that of the definition, mostly 0.05.
        rng: An integer that all random numbers are made of, or a generator that draws it.
        noise: Standard deviation of normal noise, in the unit of each number: fields `observed_...` have it.
        split: Fractions of the orbits for training, validation and test, in this order.
        file_format: "zarr" or "csv".
        license_name: The license in the data card.
        progress: Show a progress bar on standard error.

    Returns:
        The folder.

    Raises:
        ValueError: A bad argument, or a folder with another data set that is not finished, with the difference.
        FileExistsError: There is something at the path.
        BlockingIOError: Another process is writing it.
        OSError: The disk is full; the same call resumes.

    Example:
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as parent:
        ...     folder = nh.dataset("sleigh", f"{parent}/sleighs", orbits=20, steps=10)
        ...     orbits = nh.load_sweep(folder / "orbits.zarr")
        ...     orbits.heading.shape, orbits.split.values[:17].tolist().count(0)
        ((20, 11), 16)
    """
    label = function_name(name) if callable(name) else choice("dataset(name=...)", name, tuple(DEFINITIONS), _REMEDY)
    definition = family_of(name) if callable(name) else DEFINITIONS[label]
    choice("dataset(file_format=...)", file_format, ("zarr", "csv"))
    flags("dataset", progress=progress)
    text("dataset(license_name=...)", license_name)
    members = count("dataset(orbits=...)", orbits, "Pass how many.")
    h = definition.time_step if time_step is None else time_step
    h = float(scale("dataset(time_step=...)", h, "Pass a positive time step."))
    steps = count("dataset(steps=...)", steps, "Pass the number of steps.")
    if (deviation := float(number("dataset(noise=...)", noise))) < 0:
        raise error("dataset(noise=...)", "not be negative", f"{deviation}", "Pass a standard deviation, or 0.")
    task = DatasetTask(label, definition, h, steps, deviation, _ends(split, members))
    design = RandomDesign(members, definition.distributions, seed("dataset(rng=...)", rng))
    target = _checked_folder(folder)
    sweep(task, design, target / STORE, resume=True, progress=progress)
    store = open_store(target / STORE)
    if file_format == "csv":
        write_tables(store, target, task.parts)
    record = record_of(store, task, file_format, license_name)
    io.blocks.write_whole(target / CARD, card(record))
    io.blocks.write_whole(target / METADATA, json.dumps(record, indent=1, default=repr) + "\n")  # last: now it is whole
    if file_format == "csv":
        shutil.rmtree(store.path)
    return target


def _ends(split: Any, orbits: int) -> tuple[int, ...]:
    """Return the first orbit after each part, from fractions."""
    where, remedy = "dataset(split=...)", "Pass fractions for training, validation and test, such as (0.8, 0.1, 0.1)."
    fractions = array(where, split, (len(SPLITS),), remedy)
    if (fractions < 0).any() or abs(fractions.sum() - 1) > 1e-9:
        raise error(where, "be fractions whose sum is 1", f"{fractions.tolist()}", remedy)
    return tuple(round(end) for end in (orbits * np.cumsum(fractions)).tolist())


def _checked_folder(folder: Any) -> Path:
    """Return a folder that is new, or that of a call that was stopped."""
    target = checks.checked_path("dataset(folder=...)", folder)
    is_partial = (target / STORE / "zarr.json").exists() and not (target / METADATA).exists()
    is_empty = target.is_dir() and all(each.name.startswith(".") for each in target.iterdir())  # left by a killed call
    if target.exists() and not (is_partial or is_empty):
        raise FileExistsError(f"`dataset(folder=...)` must be new. Got '{target}', which exists. Choose another path.")
    return target
