"""Write branches.json: all displacements over a restricted momentum, found on matrices without any closed form.

In the Cayley chart, on tr(D_i J (W - I)^T) = h r_i: Newton's method from random complex points, then the roots are
followed around closed paths of complex momenta until no new one appears; then 50 digits. Run from the repository root;
nothing of the library is imported here.
"""

import itertools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from make_discrete_orbits import planar
from make_general_orbits import homogeneous
from matrix_algebra import algebra, exact, inverse_of, wedge
from mpmath import mp

mp.dps = 60
_PARTS = 60  # of a side of a closed path
_QUIET = 4  # closed paths without a new root after all were found
_LOOPS = 300


def residual_and_slope(y: Any, D: Any, J: Any, target: Any, inverse: Callable[..., Any] = np.linalg.inv) -> tuple:
    """Return the equations and their derivative at many points, in float64 or in mpmath numbers."""
    eye, Y = np.eye(len(J), dtype=int), np.einsum("mi,iab->mab", y, D)
    outer = inverse(eye - Y)
    W = outer @ (eye + Y)
    arms = (D @ J).reshape(len(D), -1).T
    f = (W - eye).reshape(len(y), J.size) @ arms - target
    dW = 2 * outer[:, None] @ D @ outer[:, None]
    return f, np.swapaxes(dW.reshape(len(y), len(D), J.size) @ arms, 1, 2)


def newton(y: np.ndarray, D: np.ndarray, J: np.ndarray, target: np.ndarray, steps: int) -> np.ndarray:
    """Return where Newton's method leads, without the points that it loses."""
    for _ in range(steps):
        f, slope = residual_and_slope(y, D, J, target)
        good = np.isfinite(slope).all(axis=(1, 2)) & (np.linalg.norm(y, axis=1) < 1e7)
        good[good] = np.abs(np.linalg.det(slope[good])) > 1e-100
        y, step = y[good], np.linalg.solve(slope[good], f[good][..., None])[..., 0]
        y = y - step
    return y[np.linalg.norm(step, axis=1) < 1e-10 * (1 + np.linalg.norm(y, axis=1))]


