"""The definition route: momenta as derivatives of the discrete Lagrangian, the step as a root of its equations.

Written from the definitions for any group, any discrete Lagrangian and any displacement variety, in JAX; the compiled
steps are tested against it. With a right-invariant constraint the unknown is U = g W g^-1; the equations depend on g.
The principal root is found by continuation from zero, then Newton's method.

Functions of one matrix, the library's or the user's, in JAX: values, derivatives along the group, momenta. The
principal displacement for JAX is that of the closed form of a body where it has one, which its kernel shares. Eager
calls run in a local 64-bit scope, traced calls must already be 64-bit.
"""

import contextlib
import contextvars
import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import equinox
import jax
import jax.numpy as jnp
import numpy as np

from nonholo import kernels
from nonholo.base.checks import is_traced
from nonholo.base.numerics import double_precision
from nonholo.base.progress import compiling, setting
from nonholo.base.results import Outcome, OutcomeError
from nonholo.base.traced import TracedFunction, implicit
from nonholo.base.types import Array, Float
from nonholo.discrete._scheme import Scheme, legendre, register
from nonholo.discrete.routes import ScalarStep
from nonholo.groups import AbstractMatrixGroup

_float32 = contextvars.ContextVar("float32_allowed", default=False)
register()


def allow_float32() -> contextlib.AbstractContextManager[None]:
    """Let the JAX route be traced in 32 bits, where energy is conserved to 1e-7 instead of rounding.

    Example:
        >>> with nh.allow_float32():
        ...     pass
    """
    return setting(_float32, True)


def in_double(function: Callable[..., Any], *arguments: Any) -> Any:
    """Call a JAX function: eagerly in a 64-bit scope with NumPy results, or as it is on traced 64-bit input."""
    tracers = [x for x in jax.tree.leaves(arguments) if is_traced(x)]
    if not tracers:
        with double_precision(), compiling("a map", compiling, (function, jax.tree.structure(arguments))):
            return jax.tree.map(np.asarray, function(*arguments))
    if not _float32.get() and any(x.dtype == np.float32 for x in tracers):
        raise TypeError(
            "`nonholo` must be traced in 64 bits. Got float32. Wrap the call in `with jax.enable_x64(True):`, "
            "or accept single precision with `with nonholo.allow_float32():`."
        )
    return function(*arguments)


def compile_double(function: Callable[..., Any]) -> Callable[..., Any]:
    """Compile a JAX function, which is then called as `in_double` calls it."""
    return functools.wraps(function)(functools.partial(in_double, equinox.filter_jit(function)))


_FIRST = 0.25  # first continuation step, in s
_SMALLEST = 1e-7  # continuation step, relative to s, below which the branch is given up
_CORRECTIONS = 8  # of Newton's method at each continuation step
_LAST = 20  # of Newton's method at the end, to rounding
_JUMP = 0.2  # a continuation step that moves y further than this, relative to 1 + |y|^2, is not trusted
_NEAR_FOLD = 1e-2  # of the Jacobian determinant at zero, where a continuation that stops has met a fold
_NOWHERE = 0.3  # y of a root that was not found
_FAR = 1e3  # size of y where a chart of the displacements ends: an angle of 179.9 degrees

Residual = Callable[[Array, Array], Array]
Root = tuple[Float[Array, "m"], Float[Array, "k"]]
"""A root and its target."""


def followed_root(
    residual: Residual, start: Root, target: Array, certificate: Residual | None = None, guess: Array | None = None
) -> tuple[Float[Array, "m"], Array]:
    r"""Solve residual(y, target) = 0 for the root that a given one reaches while the momenta move straight to target.

    The principal one is that which (0, 0) reaches along s target, 0 <= s <= 1. The steps in s shrink where the
    corrector moves far from the tangent or the sign of the Jacobian determinant would change, at a fold. Derivatives
    are those of the implicit function, not of the iteration.

    Args:
        residual: A function of y and the momenta, zero at the start.
        start: A root and its momenta.
        target: The momenta.
        certificate: Whether a root is certainly the principal one, by the root alone.
        guess: Where Newton's method may look first; what it finds there needs the certificate.

    Returns:
        The root and the outcome as an integer array. Where that is not successful the root is any finite number, with
        some finite derivative along all that the residual depends on.
    """
    residual, numbers = jax.closure_convert(residual, *start)
    certificate, facts = jax.closure_convert(certificate or (lambda _y, _m: jnp.asarray(False)), *start)
    return _search(residual, certificate, numbers, facts, start, target, guess)


def _at_rest(unknowns: int, target: Array) -> Root:
    """Return the root of no motion, for momenta like some others."""
    return jnp.zeros(unknowns, target.dtype), jnp.zeros_like(target)


