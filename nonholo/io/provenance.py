"""The attributes of a store: system, motion, conventions, versions; and the way back to objects.

Systems, forces and groups are described by plain data, functions of the user's own by a mark.
"""

import contextlib
import dataclasses
import functools
import hashlib
import importlib
import json
import platform
from collections.abc import Callable, Iterator, Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, NonNegativeInt, ValidationError, model_validator

from nonholo import systems
from nonholo.base.checks import error, instance, names, needs, printable, text
from nonholo.base.compiled import way_of_kernels
from nonholo.continuous import ContinuousFlow
from nonholo.discrete import MeasuredMotion, discretize
from nonholo.groups import SE, SO, AbstractMatrixGroup, MatrixGroup, ProductGroup, Translations
from nonholo.io.places import FORMAT, SCHEMAS, WHERE
from nonholo.orbit import AbstractMotion, AbstractOrbit
from nonholo.systems import AbstractCoordinateDiscretization, AbstractSystem, Friction, Gravity, Linear, Slip, Spring

_CALLABLE = "callable"
_OWN = "of your own"
_ARGUMENTS = {"given_inertia": "inertia_operator"}  # fields that the constructor calls otherwise
_FORCES = {kind.__name__: kind for kind in (Gravity, Linear, Spring, Friction, Slip)}
_FAMILIES = {"SO": SO, "SE": SE, "Translations": Translations}


def described_system(system: Any) -> tuple[str, dict[str, Any]]:
    """Return the name of a system, that of its class or of what makes it, and its parameters as plain data."""
    return getattr(system, "description", None) or (type(system).__name__, fields_of(system))


def fields_of(owner: Any) -> dict[str, Any]:
    """Return the fields of a dataclass as plain data, floating-point numbers such that they are read back exactly."""
    names_of_fields = (field.name for field in dataclasses.fields(owner) if field.metadata.get("stored", True))
    fields = {name: getattr(owner, name) for name in names_of_fields}
    plain = {name: _plain(value) for name, value in fields.items() if not isinstance(value, Mapping) or value}
    plain |= {name: getattr(owner, name) for name in getattr(owner, "in_stores", ())}
    if getattr(owner, "is_forced", False):
        plain["system"] = {"kind": type(owner.system).__name__, "parameters": fields_of(owner.system)}
    return plain


def missing_part(data: dict[str, Any]) -> str | None:
    """Name the first entry that a store cannot hold, and why; None if there is none."""
    for name, value in data.items():
        if value == _CALLABLE:
            return f"{name} is a callable"
        if isinstance(value, dict) and (inside := missing_part(value.get("parameters", {}))):
            return f"{name}: {inside}"
        if isinstance(value, dict) and _is_own(value):
            return f"{name} holds a custom object"
    return None


READY = "examples."
"""How stores call ready systems, before their names."""


@contextlib.contextmanager
def refusing_other_data(where: str, what: str) -> Iterator[None]:
    """Refuse data of a store of which nothing can be made: another version wrote them, or somebody edited them."""
    try:
        yield
    except (AttributeError, KeyError, TypeError) as failure:
        got, remedy = f"{type(failure).__name__}: {failure}", "Upgrade nonholo, or copy the store again."
        raise error(where, f"hold {what}", got, remedy) from failure


def restore_system(kind: str, parameters: dict[str, Any]) -> Any:
    """Build the system of a class of this version from its parameters, or a ready one of `nonholo.examples`.

    Functions of `nonholo.examples` are those that users call, which check what they get.
    """
    if (name := kind.removeprefix(READY)) != kind:
        with needs("jax", f"load_orbit(...) of nonholo.{kind}"):
            ready = importlib.import_module("nonholo.examples")
        if name not in ready.__all__ or not name.islower():
            raise error(WHERE, "hold a ready system of this version", repr(name), "Upgrade nonholo.")
        with refusing_other_data(WHERE, f"parameters of nonholo.{kind}"):
            return getattr(ready, name)(**parameters).system
    kind_of_system = getattr(systems, kind, None)
    if not (isinstance(kind_of_system, type) and issubclass(kind_of_system, AbstractSystem)):
        remedy = "Upgrade nonholo or, for a custom system, pass load_orbit(path, discrete=...)."
        raise error(WHERE, "hold a system of this version", repr(kind), remedy)
    with refusing_other_data(WHERE, f"parameters of nonholo.{kind}"):
        return kind_of_system(**{_ARGUMENTS.get(name, name): _restore(value) for name, value in parameters.items()})


