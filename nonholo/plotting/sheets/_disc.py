"""The displacements of a top as a disc whose opposite rim points are one: the projective plane."""

from typing import cast

import numpy as np
from matplotlib.axes import Axes

from nonholo.analysis import InvariantCurve, MomentumLocus
from nonholo.analysis.planar import Disc
from nonholo.base.types import Float
from nonholo.plotting import theme
from nonholo.plotting.elements import draw_rim
from nonholo.plotting.parts import forbidden_axis
from nonholo.plotting.sheets._base import LEVELS, AbstractSheet, runs, without_rounding
from nonholo.systems import AbstractSystem


class DiscSheet(AbstractSheet):
    """The disc of a top: the radius is the step angle in half-turns, the direction that of the turn."""

    variety: Disc
    momentum_labels = (r"$M_{13}$, along $e_1\wedge e_3$", r"$M_{23}$, along $e_2\wedge e_3$")
    locus_labels = ("$P_1$", "$P_2$", "$P_3$")
    component_names = ("P_1", "P_2", "P_3")
    signs = np.array([1.0, 1.0])

    @property
    def inertia(self) -> Float[np.ndarray, "2 2"]:
        """B."""
        return self.variety.inertia

    @property
    def blade(self) -> None:
        """None."""

    @property
    def has_deltoid(self) -> bool:
        """False."""
        return False

    def facts(self, system: AbstractSystem) -> str:
        """Return the forbidden axis."""
        axis = ", ".join(f"{number:.3g}" for number in without_rounding(cast(np.ndarray, forbidden_axis(system)), 1.0))
        return rf"SO(3),  $\langle\gamma,\omega\rangle = 0$  with  $\gamma$ = ({axis})"

    def places(self, points: Float[np.ndarray, "K 3"]) -> Float[np.ndarray, "K 2"]:
        """Return the places, each point turned to the upper half of the sphere."""
        return _laid(np.where(points[:, :1] >= 0, 1.0, -1.0) * points)

    def pieces(self, points: Float[np.ndarray, "K 3"]) -> list[Float[np.ndarray, "L 2"]]:
        """Return the runs of a curve on the sphere, each turned to the upper half and laid on the disc."""
        turned = (1 * points, -1 * points)
        return [_laid(half[run]) for half in turned for run in runs(half[:, 0] >= 0)]

    def step_angles(self, points: Float[np.ndarray, "K 3"]) -> Float[np.ndarray, "K"]:
        """Return the angles, 0 to pi."""
        return 2 * np.arctan2(np.linalg.norm(points[:, 1:], axis=1), np.abs(points[:, 0]))

    def energies(self, time_step: float) -> Float[np.ndarray, "L"]:
        """Return energies up to the order of the largest there is."""
        largest = np.linalg.eigvalsh(self.inertia)[-1] / (2 * time_step**2)
        return largest * (np.arange(1, LEVELS + 1) / (LEVELS + 0.5))

    def attracting(self, curves: list[InvariantCurve]) -> tuple[Float[np.ndarray, "E 2"], Float[np.ndarray, "2"]]:
        """Return the points over -c."""
        reach = -self.variety.coupling / np.linalg.norm(self.variety.coupling)
        points = [_laid(curve.over(np.arctan2(reach[1], reach[0]))) for curve in curves]
        return np.concatenate([np.empty((0, 2)), *points]), reach

    def inwards(self, places: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K 1"]:
        """Return signs that turn to the middle near the rim."""
        return np.where(np.linalg.norm(places, axis=1, keepdims=True) > 0.6, -1.0, 1.0)

    def dress(self, axes: Axes, curves: list[InvariantCurve], places: Float[np.ndarray, "K 2"]) -> None:
        """Draw the rim; every place is within it."""
        del curves, places
        draw_rim(axes)
        axes.set(xlim=(-1.14, 1.14), ylim=(-1.14, 1.14), xticks=[], yticks=[], aspect="equal")
        axes.spines[:].set_visible(False)
        theme.legend(axes, loc="lower left", bbox_to_anchor=(0.9, 0.02))
        axes.set_xlabel("radius: step angle; equal letters: the same half-turn")

    def locus_map(self) -> Float[np.ndarray, "3 3"]:
        """Return the identity: the components are those of the body momentum."""
        return np.eye(3)

    def locus_kind(self, locus: MomentumLocus) -> str:
        """Return what the surface is called; a body of revolution without coupling has a disc."""
        return "Steiner's surface" if len(locus.double_lines) else "a flat disc"


def _laid(z: Float[np.ndarray, "K 3"]) -> Float[np.ndarray, "K 2"]:
    """Return the direction of the last two components, as long as the step angle in half-turns."""
    size = np.linalg.norm(z[:, 1:], axis=1, keepdims=True)
    angle = 2 * np.arctan2(size, z[:, :1]) / np.pi
    return z[:, 1:] * np.divide(angle, size, out=np.ones_like(size), where=size > 0)
