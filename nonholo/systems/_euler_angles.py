"""The discrete Lagrangian of the free top in Euler angles, as the paper prints it, corrected."""

from typing import Any

from nonholo.base.checks import trailing
from nonholo.base.types import Array, Float


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
        lifted = c * c_next * (1 + cos * along) + s * (along + cos)
        return lifted - cos * along + (c_next - c) * sin * beside

    axial = (1 + c * c_next) * cos * xp.cos(spin) - c * c_next + s * (xp.cos(spin) - cos)
    axial = axial - (c + c_next) * sin * xp.sin(spin)
    cosine, sine = xp.cos(total), xp.sin(total)
    terms = xp.stack([across(cosine, sine), across(-cosine, -sine), axial], axis=-1)
    return (moments * (1 - terms)).sum(axis=-1) / 2
