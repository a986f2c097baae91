"""A system in coordinates: a Lagrangian, constraint forms, and the rule that discretizes both."""

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar

import jax

from nonholo.base.checks import choice, count, error, shown, text
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array
from nonholo.lagrange_dalembert._room import room
from nonholo.lagrange_dalembert._tracing import check_forms, check_value, count_of, with_time_step
from nonholo.systems import AbstractCoordinateSystem

_TAKEN = {"constraint_residual", "energy", "t", "time"}  # columns of their own

if TYPE_CHECKING:
    from nonholo.lagrange_dalembert._discretization import CoordinateDiscretization
    from nonholo.lagrange_dalembert._orbit import CoordinateOrbit


@dataclasses.dataclass(frozen=True)
class LagrangeDAlembert(AbstractCoordinateSystem["CoordinateDiscretization", "CoordinateOrbit"]):
    r"""A mechanical system on $\mathbb{R}^n$ with linear velocity constraints, and its discrete principle.

    $$ \frac{d}{dt}\frac{\partial L}{\partial v} - \frac{\partial L}{\partial q} = \sum_j \lambda_j A^j(q), \qquad
       A(q)\,v = 0; \qquad P_{k+1} - P^+_k = \sum_j \lambda_j A^j(q_{k+1}), \qquad F(q_k, q_{k+1}) = 0, $$

    where $P_k = -D_1 L_d(q_k, q_{k+1})$ and $P^+_k = D_2 L_d(q_k, q_{k+1})$. With v = (q' - q)/h the rule "midpoint" is
    $L_d = h L((q + q')/2, v)$, $F = A((q + q')/2) v$; "trapezoidal" takes the means of L and A over both ends.
    Nothing needs to be invariant under a group.

    Reference: [cortes-martinez-2001]; [fedorov-zenkov-2004], section 2. The signs: docs/theory, "lagrange-dalembert".

    Args:
        lagrangian: `lagrangian(q, v)` -> scalar, written with `jax.numpy`.
        constraint_forms: `constraint_forms(q)` -> (s, n), the rows $A^j(q)$; None for an unconstrained system.
        dimension: n.
        rule: "midpoint" or "trapezoidal".
        discrete_lagrangian: `discrete_lagrangian(q, q_next, time_step)` -> scalar, in place of the rule; it includes
            the factor time_step. Or `discrete_lagrangian(q, q_next)`, made for one time step; the energy of an orbit
            is then that of the Lagrangian at the midpoint.
        discrete_constraints: `discrete_constraints(q, q_next, time_step)` or `(q, q_next)` -> (s,), in place of the
            rule.
        coordinates: Names of the coordinates, for tables and pictures, such as ("x", "y", "theta"); by default "q1",
            "q2" and so on.
        name: What pictures call the system.

    Raises:
        ValueError: A function that JAX cannot trace, or whose result is not real or has the wrong shape; an unknown
            rule; names that are not n different words.

    Example:
        A particle in space with the constraint z' = y x':

        >>> import jax.numpy as jnp
        >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
        >>> def forms(q):
        ...     return jnp.array([[-q[1], 0.0, 1.0]])
        >>> particle = LagrangeDAlembert(lambda q, v: v @ v / 2, forms, dimension=3)
        >>> discrete = particle.discretize(time_step=0.1)
        >>> orbit = discrete.simulate(configuration=(0, 0, 0), body_velocity=(1, 1, 0), steps=100)
        >>> orbit.configuration.shape, bool(orbit.constraint_residual.max() < 1e-13)
        ((101, 3), True)
    """

    lagrangian: Callable[[Array, Array], Array]
    constraint_forms: Callable[[Array], Array] | None
    dimension: int = dataclasses.field(kw_only=True)
    rule: str = dataclasses.field(default="midpoint", kw_only=True)
    discrete_lagrangian: Callable[[Array, Array, Array], Array] | None = dataclasses.field(default=None, kw_only=True)
    discrete_constraints: Callable[[Array, Array, Array], Array] | None = dataclasses.field(default=None, kw_only=True)
    coordinates: tuple[str, ...] = dataclasses.field(default=(), kw_only=True)
    name: str = dataclasses.field(default="System in coordinates", kw_only=True)
    _equations: ClassVar[str] = "_equations"

    def __post_init__(self) -> None:
        dimension = count(_named("dimension"), self.dimension, "Pass the number of coordinates.")
        object.__setattr__(self, "dimension", dimension)
        object.__setattr__(self, "coordinates", _names(self.coordinates, dimension))
        text(_named("name"), self.name)
        choice(_named("rule"), self.rule, ("midpoint", "trapezoidal"))
        object.__setattr__(self, "discrete_lagrangian", with_time_step(self.discrete_lagrangian))
        object.__setattr__(self, "discrete_constraints", with_time_step(self.discrete_constraints))
        with double_precision():
            q, h = jax.ShapeDtypeStruct((self.dimension,), float), jax.ShapeDtypeStruct((), float)
            self._check("lagrangian", (), q, q)
            if self.constraint_forms is not None:
                where, remedy = _named("constraint_forms"), "Stack one row per constraint; pass None for no constraint."
                check_forms(where, self.constraint_forms, self.dimension, q, f"{self.dimension} coordinates", remedy)
            self._check("discrete_lagrangian", (), q, q, h)
            self._check("discrete_constraints", (self.constraints,), q, q, h)

    def _check(self, name: str, shape: tuple[int, ...], *arguments: Any) -> None:
        function, of = getattr(self, name), f"{self.dimension} coordinates"
        if function is not None or name == "lagrangian":
            check_value(_named(name), function, shape, arguments, of, of)

    @property
    def constraints(self) -> int:
        """The number s of constraints."""
        return count_of(self.constraint_forms, (self.dimension,))

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
        return room("_start").regularity(self, q, q_next, time_step)

    def discretize(self, time_step: float) -> "CoordinateDiscretization":
        """Return the discrete map with this time step.

        Args:
            time_step: h > 0.

        Raises:
            ValueError: A time step that is not positive.

        Example:
            >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
            >>> LagrangeDAlembert(lambda q, v: v @ v, None, dimension=2).discretize(0.1).time_step
            0.1
        """
        return room("_discretization").CoordinateDiscretization(self, time_step)

    def flow(
        self,
        *,
        configuration: Any,
        times: Any,
        body_velocity: Any = None,
        momentum: Any = None,
        rtol: float = 1e-10,
        atol: float = 1e-12,
    ) -> "CoordinateOrbit":
        r"""Solve the continuous Lagrange-d'Alembert equations.

        $$ \dot p = \frac{\partial L}{\partial q} + \sum_j \lambda_j A^j(q), \qquad p = \frac{\partial L}{\partial v},
           \qquad A(q)\,v = 0. $$

        The acceleration comes from the constraint differentiated once. Velocities are projected to the constraint,
        orthogonally in the kinetic energy, at each evaluation and at each requested time; an adaptive Runge-Kutta
        method of order 8 steps to every requested time.

        Args:
            configuration: The first configuration.
            times: The times of the states, at least one, increasing or decreasing; the start is at the first.
            body_velocity: Start with this velocity, which must satisfy the constraint.
            momentum: Start with this momentum; only its action on admissible velocities counts.
            rtol: Relative error of a step, at least 1e-14.
            atol: Absolute error of a step.

        Returns:
            The orbit. It has no displacements, and its multipliers are the forces at its times.

        Raises:
            ValueError: A bad argument, before any work.
            OutcomeError: The solver could not meet the tolerances; its `orbit` holds every good state.

        Example:
            >>> from nonholo.lagrange_dalembert import LagrangeDAlembert
            >>> spring = LagrangeDAlembert(lambda q, v: (v @ v - q @ q) / 2, None, dimension=1)
            >>> orbit = spring.flow(configuration=[1], body_velocity=[0], times=[0, np.pi])
            >>> print(orbit.configuration[-1].round(9))
            [-1.]
        """
        starts = {"body_velocity": body_velocity, "momentum": momentum}
        kind, start = room("_orbit").CoordinateOrbit, room("_start").of_flow
        return room("_flow").flow(kind, self, start, configuration, starts, times, rtol, atol)


def _named(argument: str) -> str:
    return f"LagrangeDAlembert({argument}=...)"


def _names(names: Any, n: int) -> tuple[str, ...]:
    """Return the names of the coordinates: by default q1 and so on."""
    if isinstance(names, tuple) and not names:
        return tuple(f"q{i}" for i in range(1, n + 1))
    words = set(filter(_is_word, names)) if isinstance(names, tuple | list) else set()
    if len(words) != n or len(names) != n:
        remedy = 'Pass words such as ("x", "y", "theta"), none of them ' + ", ".join(sorted(_TAKEN)) + "."
        raise error(_named("coordinates"), f"be {n} different words", shown(names), remedy)
    return tuple(names)


def _is_word(name: Any) -> bool:
    return isinstance(name, str) and name.isascii() and name.isidentifier() and name not in _TAKEN
