"""Quadratic groups: the algebras of their forms by linear algebra, and bodies on them."""

import numpy as np
import scipy.linalg

import nonholo as nh


def algebra(*forms: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the matrices x with x^T G + G x = 0 for each of the forms G."""
    N = len(forms[0])
    units = np.eye(N * N).reshape(-1, N, N)
    rows = [np.stack([(e.T @ G + G @ e).ravel() for e in units], axis=1) for G in forms]
    return scipy.linalg.null_space(np.concatenate(rows)).T.reshape(-1, N, N)


def _pseudo_orthogonal(p: int, q: int) -> nh.MatrixGroup:
    G = np.diag([1.0] * p + [-1.0] * q)
    return nh.MatrixGroup(algebra(G), form=G)


def hermitian(p: int, q: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the real and the imaginary part of a Hermitian form as real forms of twice the size."""
    H, zero = np.diag([1.0] * p + [-1.0] * q), np.zeros((p + q, p + q))
    return np.block([[H, zero], [zero, H]]), np.block([[zero, -H], [H, zero]])


def _symplectic(n: int) -> nh.MatrixGroup:
    G = np.kron([[0.0, 1.0], [-1.0, 0.0]], np.eye(n))
    return nh.MatrixGroup(algebra(G), form=G)


def _unitary(p: int, q: int) -> nh.MatrixGroup:
    return nh.MatrixGroup(algebra(*hermitian(p, q)), form=hermitian(p, q)[0])


def special(p: int, q: int) -> np.ndarray:
    """Return a basis of su(p, q): the matrices of u(p, q) without the multiples of i."""
    basis = algebra(*hermitian(p, q))
    unit = hermitian(p, q)[1] @ hermitian(p, q)[0]
    rows = scipy.linalg.null_space([np.einsum("ab,iab->i", unit, basis)])
    return np.tensordot(rows.T, basis, axes=1)


def _oblique(group: nh.MatrixGroup) -> nh.MatrixGroup:
    """Return a group seen from a basis in which neither the form nor its inverse has simple entries."""
    T = np.eye(group.size) + 0.3 * np.random.default_rng(0).normal(size=(group.size, group.size))
    return nh.MatrixGroup(np.linalg.inv(T) @ group.basis @ T, form=T.T @ group.form @ T)


_MIXED = scipy.linalg.block_diag(np.diag([1.0, 1.0, -1.0]), [[0.0, 1.0], [-1.0, 0.0]])

FORMS = {
    "SO(2,1)": _pseudo_orthogonal(2, 1),
    "SO(2,1) oblique": _oblique(_pseudo_orthogonal(2, 1)),
    "SO(3,1)": _pseudo_orthogonal(3, 1),
    "Sp(4)": _symplectic(2),
    "Sp(4) oblique": _oblique(_symplectic(2)),
    "SU(1,1)": nh.MatrixGroup(special(1, 1), form=hermitian(1, 1)[0]),
    "U(1,1)": _unitary(1, 1),
    "U(2,1)": _unitary(2, 1),
    "SO(2,1) x Sp(2)": nh.MatrixGroup(algebra(_MIXED), form=_MIXED),  # a form neither symmetric nor antisymmetric
}


def tensor(group: nh.MatrixGroup, rng: np.random.Generator) -> np.ndarray:
    """Draw a mass tensor with J* = J, the mean of a matrix over the powers of the star: four differ at most."""
    J = rng.normal(size=(group.size, group.size))
    result, inverse = np.zeros_like(J), np.linalg.inv(group.form)
    for _ in range(4):
        result, J = result + J / 4, inverse @ J.T @ group.form
    return result


def system(group: nh.MatrixGroup, k: int, rng: np.random.Generator, definite: bool = True) -> nh.LLSystem:
    """Draw a system with a random d of dimension k; its inertia along d positive definite and well conditioned."""
    for _ in range(5000):
        result = nh.LLSystem(group, tensor(group, rng), rng.normal(size=(k, group.dim)))
        values = np.linalg.eigvalsh(result.constrained_inertia)
        if not definite or values[0] > 0.03 * values[-1]:
            return result
    raise RuntimeError(f"no definite inertia on {group}, k = {k}")


def velocity(of: nh.LLSystem, size: float, rng: np.random.Generator) -> np.ndarray:
    """Draw a restricted velocity whose matrix has a given norm."""
    v = rng.normal(size=len(of.constraint_subspace))
    return v * (size / np.linalg.norm(of.group.hat(v @ of.constraint_subspace), 2))