def describe_group(group: AbstractMatrixGroup) -> dict[str, Any]:
    """Return a group as plain data: its family and dimension, its basis, or its factors.

    Example:
        >>> describe_group(nh.ProductGroup(nh.SE(2), nh.Translations(3)))
        {'group': 'ProductGroup', 'factors': [{'group': 'SE', 'n': 2}, {'group': 'Translations', 'n': 3}]}
    """
    if isinstance(group, ProductGroup):
        return {"group": "ProductGroup", "factors": [describe_group(factor) for factor in group.factors]}
    if isinstance(group, MatrixGroup):
        form = {} if group.form is None else {"form": group.form.tolist()}
        return {"group": "MatrixGroup", "basis": group.basis.tolist()} | form
    for family, n in (("SO", group.size), ("SE", group.size - 1), ("Translations", group.size - 1)):
        least = 1 if family == "Translations" else 2
        if n >= least and group == _FAMILIES[family](n):
            return {"group": family, "n": n}
    return {"group": _OWN}


def restore_group(data: dict[str, Any]) -> AbstractMatrixGroup:
    """Return the group of a description."""
    kind = data["group"]
    if kind == "ProductGroup":
        return ProductGroup(*map(restore_group, data["factors"]))
    if kind == "MatrixGroup":
        return MatrixGroup(data["basis"], data.get("form"))
    if kind not in _FAMILIES:
        raise error(WHERE, "hold a group of this version", repr(kind), "Upgrade nonholo.")
    return _FAMILIES[kind](data["n"])


def _plain(value: Any) -> Any:
    if isinstance(value, AbstractMatrixGroup):
        return describe_group(value)
    if isinstance(value, Mapping):
        return {name: _plain(each) for name, each in value.items()}
    if value is None or isinstance(value, str | AbstractSystem):
        return value
    return _plain_parts(value, value if isinstance(value, tuple) else (value,))


def _plain_parts(value: Any, several: tuple[Any, ...]) -> Any:
    """Return a function by its marker, a force or several by their numbers, else an array."""
    if any(map(callable, several)):
        return _CALLABLE
    if any(type(each).__name__ in _FORCES for each in several):
        is_one = several is not value
        return {"kind": type(value).__name__, "parameters": fields_of(value)} if is_one else list(map(_plain, several))
    array = np.asarray(value)
    return {"object": _OWN} if array.dtype.kind == "O" else array.tolist()


def _restore(value: Any) -> Any:
    if type(value) is list and dict in map(type, value):
        return tuple(map(_restore, value))
    if not isinstance(value, dict):
        return value
    if "kind" not in value:
        return restore_group(value)
    if value["kind"] in _FORCES:
        return _FORCES[value["kind"]](**value["parameters"])
    return restore_system(value["kind"], value["parameters"])


def _is_own(data: dict[str, Any]) -> bool:
    return _OWN in (data.get("group"), data.get("object")) or any(map(_is_own, data.get("factors", [])))


class _Recorded(BaseModel):
    """A system whose functions its store does not hold."""

    name: str
    coordinates: Annotated[tuple[str, ...], AfterValidator(lambda several: several and names("coordinates", several))]
    orbits: Literal["CoordinateOrbit", "GroupOrbit"]
    shapes: tuple[tuple[NonNegativeInt, ...], tuple[NonNegativeInt]]
    constraints: NonNegativeInt
    is_driven: bool
    heading: str | None = None
    parameters: dict[str, Any] = {}

    @model_validator(mode="after")
    def _fit(self) -> "_Recorded":
        shape = self.shapes[0] if self.orbits == "CoordinateOrbit" else (0,)
        if (len(self.coordinates),) != shape or self.heading not in (None, *self.coordinates):
            raise ValueError(f"coordinates: must be {shape[0]} names, the heading among them")
        return self


