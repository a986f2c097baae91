r"""Motions with constant velocity and how they attract, and which densities of momenta a motion keeps.

Theory: docs/theory/limits.md. The equilibria themselves are a question to the system.

With $F(W) = P(W)|_\mathfrak{d}$ a step takes $r = F(W)$ to $r' = -F(W^{-1})$, so that along the displacement variety
volumes change by $\det(\partial r'/\partial r) = \det F'(W^{-1})/\det F'(W)$. Theory: docs/theory/invariant-measure.md.
"""

from typing import Any, cast, overload

import numpy as np

from nonholo.analysis._linearize import SteadyMotion, steady_motion
from nonholo.analysis.planar import check_conserves_energy, planar_variety, restricted_momenta
from nonholo.base.checks import array, error, positive, refuse_given, shape_of, shown, trailing
from nonholo.base.results import result
from nonholo.base.types import Array, Float, Inexact
from nonholo.discrete import Discretization, as_discretization, momentum_slope, weights
from nonholo.orbit import Orbit
from nonholo.systems import AbstractLLSystem, Equilibria, refuse_fixed_in_space, refuse_forces


@result
class EquilibriumSpectrum:
    """Constant body velocities, and what happens beside them within their energy level.

    Attributes:
        subspace: Rows span the equilibria, shape (m, dim).
        attracting: A body velocity whose positive multiples attract; its negative multiples repel. None if none does.
        velocity: The attracting velocity with this energy; on a line of which no half attracts, either one with it.
            None on planes that do not attract, and if every admissible velocity stays constant.
        rates: Transverse eigenvalues of the flow at `velocity`, sorted; of opposite sign at -`velocity`. All negative
            where it attracts, otherwise of any sign, or complex.
        multipliers: Transverse eigenvalues of one step at the equilibrium with the momenta of `velocity`, in the order
            of `rates`; reciprocal at the opposite one. None for a system without time step.
        highest_energy: No equilibrium of the discrete map has more energy: there it turns by 90 degrees in a step. None
            where there is no bound: without time step, if equilibria do not turn, or if every velocity is one.
        others: The other linear spaces of equilibria, of systems that are neither a top nor a sleigh.
    """

    subspace: Float[np.ndarray, "m dim"]
    attracting: Float[np.ndarray, "dim"] | None
    velocity: Float[np.ndarray, "dim"] | None
    rates: Inexact[np.ndarray, "j"]
    multipliers: Float[np.ndarray, "j"] | None
    highest_energy: float | None = None
    others: tuple["EquilibriumSpectrum", ...] = ()


@overload
def equilibria(system: AbstractLLSystem | Discretization, energy: Array = 1.0) -> EquilibriumSpectrum: ...
@overload
def equilibria(system: Any, *, configuration: Any, body_velocity: Any = None) -> SteadyMotion: ...
def equilibria(
    system: Any, energy: Array = 1.0, *, configuration: Any = None, body_velocity: Any = None
) -> EquilibriumSpectrum | SteadyMotion:
    r"""Return the equilibria of a system or of its discrete map, with their transverse spectrum at an energy.

    Rates are $-\zeta|c|^2\,\mathrm{eig}(N^TB^{-1}N)$ for a top turning with $w = -\zeta c$ (N: orthonormal, across c),
    and $-a_1p_1\,\mathrm{eig}(B_1^{-1})$ for a sleigh; of other systems they are those of the linearized equations.
    A step of length h of a top or a sleigh multiplies by the Cayley transform

    $$ \mu = \frac{\varkappa + h\sigma/2}{\varkappa - h\sigma/2}, \qquad \varkappa = \cos^2(\theta/2), \quad
       \sin\theta = h|w|, $$

    of the rate $\sigma$, where $\theta$ is the angle of the step ($\varkappa = 1$ for sleighs with $a_1 \ne 0$). So
    $|\mu| < 1$ for every step; $\mu < 0$, an alternating approach, for large ones.

    With `configuration`, of any system, or its map: the state of rest near it, or the steady motion near a velocity, by
    Newton's method. Such states form families, with one direction for each constraint, ignorable coordinate and
    conserved momentum; each correction is the shortest one. On a group the body velocity stays. Steady motions of a
    map in coordinates are its own: where the motion turns they differ from those of the flow by the step squared.

    Reference: [fedorov-zenkov-2004], sections 6 and 7, "stationary solutions".

    Args:
        system: A left-invariant system, of three admissible directions at most if it is neither a top nor a sleigh, or
            a discretization with difference "matrix", constraint "skew" of a top or a sleigh.
        energy: Reduced constrained energy of the equilibrium. Rates grow as its square root.
        configuration: The configuration at which Newton's method begins. Leave out the energy beside it.
        body_velocity: The velocity at which it begins; without one the result is a state of rest.

    Raises:
        ValueError: Another system or discretization, an energy that is not positive, one that no multiple of an
            equilibrium has, one at which no step with an angle up to 90 degrees has the momenta of the equilibrium;
            a configuration near which Newton's method finds nothing.

    Example:
        A pendulum hangs:

        >>> import jax.numpy as jnp
        >>> pendulum = nh.LagrangeDAlembert(lambda q, v: v @ v / 2 + jnp.cos(q[0]), None, dimension=1)
        >>> hanging = equilibria(pendulum, configuration=[0.3])
        >>> abs(hanging.configuration.round(12)), hanging.rates.round(12), hanging.is_stable
        (array([0.]), array([0.+1.j, 0.-1.j]), True)

        >>> sleigh = nh.ChaplyginSleigh(mass=2.0, inertia=1.5, a=0.5)
        >>> states = equilibria(nh.discretize(sleigh, time_step=0.5), energy=1.0)
        >>> states.velocity, states.rates, states.multipliers
        (array([0., 1., 0.]), array([-0.5]), array([0.77777778]))
    """
    if configuration is not None or body_velocity is not None:
        refuse_given("equilibria", "be left out beside a configuration", "Pass one of them.", energy=(energy, 1.0))
        return steady_motion(system, configuration, body_velocity)
    remedy = "Pass a left-invariant system, a discretization of a top or a sleigh, or configuration= to look near."
    body = _checked_body("equilibria(system=...)", system, remedy)
    level = float(positive("equilibria(energy=...)", energy, "Pass the energy of the equilibrium."))
    family, discrete = body.equilibria(), system if isinstance(system, Discretization) else None
    if body.normal_form is None and discrete is not None and len(family.subspace) < body.rank:
        got, remedy = type(body).__name__, "Pass the system itself, for the rates of its flow."
        raise error("equilibria(system=...)", "be a top or a sleigh to have known multipliers", got, remedy)
    return _spectrum(body, discrete, family, level)


