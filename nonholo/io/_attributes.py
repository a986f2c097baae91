"""The attributes of a store: system, motion, conventions, versions; and the way back to objects."""

import contextlib
import dataclasses
import functools
import hashlib
import importlib
import json
import platform
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from nonholo.base.checks import error, instance, text
from nonholo.base.compiled import way_of_kernels
from nonholo.continuous import ContinuousFlow
from nonholo.discrete import MeasuredMotion, discretize
from nonholo.io._descriptions import (
    described_system,
    fields_of,
    missing_part,
    recorded_system,
    restore_group,
    restore_system,
)
from nonholo.orbit import AbstractMotion, AbstractOrbit
from nonholo.systems import AbstractCoordinateDiscretization

FORMAT = "nonholo.orbit"
SWEEP_FORMAT = "nonholo.sweep"
SCHEMA = 5
"""Written by this version, and read. Those below 5 are of before 0.3.0, from which on later versions read stores."""
_MOTIONS: dict[str, Callable[..., Any]] = {
    **dict.fromkeys(("Discretization", "CoordinateDiscretization", "GroupDiscretization"), discretize),
    "CoordinateFlow": lambda system: importlib.import_module("nonholo.lagrange_dalembert").CoordinateFlow(system),
    "ContinuousFlow": ContinuousFlow,
    "MeasuredMotion": MeasuredMotion,
}
_CONVENTIONS = (
    "W_k = g_k^-1 g_(k+1), P_k is the momentum at W_k, momenta are physical (L_d includes time_step). Arrays are in "
    "the user's body frame; quaternions are unit, scalar first, Hamilton's product, and take body coordinates to "
    "space. The group canonical holds what runs continue from, in the canonical body frame of the system. "
    "reduced_momentum: along the constraint subspace; for a right-invariant constraint (LR systems) that of the "
    "spatial momentum. cayley: coordinates y of the displacement along rows S, "
    "W = retract(2 y S), the Cayley map on SO(n), SE(n) and groups with a form, else exp; S are the rows of the "
    "constraint subspace or, "
    "where y has dim components, all of the algebra; for LR systems of the spatial displacement "
    "U_k = g_(k+1) g_k^-1. pose: unit quaternion, scalar first, on SO(3); (cos, sin, x, y) on SE(2); rotation matrix "
    "row by row on SO(n), followed by the position on SE(n); vector of translations; matrix row by row on other "
    "groups; factors one after another. se(2) coordinates are (omega, v1, v2), so(3) the usual vector, so(n) the "
    "coefficients of e_i ^ e_j, i < j, se(n) those of so(n), then v; the pairing is the dot product."
)


_IN_COORDINATES = (
    "Arrays are what the orbit tells (docstrings of nonholo.lagrange_dalembert.CoordinateOrbit, GroupOrbit): "
    "displacement, momentum, energy and constraint_residual are those of the single step from each state, multipliers "
    "the impulses of that step, NaN where it was not taken; body_velocity is displacement / time_step, on a group its "
    "logarithm. Of a flow they are those at its times."
)


def attributes(orbit: AbstractOrbit) -> dict[str, Any]:
    """Return everything but arrays that is needed to rebuild an orbit and to describe its making."""
    return {
        "format": FORMAT,
        "schema": SCHEMA,
        **identity_of(orbit.motion),
        "outcome": orbit.outcome.name,
        "save_every": orbit.save_every,
        "branch": orbit.branch,
        "precision": "float64",
        "conventions": _CONVENTIONS if orbit.is_compact else _IN_COORDINATES,
        "versions": versions_text() if orbit.is_compact else versions_text("jax", "jaxlib"),
        "kernels": way_of_kernels(),
    }


def attributes_of_text(scenario: str) -> dict[str, str]:
    """Return a scenario and its SHA-256 as attributes."""
    text("scenario=...", scenario)
    return {"scenario": scenario, "scenario_sha256": hashlib.sha256(scenario.encode()).hexdigest()}


