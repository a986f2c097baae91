r"""Schemes that call a solver at each step, written from their published descriptions with NumPy and SciPy.

- `moser_veselov`: the discrete Lagrange-d'Alembert principle on group elements, [fedorov-zenkov-2004]: the map that the
  library computes in closed form. `scipy.optimize.root` finds each displacement.
- `cayley_lagrange_dalembert`: the principle with $l_d = h\,l(\mathrm{cay}^{-1}(W)/h)$ for the top, in the form of
  [bou-rabee-marsden-2009]; for such maps of the Suslov problem see [jimenez-scheurle-2018] and
  [garcia-naranjo-jimenez-2016].
- `midpoint_coordinates`: the principle with the midpoint rule in $(\theta, x, y)$, [cortes-martinez-2001],
  for the sleigh.
- `midpoint_retraction`: a discretization map on the constraint distribution, of the kind of
  [vivek-martin-banavar-2025]; the choice of the symmetric Cayley map, $\eta = (\eta_k + \eta_{k+1})/2$,
  $g_{k+1} = g_k\,\mathrm{cay}(h\eta)$, is ours.

Each function returns body velocities and poses at all steps.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import fsolve, root

from peers.problems import SLEIGH, Problem, top_constants

Run = tuple[np.ndarray, np.ndarray]
TOLERANCE = 1e-12


def cayley(Y: np.ndarray) -> np.ndarray:
    """Return the Cayley image of 2 Y."""
    identity = np.eye(len(Y))
    return np.linalg.solve(identity - Y, identity + Y)


def hat(w: np.ndarray) -> np.ndarray:
    """Return the matrix of a cross product."""
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def moser_veselov(problem: Problem, h: float, steps: int) -> Run:
    """Solve the momentum equations for each displacement of exp d."""
    system = problem.system
    J, d = system.homogeneous_mass_tensor, system.constraint_subspace
    basis = np.einsum("ai,ijk->ajk", d, system.group.basis)
    inertia = d @ system.inertia_operator @ d.T
    identity = np.eye(len(J))

    def displacement(y: np.ndarray) -> np.ndarray:
        return cayley(np.tensordot(y, basis, 1))

    def leaving(y: np.ndarray) -> np.ndarray:
        W = displacement(y)
        return np.tensordot(basis, (W @ J @ (W - identity).T).T, 2) / h

    def arriving(W: np.ndarray) -> np.ndarray:
        return np.tensordot(basis, (J @ (W - identity).T @ W).T, 2) / h

    r = inertia @ d @ np.array(problem.velocity)
    y, g = h / 2 * np.linalg.solve(inertia, r), identity
    velocities, poses = [], []
    for _ in range(steps + 1):
        velocities.append(np.linalg.solve(inertia, r) @ d)
        poses.append(g)
        y = root(lambda y, r=r: leaving(y) - r, y, tol=TOLERANCE).x
        W = displacement(y)
        r, g = arriving(W), g @ W
    return np.array(velocities), np.array(poses)


def cayley_lagrange_dalembert(problem: Problem, h: float, steps: int) -> Run:
    """Solve the trivialized discrete Euler-Poincare-Suslov equations of the top for the velocity of each step."""
    inertia = problem.system.inertia_operator
    along, identity = inertia[:2, :2], np.eye(3)

    def momentum(xi: np.ndarray, h: float) -> np.ndarray:
        full = np.append(xi, 0)
        inverse_differential = identity - h / 2 * hat(full) + h * h / 4 * np.outer(full, full)
        return (inverse_differential.T @ inertia @ full)[:2]

    p, g = along @ np.array(problem.velocity[:2]), identity
    xi, velocities, poses = np.array(problem.velocity[:2]), [], []
    for _ in range(steps + 1):
        velocities.append(np.append(np.linalg.solve(along, p), 0))
        poses.append(g)
        xi = root(lambda xi, p=p: momentum(xi, h) - p, xi, tol=TOLERANCE).x
        p, g = momentum(xi, -h), g @ cayley(h / 2 * hat(np.append(xi, 0)))
    return np.array(velocities), np.array(poses)


def midpoint_coordinates(problem: Problem, h: float, steps: int) -> Run:
    """Solve for coordinates and multiplier of the sleigh at each step."""
    m, inertia, a = (float(x) for x in (SLEIGH.mass, SLEIGH.inertia, SLEIGH.a))
    turning = inertia + m * a * a

    def constraint(angle: float) -> np.ndarray:
        return np.array([0, -np.sin(angle), np.cos(angle)])

    def momenta(q: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        v, angle = (after - q) / h, (q[0] + after[0]) / 2
        across = constraint(angle)
        p = np.array([turning * v[0], m * v[1], m * v[2]]) + m * a * (v[0] * across + [across @ v, 0, 0])
        force = np.array([-m * a * v[0] * (v[1] * np.cos(angle) + v[2] * np.sin(angle)), 0, 0])
        return p - h / 2 * force, p + h / 2 * force

    def equations(unknown: np.ndarray, q: np.ndarray, p: np.ndarray) -> np.ndarray:
        after, multiplier = unknown[:3], unknown[3]
        start, _ = momenta(q, after)
        admissible = constraint((q[0] + after[0]) / 2) @ (after - q) / h
        return np.append(start - p - multiplier * constraint(q[0]), admissible)

    omega, v = problem.velocity[:2]
    q, p = np.zeros(3), np.array([turning * omega, m * v, m * a * omega])
    unknown, velocities, poses = np.array([h * omega, h * v, 0, 0]), [], []
    for _ in range(steps + 1):
        c, s = np.cos(q[0]), np.sin(q[0])
        velocities.append([p[0] / turning, (p[1] * c + p[2] * s) / m, 0])
        poses.append([[c, -s, q[1]], [s, c, q[2]], [0, 0, 1]])
        unknown = root(equations, unknown, args=(q, p), tol=TOLERANCE).x
        after = unknown[:3]
        p = momenta(q, after)[1]
        q, unknown = after, np.append(2 * after - q, 0)
    return np.array(velocities), np.array(poses)


def midpoint_retraction(problem: Problem, h: float, steps: int) -> Run:
    """Solve Hamel's equations at the middle of the step, and move by the Cayley map of the middle velocity."""
    d, basis = problem.system.constraint_subspace, problem.system.group.basis
    rate = hamel_rate(problem)
    eta = d @ np.array(problem.velocity)
    g, velocities, poses = np.eye(3), [], []
    for _ in range(steps + 1):
        velocities.append(eta @ d)
        poses.append(g)
        after = fsolve(lambda new, eta=eta: new - eta - h * rate((eta + new) / 2), eta, xtol=TOLERANCE)
        middle = (eta + after) / 2
        g = g @ cayley(h / 2 * np.tensordot(middle @ d, basis, 1))
        eta = after
    return np.array(velocities), np.array(poses)


