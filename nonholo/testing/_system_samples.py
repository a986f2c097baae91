"""Samples of a system: admissible velocities, poses, and the state of its motion as functions of a short time."""

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.types import Float
from nonholo.continuous import vector_field
from nonholo.systems import AbstractSystem
from nonholo.testing._measures import derivative

_COUNT = 4


class SystemSamples:
    """Random admissible states of a system, with momenta and velocities from the definitions.

    Args:
        system: The system.
        rng: Where the numbers come from.
    """

    def __init__(self, system: AbstractSystem, rng: np.random.Generator) -> None:
        self.system, self.group = system, system.group
        self.spatial = system.is_spatial
        self.S, self.A = np.asarray(system.constraint_subspace), np.asarray(system.annihilator)
        self.inertia = np.asarray(system.inertia_operator)
        self.covectors = rng.normal(size=(_COUNT, self.group.dim))
        self._rows = rng.normal(size=(_COUNT, len(self.S)))
        self._rng = rng

    @functools.cached_property
    def velocity(self) -> Float[np.ndarray, "4 k"]:
        """Admissible velocities of norm one, in rows of the constraint subspace (spatial ones for an LR system)."""
        return self._rows / np.linalg.norm(self._rows @ self.S, axis=1)[:, None]

    @functools.cached_property
    def g(self) -> Float[np.ndarray, "4 N N"]:
        """Poses."""
        return np.stack([self.group.random(self._rng) for _ in range(_COUNT)])

    @functools.cached_property
    def directions(self) -> Float[np.ndarray, "4 k dim"]:
        """The admissible directions in the body."""
        if not self.spatial:
            return np.broadcast_to(self.S, (_COUNT, *self.S.shape))
        return np.swapaxes(self.group.adjoint(np.linalg.inv(self.g)) @ self.S.T, -1, -2)

    @functools.cached_property
    def body_velocity(self) -> Float[np.ndarray, "4 dim"]:
        """The body velocities."""
        return (self.velocity[:, None, :] @ self.directions)[:, 0]

    @functools.cached_property
    def momentum(self) -> Float[np.ndarray, "4 dim"]:
        """Their momenta."""
        return self.body_velocity @ self.inertia.T

    @functools.cached_property
    def restricted(self) -> Float[np.ndarray, "4 k"]:
        """The momenta along the admissible directions."""
        return (self.directions @ self.momentum[:, :, None])[:, :, 0]

    @functools.cached_property
    def rate(self) -> tuple[Float[np.ndarray, "4 k"], Float[np.ndarray, "4 N N"]]:
        """The rates of restricted momentum and pose by the vector field of the system."""
        k = len(self.S)
        state = np.concatenate([self.restricted, self.g.reshape(_COUNT, -1)], axis=-1)
        rate = vector_field(self.system)(0.0, state)
        return rate[:, :k], rate[:, k:].reshape(self.g.shape)

    def along_the_motion(self, quantity: Callable[[np.ndarray, np.ndarray], Any]) -> np.ndarray:
        """Return the rate of change of a function of restricted momentum and pose."""
        momentum_rate, pose_rate = self.rate
        turn = self.group.vee(np.linalg.inv(self.g) @ pose_rate)
        return derivative(lambda t: quantity(self.restricted + t * momentum_rate, self.g @ self.group.exp(t * turn)))

    def energy(self, restricted: np.ndarray, g: np.ndarray) -> np.ndarray:
        """Return the constrained energy that the system states."""
        system: Any = self.system
        return system.constrained_energy(restricted, g) if self.spatial else system.constrained_energy(restricted)

    def full_momentum(self, restricted: np.ndarray, g: np.ndarray) -> np.ndarray:
        """Return the momentum of the admissible velocity with these momenta along the constraint."""
        system: Any = self.system
        if not self.spatial:
            return system.restricted_velocity(restricted) @ self.S @ self.inertia.T
        spatial = system.restricted_velocity(restricted, g) @ self.S
        return (self.group.adjoint(np.linalg.inv(g)) @ spatial[..., None])[..., 0] @ self.inertia.T
