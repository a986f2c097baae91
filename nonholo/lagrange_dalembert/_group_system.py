"""A system on a group whose Lagrangian is left-invariant and whose constraints need not be."""

import dataclasses
import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, ClassVar, cast

import jax
import jax.numpy as jnp
import numpy as np

from nonholo.base.checks import assign, instance, text
from nonholo.base.numerics import double_precision
from nonholo.base.types import Array, Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.lagrange_dalembert import functions as tracing
from nonholo.lagrange_dalembert._places import Poses
from nonholo.systems import checked_group, group_mass_tensor, inertia_form, terms_of

if TYPE_CHECKING:
    from nonholo.lagrange_dalembert._discretization import GroupDiscretization  # noqa: F401  (named by the base class)
    from nonholo.lagrange_dalembert._orbit import GroupOrbit  # noqa: F401  (named by the base class)


@dataclasses.dataclass(frozen=True)
class GroupLagrangeDAlembert(tracing.AbstractParametricSystem["GroupDiscretization", "GroupOrbit"]):
    r"""A left-invariant Lagrangian on a matrix group with velocity constraints that may depend on the configuration.

    $$ \dot p = \mathrm{ad}^*_\omega p + \sum_j\lambda_j a^j(g), \quad p = \frac{\partial l}{\partial\omega}, \qquad
       a(g)\,\omega = 0, \qquad \dot g = g\,\omega; $$
    $$ P_{k+1} - \mathrm{Ad}^*_{W_k}P_k = \sum_j\lambda_j a^j(g_{k+1}), \quad P_k = P(W_k), \qquad F(g_k, W_k) = 0,
       \qquad g_{k+1} = g_k W_k, $$

    with $\langle P(W), x\rangle = \tfrac{d}{d\varepsilon}l_d(e^{\varepsilon x}W)|_0$. Forms that do not depend on g
    give `LLSystem`, forms $a(g) = \mathrm{Ad}^*_g\alpha$ give `LRSystem`; then those are the faster choice.

    The default F is the midpoint rule

    $$ F(g, W) = a\bigl(g\,e^{(\log W)/2}\bigr)\,\log W/h . $$

    It is second-order accurate, and $F(gW, W^{-1}) = -F(g, W)$: with an l_d for which $l_d(W^{-1}) = l_d(W)$ the map is
    reversible. Neither the discrete map's energy nor any momentum is conserved in general.

    Reference: [fedorov-zenkov-2004], sections 2 and 3; docs/theory, "lagrange-dalembert-on-groups".

    Args:
        group: The group.
        discrete_lagrangian: `discrete_lagrangian(W, time_step)` -> scalar, written with `jax.numpy`; it includes the
            factor time_step. `mass_tensor_lagrangian` makes that of a rigid body.
        constraint_forms: `constraint_forms(g)` -> (s, dim), the rows $a^j(g)$ in body coordinates; None for none.
        discrete_constraints: `discrete_constraints(g, W, time_step)` -> (s,), in place of the midpoint rule.
        lagrangian: `lagrangian(body_velocity)` -> scalar, the limit of $l_d(e^{h\omega})/h$; only needed for `flow`
            and for starts from a velocity or a momentum, and only if it is not a quadratic form.
        potential: `potential(g)` -> scalar, U; steps take it at both ends, $l_d(W) - \tfrac h2(U(g) + U(gW))$.
            `nonholo.Forced(system, potential, force)` adds it, or `Gravity`, `Linear`, `Spring`, or a tuple of them.
        force: `force(time, g, body_velocity)` -> (dim,), a body covector; or `nonholo.Friction`; or an array (steps,
            dim), whose row k acts over step k; or a tuple with at most one of each. Half the impulse of a step acts at
            each of its ends, as in coordinates. And `nonholo.Slip` of forms that may yield, as there.
        parameters: Numbers or arrays by name, p, which all functions take last, `constraint_forms(g, p)`: see
            `LagrangeDAlembert` and `with_parameters`.
        name: The name of the system in pictures.

    Raises:
        ValueError: Something that is no group; a function that JAX cannot trace, or whose value has the wrong shape.

    Example:
        A sleigh in the plane whose blade turns in the body as the body moves along x:

        >>> import jax.numpy as jnp
        >>> from nonholo.lagrange_dalembert import GroupLagrangeDAlembert, mass_tensor_lagrangian
        >>> def forms(g):
        ...     return jnp.array([[0.0, -jnp.sin(g[0, 2]), jnp.cos(g[0, 2])]])
        >>> action = mass_tensor_lagrangian(nh.SE(2), nh.ChaplyginSleigh(1.0, 0.5, a=0.3).homogeneous_mass_tensor)
        >>> sleigh = GroupLagrangeDAlembert(nh.SE(2), action, forms)
        >>> orbit = nh.simulate(nh.discretize(sleigh, 0.1), body_velocity=(0.5, 1.0, 0.0), steps=100)
        >>> orbit.configuration.shape, bool(orbit.constraint_residual.max() < 1e-13)
        ((101, 3, 3), True)
    """

    group: AbstractMatrixGroup
    discrete_lagrangian: Callable[..., Array] = dataclasses.field(repr=False)
    constraint_forms: Callable[..., Array] | None = dataclasses.field(repr=False)
    discrete_constraints: Callable[..., Array] | None = dataclasses.field(default=None, repr=False)
    lagrangian: Callable[..., Array] | None = dataclasses.field(default=None, kw_only=True, repr=False)
    potential: Callable[..., Array] | None = dataclasses.field(default=None, kw_only=True, repr=False)
    force: Any = dataclasses.field(default=None, kw_only=True)
    parameters: Any = dataclasses.field(default_factory=dict, kw_only=True)
    name: str = dataclasses.field(default="Constraints that depend on the pose", kw_only=True)
    functions: ClassVar[tuple[str, ...]] = (
        *("discrete_lagrangian", "constraint_forms", "discrete_constraints"),
        *("lagrangian", "potential"),
    )
    coordinates: ClassVar[tuple[str, ...]] = ()
    orbits: ClassVar[str] = "GroupOrbit"
    in_stores: ClassVar[tuple[str, ...]] = ("constraints", "coordinates", "is_driven", "orbits", "shapes")
    rule: ClassVar[str] = "midpoint"
    has_limit: ClassVar[bool] = True
    prescribed: ClassVar[tuple[()]] = ()
    holonomic = constraint_velocities = cast(Any, None)

    def __post_init__(self) -> None:
        remedy = "Pass nonholo.SO(n), SE(n), MatrixGroup or a product."
        instance("GroupLagrangeDAlembert(group=...)", self.group, AbstractMatrixGroup, "be a matrix group", remedy)
        text("GroupLagrangeDAlembert(name=...)", self.name)
        assign(self, parameters=tracing.Parameters(self.parameters, type(self).__name__))
        g = jax.ShapeDtypeStruct((self.group.size, self.group.size), float)
        n, h = self.group.dim, jax.ShapeDtypeStruct((), float)
        self._trace_at("discrete_lagrangian", (), g, h)
        stack = "Stack one row per constraint, in body coordinates; pass None for no constraint."
        self._trace("constraint_forms", repr(self.group), (g,), tracing.checked_rows, n - 1, (n,), stack)
        self._trace_at("discrete_constraints", (self.constraints,), g, g, h)
        self._trace_at("lagrangian", (), jax.ShapeDtypeStruct((n,), float))
        self._trace_at("potential", (), g)
        self._check_force(repr(self.group), g, jax.ShapeDtypeStruct((n,), float))
        self._check_slips(self.discrete_constraints)

    def _trace_at(self, name: str, shape: tuple[int, ...], *arguments: Any) -> None:
        arrays = f"shapes {[x.shape for x in arguments]}"
        self._trace(name, repr(self.group), arguments, tracing.checked_value, shape, arrays)

    @property
    def dimension(self) -> int:
        """The dimension of the group."""
        return self.group.dim

    @property
    def places(self) -> Poses:
        """Where it moves."""
        return Poses(self.group, self.is_driven)

    @functools.cached_property
    def plain(self) -> Any:
        """The system as the equations see it: Lagrangians of the pose and the velocity or displacement."""
        return super().plain if self.parameters else self._in_full(_numbers_of_inertia)

    def bound(self, *numbers: Any) -> Any:
        """Return the system as the equations see it, with numbers of its parameters within."""
        self._refuse_slips()
        inertia = _inertia if self.parameters else lambda _: _numbers_of_inertia(self)
        return super().bound(*numbers)._in_full(inertia) if numbers else self.plain

    def _in_full(self, inertia: Callable[..., Array]) -> Any:
        lagrangian = functools.partial(self._lagrangian, inertia)
        full = self._with_fields(lagrangian=lagrangian, discrete_lagrangian=self._discrete_lagrangian)
        vars(full)["plain"] = full
        return full

    def _lagrangian(self, inertia: Callable[..., Array], g: Array, w: Array) -> Array:
        r"""Return $l(\omega) - U(g)$ with the given l, or the quadratic form that belongs to l_d."""
        kinetic = w @ inertia(self) @ w / 2 if self.lagrangian is None else self.lagrangian(w)
        return kinetic if self.potential is None else kinetic - self.potential(g)

    def _discrete_lagrangian(self, g: Array, W: Array, time_step: Array) -> Array:
        r"""Return $l_d(W) - \tfrac h2(U(g) + U(gW))$."""
        if self.potential is None:
            return self.discrete_lagrangian(W, time_step)
        return self.discrete_lagrangian(W, time_step) - time_step / 2 * (self.potential(g) + self.potential(g @ W))

    def forced(self, potential: Any, force: Any) -> "GroupLagrangeDAlembert":
        """Return the system with potentials and a force besides; `nonholo.Forced` calls it."""
        potentials = [] if self.potential is None else [self.potential]
        for each in terms_of(potential):
            if not callable(each):
                each.check(self.group)
            function = each if callable(each) else functools.partial(each.energy, self.group)
            potentials.append(tracing.with_parameters(function, 1) if self.parameters else function)
        total = functools.reduce(_sum, potentials) if potentials else None
        return dataclasses.replace(self, potential=total, force=self._with_force(force))

    @property
    def shapes(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Shapes of a configuration and of a velocity."""
        return self.group.identity.shape, (self.group.dim,)


def _sum(first: Callable[..., Array], second: Callable[..., Array]) -> Callable[..., Array]:
    return lambda *arguments: first(*arguments) + second(*arguments)


def _inertia(system: GroupLagrangeDAlembert) -> Array:
    """Return the inertia operator: h times the second derivative of $l_d(e^x)$ at x = 0, for h = 1."""
    action = jax.hessian(lambda x: system.discrete_lagrangian(system.group.exp(x), jnp.ones(())))
    return action(jnp.zeros(system.group.dim))


@functools.lru_cache(maxsize=64)
def _numbers_of_inertia(system: GroupLagrangeDAlembert) -> Any:
    with jax.ensure_compile_time_eval(), double_precision():
        return np.asarray(jax.jit(lambda: _inertia(system))())


def mass_tensor_lagrangian(
    group: AbstractMatrixGroup, mass_tensor: Float[Array, "N N"]
) -> Callable[[Array, Array], Array]:
    r"""Return the discrete Lagrangian of a body with a mass tensor, for `GroupLagrangeDAlembert`.

    $$ l_d(W) = h\,l\bigl((W - I)/h\bigr) = \tfrac{1}{2h}\mathrm{tr}\bigl((W - I)\,\mathbb{J}\,(W - I)^T\bigr). $$

    Args:
        group: SO(n) or SE(n).
        mass_tensor: Symmetric: (n, n) on SO(n), homogeneous (n + 1, n + 1) on SE(n).

    Raises:
        ValueError: Another group, a wrong shape, an asymmetry, a value that is not finite.

    Example:
        >>> from nonholo.lagrange_dalembert import mass_tensor_lagrangian
        >>> action = mass_tensor_lagrangian(nh.SO(3), np.eye(3))
        >>> float(action(np.diag([-1.0, -1.0, 1.0]), 0.5))  # a half-turn: (4 + 4)/(2 * 0.5)
        8.0
    """
    checked_group("mass_tensor_lagrangian(group=...)", group)
    where, instead = "mass_tensor_lagrangian(mass_tensor=...)", "Write your own discrete Lagrangian."
    return functools.partial(_mass_tensor_action, group, group_mass_tensor(where, group, mass_tensor, instead))


def _mass_tensor_action(group: AbstractMatrixGroup, tensor: np.ndarray, W: Array, time_step: Array) -> Array:
    X = W - group.identity
    return inertia_form(group, X[None], X.__array_namespace__().asarray(tensor))[0, 0] / (2 * time_step)
