r"""Rows of canonical momenta and poses as what a user reads, a row with the same bits alone and among others.

`BodyDecoder` is for any body, by NumPy; `ClosedDecoder` for those with two admissible directions on SO(3) or SE(2),
compiled. Displacements are decoded by the motion that made them. Angles become continuous headings, also of
parts of a motion.
"""

import dataclasses
from typing import Any, ClassVar, TypeAlias

import numpy as np

from nonholo.base.numerics import applied
from nonholo.base.types import Float
from nonholo.kernels import decoding
from nonholo.systems import System

_TURN = 2 * np.pi


class AliasingWarning(UserWarning):
    """Given poses of which one is turned by more than 90 degrees from the one before.

    Its velocity is that of the shorter turn. The turn of a body that turns faster than half a turn a row is not
    determined.

    Example:
        >>> import warnings
        >>> poses = nh.SE(2).exp([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]])
        >>> with warnings.catch_warnings(record=True) as caught:
        ...     warnings.simplefilter("always")
        ...     fast = nh.Orbit.from_poses(nh.ChaplyginSleigh(1.0, 1.0, 0.5), [0, 1], poses)
        >>> caught[0].category.__name__, fast.body_velocity[0, 0].round(3)
        ('AliasingWarning', np.float64(-0.757))
    """


def configurations(system: System, pose: Float[np.ndarray, "K size"]) -> Float[np.ndarray, "K N N"]:
    """Return the matrices, in the user's body frame, of compact poses in the canonical one."""
    g = system.group.matrix_from_pose(pose)
    if is_own_frame(system):
        return g.copy() if np.may_share_memory(g, pose) else g
    return g @ system.group.inverse(system.frame)


def poses(system: System, canonical_pose: Float[np.ndarray, "K size"]) -> Float[np.ndarray, "K size"]:
    """Return compact poses, in the user's body frame, from those in the canonical one; the same where frames are.

    Example:
        >>> from nonholo.systems import ChaplyginSleigh
        >>> poses(ChaplyginSleigh(1.0, 1.0, 0.5, b=0.25), np.array([[1.0, 0.0, 3.0, 0.25]]))
        array([[1., 0., 3., 0.]])
    """
    if is_own_frame(system):
        return canonical_pose
    group = system.group
    return group.pose_product(canonical_pose, group.pose_from_matrix(group.inverse(system.frame)))


def is_own_frame(system: System) -> bool:
    """Return whether the user's body frame is the canonical one."""
    return system.canonical is system or np.array_equal(np.asarray(system.frame), system.group.identity)


def unwrap(pose: Float[np.ndarray, "K 4"], before: float | None = None) -> Float[np.ndarray, "K"]:
    """Return the angles of compact poses on SE(2); the shorter turn leads to each, to the first one from `before`.

    Full turns are counted in whole numbers, so no rounding gathers, and parts of a motion give the bits of the whole.

    Example:
        >>> pose = np.array([[-1.0, 0.1, 0.0, 0.0], [-1.0, -0.1, 0.0, 0.0]])
        >>> unwrap(pose).round(2), unwrap(pose[1:], before=3.0).round(2)
        (array([3.04, 3.24]), array([3.24]))
    """
    angle = np.arctan2(pose[:, 1], pose[:, 0])
    turns = np.rint(np.diff(angle, prepend=angle[:1] if before is None else before) / _TURN)
    return angle - _TURN * np.cumsum(turns)


def turned_near(headings: Float[np.ndarray, "... K"], pose: Float[np.ndarray, "... K 4"]) -> Float[np.ndarray, "... K"]:
    """Return the headings at compact poses on SE(2) that are less than half a turn from given ones.

    Example:
        >>> turned_near(np.array([6.3]), np.array([[1.0, 0.0, 0.0, 0.0]])).round(2)
        array([6.28])
    """
    angle = np.arctan2(pose[..., 1], pose[..., 0])
    return angle + _TURN * np.rint((headings - angle) / _TURN)


@dataclasses.dataclass(frozen=True, eq=False)
class BodyDecoder:
    """Columns that are read from the momenta and poses of orbits of any system."""

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
        return self.system.canonical.constrained_energy(orbit.reduced_momentum, self.system.constraint_poses(orbit))


@dataclasses.dataclass(frozen=True, eq=False)
class ClosedDecoder:
    """The same of a body with two admissible directions on SO(3) or SE(2).

    Attributes:
        numbers: Its numbers for the compiled loops.
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
    """Return the decoder of a system: the compiled one if it has two admissible directions on SO(3) or SE(2)."""
    group = system.group
    if group.curvature is None or system.is_spatial or system.rank != 2 or system.canonical.inertia_factors is None:
        return BodyDecoder(system)
    (T, d), frame, S = system.canonical.inertia_factors, system.frame, system.constraint_subspace
    own, arms, (across,) = is_own_frame(system), system.canonical.constraint_subspace.T, system.annihilator
    arms = arms if own else group.adjoint(frame) @ arms
    numbers = decoding.Reading(
        curvature=group.curvature,
        arms=_flat(arms),
        pulls=_flat(system.inertia_operator @ arms),
        rows=_flat(S),
        across=_flat(across / (across @ across)),
        back=_flat(frame if own else group.inverse(frame)),
        factors=(float(T[1, 0]), float(d[0]), float(d[1])),
        is_turned=not own,
    )
    return ClosedDecoder(numbers)


def _flat(matrix: np.ndarray) -> Any:
    return tuple(matrix.ravel().tolist())
