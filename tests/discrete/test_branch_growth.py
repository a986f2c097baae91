"""Images of a momentum: the growth of their number, words and their discs; the tree of images and its nodes."""

import functools
import itertools
from typing import Any

import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.discrete import BranchGrowth, BranchTree, legendre
from nonholo.discrete.branching._growth import Axis, best_words

BODIES = {
    "page": (nh.ChaplyginSleigh(1.0, 1.0, 0.55), 1.0),
    "offset": (nh.ChaplyginSleigh(2.3, 0.4, 0.7, 0.3), 0.2),
    "backwards": (nh.ChaplyginSleigh(0.6, 3.0, -0.4), 0.05),
    "nearly a point": (nh.ChaplyginSleigh(1.0, 1e-4, 0.5), 0.1),
    "nearly balanced": (nh.ChaplyginSleigh(1.0, 2.0, 1e-3), 0.3),
}
SHARES = (0.999, 0.5, 0.02)  # of the highest energy


def _level(name: str, share: float) -> tuple[nh.Discretization, float]:
    body, h = BODIES[name]
    M = float(body.mass * body.a**2)
    return nh.discretize(body, h), share * 2 * (float(body.inertia) + M) ** 2 / (M * h * h)


def _numbers(discrete: nh.Discretization) -> tuple[float, ...]:
    body: Any = discrete.system
    return body.mass, body.inertia, abs(body.a), discrete.time_step


def _axis(discrete: nh.Discretization, energy: float) -> Axis:
    return Axis.of((*_numbers(discrete), energy))


def _momentum(discrete: nh.Discretization, energy: float, x: float) -> np.ndarray:
    """Return the restricted momentum of x: pi = p_theta + b p_1 is imaginary."""
    body: Any = discrete.system
    p = np.sign(body.a) * np.sqrt(2 * body.mass * energy) * np.cosh(x)
    pi = np.sqrt(2 * (body.inertia + body.mass * body.a**2) * energy) * np.sinh(x)
    return np.array([1j * pi - body.b * p, p + 0j])


def _images(discrete: nh.Discretization, energy: float, x: float) -> np.ndarray:
    """Return the three x after the step, by tau: of the cubic, polished in 18 digits."""
    m, J, a, h, E, angle = map(np.longdouble, (*_numbers(discrete), energy, x))
    unit = h * np.sqrt(2 * (J + m * a * a) * E)
    pi, p = unit * np.sinh(angle), h * np.sqrt(2 * m * E) * np.cosh(angle)
    hat = a * p + 2 * m * a * a
    cubic = np.array([-hat, pi, 2 * J + hat, -pi])
    tau = np.sort(np.roots(cubic.astype(float)).real).astype(np.longdouble)
    for _ in range(4):
        tau -= np.polyval(cubic, tau) / np.polyval(np.polyder(cubic), tau)
    after = pi - 2 * a * tau * (p - 2 * a * m * tau**2 / (1 - tau**2))  # 1 - cos = 2 t^2/(1 + t^2), t = i tau
    return np.arcsinh(after / unit).astype(float)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("name", BODIES)
def test_the_map_on_the_axis_is_the_discrete_map(name: str, share: float) -> None:
    """The closed form in tau solves the matrix equation, complex as it is: momenta on the axis, before and after."""
    discrete, energy = _level(name, share)
    axis, h = _axis(discrete, energy), discrete.time_step
    body: Any = discrete.system
    middle = (1 + 1 / axis.turn) / 2
    for tau in (-middle, -0.7, 0.0, 0.2, 0.9, middle):
        before, after = axis.ends(tau)
        t = 1j * tau
        cos, sin = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        r, arrived = _momentum(discrete, energy, before), _momentum(discrete, energy, after)
        V = h * r[1] / body.mass + body.a * (1 - cos) + body.b * sin
        X = np.array([[cos - 1, -sin, V], [sin, cos - 1, t * V], [0, 0, 0]])
        result = [body.restrict(legendre(discrete, X, side)) for side in ("left", "right")]
        poles = min(1.0, abs(abs(tau) - 1), 1 - axis.turn * abs(tau)) / max(1.0, tau**2)  # rounding grows near them
        assert np.abs(np.array(result) - [r, arrived]).max() <= 1e-13 / poles * np.abs([r, arrived]).max()


