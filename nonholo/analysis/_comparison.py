r"""Two motions of one body beside each other: errors of momentum, pose and energy, and their order in the time step."""

import dataclasses
import importlib
from collections.abc import Sequence
from typing import Any, NamedTuple, overload

import numpy as np

from nonholo.base.checks import error, instance, shown
from nonholo.base.types import Float
from nonholo.orbit import AbstractOrbit
from nonholo.systems import have_same_rows

_SAME_TIME = 1e-9  # in units of the shortest time between two states
_ROUNDING = 1e-12  # errors below this part of a quantity say nothing of an order
_REMEDY = "Pass what `simulate`, `flow` or `Orbit.from_poses` returned."


class Errors(NamedTuple):
    """Errors of the three things that a motion is measured by; None where one of the orbits does not know it.

    Attributes:
        momentum: Of momenta along admissible directions.
        pose: Of configurations.
        energy: Of energies.
    """

    momentum: Any
    pose: Any
    energy: Any


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    r"""The errors of an orbit against another one, made by `compare`.

    Attributes:
        time: The times at which both are known, shape (K,).
        momentum: $|r - r'|$ of the momenta along admissible directions, shape (K,).
        pose: On a group $\|g^{-1}g' - I\|$ (Frobenius), in coordinates $|q - q'|$, shape (K,); None without poses.
        energy: $E - E'$, with its sign, shape (K,); None where it needs poses that are not known.
        sizes: The largest momentum, pose and energy of the reference.
        time_step: That of the orbit; None for a flow.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)
        >>> start = {"body_velocity": (1.0, 0.5, 0.0)}
        >>> orbit = nh.simulate(nh.discretize(sleigh, 0.1), **start, steps=100)
        >>> against = nh.compare(orbit, nh.flow(sleigh, **start, times=(0.0, 10.0)))
        >>> round(against.largest.pose, 4), round(against.last.momentum, 5), abs(against.largest.energy) < 1e-13
        (0.0043, 1e-05, True)
    """

    time: Float[np.ndarray, "K"]
    momentum: Float[np.ndarray, "K"]
    pose: Float[np.ndarray, "K"] | None
    energy: Float[np.ndarray, "K"] | None
    sizes: Errors
    time_step: float | None = None

    def __repr__(self) -> str:
        parts = [f"{name} {value:.3g}" for name, value in self.largest._asdict().items() if value is not None]
        return f"<Comparison at {len(self)} times, largest errors: {', '.join(parts)}>"

    def __len__(self) -> int:
        return len(self.time)

    @property
    def errors(self) -> Errors:
        """The three errors at all times."""
        return Errors(self.momentum, self.pose, self.energy)

    @property
    def largest(self) -> Errors:
        """The largest absolute errors."""
        return Errors(*(None if rows is None else float(np.abs(rows).max()) for rows in self.errors))

    @property
    def last(self) -> Errors:
        """The errors at the last common time of the orbit."""
        return Errors(*(None if rows is None else float(rows[-1]) for rows in self.errors))

    def plot(self, path: Any = None, *, overwrite: bool = False) -> Any:
        """Draw the errors against time; return the matplotlib figure, saved to a new `path` if given."""
        return importlib.import_module("nonholo.plot").comparison(self, path, overwrite=overwrite)


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Convergence:
    """The errors of orbits with different time steps against one other, made by `compare`.

    Attributes:
        comparisons: Each orbit against the reference, the largest time step first.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> start = {"body_velocity": (0.4, 0.9, 0.0)}
        >>> runs = [nh.simulate(nh.discretize(top, 4 / n), **start, steps=n) for n in (40, 80, 160)]
        >>> study = nh.compare(runs, nh.flow(top, **start, times=(0.0, 4.0)))
        >>> study
        <Convergence over 3 time steps, order: momentum 2.00, pose 2.00, energy at rounding>
    """

    comparisons: tuple[Comparison, ...]

    def __repr__(self) -> str:
        slopes = {name: value for name, value in self.order._asdict().items() if value is not None}
        orders = ", ".join(f"{name} {'at rounding' if np.isnan(x) else f'{x:.2f}'}" for name, x in slopes.items())
        return f"<Convergence over {len(self)} time steps, order: {orders}>"

    def __len__(self) -> int:
        return len(self.comparisons)

    @property
    def time_step(self) -> Float[np.ndarray, "R"]:
        """The time steps, the largest first."""
        return np.array([each.time_step for each in self.comparisons])

    @property
    def largest(self) -> Errors:
        """The largest absolute errors of each orbit, shape (R,)."""
        columns = zip(*(each.largest for each in self.comparisons), strict=True)
        return Errors(*(None if None in column else np.array(column) for column in columns))

    @property
    def order(self) -> Errors:
        r"""The slopes of $\log$ error over $\log h$, by least squares; NaN where errors are only rounding."""
        sizes = zip(*(each.sizes for each in self.comparisons), strict=True)
        return Errors(*map(self._slope, self.largest, sizes))

    def plot(self, path: Any = None, *, overwrite: bool = False) -> Any:
        """Draw the errors over the time step; return the matplotlib figure, saved to a new `path` if given."""
        return importlib.import_module("nonholo.plot").convergence(self, path, overwrite=overwrite)

    def _slope(self, errors: np.ndarray | None, sizes: Sequence[float | None]) -> float | None:
        if errors is None or None in sizes:
            return None
        is_clear = errors > _ROUNDING * np.array(sizes)
        if is_clear.sum() < 2:
            return float("nan")
        return float(np.polyfit(np.log(self.time_step[is_clear]), np.log(errors[is_clear]), 1)[0])


