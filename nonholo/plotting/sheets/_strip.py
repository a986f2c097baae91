r"""The displacements of a sleigh as the strip of $(\Delta, \nu)$ whose edges are one, upside down: a Moebius band."""

import functools

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch

from nonholo.analysis import InvariantCurve, MomentumLocus
from nonholo.analysis.planar import Strip
from nonholo.base.types import Float
from nonholo.groups import SE
from nonholo.plotting import theme
from nonholo.plotting.sheets._base import LEVELS, AbstractSheet, runs, without_rounding
from nonholo.plotting.sheets._blade import Blade, blade_of
from nonholo.systems import AbstractSystem

_TALLEST = 4.0  # height of the strip in translations without turning


class StripSheet(AbstractSheet):
    """The strip of a sleigh."""

    variety: Strip
    momentum_labels = (r"angular momentum  $\pi = p_\theta + b\,p_1$", r"momentum along the blade  $p_1$")
    locus_labels = ("$p_1$, along the blade", "$p_2$, across", r"$p_\theta + bp_1 - ap_2$")
    component_names = ("p_\\theta", "p_1", "p_2")
    signs = np.array([-1.0, 1.0])  # the plane e_1^e_2 of the normal form turns against the angle

    @property
    def inertia(self) -> Float[np.ndarray, "2 2"]:
        r"""$\mathrm{diag}(J + ma^2, m)$."""
        return np.diag([self._whole, self.variety.mass])

    @property
    def _whole(self) -> float:
        return self.variety.inertia + self.variety.mass * self.variety.arm**2

    @functools.cached_property
    def blade(self) -> Blade:
        """The blade."""
        return blade_of(self.variety)

    @property
    def has_deltoid(self) -> bool:
        """Whether the center of mass lies before or behind the contact point."""
        return self.variety.arm != 0

    def facts(self, system: AbstractSystem) -> str:
        """Return m, J, a and b."""
        del system
        lengths = [np.sqrt(self.variety.inertia / self.variety.mass), *np.abs(self.variety.frame[:2, 2])]
        a, b = without_rounding(self.blade.center, max(lengths))
        symbols = {"m": self.variety.mass, "J": self.variety.inertia, "a": a, "b": b}
        return ",  ".join(f"${symbol}$ = {value:.4g}" for symbol, value in symbols.items())

    def places(self, points: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K 2"]:
        """Return angles and translations."""
        return points

    def pieces(self, points: Float[np.ndarray, "K 2"]) -> list[Float[np.ndarray, "L 2"]]:
        """Return the runs of a curve between the angles -pi and pi, turned over after each full turn."""
        turn = np.floor((points[:, 0] + np.pi) / (2 * np.pi)).astype(int)
        cut = []
        for number in np.unique(turn):
            shift, flip = 2 * np.pi * number, (-1) ** int(number)
            inside = (points[:, 0] >= shift - np.pi) & (points[:, 0] <= shift + np.pi)
            cut += [(points[run] - [shift, 0.0]) * [1.0, flip] for run in runs(inside)]
        return cut

    def step_angles(self, points: Float[np.ndarray, "K 2"]) -> Float[np.ndarray, "K"]:
        r"""Return $\Delta$."""
        return points[:, 0]

    def energies(self, time_step: float) -> Float[np.ndarray, "L"]:
        """Return energies in units of that of a quarter-turn on the spot."""
        return self._whole / time_step**2 * (np.arange(1, LEVELS + 1) / 5) ** 2

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
        for side in (-1, 1):
            _draw_edge(axes, side, reach)
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
        del locus
        return "Plücker's conoid"


def _draw_edge(axes: Axes, side: int, reach: float) -> None:
    """Draw an arrow on an edge: the two point in opposite directions."""
    ends = ((side * np.pi, -0.1 * side * reach), (side * np.pi, 0.1 * side * reach))
    look = {"arrowstyle": "-|>", "mutation_scale": 22, "shrinkA": 0, "shrinkB": 0, "linewidth": 2.0}
    axes.add_patch(FancyArrowPatch(*ends, color=theme.INK, clip_on=False, zorder=7, **look))
