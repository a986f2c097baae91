r"""The quadratic terms of the reduced equations: what drives the momentum along a direction of the algebra.

On an LL system $\dot p_x = \langle\mathbb{I}\omega, [\omega, x]\rangle$ for the momentum along $x \in \mathfrak{d}$.
Where this form vanishes a momentum is conserved; where it vanishes for every x velocities are constant.
"""

import numpy as np

from nonholo.base.types import Float


def gyroscopic_form(
    inertia: Float[np.ndarray, "dim dim"], brackets: Float[np.ndarray, "k m dim"], rows: Float[np.ndarray, "k dim"]
) -> Float[np.ndarray, "k k m"]:
    r"""Return the forms $\langle\mathbb{I}\omega, [\omega, x_m]\rangle$ as symmetric matrices in the rows of $\omega$.

    Args:
        inertia: $\mathbb{I}$.
        brackets: $[d_b, x_m]$ for the rows $d_b$ and any directions $x_m$.
        rows: $d_a$.
    """
    form = np.einsum("ad,bmd->abm", rows @ inertia, brackets)
    return (form + form.transpose(1, 0, 2)) / 2