@functools.partial(jax.custom_jvp, nondiff_argnums=(0, 1))
def _search(
    residual: Any, certificate: Any, numbers: list[Array], facts: list[Array], start: Root, target: Array, guess: Any
) -> tuple[Array, Array]:
    """Return where the search ends, and its outcome; what the functions are made of stands in `numbers` and `facts`."""

    def is_certain(y: Array, m: Array) -> Array:
        return certificate(y, m, *facts)

    end = _continue(lambda y, m: residual(y, m, *numbers), start, target, guess, is_certain)
    y, far = end.iterate, jnp.sum(end.root**2) > _FAR**2  # where the determinant vanishes without a fold
    at_fold = (end.s < 1) & ~far & (jnp.abs(end.now) < _NEAR_FOLD * jnp.abs(end.start))
    is_lost = (end.s < 1) & ~at_fold
    converged = end.converged & jnp.all(jnp.isfinite(y)) & jnp.all(jnp.isfinite(target))
    code = jnp.where(is_lost, int(Outcome.branch_unverified), int(Outcome.successful))
    code = jnp.where(converged | (is_lost & far), code, int(Outcome.not_converged))
    code = jnp.where(at_fold, int(Outcome.no_real_branch), code)
    code = jnp.where(jnp.all(jnp.isfinite(target)), code, int(Outcome.nonfinite))
    code = jnp.where(converged & is_certain(y, target), int(Outcome.successful), code)
    return jnp.where(code == 0, y, _NOWHERE), code


@_search.defjvp
def _implicit(residual: Any, certificate: Any, primals: Any, tangents: Any) -> tuple[Any, Any]:
    """Return the derivative of the implicit function at the root, which does not depend on the search."""
    y, code = _search(residual, certificate, *primals)
    numbers, _, start, target, _ = primals
    finite = jnp.all(jnp.isfinite(target))
    at, rates = jnp.where(finite, target, start[1]), jnp.where(finite, tangents[3], 0.0)
    y, change = implicit(residual, y, (at, *numbers), (rates, *tangents[0]), lambda *system: _solve(*system)[1])
    return (y, code), (change, np.zeros(code.shape, jax.dtypes.float0))


def _solve(matrix: Float[Array, "m m"], values: Float[Array, "m j"]) -> tuple[Array, Float[Array, "m j"]]:
    """Return the determinant and the solutions; two unknowns need no library, which would be called at each step."""
    if len(matrix) != 2:
        return jnp.linalg.det(matrix), jnp.linalg.solve(matrix, values)
    (a, b), (c, d) = matrix
    det, (first, second) = a * d - b * c, values
    return det, jnp.stack([d * first - b * second, a * second - c * first]) / det


class _Path(NamedTuple):
    """The continuation: the last root with its s, and Newton's method on the way to the next one.

    Attributes:
        s: The parameter up to which the root has been followed.
        size: Step of s that is being tried.
        root: y at s.
        tangent: Its derivative with respect to s.
        now: Jacobian determinant at s.
        start: Jacobian determinant at zero.
        guess: Where Newton's method started.
        iterate: Where it is.
        count: How many corrections it has made; -1 where the path begins, at a root.
        converged: Whether the last ones, at s = 1 from wherever the path ended, have come to rest.
        trial: Whether it has not begun: Newton's method looks at a guess first.
    """

    s: Array
    size: Array
    root: Array
    tangent: Array
    now: Array
    start: Array
    guess: Array
    iterate: Array
    count: Array
    converged: Array
    trial: Array


