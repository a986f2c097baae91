"""A system with a potential and a force: again a system, with kinetic energy and constraint of the one inside.

Questions about free motions (equilibria, conserved momenta, closed forms) are refused; functions that serve forces are
documented as such.

The implicit midpoint rule for half an impulse of a force that depends on the velocity.
"""

import dataclasses
import functools
import operator
from collections.abc import Callable
from typing import Any, ClassVar, cast

import numpy as np

from nonholo.base.calls import name_of, note_fault, number_of, numbers_of
from nonholo.base.checks import array, assign, choice, error, function, instance, refuse_given, trailing
from nonholo.base.numerics import applied, exponential_increment, inverse_of
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.types import Array, Float
from nonholo.systems._base import AbstractSystem, Covectors, Poses
from nonholo.systems._coordinate_system import AbstractCoordinateSystem
from nonholo.systems.forces import _friction
from nonholo.systems.forces._contacts import Contacts
from nonholo.systems.forces._potentials import Gravity

_OFFSET = 8e-3  # of a body direction, for central differences: its sixth power is at rounding
_DIFFERENCES = np.array([45.0, -9.0, 1.0]) / (60 * _OFFSET)  # of order 6, at one, two and three offsets

_SAME = """
    group is_spatial has_blade homogeneous_mass_tensor inertia_operator inertia_along constraint_subspace annihilator
    rank canonical frame frame_map inverse_frame_map frame_pose to_canonical from_canonical carried
    constraint_velocity constraint_momentum directions moved in_body constraint_poses components_along
    restricted_velocity restricted_momentum momenta_along constrained_energy
"""
"""Properties that are those of the body that moves."""

_ITERATIONS = 30  # of Newton's method with one slope
_MOST, _PARTS = 100, 0.5 ** np.arange(40)  # corrections with new slopes, and parts of one
_UNSEEN = 2e-15  # relative, of differences of U
_ROUNDING = 1e-12  # relative, before the last correction
_DIFFERENCE = 1e-7  # relative, of a momentum

SCHEMES = "energy", "variational"
Function = Callable[[np.ndarray], np.ndarray]


