r"""Decoders: rows of canonical momenta and poses as what a user reads, a row with the same bits alone and among others.

`BodyDecoder` is for any body, by NumPy; `ClosedDecoder` for those with two admissible directions on SO(3) or SE(2),
compiled. What displacements tell is decoded by the motion that made them.
"""

import dataclasses
from typing import Any, ClassVar, TypeAlias

import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.types import Float
from nonholo.kernels import decoding
from nonholo.orbit._poses import configurations, is_own_frame
from nonholo.systems import System


@dataclasses.dataclass(frozen=True, eq=False)
class BodyDecoder:
    """What is read of the momenta and poses of orbits of any system."""

    system: System
    numbers: ClassVar[None] = None

    def configuration(self, orbit: Any) -> Float[np.ndarray, "K N N"]:
        """Return poses as matrices, in the user's body frame."""
        return configurations(self.system, orbit.canonical_pose)

    def position(self, orbit: Any) -> Float[np.ndarray, "K n"]:
        """Return the translation parts of the poses of a group of motions."""
        return orbit.configuration[:, :-1, -1]

    def body_velocity(self, orbit: Any) -> Float[np.ndarray, "K dim"]:
        """Return the admissible body velocities that have the momenta."""
        system, r = self.system, orbit.reduced_momentum
        if system.is_spatial:
            g = orbit.configuration
            spatial = applied(system.constraint_subspace.T, system.restricted_velocity(r, g))
            return applied(system.group.adjoint(system.group.inverse(g)), spatial)
        body = system.canonical
        velocity = applied(body.constraint_subspace.T, body.restricted_velocity(r))
        return velocity if body is system else applied(system.group.adjoint(system.frame), velocity)

    def kinetic_energy(self, orbit: Any) -> Float[np.ndarray, "K"]:
        """Return the energies of these velocities."""
        if self.system.is_spatial:
            return self.system.constrained_energy(orbit.reduced_momentum, orbit.configuration)
        return self.system.canonical.constrained_energy(orbit.reduced_momentum)


@dataclasses.dataclass(frozen=True, eq=False)
class ClosedDecoder:
    """The same of a body with two admissible directions on SO(3) or SE(2).

    Attributes:
        numbers: What the compiled loops read it with.
    """

    numbers: decoding.Reading

    def configuration(self, orbit: Any) -> Float[np.ndarray, "K 3 3"]:
        """Return poses as matrices, in the user's body frame."""
        return decoding.read(decoding.write_matrices, self.numbers, (orbit.canonical_pose,), (3, 3))

    def position(self, orbit: Any) -> Float[np.ndarray, "K 2"]:
        """Return the translation parts of the poses of a group of motions."""
        return decoding.read(decoding.write_positions, self.numbers, (orbit.canonical_pose,), (2,))

    def body_velocity(self, orbit: Any) -> Float[np.ndarray, "K 3"]:
        """Return the admissible body velocities that have the momenta."""
        return decoding.read(decoding.write_velocities, self.numbers, (orbit.reduced_momentum,), (3,))

    def kinetic_energy(self, orbit: Any) -> Float[np.ndarray, "K"]:
        """Return the energies of these velocities."""
        return decoding.read(decoding.write_energies, self.numbers, (orbit.reduced_momentum,), ())


Decoder: TypeAlias = BodyDecoder | ClosedDecoder


def decoder_of(system: System) -> Decoder:
    """Return the decoder of a system."""
    numbers = _reading_of(system)
    return BodyDecoder(system) if numbers is None else ClosedDecoder(numbers)


def _reading_of(system: System) -> decoding.Reading | None:
    """Return the numbers of a body that has two admissible directions on SO(3) or SE(2); None of others."""
    group = system.group
    if group.curvature is None or system.is_spatial:
        return None
    frame, S = system.frame, system.constraint_subspace
    if len(S) != 2 or system.canonical.inertia_factors is None:
        return None
    T, d = system.canonical.inertia_factors
    own, arms, (across,) = is_own_frame(system), system.canonical.constraint_subspace.T, system.annihilator
    arms = arms if own else group.adjoint(frame) @ arms
    return decoding.Reading(
        curvature=group.curvature,
        arms=_flat(arms),
        pulls=_flat(system.inertia_operator @ arms),
        rows=_flat(S),
        across=_flat(across / (across @ across)),
        back=_flat(frame if own else group.inverse(frame)),
        factors=(float(T[1, 0]), float(d[0]), float(d[1])),
        turned=not own,
    )


def _flat(matrix: np.ndarray) -> Any:
    return tuple(matrix.ravel().tolist())
