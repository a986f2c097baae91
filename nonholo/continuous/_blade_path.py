r"""The path of a Chaplygin sleigh's blade: the integral of $\tanh s\; e^{i\Lambda\phi}$ in s, $\phi = \mathrm{gd}\,s$.

An antiderivative is $G = e^{i\Lambda\phi}\Lambda^{-1}[-1 + 2\,{}_2F_1(1, \Lambda/2; 1 + \Lambda/2; -e^{2i\phi})]$
with $G(-s) = \overline{G(s)}$, for $\Lambda > 1$. The argument lies on the unit circle, where `scipy.special.hyp2f1`
can lose every digit (at $\Lambda = 2$, or for large ones), so it is evaluated here, in two regions.
"""

import numpy as np
import scipy  # its parts load on first use

from nonholo.base.types import Float

_FRACTION_DEPTH = 200  # enough to rounding for every ratio on the near side of the border
_SERIES_LENGTH = 60  # enough to rounding on the far side
_LEAST_BORDER = 2.5


def blade_path(
    ratio: float, start: float, elapsed: Float[np.ndarray, "K"]
) -> tuple[Float[np.ndarray, "K"], Float[np.ndarray, "K"]]:
    r"""Return $\phi - \phi_0$ and $e^{-i\Lambda\phi_0}[G(s) - G(s_0)]$ for $s = s_0 +$ `elapsed`, $\Lambda$ = `ratio`.

    Where both ends lie far out on the same side, the straight part is subtracted analytically.

    Example:
        >>> angle, path = blade_path(2.0, 0.0, np.array([800.0]))
        >>> bool(abs(angle[0] - np.pi / 2) < 1e-15), f"{abs(path[0]):.6f}"
        (True, '798.308398')
    """
    s = start + elapsed
    angle = _gudermannian_difference(start, elapsed)
    path = np.exp(1j * ratio * angle) * _rotated(ratio, s) - _rotated(ratio, np.array([start]))
    q0 = np.exp(-abs(start))
    border = max(_LEAST_BORDER, ratio)
    if q0 * border <= 1:
        together = (np.exp(-abs(s)) * border <= 1) & (s * start > 0)
        straight = np.copysign(1.0, start) * elapsed + _remainder(ratio, np.exp(-abs(s))) - _remainder(ratio, q0)
        far = np.exp(2j * ratio * np.arctan(q0)) * straight
        path = np.where(together, far if start > 0 else far.conj(), path)
    return angle, path


def _gudermannian_difference(start: float, elapsed: np.ndarray) -> np.ndarray:
    r"""Return $2\arctan\bigl(\sinh(\delta/2)/\cosh(s_0 + \delta/2)\bigr)$.

    The exponent $|\delta|/2 - |s_0 + \delta/2|$ is taken out and, since it may cancel, written without halves.
    """
    length, ahead = abs(elapsed), np.copysign(1.0, elapsed) * start
    middle = ahead + length / 2
    exponent = np.where(middle > 0, -ahead, length + ahead)
    size = np.exp(exponent) * -np.expm1(-length) / (1 + np.exp(-2 * abs(middle)))
    return 2 * np.copysign(np.arctan(size), elapsed)


def _rotated(ratio: float, s: np.ndarray) -> np.ndarray:
    r"""Return $e^{-i\Lambda\,\mathrm{gd}\,s}\,G(s)$, which for negative s is conjugate."""
    q = np.exp(-abs(s))
    far = q * max(_LEAST_BORDER, ratio) <= 1
    value = np.empty(s.shape, dtype=np.complex128)
    value[~far] = _near(ratio, abs(s[~far]))
    value[far] = _far(ratio, abs(s[far]), q[far])
    return np.where(s < 0, value.conj(), value)


def _near(ratio: float, s: np.ndarray) -> np.ndarray:
    r"""Return $(X - iT)/(1 - X)/\Lambda$, $T = \sinh s$, with Gauss's continued fraction X.

    Euler's transformation takes the argument to $w = (1 + iT)/2$, $b = \Lambda/2$; then
    ${}_2F_1(1, 1; 1 + b; w) = 1/(1 - X)$, $X = d_1 w/(1 - d_2 w/(1 - \cdots))$; the -1 is merged without cancellation.
    """
    T, b = np.sinh(s), ratio / 2
    w = (1 + 1j * T) / 2
    X = np.zeros_like(w)
    for n in range(_FRACTION_DEPTH, 0, -1):
        j = (n + 1) // 2
        X = j * (b + j - 1) / ((b + n - 1) * (b + n)) * w / (1 - X)
    return (X - 1j * T) / (1 - X) / ratio


def _far(ratio: float, s: np.ndarray, q: np.ndarray) -> np.ndarray:
    r"""Return $e^{2i\Lambda\arctan q}\,[s + C + R(q)]$: the asymptotic straight line and what is left of it."""
    constant = -1 / ratio - np.euler_gamma - scipy.special.digamma(ratio / 2) - np.log(4) - 0.5j * np.pi
    return np.exp(2j * ratio * np.arctan(q)) * (s + constant + _remainder(ratio, q))


def _remainder(ratio: float, q: np.ndarray | float) -> np.ndarray:
    r"""Return $R(q) = -\sum_{n \ge 1} \frac{f_n q^n}{n}\bigl(1 - \frac{i}{\Lambda}\frac{n^2 q}{n + 1}\bigr)$.

    The $f_n$ are the coefficients of $\bigl(\frac{1 - iq}{1 + iq}\bigr)^\Lambda$, and R comes from integrating
    $\tanh\sigma\,e^{-2i\Lambda\arctan q} - 1$ in $q = e^{-\sigma}$.
    """
    term, previous = -2j * ratio * q, np.ones_like(q)
    total = np.zeros_like(term)
    for n in range(1, _SERIES_LENGTH + 1):
        total = total - term / n * (1 - 1j / ratio * n * n * q / (n + 1))
        term, previous = (-2j * ratio * q * term - (n - 1) * q * q * previous) / (n + 1), term
    return total
