"""Sides of the line of equilibria, and the theorem on discrete orbits of the top, with what its proof gets wrong."""

import numpy as np
import pytest
from bodies import ATTRACTING
from refusals import refusals

import nonholo as nh
from nonholo.discrete import Discretization

SYSTEMS = {name: ATTRACTING[name] for name in ("top 3", "top 3, tilted", "sleigh 2", "sleigh 2, backward")}
STEP = 0.25


def _paper(top: nh.SuslovTop, displacement: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return s, Q and q_0 in the paper's letters, q from the quaternion of the displacement."""
    J, (w, x, y, _) = top.mass_tensor, _quaternions(displacement)
    s = J[0, 2] * x + J[1, 2] * y
    Q = (J[0, 1] * J[0, 2] + J[1, 1] * J[1, 2] + J[1, 2] * J[2, 2]) * x
    return s, Q - (J[0, 0] * J[0, 2] + J[0, 1] * J[1, 2] + J[0, 2] * J[2, 2]) * y, w


def _quaternions(W: np.ndarray) -> np.ndarray:
    """Return (q0, q1, q2, q3), q0 > 0, by the formula for angles below pi."""
    w = np.sqrt(1 + np.trace(W, axis1=-2, axis2=-1)) / 2
    skew = (W - np.swapaxes(W, -1, -2)) / (4 * w[..., None, None])
    return np.array([w, skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]])


def _combinations(top: nh.SuslovTop, momentum: np.ndarray) -> np.ndarray:
    """Return the paper's two combinations of half the scaled momentum."""
    J, (M1, M2, _) = top.mass_tensor, np.moveaxis(STEP * momentum / 2, -1, 0)
    first = (J[0, 2] * (J[0, 0] + J[2, 2]) + J[0, 1] * J[1, 2]) * M1
    first = first + (J[1, 2] * (J[1, 1] + J[2, 2]) + J[0, 1] * J[0, 2]) * M2
    return np.array([first, J[1, 2] * M1 - J[0, 2] * M2])


def _orbits(discrete: Discretization, shares: np.ndarray, seed: int = 0) -> list[nh.Orbit]:
    """Run orbits whose energies are shares of the saddle's, or of the bound of the single-valued region."""
    system, rng, found = discrete.system, np.random.default_rng(seed), []
    top = isinstance(system, nh.SuslovTop)
    bound = nh.critical_energies(discrete).saddle if top else nh.single_valued_region(discrete).energy
    for share in shares:
        r = rng.normal(size=2)
        r *= np.sqrt(share * bound / system.constrained_energy(r))
        found.append(nh.simulate(discrete, momentum=r, steps=60, reconstruct=False))
    return found


def test_they_are_the_letters_of_the_paper() -> None:
    """For the axis e3 `side` and `forward` of displacements are s and Q, of momenta twice its two combinations."""
    top = SYSTEMS["top 3"]
    discrete = nh.discretize(top, STEP)
    for orbit in _orbits(discrete, np.array([0.1, 0.9])):
        s, Q, _ = _paper(top, orbit.displacement)
        found = nh.half_planes(discrete, displacement=orbit.displacement)
        assert np.abs(found.side - s).max() <= 1e-14
        assert np.abs(found.forward - Q).max() <= 1e-14
        assert (
            np.abs(
                np.array(nh.half_planes(discrete, momentum=orbit.momentum)) / 2 - _combinations(top, orbit.momentum)
            ).max()
            <= 1e-14
        )


@pytest.mark.parametrize("name", SYSTEMS)
def test_attracting_equilibria_are_forward(name: str) -> None:
    """False in the paper: the stable half-line is in Theta_-. It is in Theta_+, on no side, for momenta too."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    spectrum = nh.equilibria(discrete, 0.3)
    assert abs(spectrum.multipliers[0]) < 1
    start = nh.simulate(discrete, body_velocity=spectrum.velocity, steps=1)
    for found in (
        nh.half_planes(discrete, displacement=start.displacement),
        nh.half_planes(discrete, momentum=start.momentum),
        nh.half_planes(discrete, momentum=start.restricted_momentum),
    ):
        assert np.all(found.forward > 0)
        assert np.abs(found.side).max() <= 1e-15
    reverse = nh.half_planes(discrete, displacement=np.linalg.inv(start.displacement))
    assert np.all(reverse.forward < 0)


@pytest.mark.parametrize("name", SYSTEMS)
def test_orbits_stay_on_their_side(name: str) -> None:
    """Up to 98 % of the bound every orbit keeps the signs of both sides, and moves forward at every step."""
    discrete = nh.discretize(SYSTEMS[name], STEP)
    for orbit in _orbits(discrete, np.linspace(0.02, 0.98, 25)):
        moving = np.abs(nh.half_planes(discrete, momentum=orbit.momentum).side) > 1e-6  # growth is of order 1e-12
        momentum = nh.half_planes(discrete, momentum=orbit.momentum[moving])
        displacement = nh.half_planes(discrete, displacement=orbit.displacement[moving])
        assert np.all(np.sign(momentum.side) == np.sign(momentum.side[0]))
        assert np.all(np.sign(displacement.side) == np.sign(momentum.side[0]))
        assert np.all(np.diff(momentum.forward) > 0)


def test_a_balanced_body_has_no_sides() -> None:
    """All numbers are zero for a balanced top."""
    discrete = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0])), STEP)
    found = nh.half_planes(discrete, momentum=np.ones((4, 3)))
    assert not np.any(found)
    assert found.side.shape == (4,)


# Other systems and maps, none or two arguments, and wrong shapes are named.
test_wrong_arguments_are_refused = refusals(
    (nh.discretize(nh.SuslovTop(np.eye(4)), 0.1), {"momentum": np.ones(6)}, "top with n = 3 or of a sleigh"),
    (nh.discretize(SYSTEMS["top 3"], 0.1, difference="logarithmic"), {"momentum": np.ones(3)}, "keep energy"),
    (nh.discretize(SYSTEMS["top 3"], 0.1), {}, "be given displacement or momentum. Got none"),
    (
        nh.discretize(SYSTEMS["top 3"], 0.1),
        {"momentum": np.ones(3), "displacement": np.eye(3)},
        "be given displacement or momentum. Got both",
    ),
    (nh.discretize(SYSTEMS["top 3"], 0.1), {"momentum": np.ones(4)}, "end in shape"),
    (nh.discretize(SYSTEMS["top 3"], 0.1), {"displacement": np.eye(2)}, "end in shape"),
    ask=lambda discrete, options: nh.half_planes(discrete, **options),
)