def hamel_rate(problem: Problem) -> Callable[[np.ndarray], np.ndarray]:
    """Return the rate of the coefficients along d."""
    if problem.name == "Suslov top":
        inverse, c = top_constants()
        return lambda w: -(c[1] * w[0] - c[0] * w[1]) * (inverse @ np.array([-w[1], w[0]]))
    a = float(SLEIGH.a)
    lever = float(SLEIGH.mass * a / (SLEIGH.inertia + SLEIGH.mass * a * a))
    return lambda w: np.array([-lever * w[0] * w[1], a * w[0] * w[0]])


SCHEMES: dict[str, dict[str, Callable[[Problem, float, int], Run]]] = {
    "Suslov top": {
        "discrete Lagrange-d'Alembert on SO(3), scipy root": moser_veselov,
        "the same with the Cayley Lagrangian, scipy root": cayley_lagrange_dalembert,
        "midpoint retraction, scipy fsolve": midpoint_retraction,
    },
    "Chaplygin sleigh": {
        "discrete Lagrange-d'Alembert on SE(2), scipy root": moser_veselov,
        "discrete Lagrange-d'Alembert, midpoint coordinates, scipy root": midpoint_coordinates,
        "midpoint retraction, scipy fsolve": midpoint_retraction,
    },
}