@overload
def compare(orbit: AbstractOrbit, flow: AbstractOrbit) -> Comparison: ...
@overload
def compare(orbit: Sequence[AbstractOrbit], flow: AbstractOrbit) -> Convergence: ...
def compare(orbit: AbstractOrbit | Sequence[AbstractOrbit], flow: AbstractOrbit) -> Comparison | Convergence:
    r"""Compare an orbit with another one, state by state: errors of momentum, pose and energy.

    $$ |r_k - r(t_k)|, \qquad \|g_k^{-1}g(t_k) - I\| \ \text{or}\ |q_k - q(t_k)|, \qquad E_k - E(t_k). $$

    The states of a flow of a body on a group are those at the times of the other orbit (`Orbit.at`). Of two orbits
    without states in between, states at equal times are compared. Momenta are taken along admissible
    directions, which approach the flow's with the order of the map; the full momentum of a discrete orbit contains
    half an impulse of the constraint. The Frobenius norm is defined for each group and all angles: for a turn by
    $\alpha$ in the plane or in space it is $2\sqrt2\,|\sin\tfrac\alpha2|$, for a translation its length.

    Args:
        orbit: An orbit; or several discrete orbits with different time steps, to see the order.
        flow: The other orbit: a flow, or any orbit of the same body.

    Returns:
        `Comparison`; for several orbits `Convergence`.

    Raises:
        ValueError: An argument that is no orbit; orbits in different spaces, with momenta along different directions,
            or without a common time; several orbits that have no, or equal, time steps.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(mass=1.0, inertia=0.75, a=0.5)
        >>> start = {"body_velocity": (1.0, 0.5, 0.0)}
        >>> flow = nh.flow(sleigh, **start, times=(0.0, 4.0))
        >>> runs = [nh.simulate(nh.discretize(sleigh, h), **start, steps=round(4 / h)) for h in (0.2, 0.1, 0.05)]
        >>> round(nh.compare(runs, flow).order.pose, 1)
        2.0
    """
    instance("compare(flow=...)", flow, AbstractOrbit, "be an orbit", _REMEDY)
    if not isinstance(orbit, list | tuple):
        one = instance("compare(orbit=...)", orbit, AbstractOrbit, "be an orbit, or a list of them", _REMEDY)
        return _compare_two(one, flow)
    for number, each in enumerate(orbit):
        instance(f"compare(orbit=...)[{number}]", each, AbstractOrbit, "be an orbit", _REMEDY)
    steps = [each.time_step for each in orbit]
    if len(steps) < 2 or None in steps or len(set(steps)) < len(steps):
        remedy = "Pass discrete orbits, two or more; one orbit alone without a list."
        raise error("compare(orbit=...)", "have different time steps", shown(steps), remedy)
    finest_last = sorted(orbit, key=lambda each: -(each.time_step or 0))
    return Convergence(tuple(_compare_two(each, flow) for each in finest_last))


