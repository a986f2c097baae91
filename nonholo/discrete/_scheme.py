r"""The displacement variety, and the parts of the equations of a step: what they and routes see of a discretization.

A variety is where displacements may lie, as a chart and the equations that the chart leaves over.
"skew": $(W - W^{-1})/2 \in \mathfrak{d}$, the irreducible analytic component through the identity. "exponential":
$\exp\mathfrak{d}$. "naive": $W - I$, projected to the algebra, in $\mathfrak{d}$. Or functions $f_j(W) = 0$. If
$X^3 \in \mathfrak{d}$ for every $X \in \mathfrak{d}$ (tops, sleighs, the whole algebra, other symmetric pairs), the
first two are the same set, and the Cayley image of $\mathfrak{d}$ too.

The discrete Legendre transformation is $W \mapsto P(W)$, with $\mathrm{Ad}^*_W P(W)$ on the right. For the matrix
difference both are closed forms in $X = W - I$, free of cancellation, for the logarithmic one in log W; for every other
discrete Lagrangian they are derivatives taken by JAX.

Steps of order 4, 6 and 8 are symmetric compositions of the step of order 2 (docs/theory/compositions.md). A substep of
length $\gamma h$ takes the restricted momentum r to what the step of order 2 with time step $\gamma h$, of either sign,
makes of it; its displacement is the principal one over r. Orbits keep the momentum and the chart of the first substep
of each step.

Systems, discretizations and routes are pytrees of JAX, registered when JAX is imported.
"""

import dataclasses
import functools
from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

import numpy as np

from nonholo.base.checks import choice, error, needs
from nonholo.base.numerics import applied, identity_like, keep_programs
from nonholo.base.types import Array, Float, Inexact, read_only
from nonholo.groups import AbstractMatrixGroup
from nonholo.systems import SYSTEMS, AbstractSystem, Forced, Friction, Gravity, Linear, Slip, Spring, System, Widened


class _FixedArray(NamedTuple):
    """An array that is compared and hashed by its entries."""

    entries: bytes
    shape: tuple[int, ...]


@functools.cache
def register() -> None:
    """Register systems, forces and schemes once: `leaves` are numbers, `structure` is static.

    No check runs when a tree is rebuilt.
    """
    import jax

    keep_programs()
    for kind in (*SYSTEMS, Forced, Friction, Gravity, Linear, Slip, Spring, Widened, *Scheme.__subclasses__()):
        jax.tree_util.register_pytree_node(kind, _flatten, functools.partial(_unflatten, kind))


