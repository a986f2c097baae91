"""Designs: which members there are, and that each has its values whatever is asked for beside it."""

import itertools
from collections.abc import Callable
from typing import Any

import hypothesis
import numpy as np
import pytest
from hypothesis import strategies as st
from refusals import refusals

import nonholo as nh
from nonholo.ensembles.designs import block_of
from nonholo.ensembles.distributions import AbstractDistribution
from nonholo.ensembles.stores import layout_of

MEMBERS = 40_000
DISTRIBUTIONS = {
    "uniform": nh.Uniform(-1.0, 3.0),
    "uniform vector": nh.Uniform([0.0, -2.0, 1.0], [1.0, 2.0, 1.5]),
    "log": nh.LogUniform(0.1, 20.0),
    "normal": nh.Normal(2.0, 3.0),
    "normal vector": nh.Normal(size=5),
    "direction": nh.Direction(3, 2.0),
    "mass tensor": nh.MassTensor(3, 0.5, 2.0),
    "choice": nh.Choice([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]),
}
EACH = pytest.mark.parametrize("distribution", DISTRIBUTIONS.values(), ids=DISTRIBUTIONS.keys())


def _drawn(distribution: AbstractDistribution, members: int = MEMBERS, seed: int = 3) -> np.ndarray:
    return nh.RandomDesign(members, {"x": distribution}, rng=seed).values(0, members)["x"]


def _assert_mean(samples: np.ndarray, mean: Any) -> None:
    """Compare a mean with the true one: five standard errors, which one draw in two million exceeds."""
    error = samples.std(axis=0) / np.sqrt(len(samples))
    assert (np.abs(samples.mean(axis=0) - mean) <= 5 * error + 1e-15).all()


def test_members_of_a_grid_are_all_combinations() -> None:
    """Members are numbered as nested loops run, the last axis innermost, also where values are vectors."""
    axes = {"a": [1.0, 2.0], "start": [[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]], "b": [7.0, 8.0]}
    result = nh.Grid(axes).values(0, 12)
    for member, (a, start, b) in enumerate(itertools.product(*axes.values())):
        assert result["a"][member] == a
        assert result["start"][member].tolist() == start
        assert result["b"][member] == b


def test_a_large_grid_costs_nothing() -> None:
    """Of 10^18 members any few are found at once, with exact numbers."""
    design = nh.Grid({name: np.arange(1e6) for name in ("a", "b", "c")})
    assert design.members == 10**18
    last = design.values(10**18 - 1, 1)
    assert [last[name].tolist() for name in "abc"] == [[999_999.0]] * 3


@EACH
@hypothesis.given(cuts=st.sets(st.integers(1, 39), max_size=6))
@hypothesis.settings(max_examples=20)
def test_random_members_do_not_depend_on_blocks(distribution: AbstractDistribution, cuts: set[int]) -> None:
    """Members drawn in any blocks are those drawn at once, bit by bit."""
    design = nh.RandomDesign(40, {"x": distribution})
    borders = [0, *sorted(cuts), 40]
    parts = [design.values(begin, end - begin)["x"] for begin, end in itertools.pairwise(borders)]
    assert np.concatenate(parts).tobytes() == design.values(0, 40)["x"].tobytes()


@EACH
def test_random_members_do_not_depend_on_the_rest(distribution: AbstractDistribution) -> None:
    """A member is the same among more members and beside other names, bit by bit."""
    few = nh.RandomDesign(10, {"x": distribution}, rng=5).values(3, 4)["x"]
    others: dict[str, Any] = {"w": nh.Normal(), "x": distribution, "y": nh.Uniform(0, 1)}
    assert nh.RandomDesign(10**12, others, rng=5).values(3, 4)["x"].tobytes() == few.tobytes()


@pytest.mark.parametrize(
    ("one", "other"), [(("x", 0), ("y", 0)), (("x", 0), ("x", 1)), (("x", 1), ("y", 2))], ids=["names", "seeds", "both"]
)
def test_names_and_seeds_are_independent(one: tuple[str, int], other: tuple[str, int]) -> None:
    """Numbers of different names or seeds are not correlated, nor are those of neighbors: five standard errors."""
    first, second = (
        nh.RandomDesign(MEMBERS, {name: nh.Uniform(-1, 1)}, rng=seed).values(0, MEMBERS)[name]
        for name, seed in (one, other)
    )
    for shift in (0, 1, -1):
        assert abs(np.mean(first * np.roll(second, shift))) < 5 / 3 / np.sqrt(MEMBERS)  # products have variance 1/9


def test_random_numbers_of_tasks_are_not_those_of_the_design() -> None:
    """A task may draw numbers by member, independent of the design, of other streams and of other seeds."""
    block, other = (block_of(nh.RandomDesign(MEMBERS, {"x": nh.Uniform(-1, 1)}, seed), 0, MEMBERS) for seed in (0, 1))
    streams = [block.random(1, stream) for stream in ("", "x", "y")] + [other.random(1)]
    drawn = [block["x"], other["x"], *(2 * stream[:, 0] - 1 for stream in streams)]
    for one, other in itertools.combinations(drawn, 2):
        assert abs(np.mean(one * other)) < 5 / 3 / np.sqrt(MEMBERS)


