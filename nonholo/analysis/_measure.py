r"""Quantities that fall along a motion, and which densities of restricted momenta it keeps, or certainly does not.

With $F(W) = P(W)|_\mathfrak{d}$ a step takes $r = F(W)$ to $r' = -F(W^{-1})$, so that along the displacement variety
volumes change by $\det(\partial r'/\partial r) = \det F'(W^{-1})/\det F'(W)$. Theory: docs/theory/limits.md,
docs/theory/invariant-measure.md.
"""

import dataclasses
from typing import Any

import numpy as np

from nonholo.analysis._equilibria import equilibria
from nonholo.analysis.planar import planar_variety
from nonholo.base.checks import array, error, instance, shape_of, shown, trailing
from nonholo.base.types import Array, Float
from nonholo.discrete import Discretization, momentum_slope
from nonholo.orbit import Orbit
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
    family = system.equilibria()
    if system.normal_form is None and len(family.subspace) < system.rank:
        remedy = "Of other systems no such function of the discrete map is known."
        raise error("lyapunov_function(system=...)", "be a top or a sleigh", type(system).__name__, remedy)
    attracting = family.attracting
    return LyapunovFunction(
        np.zeros(system.group.dim) if attracting is None else attracting, system.constraint_subspace
    )


@dataclasses.dataclass(frozen=True, eq=False)
class InvariantMeasure:
    r"""Statements about densities $\rho(r)\,dr$ that a motion keeps; r are momenta along the constraint subspace.

    Attributes:
        motion: The system, meaning its flow, or its discretization.
        every_density: Whether the momenta never change, so that every density is invariant: balanced bodies.
        velocity: A body velocity near whose momentum no continuous positive density is invariant; None for balanced
            bodies.
        witness: Why: at that equilibrium one step multiplies volumes by this number, different from 1; or the flow has
            this divergence there, different from 0. None for balanced bodies.
    """

    motion: AbstractLLSystem | Discretization
    every_density: bool
    velocity: Float[np.ndarray, "dim"] | None
    witness: float | None

    def density(self, momentum: Any) -> Float[Array, "..."]:
        r"""Return an invariant density of the flow: $1/|(Bc)\cdot r^\perp|$ for a top, $1/|\pi|$ for a sleigh.

        It is infinite at the equilibria; 1 for a balanced body. As $dr = \det B\,dw$, the former is
        $dw/|c\cdot w^\perp|$ in velocities.

        Args:
            momentum: Body momenta or their components along the constraint subspace, leading axes free.

        Raises:
            ValueError: A discrete map, or a system of higher dimension, of a body that is not balanced.

        Example:
            >>> flow = invariant_measure(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5))
            >>> float(flow.density([0.5, 3.0]))
            2.0
        """
        where = "InvariantMeasure.density(momentum=...)"
        system = self.motion.system if isinstance(self.motion, Discretization) else self.motion
        k, dim = system.constraint_subspace.shape
        size = k if shape_of(momentum)[-1:] == (k,) else dim
        p = trailing(where, momentum, (size,), f"Pass {dim} body momenta or {k} along the constraint.", real=True)
        r = p if size == k else system.restrict(p)
        if self.every_density:
            return np.ones(r.shape[:-1])
        if isinstance(self.motion, Discretization):
            got = "a discrete map, whose densities are singular at equilibria, not unique and in no known closed form"
            raise error(where, "belong to a flow or a balanced body", got, "Pass the system to `invariant_measure`.")
        variety = planar_variety(system)
        if variety is None:
            got = f"{k} admissible directions"
            raise error(where, "be of a top with n = 3 or a sleigh in the plane", got, "Use `witness`.")
        with np.errstate(divide="ignore"):
            return 1 / np.abs(variety.sides_of_momenta(r).side)

    def jacobian(self, displacement: Any) -> Float[Array, "..."]:
        r"""Return the determinant of one step of the map $r_k \mapsto r_{k+1}$, from displacements.

        $$ \det\frac{\partial r'}{\partial r} = \frac{\det F'(W^{-1})}{\det F'(W)}, \qquad F(W) = P(W)|_\mathfrak{d}, $$

        in closed form for n = 3 and for the sleigh in the plane. A density is invariant if
        $\rho(r')\,|\det| = \rho(r)$.

        Args:
            displacement: W on the displacement variety, leading axes free. At a fold the value is infinite.

        Raises:
            ValueError: A flow, a wrong shape, a value that is not finite.

        Example:
            >>> measure = invariant_measure(nh.discretize(nh.ChaplyginSleigh(1.0, 0.75, 0.5), 0.5))
            >>> float(np.round(measure.jacobian(nh.SE(2).exp(np.array([0.0, 0.4, 0.0]))), 12))
            0.818181818182
        """
        where = "InvariantMeasure.jacobian(displacement=...)"
        discrete = self._discrete(where)
        shape = discrete.system.group.identity.shape
        leading = (None,) * (len(shape_of(displacement)) - 2)
        W = array(where, displacement, leading + shape, "Pass `orbit.displacement`.")
        return step_determinants(discrete, W)

    def log_volume(self, orbit: Orbit) -> Float[np.ndarray, "K"]:
        r"""Return $\log|\det \partial r_k/\partial r_0|$ along an orbit of the map, the sum over its steps.

        Raises:
            ValueError: A flow, an orbit of another motion, an orbit with states left out.
        """
        where = "InvariantMeasure.log_volume(orbit=...)"
        discrete = self._discrete(where)
        if not isinstance(orbit, Orbit) or orbit.motion is not discrete:
            remedy = "Pass an orbit of the same discretization to the measure of `orbit.motion`."
            raise error(where, "be an orbit of the measure's motion", shown(orbit), remedy)
        if not orbit.has_every_step:
            got = f"{len(orbit)} states with others, or impacts, between"
            raise error(where, "hold every step", got, "Run it with save_every=1.")
        steps = np.log(np.abs(step_determinants(discrete, orbit.displacement[:-1])))
        return np.concatenate([np.zeros(min(1, len(orbit))), np.cumsum(steps)])

    def _discrete(self, where: str) -> Discretization:
        remedy = "Pass the result of `discretize`."
        return instance(where, self.motion, Discretization, "belong to a discrete map", remedy)


