"""Matrix Lie groups: pure functions of plain arrays, written once for NumPy and JAX."""

from nonholo._checks import choice
from nonholo.groups._base import AbstractMatrixGroup
from nonholo.groups._special_euclidean import SpecialEuclidean2
from nonholo.groups._special_orthogonal import SpecialOrthogonal3

__all__ = ["SE", "SO", "AbstractMatrixGroup"]


def SO(n: int) -> AbstractMatrixGroup:
    r"""Return the rotation group $SO(n)$; this version has n = 3.

    Algebra coordinates are the usual vector, $\mathrm{hat}(v)\,x = v \times x$.

    Example:
        >>> SO(3).hat(np.array([0.0, 0.0, 1.0]))
        array([[ 0., -1.,  0.],
               [ 1.,  0.,  0.],
               [ 0.,  0.,  0.]])
    """
    choice("SO(n=...)", n, (3,), "Only the rotation group of space is available.")
    return SpecialOrthogonal3()


def SE(n: int) -> AbstractMatrixGroup:
    r"""Return the group $SE(n)$ of rigid motions as $(n + 1) \times (n + 1)$ matrices; this version has n = 2.

    Algebra coordinates are $(\omega, v_1, v_2)$, the rotation first.

    Example:
        >>> SE(2).exp(np.array([0.0, 3.0, 4.0]))
        array([[1., 0., 3.],
               [0., 1., 4.],
               [0., 0., 1.]])
    """
    choice("SE(n=...)", n, (2,), "Only the group of motions of the plane is available.")
    return SpecialEuclidean2()
