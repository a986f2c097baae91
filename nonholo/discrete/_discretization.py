"""A discretization: a system, a time step, a discrete Lagrangian and a displacement variety; its checked starts."""

import dataclasses
import functools
from typing import Any, ClassVar, cast

import numpy as np

from nonholo.base.checks import error, shape_of, shown, trailing
from nonholo.base.numerics import applied
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Float
from nonholo.discrete._decoder import ClosedDisplacementDecoder, DisplacementDecoder
from nonholo.discrete._scheme import Scheme, definition, equations_of, legendre, refuse_composition
from nonholo.discrete.routes import AbstractBodyStepper, AbstractCompiledRoute, make_route
from nonholo.orbit import AbstractMotion, First, Orbit, turned_near
from nonholo.systems import Forced, Start, Widened, in_group, of_finite_energy, refuse_forces

_TOLERANCE = 1e-9  # relative, for matrices and momenta that a user computed in floating point
_SAMPLES, _EVEN = 16, 1e-10  # of displacements; relative difference of values that counts as rounding


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Discretization(Scheme, AbstractMotion):
    """A discretized system, made by `discretize`.

    Attributes:
        system: The system.
        time_step: h.
        difference: "matrix", "logarithmic" or a callable.
        constraint: "skew", "exponential", "naive" or functions.
        order: 2, or 4, 6, 8: a symmetric composition of steps of order 2.

    Example:
        >>> discretize(ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
        Discretization(system=ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5, b=0.0), time_step=0.1,
            difference='matrix', constraint='skew', order=2)
    """

    wanted_route: str | None = dataclasses.field(default=None, repr=False, kw_only=True, metadata={"stored": False})
    """The route of a store that was begun by another one than the best; see `make_route`."""
    starts: ClassVar[tuple[str, ...]] = ("body_velocity", "displacement", "momentum", "restricted_velocity")
    structure: ClassVar[tuple[str, ...]] = (*Scheme.structure, "wanted_route")

    def __repr__(self) -> str:
        way = f"difference={self.difference!r}, constraint={self.constraint!r}, order={self.order}"
        return f"Discretization(system={self.system!r}, time_step={self.time_step}, {way})"

    @functools.cached_property
    def route(self) -> AbstractCompiledRoute:
        """The way in which steps are computed; chosen on first use and kept."""
        return make_route(self, self.wanted_route)

    @functools.cached_property
    def displacement_decoder(self) -> DisplacementDecoder | ClosedDisplacementDecoder:
        """The decoder of the displacements of its single steps."""
        numbers = self.decoder.numbers if self.difference == "matrix" else None
        if numbers is None or not self.variety.exact or self.variety.exponential:
            return DisplacementDecoder(self)
        return ClosedDisplacementDecoder(numbers, float(self.time_step))

    @functools.cached_property
    def _steppers(self) -> tuple[AbstractBodyStepper, ...]:
        return tuple(self.route.stepper(self, with_poses=with_poses) for with_poses in (False, True))

    def stepper(self, *, with_poses: bool) -> AbstractBodyStepper:
        """Return what takes the steps of the principal branch, and saves poses or not."""
        return self._steppers[bool(with_poses)]

    def first(self, start: Start, *, with_poses: bool) -> First:
        """Return the checked start of a run whose rows have poses or not: one may be large.

        A displacement or a full momentum determines W_0 or P_0 completely; the run checks that the principal root
        agrees.
        """
        system, g = self.system, None
        if start.configuration is not None or (with_poses and system.is_spatial):
            g = start.pose(system.group)
        place = g if with_poses else None
        if start.name == "displacement":
            remedy = "A whole step does not lie on the variety: start from a momentum or a velocity."
            refuse_composition(start.where, self, remedy)
            refuse_forces(start.where, system)
            demand = on_variety(start.where, self, place, start.value)
            momentum = legendre(self, demand - system.group.identity, "left")
            reduced = of_finite_energy(start.owner, system, place, system.restrict_at(momentum, place))
        else:
            full = start.name == "momentum" and shape_of(start.value) != (system.rank,)
            reduced, demand = start.momentum(system, place), np.asarray(start.value, np.float64) if full else None
        return First((reduced, start.canonical_pose(system, g) if with_poses else np.empty(0)), demand)

    @functools.cached_property
    def is_balanced(self) -> bool:  # type: ignore[override]
        """Whether the scheme is "energy"."""
        if self.forces is None:
            return False
        free = dataclasses.replace(self, system=self.forces.system)
        return self.forces.is_balanced(free.conserves_energy, self.order > 2)

    @property
    def route_name(self) -> str:
        """How stores call the route."""
        return self.route.name

    @property
    def conserves_energy(self) -> bool:
        """Whether the energy theorem holds: matrix difference, a variety closed under it, a left-invariant constraint.

        Example:
            >>> discretize(ChaplyginSleigh(1.0, 1.0, 0.5), 0.1, difference="logarithmic").conserves_energy
            False
        """
        if self.forces is not None:
            return self.is_balanced and not self.forces.parts
        if self.difference != "matrix" or self.system.is_spatial:
            return False
        if self.constraint != "exponential":
            return self.constraint == "skew"
        return self.system.normal_form is not None or not self.variety.exponential

    @property
    def is_self_adjoint(self) -> bool:
        """Whether l_d(W) = l_d(W^-1), so that the step is an even condition; tried at random W for a callable.

        Example:
            >>> discretize(ChaplyginSleigh(1.0, 1.0, 0.5), 0.1).is_self_adjoint
            True
        """
        if not callable(self.difference):
            return True
        group, map_each = self.system.group, definition("discretize(difference=...)").map_each
        W = group.exp(0.5 * np.random.default_rng(0).normal(size=(_SAMPLES, group.dim)) / np.sqrt(group.dim))
        there, back = map_each(self.difference, W), map_each(self.difference, group.inverse(W))
        return bool(np.abs(there - back).max() <= _EVEN * np.abs(there).max())

    def displaced(self, cayley: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "... N N"]:
        """Return the elements of the variety, in the user's frame, with canonical chart coordinates."""
        where, size = "Discretization.displaced(cayley=...)", len(self.variety.chart)
        charts = trailing(where, cayley, (size,), f"Pass {size} chart coordinates.", real=True, moderate=True)
        return self.displacement_decoder.displacement(charts)

    def displacements(self, states: Orbit) -> Float[np.ndarray, "K N N"]:
        """Return the displacements of whole steps; spatial ones for a right-invariant constraint."""
        if self.order == 2:
            return self.displaced(states.canonical_chart)
        group, moves = self.system.group, self.system.is_spatial
        if self.forces is not None:
            ahead = group.matrix_from_pose(self.route.parts(states, np.ones(len(states)))[2])
            return group.inverse(states.configuration) @ ahead @ group.inverse(self.system.frame)
        g = states.configuration if moves else np.broadcast_to(group.identity, (len(states), group.size, group.size))
        after = self.route.whole_steps(states.reduced_momentum, g)[1]
        return after @ group.inverse(g) if moves else after

    def after_parts(self, states: Orbit, fractions: Float[np.ndarray, "K"]) -> Orbit:
        r"""Return what is reached from states after parts of the steps that begin there.

        With momentum r and pose g at the beginning of a step W(s) is the principal root of $P(W)|_d = s\,r$; the pose
        is $g\,W(s)$, the momentum $(\mathrm{Ad}^*_{W(s)}P(W(s)))|_d/s$. For a discrete Lagrangian $h\,l(\cdot)$,
        "matrix" or "logarithmic", that is the step of length $s\,h$ from the same state; under forces with half its
        impulse at each end, of a table the row of the step. The roots W(s) are the very path that defines the principal
        branch, from the identity to the displacement of the whole step: at s = 1 the next state is reached.

        Args:
            states: States of an orbit of this map, on the principal branch.
            fractions: Numbers s in (0, 1], one for each.

        Returns:
            An orbit; momenta and displacements are NaN where there is no such part, or no whole step from its end.

        Example:
            >>> sleigh = discretize(ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
            >>> orbit = nh.simulate(sleigh, body_velocity=(1.0, 0.5, 0.0), steps=3)
            >>> half = sleigh.after_parts(orbit[1:2], np.array([0.5]))
            >>> half.time.round(3), half.step
            (array([0.15]), array([1]))
        """
        if not len(states):
            return states
        momenta, charts, pose = self.route.parts(states, fractions)
        pose = None if states.canonical_pose is None else pose
        headings = None if states.turned is None or pose is None else turned_near(states.turned, pose)
        rows = {"reduced_momentum": momenta, "cayley": charts, "canonical_pose": pose, "turned": headings}
        step, time = states.step + fractions.astype(np.int64), states.time + fractions * self.time_step
        return dataclasses.replace(states, time=time, step=step, **rows)

    def constraint_residual(self, states: Orbit) -> Float[np.ndarray, "K j"]:
        """Return the forbidden parts of (W - W^-1)/2, of log W where the chart is exp, or the variety's equations."""
        if self.system.is_wide:
            return np.zeros((len(states), 0))  # the chart has no forbidden directions
        D = self.variety.displaced(states.canonical_chart)
        if not self.variety.exact:
            return equations_of(self.variety, D)
        group = self.system.group
        coordinates = group.log(D) if self.variety.exponential else group.vee(D - group.inverse(D)) / 2
        return applied(self.variety.annihilator, coordinates)

    def full_momentum(self, states: Orbit) -> Float[np.ndarray, "K dim"]:
        """Return the discrete momenta at the displacements, of a composition at those of first substeps."""
        first = self.first_part
        momentum = first._momentum(self.system.constraint_poses(states), states.canonical_chart, "left")
        if self.forces is None:
            return momentum
        momentum = momentum - first._impulses(states, 0)
        if not self.forces.slips:
            return momentum
        body = cast(Widened, self.forces.free)
        slip = states.restricted_momentum[:, -len(body.rows) :]
        return momentum - (applied(body.duals, momentum) - slip) @ body.rows

    def mean_force(self, states: Orbit, forced: Forced | None = None) -> Float[np.ndarray, "K dim"]:
        """Return the covectors f that act over single steps from states, where forces are balanced."""
        forced, W = forced or cast(Forced, self.forces), self.displaced(states.canonical_chart)
        h, rows = float(self.time_step), forced.rows(states.step)
        return forced.mean_force(states.configuration, W, h, rows, states.time)

    def has_exact_work(self, states: Orbit) -> bool:
        """Return whether the energy less the work is constant to rounding: every step is of order 2, and balanced."""
        return self.order == 2 and self.is_balanced and states.has_every_step

    def work(self, states: Orbit, forced: Forced) -> Float[np.ndarray, "K"]:
        """Return the work of a force along states since the first: exact of balanced steps of order 2."""
        if not self.has_exact_work(states):
            return super().work(states, forced)
        before = states.chosen(slice(None, -1))
        group, W = self.system.group, self.displaced(before.canonical_chart)
        X = group.vee((W - group.inverse(W)) / 2)
        gain = np.diff(forced.potential_energy(states.configuration))
        gain += (self.mean_force(before, forced) * X).sum(axis=1)
        if forced.slips:  # by the impulses of slips, less what is lost where they end
            body, h = cast(Widened, cast(Forced, self.forces).free), float(self.time_step)
            slip, momenta = applied(body.rows, X), states.restricted_momentum[:, -len(body.rows) :]
            start = applied(body.slip_inertia, 2 / h * slip) - momenta[1:]  # the mean with what follows is M x / h
            left, right = (self.displacement_decoder.momentum(before.canonical_chart, x) for x in ("left", "right"))
            impulse = applied(body.duals, left - right - h * self.mean_force(before)) + momenta[1:] - start
            velocities = np.linalg.solve(body.slip_inertia, (momenta[:-1] + start).T).T
            gain = gain + ((impulse * slip).sum(axis=1) / h - ((momenta[:-1] - start) * velocities).sum(axis=1) / 2)
        return np.concatenate([np.zeros(min(1, len(states))), np.cumsum(gain)])

    def multipliers(self, states: Orbit) -> Float[np.ndarray, "L s"]:
        r"""Return the impulses $\lambda$ in $P_{k+1} - \mathrm{Ad}^*_{W_k} P_k = \sum_j \lambda_j a^j$.

        For a right-invariant constraint the right-hand side is $\sum_j \lambda_j \mathrm{Ad}^*_{g_{k+1}} a^j$. Where
        rows may yield, the $a^j$ are all rows of the system inside, and the friction of those that slide counts.
        """
        remedy = "Impulses of substeps at different poses do not add up to one of the step: run with order=2."
        refuse_composition("Orbit.multipliers", self, remedy)
        system, before = self.system, states.chosen(slice(None, -1))
        after = states.chosen(slice(1, None)) if states.has_every_step else self._next_states(before, states)
        if self.forces is None and not system.is_spatial:
            return self.displacement_decoder.multipliers(before.canonical_chart, after.canonical_chart)
        arriving = self._momentum(system.constraint_poses(before), before.canonical_chart, "right")
        if self.is_balanced:
            arriving = arriving + self._impulses(before, 0) + self._impulses(after, 0)
        elif self.forces is not None:
            arriving = arriving + self._impulses(after, 0) + self._impulses(after, -1)
        g = self.displaced(before.canonical_chart) @ before.configuration if system.is_spatial else None
        jump = self._momentum(g, after.canonical_chart, "left") - arriving
        jump = jump if g is None else system.group.coadjoint(system.group.inverse(g), jump)
        return applied(np.linalg.pinv(system.inside.annihilator).T, jump)

    def _next_states(self, before: Orbit, states: Orbit) -> Orbit:
        """Return the states one step after others, whose displacements count, instead of those that were saved."""
        if before.branch != "principal":
            got = f"branch {before.branch!r} and {len(before) + 1} states with others between, which are not known"
            raise error("Orbit.multipliers", "have all states, or the principal branch", got, "Run with save_every=1.")
        if self.forces is not None:
            return self.after_parts(before, np.ones(len(before)))
        return dataclasses.replace(states.chosen(slice(1, None)), cayley=self.route.next_charts(before))

    def _impulses(self, states: Orbit, shift: int) -> Float[np.ndarray, "K dim"]:
        """Return the half impulses at nodes of the steps that begin there, or with shift -1 of those that end there."""
        forced, half = cast(Forced, self.forces), float(self.time_step) * (0.5 + shift)
        if self.is_balanced:  # the same at both ends
            return half * self.mean_force(states)
        steps, momenta = states.step + shift, states.restricted_momentum
        impulses = forced.impulses(momenta, states.configuration, states.time, steps, half)
        return impulses if shift == 0 else -impulses

    def _momentum(self, g: np.ndarray | None, cayley: np.ndarray, side: str) -> np.ndarray:
        """Return the momenta of displacements; from poses where the constraint depends on them."""
        if g is None:
            return self.displacement_decoder.momentum(cayley, side)
        return legendre(self, self.system.in_body(self.variety.increment(cayley), g), side)


