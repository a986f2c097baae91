"""Whether a group is one, and does what systems and discretizations expect of it."""

import contextlib
import functools
from typing import Any

import numpy as np
import scipy.linalg

from nonholo.base.checks import flags, generator, instance, within_memory
from nonholo.base.numerics import double_precision
from nonholo.base.types import Float
from nonholo.groups import AbstractMatrixGroup
from nonholo.testing import _report as report
from nonholo.testing._report import Check, Report, derivative, gap, largest, measures, need, run_checks

_COUNT = 4


class GroupSamples:
    """Random coordinates, matrices and elements of a group.

    Args:
        group: The group.
        rng: Where the numbers come from.
    """

    def __init__(self, group: AbstractMatrixGroup, rng: np.random.Generator) -> None:
        self.group = group
        self._directions = rng.normal(size=(2, _COUNT, group.dim))
        self.p = rng.normal(size=(_COUNT, group.dim))
        self._many = rng.normal(size=(16 * _COUNT, group.dim))
        self._rng = rng

    def vectors(self, size: float, which: int = 0) -> Float[np.ndarray, "4 dim"]:
        """Return coordinates whose matrices have the given norm."""
        x = self._directions[which]
        return size * x / np.linalg.norm(self.matrix(x), 2, axis=(1, 2))[:, None]

    @functools.cached_property
    def x(self) -> Float[np.ndarray, "4 dim"]:
        """Coordinates of matrices of norm one."""
        return self.vectors(1.0)

    @functools.cached_property
    def y(self) -> Float[np.ndarray, "4 dim"]:
        """Others."""
        return self.vectors(1.0, which=1)

    @functools.cached_property
    def g(self) -> Float[np.ndarray, "4 N N"]:
        """Elements, the exponentials of x."""
        return self.element(self.x)

    @functools.cached_property
    def turning(self) -> tuple[Float[np.ndarray, "4 dim"], Float[np.ndarray, "4"]]:
        """Coordinates, among many of norm one those that turn most, and the angles through which they turn."""
        x = self._many / np.linalg.norm(self.matrix(self._many), 2, axis=(1, 2))[:, None]
        turn = np.abs(np.linalg.eigvals(self.matrix(x)).imag).max(axis=-1)
        most = np.argsort(turn)[-_COUNT:]
        return x[most], turn[most]

    @functools.cached_property
    def elements(self) -> Float[np.ndarray, "4 N N"]:
        """Elements that the group draws."""
        return np.stack([self.group.random(self._rng) for _ in range(_COUNT)])

    def matrix(self, x: Float[np.ndarray, "... dim"]) -> Float[np.ndarray, "... N N"]:
        """Return the sum over the basis."""
        return np.tensordot(x, self.group.basis, axes=1)

    def coordinates(self, X: Float[np.ndarray, "... N N"]) -> Float[np.ndarray, "... dim"]:
        """Return the coefficients of the nearest matrix in the span of the basis."""
        columns = self.group.basis.reshape(self.group.dim, -1).T
        flat = X.reshape(-1, columns.shape[0])
        return np.linalg.lstsq(columns, flat.T, rcond=None)[0].T.reshape(*X.shape[:-2], -1)

    def element(self, x: Float[np.ndarray, "... dim"]) -> Float[np.ndarray, "... N N"]:
        """Return the exponential by SciPy."""
        return scipy.linalg.expm(self.matrix(x))

    def conjugate(self, g: np.ndarray, x: np.ndarray) -> Float[np.ndarray, "... dim"]:
        """Return the coordinates of g X g^-1."""
        return self.coordinates(g @ self.matrix(x) @ np.linalg.inv(g))

    def commutator(self, x: np.ndarray, y: np.ndarray) -> Float[np.ndarray, "... N N"]:
        """Return the commutator of matrices."""
        X, Y = self.matrix(x), self.matrix(y)
        return X @ Y - Y @ X