@pytest.mark.parametrize("name", BODIES)
def test_each_point_of_the_axis_has_one_value_of_each_kind(name: str) -> None:
    """One root has |tau| < 1, one each lies beyond, all below 1/kappa; |x| falls on the first and grows on the others.

    Whether x after the step rises is what differences say.
    """
    for share in SHARES:
        discrete, energy = _level(name, share)
        axis, rng = _axis(discrete, energy), np.random.default_rng(1)
        for x in rng.uniform(-3, 3, 20) * axis.turn:
            images = _images(discrete, energy, x)
            inner, outer = axis.around(abs(x))[0], axis.around(x, outer=True)[0]
            expected = [axis.ends(outer)[1], np.copysign(axis.ends(inner)[1], x)]
            assert images[np.argsort(np.abs(images))[0]] == pytest.approx(expected[1], rel=1e-6, abs=1e-6 * axis.turn)
            assert images.min() == pytest.approx(expected[0], rel=1e-6)
            assert abs(expected[1]) < abs(x) < abs(expected[0])
            assert images.min() < -abs(x) < abs(x) < images.max()
            for tau in (inner, outer):
                step = 1e-5 * min(tau, abs(tau - 1), 1 / axis.turn - tau)
                low, high = axis.ends(tau - step), axis.ends(tau + step)
                assert low[0] < high[0]
                assert axis.rises(tau) == (low[1] < high[1])


@functools.cache
def _growth(name: str, share: float, certify: bool) -> BranchGrowth:
    discrete, energy = _level(name, share)
    return nh.branch_growth(discrete, certify, energy=energy)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("name", BODIES)
def test_words_map_the_interval_into_disjoint_parts(name: str, share: float) -> None:
    """Each word, step by step by the cubic, takes 15 points of the interval in order into its own disc."""
    discrete, energy = _level(name, share)
    growth = _growth(name, share, False)
    (middle, half), *discs = growth.discs
    ends = sorted((center - radius, center + radius) for center, radius in discs)
    assert middle - half < ends[0][0]
    assert all(one[1] < other[0] for one, other in itertools.pairwise(ends))
    assert ends[-1][1] < middle + half or (growth.discs[:2].sum(axis=1) <= 1e-12 * half).all()  # or both end at 0
    assert len(discs) == len(growth.words) == len(set(growth.words))
    for word, (center, radius) in zip(growth.words, discs, strict=True):
        reached = np.linspace(middle - half, middle + half, 15)
        for letter in word:
            reached = np.array([sorted(_images(discrete, energy, x))[letter * -1 + 1] for x in reached])
        assert np.abs(reached - center).max() <= radius + 1e-6 * half
        assert np.all(np.diff(reached) > 0)


def test_images_are_as_many_as_words() -> None:
    """From one momentum the words of N = 0 to 10 steps in all have a_N = a_(N-1) + 2 a_(N-3) different images."""
    discrete, energy = _level("page", 0.5)
    growth = _growth("page", 0.5, False)
    axis = _axis(discrete, energy)

    def moved(x: float, letter: int) -> float:
        side = np.sign(x) if letter == 0 else float(letter)
        return side * axis.ends(axis.around(side * x, outer=letter != 0)[0])[1]

    reached = [[growth.discs[0] @ [1.0, -0.5]]]
    for length in range(1, 11):
        images = []
        for word in growth.words:
            for x in reached[length - len(word)] if len(word) <= length else []:
                images.append(functools.reduce(moved, word, x))
        reached.append(images)
        assert len(images) == len(reached[-2]) + (2 * len(reached[-4]) if length >= 3 else 0)
        assert np.diff(np.sort(images)).min(initial=1.0) > 1e-9
    assert growth.rate == pytest.approx(np.roots([1, -1, 0, -2]).real.max(), rel=1e-14)
    assert growth.entropy == np.log(growth.rate)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("name", BODIES)
def test_balls_prove_what_doubles_find(name: str, share: float) -> None:
    """The certificate has the words and, to rounding, the discs of the search."""
    pytest.importorskip("flint")
    result, proved = _growth(name, share, False), _growth(name, share, True)
    assert (result.certified, proved.certified) == (False, True)
    assert result.words == proved.words
    assert np.abs(result.discs - proved.discs).max() <= 1e-5 * proved.discs[0, 1]


def test_the_certificate_doubts_what_is_false() -> None:
    """With balls as wide as a twentieth, which hold bodies of other words, nothing is proved."""
    flint = pytest.importorskip("flint")
    wide = lambda x: flint.arb(x) * flint.arb(1, 0.05)  # noqa: E731
    with pytest.raises(ArithmeticError):
        best_words(Axis.of((1.0, 1.0, 0.55, 1.0, 1.0), wide, flint.arb))


