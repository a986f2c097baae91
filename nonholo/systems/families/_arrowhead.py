r"""Tops and sleighs in very many dimensions, whose mass tensor is an arrowhead: a diagonal and one row and column.

Every mass tensor takes this form in the axes that diagonalize the constrained inertia, so nothing is lost; and nothing
of size n x n is ever made.
"""

import dataclasses
import functools
from typing import ClassVar

import numpy as np

from nonholo.base.checks import array, check_scale, error, scale
from nonholo.base.kept import kept
from nonholo.base.types import Array, Float
from nonholo.groups import SE, SO, AbstractMatrixGroup
from nonholo.systems._base import AbstractLLSystem
from nonholo.systems._mass import WideInertia, narrow
from nonholo.systems._normal_form import NormalForm
from nonholo.systems.families._sleighs import MultidimensionalSleigh
from nonholo.systems.families._tops import SuslovTop


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class ArrowheadTop(AbstractLLSystem):
    r"""The Suslov top on SO(n) with $J = \mathrm{diag}(d_1, \dots, d_n)$ plus c in the last row and column.

    The constrained inertia is $B = \mathrm{diag}(d_1 + d_n, \dots, d_{n-1} + d_n)$. `SuslovTop.arrowhead` makes it;
    `dense` gives the same top as a `SuslovTop`.

    Args:
        diagonal: d, n numbers, n >= 3.
        coupling: c, n - 1 numbers.

    Raises:
        ValueError: A wrong shape, a value that is not finite, an inertia along the constraint that is not positive.

    Example:
        >>> top = nh.SuslovTop.arrowhead(np.linspace(1, 2, 1000), np.full(999, 0.01))
        >>> orbit = nh.simulate(nh.discretize(top, 0.1), restricted_velocity=np.full(999, 0.03), steps=10,
        ...                     reconstruct=False)
        >>> orbit.restricted_momentum.shape, bool(np.ptp(orbit.energy) < 1e-14)
        ((11, 999), True)
    """

    diagonal: Array
    coupling: Array
    leaves: ClassVar[tuple[str, ...]] = ("diagonal", "coupling")
    structure: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        diagonal, coupling = _arrow("SuslovTop.arrowhead", self.diagonal, self.coupling)
        object.__setattr__(self, "diagonal", diagonal)
        object.__setattr__(self, "coupling", coupling)
        _refuse_negative("SuslovTop.arrowhead(diagonal=...)", self.inertia_along)

    def __repr__(self) -> str:
        return f"SuslovTop.arrowhead(n={len(self.diagonal)})"

    @property
    def dense(self) -> SuslovTop:
        """The same top with its mass tensor as a matrix."""
        return SuslovTop(self.homogeneous_mass_tensor)

    @kept
    def group(self) -> AbstractMatrixGroup:
        """The rotation group SO(n)."""
        return SO(len(self.diagonal))

    @kept
    def homogeneous_mass_tensor(self) -> Float[np.ndarray, "n n"]:
        """The mass tensor as a matrix."""
        narrow("A dense mass tensor of SuslovTop.arrowhead", self.group.dim)
        J = np.diag(self.diagonal)
        J[-1, :-1] = J[:-1, -1] = self.coupling
        return J

    @kept
    def inertia_along(self) -> WideInertia:
        """The diagonal of B."""
        return WideInertia(self.diagonal[:-1] + self.diagonal[-1], None, np.zeros_like(self.coupling))

    @kept
    def constraint_subspace(self) -> Float[np.ndarray, "k dim"]:
        r"""Rows $e_i\wedge e_n$."""
        return self.dense.constraint_subspace

    @functools.cached_property
    def normal_form(self) -> NormalForm:
        """The diagonal of B, and c."""
        return NormalForm(self.diagonal[:-1], self.diagonal[-1], self.coupling)