def as_discretization(where: str, value: Any, *, compositions: bool = False, forced: bool = False) -> Discretization:
    """Refuse what is not a discretized system on a group, and compositions and forces unless they are welcome."""
    if not isinstance(value, Discretization):
        raise error(where, "be a discretized system on a group", shown(value), "Pass the result of `discretize`.")
    if not compositions:
        refuse_composition(where, value, "Pass the discretization of order 2 that is composed.")
    if not forced:
        refuse_forces(where, value.system)
    return value


def check_first_state(demand: np.ndarray, there: Orbit) -> None:
    """Refuse a start whose displacement or full momentum is not that of the principal root, which is the first one."""
    if demand.ndim == 2:
        value, outcome = there.displacement[0], Outcome.branch_unverified
    else:
        value, outcome = there.momentum[0], Outcome.off_momentum_locus
    if np.linalg.norm(demand - value) > _TOLERANCE * np.linalg.norm(value):
        raise OutcomeError(outcome, "Start of the run", there.chosen(slice(0, 0)))


def on_variety(where: str, discrete: Scheme, g: np.ndarray | None, displacement: Any) -> np.ndarray:
    """Return a displacement whose place on the variety is checked, refused with its forbidden part."""
    system, group = discrete.system, discrete.system.group
    W = in_group(where, group, displacement)
    in_frame = g @ W @ group.inverse(g) if system.is_spatial else W
    logarithm = group.log(in_frame)
    if discrete.variety.exact:
        forbidden, what = system.annihilator @ logarithm, "a logarithm with forbidden part"
        remedy = "Build it as `group.exp(x)` with x admissible."
    else:
        forbidden, what = equations_of(discrete.variety, system.to_canonical_frame(in_frame)), "equations with residual"
        remedy = "Start from a velocity, or take a row of `orbit.displacement`: exp d is not this variety."
    if np.linalg.norm(forbidden) > _TOLERANCE * max(1.0, float(np.linalg.norm(logarithm))):
        got = f"{what} {np.array2string(forbidden, precision=6)}"
        raise error(where, "lie on the displacement variety", got, remedy)
    return W
