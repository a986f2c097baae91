"""Calls that draw pictures; each closes what it has drawn."""

import tempfile

import matplotlib as mpl
import numpy as np
from fuzz import shelf
from fuzz.calls import Call, call, closed
from fuzz.calls_maps import DISCRETE, SLEIGH, TOP
from fuzz.calls_runs import moving
from fuzz.kinds import Argument, anything, array, count, flag, function, number, path, positive, text, thing
from fuzz.marker import turned

import nonholo as nh

mpl.use("agg")


def calls() -> list[Call]:
    """Return the calls of this file."""
    return [*_of_orbits(), *_of_maps(), *_of_others()]


def _drawn(name: str, **arguments: Argument) -> Call:
    return call(f"plot.{name}", closed(getattr(nh.plot, name)), **arguments, slow=True)


def _of_orbits() -> list[Call]:
    top = thing(nh.simulate(TOP, restricted_velocity=(0.3, 0.2), steps=6))
    free = thing(nh.simulate(DISCRETE["free"], body_velocity=(0.3, 0.2, 0.1), steps=6))
    sleigh = thing(nh.simulate(SLEIGH, body_velocity=(1.0, 0.3, 0.0), steps=6))
    axes, view, flow = anything(None), anything((30.0, 20.0)), anything(None)
    look = {"title": text("mine", none=True), "label": text("one", none=True)}
    look |= {"color": anything("C1"), "size": anything((4.0, 3.0))}
    look |= dict.fromkeys(("legend", "annotate", "dark"), anything(True))
    movie = {"path": path("new.gif"), "frames": count(2), "fps": positive(5.0)}
    return [
        _drawn("blade_track", orbit=sleigh, axes=axes, flow=flow, enlarge=flag(True)),
        _drawn("body_axis_track", orbit=top, axes=axes, flow=flow, view=view, body_axis=array([0, 0, 1.0], none=True)),
        _drawn("energy_error", orbit=top, axes=axes, **look),
        _drawn("momentum_sphere", orbit=free, axes=axes, view=view),
        _drawn("overview", orbit=top, path=path("new.png", none=True), flow=flow),
        _drawn("point_track", orbit=sleigh, axes=axes, flow=flow),
        _drawn("animate", orbit=sleigh, **movie, progress=function(None, none=True)),
    ]


def _of_maps() -> list[Call]:
    top, sleigh, axes, orbit = {"discrete": thing(TOP)}, {"discrete": thing(SLEIGH)}, anything(None), anything(None)
    tree = nh.branch_tree(TOP, nh.SO(3).exp(np.array([0.2, 0.1, 0.0])), 2)
    locus, normal = thing(nh.momentum_locus(TOP, 12)), array([0.0, 0.0, 1.0])
    energies = array([0.5, 1.0], "any", none=True)
    return [
        _drawn("branch_counts", **sleigh, orbit=orbit, axes=axes),
        _drawn("branch_tree", **top, tree=thing(tree), axes=axes),
        _drawn("branches", **top, momentum=array([0.1, 0.2]), plane=text(None, none=True)),
        _drawn("invariant_curves", **top, orbit=orbit, axes=axes, energies=energies),
        _drawn("locus_section", locus=locus, normal=normal, offset=number(0.0), axes=axes),
        _drawn("momentum_locus", locus=locus, orbit=orbit, curve=anything(None), view=anything((30.0, 20.0))),
        _drawn("phase_portrait", system=thing(TOP.system), orbit=orbit, energies=energies, branches=text("principal")),
    ]


def _of_others() -> list[Call]:
    orbit = nh.simulate(SLEIGH, body_velocity=(6.0, 0.3, 0.0), steps=300)
    slow = nh.simulate(nh.discretize(SLEIGH.system, 0.05), body_velocity=(6.0, 0.3, 0.0), steps=600)
    errors, orders = thing(nh.compare(orbit, slow)), thing(nh.compare([orbit, slow], slow))
    saved = {"path": path("new.png", none=True)}
    section, across = nh.crossings(orbit, nh.Event(turned)), function(moving)
    with tempfile.TemporaryDirectory() as folder:
        result = nh.sweep(shelf.task, shelf.DESIGN, f"{folder}/new.zarr", "synchronous").load()
    name = text(None, none=True)
    labels = anything(("one", "other"))
    return [
        _drawn("comparison", comparison=errors, **saved),
        _drawn("convergence", convergence=orders, **saved),
        _drawn("section", crossings=thing(section), across=across, up=across, axes=anything(None), labels=labels),
        _drawn("sweep_map", result=thing(result), quantity=text("total"), x=name, y=name),
    ]
