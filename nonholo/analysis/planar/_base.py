"""The surface of displacements of a body with two admissible directions: one interface of discs and strips."""

import abc
import dataclasses
from typing import NamedTuple, Protocol

import numpy as np

from nonholo.base.types import Array, Float
from nonholo.systems import NormalForm


class HalfPlanes(NamedTuple):
    r"""Numbers whose signs tell half-planes; they are zero for every motion of a balanced body.

    Attributes:
        side: Positive in $\Delta_+$, negative in $\Delta_-$, zero on the line of equilibria.
        forward: Positive in $\Theta_+$, which contains the attracting equilibria, negative in $\Theta_-$.
    """

    side: Float[Array, "..."]
    forward: Float[Array, "..."]


class Level(Protocol):
    """The displacements of one energy."""

    def over(self, direction: float) -> Float[np.ndarray, "m c"]:
        """Return the points over a direction of the plane."""
        ...

    def components(self, count: int) -> tuple[Float[np.ndarray, "K c"], ...]:
        """Return the connected curves, with this many points for each arc."""
        ...


class Surface(Protocol):
    """The algebra of the momentum locus, in momenta of the user's frame."""

    def implicit(self, momentum: Float[np.ndarray, "... 3"]) -> Float[np.ndarray, "..."]:
        """Return the polynomial that vanishes on the surface."""
        ...

    def double_lines(self) -> Float[np.ndarray, "L 2 3"]:
        """Return the ends of the segments along which the surface meets itself."""
        ...

    def triple_point(self) -> Float[np.ndarray, "3"] | None:
        """Return where three such segments meet."""
        ...


@dataclasses.dataclass(frozen=True, eq=False)
class AbstractPlanarVariety(abc.ABC):
    """Displacements of a planar body by coordinates that cover all of them, the angle pi included.

    Attributes:
        form: The body.
        frame: The axes of the form as seen from the user's frame.
        to_rows: Takes momenta along the user's rows to momenta along those of the form.
    """

    form: NormalForm
    frame: Float[np.ndarray, "3 3"]
    to_rows: Float[np.ndarray, "2 2"]

    @abc.abstractmethod
    def displacement(self, points: Float[np.ndarray, "... c"]) -> Float[np.ndarray, "... 3 3"]:
        """Return the displacements, in the user's frame, with these coordinates."""

    @abc.abstractmethod
    def points(self, displacement: Float[np.ndarray, "... 3 3"]) -> Float[np.ndarray, "... c"]:
        """Return the coordinates of displacements on the variety."""

    @abc.abstractmethod
    def mesh(self, rows: int) -> tuple[Float[np.ndarray, "R C 2"], Float[np.ndarray, "R C c"]]:
        """Return parameters of a mesh, step angles first, and its points."""

    @abc.abstractmethod
    def area_factor(self, points: Float[np.ndarray, "... c"]) -> tuple[Float[Array, "..."], Float[Array, "..."]]:
        """Return the even and the odd part, under inversion, of the area factor of W -> hr. Folds are its zeros."""

    @abc.abstractmethod
    def sides(self, points: Float[np.ndarray, "... c"]) -> tuple[HalfPlanes, Float[Array, "..."]]:
        r"""Return the half-planes of displacements, and a weight $\Lambda$.

        The side of the momentum is $s\,(\Lambda + Q)$ before the step and $s\,(\Lambda - Q)$ after it, times 2 for a
        top.
        """

    @abc.abstractmethod
    def sides_of_momenta(self, restricted: Float[np.ndarray, "... 2"]) -> HalfPlanes:
        """Return the half-planes of momenta along the user's rows."""

    @abc.abstractmethod
    def level(self, energy: float) -> Level:
        """Return the level of an energy times the square of the time step."""

    @abc.abstractmethod
    def surface(self, time_step: float) -> Surface:
        """Return the momentum locus."""