def _continue(residual: Residual, known_root: Root, target: Array, guess: Array | None, is_certain: Residual) -> _Path:
    """Return the end of the path, where its last root is corrected at s = 1.

    Beginning, path and end are one loop, so that the residual and its derivatives are compiled once.
    """
    one, (root, before) = jnp.ones((), target.dtype), known_root
    evaluate = _evaluation(residual, before, target)
    eps = float(jnp.finfo(target.dtype).eps)

    def advance(path: _Path) -> _Path:
        first, last = path.count < 0, ~_is_unfinished(path)
        ahead = jnp.where(first, 0.0, jnp.where(last, 1.0, jnp.minimum(path.s + path.size, 1.0)))
        det, correction, tangent = evaluate(path.iterate, ahead)
        y = path.iterate - correction
        is_small = jnp.sum(correction**2) <= eps * (1 + jnp.sum(y**2))
        move, off = jnp.sum((y - path.root) ** 2), jnp.sum((y - path.guess) ** 2)
        near = ((off <= 0.01 * move) | (move < 1e-6)) & (move <= _JUMP**2 * (1 + jnp.sum(path.root**2)) ** 2)
        arrives = ~last & ~first & is_small & near & (det * path.now > 0)
        ends = ~last & (first | is_small | (path.count == _CORRECTIONS) | ~jnp.all(jnp.isfinite(y)))
        root, is_root = jnp.where(arrives, y, path.root), arrives | first
        here, before = (ahead, det, tangent), (path.s, path.now, path.tangent)
        s, now, tangent = (jnp.where(is_root, x, old) for x, old in zip(here, before, strict=True))
        size = jnp.where(is_root, 2 * path.size, jnp.where(ends, path.size / 4, path.size))
        following = path._replace(s=s, size=size, root=root, tangent=tangent, now=now)
        ahead = jnp.where(_is_unfinished(following), root + jnp.minimum(size, 1 - s) * tangent, root)
        at_rest = jnp.all(jnp.abs(correction) < eps**0.65 * (1 + jnp.abs(y)))  # momenta have any unit
        following = following._replace(
            start=jnp.where(first, det, path.start),
            guess=jnp.where(ends, ahead, path.guess),
            iterate=jnp.where(ends, ahead, y),
            count=jnp.where(ends, 0, path.count + 1),
            converged=last & at_rest,
        )
        return following if guess is None else _unless_it_failed(following, begin, is_certain(y, target))

    def is_open(path: _Path) -> Array:
        return jnp.all(jnp.isfinite(target)) & (_is_unfinished(path) | (~path.converged & (path.count < _LAST)))

    zero = 0 * one
    nothing, no = jnp.zeros_like(root), jnp.asarray(False)
    begin = _Path(zero, _FIRST / 2 * one, root, nothing, zero, zero, root, root, jnp.asarray(-1), no, no)
    first = begin if guess is None else begin._replace(s=one, iterate=guess, count=jnp.asarray(0), trial=~no)
    return jax.lax.while_loop(is_open, advance, first)


def _is_unfinished(path: _Path) -> Array:
    return (path.s < 1) & (path.size > jnp.maximum(_SMALLEST * path.s, 1e3 * jnp.finfo(path.s.dtype).tiny))


def _unless_it_failed(path: _Path, begin: _Path, certain: Array) -> _Path:
    """Return the path, or its beginning where Newton's method failed from a guess."""
    over = (path.count > _CORRECTIONS) | path.converged | ~jnp.all(jnp.isfinite(path.iterate))
    fails = path.trial & over & ~(path.converged & certain)
    return jax.tree.map(lambda new, old: jnp.where(fails, new, old), begin, path)


def _evaluation(residual: Residual, before: Array, target: Array) -> Callable[[Array, Array], tuple[Array, ...]]:
    """Return the function of y and s that gives Jacobian determinant, Newton correction and tangent."""

    def values(y: Array, s: Array) -> tuple[Array, Array]:
        gap = residual(y, before + s * (target - before))
        return gap, gap

    def evaluate(y: Array, s: Array) -> tuple[Array, Array, Array]:
        (slope, rate), gap = jax.jacfwd(values, argnums=(0, 1), has_aux=True)(y, s)
        det, solutions = _solve(slope, jnp.stack([gap, -rate], axis=1))
        return det, solutions[:, 0], solutions[:, 1]

    return evaluate


def sample_displacements(discrete: Scheme, count: int) -> Float[np.ndarray, "count N N"]:
    """Draw displacements from the variety, the principal ones of velocities that turn by about 0.3 in a step."""
    system, rng = discrete.system, np.random.default_rng(0)
    velocities = rng.normal(size=(count, len(system.constraint_subspace)))
    velocities *= 0.3 / (discrete.time_step * np.linalg.norm(velocities, axis=1, keepdims=True))
    momenta = velocities @ np.asarray(system.constrained_inertia)
    displacements, codes = in_double(_displacements, discrete, momenta, system.group.identity)
    if codes.any():
        raise OutcomeError(Outcome(int(codes.max())), "A displacement of a step of 0.3")
    return displacements


@equinox.filter_jit
def _displacements(discrete: Scheme, momenta: Array, g: Array) -> tuple[Array, Array]:
    charts, codes = jax.vmap(lambda r: principal_displacement(discrete, r, g))(momenta)
    return jax.vmap(lambda y: displacement_of(discrete, y))(charts), codes


def displacement_of(discrete: Scheme, y: Float[Array, "m"]) -> Float[Array, "N N"]:
    """Return the element of the variety, in the user's frame, with canonical chart coordinates y."""
    return discrete.system.from_canonical_frame(discrete.variety.displaced(y))


def momentum_of(discrete: Scheme, y: Array, g: Array, side: str) -> Array:
    """Return the body momentum (left) or the one that arrives (right) of a displacement at a pose."""
    group, system = discrete.system.group, discrete.system
    X = discrete.variety.increment(y)
    if system.is_spatial:
        return legendre(discrete, group.inverse(g) @ X @ g, side)
    return legendre(discrete, system.from_canonical_frame(X), side)


