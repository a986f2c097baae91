"""The inverse of the derivative of exp against its series, its definition and the logarithm."""

import math

import numpy as np
import pytest
from groups.examples import GROUPS, close, vectors
from scipy.special import bernoulli

from nonholo.groups import SE, SO, AbstractMatrixGroup


@pytest.mark.parametrize("group", GROUPS, ids=str)
def test_dexp_inverse_is_the_bernoulli_series(group: AbstractMatrixGroup) -> None:
    """Sum B_k ad^k / k!, with B_1 = -1/2; sixty terms are exact for ad of norm below 3."""
    for ad, found in zip(group.ad(x := vectors(group, 4, 0.3)), group.dexp_inverse(x), strict=True):
        power, total = np.eye(group.dim), np.zeros_like(ad)
        for k, number in enumerate(bernoulli(60)):
            total, power = total + number * power / math.factorial(k), power @ ad
        assert close(found, total, 200)


@pytest.mark.parametrize("group", [SO(3), SE(2)], ids=str)
@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-4, 0.5, 1 - 1e-9, 1 + 1e-9, 3.0, np.pi, 6.0])
def test_closed_forms_agree_with_the_definition(group: AbstractMatrixGroup, angle: float) -> None:
    """The closed form in ad and ad^2 against the inverse of the integrated exponential; near 2 pi both grow."""
    x = np.array([1.0, -1.0, 2.0]) * angle if group == SE(2) else np.array([2.0, -1.0, 2.0]) / 3 * angle
    assert close(group.dexp_inverse(x), AbstractMatrixGroup.dexp_inverse(group, x), 1000)


@pytest.mark.parametrize("group", [SO(4), SE(3)], ids=str)
def test_dexp_inverse_holds_at_large_angles(group: AbstractMatrixGroup) -> None:
    """Where ad has eigenvalues near 2 pi i, the derivative of exp times this is still the identity."""
    x = np.zeros(group.dim)
    x[0], x[-1] = 3.0, 3.0  # SO(4): two planes, ad has eigenvalues 6 i
    ad = group.ad(x)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    dexp = sum(w / 2 * group.adjoint(group.exp((t + 1) / 2 * x)) for t, w in zip(nodes, weights, strict=True))
    assert np.abs(ad).max() >= 3
    assert close(group.dexp_inverse(x) @ dexp, np.eye(group.dim), 1000)