def _spectrum(
    body: AbstractLLSystem, discrete: Discretization | None, family: Equilibria, level: float
) -> EquilibriumSpectrum:
    """Return what is known of a linear space of equilibria; multipliers and the highest energy of tops and sleighs."""
    rows, attracting, form = family.subspace, family.attracting, body.normal_form
    others = tuple(_spectrum(body, discrete, other, level) for other in family.others)
    line = rows[0] if form is None and len(rows) == 1 < body.rank else None
    direction = line if attracting is None else attracting
    if direction is None:
        multipliers = None if discrete is None else np.zeros(0)
        return EquilibriumSpectrum(rows, None, None, np.zeros(0), multipliers, others=others)
    velocity = _with_energy(body, direction, level)
    if form is None:
        rates = body.transverse_rates(velocity, rows)
        return EquilibriumSpectrum(rows, attracting, velocity, rates, None, others=others)
    w = np.linalg.solve(body.form_map.T, velocity @ np.linalg.pinv(body.constraint_subspace))
    if form.arm != 0:
        rates = np.sort(-form.mass * form.arm * w[-1] / form.moments)
    else:
        c = form.coupling
        across = np.linalg.svd(c[None, :])[2][1:].T
        turning = np.linalg.eigvalsh(across.T @ np.linalg.solve(form.stiffness_matrix, across))
        rates = np.sort(-np.linalg.norm(w[: len(c)]) * np.linalg.norm(c) * turning)
    if discrete is None:
        return EquilibriumSpectrum(rows, attracting, velocity, rates, None)
    multipliers = _multipliers(discrete, velocity, rates)
    return EquilibriumSpectrum(rows, attracting, velocity, rates, multipliers, highest_energy(discrete))


def _with_energy(body: AbstractLLSystem, direction: Float[np.ndarray, "dim"], level: float) -> Float[np.ndarray, "dim"]:
    """Return the multiple of a velocity that has an energy; on groups with a form there may be none."""
    own = float(body.constrained_energy(direction @ np.asarray(body.inertia_operator)))
    if not own > 0:
        got = f"{level:g} for an equilibrium whose energies have the sign of {own:g}"
        remedy = "Ask for `system.transverse_rates(...)`."
        raise error("equilibria(energy=...)", "be an energy of the equilibria", got, remedy)
    return direction * np.sqrt(level / own)


def highest_energy(discrete: Discretization) -> float | None:
    r"""Return the energy above which the discrete map has no equilibrium, $q_c/(2h^2|c|^2)$ for tops; None if none."""
    body = cast("AbstractLLSystem", discrete.system)
    velocity, form = body.equilibria().attracting, body.normal_form
    if velocity is None or form is None or form.arm != 0:
        return None
    turn = np.abs(_steps(discrete)).max() * float(body.group.angle(velocity))
    return float(body.constrained_energy(velocity @ np.asarray(body.inertia_operator)) / turn**2)


def _steps(discrete: Discretization) -> Float[np.ndarray, "S"]:
    """Return the time steps of the substeps, one for order 2."""
    return float(discrete.time_step) * weights(discrete.order)


def _checked_body(where: str, value: Any, remedy: str) -> AbstractLLSystem:
    """Return the free body of a left-invariant system, or of its map that conserves energy."""
    body = value.system if isinstance(value, Discretization) else value
    refuse_forces(where, body)
    refuse_fixed_in_space(where, body, remedy)
    if isinstance(value, Discretization):
        check_conserves_energy(where, value, "conserve the energy")
    return cast(AbstractLLSystem, body)