def invariant_measure(motion: AbstractLLSystem | Discretization, energy: Array = 1.0) -> InvariantMeasure:
    r"""Return which densities of restricted momenta the flow of a system, or its discrete map, keeps.

    - A balanced body keeps its momenta (the principal branch is the identity): every density is invariant.
    - Any other body keeps no density that is continuous and positive near an equilibrium other than rest. An
      invariant density has $\rho(x)\,|\det T'(x)| = \rho(x)$ at a fixed point x of the map, but $|\det T'(x)| < 1$
      at the attracting and $> 1$ at the repelling ones, for every step size.
    - Off the equilibria the motion wanders: it goes from one end to the other and does not return. So densities exist
      that are singular on the equilibria, as many as there are functions on a piece that one step takes to the next.
      One of the flow is `density`; the map does not keep it.

    Reference: [fedorov-zenkov-2004], sections 4 to 7; docs/theory/invariant-measure.md.

    Args:
        motion: A top or a sleigh of any dimension, or its discretization with "matrix" and "skew".
        energy: Energy of the equilibrium that is the witness.

    Raises:
        ValueError: Another system or discretization; an energy as in `equilibria`.

    Example:
        >>> top = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
        >>> measure = invariant_measure(nh.discretize(top, 0.2))
        >>> measure.every_density, round(measure.witness, 6)
        (False, 0.946804)
        >>> invariant_measure(nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))).every_density
        True
    """
    system = motion.system if isinstance(motion, Discretization) else motion
    refuse_forces("invariant_measure(motion=...)", system)
    if not isinstance(system, AbstractSystem) or system.normal_form is None:
        remedy = "Pass a SuslovTop, a sleigh, or a discretization of one."
        raise error("invariant_measure(motion=...)", "be a top or a sleigh", type(motion).__name__, remedy)
    spectrum = equilibria(motion, energy)
    if spectrum.attracting is None:
        return InvariantMeasure(motion, True, None, None)
    factors = spectrum.multipliers
    witness = float(np.sum(spectrum.rates)) if factors is None else float(np.prod(factors))
    return InvariantMeasure(motion, False, spectrum.velocity, witness)


def step_determinants(discrete: Discretization, W: Float[np.ndarray, "... N N"]) -> Float[Array, "..."]:
    """Return the determinant of one step from each displacement; infinite at a fold."""
    system, variety = discrete.system, planar_variety(discrete.system)
    with np.errstate(divide="ignore"):
        if variety is not None:
            even, odd = variety.area_factor(variety.points(W))
            return (even - odd) / (even + odd)
        after, before = (np.linalg.det(momentum_slope(discrete, V)) for V in (system.group.inverse(W), W))
        return after / before