def check_group(
    group: AbstractMatrixGroup,
    *,
    rng: int | np.random.Generator = 0,
    compiled: bool = True,
    tolerance_factor: float = 1.0,
    throw: bool = True,
) -> Report:
    r"""Check that a group is a group of matrices whose functions agree with their definitions.

    Samples are built from the basis by `scipy.linalg.expm`, and the conventions are those of docs/conventions.md:

    $$ \mathrm{hat}(x) = \sum x_i E_i, \qquad \mathrm{Ad}_g x = g\,x\,g^{-1}, \qquad
       \langle\mathrm{Ad}^*_g p, x\rangle = \langle p, \mathrm{Ad}_g x\rangle. $$

    Measured are: sizes, basis and brackets; `exp`, `log` (small, moderate and near angle pi), `cayley`, `retract` and
    `dexp_inverse`; conjugation and its transpose; `random` and `residual`; compact poses; leading axes; agreement of
    NumPy and JAX.

    Args:
        group: Your group.
        rng: A generator of the samples, or an integer that makes one.
        compiled: Also compare with compiled JAX functions, which takes seconds.
        tolerance_factor: On every tolerance, for a basis of badly scaled matrices.
        throw: Raise if a check fails; otherwise only the report has it.

    Returns:
        What was measured.

    Raises:
        ValueError: `group` is not a group.
        AssertionError: With `throw`: names every check that failed, what is required and what was measured.

    Example:
        >>> nh.testing.check_group(nh.ProductGroup(nh.SE(2), nh.Translations(1))).passed
        True
    """
    remedy = "Pass SO(n), a MatrixGroup or your own class that implements AbstractMatrixGroup."
    instance("check_group(group=...)", group, AbstractMatrixGroup, "be a group", remedy)
    flags("check_group", compiled=compiled, throw=throw)
    within_memory("check_group(group=...)", 8.0 * group.dim**2 * group.size**2, "Check a smaller group of its kind.")
    samples = GroupSamples(group, generator("check_group(rng=...)", rng))
    checks = (*ALGEBRA, *MAPS, *((COMPILED,) if compiled else ()))
    return run_checks(f"check_group({group!r})", checks, samples, tolerance_factor, throw)


_OFF = 1e-3  # how far matrices are moved off the group
_BLIND = 1e3  # a residual is sound if it sees at least this part of the distance


ALGEBRA: list[Check] = []
MAPS: list[Check] = []
"""In the order of the report; tolerances leave room for a few hundred rounding errors at norms of a few units."""


@measures(ALGEBRA, "sizes", "basis, identity, exp and poses are float64 arrays of the sizes stated", 0.0)
def _sizes(s: GroupSamples) -> float:
    group = s.group
    sizes = [
        (group.basis, (group.dim, group.size, group.size)),
        (group.identity, (group.size, group.size)),
        (group.exp(s.x), (len(s.x), group.size, group.size)),
        (group.pose_from_matrix(group.identity), (group.pose_size,)),
    ]
    return sum(np.shape(array) != shape or np.asarray(array).dtype != np.float64 for array, shape in sizes)


@measures(ALGEBRA, "hash", "the group can be a fixed argument of compiled functions", 0.0)
def _hash(s: GroupSamples) -> float:
    return float(hash(s.group) != hash(s.group))


@measures(ALGEBRA, "basis", "the basis is linearly independent", 0.0)
def _basis(s: GroupSamples) -> float:
    flat = s.group.basis.reshape(s.group.dim, -1)
    return s.group.dim - np.linalg.matrix_rank(flat / np.linalg.norm(flat, axis=1)[:, None])


@measures(ALGEBRA, "closure", "brackets of basis matrices lie in their span", 1e-10)
def _closure(s: GroupSamples) -> float:
    rows = s.group.basis.reshape(s.group.dim, -1)
    unit = np.diag(1 / np.linalg.norm(rows, axis=1))
    brackets = s.commutator(unit[:, None, :], unit[None, :, :])
    return largest(brackets - s.matrix(s.coordinates(brackets)))


measures(ALGEBRA, "hat", "hat(x) = sum x_i E_i", 1e-13)(lambda s: gap(s.group.hat(s.x), s.matrix(s.x)))


measures(ALGEBRA, "vee", "vee(sum x_i E_i) = x", 1e-12)(lambda s: gap(s.group.vee(s.matrix(s.x)), s.x))


