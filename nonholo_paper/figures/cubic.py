"""Figure cubic: the cubic surface of the discrete sleigh, for J = 1.5."""

import dataclasses
import functools
from typing import Any

import numpy as np
from jaxtyping import Float
from mpl_toolkits.mplot3d.art3d import Line3D, Poly3DCollection

import nonholo as nh
from nonholo.analysis import deltoid
from nonholo.plot import theme
from nonholo.plot.sheets import draw_surface
from nonholo_paper._claims import statement
from nonholo_paper._finding import Measured
from nonholo_paper.figures._figure import figure
from nonholo_paper.figures._space import along, space
from nonholo_paper.formulas import sleigh_discrete as formulas

BODY = (1.0, 1.5, 1.0, 0.0)  # m, J, a, b; only J matters for the surface
SLEIGH = nh.discretize(nh.ChaplyginSleigh(*BODY), 1.0)
_REACH = 4.0  # of p_theta and p_hat
_FLOOR = -2.6  # height of the projection


@dataclasses.dataclass(frozen=True)
class Surface:
    """The drawing of `picture`.

    Attributes:
        axes: The axes.
        mesh: The surface.
        tangents: The lines along which it touches the planes z = 1 and z = -1.
        folds: The curve on the surface where two of its sheets meet, and its projection, the discriminant curve.
    """

    axes: Any
    mesh: Poly3DCollection
    tangents: tuple[Line3D, ...]
    folds: tuple[Line3D, ...]


def points() -> Float[np.ndarray, "R C 3"]:
    """Return (p_theta, p_hat, z) of momenta of the library; each ruling is cut where it leaves the square."""
    angle, along = np.meshgrid(np.linspace(-np.pi, np.pi, 181), np.linspace(-1, 1, 61), indexing="ij")
    sine, cosine = np.sin(angle / 2), np.cos(angle / 2)
    start = BODY[1] * np.sin(angle)
    # the ruling over an angle is (start + s sine, s cosine); keep abs of both below the reach
    limits = np.stack(
        [(np.sign(side) * _REACH - start) / np.where(np.abs(sine) < 1e-9, 1e-9, sine) for side in (-1, 1)]
    )
    low = np.maximum(limits.min(axis=0), -_REACH / np.maximum(cosine, 1e-9))
    high = np.minimum(limits.max(axis=0), _REACH / np.maximum(cosine, 1e-9))
    return _lifted(angle, low + (high - low) * (along + 1) / 2)


def _lifted(angle: np.ndarray, ruling: np.ndarray) -> Float[np.ndarray, "... 3"]:
    """Return the points of displacements, from their momenta; `ruling` is p_hat / cos(angle/2)."""
    m, _, a, _ = BODY
    chord = ruling / (m * a) - 2 * a * np.cos(angle / 2)
    c, s, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    V1, V2 = chord * np.cos(angle / 2), chord * np.sin(angle / 2)
    W = np.stack([np.stack(row, axis=-1) for row in ((c, -s, V1), (s, c, V2), (zero, zero, one))], axis=-2)
    momentum = nh.discrete_legendre(SLEIGH, W)
    return np.stack([momentum[..., 0], a * momentum[..., 1] + 2 * m * a**2, s], axis=-1)


@functools.cache
@theme.in_style
def picture() -> Surface:
    """Draw it."""
    axes = space(
        r"The surface of displacements, $J = 1.5$",
        (r"$p_\theta$", r"$\hat p_1$", r"$z = \sin\Delta\theta$"),
        (27.0, -115.0),
    )
    mesh = draw_surface(axes, points())
    mesh.set_rasterized(True)
    tangents = tuple(
        axes.plot(*_touching(side).T, color=theme.INK, linewidth=1.6, zorder=4, dashes=(dash, 2))[0]
        for side, dash in ((1, 5), (-1, 2))
    )
    for line, side in zip(tangents, (1, -1), strict=True):
        line.set_label(f"$\\ell_{'-+'[side > 0]}$, touches $z = {side}$")
    flat, angle = _folds()
    lifted = np.column_stack([flat, np.sin(angle)])
    floor = np.column_stack([flat, np.full(len(flat), _FLOOR)])
    folds = (
        axes.plot(*lifted.T, color=theme.UNSTABLE, linewidth=2.0, zorder=5, label="two sheets meet")[0],
        axes.plot(*floor.T, color=theme.UNSTABLE, linewidth=1.2, zorder=0, dashes=(4, 2), label="discriminant curve")[
            0
        ],
    )
    axes.set(xlim=(-_REACH, _REACH), ylim=(-_REACH, _REACH), zlim=(_FLOOR, 1.1), zticks=(-1, 0, 1))
    axes.legend(loc="upper right")
    return Surface(axes, mesh, tangents, folds)


def _folds() -> tuple[Float[np.ndarray, "K 2"], Float[np.ndarray, "K"]]:
    """Return (p_theta, p_hat) where two displacements coincide, and their angle."""
    m, _, a, _ = BODY
    angle = np.linspace(-np.pi, np.pi, 601)
    around = deltoid(SLEIGH).touching(angle)
    return np.stack([around[:, 0], a * around[:, 1] + 2 * m * a**2], axis=1), angle


def _touching(side: int) -> Float[np.ndarray, "2 3"]:
    ends = np.array([-_REACH, _REACH - BODY[1]])
    return np.stack([side * (ends + BODY[1]), ends, np.full(2, float(side))], axis=1)


@statement
def surface() -> Measured:
    """Put the mesh and the drawn lines into the cubic and the discriminant; on the lines the cubic does not cross."""
    J, drawn = BODY[1], picture()
    mesh, folds, floor = (np.moveaxis(points(), -1, 0), *(along(line).T for line in drawn.folds))
    lines = [along(line).T for line in drawn.tangents]
    gaps = [np.abs(formulas.cubic_in_sine(J, *xyz)).max() / _REACH**3 for xyz in (mesh, folds, *lines)]
    gaps.append(np.abs(formulas.discriminant_curve(J, *floor[:2])).max() / _REACH**4)
    gaps += [np.abs(formulas.tangency(J, line[0], line[1], round(line[2, 0]))).max() for line in lines]
    gaps.append(max(0.0, np.abs(mesh[2]).max() - 1))
    return Measured(float(max(gaps)), note="11041 points of the mesh, 601 of the curve, two lines")


FIGURE = figure(lambda: picture().axes.figure, surface)
