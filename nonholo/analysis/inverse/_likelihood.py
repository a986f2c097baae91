r"""Noise levels and covariances at a point, by restricted likelihood, for squares and for a loss that outliers bear."""

from typing import NamedTuple

import numpy as np

from nonholo.analysis.inverse._problem import Problem

LOSSES = "linear", "soft_l1"
_NORMAL = {"linear": 1.0, "soft_l1": 0.34432045758120155}
"""Mean square of half the derivative of the loss over normal noise: 1 - sqrt(pi e / 2) erfc(1 / sqrt(2))."""


class Bent(NamedTuple):
    """Rows whose sum of squares is the loss, with their derivative, and half the first and second one of the loss."""

    rows: np.ndarray
    slope: np.ndarray
    first: np.ndarray
    second: np.ndarray


def bent(rows: np.ndarray, loss: str) -> Bent:
    r"""Return residuals in units of the noise, bent by the loss: $z^2$, or $2\sqrt{1 + z^2} - 2$ for "soft_l1"."""
    if loss == "linear":
        return Bent(rows, np.ones_like(rows), rows, np.ones_like(rows))
    h = np.hypot(1.0, rows)
    s = np.sqrt(2 / (1 + h))
    return Bent(rows * s, 1 / (h * s), rows / h, h**-3)


class Estimate(NamedTuple):
    r"""What residuals and derivatives at a point tell.

    Attributes:
        levels: The noise levels that follow from the present ones, $\sigma_k^2 = \sum r^2/(n_k - \mathrm{tr} G_k)$.
        counts: Numbers of each kind, $n_k$.
        shares: $G_k = Q_k^TQ_k$, over the rows of a kind, where $J = QR$ in units of the noise; their sum is 1.
        lengths: Of the columns of J.
        triangle: R, of columns of length 1.
        units: In which the growth of the loss is distributed as that of squares is, for each kind.
        missed: The cosine between the residuals and the nearest direction in which they change: 0 at a minimum.
    """

    levels: np.ndarray
    counts: np.ndarray
    shares: np.ndarray
    lengths: np.ndarray
    triangle: np.ndarray
    units: np.ndarray
    missed: float

    @property
    def free(self) -> np.ndarray:
        """Numbers of each kind less those that the fit uses up, the trace of the hat matrix over the kind."""
        return self.counts - np.trace(self.shares, axis1=1, axis2=2)

    def covariance(self, is_estimated: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        r"""Return the covariance of all numbers by Kenward and Roger, that for known noise, and degrees of freedom.

        Levels that are estimated have the information $I_{kl} = \tfrac12(\delta_{kl}(n_k - 2\,\mathrm{tr} G_k) +
        \mathrm{tr} G_kG_l)$ of their logarithms; W is its inverse. The covariance for known noise,
        $C = R^{-1}R^{-T}$, becomes $R^{-1}(1 + 2\sum_k W_{kk}G_k - 2\sum_{kl}W_{kl}G_kG_l)R^{-T}$, and by Satterthwaite
        a number with the shares $d_k$ of its variance v in the kinds has $2v^2/d^TWd$ degrees of freedom.
        """
        G = self.shares
        information = (np.einsum("kab,lab->kl", G, G) + np.diag(self.free - np.trace(G, axis1=1, axis2=2))) / 2
        W, at = np.zeros_like(information), np.ix_(is_estimated, is_estimated)
        W[at] = np.linalg.inv(information[at])
        wider = np.einsum("kk,kab->ab", W, G) - np.einsum("kl,kab,lbc->ac", W, G, G)
        root = np.linalg.inv(self.triangle) / self.lengths[:, None]
        shares = np.einsum("ja,kab,jb->jk", root, G, root)
        with np.errstate(divide="ignore"):
            degrees = 2 * np.sum(root**2, axis=1) ** 2 / np.einsum("jk,kl,jl->j", shares, W, shares)
        return root @ (np.eye(len(root)) + 2 * wider) @ root.T, root @ root.T, degrees


def estimate(problem: Problem, point: np.ndarray, noise: np.ndarray, loss: str) -> Estimate:
    """Return what residuals and derivatives at a point tell; under the robust loss rows count by their efficiency."""
    kind_of, tiny = problem.kind_of, np.finfo(np.float64).tiny
    at = bent(problem.rows(point) / noise[kind_of], loss)
    counts = np.bincount(kind_of)
    efficiency = np.bincount(kind_of, at.second) / counts / np.sqrt(_NORMAL[loss])
    J = problem.slope(point) * (efficiency / noise)[kind_of][:, None]
    lengths = np.linalg.norm(J, axis=0)
    Q, R = np.linalg.qr(J / np.where(lengths > 0, lengths, 1.0))
    shares = np.array([Q[kind_of == k].T @ Q[kind_of == k] for k in range(len(noise))])
    free = np.maximum(counts - np.trace(shares, axis1=1, axis2=2), tiny)
    levels = noise * np.sqrt(np.bincount(kind_of, at.first**2) / _NORMAL[loss] / free)
    left = at.first / efficiency[kind_of]
    units = np.sqrt(efficiency / np.sqrt(_NORMAL[loss]))
    missed = float(np.linalg.norm(Q.T @ left) / (np.linalg.norm(left) or 1.0))
    return Estimate(levels, counts, shares, lengths, R, units, missed)
