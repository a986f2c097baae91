r"""Coordinates that cover the whole displacement variety of the two closed-form systems, the angle pi included.

Tops, n = 3: unit vectors $(z_0, z_1, z_2)$ up to sign, the quaternion of the displacement; the variety is the
projective plane. Sleighs: $(\Delta, \nu)$, the step angle and the translation along the direction $\Delta/2$, with
$(\Delta, \nu) \sim (\Delta + 2\pi, -\nu)$; the variety is a Moebius band. Both in the canonical frame.
"""

from typing import Any

import numpy as np

from nonholo._checks import error, shown
from nonholo._types import Float
from nonholo.discrete import Discretization
from nonholo.discrete._discretization import as_discretization
from nonholo.discrete._legendre import legendre
from nonholo.systems import ChaplyginSleigh, SuslovTop


def closed_form(where: str, value: Any) -> Discretization:
    """Refuse what is not a top with n = 3 or a sleigh under the discretisation that keeps energy."""
    discrete = as_discretization(where, value)
    system = discrete.system
    known = isinstance(system, ChaplyginSleigh) or (isinstance(system, SuslovTop) and system.axis is not None)
    if not known:
        raise error(
            where, "be of a top with n = 3 or of a sleigh", shown(system), "For others sample `discrete_legendre`."
        )
    if not discrete.conserves_energy:
        got = f"difference={discrete.difference!r}, constraint={discrete.constraint!r}"
        raise error(where, "keep energy", got, "Use difference='matrix' and constraint='skew'.")
    return discrete


def displacement_at(discrete: Discretization, points: Float[np.ndarray, "... c"]) -> Float[np.ndarray, "... N N"]:
    """Return the displacements, in the user's frame, with these coordinates."""
    frame = np.asarray(discrete.system.frame)
    canonical = _rotation(points) if isinstance(discrete.system, SuslovTop) else _motion(points)
    return frame @ canonical @ discrete.system.group.inverse(frame)


def momentum_at(discrete: Discretization, points: Float[np.ndarray, "... c"]) -> Float[np.ndarray, "... 3"]:
    """Return the momenta, physical and in the user's frame, of the displacements with these coordinates."""
    return legendre(discrete, displacement_at(discrete, points) - discrete.system.group.identity, "left")


def points_of(discrete: Discretization, displacement: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... c"]:
    """Return the coordinates of displacements on the variety; of a top with the largest component positive."""
    frame = np.asarray(discrete.system.frame)
    W = discrete.system.group.inverse(frame) @ displacement @ frame
    return _half_turns(W) if isinstance(discrete.system, SuslovTop) else _angles(W)


def _rotation(z: np.ndarray) -> np.ndarray:
    z0, z1, z2 = np.moveaxis(z, -1, 0)
    rows = (
        (1 - 2 * z1 * z1, -2 * z1 * z2, 2 * z0 * z1),
        (-2 * z1 * z2, 1 - 2 * z2 * z2, 2 * z0 * z2),
        (-2 * z0 * z1, -2 * z0 * z2, 2 * z0 * z0 - 1),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _half_turns(W: np.ndarray) -> np.ndarray:
    """Return z from the columns of z z^T, the longest of which is nowhere small."""
    outer = np.empty_like(W)
    outer[..., 0, 0] = (1 + W[..., 2, 2]) / 2
    outer[..., 0, 1:] = outer[..., 1:, 0] = W[..., :2, 2] / 2
    outer[..., 1:, 1:] = (np.eye(2) - W[..., :2, :2]) / 2
    largest = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    column = np.take_along_axis(outer, largest[..., None, None], axis=-1)[..., 0]
    return column / np.linalg.norm(column, axis=-1, keepdims=True)


def _motion(points: np.ndarray) -> np.ndarray:
    angle, along = np.moveaxis(points, -1, 0)
    zero, one = np.zeros_like(angle), np.ones_like(angle)
    c, s = np.cos(angle), np.sin(angle)
    rows = ((c, -s, along * np.cos(angle / 2)), (s, c, along * np.sin(angle / 2)), (zero, zero, one))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _angles(W: np.ndarray) -> np.ndarray:
    angle = np.arctan2(W[..., 1, 0], W[..., 0, 0])
    along = W[..., 0, 2] * np.cos(angle / 2) + W[..., 1, 2] * np.sin(angle / 2)
    return np.stack([angle, along], axis=-1)
