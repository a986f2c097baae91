"""The task of sweeps over systems that a function makes: the ready systems of `nonholo.examples`, or your own."""

import dataclasses
import importlib
import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from nonholo.base.checks import count, error, function, instance, scale, shown
from nonholo.discrete import discretize
from nonholo.ensembles import _names
from nonholo.ensembles._names import component_of, function_from, function_name, reduced, with_components
from nonholo.ensembles._reductions import last_states
from nonholo.ensembles.designs import MemberBlock
from nonholo.groups import components_of
from nonholo.simulation import ensemble

_EXAMPLES, _READY, _FINAL = "nonholo.examples", "examples.", "final_state"
_STEP, _STARTS = "time_step", ("configuration", "body_velocity")
_STEPS, _MEMBERS = 1 << 20, 1 << 12  # at most in a block


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class FamilyTask:
    r"""Run the members of a family: systems that a function of parameters makes, such as `nh.examples.particle`.

    Names of a design are parameters of the function, "time_step", "configuration" and "body_velocity", or a component
    of one that is an array, such as "body_velocity_0". Arguments that it does not name are as given here, or the
    defaults of the function. Members with one system, or with one but for its `parameters`, run as one `ensemble`; each
    other system in coordinates is compiled: of constants that are no parameters vary a few values, and all else at
    will.

    The reduction "final_state" keeps time, configuration, velocity and energy of the last good state, and the number
    of good steps. A custom function gets the `Ensemble` of such members, and returns arrays as for
    `EnsembleTask`.

    Attributes:
        family: `family(**parameters)` -> an `nh.examples.Example`, or anything else with a `system`, a `configuration`
            and a `body_velocity` at which members start. A store names it: `resume` imports a custom one only
            if it is passed or trusted.
        time_step: h.
        steps: Number of steps.
        parameters: Arguments of the family that are the same for all members.
        reductions: The quantities to keep.
        save_every: Steps between the states that reductions see; None for the last one alone.

    Raises:
        ValueError: A bad argument, before any work.

    Example:
        >>> task = nh.FamilyTask(nh.examples.particle, time_step=0.1, steps=20)
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder:
        ...     result = nh.sweep(task, nh.Grid({"planar_velocity_0": [0.5, 1.0, 2.0]}), f"{folder}/particles.zarr")
        ...     result["final_configuration"].sel(planar_velocity_0=2.0).values.round(2)
        array([2.89, 2.  , 2.47])
    """

    family: Callable[..., Any]
    time_step: float
    steps: int
    parameters: Mapping[str, Any] = dataclasses.field(default_factory=dict, kw_only=True)
    reductions: Any = dataclasses.field(default=("final_state",), kw_only=True)
    save_every: int | None = dataclasses.field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        function(_where("family"), self.family)
        parameters = instance(_where("parameters"), self.parameters, Mapping, "be a mapping of names", "Pass a dict.")
        every, remedy = self.save_every, f"Pass {_FINAL!r} or functions of an ensemble."
        fields = {
            "time_step": float(scale(_where("time_step"), self.time_step, "Pass a positive time step.")),
            "steps": count(_where("steps"), self.steps, "Pass the number of steps."),
            "parameters": dict(parameters),
            "reductions": _names.checked_reductions(_where("reductions"), self.reductions, (_FINAL,), remedy),
            "save_every": None if every is None else count(_where("save_every"), every, "Pass steps, or None."),
        }
        vars(self).update(fields)
        arguments = inspect.signature(self.family).parameters
        for name in self.parameters.keys() - arguments.keys():
            remedy = f"It has {', '.join(arguments)}."
            raise error(_where("parameters"), "name arguments of the family", shown(name), remedy)

    @property
    def _arguments(self) -> dict[str, Any]:
        """The arguments of the family, with their values where they are not varied."""
        defaults = {name: each.default for name, each in inspect.signature(self.family).parameters.items()}
        return defaults | dict(self.parameters)

    def check_design(self, names: list[str]) -> None:
        """Refuse a design that names what the family does not have."""
        own = [*self._arguments, *(name for name in (*_STARTS, _STEP) if name not in self._arguments)]
        for name in names:
            part = component_of(name)
            if name not in own and not (part and part[0] in own):
                remedy = f"It has {', '.join(own)}."
                raise error("sweep(design=...)", "name arguments of the family", shown(name), remedy)

    @property
    def block(self) -> int:
        """Members of a block that make a good piece of work."""
        return max(1, min(_MEMBERS, _STEPS // self.steps))

    def __call__(self, block: MemberBlock) -> dict[str, Any]:
        """Run a block of members, those with one system together, and reduce it."""
        each = [self._member({name: values[k] for name, values in block.items()}) for k in range(block.count)]
        families = [getattr(system, "family", system) for system, _ in each]
        parts = []
        for family in dict.fromkeys(families):
            members = [member for member, other in enumerate(families) if other == family]
            starts = {name: np.stack([each[member][1][name] for member in members]) for name in each[0][1]}
            numbers = (block.first + np.array(members)).tolist()
            batch = self._ensemble([each[member][0] for member in members], starts, numbers)
            parts.append((members, reduced(_where("reductions"), batch, self.reductions, {_FINAL: _final_state})))
        return _names.join_results(parts)

    def _member(self, own: dict[str, Any]) -> tuple[Any, dict[str, np.ndarray]]:
        """Return the system of a member, and what it starts with."""
        arguments = self._arguments
        values = {name: with_components(name, value, own) for name, value in arguments.items()}
        example = self.family(**{name: value for name, value in values.items() if value is not inspect.Parameter.empty})
        bases = {key: (component_of(key) or (key,))[0] for key in own}
        rest = {key: value for key, value in own.items() if not {key, bases[key]} & arguments.keys()}
        starts = {name: np.asarray(with_components(name, getattr(example, name), rest)) for name in _STARTS}
        return example.system, starts | ({_STEP: np.asarray(own[_STEP])} if _STEP in own else {})

    def _ensemble(self, systems: list[Any], starts: dict[str, np.ndarray], numbers: list[int]) -> Any:
        """Run members with systems of one family."""
        parameters = {_STEP: starts.pop(_STEP)} if _STEP in starts else {}
        for name in getattr(systems[0], "parameters", ()):
            parameters[name] = np.stack([system.parameters[name] for system in systems])
        run = {"steps": self.steps, "save_every": self.save_every}
        with _names.numbering(numbers.__getitem__):
            return ensemble(discretize(systems[0], self.time_step), parameters=parameters or None, **starts, **run)

    def describe(self) -> dict[str, Any]:
        """Return the task as plain data."""
        name = function_name(self.family)
        own = name.partition(":")[2]
        reductions = [_FINAL if reduction == _FINAL else function_name(reduction) for reduction in self.reductions]
        return {
            "kind": "FamilyTask",
            "family": f"{_READY}{own}" if name.startswith(f"{_EXAMPLES}.") and own in _ready_names() else name,
            "parameters": {name: np.asarray(value).tolist() for name, value in self.parameters.items()},
            **{name: getattr(self, name) for name in ("time_step", "steps", "save_every")},
            "reductions": reductions,
        }


def family_task_from(entry: dict[str, Any]) -> FamilyTask:
    """Return the task of a description, whose functions are imported; those of the library are its ready systems."""
    name = entry["family"]
    if (own := name.removeprefix(_READY)) != name and own not in _ready_names():
        raise ValueError(f"one of {name!r}, which is no ready system of this version")
    family = function_from(name) if own == name else getattr(importlib.import_module(_EXAMPLES), own)
    reductions = [each if each == _FINAL else function_from(each) for each in entry["reductions"]]
    run = {name: entry[name] for name in ("time_step", "steps", "parameters", "save_every")}
    return FamilyTask(family, reductions=reductions, **run)


def _ready_names() -> set[str]:
    return {*importlib.import_module(_EXAMPLES).__all__} - {"Example"}


def _where(argument: str) -> str:
    return f"FamilyTask({argument}=...)"


def _final_state(batch: Any) -> dict[str, Any]:
    """Return what is known of the last good state of each member that is kept."""
    last, system = last_states(batch), batch.members.discrete.system
    configuration, names = last.configuration[:, 0], list(getattr(system, "coordinates", ()))
    axes, of_places = (("coordinate",), {"components": names}) if configuration.ndim == 2 else (("row", "column"), {})
    of_rates = {"components": names or list(components_of(system.group))}
    return {
        "final_time": ((), last.time[:, 0], {"long_name": "time of the last good state"}),
        "final_configuration": (axes, configuration, of_places | {"long_name": "configuration of the last good state"}),
        "final_velocity": (("component",), last.body_velocity[:, 0], of_rates | {"long_name": "velocity there"}),
        "final_energy": ((), last.energy[:, 0], {"long_name": "energy there"}),
        "steps_done": ((), batch.steps_done, {"long_name": "good steps"}),
    }