@dataclasses.dataclass(frozen=True, eq=False)
class Forced(AbstractSystem):
    r"""A system under a potential U and a force f, a body covector; both act along the constraint alone.

    $$ \dot p = \mathrm{ad}^*_\omega p - dU + f(t, g, \omega) + \sum_j\lambda_ja^j, \qquad \omega\in\mathfrak{d}. $$

    `discretize` gives the forced discrete map, symmetric in time and of order 2 or, composed, 4, 6, 8, with group and
    constraint kept as by the free map (docs/theory/forces.md). Two schemes differ in where forces act:

    - "energy": equal half impulses $\tfrac h2f$ at both ends of a step, taken at the displacement itself. T + U is
      exact on every branch and at every step size (Theorem 18.1), and T changes by $\langle f, X\rangle$ exactly,
      X = (W - W^-1)/2 (Theorem 18.2). It needs a free map that keeps its energy: a mass tensor, the difference
      "matrix", the constraint "skew", fixed in the body.
    - "variational": kicks at the nodes, with the trapezoidal rule for U in the action, around every step of order 2.
      The map of a body without constraint is symplectic; T + U has an error of order 2, which may grow on constrained
      bodies.

    Momenta and energies of orbits are those at the nodes. Under friction alone T never grows in steps of order 2.

    Args:
        system: A system on a group, `LLSystem` or `LRSystem` or one of their kinds; or a `LagrangeDAlembert`, which is
            returned with U(q) and f(time, q, v), of q.size components. A system with forces accepts only a table.
        potential: `Gravity`, `Linear`, `Spring`, or U, a function from a configuration (N, N) to a number; several are
            a tuple. The derivative of a function is taken by central differences of order 6 along the body directions;
            their error is about 1e-13 of the change of U over one radian or one unit of length.
        force: f, a function (time, configuration, body_velocity) -> (dim,); or `Friction`; or an array (steps, dim),
            whose row k acts constantly over step k: for maps only; or `Slip`, rows of the constraint that may yield:
            for flows and the scheme "energy". Time is that of the orbit, from zero. Several forces are a tuple of
            them, such as `(Friction(...), table)`, with at most one of each kind but `Slip`. Under "energy" f is
            evaluated in the middle of the step, at its mean velocity X / h.
        scheme: "energy" or "variational"; by default "energy" wherever it is defined and the body is constrained.

    Functions marked `numba.njit` run in the compiled step of a constraint that is fixed in the body, in a fraction of a
    microsecond beside their own time; they may return a tuple, and must not write to their arguments. An exception in
    them is printed, and ends the run as "nonfinite". Functions of Python have the same bits, and cost some hundred
    microseconds a step.

    Raises:
        ValueError: The system has forces, and the new one is not a table; a potential or force of another kind or
            shape; `discretize` refuses the scheme "energy" where it is not defined.

    Example:
        A heavy top that cannot spin about its own axis:

        >>> top = nh.SuslovTop(np.diag([1.0, 1.2, 0.6]))
        >>> heavy = nh.Forced(top, nh.Gravity(force=[0.0, 0.0, -9.81], point=[0.0, 0.0, 0.3]))
        >>> orbit = nh.simulate(nh.discretize(heavy, 0.01), body_velocity=(0.2, 0.1, 0.0), steps=1000)
        >>> float(np.ptp(orbit.energy) / abs(orbit.energy[0])) < 1e-13
        True

        Your own torque about the first axis, compiled:

        >>> import numba
        >>> @numba.njit
        ... def motor(time, configuration, body_velocity):
        ...     return 0.5 - 0.1 * body_velocity[0], 0.0, 0.0
        >>> driven = nh.discretize(nh.Forced(top, force=motor), 0.01)
        >>> orbit = nh.simulate(driven, body_velocity=(0.0, 0.0, 0.0), steps=1000)
        >>> round(float(orbit.body_velocity[-1, 0]), 3)
        2.131
    """

    system: AbstractSystem
    potential: Any = None
    force: Any = None
    scheme: str | None = None
    structure: ClassVar[tuple[str, ...]] = ("scheme",)
    normal_form: ClassVar[None] = None
    is_forced: ClassVar[bool] = True
    homogeneous_mass_tensor = constraint_subspace = cast(Any, None)  # seen by type checkers
    inside = property(operator.attrgetter("system"))
    locals().update((name, property(operator.attrgetter(f"free.{name}"))) for name in _SAME.split())

    def __new__(cls, system: Any = None, potential: Any = None, force: Any = None, scheme: str | None = None) -> Any:
        """Return the system with forces; one in coordinates has its own way to take them."""
        if not isinstance(system, AbstractCoordinateSystem):
            return super().__new__(cls)
        choice("Forced(scheme=...)", scheme, (None, "variational"), "In coordinates no other scheme is known.")
        return system.forced(potential, force)

    def __post_init__(self) -> None:
        remedy = "Pass a SuslovTop, a sleigh or an LLSystem."
        system: Any = instance("Forced(system=...)", self.system, AbstractSystem, "be a system on a group", remedy)
        if system.is_forced:  # a table may come later
            refuse_given("Forced", "be left out", "Pass it with the first forces.", potential=(self.potential, None))
            force, scheme = _friction.with_later_force(system, self.force), self.scheme or system.scheme
            self._hold(system.system, system.potential, force, scheme)
        choice("Forced(scheme=...)", self.scheme, (None, *SCHEMES), "Leave it out for the one that keeps most.")
        terms = _friction.terms_of(self.potential)
        for each in terms:
            if callable(each):
                function("Forced(potential=...)", each, "configuration")
            else:
                each.check(self.system.group)
        assign(self, potential=terms if len(terms) > 1 else terms[0] if terms else None)
        parts, dim = _friction.parts_of(self.force), self.system.group.dim
        if "friction" in parts:
            parts["friction"].check(dim)
        _ = self.free  # refused here where rows do not fit
        if "function" in parts:
            function("Forced(force=...)", parts["function"], "time", "configuration", "body_velocity")
        if "table" in parts:
            remedy = "Pass a function of time, configuration and body velocity, Friction, or one body covector a step."
            parts["table"] = array("Forced(force=...)", parts["table"], (None, dim), remedy)
        assign(self, force=_friction.force_of(parts))

    @functools.cached_property
    def terms(self) -> tuple[Any, ...]:
        """The potentials, one by one."""
        return _friction.terms_of(self.potential)

    @property
    def gravity(self) -> Gravity | None:
        """The potential, where it is that of one constant force."""
        return self.potential if isinstance(self.potential, Gravity) else None

    @property
    def own_potential(self) -> Callable[[np.ndarray], Any] | None:
        """The potential that is a function, where there is one."""
        return next(filter(callable, self.terms), None)

    @functools.cached_property
    def parts(self) -> dict[str, Any]:
        """The parts of the force among "friction", "table" and "function", and a "slip" for each contact."""
        return _friction.parts_of(self.force)

    @property
    def friction(self) -> _friction.Friction | None:
        """The viscous friction, where there is one."""
        return self.parts.get("friction")

    @property
    def slips(self) -> tuple[Any, ...]:
        """The contacts whose rows may yield."""
        return _friction.slips_of(self.parts)

    @functools.cached_property
    def contacts(self) -> Contacts:
        """The contacts, with the momenta of their slips."""
        return Contacts(cast(_friction.Widened, self.free).slip_inertia, self.slips)

    @functools.cached_property
    def free(self) -> AbstractSystem:
        """The body that moves without forces: the system inside, without the rows of its constraint that may yield."""
        slips, inside = _friction.slips_of(_friction.parts_of(self.force)), self.system
        return _friction.Widened(inside, *_friction.remaining_rows(inside, slips)) if slips else inside

    @functools.cached_property
    def holding(self) -> AbstractSystem:
        """The system while no row yields."""
        rest = _friction.without_slips(self.parts)
        system = Forced(self.system, self.potential, _friction.force_of(rest), self.scheme)
        return self.system if system.forces is None else system

    @functools.cached_property
    def sliding(self) -> "Forced":
        """The system while rows slide, without the friction of these."""
        rest = {"friction": _friction.Friction(np.zeros(self.group.dim))} | _friction.without_slips(self.parts)
        return Forced(self.free, self.potential, _friction.force_of(rest), "energy")

    @functools.cached_property
    def resistance(self) -> "Forced":
        """The system under what takes energy alone: friction and slips."""
        takes = {name: each for name, each in self.parts.items() if name not in ("table", "function")}
        return Forced(self.system, None, _friction.force_of(takes))

    @property
    def table(self) -> Array | None:
        """The forces of the steps, (steps, dim), where they are given one by one."""
        return self.parts.get("table")

    @property
    def function(self) -> Callable[..., Any] | None:
        """The force of time, pose and velocity, where there is one."""
        return self.parts.get("function")

    @property
    def forces(self) -> "Forced | None":
        """The system itself; None with neither a potential nor a force."""
        return None if self.potential is None and self.force is None else self

    @property
    def names(self) -> str:
        """The name of the forces in errors."""
        return " and ".join(map(name_of, (*self.terms, *self.parts.values())))

    @property
    def needs_function(self) -> bool:
        """Whether a function has to be called, which no store holds."""
        return any(map(callable, (self.own_potential, self.function)))

    @property
    def is_jitted(self) -> bool:
        """Whether numba compiled every function, so that a kernel can call it."""
        return all(hasattr(each, "py_func") for each in (self.own_potential, self.function) if callable(each))

    def is_balanced(self, exact: bool, is_composition: bool = False) -> bool:
        """Whether forces act by equal half impulses at the displacement, the scheme "energy", around a free step.

        Raises:
            ValueError: The free step does not keep its energy.
        """
        if self.slips:
            if not exact or is_composition or self.scheme == "variational":
                got = "another order (in substeps back in time slips add energy), scheme, difference or constraint, "
                got += "or an inertia operator"
                remedy = "Pass a mass tensor, order=2, and leave scheme, difference and constraint out."
                demand = "be discretized with order 2 and the scheme 'energy'"
                raise error("Forced(force=Slip(...))", demand, got, remedy)
            return True
        if self.scheme == "energy" and not exact:
            got = "an inertia operator, a constraint fixed in space, or another difference or constraint"
            remedy = "Leave scheme out, or pass a mass tensor and the default difference and constraint."
            raise error("Forced(scheme='energy')", "belong to a free step that conserves energy", got, remedy)
        if self.scheme is not None or not exact:
            return self.scheme == "energy"
        return is_composition or self.rank < self.group.dim

    @functools.cached_property
    def differences(self) -> tuple[Float[np.ndarray, "dim orders 2 N N"], Float[np.ndarray, "orders"]]:
        """Displacements to and fro along each body direction, and weights: -dU sums what U loses between them."""
        offsets, weights = central_differences(self.group.dim)
        return self.group.exp(offsets), weights

    def potential_energy(self, configuration: Float[Array, "... N N"]) -> Float[Array, "..."]:
        """Return U at configurations; zero without a potential.

        Example:
            >>> heavy = nh.Gravity(force=[0.0, -2.0], point=[0.5, 0.0])
            >>> forced = nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.5), heavy)
            >>> float(forced.potential_energy(nh.SE(2).exp([0.0, 0.0, 3.0])))
            6.0
        """
        g = self._at(configuration)
        if not self.terms:
            return np.zeros(g.shape[:-2])
        energies = (_each(self._value, g) if callable(each) else each.energy(self.group, g) for each in self.terms)
        return functools.reduce(operator.add, energies)

    def potential_force(self, configuration: Float[Array, "... N N"]) -> Float[Array, "... dim"]:
        """Return -dU, body covectors at configurations: by differences of a function, else exact."""
        g = self._at(configuration)
        group, dim = self.group, self.group.dim
        if not self.terms:
            return np.zeros((*g.shape[:-2], dim))
        covectors = (_each(self._slope, g, dim) if callable(each) else each.covector(group, g) for each in self.terms)
        return functools.reduce(operator.add, covectors)

    def mean_force(self, g: Poses, W: Poses, h: Array, constant: Covectors, time: Any = None) -> Covectors:
        r"""Return the covectors f whose impulse $\tfrac h2f$ acts at both ends of a step under the scheme "energy".

        $$ f = -G(g, W) + f_k - C\,X/h + f(t + \tfrac h2, g\,W^{1/2}, X/h), \qquad X = \tfrac12(W - W^{-1}), $$

        with $\langle G, X\rangle = U(gW) - U(g)$: exact of `Gravity`, `Linear` and `Spring`; of a function dU in the
        middle and what it lacks along X. Then $T' - T = \langle f, X\rangle$ (Theorem 18.2).

        Args:
            g: Poses.
            W: Displacements.
            h: Time step.
            constant: Rows of a table.
            time: Times at the beginning of steps, for functions.
        """
        group = self.group
        X = group.vee((W - group.inverse(W)) / 2)
        terms = (each.mean_covector(group, g, W) for each in self.terms if not callable(each))
        f = functools.reduce(operator.add, terms, constant)
        f = f if self.friction is None else f + self.friction.covector(X / h)
        if not self.needs_function:
            return f
        middle = g @ group.exp(group.log(W) / 2)
        if self.own_potential is not None:
            f = f + self._mean_slope(g, W, X, _each(self._slope, middle, group.dim))
        rows = zip(time + h / 2, middle, X / h, strict=True)
        return f + np.reshape([self.driving_force(*row) for row in rows], X.shape)

    def _mean_slope(self, g: np.ndarray, W: np.ndarray, X: np.ndarray, pull: np.ndarray) -> np.ndarray:
        """Return -G of the function, from -dU in the middle."""
        before, after = _each(self._value, g), _each(self._value, g @ W)
        along = applied(np.asarray(self.inertia_operator), X)
        change, twice = after - before + (pull * X).sum(axis=1), (along * X).sum(axis=1)
        is_significant = (twice > 0) & (np.abs(change) > _UNSEEN * (np.abs(before) + np.abs(after)))
        return pull - np.divide(change, twice, out=np.zeros_like(change), where=is_significant)[:, None] * along

    def applied_force(self, time: float, configuration: np.ndarray, body_velocity: np.ndarray) -> np.ndarray:
        """Return f, one body covector, of `Friction`, a function and slips; none of a table, which belongs to steps."""
        force = self.driving_force(time, configuration, body_velocity)
        for one in (one for one in self.slips if one.grip < np.inf):
            v = one.rows @ body_velocity
            force = force - one.rows.T @ (one.grip * v / (np.linalg.norm(v) or 1.0) + one.viscous * v)
        return force if self.friction is None else force + self.friction.covector(body_velocity)

    def driving_force(self, time: float, configuration: np.ndarray, body_velocity: np.ndarray) -> np.ndarray:
        """Return the body covector of the function alone; zero without one."""
        if self.function is None:
            return np.zeros(self.group.dim)
        where, remedy = "Forced(force=...)", "Return a body covector."
        return numbers_of(where, self.function, (self.group.dim,), remedy, float(time), configuration, body_velocity)

    @property
    def all_rows(self) -> Float[Array, "K dim"]:
        """The rows of the table, and a last one of zeros."""
        table = np.zeros((0, self.group.dim)) if self.table is None else self.table
        xp = table.__array_namespace__()
        return xp.concatenate([table, xp.zeros((1, self.group.dim))])

    def rows(self, steps: np.ndarray) -> Float[Array, "K dim"]:
        """Return the rows of the table for numbers of steps from -1; zero before it, after its end, and without one."""
        rows = self.all_rows
        return rows[np.minimum(steps, len(rows) - 1)]

    def propagator(self, E: Float[Array, "... dim k"], tau: Array) -> Float[Array, "3 ... k k"]:
        r"""Return A, V and W of $\dot r = a - Dr$, friction over a time: $r' = Ar + Va$ and $\int r\,dt = Vr + Wa$."""
        k, along = E.shape[-1], E.mT
        C = np.zeros((self.group.dim,) * 2) if self.friction is None else self.friction.matrix
        D = along @ C @ E @ inverse_of(along @ self.inertia_operator @ E)
        xp, nothing = D.__array_namespace__(), 0 * D
        one = nothing + np.eye(k)
        rows = (-D, one, nothing), (nothing, nothing, one), (nothing, nothing, nothing)
        block = xp.concatenate([xp.concatenate(row, axis=-1) for row in rows], axis=-2)
        blocks = exponential_increment(tau * block)[..., :k, :] + np.eye(k, 3 * k)
        return blocks.__array_namespace__().stack([blocks[..., j * k : (j + 1) * k] for j in range(3)])

    def kick_at(self, g: Poses, tau: Array) -> tuple[Array, ...]:
        r"""Return what kicks over a time take from poses: $E$ and $E B^{-1}$, with friction V and W as well."""
        E = self.directions(g)
        to_velocity = E @ inverse_of(E.mT @ self.inertia_operator @ E)
        return E, to_velocity, *(() if self.friction is None else self.propagator(E, tau)[1:])

    def impulse(self, r: Array, constant: Array, tau: Array, kick: tuple[Array, ...]) -> Covectors:
        """Return the impulses of constant body covectors and friction over a time, as `impulses`."""
        if self.friction is None:
            return tau * constant
        E, to_velocity, push, gather = kick
        integral = push @ r[..., None] + gather @ (E.mT @ constant[..., None])
        return tau * constant + self.friction.covector((to_velocity @ integral)[..., 0])

    def impulses(
        self,
        r: Float[np.ndarray, "K k"],
        g: Float[np.ndarray, "K N N"],
        time: Float[np.ndarray, "K"],
        steps: np.ndarray,
        tau: float,
        faults: dict[str, str] | None = None,
    ) -> Float[np.ndarray, "K dim"]:
        r"""Return the impulses j of kicks over a time $\tau$, body covectors; a kick takes r to $r + E^Tj$.

        $$ j = \tau\,\bigl(-dU + f_k + f(t, g, E B^{-1}(r + r')/2)\bigr) - C\,E B^{-1}\!\int_0^\tau\! r\,dt,
           \quad B = E^T\mathbb{I}E: $$

        by the midpoint rule for a function, exact for friction. A kick over $-\tau$ takes back the kick over $\tau$.

        Args:
            r: Momenta before the kicks, along the rows of the constraint subspace; after them for a negative time.
            g: Poses.
            time: Times of the nodes.
            steps: Numbers of the steps, whose row of a table acts.
            tau: Half a time step, or its negative.
            faults: Gets what a force says that is not finite: its impulse is NaN then.
        """
        constant, faults = self.potential_force(g) + self.rows(steps), {} if faults is None else faults
        if self.function is None and self.friction is None:
            return tau * constant
        kicks = self.kick_at(g, tau)
        if self.function is None:
            return self.impulse(r, constant, tau, kicks)
        covectors = np.empty((len(r), self.group.dim))
        each = zip(*(np.broadcast_to(x, (len(r), *x.shape[-2:])) for x in kicks), strict=True)
        for k, kick in enumerate(each):

            def impulse(velocity: np.ndarray, k: int = k, kick: tuple[Array, ...] = kick) -> np.ndarray:
                force = np.full(self.group.dim, np.nan)
                with note_fault(faults, "force"):
                    force = self.driving_force(time[k], g[k], velocity)
                return self.impulse(r[k], constant[k] + force, tau, kick)

            covectors[k] = midpoint_impulse(impulse, r[k], *kick[:2])
        return covectors

    def work(self, time: np.ndarray, g: np.ndarray, velocity: np.ndarray, step: np.ndarray) -> Float[np.ndarray, "K"]:
        """Return the work of the force along states of steps since the first, by the trapezoidal rule."""
        power = np.zeros(max(0, len(time) - 1))
        if self.table is not None:
            power += ((velocity[:-1] + velocity[1:]) * self.rows(step[:-1])).sum(axis=1) / 2
        if self.parts.keys() - {"table"}:
            now = np.array([self.applied_force(*row) @ row[2] for row in zip(time, g, velocity, strict=True)])
            power += (now[:-1] + now[1:]) / 2
        return np.concatenate([np.zeros(min(1, len(time))), np.cumsum(np.diff(time) * power)])

    def _at(self, configuration: Float[Array, "... N N"]) -> Float[Array, "... N N"]:
        where, shape = "Forced (configuration=...)", (self.group.size, self.group.size)
        return trailing(where, configuration, shape, "Pass the matrix of a pose.", real=True)

    def _value(self, g: np.ndarray) -> np.float64:
        return number_of("Forced(potential=...)", cast(Any, self.own_potential), "Return U of a configuration.", g)

    def _slope(self, g: np.ndarray) -> np.ndarray:
        moves, weights = self.differences
        values = _each(self._value, g @ moves)
        return (values[..., 1] - values[..., 0]) @ weights