def test_rate_falls_with_the_energy() -> None:
    """By default the level is the highest; words at lower energies are longer, whatever the time step."""
    rates = []
    for share in (0.9, 0.1, 1e-2, 1e-4):
        discrete, energy = _level("page", share)
        rates.append(nh.branch_growth(discrete, energy=energy).rate)
        shorter = nh.discretize(discrete.system, 0.1)
        assert nh.branch_growth(shorter, energy=100 * energy).rate == rates[-1]
    assert nh.branch_growth(_level("page", 1.0)[0]).rate == rates[0] > rates[1] >= rates[2] > rates[3] > 1


SLEIGH, TOP = nh.ChaplyginSleigh(1.0, 1.0, 0.5), nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])


test_what_has_no_such_words_is_refused = refusals(
    ((nh.discretize(TOP, 0.1), {}), "`branch_tree` counts the images of tops"),
    ((nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1), {}), "ChaplyginSleigh, a = 0"),
    (
        (nh.discretize(nh.MultidimensionalSleigh(1.0, [0.5, 0.0, 0.0], np.eye(3)), 0.1), {}),
        r"Got MultidimensionalSleigh\. Pass",
    ),
    ((nh.discretize(SLEIGH, 0.1, difference="logarithmic"), {}), "map with three branches"),
    ((nh.discretize(SLEIGH, 0.1, order=4), {}), "order 2"),
    ((SLEIGH, {}), "discretized system"),
    ((nh.discretize(nh.Forced(SLEIGH, force=nh.Friction([0.1, 0.0, 0.0])), 0.1), {}), "force"),
    ((nh.discretize(SLEIGH, 0.1), {"energy": 1250.0}), "be below 1250 and give words of at most 1000 steps"),
    ((nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 1e-3), 0.1), {"energy": 1e-3}), "Pass an energy between these"),
    ((nh.discretize(SLEIGH, 0.1), {"energy": -1.0}), r"branch_growth\(energy=...\)"),
    ((nh.discretize(SLEIGH, 0.1), {"certify": 1}), "certify"),
    ((nh.discretize(nh.ChaplyginSleigh(1.0, 1e-30, 0.5), 0.1), {}), "less extreme body"),
    ask=lambda given: nh.branch_growth(given[0], **given[1]),
    kind=(ValueError, TypeError),
)


LONG_SLEIGH = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
LONG_TOP = nh.discretize(nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]), 0.5)
MOTION = nh.discretize(nh.MultidimensionalSleigh(1.3, [0.3, 0.2, -0.1], np.diag([0.5, 0.7, 0.4]) + 0.1), 0.3)
ROOTS = {
    "sleigh": (LONG_SLEIGH, nh.SE(2).exp(np.array([0.3, 0.1, 0.0]))),
    "top": (LONG_TOP, nh.SO(3).exp(np.array([0.3, -0.4, 0.0]))),
    "tilted top": (
        nh.discretize(
            nh.SuslovTop.from_inertia([[3, 0.1, 0.2], [0.1, 2, 0.3], [0.2, 0.3, 2.5]], (2 / 3, -1 / 3, 2 / 3)), 0.2
        ),
        np.eye(3),
    ),
    "motion": (MOTION, nh.SE(3).exp(np.array([0.0, 0.2, -0.3, 0.4, 0.0, 0.0]))),
}


def _tree(name: str, depth: int) -> tuple[nh.Discretization, BranchTree]:
    discrete, W = ROOTS[name]
    return discrete, nh.branch_tree(discrete, W, depth)


@pytest.mark.parametrize(("name", "base", "depth"), [("sleigh", 3, 5), ("top", 4, 4), ("motion", 5, 3)])
def test_images_multiply(name: str, base: int, depth: int) -> None:
    """A sleigh has 3, 9, 27, 81, 243 distinct images, a top in space 4, 16, ..., a sleigh on SE(3) 5, 25, ..."""
    _, tree = _tree(name, depth)
    assert tree.counts.tolist() == [base**level for level in range(depth + 1)]
    assert np.bincount(tree.level).tolist() == tree.counts.tolist()


