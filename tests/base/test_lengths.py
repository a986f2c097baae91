"""Rows whose first numbers are divided by their length: the compiled loop against the formula."""

import numpy as np
import pytest

from nonholo.base.numerics import of_length_one


def _formula(x: np.ndarray, count: int) -> np.ndarray:
    squares = x[..., :1] * x[..., :1]
    for m in range(1, count):
        squares = squares + x[..., m : m + 1] * x[..., m : m + 1]
    return np.concatenate([x[..., :count] / np.sqrt(squares), x[..., count:]], axis=-1)


@pytest.mark.parametrize(("shape", "count"), [((4,), 4), ((500, 4), 4), ((3, 7, 4), 2), ((0, 4), 2), ((60, 9), 4)])
def test_rows_have_the_bits_of_the_formula(shape: tuple[int, ...], count: int) -> None:
    """In any shape and order in memory, for one row and for many, with zeros of both signs and uneven sizes."""
    rng = np.random.default_rng(7)
    x = rng.normal(size=shape) * 10.0 ** rng.integers(-120, 120, shape)
    x[..., 1:2] *= -0.0
    wide = np.repeat(x, 2, axis=-1)[..., ::2]
    before = x.copy()
    for one in (x, wide, np.asfortranarray(x)):
        found = of_length_one(one, count)
        assert np.array_equal(found.view(np.int64), _formula(x, count).view(np.int64))
    assert np.array_equal(x, before)
    assert not np.shares_memory(of_length_one(x, count), x)


def test_other_numbers_go_by_the_formula() -> None:
    """Single precision stays what it is; what has no length is NaN, and infinite numbers give none."""
    assert of_length_one(np.array([3.0, 4.0], dtype=np.float32), 2).dtype == np.float32
    with np.errstate(invalid="ignore"):  # of plain Python
        bad = of_length_one(np.array([[0.0, 0.0, 1.0], [np.inf, 1.0, 2.0], [np.nan, 1.0, 3.0]]), 2)
    assert np.array_equal(np.isnan(bad), [[True, True, False], [True, False, False], [True, True, False]])
