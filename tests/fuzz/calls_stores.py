"""Calls that write and read stores, and of sweeps; they work in a folder with the stores of `fuzz.shelf`."""

from types import SimpleNamespace
from typing import Any

import numpy as np
from fuzz import shelf
from fuzz.calls import Call, by_position, call
from fuzz.calls_maps import TOP
from fuzz.kinds import anything, array, count, flag, function, integer, number, path, positive, text, thing

import nonholo as nh


def calls() -> list[Call]:
    """Return the calls of this file."""
    return [*_orbits(), *_sweeps(), *_designs(), *_blocks()]


def _family(*, a: float = 0.5) -> Any:
    return SimpleNamespace(system=nh.ChaplyginSleigh(1.0, 1.0, a), configuration=np.eye(3), body_velocity=np.eye(3)[1])


def _orbits() -> list[Call]:
    store, other = path(shelf.ORBIT), {"discrete": anything(None)}
    saved = {"path": path("new.zarr"), "overwrite": flag(False), "scenario": text("a = 1", none=True)}
    how = {"throw": flag(True), "progress": flag(False), "trust": flag(False)}
    orbit = nh.simulate(TOP, restricted_velocity=(0.3, 0.2), steps=4)
    return [
        call("save_orbit", orbit=thing(orbit), **saved),
        call("load_orbit", path=store, **other, stores=True),
        call("resume", store=path(shelf.UNFINISHED), **other, **how, events=anything(None), stores=True),
        call("resume [sweep]", store=path(shelf.SWEEP_UNFINISHED), task=function(shelf.task), stores=True),
        call("extend", store=path(shelf.RUN), steps=count(8), **other, **how, stores=True),
        call("io.store_to_csv", by_position(nh.io.store_to_csv), store=store, path=path("new.csv"), stores=True),
    ]


def _sweeps() -> list[Call]:
    where = {"store": path("new.zarr"), "scheduler": text("synchronous", none=True)}
    how = {"workers": count(1, none=True), "block": count(2, none=True), "resume": flag(False), "progress": flag(False)}
    task = {"discrete": thing(TOP), "steps": count(3), "restricted_velocity": array([0.3, 0.2])}
    names = {"reductions": anything(["final_state"]), "save_every": count(1, none=True)}
    family = {"family": function(_family), "time_step": positive(0.1), "steps": count(3)}
    data = {"orbits": count(3), "steps": count(3), "time_step": positive(0.1), "rng": integer(0)}
    labels = {"noise": number(0.1), "split": array([0.5, 0.25, 0.25]), "progress": flag(False)}
    labels |= {"file_format": text("csv"), "license_name": text("MIT")}
    return [
        call("sweep", task=function(shelf.task), design=thing(shelf.DESIGN), **where, **how),
        call("load_sweep", store=path(shelf.SWEEP), stores=True),
        call("dataset", name=text("sleigh"), folder=path("sleighs"), **data, **labels),
        call("FamilyTask", **family, **names, parameters=anything({"a": 2.0})),
        call("EnsembleTask", **task, **names, reconstruct=flag(True)),
    ]


def _designs() -> list[Call]:
    axis, uniform = array([1.0, 2.0], "any"), nh.Uniform(0.0, 1.0)
    grid = lambda x, y, rng: nh.Grid({"x": x, "y": y}, rng)  # noqa: E731
    drawn = lambda members, x, rng: nh.RandomDesign(members, {"x": x}, rng)  # noqa: E731
    return [
        call("Grid", grid, x=axis, y=array([[0.0, 1.0], [1.0, 2.0]], "any"), rng=integer(0)),
        call("Grid [axes]", axes=anything({"x": [1.0]}), rng=integer(0)),
        call("RandomDesign", drawn, members=count(4), x=thing(uniform), rng=integer(0)),
        call("RandomDesign [distributions]", members=count(4), distributions=anything({"x": uniform})),
        call("Uniform", low=array(0.0, "any"), high=array(1.0, "any")),
        call("LogUniform", low=array(0.5, "any"), high=array(1.0, "any")),
        call("Normal", mean=number(0.0), deviation=positive(1.0), size=count(2, none=True)),
        call("Direction", size=count(2), length=positive(1.0)),
        call("MassTensor", n=count(3), low=positive(0.5), high=positive(2.0)),
        call("Choice", values=array([1.0, 2.0, 4.0], "any")),
    ]


def _blocks() -> list[Call]:
    design, block = nh.RandomDesign(4, {"x": nh.Uniform(0.0, 1.0)}), nh.MemberBlock(0, 3, 0, {"x": np.arange(3.0)})
    return [
        call("MemberBlock.random", block.random, width=count(2), stream=text("")),
        call("MemberBlock.part", block.part, begin=integer(0), end=integer(2)),
        call("RandomDesign.values", design.values, first=integer(0), count=count(3)),
    ]
