"""A system in coordinates: a Lagrangian, constraint forms, and the rule that discretizes both."""

import dataclasses
import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar

import jax
import numpy as np

from nonholo.base.calls import call
from nonholo.base.checks import array, assign, choice, count, error, names, shown, text, within_memory
from nonholo.base.types import Array, Float
from nonholo.lagrange_dalembert import functions as tracing
from nonholo.lagrange_dalembert._places import Coordinates

if TYPE_CHECKING:
    from nonholo.lagrange_dalembert._discretization import CoordinateDiscretization  # noqa: F401  (named by the base)
    from nonholo.lagrange_dalembert._orbit import CoordinateOrbit  # noqa: F401  (named by the base class)

Parts = tuple[Float[np.ndarray, "P 2"], ...]
_REMEDY = "Pass the corners of each part in body axes: [[(-0.1, -0.1), (0.2, 0.0), (-0.1, 0.1)], ...]."


@dataclasses.dataclass(frozen=True)
class LagrangeDAlembert(tracing.AbstractParametricSystem["CoordinateDiscretization", "CoordinateOrbit"]):
    r"""A mechanical system on $\mathbb{R}^n$ with linear velocity constraints, and its discrete principle.

    $$ \frac{d}{dt}\frac{\partial L}{\partial v} - \frac{\partial L}{\partial q} = \sum_j \lambda_j A^j(q), \qquad
       A(q)\,v = 0; \qquad P_{k+1} - P^+_k = \sum_j \lambda_j A^j(q_{k+1}), \qquad F(q_k, q_{k+1}) = 0, $$

    where $P_k = -D_1 L_d(q_k, q_{k+1})$ and $P^+_k = D_2 L_d(q_k, q_{k+1})$. With v = (q' - q)/h the rule "midpoint" is
    $L_d = h L((q + q')/2, v)$, $F = A((q + q')/2) v$; "trapezoidal" takes the means of L and A over both ends.
    Nothing needs to be invariant under a group. A system keeps the numbers that its functions read when it is made, of
    globals and arrays; a function under `jax.jit` those of its first call, a rule of JAX.

    A *driven* system has constraints $A(q, t)\,v = b(q, t)$, prescribed coordinates, a Lagrangian of the time or a
    force f(t, q, v), or it has holonomic constraints of the time: then
    $P_k = -D_1L_d - f^-_k$ and $P^+_k = D_2L_d + f^+_k$ with half the impulse of a step at each of its
    ends, $f^-_k = \tfrac h2f(t_k, q_k, v)$, $f^+_k = \tfrac h2f(t_{k+1}, q_{k+1}, v)$. The map is of order 2.

    *Holonomic* constraints $\Phi(q, t) = 0$, as a closed loop or a wheel on the ground, hold at each node to rounding:
    $\Phi(q_{k+1}, t_{k+1}) = 0$ stands beside F, rows $\partial\Phi_j/\partial q$ beside $A^j$, and the principle is
    the same: nothing is projected. Without other constraints the map is the variational integrator on the surface
    $\Phi = 0$ (SHAKE, for a constant mass matrix and "trapezoidal"); flows are kept on it.

    Reference: [cortes-martinez-2001]; [fedorov-zenkov-2004], section 2. The signs: docs/theory, "lagrange-dalembert".

    Args:
        lagrangian: `lagrangian(q, v)` or `lagrangian(q, v, time)` -> scalar, written with `jax.numpy`.
        constraint_forms: `constraint_forms(q)` or `constraint_forms(q, time)` -> (s, n), the rows $A^j$; None for an
            unconstrained system.
        holonomic: `holonomic(q)` or `holonomic(q, time)` -> (m,), the constraints $\Phi$ of places; their multipliers
            come after those of the forms.
        dimension: n.
        rule: "midpoint" or "trapezoidal".
        discrete_lagrangian: `discrete_lagrangian(q, q_next, time_step)` -> scalar, in place of the rule; it includes
            the factor time_step. Or `discrete_lagrangian(q, q_next)`, made for one time step; the energy of an orbit
            is then that of the Lagrangian at the midpoint.
        discrete_constraints: `discrete_constraints(q, q_next, time_step)` or `(q, q_next)` -> (s,), in place of the
            rule of the constraint forms.
        constraint_velocities: `constraint_velocities(q, time)` -> (s,), the right-hand side b of moving constraints.
        prescribed: Motions s(time) of coordinates, by index: joints that are driven. Discrete motions follow them
            exactly; their multipliers, the last ones, are the driving forces.
        force: `force(time, q, v)` -> (n,); or `nonholo.Friction`; or an array (steps, n), whose row k acts over step k;
            or a tuple with at most one of each; and `nonholo.Slip` of forms that may yield, `rows=[[0.0, 1.0]]` for the
            second of two, one row for each form, one `Slip` for each contact.
            `nonholo.Forced(system, potential, force)` adds one.
        parameters: Numbers or arrays by name, p. Where there are any, every function takes them as its last argument, a
            dictionary with these names: `lagrangian(q, v, p)` or `(q, v, time, p)`, `constraint_forms(q, p)` or
            `(q, time, p)` and so `holonomic`, `discrete_lagrangian(q, q_next, time_step, p)`,
            `constraint_velocities(q, time, p)`, `force(time, q, v, p)`, prescribed motions `s(time, p)`,
            `outline(q, p)`. They are compiled once for all numbers: see `with_parameters`.
        coordinates: Names of the coordinates, for tables and pictures, such as ("x", "y", "theta"); by default "q1",
            "q2" and so on.
        name: The name of the system in pictures.
        heading: The name of the coordinate that is the heading of a body with the coordinates x and y.
        outline: The drawing of such a body in pictures: parts of at least two points (P, 2) in body axes, x ahead, the
            body first, then its parts, such as wheels; or a function of q that returns them.

    Raises:
        ValueError: A function that JAX cannot trace, that does not take the parameters there are, or whose result is
            not real or has the wrong shape; an unknown rule; own discrete functions where L or A has the time; names
            that are not n different words; a heading that is not among them, an outline that is no drawing.

    Example:
        A particle in space with the constraint z' = y x':

        >>> import jax.numpy as jnp
        >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
        >>> def forms(q):
        ...     return jnp.array([[-q[1], 0.0, 1.0]])
        >>> particle = LagrangeDAlembert(lambda q, v: v @ v / 2, forms, dimension=3)
        >>> discrete = nh.discretize(particle, time_step=0.1)
        >>> orbit = nh.simulate(discrete, configuration=(0, 0, 0), body_velocity=(1, 1, 0), steps=100)
        >>> orbit.configuration.shape, bool(orbit.constraint_residual.max() < 1e-13)
        ((101, 3), True)

        A pendulum in Cartesian coordinates; twice the multiplier over the time step is the force of its rod:

        >>> def length(q):
        ...     return jnp.array([q @ q - 1.0])
        >>> pendulum = LagrangeDAlembert(lambda q, v: v @ v / 2 - q[1], None, holonomic=length, dimension=2)
        >>> start = {"configuration": (0.6, -0.8), "body_velocity": (0, 0)}
        >>> swing = nh.simulate(nh.discretize(pendulum, 0.1), **start, steps=1000)
        >>> bool(abs((swing.configuration**2).sum(axis=1) - 1).max() < 1e-15)
        True
    """

    lagrangian: Callable[..., Array]
    constraint_forms: Callable[..., Array] | None
    holonomic: Callable[..., Array] | None = dataclasses.field(default=None, kw_only=True)
    dimension: int = dataclasses.field(kw_only=True)
    rule: str = dataclasses.field(default="midpoint", kw_only=True)
    discrete_lagrangian: Callable[..., Array] | None = dataclasses.field(default=None, kw_only=True)
    discrete_constraints: Callable[..., Array] | None = dataclasses.field(default=None, kw_only=True)
    constraint_velocities: Callable[..., Array] | None = dataclasses.field(default=None, kw_only=True)
    prescribed: Any = dataclasses.field(default=(), kw_only=True)
    force: Any = dataclasses.field(default=None, kw_only=True)
    parameters: Any = dataclasses.field(default_factory=dict, kw_only=True)
    coordinates: tuple[str, ...] = dataclasses.field(default=(), kw_only=True)
    name: str = dataclasses.field(default="System in coordinates", kw_only=True)
    functions: ClassVar[tuple[str, ...]] = (
        *("lagrangian", "constraint_forms", "holonomic"),
        *("discrete_lagrangian", "discrete_constraints", "constraint_velocities"),
    )
    of_time: ClassVar[dict[str, int]] = {"lagrangian": 2, "constraint_forms": 1, "holonomic": 1}
    orbits: ClassVar[str] = "CoordinateOrbit"
    in_stores: ClassVar[tuple[str, ...]] = ("constraints", "is_driven", "orbits", "shapes")
    has_limit: ClassVar[bool] = False
    heading: str | None = dataclasses.field(default=None, kw_only=True, compare=False)
    outline: Any = dataclasses.field(default=(), kw_only=True, compare=False, repr=False, metadata={"stored": False})

    def __post_init__(self) -> None:
        dimension = count(_argument("dimension"), self.dimension, "Pass the number of coordinates.")
        within_memory(_argument("dimension"), 8.0 * dimension**2, "Pass the number of coordinates.")  # the mass matrix
        coordinates = tuple(f"q{i}" for i in range(1, dimension + 1))
        if not isinstance(self.coordinates, tuple) or self.coordinates:
            coordinates = names(_argument("coordinates"), self.coordinates, dimension)
        assign(self, dimension=dimension, parameters=tracing.Parameters(self.parameters), coordinates=coordinates)
        text(_argument("name"), self.name)
        _check_heading(_argument("heading"), self.heading, self.coordinates)
        if not callable(self.outline):
            assign(self, outline=_as_parts(_argument("outline"), self.outline))
        choice(_argument("rule"), self.rule, ("midpoint", "trapezoidal"))
        for name in ("discrete_lagrangian", "discrete_constraints"):
            assign(self, **{name: tracing.with_time_step(getattr(self, name), len(self._shapes_given))})
        assign(self, prescribed=_motions(self.prescribed, dimension, self._shapes_given))
        n, of = dimension, f"{dimension} coordinates"
        q, time = jax.ShapeDtypeStruct((n,), float), jax.ShapeDtypeStruct((), float)
        self._trace("lagrangian", of, (q, q), tracing.checked_value, (), of)
        stack = "Stack one row per constraint; pass None for no constraint."
        self._trace("constraint_forms", of, (q,), tracing.checked_rows, n - 1, (n,), stack)
        stack = "Return one number per constraint, jnp.array([...]); pass None for no constraint."
        self._trace("holonomic", of, (q,), tracing.checked_rows, n, (), stack)
        self._trace("discrete_lagrangian", of, (q, q, time), tracing.checked_value, (), of)
        self._trace("discrete_constraints", of, (q, q, time), tracing.checked_value, (self.velocity_constraints,), of)
        self._trace("constraint_velocities", of, (q, time), tracing.checked_value, (self.velocity_constraints,), of)
        self._check_force(of, q, q)
        self._check_slips(self.discrete_lagrangian, self.discrete_constraints)
        moves = self.constraint_velocities is not None or any(map(self.takes_time, self.of_time))
        if moves and (self.discrete_lagrangian or self.discrete_constraints):
            remedy = 'Use rule="midpoint" or "trapezoidal".'
            where, demand = _argument("discrete_lagrangian"), "be left out where L or A has the time"
            raise error(where, demand, "discrete functions", remedy)

    @property
    def places(self) -> Coordinates:
        """Where it moves."""
        return Coordinates(self.dimension, self.is_driven)

    def parts(self, q: Any) -> tuple[Float[np.ndarray, "P 2"], ...]:
        """Return the parts of the outline at a configuration, in body axes."""
        where, last = _argument("outline"), (self.parameters,) if self.parameters else ()
        return _as_parts(where, call(where, self.outline, q, *last) if callable(self.outline) else self.outline)

    @property
    def shapes(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Shapes of a configuration and of a velocity."""
        return (self.dimension,), (self.dimension,)

    def forced(self, potential: Any, force: Any) -> "LagrangeDAlembert":
        """Return the system with a potential U(q) and a force; itself with neither. `nonholo.Forced` calls it.

        Both may take the parameters of the system last, or do without.
        """
        if potential is None and force is None:
            return self
        force, lagrangian = self._with_force(force), self.lagrangian
        potential = tracing.with_parameters(potential, 1) if self.parameters else potential
        if potential is not None:
            q, of = jax.ShapeDtypeStruct((self.dimension,), float), f"{self.dimension} coordinates"
            potential = tracing.checked_value("Forced(potential=...)", potential, of, (q, *self._shapes_given), (), of)
            lagrangian = _with_potential(lagrangian, potential, last=bool(self.parameters))
        return dataclasses.replace(self, lagrangian=lagrangian, force=force)

    def regularity(self, q: Any, q_next: Any, *, time_step: float = 1.0) -> float:
        r"""Return the smallest singular value of the scaled regularity matrix; zero at a fold of the map.

        $$ \begin{pmatrix} -h\,D_2 D_1 L_d & -A(q)^T \\ h\,D_2 F & 0 \end{pmatrix} $$

        is made free of units: coordinates are measured in units of $|\partial^2 L/\partial v_i^2|^{-1/2}$ and the rows
        of A and D_2 F have length one. For h -> 0 and L = v.v/2 it tends to 1 without constraints, and to
        $(\sqrt5 - 1)/2$ with orthogonal constraint rows. Where it is not zero, the next step is locally unique.

        Args:
            q: Configuration.
            q_next: The next configuration.
            time_step: h > 0; `discretize(h)` has this method with its own.

        Raises:
            ValueError: A wrong shape, a value that is not finite, a time step that is not positive.

        Example:
            >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
            >>> free = LagrangeDAlembert(lambda q, v: 3 * v @ v, None, dimension=2)
            >>> round(free.regularity((0, 0), (1, 2), time_step=0.5), 12)
            1.0
        """
        return tracing.room("_start").regularity(self, q, q_next, time_step)


def _with_potential(lagrangian: Callable[..., Array], potential: Any, *, last: bool) -> Callable[..., Array]:
    """Return a Lagrangian less a potential; both may take parameters last."""

    @functools.wraps(lagrangian)  # whose signature says whether the time is passed
    def less(q: Array, v: Array, *rest: Any) -> Array:
        return lagrangian(q, v, *rest) - potential(q, *(rest[-1:] if last else ()))

    return less


def _motions(motions: Any, dimension: int, last: tuple[Any, ...]) -> tuple[tuple[int, Callable[[Array], Array]], ...]:
    """Return prescribed motions as pairs of index and function, in the order of the coordinates."""
    where = _argument("prescribed")
    try:
        of_index = dict(motions)
    except (TypeError, ValueError):
        raise error(where, "be functions by index", shown(motions), "Pass {2: lambda time: jnp.sin(time)}.") from None
    time, motion_of = jax.ShapeDtypeStruct((), float), {}
    for index, motion in of_index.items():
        if not isinstance(index, int) or not 0 <= index < dimension:
            raise error(where, f"have indices from 0 to {dimension - 1}", shown(index), "Name coordinates by index.")
        motion_of[index] = tracing.checked_value(where, motion, "the time", (time, *last), (), "the time")
    return tuple(sorted(motion_of.items()))


def _argument(argument: str) -> str:
    return f"LagrangeDAlembert({argument}=...)"


def _check_heading(where: str, heading: Any, coordinates: tuple[str, ...]) -> None:
    """Refuse a heading that is no coordinate of a body with a place in the plane."""
    if heading is not None and not {"x", "y", heading} <= set(coordinates) - ({heading} & {"x", "y"}):
        remedy = 'Name the coordinates: coordinates=("x", "y", "theta"), heading="theta".'
        raise error(where, f"be a coordinate beside x and y of {', '.join(coordinates)}", shown(heading), remedy)


def _as_parts(where: str, value: Any) -> Parts:
    """Return the parts of an outline, at least two points each."""
    try:
        rows = tuple(value)
    except TypeError:
        raise error(where, "be a list of parts", shown(value), _REMEDY) from None
    parts = tuple(array(where, part, (None, 2), _REMEDY) for part in rows)
    if any(len(part) < 2 for part in parts):
        raise error(where, "have parts of at least two points", "one point", _REMEDY)
    return parts
