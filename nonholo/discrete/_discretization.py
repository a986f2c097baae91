"""A discretisation: a system, a time step, a discrete Lagrangian and a displacement variety."""

import dataclasses
from collections.abc import Callable

import numpy as np

from nonholo._checks import choice, error, positive
from nonholo._types import Array, Float
from nonholo.discrete._legendre import legendre_of_chart
from nonholo.discrete._structured import next_charts
from nonholo.orbit import AbstractMotion
from nonholo.systems import AbstractLLSystem

Difference = str | Callable[[Array], Array]


@dataclasses.dataclass(frozen=True, eq=False)
class Discretization(AbstractMotion):
    """A discretised system, made by `discretize`.

    Attributes:
        system: What moves.
        time_step: h.
        difference: "matrix", "logarithmic" or a callable.
        constraint: "skew" or "exponential".
        order: 2.

    Example:
        >>> discretize(ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        Discretization(system=ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.0), time_step=np.float64(0.1),
            difference='matrix', constraint='skew', order=2)
    """

    system: AbstractLLSystem
    time_step: Array
    difference: Difference = "matrix"
    constraint: str = "skew"
    order: int = 2

    def full_momentum(
        self, reduced_momentum: Float[np.ndarray, "K k"], cayley: Float[np.ndarray, "K k"]
    ) -> Float[np.ndarray, "K dim"]:
        """Return the discrete momenta at the displacements."""
        del reduced_momentum
        return legendre_of_chart(self, cayley, "left")

    def multipliers(
        self, reduced_momentum: Float[np.ndarray, "K k"], cayley: Float[np.ndarray, "K k"], save_every: int
    ) -> Float[np.ndarray, "L s"]:
        r"""Return the impulses $\lambda$ in $P_{k+1} - \mathrm{Ad}^*_{W_k} P_k = \sum_j \lambda_j a^j$."""
        following = cayley[1:] if save_every == 1 else next_charts(self, reduced_momentum[:-1], cayley[:-1])
        jump = legendre_of_chart(self, following, "left") - legendre_of_chart(self, cayley[:-1], "right")
        return jump @ np.linalg.pinv(self.system.annihilator)


def discretize(
    system: AbstractLLSystem,
    time_step: Array,
    difference: Difference = "matrix",
    constraint: str = "skew",
    order: int = 2,
) -> Discretization:
    r"""Discretise a system: choose the discrete Lagrangian and the variety that displacements lie on.

    $$ l_d(W) = h\, l\bigl((W - I)/h\bigr) \ \text{(matrix)}, \qquad l_d(W) = h\, l(\log W/h)\ \text{(logarithmic)}, $$

    with $h$ the time step and, for matrices, $l(X) = \tfrac12\mathrm{tr}(X\,\mathbb{J}\,X^T)$. With "matrix" and "skew"
    the step conserves the reduced constrained energy exactly; with "logarithmic" or a callable it does not.

    Reference: [fedorov-zenkov-2004], section 3.

    Args:
        system: What moves.
        time_step: h > 0.
        difference: "matrix", "logarithmic" or a callable $L_d(W)$ of a JAX matrix that includes the factor h.
        constraint: "skew", (W - W^-1)/2 in d on the component through the identity, or "exponential", exp d; the same
            set for the systems of this version.
        order: 2.

    Raises:
        ValueError: A time step that is not positive and real, an unknown choice.

    Example:
        >>> discretize(ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5), time_step=0.1).difference
        'matrix'
    """
    if not isinstance(system, AbstractLLSystem):
        raise error("discretize(system=...)", "be a system", repr(system), "Pass a SuslovTop or a ChaplyginSleigh.")
    step = positive("discretize(time_step=...)", time_step, "Pass a positive real time step.")
    if not callable(difference):
        choice("discretize(difference=...)", difference, ("matrix", "logarithmic"), "Or pass a callable L_d(W).")
    choice("discretize(constraint=...)", constraint, ("skew", "exponential"))
    choice("discretize(order=...)", order, (2,))
    return Discretization(system, step, difference, constraint, order)
