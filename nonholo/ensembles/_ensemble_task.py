"""The task of most sweeps: run the members of a block as an ensemble, keep what reductions make of it."""

import copy
import dataclasses
import json
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np

from nonholo import io
from nonholo.base.checks import array, assign, count, error, flag, shown
from nonholo.base.types import Float
from nonholo.discrete import PRINCIPAL, BranchRule, Discretization, as_discretization
from nonholo.ensembles import _names
from nonholo.ensembles._names import checked_reductions, function_from, function_name, join_results, reduced
from nonholo.ensembles._reductions import REDUCTIONS
from nonholo.ensembles.designs import MemberBlock
from nonholo.io.provenance import missing_part
from nonholo.simulation import Ensemble, Members, check_forces, ensemble, in_lanes, numbers_of, stepper_of
from nonholo.systems import one_start, refuse_forces

_BLOCK, _NUMBERS = 1 << 16, 1 << 22  # most members of a block, and numbers of all their states
LANES, _STEPS = 32, 1 << 28  # members that the compiled loop takes at once, and most steps of a block: some seconds
_STEPS_EACH = 1 << 20  # the same for systems that run one by one

_FUNCTIONS = {name: reduction.function for name, reduction in REDUCTIONS.items()}
_KNOWN = f"Choose among {', '.join(REDUCTIONS)}, or pass a function of an Ensemble."
RULE = "branch_function"
"""The key of a description for a branch rule that is a function."""

