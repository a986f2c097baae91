"""Groups from a basis, products and translations: what they refuse, and when they are equal."""

import numpy as np
import pytest
from groups.examples import HEISENBERG, OBLIQUE, SL2, SL3, TWO_BODIES, WHEELED, close, vectors
from refusals import refusals

from nonholo.groups import SE, SO, MatrixGroup, ProductGroup, Translations

# Each refusal says what is wrong with the basis, and by how much.
test_bases_that_span_no_lie_algebra_are_refused = refusals(
    (np.full((1, 2, 2), np.nan), r"finite.*nan at index \(0, 0, 0\)"),
    (np.ones((2, 2)), r"shape \(any, any, any\).*\(2, 2\)"),
    (np.ones((1, 2, 3)), r"square matrices.*\(1, 2, 3\)"),
    (np.zeros((0, 2, 2)), r"square matrices.*\(0, 2, 2\)"),
    ([np.eye(2), np.zeros((2, 2))], r"linearly independent.*zero matrix at index 1"),
    ([np.eye(2), 2 * np.eye(2), np.ones((2, 2))], r"linearly independent.*3 matrices of rank 2"),
    ([np.eye(3, k=1) * [0, 1, 0], np.eye(3, k=1) * [0, 0, 1]], r"Lie algebra.*matrices 0 and 1.*by 1 \("),
    ask=MatrixGroup,
    begin=r"MatrixGroup\(basis=\.\.\.\).*",
)


def test_badly_scaled_bases_are_taken() -> None:
    """Units may differ by many powers of ten: independence and closure are judged by direction."""
    scales = np.array([1e-12, 1e12, 1.0])[:, None, None]
    group = MatrixGroup(scales * OBLIQUE.basis)
    assert close(group.vee(group.hat(np.array([1e12, 1e-12, 1.0]))) * scales[:, 0, 0], np.ones(3))


def test_a_group_from_a_basis_is_the_group_it_spans() -> None:
    """SO(3) in an oblique basis: the same matrices, covectors that transform by the inverse transpose."""
    change = np.array([[1.0, 2.0, 0.0], [0.0, 3.0, -1.0], [0.5, 0.0, 2.0]])
    x, p = vectors(OBLIQUE, 2, 0.4)
    g = OBLIQUE.exp(x)
    assert close(g, SO(3).exp(x @ change))
    assert close(OBLIQUE.coadjoint(g, p), change @ SO(3).coadjoint(g, np.linalg.solve(change, p)), 1000)
    assert close(OBLIQUE.coad(x, p), change @ SO(3).coad(x @ change, np.linalg.solve(change, p)), 1000)


@pytest.mark.parametrize(("group", "stays"), [(HEISENBERG, True), (SL2, True), (OBLIQUE, True), (SL3, False)])
def test_cayley_is_offered_where_it_stays_in_the_group(group: MatrixGroup, stays: bool) -> None:
    """On SL(2) determinants of the Cayley map are one, on SL(3) they are not."""
    assert group.has_cayley == stays


@pytest.mark.parametrize(
    ("first", "second", "other"),
    [
        (SL2, MatrixGroup(SL2.basis.tolist()), HEISENBERG),
        (MatrixGroup([[[0.0, 1.0], [0.0, 0.0]]]), MatrixGroup([[[-0.0, 1.0], [0.0, -0.0]]]), SL2),
        (WHEELED, ProductGroup(SE(2), Translations(2)), TWO_BODIES),
        (SO(5), SO(5), SO(4)),
        (Translations(2), Translations(2), Translations(3)),
    ],
)
def test_equal_groups_hash_alike(first: object, second: object, other: object) -> None:
    """Groups are equal by what they are made of, so that they can be static arguments of compiled functions."""
    assert first == second
    assert hash(first) == hash(second)
    assert first != other


# No factors, numbers as factors, vectors without components; a matrix where coordinates are needed, and the reverse.
test_what_is_no_group_is_refused = refusals(
    (ProductGroup, r"ProductGroup.*no factor"),
    (lambda: ProductGroup(SO(3), 3), r"ProductGroup.*Got 3"),  # type: ignore[arg-type]
    (lambda: Translations(0), r"Translations\(m=\.\.\.\).*Got 0"),
    (lambda: SO(1), r"SO\(n=\.\.\.\).*at least 2.*Got 1"),
    (lambda: SE(2.5), r"SE\(n=\.\.\.\).*positive integer.*Got 2\.5"),  # type: ignore[arg-type]
    (lambda: SO(3).exp(np.zeros(4)), r"SO\(3\) \(coordinates\).*shape \(3,\).*vee"),
    (lambda: SE(2).log(np.zeros((2, 2))), r"SE\(2\) \(element\).*hat"),
)


def test_products_act_by_blocks() -> None:
    """exp, adjoint and coad of SO(3) x SO(3) are those of the factors; entries outside the blocks count as residual."""
    x, p = vectors(TWO_BODIES, 2)
    g = TWO_BODIES.exp(x)
    assert np.array_equal(g[:3, :3], SO(3).exp(x[:3]))
    assert not g[:3, 3:].any()
    assert close(TWO_BODIES.adjoint(g)[3:, 3:], SO(3).adjoint(SO(3).exp(x[3:])))
    assert close(TWO_BODIES.coad(x, p), np.concatenate([SO(3).coad(x[i : i + 3], p[i : i + 3]) for i in (0, 3)]))
    g[0, 5] = 0.25
    assert TWO_BODIES.residual(g) == 0.25


def test_repr_names_sizes() -> None:
    """A group says what it is in one line."""
    assert repr(SL3) == "MatrixGroup(dim=8, N=3)"
    assert repr(ProductGroup(SE(3), SL2)) == "ProductGroup(SE(3), MatrixGroup(dim=3, N=2))"
