"""The principal displacement for JAX, by the closed form of a body where it has one, which its kernel shares."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np

from nonholo import kernels
from nonholo.base.types import Array, Float
from nonholo.discrete._scheme import Scheme
from nonholo.discrete.definition._root import principal_root
from nonholo.discrete.definition._step import principal_displacement
from nonholo.discrete.routes import ScalarStep

ON_LOCUS = 1e-6  # relative distance from the momentum locus that a computed momentum may have


class ClosedStep(NamedTuple):
    """The closed form of a step, between momenta and charts of the canonical frame and those of the kernel.

    Attributes:
        body: The body of the kernel.
        momenta: C with m = C r, for r along the rows of the constraint subspace.
        rows: R with y_canonical = y R; None where they are the same.
    """

    body: kernels.Body
    momenta: Float[Array, "2 2"]
    rows: Float[Array, "2 2"] | None


def closed_step_of(discrete: Scheme, step: ScalarStep) -> ClosedStep:
    """Return the closed form with the numbers that it has for a discretization."""
    C = jnp.asarray(discrete.system.frame_map)
    return ClosedStep(step.body, step.scale * (C if step.rows is None else step.rows @ C), step.rows)


def traceable(number: Array) -> Array:
    """Return a number as a scalar array: JAX would compile the step anew for each value of a Python float."""
    return np.float64(number) if isinstance(number, float) else number


def kernel_root(body: kernels.Body, m: Float[Array, "2"], guess: Array | None = None) -> tuple[Array, Array]:
    """Return the principal root over momenta of a kernel, and the outcome; the search looks at a guess first."""

    def residual(y: Array, m: Array) -> Array:
        return jnp.stack(kernels.residual(body, *m, *y))

    return principal_root(residual, m, 2, lambda y, m: kernels.is_certain(body, *m, *y), guess)


def principal_of(discrete: Scheme, closed: ScalarStep | None, r: Float[Array, "k"], g: Array) -> tuple[Array, Array]:
    """Return canonical chart coordinates of the principal displacement with momenta r along d, and the outcome."""
    if closed is None:
        return principal_displacement(discrete, r, g)
    step = closed_step_of(discrete, closed)
    y, code = kernel_root(step.body, step.momenta @ r)
    return y if step.rows is None else y @ step.rows, code
