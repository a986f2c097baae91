"""What a store says about itself: system, motion, conventions, versions; and the way back to objects."""

import dataclasses
import hashlib
import json
import platform
from collections.abc import Callable
from importlib.metadata import version
from typing import Any

import numpy as np

from nonholo import systems
from nonholo._checks import error
from nonholo.continuous import ContinuousFlow
from nonholo.discrete import discretize
from nonholo.orbit import AbstractMotion, Orbit
from nonholo.systems import AbstractLLSystem

FORMAT = "nonholo.orbit"
SCHEMA = 1
_CALLABLE = "callable"
_MOTIONS: dict[str, Callable[..., AbstractMotion]] = {"Discretization": discretize, "ContinuousFlow": ContinuousFlow}
_CONVENTIONS = (
    "W_k = g_k^-1 g_(k+1), P_k is the momentum at W_k, momenta are physical (L_d includes time_step). "
    "reduced_momentum: along the constraint subspace; cayley: y with W = cayley(2 y); pose: unit quaternion, scalar "
    "first, on SO(3), (cos, sin, x, y) on SE(2); all three in the canonical body frame of the system. "
    "se(2) coordinates are (omega, v1, v2), so(3) the usual vector; the pairing is the dot product."
)


def attributes(orbit: Orbit) -> dict[str, Any]:
    """Return everything but arrays that is needed to rebuild an orbit and to say how it was made."""
    return {
        "format": FORMAT,
        "schema": SCHEMA,
        **_identity(orbit.motion),
        "outcome": orbit.outcome.name,
        "save_every": orbit.save_every,
        "precision": "float64",
        "conventions": _CONVENTIONS,
        "versions": json.dumps(_versions()),
    }


def attributes_of_text(scenario: str) -> dict[str, str]:
    """Return a scenario and its SHA-256 as attributes."""
    return {"scenario": scenario, "scenario_sha256": hashlib.sha256(scenario.encode()).hexdigest()}


def restore_motion(stored: dict[str, Any], motion: AbstractMotion | None) -> AbstractMotion:
    """Rebuild the motion of a store, or check that the one given is the stored one.

    A callable cannot be stored: such a motion has to be given.
    """
    if motion is not None:
        return _same(stored, motion)
    described = json.loads(stored["motion"])
    if _CALLABLE in described.values():
        name = next(key for key, value in described.items() if value == _CALLABLE)
        remedy = f"Pass load_orbit(path, discrete=...) with the discretisation whose {name} made this store."
        raise error("load_orbit(path=...)", "be rebuilt from data", f"a store whose {name} is a callable", remedy)
    kind = described.pop("kind")
    system = _restore_system(stored["system"], json.loads(stored["parameters"]))
    if kind not in _MOTIONS:
        raise error("load_orbit(path=...)", "hold a motion of this version", repr(kind), "Upgrade nonholo.")
    return _MOTIONS[kind](system, **described)


def _same(stored: dict[str, Any], motion: AbstractMotion) -> AbstractMotion:
    for key, value in _identity(motion).items():
        if value != stored[key]:
            got = f"{key} {value} instead of {stored[key]}"
            raise error("load_orbit(discrete=...)", "be the discretisation of the store", got, "Pass that one.")
    return motion


def _identity(motion: AbstractMotion) -> dict[str, str]:
    """Return what a motion is, with floating-point numbers written so that they are read back exactly."""
    described = {"kind": type(motion).__name__, **_fields(motion)}
    parameters = _fields(motion.system)
    return {
        "system": type(motion.system).__name__,
        "parameters": json.dumps(parameters),
        "motion": json.dumps({key: value for key, value in described.items() if key != "system"}),
    }


def _fields(owner: Any) -> dict[str, Any]:
    return {field.name: _plain(getattr(owner, field.name)) for field in dataclasses.fields(owner)}


def _plain(value: Any) -> Any:
    if callable(value):
        return _CALLABLE
    return value if isinstance(value, str | AbstractLLSystem) else np.asarray(value).tolist()


def _restore_system(kind: str, parameters: dict[str, Any]) -> AbstractLLSystem:
    found = getattr(systems, kind, None)
    if not (isinstance(found, type) and issubclass(found, AbstractLLSystem)):
        remedy = "Upgrade nonholo or, for a system of your own, pass load_orbit(path, discrete=...)."
        raise error("load_orbit(path=...)", "hold a system of this version", repr(kind), remedy)
    return found(**parameters)


def _versions() -> dict[str, str]:
    packages = ("nonholo", "numpy", "numba", "zarr")
    return {"python": platform.python_version()} | {name: version(name) for name in packages}
