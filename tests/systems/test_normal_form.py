"""The normal form of tops and sleighs against the equations of motion by definition, in any axes."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import numpy as np
import pytest
from bodies import elsewhere, tensor

import nonholo as nh
from nonholo.systems import NormalForm
from nonholo.systems._base import replace_numbers

RNG = np.random.default_rng(16)
_tensor = functools.partial(tensor, rng=RNG)
_elsewhere = functools.partial(elsewhere, rng=RNG)


NAMED = {
    "top": lambda: nh.SuslovTop(_tensor(3)),
    "tilted top": lambda: nh.SuslovTop(_tensor(3), axis=np.array([2.0, -1.0, 2.0]) / 3),
    "top 5": lambda: nh.SuslovTop(_tensor(5)),
    "arrowhead top": lambda: nh.SuslovTop.arrowhead([1.0, 2.0, 3.0, 4.0], [0.3, 0.2, -0.1]),
    "sleigh": lambda: nh.ChaplyginSleigh(2.0, 1.5, 0.5, 0.3),
    "balanced sleigh": lambda: nh.ChaplyginSleigh(2.0, 1.5, 0.0, 0.3),
    "sleigh 3": lambda: nh.MultidimensionalSleigh(2.0, RNG.normal(size=3), _tensor(3)),
    "balanced sleigh 4": lambda: nh.MultidimensionalSleigh(2.0, [0.0, 0.3, 0.1, -0.2], _tensor(4)),
    "arrowhead sleigh": lambda: nh.MultidimensionalSleigh.arrowhead(
        2.0, [0.5, 0.1, 0.2, 0.3], [1.0, 2.0, 3.0, 4.0], [0.3, 0.2, -0.1]
    ),
}
SYSTEMS = {**NAMED, **{f"{name}, elsewhere": lambda make=make: _elsewhere(make()) for name, make in NAMED.items()}}


def _rates(form: NormalForm, r: np.ndarray) -> np.ndarray:
    """Return the rates of the momenta along the rows of the form, by its equations of motion."""
    B, c, m, a = form.turning, form.coupling, form.mass, form.arm
    B = np.diag(B) if form.is_diagonal else B
    if not form.is_sleigh:
        w = np.linalg.solve(B, r)
        return (c @ w) * w - (w @ w) * c
    u = r[-1] / m
    w = np.linalg.solve(B, r[:-1] - form.offset * r[-1])
    pushed = m * a * (w @ w)
    return np.append((c @ w) * w - (w @ w) * c - m * a * u * w + form.offset * pushed, pushed)


@pytest.mark.parametrize("make", SYSTEMS.values(), ids=SYSTEMS)
def test_equations_of_motion(make: Callable[[], Any]) -> None:
    """The momenta change as the form says; its energy is that of the system."""
    system = make()
    form, field = system.normal_form, nh.vector_field(system)
    assert form.is_sleigh == ("SE" in repr(system.group))
    to_rows = np.eye(system.rank) if form.frame_map is None else form.frame_map
    to_rows = to_rows @ system.frame_map
    for _ in range(5):
        r = RNG.normal(size=system.rank)
        rate = field(0.0, np.concatenate([r, system.group.identity.ravel()]))[: system.rank]
        expected = _rates(form, to_rows @ r)
        scale = np.abs(to_rows).max() * (r @ r) + np.abs(expected).max()
        np.testing.assert_allclose(to_rows @ rate, expected, atol=1e-11 * scale, rtol=0)


@pytest.mark.parametrize("make", NAMED.values(), ids=NAMED)
def test_axes_do_not_matter(make: Callable[[], Any]) -> None:
    """A body in other axes has the same form but for a rotation of the planes, and the side that faces forward."""
    system = make()
    named, result = system.normal_form, _elsewhere(system).normal_form

    def invariants(form: NormalForm) -> np.ndarray:
        B = np.diag(form.stiffness) if form.is_diagonal else np.asarray(form.stiffness)
        powers = [form.coupling @ np.linalg.matrix_power(B, i) @ form.coupling for i in range(3)]
        return np.array([*np.linalg.eigvalsh(B), *powers, abs(form.arm), form.mass or 0.0])

    np.testing.assert_allclose(invariants(result), invariants(named), rtol=1e-10, atol=1e-12)
    assert (result.arm == 0) == (named.arm == 0)


NEITHER = {
    "free": lambda: nh.RigidBody(_tensor(3), nh.SO(3)),
    "two constraints": lambda: nh.LLSystem(nh.SO(3), _tensor(3), annihilator=np.eye(3)[:2]),
    "no plane through one axis": lambda: nh.LLSystem(nh.SO(4), _tensor(4), np.eye(6)[[0, 3, 5]]),
    "planes that miss an axis": lambda: nh.LLSystem(nh.SO(4), _tensor(4), np.eye(6)[:3] + 1e-9 * np.eye(6)[3:]),
    "no sliding": lambda: nh.LLSystem(nh.SE(2), _tensor(3), annihilator=[[1.0, 0.0, 0.0]]),
    "inertia operator": lambda: nh.LLSystem(nh.SO(3), inertia_operator=_tensor(3), annihilator=[[0.0, 0.0, 1.0]]),
    "right-invariant": lambda: nh.VeselovaTop(_tensor(3)),
}


@pytest.mark.parametrize("make", NEITHER.values(), ids=NEITHER)
def test_other_systems_have_none(make: Callable[[], Any]) -> None:
    """What is neither a top nor a sleigh has no form, nor has a system without a mass tensor."""
    assert make().normal_form is None


def test_nothing_that_is_traced_is_kept() -> None:
    """A body that is first asked within an inner transformation answers outside of it, too."""

    def traced(tensor: Any) -> Any:
        top = replace_numbers(nh.SuslovTop(np.eye(3)), mass_tensor=tensor)
        return jax.jit(lambda x: x * top.inertia_along)(1.0) + top.inertia_along

    np.testing.assert_array_equal(jax.jit(traced)(np.diag([1.0, 2.0, 4.0])), 2 * np.diag([5.0, 6.0]))