@measures(ALGEBRA, "bracket", "hat(bracket(x, y)) = X Y - Y X", 1e-12)
def _bracket(s: GroupSamples) -> float:
    return gap(s.matrix(s.group.bracket(s.x, s.y)), s.commutator(s.x, s.y))


@measures(ALGEBRA, "Jacobi", "[x, [y, z]] + [y, [z, x]] + [z, [x, y]] = 0", 1e-12)
def _jacobi(s: GroupSamples) -> float:
    bracket, x, y, z = s.group.bracket, s.x, s.y, s.x[::-1]
    terms = np.stack([bracket(x, bracket(y, z)), bracket(y, bracket(z, x)), bracket(z, bracket(x, y))])
    return largest(terms.sum(axis=0)) / (1 + largest(terms))


@measures(ALGEBRA, "ad", "ad(x) y = [x, y]", 1e-12)
def _ad(s: GroupSamples) -> float:
    return gap((s.group.ad(s.x) @ s.y[:, :, None])[:, :, 0], s.coordinates(s.commutator(s.x, s.y)))


@measures(ALGEBRA, "coad", "<coad(x, p), y> = <p, [x, y]>", 1e-12)
def _coad(s: GroupSamples) -> float:
    pairing = np.sum(s.group.coad(s.x, s.p) * s.y, axis=-1)
    return gap(pairing, np.sum(s.p * s.coordinates(s.commutator(s.x, s.y)), axis=-1))


@measures(ALGEBRA, "inverse", "inverse(g) g = I", 1e-12)
def _inverse(s: GroupSamples) -> float:
    return gap(s.group.inverse(s.g) @ s.g, np.broadcast_to(s.group.identity, s.g.shape))


@measures(ALGEBRA, "adjoint", "hat(adjoint(g) x) = g X g^-1", 1e-11)
def _adjoint(s: GroupSamples) -> float:
    return gap((s.group.adjoint(s.g) @ s.y[:, :, None])[:, :, 0], s.conjugate(s.g, s.y))


@measures(ALGEBRA, "adjoint of products", "adjoint(g h) = adjoint(g) adjoint(h)", 1e-11)
def _adjoint_of_products(s: GroupSamples) -> float:
    adjoint, h = s.group.adjoint, s.g[::-1]
    return gap(adjoint(s.g @ h), adjoint(s.g) @ adjoint(h))


@measures(ALGEBRA, "adjoint of exp", "adjoint(exp(x)) = expm(ad(x))", 1e-11)
def _adjoint_of_exp(s: GroupSamples) -> float:
    return gap(s.group.adjoint(s.group.exp(s.x)), scipy.linalg.expm(s.group.ad(s.x)))


@measures(ALGEBRA, "coadjoint", "<coadjoint(g, p), x> = <p, adjoint(g) x>", 1e-11)
def _coadjoint(s: GroupSamples) -> float:
    pairing = np.sum(s.group.coadjoint(s.g, s.p) * s.y, axis=-1)
    return gap(pairing, np.sum(s.p * s.conjugate(s.g, s.y), axis=-1))


measures(ALGEBRA, "random", "residual(random(rng)) = 0", 1e-11)(lambda s: largest(s.group.residual(s.elements)))


@measures(ALGEBRA, "products", "residual(g h) = 0", 1e-11)
def _products(s: GroupSamples) -> float:
    """Multiply elements so near the identity that their product has a logarithm."""
    return largest(s.group.residual(s.element(s.x / 4) @ s.element(s.y / 4)))


@measures(ALGEBRA, "residual", "distance / residual of matrices off the group is bounded", _BLIND)
def _blindness(s: GroupSamples) -> float:
    """Return the part of a distance from the group that the residual does not see, as distance over residual."""
    normal = scipy.linalg.null_space(s.group.basis.reshape(s.group.dim, -1))
    need(normal.shape[1], "every invertible matrix near the group lies in it")
    away = normal.T.reshape(-1, s.group.size, s.group.size)
    residual = s.group.residual(s.g[0] @ (s.group.identity + _OFF * away))
    return float(np.max(_OFF / np.maximum(residual, np.finfo(float).tiny)))


