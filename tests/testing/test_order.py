"""The quick check of order for users: it finds the order that there is, and says where it is another one."""

import numpy as np
import pytest

import nonholo as nh
from nonholo.testing import check_order

SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
START = (1.0, 0.5, 0.0)


@pytest.mark.profile("routes", cases=["4"])
@pytest.mark.parametrize("order", [2, 4])
def test_the_order_is_found(order: int) -> None:
    """Slopes of momenta and poses are those of the composition, and the errors are drawn."""
    found = check_order(nh.discretize(SLEIGH, 0.2, order=order), START)
    assert np.allclose([found.order.momentum, found.order.pose], order, atol=0.1)
    assert found.plot().axes


def test_another_order_is_refused() -> None:
    """Slopes that are farther off than allowed are an error, which names them; without `throw` they are returned."""
    discrete = nh.discretize(SLEIGH, 0.2)
    with pytest.raises(AssertionError, match=r"must find order 2 \+- 1e-06. Got <Convergence"):
        check_order(discrete, START, tolerance=1e-6)
    assert abs(check_order(discrete, START, tolerance=1e-6, throw=False).order.momentum - 2) > 1e-6


def test_a_system_is_no_discretization() -> None:
    """What is refused is named with the remedy."""
    with pytest.raises(ValueError, match=r"check_order\(discrete=...\).*Pass `discretize"):
        check_order(SLEIGH, START)
