r"""Motions with constant velocity and how they attract: rates of the flow, multipliers of the discrete map.

Theory: docs/theory/limits.md. The equilibria themselves are a question to the system.
"""

import dataclasses
from typing import Any, cast, overload

import numpy as np

from nonholo.analysis._linearize import SteadyMotion, steady_motion
from nonholo.base.checks import error, positive, refuse_given
from nonholo.base.types import Array, Float, Inexact
from nonholo.discrete import Discretization, weights
from nonholo.systems import AbstractLLSystem, AbstractSystem, Equilibria, NormalForm, refuse_forces


@dataclasses.dataclass(frozen=True, eq=False)
class EquilibriumSpectrum:
    """Constant body velocities, and what happens beside them within their energy level.

    Attributes:
        subspace: Rows span the equilibria, shape (m, dim).
        attracting: A body velocity whose positive multiples attract; its negative multiples repel. None if none does.
        velocity: The attracting velocity with the energy asked for; on a line of which no half attracts either one
            with it. None on planes that do not attract, and if every admissible velocity stays constant.
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
    Newton's method. Such states come in families, of as many directions as there are constraints, ignorable coordinates
    and conserved momenta; each correction is the shortest one. Of a body on a group, states of rest under forces.

    Reference: [fedorov-zenkov-2004], sections 6 and 7, "stationary solutions".

    Args:
        system: A left-invariant system, of three admissible directions at most if it is neither a top nor a sleigh, or
            a discretization with difference "matrix", constraint "skew" of a top or a sleigh.
        energy: Reduced constrained energy of the equilibrium that is looked at; rates grow as its square root.
        configuration: A configuration near which an equilibrium is looked for; then the energy is left out.
        body_velocity: A velocity near that of a steady motion; by default states of rest are looked for.

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
    body, step = _body_and_steps("equilibria(system=...)", system)
    level = float(positive("equilibria(energy=...)", energy, "Pass the energy of the equilibrium."))
    if body.normal_form is None:
        return _of_field(body, step, body.equilibria(), level)
    return _of_form(body, step, body.equilibria(), level)


def _of_form(
    body: AbstractLLSystem, steps: Float[np.ndarray, "S"] | None, family: Equilibria, level: float
) -> EquilibriumSpectrum:
    if family.attracting is None:
        nothing = np.zeros(0)
        return EquilibriumSpectrum(family.subspace, None, None, nothing, None if steps is None else nothing)
    velocity = _with_energy(body, family.attracting, level)
    rates = np.sort(_rates(body, velocity @ np.linalg.pinv(body.constraint_subspace)))
    if steps is None:
        return EquilibriumSpectrum(family.subspace, family.attracting, velocity, rates, None)
    multipliers, highest = _multipliers(body, velocity, rates, steps), _highest_energy(body, steps)
    return EquilibriumSpectrum(family.subspace, family.attracting, velocity, rates, multipliers, highest)


def _of_field(
    body: AbstractLLSystem, steps: Float[np.ndarray, "S"] | None, family: Equilibria, level: float
) -> EquilibriumSpectrum:
    nothing, everywhere = np.zeros(0), len(family.subspace) == body.rank
    if steps is not None and not everywhere:
        got, remedy = type(body).__name__, "Pass the system itself, for the rates of its flow."
        raise error("equilibria(system=...)", "be a top or a sleigh to have known multipliers", got, remedy)
    others = tuple(_of_field(body, steps, other, level) for other in family.others)
    line = family.subspace[0] if len(family.subspace) == 1 and not everywhere else None
    direction = line if family.attracting is None else family.attracting
    if direction is None:
        multipliers = None if steps is None else nothing
        return EquilibriumSpectrum(family.subspace, None, None, nothing, multipliers, others=others)
    velocity = _with_energy(body, direction, level)
    rates = body.transverse_rates(velocity, family.subspace)
    return EquilibriumSpectrum(family.subspace, family.attracting, velocity, rates, None, others=others)


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
    return _highest_energy(cast("AbstractLLSystem", discrete.system), _steps(discrete))


def _highest_energy(body: AbstractLLSystem, steps: Float[np.ndarray, "S"]) -> float | None:
    velocity, form = body.equilibria().attracting, body.normal_form
    if velocity is None or form is None or (form.is_sleigh and form.arm != 0):
        return None
    turn = np.abs(steps).max() * float(body.group.angle(velocity))
    return float(body.constrained_energy(velocity @ np.asarray(body.inertia_operator)) / turn**2)


def _steps(discrete: Discretization) -> Float[np.ndarray, "S"]:
    """Return the time steps of the substeps, one for order 2."""
    return float(discrete.time_step) * weights(discrete.order)


def _body_and_steps(where: str, value: Any) -> tuple[AbstractLLSystem, Float[np.ndarray, "S"] | None]:
    """Return the body and the time steps of the substeps, one for order 2."""
    remedy = "Pass a left-invariant system, a discretization of a top or a sleigh, or configuration= to look near."
    body = value.system if isinstance(value, Discretization) else value
    refuse_forces(where, body)
    if not isinstance(body, AbstractSystem) or body.is_spatial:
        raise error(where, "have a left-invariant constraint", type(body).__name__, remedy)
    left = cast(AbstractLLSystem, body)
    if not isinstance(value, Discretization):
        return left, None
    if not value.conserves_energy:
        got = f"difference={value.difference!r}, constraint={value.constraint!r}"
        raise error(where, "conserve the energy", got, "Use the defaults of `discretize`.")
    return left, _steps(value)


def _rates(body: AbstractLLSystem, w: Float[np.ndarray, "k"]) -> Float[np.ndarray, "j"]:
    """Return the transverse rates at the equilibrium with this velocity in the rows of the constraint subspace."""
    form = cast("NormalForm", body.normal_form)
    w = np.linalg.solve(body.form_map.T, w)
    if not form.is_sleigh or form.arm == 0:
        return _turning(form.stiffness_matrix, form.coupling, w[: len(form.coupling)])
    turning = np.sort(form.turning) if form.is_diagonal else np.linalg.eigvalsh(form.turning)
    return -form.mass * form.arm * w[-1] / turning


def _turning(B: Float[np.ndarray, "k k"], c: Float[np.ndarray, "k"], w: Float[np.ndarray, "k"]) -> np.ndarray:
    across = np.linalg.svd(c[None, :])[2][1:].T
    return -np.linalg.norm(w) * np.linalg.norm(c) * np.linalg.eigvalsh(across.T @ np.linalg.solve(B, across))


def _multipliers(body: AbstractLLSystem, velocity: np.ndarray, rates: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Return the products, over the substeps of a step, of their multipliers."""
    sine = np.abs(steps[:, None]) * float(body.group.angle(velocity))
    if sine.max() > 1:
        remedy = f"Lower the energy, to {_highest_energy(body, steps):.6g} at most, or the time step."
        got = f"time_step * angular velocity = {sine.max():.6g}"
        raise error("equilibria(energy=...)", "belong to a step of at most 90 degrees", got, remedy)
    share, change = (1 + np.sqrt((1 - sine) * (1 + sine))) / 2, steps[:, None] * rates / 2
    return np.prod((share + change) / (share - change), axis=0)