@pytest.mark.parametrize(
    ("distribution", "low", "high"),
    [
        (nh.Uniform(-1.0, 3.0), -1.0, 3.0),
        (nh.Uniform([0.0, -2.0], [1.0, 2.0]), [0.0, -2.0], [1.0, 2.0]),
        (nh.LogUniform(0.1, 20.0), 0.1, 20.0),
        (nh.LogUniform(0.3, 0.3), 0.3, 0.3),
    ],
    ids=["uniform", "vector", "log", "log of one point"],
)
def test_draws_stay_within_bounds(distribution: AbstractDistribution, low: Any, high: Any) -> None:
    """Draws do not leave the bounds, not even by rounding, for the least and the largest uniform numbers too."""
    extreme = np.repeat([[0.0], [np.nextafter(1.0, 0.0)]], distribution.width, axis=1)
    for draws in (_drawn(distribution), distribution.draw(extreme)):
        assert (draws >= low).all()
        assert (draws <= high).all()


@pytest.mark.parametrize(
    ("distribution", "of", "mean", "variance"),
    [
        (nh.Uniform(-1.0, 3.0), np.asarray, 1.0, 16 / 12),
        (nh.LogUniform(0.1, 10.0), np.log, 0.0, np.log(100.0) ** 2 / 12),
        (nh.Normal(2.0, 3.0), np.asarray, 2.0, 9.0),
        (nh.Normal(size=4), np.asarray, 0.0, 1.0),
    ],
    ids=["uniform", "log", "normal", "normal vector"],
)
def test_moments(distribution: AbstractDistribution, of: Callable[..., Any], mean: float, variance: float) -> None:
    """Means and variances are those of the distribution, to five standard errors of 40 000 draws."""
    draws = of(_drawn(distribution))
    _assert_mean(draws, mean)
    _assert_mean((draws - mean) ** 2, variance)


def test_directions_point_anywhere() -> None:
    """Directions have the length asked for; each component on a sphere is uniform, and no two are correlated."""
    draws = _drawn(nh.Direction(3, 2.0)) / 2
    assert np.abs(np.linalg.norm(draws, axis=1) - 1).max() < 4e-16
    for power, mean in ((1, 0.0), (2, 1 / 3), (3, 0.0), (4, 1 / 5), (6, 1 / 7)):  # of a uniform number in [-1, 1]
        _assert_mean(draws**power, mean)
    _assert_mean(draws * np.roll(draws, 1, axis=1), 0.0)


def test_mass_tensors_have_uniform_eigenvalues_and_any_axes() -> None:
    """Eigenvalues of mass tensors lie between the bounds, to rounding, with the moments of uniform numbers."""
    J = _drawn(nh.MassTensor(3, 0.5, 2.0))
    assert (J.swapaxes(1, 2) == J).all()
    eigenvalues, axes = np.linalg.eigh(J)
    assert eigenvalues.min() > 0.5 * (1 - 1e-14)
    assert eigenvalues.max() < 2.0 * (1 + 1e-14)
    for power in (1, 2, 3):  # sums, because eigenvalues come sorted
        mean = 3 * (2.0 ** (power + 1) - 0.5 ** (power + 1)) / (1.5 * (power + 1))
        _assert_mean((eigenvalues**power).sum(axis=1), mean)
    along = axes[:, :, 2]
    _assert_mean(along[:, :, None] * along[:, None, :], np.eye(3) / 3)
    _assert_mean(along**4, 1 / 5)


def test_choices_are_the_values() -> None:
    """All values are chosen, nothing else is, and each as often as the others."""
    values = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    draws = _drawn(nh.Choice(values))
    result = (draws[:, None] == values).all(axis=2)
    assert (result.sum(axis=1) == 1).all()
    _assert_mean(result, 1 / 3)


def test_blocks_know_their_members() -> None:
    """A block and a part of it have the numbers, the values and the random numbers of their members."""
    design = nh.RandomDesign(100, {"x": nh.Uniform(0, 1), "start": nh.Direction(2)}, rng=8)
    whole, block = block_of(design, 0, 100), block_of(design, 40, 20)
    for piece, members in ((block, slice(40, 60)), (block.part(5, 9), slice(45, 49))):
        assert piece.index.tolist() == list(range(100))[members]
        assert piece.count == members.stop - members.start
        for name in ("x", "start"):
            assert np.array_equal(piece[name], whole[name][members])
        assert np.array_equal(piece.random(5, "a"), whole.random(5, "a")[members])
    with pytest.raises(KeyError, match="the design has x, start"):
        block["y"]


