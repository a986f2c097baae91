"""The members of an ensemble: one discretized system, and the parameters in which each member differs from it."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from nonholo.base.checks import array, error, shown
from nonholo.base.types import Float
from nonholo.discrete import Discretization
from nonholo.systems import System, unchecked

STEP = "time_step"
_ARGUMENTS = {"given_inertia": "inertia_operator"}  # fields that the constructor calls otherwise


@dataclasses.dataclass(frozen=True, eq=False)
class Members:
    """Discretized systems that differ by parameters.

    Attributes:
        discrete: The discretized system of all members, but for the parameters.
        parameters: Values by name, a field of the system or "time_step", with a leading member axis.
        count: The number M of members.
    """

    discrete: Discretization
    parameters: dict[str, Float[np.ndarray, "M ..."]]
    count: int

    def __len__(self) -> int:
        return self.count

    @property
    def time_step(self) -> Float[np.ndarray, "m"]:
        """The time step of each member, or that of all as one number."""
        return self.values(STEP)

    def values(self, name: str) -> Float[np.ndarray, "m ..."]:
        """Return a parameter of each member, or with an axis of length 1 that of all."""
        if name in self.parameters:
            return self.parameters[name]
        return np.asarray(self.discrete.time_step if name == STEP else getattr(self.discrete.system, name))[None]

    def of(self, member: int) -> Discretization:
        """Return the discretized system of one member."""
        if not self.parameters:
            return self.discrete
        own = {name: values[member] for name, values in self.parameters.items()}
        step = own.pop(STEP, self.discrete.time_step)
        system = _rebuilt(self.discrete.system, own) if own else self.discrete.system
        return dataclasses.replace(self.discrete, system=system, time_step=step)

    @property
    def stacked(self) -> System:
        """The systems of all members in one, numbers with an axis of members in front: for formulas that allow it."""
        system = self.discrete.system
        values = {name: self.values(_ARGUMENTS.get(name, name)) for name in _numbers(system)}
        return unchecked(system, **{name: np.broadcast_to(x, (len(self), *x.shape[1:])) for name, x in values.items()})

    def part(self, chosen: slice) -> "Members":
        """Return some of the members."""
        kept = {name: values[chosen] for name, values in self.parameters.items()}
        return Members(self.discrete, kept, len(range(*chosen.indices(self.count))))


def _rebuilt(system: Any, own: dict[str, Any]) -> Any:
    kept = {_ARGUMENTS.get(field.name, field.name): getattr(system, field.name) for field in dataclasses.fields(system)}
    return type(system)(**{**kept, **own})


def _numbers(system: System) -> list[str]:
    return [name for name in system.leaves if getattr(system, name) is not None]


def checked_parameters(discrete: Discretization, parameters: Any) -> dict[str, Any]:
    """Return the parameters of an ensemble as arrays, refused with names that the system does not have."""
    if parameters is None:
        return {}
    system = discrete.system
    if not isinstance(parameters, Mapping):
        raise error("ensemble(parameters=...)", "be a mapping of names to arrays", shown(parameters), "Pass a dict.")
    known = [*(_ARGUMENTS.get(name, name) for name in _numbers(system)), STEP]
    checked = {}
    for name, value in parameters.items():
        if name not in known:
            remedy = f"{type(system).__name__} has {', '.join(known)}."
            raise error("ensemble(parameters=...)", "name fields of the system", shown(name), remedy)
        shape = () if name == STEP else np.shape(getattr(system, name))
        where = f"ensemble(parameters={{{name!r}: ...}})"
        checked[name] = array(where, value, (None, *shape), "Pass one value for each member.")
    _one_length(checked)
    return checked


def _one_length(parameters: dict[str, np.ndarray]) -> None:
    lengths = {name: len(values) for name, values in parameters.items()}
    if len(set(lengths.values())) > 1:
        got = ", ".join(f"{count} of {name}" for name, count in lengths.items())
        raise error("ensemble(parameters=...)", "have one length", got, "Pass one value for each member.")


def refused(member: int, failure: ValueError) -> ValueError:
    """Return the error of one member, with its number."""
    return ValueError(f"{failure} This is member {member}.")
