"""Drawings of a body with two admissible directions: one interface of discs (tops) and strips (sleighs).

Points are those of `nonholo.analysis.planar`.
"""

import abc
import dataclasses
from typing import Any, ClassVar

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from nonholo.analysis import InvariantCurve, MomentumLocus
from nonholo.analysis.planar import AbstractPlanarVariety
from nonholo.base.types import Float
from nonholo.plotting.sheets._blade import Blade
from nonholo.systems import AbstractSystem

_ROUNDING = 1e-14
LEVELS = 9  # curves of one energy, where none are asked for


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractSheet(abc.ABC):
    """The displacements of a body on paper, and the words for its momenta.

    Attributes:
        variety: The displacements.
        momentum_labels: Names of the axes of the plane of momenta.
        locus_labels: Names of the axes of a momentum locus in space.
        component_names: Names of the components of a body momentum.
        signs: The map from momenta along the rows of the normal form to the plane of momenta.
    """

    variety: AbstractPlanarVariety
    momentum_labels: ClassVar[tuple[str, str]]
    locus_labels: ClassVar[tuple[str, str, str]]
    component_names: ClassVar[tuple[str, str, str]]
    signs: ClassVar[Float[np.ndarray, "2"]]

    @property
    def to_plane(self) -> Float[np.ndarray, "2 2"]:
        """The map from canonical momenta to the plane of momenta; exactly the identity for tops and sleighs by name."""
        to_form = self.variety.form.frame_map
        return self.signs[:, None] * (np.eye(2) if to_form is None else to_form)

    @property
    @abc.abstractmethod
    def inertia(self) -> Float[np.ndarray, "2 2"]:
        """The inertia in the coordinates of the plane of momenta."""

    @property
    @abc.abstractmethod
    def blade(self) -> Blade | None:
        """The blade of a sleigh; None for a top."""

    @property
    @abc.abstractmethod
    def has_deltoid(self) -> bool:
        """Whether three values are real over a region of the plane of momenta."""

    @abc.abstractmethod
    def facts(self, system: AbstractSystem) -> str:
        """Return the parameters of the body in words."""

    @abc.abstractmethod
    def places(self, points: Float[np.ndarray, "K c"]) -> Float[np.ndarray, "K 2"]:
        """Return the places of displacements."""

    @abc.abstractmethod
    def pieces(self, points: Float[np.ndarray, "K c"]) -> list[Float[np.ndarray, "L 2"]]:
        """Return a curve cut where it leaves the sheet."""

    @abc.abstractmethod
    def step_angles(self, points: Float[np.ndarray, "K c"]) -> Float[np.ndarray, "K"]:
        """Return the step angles of displacements; of a top with the direction left out."""

    @abc.abstractmethod
    def energies(self, time_step: float) -> Float[np.ndarray, "L"]:
        """Return energies whose curves fill the sheet."""

    @abc.abstractmethod
    def attracting(self, curves: list[InvariantCurve]) -> tuple[Float[np.ndarray, "E 2"], Float[np.ndarray, "2"]]:
        """Return the attracting equilibria on curves, and the end of their line; of a body that is not balanced."""

    @abc.abstractmethod
    def inwards(self, places: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K ..."]:
        """Return signs that turn the direction of a label inwards where it would meet the rim or the legend."""

    @abc.abstractmethod
    def dress(self, axes: Axes, curves: list[InvariantCurve], places: Float[np.ndarray, "K 2"]) -> None:
        """Draw the rim or the edges, name the axes and place the legend; show places that are far away too."""

    @abc.abstractmethod
    def locus_map(self) -> Float[np.ndarray, "3 3"]:
        """Return what takes rows of body momenta to the components that are drawn in space."""

    @abc.abstractmethod
    def locus_kind(self, locus: MomentumLocus) -> str:
        """Return what the surface of momenta is called."""

    def draw_level(self, axes: Axes, curve: InvariantCurve, **look: Any) -> LineCollection:
        """Draw all components of a curve of one energy, cut where they leave the sheet."""
        lines = LineCollection([piece for points in curve.components for piece in self.pieces(points)], **look)
        axes.add_collection(lines)
        return lines


def without_rounding(values: Float[np.ndarray, "K"], size: float) -> Float[np.ndarray, "K"]:
    """Return numbers to be read: those that are rounding beside a size are zero."""
    return np.where(np.abs(values) > _ROUNDING * size, values, 0.0)


def runs(inside: np.ndarray) -> list[slice]:
    """Return the stretches of more than one point on which a condition holds."""
    ends = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]]))).reshape(-1, 2)
    return [slice(first, last) for first, last in ends if last - first > 1]