_SMALL = 1e-6
_TURN = 3.0  # an angle near the edge of injectivity, pi
_STRETCH = 5.0  # samples that need a matrix of larger norm to turn so far are left out


measures(MAPS, "exp of zero", "exp(0) = I", 0.0)(lambda s: largest(s.group.exp(0 * s.x) - s.group.identity))


@measures(MAPS, "exp", "exp(x) = expm(hat(x))", 1e-12)
def _exp(s: GroupSamples) -> float:
    return max(gap(s.group.exp(x), s.element(x)) for x in (s.x, s.vectors(2.5, which=1)))


@measures(MAPS, "exp_increment", "exp_increment(x) = X + X^2/2 + ... to relative accuracy", 1e-13)
def _exp_increment(s: GroupSamples) -> float:
    x = s.vectors(_SMALL)
    X = s.matrix(x)
    return largest(s.group.exp_increment(x) - X - X @ X / 2 - X @ X @ X / 6) / _SMALL


@measures(MAPS, "log of small motions", "log(exp(x)) = x to nine digits at |X| = 1e-6", 1e-9)
def _log_small(s: GroupSamples) -> float:
    x = s.vectors(_SMALL)
    X = s.matrix(x)
    return largest(s.matrix(s.group.log(s.group.identity + X + X @ X / 2) - x)) / _SMALL


measures(MAPS, "log", "log(exp(x)) = x at |X| = 1", 1e-12)(lambda s: gap(s.group.log(s.g), s.x))


@measures(MAPS, "log of large turns", "log(exp(x)) = x at angle 3", 1e-10)
def _log_large(s: GroupSamples) -> float:
    x, turn = s.turning
    turning = turn > _TURN / _STRETCH  # rounding gives nilpotent matrices small imaginary parts
    need(turning.any(), "no sample turns")
    x = x[turning] * (_TURN / turn[turning])[:, None]
    return gap(s.group.log(s.element(x)), x)


@measures(MAPS, "exp of log", "exp(log(g)) = g for random elements", 1e-11)
def _exp_of_log(s: GroupSamples) -> float:
    return gap(s.group.exp(s.group.log(s.elements)), s.elements)


def _cayley_of(s: GroupSamples) -> np.ndarray:
    """Return Cayley images; a group that is not rigid may refuse."""
    try:
        return s.group.cayley(s.x)
    except ValueError as refusal:
        if s.group.is_rigid:
            raise
        raise report.NotApplicableError(str(refusal)) from None


@measures(MAPS, "Cayley", "(I - X/2) cayley(x) = I + X/2", 1e-12)
def _cayley(s: GroupSamples) -> float:
    X, eye = s.matrix(s.x), s.group.identity
    return gap((eye - X / 2) @ _cayley_of(s), eye + X / 2)


measures(MAPS, "Cayley stays", "residual(cayley(x)) = 0", 1e-12)(lambda s: largest(s.group.residual(_cayley_of(s))))


@measures(MAPS, "retract", "retract(x) - exp(x) is of third order: at most |X|^3", 1.0)
def _retract(s: GroupSamples) -> float:
    size = 1e-2
    x = s.vectors(size)
    return largest(s.group.retract(x) - s.element(x)) / size**3


@measures(MAPS, "retract stays", "residual(retract(x)) = 0", 1e-12)
def _retract_stays(s: GroupSamples) -> float:
    return largest(s.group.residual(s.group.retract(s.x)))


@measures(MAPS, "retract_increment", "I + retract_increment(x) = retract(x)", 1e-14)
def _retract_increment(s: GroupSamples) -> float:
    return gap(s.group.identity + s.group.retract_increment(s.x), s.group.retract(s.x))


@measures(MAPS, "dexp_inverse", "dexp_inverse(x) = (integral of expm(t ad(x)), 0 < t < 1)^-1", 1e-11)
def _dexp_inverse(s: GroupSamples) -> float:
    ad, eye = s.group.ad(s.x), np.eye(s.group.dim)
    upper = np.concatenate([ad, np.broadcast_to(eye, ad.shape)], axis=-1)
    block = scipy.linalg.expm(np.concatenate([upper, np.zeros_like(upper)], axis=-2))
    return gap(s.group.dexp_inverse(s.x) @ block[:, : s.group.dim, s.group.dim :], np.broadcast_to(eye, ad.shape))


