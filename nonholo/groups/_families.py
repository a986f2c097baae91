"""The rotation groups and the groups of rigid motions by dimension: closed forms for SO(3) and SE(2)."""

from nonholo.base.checks import dimension
from nonholo.groups._base import AbstractMatrixGroup
from nonholo.groups._special_euclidean import SpecialEuclidean2
from nonholo.groups._special_euclidean_n import SpecialEuclideanN
from nonholo.groups._special_orthogonal import SpecialOrthogonal3
from nonholo.groups._special_orthogonal_n import SpecialOrthogonalN


def SO(n: int) -> AbstractMatrixGroup:
    r"""Return the rotation group $SO(n)$, $n \ge 2$.

    Algebra coordinates: for n = 3 the usual vector, $\mathrm{hat}(v)\,x = v \times x$; otherwise $x_{ij}$, pairs
    $i < j$ in lexicographic order, the coefficients of $e_i\wedge e_j = e_ie_j^T - e_je_i^T$.

    Raises:
        ValueError: `n` is not an integer of at least 2.

    Example:
        >>> SO(3).hat(np.array([0.0, 0.0, 1.0]))
        array([[ 0., -1.,  0.],
               [ 1.,  0.,  0.],
               [ 0.,  0.,  0.]])
        >>> SO(4).hat(np.arange(1.0, 7.0))
        array([[ 0.,  1.,  2.,  3.],
               [-1.,  0.,  4.,  5.],
               [-2., -4.,  0.,  6.],
               [-3., -5., -6.,  0.]])
    """
    n = dimension("SO(n=...)", n)
    return SpecialOrthogonal3() if n == 3 else SpecialOrthogonalN(n)


def SE(n: int) -> AbstractMatrixGroup:
    r"""Return the group $SE(n)$, $n \ge 2$, of rigid motions as $(n + 1) \times (n + 1)$ matrices.

    Algebra coordinates: for n = 2 $(\omega, v_1, v_2)$; otherwise those of so(n), then $v_1, \dots, v_n$.

    Raises:
        ValueError: `n` is not an integer of at least 2.

    Example:
        >>> SE(2).exp(np.array([0.0, 3.0, 4.0]))
        array([[1., 0., 3.],
               [0., 1., 4.],
               [0., 0., 1.]])
        >>> SE(3).dim, SE(3).hat(np.arange(1.0, 7.0))[:3].tolist()
        (6, [[0.0, -3.0, 2.0, 4.0], [3.0, 0.0, -1.0, 5.0], [-2.0, 1.0, 0.0, 6.0]])
    """
    n = dimension("SE(n=...)", n)
    return SpecialEuclidean2() if n == 2 else SpecialEuclideanN(n)


def components_of(group: AbstractMatrixGroup) -> tuple[str, ...]:
    """Return names of the coordinates of an algebra.

    Example:
        >>> components_of(SE(2)), components_of(SO(3))
        (('omega', 'v1', 'v2'), ('omega1', 'omega2', 'omega3'))
    """
    turns, shifts = group.dim, 0
    if group == SE(2):
        return "omega", "v1", "v2"
    if group == SE(3):
        turns = shifts = 3
    return (*(f"omega{i + 1}" for i in range(turns)), *(f"v{i + 1}" for i in range(shifts)))
