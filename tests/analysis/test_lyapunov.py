"""The Lyapunov function falls along random orbits on SO(3..6) and SE(2..4), by the amount that is claimed."""

import numpy as np
import pytest
from bodies import mass_tensor

import nonholo as nh
from nonholo.systems import AbstractLLSystem


def _body(name: str, rng: np.random.Generator) -> AbstractLLSystem:
    kind, n = name.split()
    if kind == "top":
        return nh.SuslovTop(mass_tensor(nh.SO(int(n)), rng))
    if int(n) == 2:
        return nh.ChaplyginSleigh(*rng.uniform(0.3, 1.5, size=2), *rng.normal(size=2))
    center = rng.normal(size=int(n)) * ([0.0] + [1.0] * (int(n) - 1) if kind == "turning" else 1.0)
    return nh.MultidimensionalSleigh(rng.uniform(0.3, 1.5), center, mass_tensor(nh.SO(int(n)), rng))


NAMES = ["top 3", "top 4", "top 5", "top 6", "sleigh 2", "sleigh 3", "sleigh 4", "turning 3", "turning 4"]


@pytest.mark.parametrize("name", NAMES)
def test_falls_by_the_claimed_amount(name: str) -> None:
    """The change in a step is -(4/h) sin^2(theta/2) times |c|^2 - (c.u)^2 (turning) or m |a_1| (sliding)."""
    rng = np.random.default_rng(4)
    system, h = _body(name, rng), 0.2
    rows = system.constraint_subspace
    orbit = nh.simulate(nh.discretize(system, h), restricted_velocity=0.5 * rng.normal(size=len(rows)), steps=20)
    x = system.group.log(orbit.displacement[:-1]) @ np.linalg.pinv(rows)
    turn = x[:, : 1 if name == "sleigh 2" else len(x[0]) - (0 if name.startswith("top") else 1)]
    theta = np.linalg.norm(turn, axis=1)
    if name.startswith("sleigh"):
        a1 = system.a if name == "sleigh 2" else system.center_of_mass[0]
        weight = np.full(len(theta), system.mass * abs(a1))
    else:
        c = system.coupling if name.startswith("top") else system.mass_tensor[0, 1:]
        weight = c @ c - (turn @ c / theta) ** 2
    expected = -4 / h * np.sin(theta / 2) ** 2 * weight
    change = np.diff(nh.lyapunov_function(system)(orbit.momentum))
    assert np.abs(change - expected).max() <= 1e-13 * max(1.0, np.abs(orbit.momentum).max())


@pytest.mark.profile("routes", keep=["top 4", "sleigh 3"])
@pytest.mark.parametrize("name", NAMES)
def test_falls_along_the_flow(name: str) -> None:
    """L falls between all saved states of a flow."""
    rng = np.random.default_rng(5)
    system = _body(name, rng)
    start = rng.normal(size=len(system.constraint_subspace))
    orbit = nh.flow(system, restricted_velocity=start, times=np.linspace(0.0, 1.0, 6))
    assert np.all(np.diff(nh.lyapunov_function(system)(orbit.momentum)) < 0)


def test_tilted_axis() -> None:
    """The function of a tilted top takes momenta in the user's body frame."""
    top = nh.SuslovTop.from_inertia([[3.0, 0.1, 0.2], [0.1, 2.0, 0.3], [0.2, 0.3, 2.5]], (2 / 3, -1 / 3, 2 / 3))
    orbit = nh.simulate(nh.discretize(top, 0.1), restricted_velocity=(0.5, 0.6), steps=50)
    assert np.all(np.diff(nh.lyapunov_function(top)(orbit.momentum)) < 0)


def test_balanced_and_refused() -> None:
    """For a balanced body the function is constant; a right-invariant constraint is refused."""
    assert nh.lyapunov_function(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])))([0.3, 0.4]) == 0
    with pytest.raises(ValueError, match="left-invariant"):
        nh.lyapunov_function(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])))