def _flatten(thing: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    constants = (getattr(thing, name) for name in thing.structure)
    static = (_FixedArray(x.tobytes(), x.shape) if isinstance(x, np.ndarray) else x for x in constants)
    return tuple(getattr(thing, name) for name in thing.leaves), tuple(static)


def _unflatten(kind: Any, constants: Any, children: Any) -> Any:
    thing = object.__new__(kind)
    for name, value in zip((*kind.leaves, *kind.structure), (*children, *constants), strict=True):
        is_fixed = isinstance(value, _FixedArray)
        object.__setattr__(thing, name, np.frombuffer(value.entries).reshape(value.shape) if is_fixed else value)
    return thing


Constraint = str | tuple[Callable[[Array], Array], ...]

_NAMES = ("skew", "exponential", "naive")
_ROUNDING = 1e-10  # relative, of cubes that must stay in the subspace, and of tangents of functions
_ROWS = 1e-12  # relative to the largest entry: a row in axes that are nearly those of the body has small ones


@dataclasses.dataclass(frozen=True, eq=False)
class Variety:
    """A chart of displacements and the equations that it leaves over.

    Attributes:
        group: The group.
        chart: Rows span the directions of the chart, shape (m, dim).
        annihilator: Rows of the forbidden directions, shape (s, dim).
        constraint: "skew", "exponential", "naive" or functions.
        exponential: Whether the chart is exp, not the group's retraction.
        frame: The canonical body frame as seen from the user's, in which "naive" and functions are meant; None for the
            others, which are the same in every frame.
    """

    group: AbstractMatrixGroup
    chart: Float[np.ndarray, "m dim"]
    annihilator: Float[np.ndarray, "s dim"]
    constraint: Constraint
    exponential: bool
    frame: Float[Array, "N N"] | None = None

    @property
    def exact(self) -> bool:
        """Whether the chart covers the variety and no equations are left."""
        return self.chart.shape[0] + self.annihilator.shape[0] == self.group.dim

    def displaced(self, y: Float[Array, "... m"]) -> Float[Array, "... N N"]:
        """Return the displacement with chart coordinates y, tangent to 2 y."""
        X = self.increment(y)
        return identity_like(X) + X

    def increment(self, y: Float[Array, "... m"]) -> Float[Array, "... N N"]:
        """Return the displacement minus the identity, without cancellation."""
        x = applied(y.__array_namespace__().asarray(self.chart, dtype=y.dtype).T, 2 * y)
        return self.group.exp_increment(x) if self.exponential else self.group.retract_increment(x)

    def angle(self, y: Float[np.ndarray, "... m"]) -> Float[np.ndarray, "..."]:
        """Return the angles through which displacements turn; Cayley's map of a body takes t to 2 arctan(t / 2)."""
        if self.exponential or not self.group.is_rigid:
            return self.group.angle(self.group.log(self.displaced(y)))
        return 2 * np.arctan(self.group.angle(applied(self.chart.T, 2 * y)) / 2)

    def coordinates(self, W: Float[np.ndarray, "N N"]) -> Float[np.ndarray, "m"]:
        """Return the chart coordinates of a displacement of less than half a turn."""
        if self.exponential or not self.group.has_skew_part:
            x = self.group.log(W)
        else:
            x = self.group.vee(2 * (W - self.group.identity) @ np.linalg.inv(W + self.group.identity))
        return np.linalg.lstsq(self.chart.T, x / 2)[0]

    def equations(self, W: Float[Array, "... N N"]) -> Float[Array, "... j"]:
        """Return what must vanish on the variety and is not built into the chart."""
        xp = W.__array_namespace__()
        if self.exact:
            return xp.zeros((*W.shape[:-2], 0), dtype=W.dtype)
        annihilator = xp.asarray(self.annihilator, dtype=W.dtype)
        if self.frame is None:
            return applied(annihilator, self.group.vee((W - self.group.inverse(W)) / 2))
        back, frame = (xp.asarray(g, dtype=W.dtype) for g in (self.group.inverse(self.frame), self.frame))
        W = frame @ W @ back
        if isinstance(self.constraint, str):
            return applied(annihilator, self.group.vee(W - xp.asarray(self.group.identity, dtype=W.dtype)))
        return xp.stack([f(W) for f in self.constraint], axis=-1)


def variety_of(system: AbstractSystem, constraint: Constraint) -> Variety:
    """Return the displacement variety of a system, in its canonical frame."""
    if constraint not in ("skew", "exponential"):
        every, annihilator = np.eye(system.group.dim), np.asarray(system.annihilator)
        return Variety(system.group, every, annihilator, constraint, exponential=False, frame=system.frame)
    canonical, group = system.canonical, system.group
    subspace, annihilator = map(np.ascontiguousarray, (canonical.constraint_subspace, canonical.annihilator))
    has_form = canonical.normal_form is not None
    is_closed = has_form or (group.has_skew_part and _cubes_stay(group, subspace, annihilator))
    exponential = constraint == "exponential" and not is_closed
    chart = subspace if is_closed or exponential else np.eye(group.dim)
    return Variety(group, chart, annihilator, constraint, exponential)


def _cubes_stay(group: AbstractMatrixGroup, subspace: np.ndarray, annihilator: np.ndarray) -> bool:
    """Return whether X^3 lies in the subspace for every X in it; a polynomial identity, tried on random X."""
    X = group.hat(np.random.default_rng(0).normal(size=(4, len(subspace))) @ subspace)
    forbidden = forbidden_matrices(group, annihilator)
    escape = np.einsum("jab,iab->ij", forbidden, X @ X @ X)
    sizes = np.abs(X) @ np.abs(X) @ np.abs(X)
    bound = _ROUNDING * np.einsum("jab,iab->ij", np.abs(forbidden), sizes)  # lengths in any unit
    if group.form is not None:  # no lengths: zeros of a slanted basis may be rounding errors
        bound = _ROUNDING * np.abs(forbidden).max(initial=0.0) * sizes.max(initial=0.0)
    for part in (sizes[..., : group.point_size], sizes[..., group.point_size :]):  # turns, slides
        part[:] = part.max((-2, -1), initial=0.0, keepdims=True)
    bound = np.maximum(bound, _ROWS * np.einsum("jab,iab->ij", np.abs(forbidden), sizes))
    return bool(np.all(np.abs(escape) <= bound))


def forbidden_matrices(group: AbstractMatrixGroup, annihilator: np.ndarray) -> Float[np.ndarray, "s N N"]:
    """Return matrices whose sums of products of entries with X are the forbidden coordinates of X."""
    units = np.eye(group.size**2).reshape(-1, group.size, group.size)
    return (group.vee(units) @ annihilator.T).T.reshape(-1, group.size, group.size)


def definition(owner: str) -> Any:
    """Import the functions of the definition, or name the extra that they need and the call that needs it."""
    with needs("jax", owner):
        from nonholo.discrete import definition
    return definition


def equations_of(variety: Variety, D: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... j"]:
    """Return the equations of a variety at displacements in the canonical frame, in 64 bits."""
    if isinstance(variety.constraint, str):
        return variety.equations(D)
    map_each = definition("discretize(constraint=...)").map_each
    values = map_each(variety.equations, D.reshape(-1, *D.shape[-2:]))  # functions take one matrix at a time
    return values.reshape(*D.shape[:-2], -1)


def checked_constraint(where: str, system: AbstractSystem, constraint: object) -> Constraint:
    """Return a named constraint, or functions that pass through the identity with tangent space d."""
    if callable(constraint):
        constraint = (constraint,)
    if not isinstance(constraint, list | tuple):
        return choice(where, constraint, _NAMES, "Or pass functions f_j(W), zero on the variety.")
    s = len(system.annihilator)
    if len(constraint) != s:
        raise error(where, f"be {s} functions, one per forbidden direction", f"{len(constraint)}", "Pass as many.")
    write = "Write each f_j(W) with jax.numpy, for one matrix, returning one number."
    words = "real scalar functions", write, "Avoid 0/0 and square roots of zero there."
    functions, values, derivative = at_identity(where, constraint, system.group, words)
    if np.abs(values).max(initial=0.0) > _ROUNDING:
        raise error(where, "vanish at the identity", f"values {values}", "Subtract them.")
    along = np.abs(derivative @ system.constraint_subspace.T).max(initial=0.0)
    if along > _ROUNDING * np.abs(derivative).max(initial=1.0):
        got = f"a derivative {along:.3g} along d"
        raise error(where, "be tangent to d at the identity", got, "Check the functions against constraint_subspace.")
    if np.linalg.matrix_rank(derivative, tol=_ROUNDING * np.abs(derivative).max(initial=0.0)) < s:
        raise error(where, "be independent at the identity", "dependent derivatives", "Drop the dependent ones.")
    return functions


def at_identity(
    where: str, functions: Any, group: AbstractMatrixGroup, words: tuple[str, str, str]
) -> tuple[Any, np.ndarray, np.ndarray]:
    """Return traced functions of a user, their values at the identity and their derivatives along the group.

    The words of errors are what they should be, how to write them, and how to make them differentiable.
    """
    of_jax, own = definition(where), []
    values, slopes = np.zeros(len(functions)), np.zeros((len(functions), group.dim))
    for j, function in enumerate(functions):
        try:
            each, values[j], slopes[j] = of_jax.trace(function, group)
            own.append(each)
        except Exception as failure:
            got = f"{type(failure).__name__}: {f'{failure}'.splitlines()[0]}"
            raise error(where, f"be {words[0]} of a JAX matrix", got, words[1]) from failure
    if not (np.all(np.isfinite(values)) and np.all(np.isfinite(slopes))):
        got = f"values {values}, derivatives {slopes.tolist()}"
        raise error(where, "be differentiable at the identity", got, words[2])
    return tuple(own), values, slopes


def free_rows(group: AbstractMatrixGroup) -> int:
    """Return how many rows of the matrices of a group are not the same for all."""
    return group.size if group.form is not None or np.any(group.basis[:, -1]) else group.size - 1


Difference = str | Callable[[Array], Array]


@dataclasses.dataclass(frozen=True, eq=False)
class Scheme:
    """A system, a time step, a discrete Lagrangian and a displacement variety.

    A class, not a protocol: to try whether an object obeys one would ask it for its variety, whose matrices
    fill the memory for wide bodies.

    Attributes:
        system: The system.
        time_step: The time step h.
        difference: The discrete Lagrangian: "matrix", "logarithmic" or a callable.
        constraint: The name of the variety, or its functions.
        order: 2, or that of a composition.
    """

    system: System
    time_step: Array
    difference: Difference = "matrix"
    constraint: Constraint = "skew"
    order: int = 2
    leaves: ClassVar[tuple[str, ...]] = ("system", "time_step")
    structure: ClassVar[tuple[str, ...]] = ("difference", "constraint", "order")

    @functools.cached_property
    def variety(self) -> Variety:
        """The displacement variety in the canonical frame."""
        return variety_of(self.system, self.constraint)

    def part(self, share: Array) -> Any:
        """Return the step of order 2 whose length is a share of that of a step."""
        return dataclasses.replace(self, time_step=share * self.time_step, order=2)

    @functools.cached_property
    def first_part(self) -> Any:
        """The first step of order 2 of a composition; the scheme itself, if it is one."""
        return self if self.order == 2 else self.part(float(weights(self.order)[0]))


def legendre(discrete: Scheme, increment: Inexact[Array, "... N N"], side: str) -> Inexact[Array, "... dim"]:
    r"""Return the momenta of displacements given as W - I.

    Logarithmic ones are $(\mathrm{dexp}^{-1}_{\pm X})^*\,\mathbb{I}\,X/h$, $X = \log W$: plus on the left, minus on the
    right.
    """
    system, group = discrete.system, discrete.system.group
    if discrete.difference == "matrix":
        return matrix_legendre(group, system.homogeneous_mass_tensor, increment, side) / discrete.time_step
    if callable(discrete.difference):
        by_derivative = definition("discretize(difference=...)").momenta_by_derivative
        return by_derivative(discrete.difference, group, increment + group.identity, side)
    x = group.log(increment + group.identity)
    p = applied(x.__array_namespace__().asarray(system.inertia_operator), x) / discrete.time_step
    return (p[..., None, :] @ group.dexp_inverse(x if side == "left" else -x))[..., 0, :]


def matrix_legendre(
    group: AbstractMatrixGroup, tensor: Inexact[Array, "N N"], X: Inexact[Array, "... N N"], side: str
) -> Inexact[Array, "... dim"]:
    r"""Return $\mathrm{tr}(E_i W\mathbb{J}X^*)$ (left) or $\mathrm{tr}(W E_i\mathbb{J}X^*)$ (right), $W = I + X$."""
    xp = X.__array_namespace__()
    arm = xp.asarray(tensor, dtype=X.dtype) @ group.form_adjoint(X)
    product = arm + X @ arm if side == "left" else arm + arm @ X
    return group.coordinates.dual_vector(xp.swapaxes(product, -1, -2))


WEIGHTS = {
    4: ("0.414490771794375737142354062860761495711775", "0.414490771794375737142354062860761495711775"),
    6: (
        "0.39216144400731413927925056",
        "0.332599136789359438599748634257274355737334",
        "-0.706246172557639359809964819634910351039340",
        "0.0822135962935508002314904488531569176963106",
    ),
    8: (
        "0.741670364350612953448227801783806315603537",
        "-0.409100825800031593997300095893563417309918",
        "0.190754710296238379953876256450371662735461",
        "-0.573862471116082266656387726635535742159509",
        "0.299064181303655923844463540688602988225823",
        "0.334624918245298183784957979882182288633692",
        "0.315293092396766596632056663811002430994081",
    ),
}
r"""First half of the $\gamma_i$ by order; the second is its mirror image and the middle one makes their sum 1."""


@functools.cache
def weights(order: int) -> Float[np.ndarray, "S"]:
    r"""Return the fractions $\gamma_i$ of the time step, one for order 2.

    Example:
        >>> weights(4).round(3).tolist()
        [0.414, 0.414, -0.658, 0.414, 0.414]
    """
    half = np.array([float(text) for text in WEIGHTS.get(order, ())])
    return read_only(np.concatenate([half, [1 - 2 * half.sum()], half[::-1]]))


def refuse_composition(where: str, discrete: Scheme, remedy: str) -> None:
    """Refuse a discretization of an order above 2."""
    if discrete.order > 2:
        got = f"order {discrete.order}, a composition of {len(weights(discrete.order))} steps"
        raise error(where, "have a discretization of order 2", got, remedy)
