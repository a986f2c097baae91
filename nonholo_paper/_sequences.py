"""Sequences of displacements: any, for identities, and orbits of the library, for equations of motion."""

import itertools

import numpy as np

import nonholo as nh
from nonholo_paper import _twin as twin
from nonholo_paper._bodies import Body, pose
from nonholo_paper._twin import Matrix, ctx

STEPS = 4


def displacements(body: Body) -> list[Matrix]:
    """Return displacements that do not follow from each other, some of more than half a turn."""
    k = len(body.subspace)
    return [body.displacement(body.velocity([s * c for c in twin.numbers(31 + s, k)])) for s in (1, 3, 2, 4)]


def poses(body: Body) -> list[Matrix]:
    """Return the poses that these displacements lead to, from a random one."""
    return list(itertools.accumulate(displacements(body), lambda g, W: g * W, initial=pose(body)))


def slope(body: Body, W: Matrix) -> Matrix:
    """Return the partial derivatives of l_d(W) = tr((W - I) J (W - I)^T)/2 by the entries of W."""
    return (W - ctx.eye(W.rows)) * body.tensor


def orbit(body: Body) -> nh.Orbit:
    """Return an orbit of the library with time step 1."""
    coefficients = [0.5, -0.25, 0.125][: len(body.subspace)]
    return nh.simulate(nh.discretize(body.system, 1.0), restricted_velocity=coefficients, steps=STEPS)


def exactly(W: np.ndarray) -> Matrix:
    """Return a matrix of the library, digit for digit."""
    return ctx.matrix(W.tolist())
