"""Linear integrals: rates along sampled motions, the discrete map, the textbook cases."""

import numpy as np
import pytest

import nonholo as nh
from nonholo.analysis._invariants import conserved_momenta
from nonholo.systems import (
    AbstractSystem,
    LLSystem,
    LRSystem,
    MultidimensionalSleigh,
    RigidBody,
    SuslovTop,
    VeselovaTop,
)

_J = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
_UNEQUAL, _ROUND = np.diag([1.0, 2.0, 3.0]), np.diag([1.0, 1.0, 3.0])
_BODY_IN_SPACE = MultidimensionalSleigh(1.2, [0.3, -0.2, 0.4], _J).homogeneous_mass_tensor
_E6 = np.eye(6)

# (number of conserved body components, of conserved spatial components)
LEFT = {
    "top": (SuslovTop(_J), 0, 0),
    "balanced top": (SuslovTop(_UNEQUAL), 2, 0),
    "balanced top of revolution": (SuslovTop(_ROUND), 2, 3),  # no reaction at all
    "tilted balanced top": (SuslovTop.from_inertia(_UNEQUAL, (0, 1, 0)), 2, 0),
    "balanced top in four dimensions": (SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0])), 3, 0),
    "sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.2), 0, 0),
    "balanced sleigh": (nh.ChaplyginSleigh(1.0, 1.0, 0.0, 0.5), 2, 0),
    "sleigh in space, center of mass beside": (MultidimensionalSleigh(1.0, [0.0, 0.3, 0.2], _J), 1, 0),
    "free top": (RigidBody(_UNEQUAL), 0, 3),
    "free top of revolution": (RigidBody(_ROUND), 1, 3),
    "free sphere": (RigidBody(np.eye(3)), 3, 3),
    "one plane of rotation": (LLSystem(nh.SO(3), _J, [[1.0, 0.0, 0.0]]), 1, 0),
    "a body that may not turn": (LLSystem(nh.SE(3), _BODY_IN_SPACE, _E6[3:]), 3, 6),
    "a body that may not spin": (LLSystem(nh.SE(3), _BODY_IN_SPACE, _E6[1:]), 0, 3),  # translations: an ideal in d
}
RIGHT = {
    "Veselova top": (VeselovaTop(_UNEQUAL), 0, 2),
    "Veselova sphere": (VeselovaTop(np.eye(3)), 3, 3),
    "Veselova top in four dimensions": (VeselovaTop(np.diag([1.0, 2.0, 3.0, 4.0])), 0, 3),
    "free body with rows in space": (LRSystem(nh.SO(3), _UNEQUAL, np.eye(3)), 0, 3),
    "plane body": (LRSystem(nh.SE(2), _J, np.eye(3)[:2]), 0, 2),
    "body in space": (LRSystem(nh.SE(3), _BODY_IN_SPACE, _E6[:4]), 0, 4),
}


@pytest.mark.parametrize("name", LEFT | RIGHT)
def test_conserved_components(name: str) -> None:
    """The counts are the known ones; listed components do not change at 60 random states, all others do at some.

    Components along a constraint in space are among the spatial ones; in the body momenta are known along it alone.
    """
    system, body, spatial = (LEFT | RIGHT)[name]
    found, rows = conserved_momenta(system), system.constraint_subspace
    assert (len(found.body), len(found.spatial)) == (body, spatial)
    in_body, in_space = map(np.array, zip(*(_rates(system, seed) for seed in range(60)), strict=True))
    known = np.eye(system.group.dim) if system.is_spatial else np.linalg.pinv(rows) @ rows
    _check(system, found.body, in_body @ known, 0 if system.is_spatial else len(system.annihilator))
    _check(system, found.spatial, in_space, 0)
    if system.is_spatial:
        assert np.linalg.matrix_rank(np.concatenate([found.spatial, rows]), tol=1e-9) == len(found.spatial)


def _check(system: AbstractSystem, rows: np.ndarray, rates: np.ndarray, without: int) -> None:
    """Rates are central differences at velocities of order one: rounding eps/step and truncation step^2 leave 1e-9."""
    scale = np.abs(system.inertia_operator).max()
    assert np.abs(rows @ rates.T).max(initial=0.0) < 1e-8 * scale
    assert np.linalg.matrix_rank(rates, tol=1e-6 * scale) == system.group.dim - without - len(rows)


def _rates(system: AbstractSystem, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Rates of body and spatial momentum along the vector field, by central differences."""
    rng, group, k, step = np.random.default_rng(seed), system.group, system.rank, 1e-5
    state = np.concatenate([rng.normal(size=k), group.random(rng).ravel()])

    def momenta(state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        g = state[k:].reshape(group.identity.shape)
        back = np.linalg.inv(group.adjoint(g))
        velocity = system.restricted_velocity(state[:k], g) @ system.constraint_subspace
        p = system.inertia_operator @ (back @ velocity if system.is_spatial else velocity)
        return p, back.T @ p

    rate = nh.vector_field(system)(0.0, state)
    ahead, behind = momenta(state + step * rate), momenta(state - step * rate)
    return (ahead[0] - behind[0]) / (2 * step), (ahead[1] - behind[1]) / (2 * step)


@pytest.mark.parametrize(
    "name", ["balanced top", "tilted balanced top", "balanced top of revolution", "balanced sleigh"]
)
def test_discrete_map_keeps_the_body_components(name: str) -> None:
    """The balanced tops and sleighs keep their momenta along d for 200 large steps, to rounding."""
    system = LEFT[name][0]
    orbit = nh.simulate(nh.discretize(system, 0.4), restricted_velocity=(0.7, -0.4), steps=200)
    kept = orbit.momentum @ conserved_momenta(system).body.T
    assert np.abs(kept - kept[0]).max() < 200 * np.finfo(np.float64).eps * np.abs(orbit.momentum).max()


def test_discrete_map_of_the_top_of_revolution_keeps_all_spatial_momenta() -> None:
    """Without reactions the discrete top keeps its spatial momentum as the continuous one does; its sister does not."""
    drifts = []
    for name in ("balanced top of revolution", "balanced top"):
        orbit = nh.simulate(nh.discretize(LEFT[name][0], 0.4), restricted_velocity=(0.7, -0.4), steps=200)
        drifts.append(np.abs(orbit.spatial_momentum - orbit.spatial_momentum[0]).max())
    assert drifts[0] < 1e-12 < 0.1 < drifts[1]


def test_flow_keeps_what_is_listed_and_nothing_else() -> None:
    """Along a computed flow the balanced top keeps p along d, the unbalanced one does not."""
    times = np.linspace(0.0, 5.0, 6)
    balanced, unbalanced = LEFT["balanced top"][0], LEFT["top"][0]
    kept = nh.flow(balanced, body_velocity=(0.5, 0.3, 0.0), times=times).momentum @ conserved_momenta(balanced).body.T
    assert np.abs(kept - kept[0]).max() < 1e-12
    moved = nh.flow(unbalanced, body_velocity=(0.5, 0.3, 0.0), times=times).momentum @ unbalanced.constraint_subspace.T
    assert np.abs(moved - moved[0]).max() > 0.1


def test_only_systems_have_momenta() -> None:
    """Anything else is refused, systems in coordinates in these words."""
    for other in (3, nh.examples.particle().system):
        with pytest.raises(ValueError, match=r"conserved_momenta\(system=\.\.\.\)` must be a system on a group. Got"):
            conserved_momenta(other)
