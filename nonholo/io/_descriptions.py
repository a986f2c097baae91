"""Systems and motions as plain JSON data and back; what data cannot hold is named by a marker instead."""

import dataclasses
import importlib
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, BaseModel, NonNegativeInt, ValidationError, model_validator

from nonholo import systems
from nonholo.base.checks import error, names, needs
from nonholo.groups import SE, SO, AbstractMatrixGroup, MatrixGroup, ProductGroup, Translations
from nonholo.systems import AbstractSystem, Friction, Gravity, Linear, Slip, Spring

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


def restore_system(kind: str, parameters: dict[str, Any]) -> Any:
    """Build the system of a class of this version from its parameters, or a ready one of `nonholo.examples`."""
    if kind.startswith(READY):
        return restore_ready(kind.removeprefix(READY), parameters)
    kind_of_system = getattr(systems, kind, None)
    if not (isinstance(kind_of_system, type) and issubclass(kind_of_system, AbstractSystem)):
        remedy = "Upgrade nonholo or, for a custom system, pass load_orbit(path, discrete=...)."
        raise error("load_orbit(path=...)", "hold a system of this version", repr(kind), remedy)
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
        raise error("load_orbit(path=...)", "hold a group of this version", repr(kind), "Upgrade nonholo.")
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
        return [_plain(each) for each in several] if several is value else _plain_force(value)
    return _plain_array(np.asarray(value))


def _plain_force(force: Any) -> dict[str, Any]:
    return {"kind": type(force).__name__, "parameters": fields_of(force)}


def _plain_array(array: np.ndarray) -> Any:
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
    factors = data.get("factors", [])
    return _OWN in (data.get("group"), data.get("object")) or any(map(_is_own, factors))


READY = "examples."
"""How stores call ready systems, before their names."""
_WHERE = "load_orbit(path=...)"


def restore_ready(name: str, parameters: dict[str, Any]) -> Any:
    """Make a ready system by the function of `nonholo.examples` that users call, which checks what it gets."""
    with needs("jax", f"load_orbit(...) of nonholo.examples.{name}"):
        ready = importlib.import_module("nonholo.examples")
    if name not in ready.__all__ or not name.islower():
        raise error(_WHERE, "hold a ready system of this version", repr(name), "Upgrade nonholo.")
    try:
        return getattr(ready, name)(**parameters).system
    except TypeError as failure:
        raise error(_WHERE, f"hold parameters of nonholo.examples.{name}", str(failure), "Upgrade nonholo.") from None


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


def recorded_system(kind: str, parameters: dict[str, Any], group: Any) -> Any:
    """Return what was recorded of a system, on a group if there is one, for orbits as they were computed."""
    try:
        record = _Recorded.model_validate(parameters).model_dump()
    except ValidationError as failure:
        problem = failure.errors()[0]
        got = f"{'.'.join(map(str, problem['loc']))}: {problem['msg'].removeprefix('Value error, ').rstrip('.')}"
        raise error(_WHERE, "describe its system", got, "It was edited: run it again.") from None
    with needs("jax", "load_orbit(...) of an orbit in coordinates"):
        room = importlib.import_module("nonholo.lagrange_dalembert")
    return room.RecordedSystem(record | ({} if group is None else {"group": group}), (kind, parameters))
