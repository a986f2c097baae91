"""The ball in which a root is certainly the principal one: its constants and its promise, against numbers.

docs/theory/general-step.md proves both; here bodies with mass tensors of very uneven eigenvalues try to break them.
"""

import functools

import numpy as np
import pytest
from bodies import random_rows

import nonholo as nh
from nonholo.discrete.routes import make_route
from nonholo.groups import AbstractMatrixGroup
from nonholo.kernels import GeneralBody
from nonholo.kernels.general._step import displace, workspace
from nonholo.kernels.general.run import is_certain, newton, principal

GROUPS = [nh.SO(3), nh.SO(4), nh.SO(5), nh.SE(2), nh.SE(3)]
INSIDE = 1 - 1e-5  # a difference quotient with a step of 1e-5 radii stays in the ball


def _uneven_tensor(group: AbstractMatrixGroup, rng: np.random.Generator) -> np.ndarray:
    """Draw a mass tensor whose points and masses differ by up to three orders of magnitude."""
    N = group.identity.shape[0]
    points = rng.normal(size=(N + 1, N)) * 10.0 ** rng.uniform(-0.7, 0.7, size=N)
    if not np.any(group.basis[:, -1]):
        points[:, -1] = 1.0
    return (points.T * 10.0 ** rng.uniform(-1.5, 1.5, size=N + 1)) @ points


@functools.cache
def _bodies(index: int) -> list[tuple[nh.LLSystem, GeneralBody]]:
    """Return one body for each dimension of d, general subspaces and coordinate ones in turn."""
    group, rng, found = GROUPS[index], np.random.default_rng(index), []
    for k in range(1, group.dim + 1):
        chosen = np.sort(rng.choice(group.dim, k, replace=False))
        rows = np.eye(group.dim)[chosen] if k % 2 else random_rows(group, k, rng)
        system = nh.LLSystem(group, _uneven_tensor(group, rng), rows)
        found.append((system, make_route(nh.discretize(system, 1.0), "matrix").body))
    return found


def _root(body: GeneralBody) -> np.ndarray:
    """Return the Cholesky factor of the inertia along d, in the kernel's units."""
    return np.linalg.cholesky(np.linalg.inv(body.metric))


def _even_part(body: GeneralBody, root: np.ndarray, x: np.ndarray) -> np.ndarray:
    r"""Return $\phi(x)$ by its definition, with W = K + S found from the eigenvectors of the rotation part of K."""
    n, K = body.size, np.einsum("a,aij", np.linalg.solve(root.T, x), body.directions)
    values, vectors = np.linalg.eigh(1j * K[:n, :n])
    S = np.zeros_like(K)
    S[:n, :n] = ((vectors * (np.sqrt(1 - values**2) - 1)) @ vectors.conj().T).real
    if n < len(K):
        R = np.eye(n) + K[:n, :n] + S[:n, :n]
        S[:n, n] = (np.eye(n) - R.T) @ np.linalg.solve(np.eye(n) + R.T, K[:n, n])
    return np.linalg.solve(root, np.einsum("aij,jk,ik->a", body.directions, body.tensor, S))


def _momenta_on_the_level(body: GeneralBody, count: int, rng: np.random.Generator) -> np.ndarray:
    """Draw momenta just inside the largest norm that the certificate accepts."""
    m = rng.normal(size=(count, len(body.metric)))
    norms = np.sqrt(np.einsum("ia,ab,ib->i", m, body.metric, m))
    return m * (np.sqrt(body.level) * (1 - 1e-12) / norms)[:, None]


@pytest.mark.parametrize("index", range(len(GROUPS)), ids=map(str, GROUPS))
def test_the_lipschitz_constant_is_not_exceeded(index: int) -> None:
    """On the boundary of the ball the derivative of the even part stays below the constant in use."""
    rng = np.random.default_rng(20 + index)
    for _, body in _bodies(index):
        root, radius = _root(body), np.sqrt(body.radius)
        claimed = 1 - np.sqrt(body.level) / radius
        for x in rng.normal(size=(20, len(root))):
            x *= INSIDE * radius / np.linalg.norm(x)
            steps = 1e-5 * radius * np.eye(len(root))
            pairs = [(_even_part(body, root, x + e), _even_part(body, root, x - e)) for e in steps]
            slopes = np.array([ahead - behind for ahead, behind in pairs]) / (2e-5 * radius)
            assert np.linalg.norm(slopes, 2) <= claimed + 1e-9  # rounding of the quotients


@pytest.mark.profile("problems", keep=["SO(3)", "SE(2)"])
@pytest.mark.parametrize("index", range(len(GROUPS)), ids=map(str, GROUPS))
def test_roots_on_the_level_are_principal_and_certified(index: int) -> None:
    """For momenta at the level the followed root is the fixed point of the contraction, and it is certified."""
    rng = np.random.default_rng(30 + index)
    for system, body in _bodies(index):
        root = _root(body)
        for m in _momenta_on_the_level(body, 4, rng):
            x, target = np.zeros(len(m)), np.linalg.solve(root, m)
            for _ in range(300):
                x = target - _even_part(body, root, x)
            work = workspace(body)
            y = np.empty(len(body.stretch))
            assert principal(body, work, m, y) == 0
            assert is_certain(body, work, m, y)
            displace(body, work, y)
            X = work.X
            K = (X - (system.group.inverse(X + system.group.identity) - system.group.identity)) / 2
            fixed = np.einsum("a,aij", np.linalg.solve(root.T, x), body.directions)
            assert np.abs(K - fixed).max() <= 1e-9 * np.abs(fixed).max()


@pytest.mark.parametrize("index", range(len(GROUPS)), ids=map(str, GROUPS))
def test_no_other_root_is_certified(index: int) -> None:
    """Newton's method from far guesses finds other roots at the level; none of them gets the certificate."""
    rng, others = np.random.default_rng(40 + index), 0
    for _, body in _bodies(index):
        for m in _momenta_on_the_level(body, 3, rng):
            work = workspace(body)
            first = np.empty(len(body.stretch))
            principal(body, work, m, first)
            for y in 2.0 * rng.normal(size=(25, len(body.stretch))):
                good, _ = newton(body, work, 1.0, m, y)
                if good and np.abs(y - first).max() > 1e-6 * (1 + np.abs(first).max()):
                    others += 1
                    assert not is_certain(body, work, m, y)
    assert others >= 10  # otherwise nothing was tried
