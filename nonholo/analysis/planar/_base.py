"""Half-planes of a body with two admissible directions, and arcs of its level curves."""

import dataclasses
from typing import NamedTuple

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


@dataclasses.dataclass(frozen=True, eq=False)
class PlanarBody:
    """The parts of `Disc` and `Strip`.

    Attributes:
        form: The body.
        frame: The axes of the form as seen from the user's frame.
        to_rows: Takes momenta along the user's rows to momenta along those of the form.
    """

    form: NormalForm
    frame: Float[np.ndarray, "3 3"]
    to_rows: Float[np.ndarray, "2 2"]


FOLD, EQUATOR = "fold", "equator"


class Arc(NamedTuple):
    """One solution over an interval.

    Attributes:
        sign: Which of the two solutions, -1 or 1.
        start: First direction.
        stop: Last direction.
        ends: The kinds of the two, FOLD or EQUATOR; empty for an arc that closes on itself.
    """

    sign: int
    start: float
    stop: float
    ends: tuple[str, ...] = ()

    def directions(self, count: int) -> Float[np.ndarray, "K"]:
        """Return directions, denser at the ends, where an arc has the shape of a square root."""
        if not self.ends:
            return np.linspace(self.start, self.stop, count)
        middle, half = (self.start + self.stop) / 2, (self.stop - self.start) / 2
        return np.clip(middle - half * np.cos(np.linspace(0.0, np.pi, count)), self.start, self.stop)