def _multipliers(discrete: Discretization, velocity: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Return the products, over the substeps of a step, of their multipliers."""
    steps = _steps(discrete)
    sine = np.abs(steps[:, None]) * float(discrete.system.group.angle(velocity))
    if sine.max() > 1:
        remedy = f"Lower the energy, to {highest_energy(discrete):.6g} at most, or the time step."
        got = f"time_step * angular velocity = {sine.max():.6g}"
        raise error("equilibria(energy=...)", "belong to a step of at most 90 degrees", got, remedy)
    share, change = (1 + np.sqrt((1 - sine) * (1 + sine))) / 2, steps[:, None] * rates / 2
    return np.prod((share + change) / (share - change), axis=0)


@result
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


def lyapunov_function(system: AbstractLLSystem | Discretization) -> LyapunovFunction:
    r"""Return the function of the momentum that falls along every motion that is not an equilibrium.

    $L = c\cdot r$ for a top, $L = -\mathrm{sgn}(a_1)\,p_1$ for a sleigh, $L = -c\cdot\pi$ for a sleigh with $a_1 = 0$.
    In one step of the discrete map, with momenta of that step and the angle $\theta$ of the displacement about $u$,

    $$ \Delta L = -\tfrac4h\sin^2\tfrac\theta2\,\bigl(|c|^2 - (c\cdot u)^2\bigr) \ \text{(top)}, \qquad
       \Delta L = -\tfrac{4m|a_1|}h\sin^2\tfrac\theta2 \ \text{(sleigh)}, $$

    on every branch and for every step size.

    Reference: [fedorov-zenkov-2004], sections 6 and 7, for n = 3 and SE(2).

    Args:
        system: A top, a sleigh, or a system all of whose velocities stay constant; or its discretization with "matrix"
            and "skew".

    Raises:
        ValueError: Another system or discretization.

    Example:
        >>> sleigh = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
        >>> orbit = nh.simulate(nh.discretize(sleigh, 0.1), body_velocity=(1, -2, 0), steps=50)
        >>> bool(np.all(np.diff(lyapunov_function(sleigh)(orbit.momentum)) < 0))
        True
    """
    where, remedy = "lyapunov_function(system=...)", "Pass a SuslovTop, a sleigh, or the discretization of one."
    body = _checked_body(where, system, remedy)
    family = body.equilibria()
    if body.normal_form is None and len(family.subspace) < body.rank:
        remedy = "Of other systems no such function of the discrete map is known."
        raise error(where, "be a top or a sleigh", type(body).__name__, remedy)
    attracting = np.zeros(body.group.dim) if family.attracting is None else family.attracting
    return LyapunovFunction(attracting, body.constraint_subspace)


@result
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
        r = restricted_momenta(where, system, momentum)
        if self.every_density:
            return np.ones(r.shape[:-1])
        if isinstance(self.motion, Discretization):
            got = "a discrete map, whose densities are singular at equilibria, not unique and in no known closed form"
            raise error(where, "belong to a flow or a balanced body", got, "Pass the system to `invariant_measure`.")
        variety = planar_variety(system)
        if variety is None:
            got = f"{system.rank} admissible directions"
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
            ValueError: A flow, a composition, a wrong shape, a value that is not finite.

        Example:
            >>> measure = invariant_measure(nh.discretize(nh.ChaplyginSleigh(1.0, 0.75, 0.5), 0.5))
            >>> float(np.round(measure.jacobian(nh.SE(2).exp(np.array([0.0, 0.4, 0.0]))), 12))
            0.818181818182
        """
        where = "InvariantMeasure.jacobian(displacement=...)"
        discrete = as_discretization(where, self.motion)
        shape = discrete.system.group.identity.shape
        leading = (None,) * (len(shape_of(displacement)) - 2)
        W = array(where, displacement, leading + shape, "Pass `orbit.displacement`.")
        return step_determinants(discrete, W)

    def log_volume(self, orbit: Orbit) -> Float[np.ndarray, "K"]:
        r"""Return $\log|\det \partial r_k/\partial r_0|$ along an orbit of the map, the sum over its steps.

        Raises:
            ValueError: A flow, a composition, an orbit of another motion, an orbit with states left out.
        """
        where = "InvariantMeasure.log_volume(orbit=...)"
        discrete = as_discretization(where, self.motion)
        if not isinstance(orbit, Orbit) or orbit.motion is not discrete:
            remedy = "Pass an orbit of the same discretization to the measure of `orbit.motion`."
            raise error(where, "be an orbit of the measure's motion", shown(orbit), remedy)
        if not orbit.has_every_step:
            got = f"{len(orbit)} states with others, or impacts, between"
            raise error(where, "hold every step", got, "Run it with save_every=1.")
        steps = np.log(np.abs(step_determinants(discrete, orbit.displacement[:-1])))
        return np.concatenate([np.zeros(min(1, len(orbit))), np.cumsum(steps)])


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
    if getattr(system, "normal_form", None) is None:
        remedy = "Pass a SuslovTop, a sleigh, or a discretization of one."
        raise error("invariant_measure(motion=...)", "be a top or a sleigh", type(system).__name__, remedy)
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
