"""Orbits on a group: plain arrays at the saved states, and their labels."""

import dataclasses
from typing import ClassVar

from nonholo.lagrange_dalembert._orbit import AbstractCoordinateOrbit, Labels


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class GroupOrbit(AbstractCoordinateOrbit):
    r"""A motion of a `GroupLagrangeDAlembert` at K saved states.

    Attributes:
        time: Times of the saved states, shape (K,).
        configuration: $g_k$, shape (K, N, N).
        displacement: $W_k = g_k^{-1}g_{k+1}$ of single steps, shape (K, N, N); None for a flow.
        body_velocity: The body velocity; for a discrete orbit $\log(W_k)/h$, shape (K, dim).
        momentum: $P_k = P(W_k)$, for a flow $\partial l/\partial\omega$, shape (K, dim).
        multipliers: Impulses $\lambda$ in $P_{k+1} - \mathrm{Ad}^*_{W_k}P_k = \sum_j\lambda_j a^j(g_{k+1})$ of the
            steps from the saved states but the last, shape (K - 1, s); for a flow the forces at its times, (K, s).
        energy: $-\partial l_d/\partial h$ at $W_k$, for a flow $\omega\cdot\partial l/\partial\omega - l$, shape (K,).
        constraint_residual: Largest $|F_j(g_k, W_k)|$, for a flow $|a^j(g)\omega|$, shape (K,).
        outcome: How the run ended.

    Example:
        >>> from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
        >>> free = GroupLagrangeDAlembert(nh.SO(3), mass_tensor_lagrangian(nh.SO(3), np.diag([1.0, 2.0, 3.0])), None)
        >>> free.discretize(0.1).simulate(body_velocity=(1.0, 0.2, 0.0), steps=10)
        <GroupOrbit: 11 states of 3 x 3 matrices, time 0 to 1, successful>
    """

    _labels: ClassVar[Labels] = {
        "configuration": (("row", "column"), "pose"),
        "displacement": (("row", "column"), "displacement of a single step, seen from the body"),
        "body_velocity": (("component",), "body velocity; of a discrete orbit log(displacement) / time_step"),
        "momentum": (("component",), "body momentum at the start of the step; of a flow the Legendre transform"),
    }

    def _configurations(self) -> str:
        n = self.configuration.shape[-1]
        return f"{n} x {n} matrices"