def around(y: np.ndarray, D: np.ndarray, J: np.ndarray, target: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Follow roots along a closed path of complex momenta, which permutes them."""
    size, k = np.linalg.norm(target) * 10 ** rng.uniform(-0.5, 1), len(target)
    corners = [target, *(size * (rng.normal(size=(2, k)) + 1j * rng.normal(size=(2, k)))), target]
    for start, end in itertools.pairwise(corners):
        for t in np.linspace(0, 1, _PARTS + 1)[1:]:
            y = newton(y, D, J, (1 - t) * start + t * end, 5)
    return newton(y, D, J, target, 10)


def all_roots(D: np.ndarray, J: np.ndarray, target: np.ndarray, count: int) -> list[np.ndarray]:
    """Return the distinct roots; raise unless there are `count` when no more are found."""
    rng, roots, quiet = np.random.default_rng(5), [], 0
    y = (rng.normal(size=(400, len(D))) + 1j * rng.normal(size=(400, len(D)))) * 10 ** rng.uniform(-2, 1, size=(400, 1))
    reached = newton(y, D, J, target, 60)
    for _ in range(_LOOPS):
        before = len(roots)
        for candidate in [*reached, *reached.conj()]:  # the equations are real
            if all(np.linalg.norm(candidate - root) > 1e-6 * (1 + np.linalg.norm(root)) for root in roots):
                roots.append(candidate)
        quiet = quiet + 1 if len(roots) == before == count else 0
        if quiet == _QUIET:
            break
        reached = around(np.array(roots), D, J, target, rng)
    if len(roots) != count:
        raise ArithmeticError(f"{len(roots)} roots instead of {count}")
    return roots


def refined(y: np.ndarray, D: Any, J: Any, target: Any) -> list:
    """Return the root to 50 digits."""
    root = np.array([mp.mpmathify(complex(v)) for v in y])
    for _ in range(4):
        f, slope = residual_and_slope(root[None], D, J, target, lambda matrices: inverse_of(matrices[0])[None])
        step = inverse_of(slope[0]) @ f[0]
        root = root - step
    if np.abs(step).max() > mp.mpf(10) ** -50 * (1 + np.abs(root).max()):
        raise ArithmeticError("not converged")
    return [[float(v.real), float(v.imag)] for v in root]


def case(kind: str, parameters: dict, J: Any, D: Any, h: float, r: list[float], count: int) -> dict:
    """Return one case: a system, a momentum and the Cayley coordinates of every displacement over it."""
    J, D, target = exact(J), exact(D), exact(h) * exact(r)
    rough = all_roots(*(arguments.astype(float) for arguments in (D, J, target)), count)
    roots = [refined(y, D, J, target) for y in rough]
    print(kind, len(J), "real:", sum(all(abs(v[1]) < 1e-30 for v in y) for y in roots), flush=True)
    return {"system": kind, "parameters": parameters, "time_step": h, "momentum": r, "roots": roots}


def tensor(n: int, rng: np.random.Generator) -> list[list[float]]:
    """Draw the mass tensor of a few points."""
    points = rng.normal(size=(n + 2, n)).round(3)
    return ((points.T @ points).round(6) / 8).tolist()


def top(n: int, rng: np.random.Generator) -> dict:
    """Return a Suslov top."""
    J, k = tensor(n, rng), n - 1
    D = [algebra("SO(3)")[1], -algebra("SO(3)")[0]] if n == 3 else [wedge(i, k, n) for i in range(k)]
    r = (rng.choice([0.3, 1.0]) * rng.normal(size=k)).round(4).tolist()
    return case("top", {"mass_tensor": J}, J, D, 0.5, r, 2 * k)


def sleigh(a: float, b: float, pi: float, phat: float) -> dict:
    """Return a Chaplygin sleigh with m = 1.5, J = 1 at a point of the plane of the deltoid."""
    m = 1.5
    p1 = (phat - 2 * m * a * a) / a
    J = homogeneous(planar(m, 1.0, a, b)).astype(float)
    parameters = {"mass": m, "inertia": 1.0, "a": a, "b": b}
    return case("sleigh", parameters, J, algebra("SE(2)")[:2], 1.0, [pi - b * p1, p1], 3)


def motion(n: int, rng: np.random.Generator) -> dict:
    """Return a sleigh on SE(n)."""
    Jc, a, m = tensor(n, rng), rng.normal(size=n).round(3), 1.5
    lever = np.append(a, 1.0)
    J = np.pad(np.array(Jc), ((0, 1), (0, 1))) + m * np.outer(lever, lever)
    D = [*(wedge(0, j, n + 1) for j in range(1, n)), algebra(f"SE({n})")[-n]]
    parameters = {"mass": m, "center_of_mass": a.tolist(), "mass_tensor": Jc}
    r = (0.4 * rng.normal(size=n)).round(4).tolist()
    return case("motion", parameters, J.tolist(), D, 0.5, r, 2 * n - 1)


def main() -> None:
    """Write every case."""
    rng = np.random.default_rng(2)
    cases = [top(n, rng) for n in [3] * 20 + [4] * 5 + [6] * 5]
    inside, outside = [(0.1, -0.5), (-0.3, -0.2), (1.0, 0.1), (0.05, -1.5)], [(0.4, 0.9), (1.5, -0.5), (-0.6, -1.9)]
    cases += [sleigh(a, b, *at) for at in inside + outside for a, b in [(0.5, 0.0), (-0.4, 0.3)]]
    cases += [motion(3, rng) for _ in range(5)]
    Path("tests/golden/branches.json").write_text("[\n" + ",\n".join(json.dumps(c) for c in cases) + "\n]\n")


if __name__ == "__main__":
    main()
