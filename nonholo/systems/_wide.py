"""Bodies of high dimension, whose full momenta and matrices are not made."""

import dataclasses

import numpy as np

from nonholo.base.checks import error
from nonholo.base.numerics import applied
from nonholo.base.types import Float

LARGEST = 100_000
"""Components of the longest full momentum that is made; a momentum of SO(n) has n (n - 1) / 2."""


def narrow(where: str, components: int) -> None:
    """Refuse to make what grows with the square of n, where n is large."""
    if components > LARGEST:
        remedy = "Use restricted_momentum, chart and energy, and reconstruct=False."
        raise error(where, f"have at most {LARGEST} components", f"{components}", remedy)


@dataclasses.dataclass(frozen=True, eq=False)
class WideInertia:
    r"""An inertia along the constraint that is known without its matrix: $w\cdot Dw + m(v + \alpha\cdot w)^2$.

    Attributes:
        turning: The diagonal of D.
        mass: m; None for a body that does not slide, which has no v.
        offset: $\alpha$.
    """

    turning: Float[np.ndarray, "k"]
    mass: Float[np.ndarray, ""] | np.floating | None
    offset: Float[np.ndarray, "k"]

    @property
    def rank(self) -> int:
        """The number of velocities."""
        return len(self.turning) + (self.mass is not None)

    @property
    def dense(self) -> Float[np.ndarray, "k k"]:
        """The matrix."""
        narrow("An inertia matrix", self.rank**2)
        return self.momenta(np.eye(self.rank))

    def momenta(self, velocity: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
        """Return the momenta of velocities."""
        if self.mass is None:
            return velocity * self.turning
        w, v = velocity[..., :-1], velocity[..., -1:]
        along = self.mass * (v + applied(self.offset[None], w))
        return np.concatenate([w * self.turning + along * self.offset, along], axis=-1)

    def velocities(self, momenta: Float[np.ndarray, "... k"]) -> Float[np.ndarray, "... k"]:
        """Return the velocities that have these momenta."""
        if self.mass is None:
            return momenta / self.turning
        along = momenta[..., -1:]
        w = (momenta[..., :-1] - along * self.offset) / self.turning
        return np.concatenate([w, along / self.mass - applied(self.offset[None], w)], axis=-1)
