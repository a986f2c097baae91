r"""Where motions take place: $\mathbb{R}^n$, whose places are vectors, and groups of matrices.

$\mathbb{R}^n$ is the group of translations: a step adds h v, where one on a group multiplies by $W = e^{hv}$. All other
equations are the same. A place x is the configuration q, of a driven system (q, t): time is one more coordinate,
whose rate is one; on a group one more row of the matrix, in all of its entries.
"""

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import array, error, is_traced
from nonholo.base.types import Array
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import in_group

Pair = tuple[Array, Array]


class Coordinates(NamedTuple):
    """Places with coordinates; what leads from one to another is described by v, so that no digits of q' - q are lost.

    Attributes:
        dimension: n.
        is_driven: Whether places have the time.
    """

    dimension: int
    is_driven: bool
    at_rest = "for q_next = q"

    def step(self, v: Array, _h: Any) -> Array:
        """Return what stands for a displacement in L_d."""
        return v

    def displacement(self, v: Array, h: Any) -> Array:
        """Return q' - q."""
        return h * v

    def ends(self, x: Array, v: Array, h: Any) -> Pair:
        """Return what discrete functions take: q and q'."""
        q = x[: self.dimension]
        return q, q + h * v

    def step_of(self, displacement: Array, h: Any) -> Array:
        """Return what stands for a displacement."""
        return displacement / h

    def momenta(self, _x: Array, _v: Array, h: Any, along_x: Array, along_v: Array) -> Pair:
        """Return $-D_1L_d$ and $D_2L_d$ of slopes of L_d: at fixed q the end moves by h times the change of v."""
        arriving = along_v / h
        return arriving - along_x[: self.dimension], arriving

    def force(self, _v: Array, _p: Array, _x: Array, along_x: Array) -> Array:
        """Return the force of a Lagrangian with this slope."""
        return along_x[: self.dimension]

    def ahead(self, x: Array, v: Array, h: Any) -> Array:
        """Return the place after a step."""
        return x + h * self.rate(x, v)

    def normalize(self, x: Array) -> Array:
        """Return the place as it is: rounding errors lead to another one."""
        return x

    def rate(self, _x: Array, v: Array) -> Array:
        """Return the rate of change of a place."""
        return jnp.append(v, 1.0) if self.is_driven else v

    def beside(self, x: Array, xi: Array) -> Array:
        """Return the place with the coordinates xi as seen from x."""
        return x + xi

    def frame(self, x: Array, _v: Array, _time: Any) -> Array:
        """Return from where places are seen after a time: it stays."""
        return x

    def departure(self, x: Array, after: Array) -> Array:
        """Return the coordinates of a place as seen from x."""
        return after - x

    def departure_rate(self, _v: Array, xi: Array, w: Array) -> Array:
        """Return the rate of the coordinates xi of a place that moves with the velocity w, from a frame with v."""
        return self.rate(xi, w)

    def configuration(self, where: str, value: Any) -> np.ndarray:
        """Return the checked configuration of a start."""
        remedy = f"Pass the {self.dimension} coordinates."
        if value is None:
            raise error(where, "be given for a system in coordinates", "none", remedy)
        return array(where, value, (self.dimension,), remedy)

    def velocity(self, where: str, displacement: Any, h: Any) -> np.ndarray:
        """Return the velocity of a checked displacement."""
        return array(where, displacement, (self.dimension,), "Pass q_1 - q_0.") / h


class Poses(NamedTuple):
    """Places on a group. Displacements $W = e^{hv}$ are described by v: no digits of log W are lost, nor angles of pi.

    Attributes:
        group: The group.
        is_driven: Whether places have the time.
    """

    group: AbstractMatrixGroup
    is_driven: bool = False
    at_rest = "at W = I"

    def pose(self, x: Array) -> Array:
        """Return the pose of a place."""
        return x[..., : self.group.size, :] if self.is_driven else x

    def _join(self, x: Array, g: Array, times: Any) -> Array:
        """Return the place with another pose, and times added to its own."""
        if not self.is_driven:
            return g
        return g.__array_namespace__().concatenate([g, x[..., self.group.size :, :] + times], axis=-2)

    def step(self, v: Array, h: Any) -> Array:
        """Return the displacement W."""
        return self.group.exp(h * v)

    displacement = step

    def ends(self, g: Array, W: Array, _h: Any) -> Pair:
        """Return what discrete functions take: g and W."""
        return self.pose(g), W

    def step_of(self, W: Array, _h: Any) -> Array:
        """Return what stands for a displacement: itself."""
        return W

    def momenta(self, g: Array, W: Array, _h: Any, along_g: Array, D: Array) -> Pair:
        r"""Return $P(W)$ and $P^+(W) = \mathrm{Ad}^*_W P(W)$, the first less the covector of the slope along g.

        With D the matrix of derivatives of l_d they are $\mathrm{tr}\,D^TE_iW$ and $\mathrm{tr}\,D^TWE_i$.
        """
        covector = self.group.coordinates.dual_vector
        return covector(D @ W.T) - covector(self.pose(g).T @ self.pose(along_g)), covector(W.T @ D)

    def force(self, w: Array, p: Array, g: Array, along_g: Array) -> Array:
        r"""Return $\mathrm{ad}^*_\omega p$, what turns the momentum of a free body, and the force of this slope."""
        return self.group.coad(w, p) + self.group.coordinates.dual_vector(self.pose(g).T @ self.pose(along_g))

    def ahead(self, g: Array, v: Array, h: Any) -> Array:
        """Return the pose after a step."""
        return self._join(g, self.pose(g) @ self.step(v, h), h)

    def normalize(self, g: Array) -> Array:
        """Return the element of the group next to a matrix in which rounding errors have gathered."""
        group = self.group
        return self._join(g, group.matrix_from_pose(group.normalize_pose(group.pose_from_matrix(self.pose(g)))), 0.0)

    def rate(self, g: Array, w: Array) -> Array:
        """Return the rate of change of a pose."""
        return self._join(jnp.zeros_like(g), self.pose(g) @ self.group.hat(w), 1.0)

    def beside(self, g: Array, xi: Array) -> Array:
        r"""Return the pose $g e^\xi$."""
        n = self.group.dim
        return self._join(g, self.pose(g) @ self.group.exp(xi[..., :n]), xi[..., n:, None])

    def frame(self, g: Array, v: Array, time: Any) -> Array:
        """Return from where poses are seen after a time: from a body that moves steadily."""
        return self._join(g, self.pose(g) @ self.step(v, time), 0.0)

    def departure(self, g: Array, after: Array) -> Array:
        r"""Return the $\xi$ of a pose $g e^\xi$."""
        later = (after - g)[..., self.group.size :, 0]
        xi = self.group.log(self.group.inverse(self.pose(g)) @ self.pose(after))
        return xi.__array_namespace__().concatenate([xi, later], axis=-1) if self.is_driven else xi

    def departure_rate(self, v: Array, xi: Array, w: Array) -> Array:
        r"""Return the rate of a small $\xi$ between poses that move with the body velocities v and w."""
        rate = w - v + self.group.bracket(xi[: len(v)], v)
        return jnp.append(rate, 1.0) if self.is_driven else rate

    def configuration(self, where: str, value: Any) -> np.ndarray:
        """Return the checked configuration of a start, the identity by default."""
        if value is None or is_traced(value):
            return self.group.identity if value is None else array(where, value, self.group.identity.shape)
        return in_group(where, self.group, value)

    def velocity(self, where: str, displacement: Any, h: Any) -> np.ndarray:
        """Return the velocity of a checked displacement."""
        return self.group.log(in_group(where, self.group, displacement)) / h
