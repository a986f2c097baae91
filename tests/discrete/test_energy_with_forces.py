"""Theorem 18.2 of the theory of forces, from the definitions in 50 digits: the exact balance of any force.

What the library makes of it, and of Theorem 18.1, stands in tests/simulation/test_energy_scheme.py.
"""

from typing import Any

import mpmath as mp
import numpy as np
import pytest
from forms import FORMS

import nonholo as nh

H = mp.mpf(2) / 5


def _trace(A: Any) -> Any:
    return sum(A[i, i] for i in range(A.rows))


def _drawn(rng: np.random.Generator, *shape: int, unreal: bool = False) -> Any:
    return mp.matrix((rng.normal(size=shape) + (1j * rng.normal(size=shape) if unreal else 0.0)).tolist())


@pytest.mark.parametrize("unreal", [False, True], ids=["real", "complex"])
@pytest.mark.parametrize("name", ["SO(3)", "SO(4)", "SE(2)", "SE(3)", "SO(2,1)", "Sp(4)"])
def test_the_balance_of_any_force_is_exact(name: str, unreal: bool) -> None:
    """T' - T = <f, X> for equal half impulses h f / 2, whatever f is: random J with J* = J and half the directions."""
    rng = np.random.default_rng(12)
    group = FORMS[name] if name in FORMS else getattr(nh, name[:2])(int(name[3]))
    with mp.workdps(50):
        eye, form = (mp.matrix(x.tolist()) for x in (group.identity, group.form if name in FORMS else group.identity))

        def star(A: Any) -> Any:
            return form**-1 * A.T * form

        J = _drawn(rng, group.size, group.size)
        J = J + star(J)
        rows = [mp.matrix(row.tolist()) for row in group.hat(rng.normal(size=(group.dim // 2, group.dim)))]
        if not group.is_affine:  # to all digits
            rows = [(row - star(row)) / 2 for row in rows]
        inertia = mp.matrix([[_trace(a * J * star(b)) for b in rows] for a in rows])

        def momentum(W: Any) -> Any:
            """F(W): the derivative of l_d along exp(s x) W, for each row x."""
            pulled = W * J * star(W - eye) / H
            return mp.matrix([_trace(row * pulled) for row in rows])

        def energy(r: Any) -> Any:
            return (r.T * inertia**-1 * r)[0] / 2

        x, f = 0.4 * _drawn(rng, len(rows), 1, unreal=unreal), _drawn(rng, len(rows), 1, unreal=unreal)
        X = sum((component * row for component, row in zip(x, rows, strict=True)), 0 * eye)
        C = mp.sqrtm(eye + X * X)
        roots = [C]
        if group.size == 3:  # X has the eigenvalues 0, mu, -mu: the plane of the last two has another root
            roots.append(C - 2 * C * (X * X / (_trace(X * X) / 2)))
        for W in (X + root for root in roots):
            before, after = momentum(W) - H / 2 * f, -momentum(W**-1) + H / 2 * f
            assert abs(energy(after) - energy(before) - (f.T * x)[0]) < 1e-40
