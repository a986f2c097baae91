"""The result of `ensemble`: compact states of all members, decoded on access as those of an orbit are."""

import dataclasses
import importlib
from typing import Any

import numpy as np

from nonholo.base.checks import error, natural
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome
from nonholo.base.types import Float, Int
from nonholo.discrete import Discretization
from nonholo.groups import SE
from nonholo.orbit import Orbit
from nonholo.simulation.members._event_log import MemberEvents
from nonholo.simulation.members._families import family_of, have_kernel, scalar_members
from nonholo.simulation.members._members import Members
from nonholo.simulation.members._start import energies
from nonholo.systems import System

_OF_FRAME = ("configuration", "pose", "position", "displacement")


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Ensemble:
    r"""Motions of M members at K saved states, from `ensemble`: arrays as in an `Orbit`, with a leading member axis.

    With `save_every=None` K = 1, and the state is the last good one of each member, after `steps_done` steps. Otherwise
    row j is the state after j `save_every` steps; a member that ends early has NaN in its later rows. A member whose
    start has no principal root has only NaN. `outcome` tells them apart.

    Attributes:
        members: The discretized system and the parameters.
        steps: Number of steps N that were asked for.
        save_every: Steps between saved states; None if only the last one is kept.
        reduced_momentum: Compact momenta, canonical frame, shape (M, K, k).
        cayley: Chart coordinates of the displacements, canonical frame, shape (M, K, m).
        canonical_pose: Compact poses, canonical frame, shape (M, K, size); None if not reconstructed.
        outcome: How each member ended, values of `Outcome`, shape (M,).
        steps_done: Good steps of each member, shape (M,); of states at crossings with the fraction of the last one.
        first_momentum: Compact momenta of the starts, canonical frame, shape (M, k).
        events: What `events=` of the run found, a `MemberEvents`: by name or position how many crossings each member
            has, and the states at the first and the last. None without `events=`.

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> batch = nh.ensemble(sleigh, restricted_velocity=[[1, 0], [0, 1], [9, -9]], steps=100)
        >>> batch.momentum.shape, batch.steps_done, str(batch.orbit(2).outcome)
        ((3, 1, 3), array([100, 100,   0]), 'no_real_branch')
    """

    members: Members
    steps: int
    save_every: int | None
    reduced_momentum: Float[np.ndarray, "M K k"]
    cayley: Float[np.ndarray, "M K m"]
    canonical_pose: Float[np.ndarray, "M K size"] | None
    outcome: Int[np.ndarray, "M"]
    steps_done: Int[np.ndarray, "M"] | Float[np.ndarray, "M"]
    first_momentum: Float[np.ndarray, "M k"]
    events: MemberEvents | None = None

    def __len__(self) -> int:
        return len(self.members)

    def __repr__(self) -> str:
        counts = zip(*np.unique(self.outcome, return_counts=True), strict=True)
        ended = ", ".join(f"{count} {Outcome(int(code))}" for code, count in counts)
        kind = type(self.members.discrete.system).__name__
        return f"<Ensemble of {kind}: {len(self)} members, {self.cayley.shape[1]} states each, {ended}>"

    def orbit(self, member: int) -> Orbit:
        """Return the good states of one member as an orbit."""
        member = natural("Ensemble.orbit(member=...)", member, "Pass the number of a member, from 0.")
        if member >= len(self):
            raise error("Ensemble.orbit(member=...)", f"be below {len(self)}", str(member), "Members count from 0.")
        kept = slice(0, int(np.isfinite(self.reduced_momentum[member, :, 0]).sum()))
        return self._orbit(member, kept)

    def _orbit(self, member: int, kept: slice | np.ndarray) -> Orbit:
        states = self._states(self.members.of(member), self.time[member, kept], (member, kept))
        every, width = self.save_every or self.steps or 1, self.cayley.shape[1]
        done = np.array(self.steps_done[member : member + 1] if self.save_every is None else every * np.arange(width))
        step = np.nan_to_num(done)[kept].astype(np.int64)
        return dataclasses.replace(states, outcome=Outcome(int(self.outcome[member])), save_every=every, step=step)

    def _states(self, discrete: Discretization, time: np.ndarray, rows: Any) -> Orbit:
        """Return some rows of the states as an orbit."""
        pose = None if self.canonical_pose is None else self.canonical_pose[rows]
        return Orbit(discrete, time, self.reduced_momentum[rows], self.cayley[rows], pose)

    @property
    def time(self) -> Float[np.ndarray, "M K"]:
        """Times of the states; with `save_every=None` that of each member's last good one."""
        if self.save_every is None:
            return (self.members.time_step * self.steps_done)[:, None]
        done = self.save_every * np.arange(self.cayley.shape[1])
        return np.broadcast_to(self.members.time_step[:, None] * done, self.cayley.shape[:2])

    @property
    def restricted_momentum(self) -> Float[np.ndarray, "M K k"]:
        """Momenta along the rows of the constraint subspace; spatial ones for a right-invariant constraint."""
        if not have_kernel(self.members):
            return self._decoded("restricted_momentum")
        return applied(np.linalg.inv(scalar_members(self.members).frame_map)[:, None], self.reduced_momentum)

    @property
    def energy(self) -> Float[np.ndarray, "M K"]:
        """Reduced constrained energies."""
        if not have_kernel(self.members):
            return self._decoded("energy")
        return energies(scalar_members(self.members), self.reduced_momentum)

    @property
    def first_energy(self) -> Float[np.ndarray, "M"]:
        """Reduced constrained energies of the starts."""
        if have_kernel(self.members):
            return energies(scalar_members(self.members), self.first_momentum)
        systems = [self.members.of(member).system for member in range(len(self))]
        return np.array([_first_energy(s, r) for s, r in zip(systems, self.first_momentum, strict=True)])

    @property
    def momentum(self) -> Float[np.ndarray, "M K dim"]:
        """Body momenta; decoded member by member where parameters differ, some 50 us each."""
        return self._decoded("momentum")

    @property
    def body_velocity(self) -> Float[np.ndarray, "M K dim"]:
        """Admissible body velocities whose momenta along the constraint are those of the states."""
        return self._decoded("body_velocity")

    @property
    def displacement(self) -> Float[np.ndarray, "M K N N"]:
        """Displacements W_k of single steps at the saved states."""
        return self._decoded("displacement")

    @property
    def configuration(self) -> Float[np.ndarray, "M K N N"]:
        """Poses as matrices; every member starts at the identity."""
        return self._decoded("configuration")

    @property
    def pose(self) -> Float[np.ndarray, "M K size"] | None:
        """Compact poses of the group in the user's body frame; None if not reconstructed."""
        if self.canonical_pose is None or not have_kernel(self.members) or self._is_shared("pose"):
            return None if self.canonical_pose is None else self._decoded("pose")
        group = self.members.discrete.system.group
        frames = group.matrix_from_pose(scalar_members(self.members).pose)[:, None]
        if np.array_equal(frames, np.broadcast_to(group.identity, frames.shape)):
            return self.canonical_pose
        sound = np.asarray(np.isfinite(self.canonical_pose).all(-1))
        moved = group.matrix_from_pose(self.canonical_pose) @ group.inverse(frames)
        return _spread(group.pose_from_matrix(moved[sound]), sound)

    @property
    def position(self) -> Float[np.ndarray, "M K n"]:
        """Translation parts of the poses; for groups of motions."""
        return self._decoded("position")

    @property
    def heading(self) -> Float[np.ndarray, "M K"]:
        """Angles of the body on SE(2): between saved states the shorter turn is assumed, from 0 at the start.

        With `save_every=None` nothing is known of full turns, and the angle is between -pi and pi.
        """
        group = self.members.discrete.system.group
        if group != SE(2) or self.canonical_pose is None:
            got = f"{group}" if group != SE(2) else "reconstruct=False"
            raise error("Ensemble.heading", "have poses in the plane", got, "Use configuration, or reconstruct=True.")
        return np.unwrap(np.arctan2(self.canonical_pose[..., 1], self.canonical_pose[..., 0]), axis=1)

    def to_dataset(self) -> Any:
        """Return the states as a labeled `xarray.Dataset` with dimensions `member` and `step`."""
        return importlib.import_module("nonholo.simulation.members._dataset").ensemble_to_dataset(self)

    def _decoded(self, name: str) -> np.ndarray:
        """Return a quantity of orbits, NaN after a member's end; in one go where it is the same function for all."""
        sound = np.asarray(np.isfinite(self.reduced_momentum).all(-1) & np.isfinite(self.cayley).all(-1))
        if self._is_shared(name):
            states = self._states(self.members.discrete, np.zeros(sound.sum()), sound)
            return _spread(getattr(states, name), sound)
        each = (getattr(self._orbit(member, sound[member]), name) for member in range(len(self)))
        return np.stack([_spread(found, rows) for found, rows in zip(each, sound, strict=True)])

    def _is_shared(self, name: str) -> bool:
        """Tell whether a quantity is the same function of the state for all members."""
        discrete = self.members.discrete
        if discrete.forces is not None:
            return False
        composed = discrete.order > 2 and name == "displacement"
        same = set() if name == "momentum" or composed else {"time_step"}
        family = family_of(discrete.system)
        if name in _OF_FRAME and not composed and family is not None:
            same |= family.keeps_frame
        return self.members.parameters.keys() <= same


def _spread(found: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return what belongs to some of the rows in its place among all of them, NaN in the others."""
    whole = np.full((*rows.shape, *found.shape[1:]), np.nan)
    whole[rows] = found
    return whole


def _first_energy(system: System, reduced: np.ndarray) -> float:
    """Return the energy of a canonical momentum at the identity; NaN of a member that has none."""
    if not np.isfinite(reduced).all():
        return np.nan
    kinetic, g = system.canonical.constrained_energy(reduced, system.group.identity), system.group.identity
    return float(kinetic if system.forces is None else kinetic + system.forces.potential_energy(g))