def _compare_two(orbit: AbstractOrbit, flow: AbstractOrbit) -> Comparison:
    _check_alike(orbit, flow)
    (orbit, i), (other, j) = _common_rows(orbit, flow)
    has_poses, pose = orbit.has_poses and other.has_poses, None
    momenta = orbit.restricted_momentum[i] - other.restricted_momentum[j]
    if has_poses:  # coordinates, or matrices with the displacement between them
        g, off = orbit.configuration[i], other.configuration[j] - orbit.configuration[i]
        pose = np.linalg.norm(off if g.ndim == 2 else np.linalg.solve(g, off), axis=tuple(range(1, g.ndim)))
    has_energy = has_poses or not getattr(orbit.system, "is_spatial", False)
    energy = orbit.energy[i] - other.energy[j] if has_energy else None
    sizes = Errors(
        float(np.linalg.norm(other.restricted_momentum[j], axis=1).max()),
        float(np.abs(other.configuration[j]).max()) if has_poses else None,
        float(np.abs(other.energy[j]).max()) if has_energy else None,
    )
    return Comparison(orbit.time[i], np.linalg.norm(momenta, axis=1), pose, energy, sizes, orbit.time_step)


def _check_alike(orbit: AbstractOrbit, flow: AbstractOrbit) -> None:
    where = "compare(flow=...)"
    if orbit.space != flow.space:
        raise error(where, f"move in {orbit.space}", f"{flow.space}", "Pass a motion of the same body.")
    systems = orbit.system, flow.system
    if all(each.is_wide for each in systems) or not all(hasattr(each, "constraint_subspace") for each in systems):
        is_alike = orbit.restricted_momentum.shape[1] == flow.restricted_momentum.shape[1]
    else:
        is_alike = have_same_rows(*systems)
    if not is_alike:
        remedy = "Momenta along different directions cannot be compared."
        raise error(where, "have the constraint of the orbit", "another constraint", remedy)


def _common_rows(orbit: AbstractOrbit, flow: AbstractOrbit) -> tuple[tuple[AbstractOrbit, np.ndarray], ...]:
    """Return both orbits and the rows that are at the same times; a flow that knows its states between at new times."""
    for one, other in ((orbit, flow), (flow, orbit)):
        if other.span is not None:
            near, (first, last) = _nearness(one.time), sorted(other.span)
            rows = np.flatnonzero((one.time >= first - near) & (one.time <= last + near))
            _check_common(rows)
            rest = other.at(np.clip(one.time[rows], first, last)), np.arange(len(rows))
            return ((one, rows), rest) if one is orbit else (rest, (one, rows))
    first, second = orbit.time, flow.time
    _check_common(first if len(second) else second)  # an orbit may have no states
    order = np.argsort(second, kind="stable")
    after = np.searchsorted(second, first, sorter=order).clip(1, max(1, len(second) - 1))
    around = order[np.stack([after - 1, np.minimum(after, len(second) - 1)])]
    nearest = np.take_along_axis(around, np.abs(second[around] - first).argmin(axis=0)[None], axis=0)[0]
    rows = np.flatnonzero(np.abs(second[nearest] - first) <= min(_nearness(first), _nearness(second)))
    _check_common(rows)
    return (orbit, rows), (flow, nearest[rows])


def _nearness(time: np.ndarray) -> float:
    """Return the difference up to which times are taken for equal."""
    gaps = np.abs(np.diff(time))
    return _SAME_TIME * float(gaps.min(initial=np.inf, where=gaps > 0) if gaps.any() else np.abs(time).max(initial=0.0))


def _check_common(rows: np.ndarray) -> None:
    if not len(rows):
        remedy = "Solve the flow at the times of the orbit: flow(..., times=orbit.time)."
        raise error("compare(flow=...)", "have a time in common with the orbit", "none", remedy)
