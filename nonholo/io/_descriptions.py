"""Systems and motions as plain JSON data and back; what data cannot hold is named by a marker instead."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from nonholo import systems
from nonholo.base.checks import error
from nonholo.groups import SE, SO, AbstractMatrixGroup, MatrixGroup, ProductGroup, Translations
from nonholo.io._in_coordinates import READY, restore_ready
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
    stored = (field.name for field in dataclasses.fields(owner) if field.metadata.get("stored", True))
    given = {name: getattr(owner, name) for name in stored}
    plain = {name: _plain(value) for name, value in given.items() if not isinstance(value, Mapping) or value}
    plain |= {name: getattr(owner, name) for name in getattr(owner, "recorded", ())}
    if getattr(owner, "is_forced", False):
        plain["system"] = {"kind": type(owner.system).__name__, "parameters": fields_of(owner.system)}
    return plain


def unstored(described: dict[str, Any]) -> str | None:
    """Name the first entry that a store cannot hold, and why; None if there is none."""
    for name, value in described.items():
        if value == _CALLABLE:
            return f"{name} is a callable"
        if isinstance(value, dict) and (inside := unstored(value.get("parameters", {}))):
            return f"{name}: {inside}"
        if isinstance(value, dict) and _is_own(value):
            return f"{name} holds a custom object"
    return None


def restore_system(kind: str, parameters: dict[str, Any]) -> Any:
    """Build the system of a class of this version from its parameters, or a ready one of `nonholo.examples`."""
    if kind.startswith(READY):
        return restore_ready(kind.removeprefix(READY), parameters)
    found = getattr(systems, kind, None)
    if not (isinstance(found, type) and issubclass(found, AbstractSystem)):
        remedy = "Upgrade nonholo or, for a custom system, pass load_orbit(path, discrete=...)."
        raise error("load_orbit(path=...)", "hold a system of this version", repr(kind), remedy)
    return found(**{_ARGUMENTS.get(name, name): _restored(value) for name, value in parameters.items()})


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


def restore_group(described: dict[str, Any]) -> AbstractMatrixGroup:
    """Return the group of a description."""
    kind = described["group"]
    if kind == "ProductGroup":
        return ProductGroup(*map(restore_group, described["factors"]))
    if kind == "MatrixGroup":
        return MatrixGroup(described["basis"], described.get("form"))
    if kind not in _FAMILIES:
        raise error("load_orbit(path=...)", "hold a group of this version", repr(kind), "Upgrade nonholo.")
    return _FAMILIES[kind](described["n"])


def _plain(value: Any) -> Any:
    if isinstance(value, AbstractMatrixGroup):
        return describe_group(value)
    if isinstance(value, Mapping):
        return {name: _plain(each) for name, each in value.items()}
    if value is None or isinstance(value, str | AbstractSystem):
        return value
    several = value if isinstance(value, tuple) else (value,)
    if any(map(callable, several)):
        return _CALLABLE
    if any(type(each).__name__ in _FORCES for each in several):
        return [_plain(each) for each in several] if several is value else _plain_force(value)
    return _plain_array(np.asarray(value))


def _plain_force(force: Any) -> dict[str, Any]:
    return {"kind": type(force).__name__, "parameters": fields_of(force)}


def _plain_array(array: np.ndarray) -> Any:
    return {"object": _OWN} if array.dtype.kind == "O" else array.tolist()


def _restored(value: Any) -> Any:
    if type(value) is list and dict in map(type, value):
        return tuple(map(_restored, value))
    if not isinstance(value, dict):
        return value
    if "kind" not in value:
        return restore_group(value)
    if value["kind"] in _FORCES:
        return _FORCES[value["kind"]](**value["parameters"])
    return restore_system(value["kind"], value["parameters"])


def _is_own(described: dict[str, Any]) -> bool:
    factors = described.get("factors", [])
    return _OWN in (described.get("group"), described.get("object")) or any(map(_is_own, factors))
