"""Groups from a basis, products and translations: what they refuse, and when they are equal."""

import numpy as np
import pytest
from forms import FORMS, algebra, hermitian, special
from groups.examples import HEISENBERG, OBLIQUE, SL2, SL3, TWO_BODIES, WHEELED, close, vectors
from refusals import refusals

import nonholo as nh

# Each refusal says what is wrong with the basis, and by how much.
test_bases_that_span_no_lie_algebra_are_refused = refusals(
    (np.full((1, 2, 2), np.nan), r"finite.*nan at index \(0, 0, 0\)"),
    (np.ones((2, 2)), r"shape \(any, any, any\).*\(2, 2\)"),
    (np.ones((1, 2, 3)), r"square matrices.*\(1, 2, 3\)"),
    (np.zeros((0, 2, 2)), r"square matrices.*\(0, 2, 2\)"),
    ([np.eye(2), np.zeros((2, 2))], r"linearly independent.*zero matrix at index 1"),
    ([np.eye(2), 2 * np.eye(2), np.ones((2, 2))], r"linearly independent.*3 matrices of rank 2"),
    ([np.eye(3, k=1) * [0, 1, 0], np.eye(3, k=1) * [0, 0, 1]], r"Lie algebra.*matrices 0 and 1.*by 1 \("),
    ask=nh.MatrixGroup,
    begin=r"MatrixGroup\(basis=\.\.\.\).*",
)


def test_badly_scaled_bases_are_taken() -> None:
    """Units may differ by many powers of ten: independence and closure are judged by direction."""
    scales = np.array([1e-12, 1e12, 1.0])[:, None, None]
    group = nh.MatrixGroup(scales * OBLIQUE.basis)
    assert close(group.vee(group.hat(np.array([1e12, 1e-12, 1.0]))) * scales[:, 0, 0], np.ones(3))


@pytest.mark.parametrize(
    ("first", "second", "other"),
    [
        (SL2, nh.MatrixGroup(SL2.basis.tolist()), HEISENBERG),
        (nh.MatrixGroup([[[0.0, 1.0], [0.0, 0.0]]]), nh.MatrixGroup([[[-0.0, 1.0], [0.0, -0.0]]]), SL2),
        (WHEELED, nh.ProductGroup(nh.SE(2), nh.Translations(2)), TWO_BODIES),
        (nh.SO(5), nh.SO(5), nh.SO(4)),
        (nh.Translations(2), nh.Translations(2), nh.Translations(3)),
    ],
)
def test_equal_groups_hash_alike(first: object, second: object, other: object) -> None:
    """Groups are equal by what they are made of, so that they can be static arguments of compiled functions."""
    assert first == second
    assert hash(first) == hash(second)
    assert first != other


# No factors, numbers as factors, vectors without components; a matrix where coordinates are needed, and the reverse.
test_what_is_no_group_is_refused = refusals(
    (nh.ProductGroup, r"ProductGroup.*no factor"),
    (lambda: nh.ProductGroup(nh.SO(3), 3), r"ProductGroup.*Got 3"),  # type: ignore[arg-type]
    (lambda: nh.Translations(0), r"Translations\(m=\.\.\.\).*Got 0"),
    (lambda: nh.SO(1), r"SO\(n=\.\.\.\).*at least 2.*Got 1"),
    (lambda: nh.SE(2.5), r"SE\(n=\.\.\.\).*positive integer.*Got 2\.5"),  # type: ignore[arg-type]
    (lambda: nh.SO(3).exp(np.zeros(4)), r"SO\(3\) \(coordinates\).*shape \(3,\).*vee"),
    (lambda: nh.SE(2).log(np.zeros((2, 2))), r"SE\(2\) \(element\).*hat"),
)


def test_repr_names_sizes() -> None:
    """A group says what it is in one line."""
    assert repr(SL3) == "MatrixGroup(dim=8, N=3)"
    assert repr(nh.ProductGroup(nh.SE(3), SL2)) == "ProductGroup(SE(3), MatrixGroup(dim=3, N=2))"


_LORENTZ = np.diag([1.0, 1.0, -1.0])
_SO21 = _LORENTZ @ nh.SO(3).basis


@pytest.mark.parametrize("name", FORMS)
def test_the_inverse_is_the_adjoint_in_the_form(name: str) -> None:
    """g* g = I, the adjoint reverses products, and matrices of the algebra change their sign."""
    group = FORMS[name]
    x = vectors(group, 4, 0.5)
    g = group.exp(x)
    assert close(group.inverse(g), np.linalg.inv(g))
    assert close(group.form_adjoint(g @ group.hat(x)), group.form_adjoint(group.hat(x)) @ group.inverse(g))
    assert close(group.form_adjoint(group.hat(x)), -group.hat(x))


