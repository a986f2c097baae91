r"""The displacements of the Suslov top: membership in $\exp\mathfrak{d}$, and the constraints as traces.

The variety of a general system, with its charts, belongs to the discrete map.
"""

import numpy as np

from nonholo.base.checks import error, positive, shape_of, trailing
from nonholo.base.types import Array, Bool, Float


def trace_constraints(
    configuration: Float[Array, "... n n"], configuration_next: Float[Array, "... n n"]
) -> Float[Array, "... s"]:
    r"""Return the constraints of the discrete Suslov top between two configurations; they vanish if it can step so.

    $$ \mathrm{tr}\bigl(R_{k+1}\,(e_i\wedge e_j)\,R_k^T\bigr) = W_{ji} - W_{ij}, \qquad 1 \le i < j \le n - 1, \qquad
       W = R_k^TR_{k+1}, $$

    in lexicographic order. They are necessary, not sufficient: see `in_exp_d`.

    Reference: [fedorov-zenkov-2004], section 4.

    Args:
        configuration: $R_k$.
        configuration_next: $R_{k+1}$.

    Raises:
        ValueError: Not two real square matrices, or stacks of such, of one size.

    Example:
        >>> trace_constraints(np.eye(3), nh.SO(3).exp([0.3, -0.2, 0.0]))
        array([0.])
    """
    n = (shape_of(configuration) or (0,))[-1]
    R = trailing("trace_constraints(configuration=...)", configuration, (n, n), "Pass a matrix of SO(n).", real=True)
    where, remedy = "trace_constraints(configuration_next=...)", "Pass a matrix of the same SO(n)."
    R_next = trailing(where, configuration_next, (n, n), remedy, real=True)
    W = R.__array_namespace__().swapaxes(R, -1, -2) @ R_next
    i, j = np.triu_indices(W.shape[-1] - 1, 1)
    return W[..., j, i] - W[..., i, j]


def in_exp_d(displacement: Float[np.ndarray, "... n n"], tolerance: float = 1e-9) -> Bool[Array, "..."]:
    r"""Tell whether a rotation is a displacement $\exp(\theta\,u\wedge e_n)$ of the Suslov top in its canonical frame.

    With $I_e = \mathrm{diag}(1, \dots, 1, -1)$: $I_eW$ is symmetric, that is an orthogonal reflection, and

    $$ \mathrm{tr}(I_eW) = n - 2. $$

    The trace picks the component of the identity: without it the reflections in spaces of other odd codimension pass,
    for n = 3 the half-turn diag(-1, -1, 1) about the forbidden axis.

    Reference: [fedorov-zenkov-2004], section 4, completed by the condition on the trace.

    Args:
        displacement: W.
        tolerance: Largest entry of a defect that is forgiven.

    Raises:
        ValueError: Not a square matrix, or a stack of such.

    Example:
        >>> in_exp_d(nh.SO(3).exp([0.3, -0.2, 0.0])), in_exp_d(np.diag([-1.0, -1.0, 1.0]))
        (np.True_, np.False_)
    """
    where = "in_exp_d(displacement=...)"
    W = trailing(where, displacement, (), "Pass W of SO(n).", real=True)
    n = W.shape[-1] if W.ndim >= 2 else 0
    if n < 2 or W.shape[-2] != n:
        raise error(where, "be a square matrix", f"shape {W.shape}", "Pass W of SO(n).")
    tolerance = positive("in_exp_d(tolerance=...)", tolerance, "Pass a positive error.")
    reflected = np.append(np.ones(n - 1), -1.0)[:, None] * W
    turned = np.swapaxes(reflected, -1, -2)
    asymmetry = np.abs(reflected - turned).max(axis=(-2, -1))
    defect = np.abs(reflected @ turned - np.eye(n)).max(axis=(-2, -1))
    trace = np.abs(np.trace(reflected, axis1=-2, axis2=-1) - (n - 2))
    return (asymmetry <= tolerance) & (defect <= tolerance) & (trace <= n * tolerance)
