"""Real eigenspaces of small matrices whose entries have rounding errors."""

import numpy as np

from nonholo.base.types import Float


def real_eigenspaces(matrix: Float[np.ndarray, "3 3"], rounding: float) -> tuple[Float[np.ndarray, "_ 3"], ...]:
    r"""Return orthonormal rows for each real eigenspace of a matrix of order three, eigenvalues in ascending order.

    Eigenvalues count as one where a change of the entries by about `rounding` makes them one: those of a defective
    matrix come apart by its root, and are then real or complex by chance. A block N with trace 0 has one eigenvalue if
    $N^m = 0$, that is if the other coefficients of its characteristic polynomial vanish.

    Example:
        >>> defective = np.array([[2.0, 1.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 5.0]])
        >>> [np.abs(space).tolist() for space in real_eigenspaces(defective, 1e-14)]
        [[[1.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]]]
    """
    mean = _mean(matrix)
    if _is_nilpotent(_less(matrix, mean), rounding):
        return (_kernel(_less(matrix, mean), rounding),)
    values, left = np.linalg.eig(matrix.T)
    simple = sorted((float(value.real), i) for i, value in enumerate(values) if value.imag == 0)
    for value, i in simple:
        across = np.linalg.svd(np.real(left[None, :, i]))[2][1:]  # spans the plane of the other two eigenvalues
        block = across @ matrix @ across.T
        mean = _mean(block)
        if _is_nilpotent(_less(block, mean), rounding):
            spaces = _kernel(_less(matrix, mean), rounding), _kernel(_less(matrix, value), 0.0)
            return spaces if mean < value else spaces[::-1]
    return tuple(_kernel(_less(matrix, value), 0.0) for value, _ in simple)


def _less(matrix: Float[np.ndarray, "m m"], value: float) -> Float[np.ndarray, "m m"]:
    return matrix - value * np.eye(len(matrix))


def _mean(block: Float[np.ndarray, "m m"]) -> float:
    return float(np.trace(block)) / len(block)


def _is_nilpotent(block: Float[np.ndarray, "m m"], rounding: float) -> bool:
    """Tell whether the eigenvalues of a block with trace 0 are all zero, up to a change of its entries."""
    size = np.linalg.norm(block)
    squares = abs(np.trace(block @ block)) / 2
    return bool(squares <= rounding * size and abs(np.linalg.det(block)) <= rounding * size ** (len(block) - 1))


def _kernel(matrix: Float[np.ndarray, "3 3"], rounding: float) -> Float[np.ndarray, "_ 3"]:
    """Return what a singular matrix takes to zero: at least one row."""
    _, sizes, rows = np.linalg.svd(matrix)
    return rows[-max(1, int(np.sum(sizes <= rounding))) :]