Start: TypeAlias = tuple[str, Float[np.ndarray, "n"]]


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class EnsembleTask:
    r"""Run the members of a design and keep some numbers of each.

    Arguments that the design does not name are as given here. Names of a design are parameters of the system,
    "time_step", a start or one of its components, such as "restricted_velocity_0". A start need not be given if all of
    it is varied. Of a system under forces they are also numbers of these, such as "gravity_force", "gravity_force_1",
    "friction" and "slip_grip": such members run one by one.

    Reductions: "final_state" (restricted momentum, time, energy and compact pose of the last good state that is saved,
    and the number of good steps), "energy_drift" (of that state, relative), "limit_angle" (total turn of a plane
    sleigh; angle between the first and the last spatial axis of a top with n = 3), "turning_deviation" (of a plane
    sleigh, relative to the total turn of its flow: the part that is missing), "branch_counts" (real values of the map
    over the first momentum), "lyapunov" (largest finite-time exponent of the momenta: growth of the most stretched
    direction, 1/time). A custom function gets the `Ensemble` of a block and returns a dictionary of arrays with a
    leading member axis; of a tuple (dimensions, array) the names label the other axes.

    Attributes:
        discrete: The discretized system.
        steps: Number of steps.
        start: Name of the start and its value for all members.
        reductions: What to keep.
        save_every: Steps between the states that reductions see; None for the last one alone. It is 1 with
            "lyapunov" and with the turn of a sleigh, which take all states.
        branch: The branch rule, as in `ensemble`.
        reconstruct: Whether there are poses.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> task = nh.EnsembleTask(sleigh, steps=100, restricted_velocity=(1.0, 0.2), reductions=["energy_drift"])
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder:
        ...     result = nh.sweep(task, nh.Grid({"a": [0.1, 0.5], "inertia": [1.0, 2.0, 3.0]}), f"{folder}/a.zarr")
        ...     dict(result.sizes), float(result["energy_drift"].max()) < 1e-13
        ({'a': 2, 'inertia': 3}, True)
    """

    discrete: Discretization
    steps: int
    start: tuple[str, Any] | None
    reductions: tuple[str | Callable[[Ensemble], Any], ...]
    save_every: int | None
    branch: BranchRule
    reconstruct: bool

    def __init__(
        self,
        discrete: Discretization,
        *,
        steps: int,
        body_velocity: Any = None,
        restricted_velocity: Any = None,
        momentum: Any = None,
        reductions: Any = ("final_state",),
        save_every: int | None = None,
        branch: BranchRule = PRINCIPAL.name,
        reconstruct: bool = True,
    ) -> None:
        starts = dict(zip(_names.STARTS, (body_velocity, restricted_velocity, momentum), strict=True))
        remedy = "Pass the start of all members; what differs belongs to the design."
        own = {name: value for name, value in starts.items() if value is not None}
        start = [(name, array(f"EnsembleTask({name}=...)", value, (None,), remedy)) for name, value in own.items()]
        if start:
            one_start("EnsembleTask", **starts)
        if save_every is not None:
            save_every = count("EnsembleTask(save_every=...)", save_every, "Pass the steps between states, or None.")
        vars(self).update(
            discrete=as_discretization("EnsembleTask(discrete=...)", discrete, compositions=True, forced=True),
            steps=count("EnsembleTask(steps=...)", steps, "Pass the number of steps."),
            start=start[0] if start else None,
            reductions=checked_reductions("EnsembleTask(reductions=...)", reductions, REDUCTIONS, _KNOWN),
            save_every=save_every,
            branch=branch,
            reconstruct=flag("EnsembleTask(reconstruct=...)", reconstruct),
        )
        stepper_of(discrete, branch, "auto", with_poses=self.reconstruct, owner="EnsembleTask")
        check_forces("EnsembleTask", discrete, self.steps)
        if free := ({*REDUCTIONS} - {"final_state"}) & {*self.reductions}:
            refuse_forces(f"EnsembleTask(reductions={sorted(free)})", discrete.system)

    def __call__(self, block: MemberBlock) -> dict[str, Any]:
        """Run a block of members and reduce it; under forces that differ one by one."""
        if of_forces := [name for name in block if _names.is_force_number(self.discrete.system, name)]:
            return join_results([([member], self._member(block, member, of_forces)) for member in range(block.count)])
        numbers = numbers_of(self.discrete)
        parameters = {name: block[name] for name in block if name in numbers}
        run: Any = {"steps": self.steps, "save_every": self._every, "branch": self.branch}
        run |= _rows_of_starts(self.start, block)
        with _names.numbering(lambda member: block.first + member):
            batch = ensemble(self.discrete, parameters=parameters or None, reconstruct=self.reconstruct, **run)
        return reduced("EnsembleTask(reductions=...)", batch, self.reductions, _FUNCTIONS)

    @property
    def block(self) -> int:
        """Members of a block that make a good piece of work: their states fit in memory, and it takes some seconds."""
        is_compiled = self.branch == PRINCIPAL.name and in_lanes(Members(self.discrete, {}, 1))
        lanes, steps = (LANES, _STEPS) if is_compiled else (1, _STEPS_EACH)
        states = 1 if self._every is None else 1 + self.steps // self._every
        state = 2 * self.discrete.system.rank + self.discrete.system.group.pose_size
        return max(1, min(_BLOCK, _NUMBERS // (states * state), steps // self.steps) // lanes) * lanes

    @property
    def _every(self) -> int | None:
        """Steps between states: every one, if a built-in reduction needs all of them."""
        reductions = [REDUCTIONS[r] for r in self.reductions if isinstance(r, str)]
        return 1 if any(r.needs_all(self.discrete.system) for r in reductions) else self.save_every

    def check_design(self, names: list[str]) -> None:
        """Refuse a design that names what the task does not know, no start, or several."""
        _check_starts(self.discrete, self.start, names)
        system, numbers = self.discrete.system, numbers_of(self.discrete)
        for name in names:
            is_start = name in _names.STARTS or _names.start_component(name) is not None
            if not (name in numbers or is_start or _names.is_force_number(system, name)):
                kind, names_known = type(system).__name__, ", ".join([*numbers, *_names.force_numbers(system)])
                remedy = f"{kind} has {names_known}; starts are {', '.join(_names.STARTS)}."
                raise error("sweep(design=...)", "name parameters of the system or starts", shown(name), remedy)

    def on_route_of(self, attributes: dict[str, Any]) -> "EnsembleTask":
        """Return the task by the route that began a store, from the description of that one's task."""
        return self._with(io.provenance.on_route_of(attributes, self.discrete))

    def _member(self, block: MemberBlock, member: int, of_forces: list[str]) -> dict[str, Any]:
        """Run one member under its forces."""
        system = _names.with_force_numbers(self.discrete.system, {name: block[name][member] for name in of_forces})
        rest = {name: values for name, values in block.items() if name not in of_forces}
        task = self._with(dataclasses.replace(self.discrete, system=system))
        return task(dataclasses.replace(block, arrays=rest).part(member, member + 1))

    def _with(self, discrete: Discretization) -> "EnsembleTask":
        task = copy.copy(self)
        assign(task, discrete=discrete)
        return task

    def describe(self) -> dict[str, Any]:
        """Return the task as plain data."""
        rule = {"branch": self.branch} if isinstance(self.branch, str) else {RULE: function_name(self.branch)}
        rule = {} if self.branch == PRINCIPAL.name else rule  # a store says nothing of the principal one
        return {
            "kind": "EnsembleTask",
            **io.provenance.identity_of(self.discrete),
            **{name: getattr(self, name) for name in ("steps", "save_every", "reconstruct")},
            "start": None if self.start is None else [self.start[0], self.start[1].tolist()],
            "reductions": [r if isinstance(r, str) else function_name(r) for r in self.reductions],
            **rule,
        }


def ensemble_task_from(entry: dict[str, Any]) -> EnsembleTask:
    """Return the task of a description, whose functions are imported; refuse one of which data are not enough."""
    if missing := missing_part(json.loads(entry["motion"])) or missing_part(json.loads(entry["parameters"])):
        raise ValueError(f"one whose {missing}")
    reductions = [name if name in REDUCTIONS else function_from(name) for name in entry["reductions"]]
    start = dict([entry["start"]]) if entry["start"] else {}
    options = {name: entry[name] for name in ("steps", "save_every", "reconstruct", "branch") if name in entry}
    if RULE in entry:
        options["branch"] = function_from(entry[RULE])
    return EnsembleTask(io.provenance.restore_motion(entry, None), reductions=reductions, **options, **start)


def _check_starts(discrete: Discretization, start: Start | None, names: Sequence[str]) -> None:
    """Refuse a design that varies several starts, components that the start does not have, or leaves none."""
    if len(whole := [name for name in names if name in _names.STARTS]) > 1:
        raise error("sweep(design=...)", "vary one start", " and ".join(whole), "Choose one.")
    parts = {name: part for name in names if (part := _names.start_component(name))}
    if not whole and start is None:
        _check_all(discrete, parts)
    else:
        _check_components(None if whole else start, parts)


def _check_components(start: Start | None, parts: dict[str, tuple[str, int]]) -> None:
    """Refuse components of another start than that of the task, whole or not, and those that it does not have."""
    for name, (owner, component) in parts.items():
        if start is None or start[0] != owner:
            remedy = f"Pass EnsembleTask(..., {owner}=...) with what the other components are, or vary each of them."
            raise error("sweep(design=...)", "vary components of the start of the task", shown(name), remedy)
        if component >= len(start[1]):
            raise _names.no_component(f"{name!r} of a start with {len(start[1])}")


def _rows_of_starts(start: Start | None, block: MemberBlock) -> dict[str, Float[np.ndarray, "count n"]]:
    """Return the start of each member of a block, by its name."""
    parts = {name: part for name in block if (part := _names.start_component(name))}
    if whole := [name for name in block if name in _names.STARTS]:
        name, value = whole[0], block[whole[0]]
    elif start is not None:
        name, value = start
    else:
        name, value = next(iter(parts.values()))[0], np.zeros(len(parts))
    rows = np.broadcast_to(value, (block.count, np.shape(value)[-1])).copy()
    for key, (_, component) in parts.items():
        rows[:, component] = block[key]
    return {name: rows}


def _check_all(discrete: Discretization, parts: dict[str, tuple[str, int]]) -> None:
    """Refuse components that are not all of one start, where the task has none."""
    if not (owners := {owner for owner, _ in parts.values()}):
        raise error("sweep(task=...)", "have a start", "none", "Pass body_velocity=..., or vary it in the design.")
    if len(owners) > 1:
        raise error("sweep(design=...)", "vary components of one start", " and ".join(parts), "Choose one.")
    (owner,) = owners
    k, dim = discrete.system.rank, discrete.system.group.dim
    lengths: dict[str, Any] = {"body_velocity": (dim,), "restricted_velocity": (k,), "momentum": (k, dim)}
    components = sorted(component for _, component in parts.values())
    if not any(components == list(range(length)) for length in lengths[owner]):
        sizes = " or ".join(dict.fromkeys(map(str, lengths[owner])))
        remedy = f"Vary {owner}_0 to the last one, or pass EnsembleTask(..., {owner}=...) with what the others are."
        requirement = f"vary all {sizes} components of a start that is not given"
        raise error("sweep(design=...)", requirement, str(components), remedy)