def restricted(discrete: Scheme, momentum: Array, g: Array) -> Array:
    """Return the components of a body momentum along the constraint, in space where that is fixed in space."""
    momentum = discrete.system.constraint_momentum(momentum, g)
    return jnp.asarray(discrete.system.constraint_subspace, dtype=momentum.dtype) @ momentum


def principal_displacement(discrete: Scheme, r: Float[Array, "k"], g: Array) -> tuple[Array, Array]:
    """Return chart coordinates of the principal displacement with these momenta along d, and the outcome."""
    return followed_root(equations_at(discrete, g), _at_rest(len(discrete.variety.chart), r), r)


def nearest_displacement(discrete: Scheme, y: Float[Array, "m"], r: Float[Array, "k"]) -> tuple[Array, Array]:
    """Return chart coordinates of the displacement that y reaches when its momenta along d move straight to r."""
    g = discrete.system.group.identity
    before = restricted(discrete, momentum_of(discrete, y, g, "left"), g)
    return followed_root(equations_at(discrete, g), (y, before), r)


def equations_at(discrete: Scheme, g: Array) -> Callable[[Array, Array], Array]:
    """Return the function of chart coordinates and momenta along d that vanishes at a displacement."""
    variety = discrete.variety

    def residual(y: Array, target: Array) -> Array:
        gap = restricted(discrete, momentum_of(discrete, y, g, "left"), g) - target
        return jnp.concatenate([gap, variety.equations(variety.displaced(y))])

    return residual


def push(discrete: Scheme, y: Array, g: Array) -> tuple[Array, Array]:
    """Return restricted momentum and pose after a displacement."""
    after = discrete.system.moved(g, displacement_of(discrete, y))
    return restricted(discrete, momentum_of(discrete, y, g, "right"), after), after


def trace(function: Callable[[Array], Array], group: AbstractMatrixGroup) -> tuple[TracedFunction, Any, Any]:
    """Return a function of a matrix of a group with the numbers that it reads now; its value and slope at I."""
    own = TracedFunction(function, (jax.ShapeDtypeStruct(group.identity.shape, float),))
    return own, *_value_and_slope(own, group)


@compile_double
def _value_and_slope(lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup) -> tuple[Any, Any]:
    """Return a discrete Lagrangian and its derivative along the group at the identity."""
    return jax.value_and_grad(lambda x: lagrangian(group.exp(x)))(jnp.zeros(group.dim))


@compile_double
def map_each(function: Callable[[Array], Array], W: Float[Array, "K N N"]) -> Any:
    """Return the values of a function of one matrix at each of several."""
    return jax.vmap(function)(W)


@compile_double
def momenta_by_derivative(
    lagrangian: Callable[[Array], Array], group: AbstractMatrixGroup, W: Float[Array, "... N N"], side: str
) -> Float[Array, "... dim"]:
    """Return the momenta P(W) (left) or Ad*_W P(W) (right) of a discrete Lagrangian by automatic differentiation."""

    def variation(x: Array, V: Array) -> Array:
        g = group.exp(x)
        return lagrangian(g @ V if side == "left" else V @ g)

    flat = jnp.reshape(W, (-1, *W.shape[-2:]))
    momenta = jax.vmap(jax.grad(variation), (None, 0))(jnp.zeros(group.dim, W.dtype), flat)
    return jnp.reshape(momenta, (*W.shape[:-2], group.dim))


ON_LOCUS = 1e-6  # relative distance from the momentum locus that a computed momentum may have


def traceable(number: Array) -> Array:
    """Return a number as a scalar array: JAX would compile the step again for each value of a Python float."""
    return np.float64(number) if isinstance(number, float) else number


def kernel_root(body: kernels.Body, m: Float[Array, "2"], guess: Array | None = None) -> tuple[Array, Array]:
    """Return the principal root over momenta of a kernel, and the outcome; the search looks at a guess first."""

    def residual(y: Array, m: Array) -> Array:
        return jnp.stack(kernels.residual(body, *m, *y))

    return followed_root(residual, _at_rest(2, m), m, lambda y, m: kernels.is_certain(body, *m, *y), guess)


def principal_of(discrete: Scheme, scalar: ScalarStep | None, r: Float[Array, "k"], g: Array) -> tuple[Array, Array]:
    """Return canonical chart coordinates of the principal displacement with momenta r along d, and the outcome."""
    if scalar is None:
        return principal_displacement(discrete, r, g)
    y, code = kernel_root(scalar.body, jnp.asarray(scalar.momentum_map(discrete.system)) @ r)
    return scalar.canonical_chart(y), code
