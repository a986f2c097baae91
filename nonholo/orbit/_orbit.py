r"""Orbits store compact states in the canonical body frame of their system; matrices are computed on access.

A state is the momentum along the constraint subspace, for a discrete orbit the Cayley coordinates of the displacement,
and the compact pose. `AbstractMotion` is what a discretisation or a flow must know to decode them.
"""

import abc
import dataclasses
import importlib
from typing import Any

import numpy as np

from nonholo._results import Outcome
from nonholo._types import Array, Float
from nonholo.systems import AbstractLLSystem


class AbstractMotion(abc.ABC):
    """A rule of motion of a system: a discretisation or the continuous flow."""

    system: AbstractLLSystem

    @abc.abstractmethod
    def full_momentum(self, reduced_momentum: Float[np.ndarray, "K k"], cayley: Array) -> Float[np.ndarray, "K dim"]:
        """Return body momenta, in the user's body frame, of canonical compact states."""

    @abc.abstractmethod
    def multipliers(
        self, reduced_momentum: Float[np.ndarray, "K k"], cayley: Array, save_every: int
    ) -> Float[np.ndarray, "L s"]:
        """Return the multipliers that belong to canonical compact states."""


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Orbit:
    r"""A motion at K saved states, from `simulate` or `flow`.

    Arrays are in the user's body frame, momenta in physical units. In a discrete orbit $W_k = g_k^{-1} g_{k+1}$ is the
    displacement and $P_k$ the momentum at $W_k$; with `save_every` > 1 displacements and multipliers are those of the
    single steps at the saved k.

    Attributes:
        motion: The discretisation or flow that made it.
        time: Times of the saved states, shape (K,).
        reduced_momentum: Compact momenta, canonical frame, shape (K, k).
        cayley: Compact displacements, canonical frame, shape (K, k); None for a flow.
        pose: Compact poses, canonical frame, shape (K, size); None if not reconstructed.
        outcome: How the run ended.
        save_every: Steps between saved states.
        turned: Heading without ambiguity of full turns, where the run knows it, shape (K,).

    Example:
        >>> sleigh = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        >>> orbit = nh.simulate(sleigh, body_velocity=(1, 0, 0), steps=3)
        >>> orbit.configuration.shape, orbit.multipliers.shape, str(orbit.outcome)
        ((4, 3, 3), (3, 1), 'successful')
    """

    motion: AbstractMotion
    time: Float[np.ndarray, "K"]
    reduced_momentum: Float[np.ndarray, "K k"]
    cayley: Float[np.ndarray, "K k"] | None
    pose: Float[np.ndarray, "K size"] | None
    outcome: Outcome = Outcome.successful
    save_every: int = 1
    turned: Float[np.ndarray, "K"] | None = None

    def __repr__(self) -> str:
        span = f", time {self.time[0]:g} to {self.time[-1]:g}" if len(self) else ""
        return f"<Orbit of {type(self.system).__name__}: {len(self)} states{span}, {self.outcome}>"

    def __len__(self) -> int:
        return len(self.time)

    def __getitem__(self, states: slice) -> "Orbit":
        """Return the orbit at a forward slice of its states."""
        if not isinstance(states, slice):
            raise TypeError(f"`Orbit[...]` takes slices. Got {states!r}. Index an array instead: orbit.momentum[0].")
        stride = states.indices(len(self))[2]
        if stride < 1:
            raise ValueError(f"`Orbit[...]` must be sliced forwards. Got stride {stride}. Reverse the arrays instead.")
        names = ("time", "reduced_momentum", "cayley", "pose", "turned")
        kept = {name: None if (rows := getattr(self, name)) is None else rows[states] for name in names}
        return dataclasses.replace(self, save_every=self.save_every * stride, **kept)

    @property
    def system(self) -> AbstractLLSystem:
        """The system that moves."""
        return self.motion.system

    @property
    def restricted_momentum(self) -> Float[np.ndarray, "K k"]:
        """Momenta along the rows of the constraint subspace."""
        return np.linalg.solve(self.system.frame_map, self.reduced_momentum[..., None])[..., 0]

    @property
    def chart(self) -> Float[np.ndarray, "K k"]:
        """Cayley coordinates y of the displacements in rows of the constraint subspace, W = cayley(2 y)."""
        return self._displaced() @ self.system.frame_map

    @property
    def momentum(self) -> Float[np.ndarray, "K dim"]:
        """Body momenta."""
        return self.motion.full_momentum(self.reduced_momentum, self.cayley)

    @property
    def multipliers(self) -> Float[np.ndarray, "L s"]:
        """Impulses between the states of a discrete orbit, (K - 1, s), or forces at the times of a flow, (K, s)."""
        return self.motion.multipliers(self.reduced_momentum, self.cayley, self.save_every)

    @property
    def displacement(self) -> Float[np.ndarray, "K N N"]:
        """Displacements of single steps at the saved states."""
        group, canonical, frame = self.system.group, self.system.canonical, self.system.frame
        W = group.cayley(2 * self._displaced() @ canonical.constraint_subspace)
        return frame @ W @ group.inverse(frame)

    @property
    def configuration(self) -> Float[np.ndarray, "K N N"]:
        """Poses as matrices."""
        group = self.system.group
        return group.matrix_from_pose(self._posed()) @ group.inverse(self.system.frame)

    @property
    def body_velocity(self) -> Float[np.ndarray, "K dim"]:
        """Admissible body velocities whose momenta along the constraint are those of the states."""
        system = self.system
        velocity = system.canonical.restricted_velocity(self.reduced_momentum) @ system.canonical.constraint_subspace
        return velocity @ system.group.adjoint(system.frame).T

    @property
    def spatial_momentum(self) -> Float[np.ndarray, "K dim"]:
        """Momenta carried to space, the plain transpose of Ad at the inverse pose."""
        group = self.system.group
        return group.coadjoint(group.inverse(self.configuration), self.momentum)

    @property
    def position(self) -> Float[np.ndarray, "K n"]:
        """Translation parts of the poses; for groups of motions."""
        configuration = self.configuration
        if self.system.group.dim != 3 or configuration[0, -1, -1] != 1 or np.any(configuration[:, -1, :-1]):
            raise ValueError(f"`Orbit.position` needs a group of motions. Got {self.system.group}. Use configuration.")
        return configuration[:, :-1, -1]

    @property
    def heading(self) -> Float[np.ndarray, "K"]:
        """Unwrapped angle of the body on SE(2); between saved states the shorter turn is assumed unless it is known."""
        if self.turned is not None:
            return self.turned
        _ = self.position
        pose = self._posed()
        return np.unwrap(np.arctan2(pose[:, 1], pose[:, 0]))

    @property
    def energy(self) -> Float[np.ndarray, "K"]:
        """Reduced constrained energy."""
        return self.system.canonical.constrained_energy(self.reduced_momentum)

    def to_dataset(self) -> Any:
        """Return the orbit as a labelled `xarray.Dataset` that `load_orbit` and Zarr understand."""
        return importlib.import_module("nonholo.io").orbit_to_dataset(self)

    def plot(self, path: str | None = None) -> Any:
        """Draw the overview picture of the orbit; return the matplotlib figure, saved to `path` if given."""
        return importlib.import_module("nonholo.plotting").overview(self, path)

    def _displaced(self) -> np.ndarray:
        if self.cayley is None:
            raise ValueError("`Orbit.displacement` needs a discrete orbit. Got a continuous flow. Use `simulate`.")
        return self.cayley

    def _posed(self) -> np.ndarray:
        if self.pose is None:
            raise ValueError("`Orbit.configuration` needs poses. Got reconstruct=False. Run with reconstruct=True.")
        return self.pose
