"""Theorems 18.1 and 18.2 of the theory of forces: a step that keeps T + U, and the exact balance of any force.

The step is written here from the definitions, in 50 digits for identities and in doubles for orders: the library does
not take it yet.
"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np
import pytest
from forms import FORMS, tensor

import nonholo as nh

H = mp.mpf(2) / 5
_ZERO = mp.mpf(10) ** -40


class Body(NamedTuple):
    """A group by the form of its adjoint, a mass tensor with J* = J, and rows of a constraint, as matrices."""

    size: int
    star: Callable[[Any], Any]
    J: Any
    rows: list[Any]


def _mp(array: Any) -> Any:
    return mp.matrix(np.asarray(array).tolist())


def _random(rng: np.random.Generator, *shape: int, unreal: bool) -> np.ndarray:
    return rng.normal(size=shape) + (1j * rng.normal(size=shape) if unreal else 0.0)


def _body(name: str, rng: np.random.Generator) -> Body:
    """Return a body with a random tensor and random rows, as many as a half of the algebra has."""
    group = FORMS[name] if name in FORMS else getattr(nh, name[:2])(int(name[3]))
    n, dim, root = group.size, group.dim, rng.normal(size=(group.size, group.size + 2))
    J, K = (tensor(group, rng), _mp(group.form)) if name in FORMS else (root @ root.T, None)
    rows = rng.normal(size=(dim // 2, dim))

    def star(A: Any) -> Any:
        return A.T if K is None else K**-1 * A.T * K

    matrices = [_mp(group.hat(row)) for row in rows]
    if K is not None:  # to all digits
        return Body(n, star, (_mp(J) + star(_mp(J))) / 2, [(x - star(x)) / 2 for x in matrices])
    return Body(n, star, _mp(J), matrices)


def _trace(A: Any) -> Any:
    return sum(A[i, i] for i in range(A.rows))


def _legendre(b: Body, W: Any) -> Any:
    """F(W): the derivative of l_d along exp(s x) W, for each row x."""
    pulled = W * b.J * b.star(W - mp.eye(b.size)) / H
    return mp.matrix([_trace(x * pulled) for x in b.rows])


def _inertia(b: Body) -> Any:
    return mp.matrix([[_trace(x * b.J * b.star(y)) for y in b.rows] for x in b.rows])


def _displacements(b: Body, rng: np.random.Generator, *, unreal: bool) -> Iterator[tuple[Any, Any, Any]]:
    """Give x, X and W = X + C, on each branch that another square root C of I + X^2 leads to."""
    x = mp.matrix((0.4 * _random(rng, len(b.rows), unreal=unreal)).tolist())
    X = sum((x[i] * b.rows[i] for i in range(1, len(b.rows))), x[0] * b.rows[0])
    C = mp.sqrtm(mp.eye(b.size) + X * X)
    yield x, X, X + C
    if b.size == 3:  # X has the eigenvalues 0, mu, -mu: the plane of the last two has another root
        yield x, X, X + C - 2 * C * (X * X / (_trace(X * X) / 2))


def _energy(b: Body, r: Any) -> Any:
    return (r.T * _inertia(b) ** -1 * r)[0] / 2


def _linear(A: Any) -> tuple[Callable, Callable]:
    """U = tr(A^T g), and <G, x> = tr(A^T g (I + Y) x) with the Cayley matrix Y of W."""

    def slope(b: Body, g: Any, W: Any) -> Any:
        one = mp.eye(b.size)
        impulse = A.T * g * (one + (W - one) * (W + one) ** -1)
        return mp.matrix([_trace(impulse * x) for x in b.rows])

    return lambda g: _trace(A.T * g), slope


def _midpoint(A: Any) -> tuple[Callable, Callable]:
    """U = u^3 + exp(u), u = tr(A^T g) / 9: its slope at g W^(1/2), corrected along B X by what U lacks."""

    def u(g: Any) -> Any:
        return _trace(A.T * g) / 9

    def potential(g: Any) -> Any:
        return u(g) ** 3 + mp.exp(u(g))

    def slope(b: Body, g: Any, W: Any) -> Any:
        middle = g * mp.sqrtm(W)
        d = 3 * u(middle) ** 2 + mp.exp(u(middle))
        dU = mp.matrix([d * _trace(A.T * middle * x) / 9 for x in b.rows])
        x = _inertia(b) ** -1 * (_legendre(b, W) - _legendre(b, W**-1)) * H / 2  # Lemma 3.3
        along = _inertia(b) * x
        return dU + (potential(g * W) - potential(g) - (dU.T * x)[0]) / (x.T * along)[0] * along

    return potential, slope


@pytest.mark.profile(
    "problems", keep=["SO(3)-any-complex", "SE(2)-any-real", "SE(3)-linear-real", "Sp(4)-linear-complex"]
)
@pytest.mark.parametrize("unreal", [False, True], ids=["real", "complex"])
@pytest.mark.parametrize("potential", [_linear, _midpoint], ids=["linear", "any"])
@pytest.mark.parametrize("name", ["SO(3)", "SO(4)", "SE(2)", "SE(3)", "SO(2,1)", "Sp(4)"])
def test_the_energy_is_kept_on_every_branch(name: str, potential: Callable, unreal: bool) -> None:
    """Theorem 18.1: what a step leads to has the T + U of what it comes from; its slope has (i) and (ii)."""
    rng = np.random.default_rng(11)
    with mp.workdps(50):
        for _ in range(3):
            b = _body(name, rng)
            U, slope = potential(_mp(rng.normal(size=(b.size, b.size))))
            *_, (_, _, g) = _displacements(b, rng, unreal=unreal)
            for x, _, W in _displacements(b, rng, unreal=unreal):
                G, work = slope(b, g, W), U(g * W) - U(g)
                assert abs((G.T * x)[0] - work) < _ZERO
                assert mp.mnorm(slope(b, g * W, W**-1) - G, mp.inf) < _ZERO
                r, after = _legendre(b, W) + H / 2 * G, -_legendre(b, W**-1) - H / 2 * G
                assert abs(_energy(b, after) - _energy(b, r) + work) < _ZERO
                assert abs(work) > 1e-6  # there is an energy to lose


@pytest.mark.parametrize("name", ["SO(3)", "SO(4)", "SE(2)", "SE(3)", "SO(2,1)", "Sp(4)"])
def test_the_balance_of_any_force_is_exact(name: str) -> None:
    """Theorem 18.2: T' - T = <f, X> for equal half impulses h f / 2, whatever f is."""
    rng = np.random.default_rng(12)
    with mp.workdps(50):
        for unreal in (False, True):
            b = _body(name, rng)
            f = mp.matrix(_random(rng, len(b.rows), unreal=unreal).tolist())
            for x, _, W in _displacements(b, rng, unreal=unreal):
                r, after = _legendre(b, W) - H / 2 * f, -_legendre(b, W**-1) + H / 2 * f
                assert abs(_energy(b, after) - _energy(b, r) - (f.T * x)[0]) < _ZERO