@hypothesis.given(sizes=st.lists(st.integers(1, 7), min_size=1, max_size=4).map(tuple), block=st.integers(1, 50))
def test_every_member_is_in_one_block(sizes: tuple[int, ...], block: int) -> None:
    """Blocks cover every member once, hold at most this many, and their members follow each other in the arrays."""
    layout = layout_of(sizes, block)
    numbers, counts = np.arange(np.prod(sizes)).reshape(sizes), np.zeros(sizes, dtype=int)
    for number in range(layout.blocks):
        piece = layout.piece(number)
        assert piece.count <= block
        assert numbers[piece.place].ravel().tolist() == list(range(piece.first, piece.first + piece.count))
        counts[piece.place] += 1
    assert (counts == 1).all()


@pytest.mark.parametrize("block", [1, 100, 4096])
def test_blocks_are_not_small(block: int) -> None:
    """Where trailing dimensions are short, a block takes several of them: at least half of what it may."""
    assert layout_of((1000, 50, 3, 2), block).piece(0).count > block / 2


# What is no design, no distribution or no name is refused with the reason.
test_bad_designs_are_refused = refusals(
    (lambda: nh.Grid([1.0, 2.0]), r"Grid\(axes=...\)` must be a mapping"),
    (lambda: nh.Grid({}), "must be a mapping"),
    (lambda: nh.Grid({"a": []}), "hold at least one value"),
    (lambda: nh.Grid({"a": [1.0, np.nan]}), "must be finite"),
    (lambda: nh.Grid({"a": ["one"]}), "array of real numbers"),
    (lambda: nh.Grid({"a/b": [1.0]}), "be a name: a letter"),
    (lambda: nh.Grid({"outcome": [1.0]}), "taken: member, outcome, run, t, time"),
    (lambda: nh.Grid({"a": [[1.0, 2.0]], "a_number": [1.0]}), "other names than its vectors"),
    (lambda: nh.Grid({"a": [1.0]}, rng=-1), "be a natural number|be at most"),
    (lambda: nh.Grid({"a": [1.0, 2.0]}).values(1, 2), r"`Grid.values\(count=...\)` must not lead beyond"),
    (lambda: nh.RandomDesign(5, {"a": nh.Normal()}).values(0, 6), "must not lead beyond the last member"),
    (lambda: nh.RandomDesign(0, {"a": nh.Normal()}), "must be a positive integer"),
    (lambda: nh.RandomDesign(5, {"a": 1.0}), "be a distribution. Got 1.0. Pass nh.Uniform"),
    (lambda: nh.RandomDesign(5, {}), "must be a mapping"),
    (lambda: nh.RandomDesign(5, {"a": nh.Normal()}, rng=True), "be a natural number|be at most"),
    (lambda: nh.Uniform(2.0, 1.0), "not be below `low`"),
    (lambda: nh.LogUniform([], 1.0), r"LogUniform\(low=...\)` must have a number. Got none"),
    (lambda: nh.LogUniform(0.0, 1.0), r"LogUniform\(low=...\)` must be positive"),
    (lambda: nh.Normal(0.0, 0.0), "must be positive"),
    (lambda: nh.Direction(0), "must be a positive integer"),
    (lambda: nh.MassTensor(3, -1.0, 1.0), "be one positive number"),
    (lambda: nh.Choice([]), "hold at least one value"),
)


def test_draws_do_not_depend_on_the_spelling_of_components() -> None:
    """A component of a start has the same random numbers under both of its names."""
    drawn = [
        nh.RandomDesign(5, {name: nh.Uniform(0, 1)}, rng=3).values(0, 5)["momentum_1"]
        for name in ("momentum[1]", "momentum_1")
    ]
    assert np.array_equal(*drawn)


def test_an_integer_draws_what_it_always_drew() -> None:
    """The bits of `rng=5` are those that version 0.2 drew from `seed=5`."""
    drawn = nh.RandomDesign(10**6, {"x": nh.Uniform(0, 1)}, rng=5).values(3, 2)["x"]
    assert [number.hex() for number in drawn.tolist()] == ["0x1.ae059de331ec2p-2", "0x1.aebe25230f6b5p-1"]


def test_a_generator_draws_the_integer() -> None:
    """Equal generators make equal designs, the next design of one is another, and each is that of its integer."""
    generator, distributions = np.random.default_rng(2), {"x": nh.Uniform(0, 1)}
    first, second = (nh.RandomDesign(4, distributions, rng=generator) for _ in range(2))
    assert first.seed == nh.Grid({"x": [1.0]}, rng=np.random.default_rng(2)).seed != second.seed
    again = nh.RandomDesign(4, distributions, rng=first.seed)
    assert again.values(0, 4)["x"].tobytes() == first.values(0, 4)["x"].tobytes()


@pytest.mark.parametrize("make", [nh.Grid, nh.RandomDesign, nh.dataset])
def test_the_former_keyword_names_the_new_one(make: Callable[..., Any]) -> None:
    """`seed=` is refused with the word of today and the page that lists such changes."""
    with pytest.raises(ValueError, match=rf"{make.__name__}\(seed=...\)` must be called `rng`.*migration"):
        make(seed=3)
