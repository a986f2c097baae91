r"""Bodies with two admissible directions on paper: their displacements on a disc or a strip, and their momenta.

One interface of two classes: discs of tops, whose opposite rim points are one, the projective plane; strips of
$(\Delta, \nu)$ of sleighs, whose edges are one upside down, a Moebius band. Points are those of
`nonholo.analysis.planar`. Coordinates of the plane of momenta are those of the normal form of tops and sleighs, of
others those of the canonical frame. The drawing on that plane is not decided here.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple, TypeAlias, cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, FancyArrowPatch

from nonholo.analysis import InvariantCurve, MomentumLocus
from nonholo.analysis.planar import Disc, Strip, planar_variety
from nonholo.base.types import Float
from nonholo.groups import SE
from nonholo.orbit import Orbit
from nonholo.plot import theme
from nonholo.plot.parts import forbidden_axis
from nonholo.systems import AbstractSystem

_ROUNDING = 1e-14
LEVELS = 9  # curves of one energy, where none are asked for


def without_rounding(values: Float[np.ndarray, "K"], size: float) -> Float[np.ndarray, "K"]:
    """Return numbers to be read: those that are rounding beside a size are zero."""
    return np.where(np.abs(values) > _ROUNDING * size, values, 0.0)


def runs(inside: np.ndarray) -> list[slice]:
    """Return the stretches of more than one point on which a condition holds."""
    ends = np.flatnonzero(np.diff(np.concatenate([[0], inside.astype(int), [0]]))).reshape(-1, 2)
    return [slice(first, last) for first, last in ends if last - first > 1]


class DiscSheet(NamedTuple):
    """The disc of a top: the radius is the step angle in half-turns, the direction that of the turn.

    Attributes:
        variety: The displacements.
        momentum_labels: Names of the axes of the plane of momenta.
        locus_labels: Names of the axes of a momentum locus in space.
        component_names: Names of the components of a body momentum.
        signs: The map from momenta along the rows of the normal form to the plane of momenta.
        has_deltoid: Whether three values are real over a region of the plane of momenta.
    """

    variety: Disc
    momentum_labels = (r"$M_{13}$, along $e_1\wedge e_3$", r"$M_{23}$, along $e_2\wedge e_3$")
    locus_labels = ("$P_1$", "$P_2$", "$P_3$")
    component_names = ("P_1", "P_2", "P_3")
    signs = np.array([1.0, 1.0])
    has_deltoid = False

    @property
    def inertia(self) -> Float[np.ndarray, "2 2"]:
        """B."""
        return self.variety.inertia

    def facts(self, system: AbstractSystem) -> str:
        """Return the forbidden axis."""
        axis = ", ".join(f"{number:.3g}" for number in without_rounding(cast(np.ndarray, forbidden_axis(system)), 1.0))
        return rf"SO(3),  $\langle\gamma,\omega\rangle = 0$  with  $\gamma$ = ({axis})"

    def places(self, points: Float[np.ndarray, "K 3"]) -> Float[np.ndarray, "K 2"]:
        """Return the places, each point turned to the upper half of the sphere."""
        return _laid(np.where(points[:, :1] >= 0, 1.0, -1.0) * points)

    def pieces(self, points: Float[np.ndarray, "K 3"]) -> list[Float[np.ndarray, "L 2"]]:
        """Return the runs of a curve on the sphere, each turned to the upper half and laid on the disc."""
        return [_laid(half[run]) for half in (points, -points) for run in runs(half[:, 0] >= 0)]

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


_TALLEST = 4.0  # height of the strip in translations without turning


class StripSheet(NamedTuple):
    """The strip of a sleigh, and where its blade is.

    All points of the line across the blade move along it; the contact point is the one nearest to the origin of body
    coordinates. The axes at the contact point are `variety.blade`, the first along the blade.
    """

    variety: Strip
    momentum_labels = (r"angular momentum  $\pi = p_\theta + b\,p_1$", r"momentum along the blade  $p_1$")
    locus_labels = ("$p_1$, along the blade", "$p_2$, across", r"$p_\theta + bp_1 - ap_2$")
    component_names = ("p_\\theta", "p_1", "p_2")
    signs = np.array([-1.0, 1.0])  # the plane e_1^e_2 of the normal form turns against the angle

    @property
    def inertia(self) -> Float[np.ndarray, "2 2"]:
        r"""$\mathrm{diag}(J + ma^2, m)$."""
        return np.diag([self.variety.inertia + self.variety.mass * self.variety.arm**2, self.variety.mass])

    @property
    def center(self) -> Float[np.ndarray, "2"]:
        """The center of mass (a, b) in the axes of the blade."""
        return np.array([self.variety.arm, -self.variety.across])

    def blades(self, orbit: Orbit) -> Float[np.ndarray, "K 3 3"]:
        """Return the axes of the blade in the plane."""
        return orbit.configuration @ self.variety.blade

    def contact(self, orbit: Orbit) -> Float[np.ndarray, "K 2"]:
        """Return the contact points in the plane."""
        return self.blades(orbit)[:, :2, 2]

    def heading(self, orbit: Orbit) -> Float[np.ndarray, "K"]:
        """Return the angle of the blade in the plane, full turns counted."""
        return orbit.heading + np.arctan2(self.variety.blade[1, 0], self.variety.blade[0, 0])

    def speed(self, orbit: Orbit) -> Float[np.ndarray, "K"]:
        """Return the velocity of the contact point along the blade."""
        return orbit.body_velocity @ SE(2).adjoint(SE(2).inverse(self.variety.blade))[1]

    @property
    def has_deltoid(self) -> bool:
        """Whether the center of mass lies before or behind the contact point."""
        return self.variety.arm != 0

    def facts(self, system: AbstractSystem) -> str:
        """Return m, J, a and b."""
        lengths = [np.sqrt(self.variety.inertia / self.variety.mass), *np.abs(self.variety.frame[:2, 2])]
        a, b = without_rounding(self.center, max(lengths))
        symbols = {"m": self.variety.mass, "J": self.variety.inertia, "a": a, "b": b}
        return ",  ".join(f"${symbol}$ = {value:.4g}" for symbol, value in symbols.items())

    def places(self, points: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K 2"]:
        """Return angles and translations."""
        return points

    def pieces(self, points: Float[np.ndarray, "K 2"]) -> Iterator[Float[np.ndarray, "L 2"]]:
        """Yield the runs of a curve between the angles -pi and pi, turned over after each full turn."""
        for number in np.unique(np.floor((points[:, 0] + np.pi) / (2 * np.pi)).astype(int)):
            shift, flip = 2 * np.pi * number, (-1) ** int(number)
            inside = (points[:, 0] >= shift - np.pi) & (points[:, 0] <= shift + np.pi)
            yield from ((points[run] - [shift, 0.0]) * [1.0, flip] for run in runs(inside))

    def step_angles(self, points: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K"]:
        r"""Return $\Delta$."""
        return points[:, 0]

    def energies(self, time_step: float) -> Float[np.ndarray, "L"]:
        """Return energies in units of that of a quarter-turn on the spot."""
        return self.inertia[0, 0] / time_step**2 * (np.arange(1, LEVELS + 1) / 5) ** 2

    def attracting(self, curves: list[InvariantCurve]) -> tuple[Float[np.ndarray, "E 2"], Float[np.ndarray, "2"]]:
        """Return the translations in the direction of the center of mass."""
        side = np.sign(self.variety.arm)
        points = [p[np.sign(p[:, 1]) == side] for p in (curve.over(0.0) for curve in curves)]
        reach = max((abs(p).max() for p in points), default=1.0) * 1.06 * np.array([0.0, side])
        return np.concatenate([np.empty((0, 2)), *points]), reach

    def inwards(self, places: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K 2"]:
        """Return signs that turn to the middle near the edges."""
        return np.where(np.abs(places[:, :1]) > np.pi / 2, [-1.0, 1.0], [1.0, 1.0])

    def dress(self, axes: Axes, curves: list[InvariantCurve], places: Float[np.ndarray, "K 2"]) -> None:
        """Draw the edges, and reach beyond the curves to places that moved farther."""
        axes.autoscale_view()
        low, high = axes.get_ylim()
        middle = max((float(np.abs(curve.over(0.0)[:, 1]).max()) for curve in curves), default=1.0)
        reach = min(max(-low, high), _TALLEST * middle)  # levels of a balanced sleigh go to infinity
        axes.set_xlim(-np.pi, np.pi)
        axes.set_xticks(np.pi * np.linspace(-1, 1, 5), [r"$-\pi$", r"$-\pi/2$", "0", r"$\pi/2$", r"$\pi$"])
        look = {"arrowstyle": "-|>", "mutation_scale": 22, "shrinkA": 0, "shrinkB": 0, "linewidth": 2.0}
        for side in (-np.pi, np.pi):  # arrows on the edges, in opposite directions
            ends = ((side, -0.1 * np.sign(side) * reach), (side, 0.1 * np.sign(side) * reach))
            axes.add_patch(FancyArrowPatch(*ends, color=theme.INK, clip_on=False, zorder=7, **look))
        reach = max(reach, 0.0 if axes.get_autoscaley_on() else high, 1.1 * np.abs(places[:, 1]).max(initial=0.0))
        axes.spines["right"].set_visible(True)
        axes.set(xlabel=r"step angle $\Delta$", ylabel=r"translation along the chord  $\nu$", ylim=(-reach, reach))
        theme.legend_above(axes)

    def locus_map(self) -> Float[np.ndarray, "3 3"]:
        """Return what takes rows of momenta to p_1, p_2 in the axes of the blade, and that about the center of mass."""
        at_center = np.eye(3)
        at_center[0, 2] = self.variety.arm
        return SE(2).coadjoint(self.variety.frame @ at_center, np.eye(3))[:, [1, 2, 0]]

    def locus_kind(self, locus: MomentumLocus) -> str:
        """Return what the surface is called."""
        return "Plücker's conoid"


Sheet: TypeAlias = DiscSheet | StripSheet
"""The displacements of a body on paper, and the words for its momenta; both kinds answer the same questions."""


def draw_level(axes: Axes, sheet: Sheet, curve: InvariantCurve, **look: Any) -> LineCollection:
    """Draw all components of a curve of one energy, cut where they leave the sheet."""
    lines = LineCollection([piece for points in curve.components for piece in sheet.pieces(points)], **look)
    axes.add_collection(lines)
    return lines


def sheet_of(system: AbstractSystem) -> Sheet | None:
    """Return the sheet of a top in space or a sleigh in the plane, of any class; None for other systems."""
    variety: Any = planar_variety(system)
    return None if variety is None else (DiscSheet if variety.blade is None else StripSheet)(variety)


def strip_of(system: AbstractSystem) -> StripSheet | None:
    """Return the sheet of a sleigh in the plane, under any forces; None for other systems."""
    sheet = sheet_of(system.inside)
    return sheet if isinstance(sheet, StripSheet) else None


def on_plane(system: AbstractSystem, restricted: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
    """Return momenta along the rows of the constraint subspace in the coordinates of the plane."""
    return _to_plane(system, system.to_canonical(restricted))


def momenta_on_plane(orbit: Orbit) -> Float[np.ndarray, "K k"]:
    """Return the momenta of an orbit in the coordinates of the plane."""
    return _to_plane(orbit.system, orbit.reduced_momentum)


def _to_plane(system: AbstractSystem, canonical: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
    if (sheet := sheet_of(system)) is None:
        return canonical
    to_form = sheet.variety.form.frame_map  # None for tops and sleighs by name, whose map is exactly the identity
    return canonical @ (sheet.signs[:, None] * (np.eye(2) if to_form is None else to_form)).T


def plane_inertia(system: AbstractSystem) -> Float[np.ndarray, "2 2"]:
    """Return the inertia in the coordinates of the plane."""
    sheet = sheet_of(system)
    return np.asarray(system.canonical.constrained_inertia) if sheet is None else sheet.inertia


def half_axes(system: AbstractSystem) -> Float[np.ndarray, "2 2"]:
    """Return a matrix that maps the circle of radius s to the ellipse of energy s^2 / 2."""
    return np.linalg.cholesky(plane_inertia(system))


def ellipse(system: AbstractSystem, energy: float) -> Float[np.ndarray, "K 2"]:
    """Return the closed curve of one energy."""
    angle = np.linspace(0.0, 2 * np.pi, 361)
    circle = np.sqrt(2 * energy) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return circle @ half_axes(system).T


def name_axes(axes: Axes, system: AbstractSystem) -> None:
    """Name the axes; both of a top have one scale."""
    sheet, form = sheet_of(system), system.normal_form
    across, up = ("$r_1$", "$r_2$") if sheet is None else sheet.momentum_labels
    axes.set(xlabel=across, ylabel=up)
    axes.margins(0.06)
    if form is not None and not form.is_sleigh:
        axes.set_aspect("equal", adjustable="datalim")


_SHEET = "#9cc4dd"
_OPACITY = 0.42
_FLAT = 1e-9
_PAIRS = "abcd"  # names of pairs of opposite points of the rim that are one


def draw_surface(axes: Any, momentum: Float[np.ndarray, "R C 3"]) -> Any:
    """Draw a surface of momenta as a translucent mesh, lit from above.

    Args:
        axes: Axes in space.
        momentum: The rows and columns of the mesh.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> axes = plt.figure().add_subplot(projection="3d")
        >>> sphere = [[[np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)] for u in range(7)] for v in (-1, 0, 1)]
        >>> draw_surface(axes, np.array(sphere)).get_facecolor().shape
        (12, 4)
    """
    x, y, z = np.moveaxis(momentum, -1, 0)
    unit = momentum / spans(momentum)
    normal = np.cross(np.gradient(unit, axis=0), np.gradient(unit, axis=1))
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    light = np.abs(normal / np.where(length > 0, length, 1.0) @ (np.array([0.35, -0.45, 0.82])))
    shade = 0.55 + 0.45 * light[..., None]
    colors = np.concatenate([shade * to_rgb(_SHEET), np.full(shade.shape, _OPACITY)], axis=-1)
    rows, columns = x.shape
    look = {"rcount": rows, "ccount": columns, "linewidth": 0, "antialiased": False, "shade": False}
    return axes.plot_surface(x, y, z, facecolors=colors, **look)


def spans(momentum: Float[np.ndarray, "R C 3"]) -> Float[np.ndarray, "3"]:
    """Return the extent of each component; the largest of them where a surface is flat up to rounding."""
    span = np.ptp(momentum.reshape(-1, 3), axis=0)
    return np.where(span > _FLAT * span.max(), span, span.max())


def draw_rim(axes: Axes) -> None:
    """Draw the half-turns around a disc of displacements; points with the same letter are the same one.

    Args:
        axes: Axes whose unit circle is the rim.

    Example:
        >>> import matplotlib.pyplot as plt
        >>> axes = plt.figure().add_subplot()
        >>> draw_rim(axes)
        >>> [text.get_text() for text in axes.texts]
        ['a', 'a', 'b', 'b', 'c', 'c', 'd', 'd']
    """
    axes.add_patch(Circle((0, 0), 1.0, facecolor="none", edgecolor=theme.MUTED, linewidth=1.2, zorder=2))
    for index, letter in enumerate(_PAIRS):
        angle = np.pi * (index + 0.5) / len(_PAIRS)
        for sign in (1, -1):
            x, y = sign * np.cos(angle), sign * np.sin(angle)
            axes.plot(x, y, "o", color=theme.MUTED, markersize=4, zorder=4)
            axes.text(1.07 * x, 1.07 * y, letter, color=theme.INK, ha="center", va="center", style="italic")