@pytest.mark.parametrize("name", ["sleigh", "top", "motion"])
def test_each_node_follows_its_parent(name: str) -> None:
    """The momenta along the constraint are those that arrive from the parent: the defining equation, complex too.

    All have the energy of the root, r . B^-1 r / 2 without conjugation.
    """
    discrete, tree = _tree(name, 2)
    before, after = tree.displacement[tree.parent[1:]], tree.momentum[1:]
    images = before[:, None] @ discrete.system.group.basis @ np.linalg.inv(before)[:, None]
    carried = np.einsum("tji,ti->tj", discrete.system.group.vee(images), tree.momentum[tree.parent[1:]])
    missed = discrete.system.restrict(carried - after)
    size = np.abs(before).max((1, 2)) ** 2 * np.abs(tree.momentum[tree.parent[1:]]).max(1)
    assert np.abs(missed / size[:, None]).max() < 1e-12  # rounding of a product of three matrices
    r = discrete.system.restrict(tree.momentum)
    energy = np.einsum("ti,ij,tj->t", r, np.linalg.inv(discrete.system.constrained_inertia), r) / 2
    assert (np.abs(energy - energy[0]) / np.einsum("ti,ti->t", r.conj(), r).real).max() < 1e-12


@pytest.mark.parametrize("name", ["sleigh", "top", "motion"])
def test_the_first_generation_is_branches(name: str) -> None:
    """The images of the root are what `branches` finds, with the same mask of real ones."""
    discrete, tree = _tree(name, 1)
    result = nh.branches(discrete, displacement=ROOTS[name][1])
    np.testing.assert_allclose(tree.displacement[1:], result.displacement, rtol=0, atol=1e-13)
    np.testing.assert_allclose(tree.momentum[1:], result.momentum, rtol=0, atol=1e-11)  # 1/time_step larger
    assert np.array_equal(tree.is_real[1:], result.is_real)


def test_complex_nodes_have_conjugate_partners() -> None:
    """The root is real, so each generation is its own complex conjugate."""
    _, tree = _tree("top", 2)
    last = tree.displacement[tree.level == 2]
    missed = [np.abs(last - W.conj()).max((1, 2)).min() / np.abs(W).max() for W in last]
    assert max(missed) < 1e-9  # two generations of roots, near folds too


def test_equal_images_are_one_node() -> None:
    """At rest a top has images that its other images have too; they are counted once."""
    discrete, W = ROOTS["tilted top"]
    tree = nh.branch_tree(discrete, W, 2)
    assert tree.counts[2] < tree.counts[1] ** 2
    last = tree.displacement[tree.level == 2]
    apart = np.abs(last[:, None] - last[None]).max((2, 3)) + np.eye(len(last))
    assert apart.min() > 1e-10


def test_depth_zero_is_the_root() -> None:
    """With depth 0 the tree has one node, real and without a parent."""
    tree = nh.branch_tree(LONG_SLEIGH, np.eye(3), 0)
    assert (len(tree), tree.counts.tolist(), tree.parent.tolist(), tree.is_real.tolist()) == (1, [1], [-1], [True])


def test_a_single_image_has_a_single_line() -> None:
    """A balanced sleigh on a straight line has one image; the other half-turn is infinitely far."""
    straight = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.0), 0.1)
    assert nh.branch_tree(straight, nh.SE(2).exp(np.array([0.0, 0.1, 0.0])), 3).counts.tolist() == [1, 1, 1, 1]


# Each names the argument, the requirement, what was got and the remedy.
test_bad_arguments_are_refused = refusals(
    ((LONG_SLEIGH, np.eye(3), -1), r"depth=...\)` must be a natural number. Got -1"),
    ((LONG_SLEIGH, np.eye(3), 1.5), "must be a natural number. Got 1.5"),
    ((LONG_SLEIGH, np.eye(3), True), "must be a natural number. Got True"),
    ((LONG_SLEIGH, np.eye(3), 9), r"below 10000 images. Got 9, with 3\^9 images. Pass depth=8 or less"),
    ((LONG_SLEIGH, np.eye(2), 1), r"displacement=...\)` must have shape \(3, 3\)"),
    ((LONG_SLEIGH, nh.SE(2).exp(np.array([0.3, 0.1, 0.2])), 1), "must lie on the displacement variety"),
    ((nh.discretize(nh.RigidBody(np.diag([1.0, 2.0, 3.0, 4.0])), 0.1), np.eye(4), 1), "rank 1 to 4. Got .* rank 6"),
    (("sleigh", np.eye(3), 1), "must be a discretized system"),
    ask=lambda given: nh.branch_tree(*given),
)
