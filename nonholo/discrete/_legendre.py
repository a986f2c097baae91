r"""The discrete Legendre transformation $W \mapsto P(W)$ and its right-handed companion $\mathrm{Ad}^*_W P(W)$.

For the matrix difference both are closed forms in $X = W - I$, free of cancellation, for the logarithmic one in log W;
for every other discrete Lagrangian they are derivatives taken by JAX (`_functions`).
"""

from nonholo.base.checks import needs
from nonholo.base.numerics import applied
from nonholo.base.types import Array, Float, Inexact
from nonholo.discrete._scheme import Scheme
from nonholo.groups import AbstractMatrixGroup


def legendre(discrete: Scheme, increment: Inexact[Array, "... N N"], side: str) -> Inexact[Array, "... dim"]:
    """Return the momenta of displacements given as W - I."""
    group = discrete.system.group
    if discrete.difference == "matrix":
        tensor = discrete.system.homogeneous_mass_tensor
        return matrix_legendre(group, tensor, increment, side) / discrete.time_step
    if isinstance(discrete.difference, str):
        return logarithmic_legendre(discrete, increment + group.identity, side)
    with needs("jax", "discretize(difference=...)"):
        from nonholo.discrete.definition import momenta_by_derivative

    return momenta_by_derivative(discrete.difference, group, increment + group.identity, side)


def logarithmic_legendre(discrete: Scheme, W: Float[Array, "... N N"], side: str) -> Float[Array, "... dim"]:
    r"""Return $(\mathrm{dexp}^{-1}_{\pm X})^*\,\mathbb{I}\,X/h$, $X = \log W$: plus on the left, minus on the right."""
    group = discrete.system.group
    x = group.log(W)
    xp = x.__array_namespace__()
    transport = group.dexp_inverse(x if side == "left" else -x)
    p = applied(xp.asarray(discrete.system.inertia_operator), x) / discrete.time_step
    return (p[..., None, :] @ transport)[..., 0, :]


def matrix_legendre(
    group: AbstractMatrixGroup, tensor: Inexact[Array, "N N"], X: Inexact[Array, "... N N"], side: str
) -> Inexact[Array, "... dim"]:
    r"""Return $\mathrm{tr}(E_i W\mathbb{J}X^*)$ (left) or $\mathrm{tr}(W E_i\mathbb{J}X^*)$ (right), $W = I + X$."""
    xp = X.__array_namespace__()
    arm = xp.asarray(tensor, dtype=X.dtype) @ group.form_adjoint(X)
    carried = arm + X @ arm if side == "left" else arm + arm @ X
    return group.coordinates.dual_vector(xp.swapaxes(carried, -1, -2))