@pytest.mark.parametrize("name", FORMS)
def test_the_skew_part_lies_in_the_algebra(name: str) -> None:
    """(W - W^-1)/2 is in the span of the basis, also far from the identity, and the Cayley map stays in the group."""
    group = FORMS[name]
    g = group.exp(vectors(group, 4, 3.0))
    K = (g - np.linalg.inv(g)) / 2
    assert np.abs(K - group.hat(group.vee(K))).max() <= 1e-10 * np.abs(K).max()
    assert group.has_skew_part
    assert group.has_cayley
    assert np.all(group.residual(group.cayley(vectors(group, 4))) < 1e-14)


@pytest.mark.parametrize("name", ["SO(2,1) oblique", "SU(1,1)", "SO(2,1) x Sp(2)"])
def test_the_group_checks_pass(name: str) -> None:
    """All properties that users check on groups of their own."""
    assert nh.testing.check_group(FORMS[name], compiled=name == "SU(1,1)").passed


# A form that is not preserved, degenerate, of a wrong shape; an algebra that its cubes leave.
test_forms_that_do_not_fit_are_refused = refusals(
    ((_SO21, np.eye(3)), r"x\^T G \+ G x = 0.*residual of 1.41 at matrix 0.*that the group"),
    ((nh.SE(2).basis, np.diag([1.0, 1.0, 0.0])), r"nondegenerate.*singular values from 1 to 0.*Leave it out"),
    ((_SO21, np.eye(4)), r"shape \(3, 3\).*\(4, 4\).*Pass the \(3, 3\) matrix G"),
    ((_SO21, np.full((3, 3), np.nan)), r"finite"),
    ((special(2, 1), hermitian(2, 1)[0]), r"contains \(W - W\^-1\)/2.*a cube leaves by.*U\(p, q\), not SU\(p, q\)"),
    ask=lambda basis_and_form: nh.MatrixGroup(*basis_and_form),
    begin=r"MatrixGroup\(form=\.\.\.\).*",
)


def test_the_skew_part_leaves_su_2_1() -> None:
    """Why SU(2, 1) is refused: the trace of (W - W^-1)/2 is i times the imaginary part of that of W."""
    group = nh.MatrixGroup(special(2, 1))
    W = group.exp(vectors(group, 1, 0.8)[0])
    K = (W - np.linalg.inv(W)) / 2
    assert np.abs(K - group.hat(group.vee(K))).max() > 1e-3
    whole = FORMS["U(2,1)"]
    assert np.abs(K - whole.hat(whole.vee(K))).max() < 1e-14


def test_sl_2_is_symplectic() -> None:
    """SL(2) preserves the area form, so it is a quadratic group; SL(3) preserves no form."""
    area = np.array([[0.0, 1.0], [-1.0, 0.0]])
    assert nh.MatrixGroup(SL2.basis, form=area).has_skew_part
    assert len(algebra(area)) == 3


def test_groups_are_equal_by_their_forms_too() -> None:
    """A multiple of the form is another argument, and a group without form says so in repr."""
    group, other = (nh.MatrixGroup(_SO21, form=c * _LORENTZ) for c in (1.0, 2.0))
    assert group == nh.MatrixGroup(_SO21, _LORENTZ.tolist())
    assert hash(group) == hash(nh.MatrixGroup(_SO21, _LORENTZ))
    assert group != other
    assert group != nh.MatrixGroup(_SO21)
    assert repr(group) == "MatrixGroup(dim=3, N=3, with a form)"
    assert HEISENBERG.form is nh.SO(3).form is None


def test_the_residual_of_large_elements() -> None:
    """It is relative, so that boosts of any size lie in the group; a wrong entry and a reflection do not."""
    group = nh.MatrixGroup(_SO21, form=_LORENTZ)
    boosts = group.exp(np.array([[0.0, 1.0, 0.0], [0.0, 30.0, 0.0], [0.3, 400.0, 0.2]]))
    assert np.all(group.residual(boosts) < 1e-14)
    assert group.residual(boosts[0] + 1e-6 * np.eye(3)) > 1e-7
    assert group.residual(-np.eye(3)) == 2


def test_the_residual_sees_the_other_form() -> None:
    """The real form of U(1,1) preserves two forms: elements of the larger SO(2,2) have a residual, though g* g = I."""
    unitary = FORMS["U(1,1)"]
    larger = nh.MatrixGroup(algebra(unitary.form), form=unitary.form)
    g = larger.exp(vectors(larger, 4, 0.5))
    assert np.all(larger.residual(g) < 1e-14)
    assert np.all(unitary.residual(g) > 1e-2)