def restore_motion(attributes: dict[str, Any], motion: Any) -> Any:
    """Rebuild the motion of a store, or check that the one given is the stored one.

    Callables and groups of the user's own cannot be stored: such a motion has to be given. In coordinates, where stores
    hold all that an orbit tells, it is one that cannot run.
    """
    where = "load_orbit(path=...)"
    if motion is not None:
        kinds: Any = (AbstractMotion, AbstractCoordinateDiscretization)
        remedy = "Pass that of the store, or None."
        return _same(attributes, instance("load_orbit(discrete=...)", motion, kinds, "be a discretization", remedy))
    options = json.loads(attributes["motion"])
    kind, route = options.pop("kind"), options.pop("route", None)
    remedy = f"Pass load_orbit(path, discrete=...) with the {kind} that made this store."
    system = system_of(attributes, where, remedy, missing_part(options))
    if kind not in _MOTIONS:
        raise error(where, "hold a motion of this version", repr(kind), "Upgrade nonholo.")
    motion_again = on_route_of(attributes, _MOTIONS[kind](system, **options))
    if type(motion_again).__name__ != kind or route != motion_again.route_name:
        raise error(where, "hold a run by a route of this version", repr(route or kind), "Upgrade nonholo.")
    return motion_again


def system_of(attributes: dict[str, Any], where: str, remedy: str, missing: str | None = None) -> Any:
    """Return the system of a store; in coordinates, what is known of one whose functions it does not hold."""
    name, parameters = attributes["system"], json.loads(attributes["parameters"])
    group, absent = parameters.get("group"), missing or missing_part(parameters)
    if not absent:
        return restore_system(name, parameters)
    if missing or "orbits" not in parameters or missing_part({"group": group}):
        raise error(where, "be rebuilt from data", f"a store whose {absent}", remedy)
    return recorded_system(name, parameters, None if group is None else restore_group(group))


def _same(attributes: dict[str, Any], motion: Any) -> Any:
    motion = on_route_of(attributes, motion)
    for key, value in identity_of(motion).items():
        if value != attributes[key]:  # JSON text: floating-point numbers are compared exactly
            got = f"{key} {value} instead of {attributes[key]}"
            raise error("load_orbit(discrete=...)", "be the discretization of the store", got, "Pass that one.")
    return motion


def on_route_of(attributes: dict[str, Any], motion: Any) -> Any:
    """Return a motion by the route that began a store, or the next one; the motion itself where that is its own."""
    if motion.route_name is None:
        return motion
    other = dataclasses.replace(motion, wanted_route=json.loads(attributes["motion"]).get("route"))
    return motion if other.route_name == motion.route_name else other


def identity_of(motion: Any) -> dict[str, str]:
    """Return what a motion is."""
    options = {"kind": type(motion).__name__, **fields_of(motion)}
    if motion.route_name is not None:
        options["route"] = motion.route_name
    system, parameters = described_system(motion.system)
    return {
        "system": system,
        "parameters": json.dumps(parameters),
        "motion": json.dumps({key: value for key, value in options.items() if key != "system"}),
    }


def other_versions(attributes: dict[str, Any]) -> str:
    """Name the packages of which a store was made with another version; empty if there is none."""
    theirs = json.loads(attributes["versions"])
    now = _versions(*theirs)
    return ", ".join(f"{name} {old} (now {now.get(name)})" for name, old in theirs.items() if old != now.get(name))


@functools.cache  # each is read from a file
def versions_text(*others: str) -> str:
    """Return the versions of what computes, as JSON: of the core, and of other packages."""
    return json.dumps(_versions("nonholo", "numpy", "numba", "zarr", *others))


def _versions(*packages: str) -> dict[str, str]:
    versions = {"python": platform.python_version()}
    for name in packages:
        with contextlib.suppress(PackageNotFoundError):
            versions |= {name: version(name)} if name not in versions else {}
    return versions
