r"""The quantity that only falls: along the flow, and along every branch of the discrete map, in any dimension.

Theory: docs/theory/limits.md. The limits that follow from it live in `_asymptotics`.
"""

import dataclasses

import numpy as np

from nonholo.base.checks import error, shape_of, trailing
from nonholo.base.types import Array, Float
from nonholo.systems import AbstractLLSystem, AbstractSystem, refuse_forces


@dataclasses.dataclass(frozen=True, eq=False)
class LyapunovFunction:
    r"""The linear function $L(p) = -\langle p, x\rangle$ with an attracting velocity $x$.

    Attributes:
        attracting: $x$, or zeros if every velocity stays constant.
        subspace: Rows of the constraint subspace, in which x lies.
    """

    attracting: Float[np.ndarray, "dim"]
    subspace: Float[np.ndarray, "k dim"]

    def __call__(self, momentum: Float[Array, "... dim"] | Float[Array, "... k"]) -> Float[Array, "..."]:
        """Return the value at momenta, or at their components along the rows of the constraint subspace."""
        (k, dim), where = self.subspace.shape, "LyapunovFunction(momentum=...)"
        size = k if shape_of(momentum)[-1:] == (k,) else dim
        p = trailing(where, momentum, (size,), f"Pass {dim} or {k} components.", real=True)
        return -p @ (self.attracting if size == dim else self.attracting @ np.linalg.pinv(self.subspace))


def lyapunov_function(system: AbstractLLSystem) -> LyapunovFunction:
    r"""Return the function of the momentum that falls along every motion that is not an equilibrium.

    $L = c\cdot r$ for a top, $L = -\mathrm{sgn}(a_1)\,p_1$ for a sleigh, $L = -c\cdot\pi$ for a sleigh with $a_1 = 0$.
    In one step of the discrete map, with momenta of that step and the angle $\theta$ of the displacement about $u$,

    $$ \Delta L = -\tfrac4h\sin^2\tfrac\theta2\,\bigl(|c|^2 - (c\cdot u)^2\bigr) \ \text{(top)}, \qquad
       \Delta L = -\tfrac{4m|a_1|}h\sin^2\tfrac\theta2 \ \text{(sleigh)}, $$

    on every branch and for every step size.

    Reference: [fedorov-zenkov-2004], sections 6 and 7, for n = 3 and SE(2).

    Args:
        system: A top, a sleigh, or a system all of whose velocities stay constant.

    Raises:
        ValueError: Another system.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
        >>> orbit = nh.simulate(nh.discretize(sleigh, 0.1), body_velocity=(1, -2, 0), steps=50)
        >>> bool(np.all(np.diff(lyapunov_function(sleigh)(orbit.momentum)) < 0))
        True
    """
    refuse_forces("lyapunov_function(system=...)", system)
    if not isinstance(system, AbstractSystem) or system.is_spatial:
        remedy = "Pass a SuslovTop, a sleigh, or another left-invariant system."
        raise error("lyapunov_function(system=...)", "have a left-invariant constraint", type(system).__name__, remedy)
    known = system.equilibria()
    if system.normal_form is None and len(known.subspace) < system.rank:
        remedy = "Of other systems no such function of the discrete map is known."
        raise error("lyapunov_function(system=...)", "be a top or a sleigh", type(system).__name__, remedy)
    attracting = known.attracting
    return LyapunovFunction(
        np.zeros(system.group.dim) if attracting is None else attracting, system.constraint_subspace
    )
