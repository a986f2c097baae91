r"""Displacements of tops: membership in $\exp\mathfrak{d}$, constraints as traces, the Lagrangian in Euler angles.

The variety of a general system, with its charts, belongs to the discrete map.
"""

from typing import Any

import numpy as np

from nonholo.base.checks import positive, shape_of, trailing
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
    W = R.mT @ R_next
    i, j = np.triu_indices(W.shape[-1] - 1, 1)
    return W[..., j, i] - W[..., i, j]


def in_exp_d(displacement: Float[np.ndarray, "... n n"], tolerance: float = 1e-9) -> Bool[Array, "..."]:
    r"""Return whether a rotation is a displacement $\exp(\theta\,u\wedge e_n)$ of the Suslov top, in canonical axes.

    With $I_e = \mathrm{diag}(1, \dots, 1, -1)$: $I_eW$ is symmetric, that is an orthogonal reflection, and

    $$ \mathrm{tr}(I_eW) = n - 2. $$

    The trace picks the component of the identity: without it the reflections in spaces of other odd codimension pass,
    for n = 3 the half-turn diag(-1, -1, 1) about the forbidden axis.

    Reference: [fedorov-zenkov-2004], section 4, completed by the condition on the trace.

    Args:
        displacement: W.
        tolerance: Largest entry of a defect that is forgiven.

    Raises:
        ValueError: Not a square matrix, or a stack of such; one matrix that is not finite.

    Example:
        >>> in_exp_d(nh.SO(3).exp([0.3, -0.2, 0.0])), in_exp_d(np.diag([-1.0, -1.0, 1.0]))
        (np.True_, np.False_)
    """
    where = "in_exp_d(displacement=...)"
    n = max((2, *shape_of(displacement)[-1:]))
    W = trailing(where, displacement, (n, n), "Pass W of SO(n).", real=True)
    tolerance = positive("in_exp_d(tolerance=...)", tolerance, "Pass a positive error.")
    reflection = np.append(np.ones(n - 1), -1.0)[:, None] * W
    asymmetry = np.abs(reflection - reflection.mT).max(axis=(-2, -1))
    defect = np.abs(reflection @ reflection.mT - np.eye(n)).max(axis=(-2, -1))
    trace = np.abs(np.trace(reflection, axis1=-2, axis2=-1) - (n - 2))
    return (asymmetry <= tolerance) & (defect <= tolerance) & (trace <= n * tolerance)


def euler_angle_discrete_lagrangian(principal_moments: Any, angles: Any, angles_next: Any) -> Float[Array, "..."]:
    r"""Return $\mathrm{tr}\,J - \mathrm{tr}(R_k^TR_{k+1}J)$ of two rotations given by z-x-z Euler angles.

    With $R = R_z(\varphi)R_x(\theta)R_z(\psi)$, $\Delta\varphi = \varphi' - \varphi$, $\Delta\psi = \psi' - \psi$,
    $\Sigma = \psi + \psi'$ and principal moments $A_1 = J_2 + J_3$, ...

    $$ L_d = \tfrac12(A_1 + A_2 + A_3) - \tfrac12\bigl(A_1 f(\Sigma) + A_2 f(\Sigma + \pi) + A_3 f_3\bigr), $$

    $$ f(\Sigma) = \cos\theta\cos\theta'(1 + \cos\Delta\varphi\cos\Sigma) + \sin\theta\sin\theta'(\cos\Sigma +
       \cos\Delta\varphi) - \cos\Delta\varphi\cos\Sigma + (\cos\theta' - \cos\theta)\sin\Delta\varphi\sin\Sigma, $$

    $$ f_3 = (1 + \cos\theta\cos\theta')\cos\Delta\varphi\cos\Delta\psi - \cos\theta\cos\theta' +
       \sin\theta\sin\theta'(\cos\Delta\psi - \cos\Delta\varphi) -
       (\cos\theta + \cos\theta')\sin\Delta\varphi\sin\Delta\psi. $$

    For a time step h the discrete Lagrangian of the library is this, divided by h.

    Reference: [fedorov-zenkov-2004], section 4, the remark on Euler angles; the terms of $A_1$ and $A_2$ are corrected.

    Args:
        principal_moments: $A_1, A_2, A_3$, the diagonal of the inertia tensor.
        angles: $(\varphi, \theta, \psi)$ of $R_k$: precession, nutation, spin.
        angles_next: The same of $R_{k+1}$.

    Example:
        >>> euler_angle_discrete_lagrangian((5.0, 4.0, 3.0), (0.0, 0.4, 0.0), (0.0, 1.4, 0.0))  # 5 (1 - cos 1)
        np.float64(2.298...)
    """
    where, remedy = "euler_angle_discrete_lagrangian({}=...)", "Pass three numbers, or an array of triples."
    moments = trailing(where.format("principal_moments"), principal_moments, (3,), remedy, real=True)
    first = trailing(where.format("angles"), angles, (3,), remedy, real=True)
    second = trailing(where.format("angles_next"), angles_next, (3,), remedy, real=True)
    xp = (first * second).__array_namespace__()
    turn, spin, total = (second - first)[..., 0], (second - first)[..., 2], (first + second)[..., 2]
    c, c_next, s = xp.cos(first[..., 1]), xp.cos(second[..., 1]), xp.sin(first[..., 1]) * xp.sin(second[..., 1])
    cos, sin = xp.cos(turn), xp.sin(turn)

    def across(along: Array, beside: Array) -> Array:
        tilt = c * c_next * (1 + cos * along) + s * (along + cos)
        return tilt - cos * along + (c_next - c) * sin * beside

    axial = (1 + c * c_next) * cos * xp.cos(spin) - c * c_next + s * (xp.cos(spin) - cos)
    axial = axial - (c + c_next) * sin * xp.sin(spin)
    cosine, sine = xp.cos(total), xp.sin(total)
    terms = xp.stack([across(cosine, sine), across(-cosine, -sine), axial], axis=-1)
    return (moments * (1 - terms)).sum(axis=-1) / 2