def central_differences(dim: int) -> tuple[Float[np.ndarray, "dim orders 2 dim"], Float[np.ndarray, "orders"]]:
    """Return offsets to and fro along each direction, and the weights of what a function loses between them."""
    offsets = _OFFSET * np.arange(1, 1 + len(_DIFFERENCES))[:, None] * np.eye(dim)[:, None]
    return np.stack([offsets, -offsets], axis=2), _DIFFERENCES


def _each(function: Callable[[np.ndarray], Any], g: np.ndarray, *shape: int) -> np.ndarray:
    """Return the values of a function of one matrix, which have a shape, at all of them."""
    return np.reshape([function(each) for each in g.reshape(-1, *g.shape[-2:])], (*g.shape[:-2], *shape))


def midpoint_impulse(
    impulse_at: Function, r: Float[np.ndarray, "k"], E: Float[np.ndarray, "dim k"], to_velocity: np.ndarray
) -> Float[np.ndarray, "dim"]:
    """Return the impulse at the velocity of the mean of the momenta before and after it; NaN where there is none.

    Raises:
        OutcomeError: There is no such impulse nearby.
    """

    def impulse(after: np.ndarray) -> np.ndarray:
        return impulse_at(to_velocity @ ((r + after) / 2))

    def residual(after: np.ndarray) -> np.ndarray:
        return r + E.T @ impulse(after) - after

    def slope_at(after: np.ndarray) -> np.ndarray:
        slopes = [E.T @ (impulse(after + x) - impulse(after - x)) / (2 * x.max()) for x in offsets]
        return np.eye(len(r)) - np.nan_to_num(np.transpose(slopes))

    first = E.T @ impulse(r)
    offsets = _DIFFERENCE * (np.abs(np.append(r, first)).max() or 1.0) * np.eye(len(r))
    slope = slope_at(r)
    after = _root(residual, lambda _: slope, r, r + np.nan_to_num(first), _ITERATIONS, shortens=False)
    if after is None:
        after = _root(residual, slope_at, r, r, _MOST, shortens=True)
    if after is None:
        raise OutcomeError(Outcome.no_half_impulse, "Half impulse of a force that depends on the velocity")
    return impulse(after)


def _root(
    residual: Function, slope_at: Function, r: np.ndarray, after: np.ndarray, most: int, *, shortens: bool
) -> np.ndarray | None:
    """Return the momenta after the impulse by Newton's method, which may halve corrections that miss more; or None."""
    for _ in range(most):
        gap = residual(after)
        left = np.abs(gap).max()
        if not left < np.inf:
            return np.full_like(r, np.nan) if shortens else None
        change, parts = np.linalg.lstsq(slope_at(after), gap)[0], _PARTS if shortens else _PARTS[:1]
        if left <= _ROUNDING * np.abs(np.append(r, after)).max():
            return after + change
        better = (part for part in parts if not shortens or np.abs(residual(after + part * change)).max() < left)
        if (part := next(better, None)) is None:
            return None
        after = after + part * change
    return None
