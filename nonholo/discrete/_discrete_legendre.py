"""`discrete_legendre`: the momentum of a displacement, checked."""

from nonholo.base.checks import array, choice, shape_of
from nonholo.base.types import Array, Float
from nonholo.discrete._discretization import Discretization, as_discretization
from nonholo.discrete._legendre import legendre


def discrete_legendre(
    discrete: Discretization, displacement: Float[Array, "... N N"], side: str = "left"
) -> Float[Array, "... dim"]:
    r"""Return the discrete body momentum of a displacement, in physical units.

    $$ \langle P(W), x\rangle = \tfrac{d}{d\varepsilon} l_d(e^{\varepsilon x} W)\big|_0 \ \text{(left)}, \qquad
       \langle P^+(W), x\rangle = \tfrac{d}{d\varepsilon} l_d(W e^{\varepsilon x})\big|_0 \ \text{(right)}, $$

    and $P^+(W) = \mathrm{Ad}^*_W P(W)$: the momentum that arrives at the next state before the constraint force.

    Reference: [fedorov-zenkov-2004], equation (disc.mom.dfn), whose second form has the wrong sign.

    Args:
        discrete: The discretized system.
        displacement: W, an element of the group; a leading axis of many is allowed.
        side: "left" or "right".

    Raises:
        ValueError: A wrong shape, a value that is not finite, an unknown side.

    Example:
        >>> sleigh = discretize(ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.0), time_step=0.5)
        >>> discrete_legendre(sleigh, SE(2).exp(np.array([0.0, 0.5, 0.0])))
        array([0., 1., 0.])
    """
    group = as_discretization("discrete_legendre(discrete=...)", discrete).system.group
    where, shape = "discrete_legendre(displacement=...)", group.identity.shape
    leading = (None,) * (len(shape_of(displacement)) - 2)
    W = array(where, displacement, leading + shape, f"Pass an element of {group} as a matrix.")
    return legendre(discrete, W - group.identity, choice("discrete_legendre(side=...)", side, ("left", "right")))
