r"""The discrete Legendre transformation $W \mapsto P(W)$ and its right-handed companion $\mathrm{Ad}^*_W P(W)$.

For the matrix difference both are closed forms in $X = W - I$, free of cancellation, for the logarithmic one in log W;
for every other discrete Lagrangian they are derivatives taken by JAX (`_definition`).
"""

from typing import TYPE_CHECKING

from nonholo._checks import array, choice, needs, shape_of
from nonholo._types import Array, Float, Inexact
from nonholo.groups import AbstractMatrixGroup

if TYPE_CHECKING:
    from nonholo.discrete._discretization import Discretization


def discrete_legendre(
    discrete: "Discretization", displacement: Float[Array, "... N N"], side: str = "left"
) -> Float[Array, "... dim"]:
    r"""Return the discrete body momentum of a displacement, in physical units.

    $$ \langle P(W), x\rangle = \tfrac{d}{d\varepsilon} l_d(e^{\varepsilon x} W)\big|_0 \ \text{(left)}, \qquad
       \langle P^+(W), x\rangle = \tfrac{d}{d\varepsilon} l_d(W e^{\varepsilon x})\big|_0 \ \text{(right)}, $$

    and $P^+(W) = \mathrm{Ad}^*_W P(W)$: the momentum that arrives at the next state before the constraint force.

    Reference: [fedorov-zenkov-2004], equation (disc.mom.dfn), whose second form has the wrong sign.

    Args:
        discrete: The discretised system.
        displacement: W, an element of the group; a leading axis of many is allowed.
        side: "left" or "right".

    Raises:
        ValueError: A wrong shape, a value that is not finite, an unknown side.

    Example:
        >>> sleigh = discretize(ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.0), time_step=0.5)
        >>> discrete_legendre(sleigh, SE(2).exp(np.array([0.0, 0.5, 0.0])))
        array([0., 1., 0.])
    """
    from nonholo.discrete._discretization import as_discretization

    group = as_discretization("discrete_legendre(discrete=...)", discrete).system.group
    where, shape = "discrete_legendre(displacement=...)", group.identity.shape
    leading = (None,) * (len(shape_of(displacement)) - 2)
    W = array(where, displacement, leading + shape, f"Pass an element of {group} as a matrix.")
    return legendre(discrete, W - group.identity, choice("discrete_legendre(side=...)", side, ("left", "right")))


def legendre(discrete: "Discretization", increment: Inexact[Array, "... N N"], side: str) -> Inexact[Array, "... dim"]:
    """Return the momenta of displacements given as W - I."""
    group = discrete.system.group
    if discrete.difference == "matrix":
        tensor = discrete.system.homogeneous_mass_tensor
        return matrix_legendre(group, tensor, increment, side) / discrete.time_step
    if discrete.difference == "logarithmic":
        return logarithmic_legendre(discrete, increment + group.identity, side)
    with needs("jax", "discretize(difference=...)"):
        from nonholo.discrete._definition import legendre_by_derivative

    return legendre_by_derivative(discrete, increment + group.identity, side)


def logarithmic_legendre(discrete: "Discretization", W: Float[Array, "... N N"], side: str) -> Float[Array, "... dim"]:
    r"""Return $(\mathrm{dexp}^{-1}_{\pm X})^*\,\mathbb{I}\,X/h$, $X = \log W$: plus on the left, minus on the right."""
    group = discrete.system.group
    x = group.log(W)
    xp = x.__array_namespace__()
    transport = group.dexp_inverse(x if side == "left" else -x)
    p = x @ xp.asarray(discrete.system.inertia_operator).T / discrete.time_step
    return (p[..., None, :] @ transport)[..., 0, :]


def matrix_legendre(
    group: AbstractMatrixGroup, tensor: Inexact[Array, "N N"], X: Inexact[Array, "... N N"], side: str
) -> Inexact[Array, "... dim"]:
    r"""Return $\mathrm{tr}(E_i W\mathbb{J}X^*)$ (left) or $\mathrm{tr}(W E_i\mathbb{J}X^*)$ (right), $W = I + X$."""
    xp = X.__array_namespace__()
    arm = xp.asarray(tensor, dtype=X.dtype) @ group.form_adjoint(X)
    carried = arm + X @ arm if side == "left" else arm + arm @ X
    return xp.einsum("iab,...ba->...i", xp.asarray(group.basis, dtype=X.dtype), carried)


def legendre_of_chart(discrete: "Discretization", cayley: Float[Array, "... k"], side: str) -> Float[Array, "... dim"]:
    """Return the momenta, in the user's body frame, of displacements given by canonical Cayley coordinates."""
    system = discrete.system
    group, canonical, back = system.group, system.canonical, system.group.inverse(system.frame)
    X = discrete.variety.increment(cayley)
    if discrete.difference == "matrix":
        reduced = matrix_legendre(group, canonical.homogeneous_mass_tensor, X, side) / discrete.time_step
        return reduced if canonical is system else group.coadjoint(back, reduced)
    return legendre(discrete, system.frame @ X @ back, side)