@dataclasses.dataclass(frozen=True, repr=False, eq=False)
class ArrowheadSleigh(AbstractLLSystem):
    r"""The sleigh on SE(n) with $J_C = \mathrm{diag}(d_1, \dots, d_n)$ plus c in the first row and column.

    `MultidimensionalSleigh.arrowhead` makes it; `dense` gives the same sleigh as a `MultidimensionalSleigh`.

    Args:
        mass: m.
        center_of_mass: a, n body coordinates.
        diagonal: d, n numbers, n >= 3.
        coupling: c, n - 1 numbers.

    Raises:
        ValueError: A wrong shape, a mass or an inertia that is not positive.

    Example:
        >>> center = np.linspace(0.5, 0.0, 1000)
        >>> nh.MultidimensionalSleigh.arrowhead(1.0, center, np.linspace(1, 2, 1000), np.full(999, 0.01)).rank
        1000
    """

    mass: Array
    center_of_mass: Array
    diagonal: Array
    coupling: Array
    leaves: ClassVar[tuple[str, ...]] = ("mass", "center_of_mass", "diagonal", "coupling")
    structure: ClassVar[tuple[str, ...]] = ()
    has_blade: ClassVar[bool] = True

    def __post_init__(self) -> None:
        owner = "MultidimensionalSleigh.arrowhead"
        mass = scale(f"{owner}(mass=...)", self.mass, "Pass the mass of the body.")
        diagonal, coupling = _arrow(owner, self.diagonal, self.coupling)
        where = f"{owner}(center_of_mass=...)"
        center = array(where, self.center_of_mass, diagonal.shape, "Pass n body coordinates.")
        for field, value in zip(dataclasses.fields(self), (mass, center, diagonal, coupling), strict=True):
            object.__setattr__(self, field.name, value)
        _refuse_negative(f"{owner}(diagonal=...)", self.inertia_along)

    def __repr__(self) -> str:
        return f"MultidimensionalSleigh.arrowhead(n={len(self.diagonal)}, mass={self.mass}, a={self.center_of_mass[0]})"

    @property
    def dense(self) -> MultidimensionalSleigh:
        """The same sleigh with its mass tensor as a matrix."""
        narrow("A dense mass tensor of MultidimensionalSleigh.arrowhead", self.group.dim)
        J = np.diag(self.diagonal)
        J[0, 1:] = J[1:, 0] = self.coupling
        return MultidimensionalSleigh(self.mass, self.center_of_mass, J)

    @kept
    def group(self) -> AbstractMatrixGroup:
        """The group of rigid motions SE(n)."""
        return SE(len(self.diagonal))

    @kept
    def homogeneous_mass_tensor(self) -> Float[np.ndarray, "N N"]:
        """The mass tensor about the reference point as a matrix."""
        return self.dense.homogeneous_mass_tensor

    @kept
    def inertia_along(self) -> WideInertia:
        r"""The diagonal of $B_1$, the mass, and the offset of the center of mass across the blade."""
        a = self.center_of_mass
        return WideInertia(self.diagonal[1:] + self.diagonal[0] + self.mass * a[0] ** 2, self.mass, a[1:])

    @kept
    def constraint_subspace(self) -> Float[np.ndarray, "n dim"]:
        r"""Rows $e_1\wedge e_j$, then the velocity along body axis 1."""
        return self.dense.constraint_subspace

    @functools.cached_property
    def normal_form(self) -> NormalForm:
        """The numbers of the equations of motion, c with the other sign."""
        d, a = self.diagonal, self.center_of_mass
        return NormalForm(d[1:], d[0], -self.coupling, self.mass, a[0], a[1:])


def _arrow(owner: str, diagonal: object, coupling: object) -> tuple[np.ndarray, np.ndarray]:
    where = f"{owner}(diagonal=...)"
    d = array(where, diagonal, (None,), "Pass the n entries of the diagonal.")
    if len(d) < 3:
        raise error(where, "have at least 3 entries", f"{len(d)}", "In the plane use `ChaplyginSleigh`.")
    check_scale(where, d)
    c = array(f"{owner}(coupling=...)", coupling, (len(d) - 1,), f"Pass the {len(d) - 1} entries beside the corner.")
    return d, c


def _refuse_negative(where: str, inertia: WideInertia) -> None:
    turning = inertia.turning
    if not turning.min() > 0:
        got = f"{turning.min():.3g} at entry {int(np.argmin(turning))}"
        raise error(where, "give a positive inertia along the constraint", got, "Pass the mass tensor of a body.")