@measures(MAPS, "dexp_inverse and log", "d/dt log(exp(t y) exp(x)) = dexp_inverse(x) y", 1e-8)
def _dexp_of_log(s: GroupSamples) -> float:
    def logarithm(t: float) -> np.ndarray:
        return s.group.log(s.element(t * s.y / 2) @ s.element(s.x / 2))

    return gap(derivative(logarithm), (s.group.dexp_inverse(s.x / 2) @ s.y[:, :, None])[:, :, 0] / 2)


# eigenvalues of defective matrices are found to the root of rounding only
@measures(MAPS, "angle", "angle(x) = largest imaginary part of an eigenvalue of hat(x)", 1e-7)
def _angle(s: GroupSamples) -> float:
    return gap(s.group.angle(s.x), np.abs(np.linalg.eigvals(s.matrix(s.x)).imag).max(axis=-1))


@measures(MAPS, "poses", "matrix_from_pose(pose_from_matrix(g)) = g", 1e-13)
def _poses(s: GroupSamples) -> float:
    return gap(s.group.matrix_from_pose(s.group.pose_from_matrix(s.elements)), s.elements)


@measures(MAPS, "pose_product", "matrix_from_pose(pose_product(p, q)) = matrix_from_pose(p) matrix_from_pose(q)", 1e-12)
def _pose_product(s: GroupSamples) -> float:
    group, others = s.group, s.elements[::-1]
    product = group.pose_product(group.pose_from_matrix(s.elements), group.pose_from_matrix(others))
    return gap(group.matrix_from_pose(product), s.elements @ others)


@measures(MAPS, "normalize_pose", "normalize_pose keeps poses of the group", 1e-13)
def _normalize(s: GroupSamples) -> float:
    pose = s.group.pose_from_matrix(s.elements)
    return gap(s.group.normalize_pose(pose), pose)


@measures(MAPS, "pose_rate", "d/dt matrix_from_pose(pose + t pose_rate) = g hat(x)", 1e-8)
def _pose_rate(s: GroupSamples) -> float:
    """Differentiate matrices, since several poses may have the same one."""
    pose = s.group.pose_from_matrix(s.elements)
    rate = s.group.pose_rate(pose, s.x)
    return gap(derivative(lambda t: s.group.matrix_from_pose(pose + t * rate)), s.elements @ s.matrix(s.x))


def _everything(group: Any, x: Any) -> dict[str, Any]:
    """Return by name the values of functions that have leading axes and are compiled."""
    g = group.exp(x)
    pose = group.pose_from_matrix(g)
    arguments = {
        "log inverse adjoint residual": (g,),
        "retract dexp_inverse angle": (x,),
        "normalize_pose matrix_from_pose": (pose,),
        "coadjoint": (g, x),
        "coad": (x, x[..., ::-1]),
        "pose_rate": (pose, x),
    }
    return {"exp": g} | {name: getattr(group, name)(*own) for names, own in arguments.items() for name in names.split()}


@measures(MAPS, "broadcasting", "leading axes are mapped over", 1e-12)
def _broadcast(s: GroupSamples) -> float:
    """Compare a stack of two by two with its entries one by one."""
    whole = _everything(s.group, s.x.reshape(2, 2, -1))
    single = [_everything(s.group, x) for x in s.x]
    flat = {name: np.reshape(array, (4, *np.shape(array)[2:])) for name, array in whole.items()}
    return max(gap(flat[name], np.stack([each[name] for each in single])) for name in flat)


def _jax(s: GroupSamples) -> float:
    with contextlib.suppress(ImportError):
        import jax

        with double_precision():
            arrays = jax.jit(lambda x: _everything(s.group, x))(jax.numpy.asarray(s.x))
            values = {name: np.asarray(array) for name, array in arrays.items()}
        return max(gap(values[name], exact) for name, exact in _everything(s.group, s.x).items())
    raise report.NotApplicableError("JAX is not installed")


COMPILED = Check("JAX", "compiled JAX functions give the numbers of NumPy", 1e-11, _jax)
