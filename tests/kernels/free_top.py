r"""A closed-form family beside those of the library, the top with c = 0: a program that prints what its motions do.

Its momentum m stays constant, and $By = (1 + |y|^2)\,m$ has the root $y = \lambda B^{-1}m$,
$\lambda = 2/(1 + \sqrt{1 - 4|B^{-1}m|^2})$, real up to $|y| = 1$.

python free_top.py   # with NUMBA_DISABLE_JIT=1 in plain Python
"""

# ruff: noqa: ARG001
import json
import sys
import tempfile
from typing import Any, NamedTuple

import numpy as np

import nonholo as nh
from nonholo.base.compiled import njit
from nonholo.discrete.routes import _normal_forms
from nonholo.kernels._scalar import COMPILED, Body, scalar, sqrt
from nonholo.kernels._suslov import move as moved
from nonholo.systems import NormalForm


class FreeTopBody(NamedTuple):
    """The entries of B^-1."""

    i11: Any
    i12: Any
    i22: Any


@scalar
def root(p: FreeTopBody, m1: float, m2: float) -> tuple[float, float]:
    """Return y; NaN where there is none."""
    u1, u2 = p.i11 * m1 + p.i12 * m2, p.i12 * m1 + p.i22 * m2
    factor = 2 / (1 + sqrt(1 - 4 * (u1 * u1 + u2 * u2)))
    return factor * u1, factor * u2


@scalar
def residual(p: FreeTopBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return B^-1 of the equations."""
    weight = 1 + y1 * y1 + y2 * y2
    return y1 - weight * (p.i11 * m1 + p.i12 * m2), y2 - weight * (p.i12 * m1 + p.i22 * m2)


@scalar
def correction(p: FreeTopBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return what is missing to the root."""
    r1, r2 = root(p, m1, m2)
    return r1 - y1, r2 - y2


@scalar
def is_certain(p: FreeTopBody, m1: float, m2: float, y1: float, y2: float) -> bool:
    """Every real root of this branch is the principal one."""
    return y1 * y1 + y2 * y2 < 1


@scalar
def increment(p: FreeTopBody, m1: float, m2: float, y1: float, y2: float) -> tuple[float, float]:
    """Return zero."""
    return 0.0 * m1, 0.0 * m2


@scalar
def move(
    p: FreeTopBody, y1: float, y2: float, q0: float, q1: float, q2: float, q3: float
) -> tuple[float, float, float, float]:
    """Return the quaternion of g W."""
    return moved(p, y1, y2, q0, q1, q2, q3)


@njit(**COMPILED)
def principal(p: FreeTopBody, m1: float, m2: float) -> tuple[int, float, float]:
    """Return the outcome and the root."""
    y1, y2 = root(p, m1, m2)
    return (0 if y1 * y1 + y2 * y2 < 1 else 1), y1, y2


def body(form: NormalForm) -> Body:
    """Return the numbers of a top."""
    numbers = (np.linalg.inv(form.stiffness)[..., i, j] for i, j in ((0, 0), (0, 1), (1, 1)))
    return FreeTopBody(*(x if np.ndim(x) else float(x) for x in numbers))


FREE_TOP = _normal_forms.ClosedForm(lambda form: not form.is_sleigh and not form.is_coupled, body, 0.5, None)
VELOCITY, STEPS = (0.7, -0.4), 12


def motions(system: nh.SuslovTop) -> dict[str, Any]:
    """Return what a run, a composition, an ensemble, a resumed store and single steps give."""
    two, four = nh.discretize(system, 0.5), nh.discretize(system, 0.5, order=4)
    run, composed = (nh.simulate(each, restricted_velocity=VELOCITY, steps=STEPS) for each in (two, four))
    many = nh.ensemble(two, restricted_velocity=[VELOCITY, (0.1, 0.2), (99.0, 0.0)], steps=STEPS)
    tensors = {"mass_tensor": [system.mass_tensor] * 2}
    own = nh.ensemble(two, restricted_velocity=[VELOCITY] * 2, steps=STEPS, parameters=tensors)
    with tempfile.TemporaryDirectory() as folder:
        store = f"{folder}/new.zarr"
        nh.simulate(two, restricted_velocity=VELOCITY, steps=STEPS // 2, store=store)
        stored = nh.extend(store, steps=STEPS // 2)
    return {
        "body": type(two.route.compiled_route.body).__name__,
        "is_scalar": two.route.is_scalar,
        "pose": run.pose.tolist(),
        "composed": composed.pose.tolist(),
        "stored": stored.pose.tolist(),
        "members": many.pose[:, -1].tolist(),
        "own": own.pose[:, -1].tolist(),
        "outcomes": many.outcome.tolist(),
        "reversal_defect": nh.invariants(run).reversal_defect,
    }


if __name__ == "__main__":
    top = nh.SuslovTop([[1.4, 0.2, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 0.9]])
    given = motions(top)
    _normal_forms._CLOSED_FORMS = (FREE_TOP, *_normal_forms._CLOSED_FORMS)
    sys.stdout.write(json.dumps({"given": given, "added": motions(top)}))