def problems_in(failure: Exception) -> str:
    """Return what is wrong with data, each with its place."""
    if not isinstance(failure, ValidationError):
        return printable(str(failure))
    flaws = [(".".join(map(str, flaw["loc"])) or "they", flaw["msg"]) for flaw in failure.errors()[:5]]
    return printable("; ".join(f"{place}: {text.removeprefix('Value error, ').rstrip('.')}" for place, text in flaws))


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
        "schema": SCHEMAS[FORMAT],
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


def restore_motion(attributes: dict[str, Any], motion: Any, owner: str = "load_orbit") -> Any:
    """Rebuild the motion of a store, or check that the one given is the stored one.

    Callables and groups of the user's own cannot be stored: such a motion has to be given. In coordinates, where stores
    hold all that an orbit tells, it is one that cannot run.
    """
    if motion is not None:
        kinds: Any = (AbstractMotion, AbstractCoordinateDiscretization)
        remedy = "Pass that of the store, or None."
        where = f"{owner}(discrete=...)"
        motion = on_route_of(attributes, instance(where, motion, kinds, "be a discretization", remedy))
        for key, value in identity_of(motion).items():
            if value != attributes[key]:  # JSON text: floating-point numbers are compared exactly
                got = f"{key} {value} instead of {attributes[key]}"
                raise error(where, "be the discretization of the store", got, "Pass that one.")
        return motion
    options = json.loads(attributes["motion"])
    kind, route = options.pop("kind"), options.pop("route", None)
    remedy = f"Pass {owner}(path, discrete=...) with the {kind} that made this store."
    with refusing_other_data(WHERE, "a motion of this version"):
        system = system_of(attributes, WHERE, remedy, missing_part(options))
        if kind not in _MOTIONS:
            raise error(WHERE, "hold a motion of this version", repr(kind), "Upgrade nonholo.")
        motion_again = on_route_of(attributes, _MOTIONS[kind](system, **options))
    if type(motion_again).__name__ != kind or route != motion_again.route_name:
        raise error(WHERE, "hold a run by a route of this version", repr(route or kind), "Upgrade nonholo.")
    return motion_again


@refusing_other_data(WHERE, "a system of this version")
def system_of(attributes: dict[str, Any], where: str, remedy: str, missing: str | None = None) -> Any:
    """Return the system of a store; in coordinates, what is known of one whose functions it does not hold."""
    name, parameters = attributes["system"], json.loads(attributes["parameters"])
    group, absent = parameters.get("group"), missing or missing_part(parameters)
    if not absent:
        return restore_system(name, parameters)
    if missing or "orbits" not in parameters or missing_part({"group": group}):
        raise error(where, "be rebuilt from data", f"a store whose {absent}", remedy)
    try:
        record = _Recorded.model_validate(parameters).model_dump()
    except ValidationError as failure:
        raise error(WHERE, "describe its system", problems_in(failure), "It was edited: run it again.") from None
    with needs("jax", "load_orbit(...) of an orbit in coordinates"):
        room = importlib.import_module("nonholo.lagrange_dalembert")
    own = {} if group is None else {"group": restore_group(group)}
    return room.RecordedSystem(record | own, (name, parameters))


def on_route_of(attributes: dict[str, Any], motion: Any) -> Any:
    """Return a motion by the route that began a store, or the next one; the motion itself where that is its own."""
    if motion.route_name is None:
        return motion
    other = dataclasses.replace(motion, wanted_route=json.loads(attributes["motion"]).get("route"))
    return motion if other.route_name == motion.route_name else other


def identity_of(motion: Any) -> dict[str, str]:
    """Return what a motion is."""
    options = {"kind": type(motion).__name__, **fields_of(motion)}
    options.pop("system", None)
    if motion.route_name is not None:
        options["route"] = motion.route_name
    system, parameters = described_system(motion.system)
    return {"system": system, "parameters": json.dumps(parameters), "motion": json.dumps(options)}


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
