"""The same functions under JAX: values of compiled code, derivatives at the identity, groups as static arguments."""

from collections.abc import Iterator

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from groups.examples import HEISENBERG, OTHERS, RIGID, SL2, SL3, TWO_BODIES, close, vectors

from nonholo.base.numerics import exponential_increment
from nonholo.groups import SE, SO, AbstractMatrixGroup, ProductGroup, Translations

# SO(5), SO(6), SE(4) and SE(5) run the code of SO(4) and SE(3)
COMPILED = [group for group in [*RIGID, *OTHERS] if group not in (SO(5), SO(6), SE(4), SE(5), TWO_BODIES)]


@pytest.fixture(autouse=True)
def _double_precision() -> Iterator[None]:
    with jax.enable_x64(True):
        yield


def _everything(group: AbstractMatrixGroup, x: jax.Array) -> dict[str, jax.Array]:
    g = group.exp(x)
    pose = group.pose_from_matrix(g)
    return {
        "exp": g,
        "log": group.log(g),
        "retract_increment": group.retract_increment(x),
        "inverse": group.inverse(g),
        "adjoint": group.adjoint(g),
        "coadjoint": group.coadjoint(g, x),
        "coad": group.coad(x, x[::-1]),
        "dexp_inverse": group.dexp_inverse(x),
        "angle": group.angle(x),
        "residual": group.residual(g),
        "matrix_from_pose": group.matrix_from_pose(pose),
        "pose_rate": group.pose_rate(pose, x),
    }


@pytest.mark.profile("routes", keep=["SO(3)", "ProductGroup(SE(2)*"])
@pytest.mark.parametrize("group", COMPILED, ids=str)
def test_compiled_functions_agree_with_numpy(group: AbstractMatrixGroup) -> None:
    """One jit over everything, the group a static argument, on several points at once."""
    x = vectors(group, 4, 0.6)
    result = jax.jit(_everything, static_argnums=0)(group, jnp.asarray(x))
    for name, expected in _everything(group, x).items():
        assert close(np.asarray(result[name]), expected, 300), name


@pytest.mark.profile("routes", keep=["0.0"])
@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 0.9999, 1.0001, np.pi, 2 * np.pi, 30.0])
def test_the_closed_form_of_screws_is_the_series(angle: float) -> None:
    """On se(3) exp(x) - I and its derivatives are those of the exponential of matrices, to rounding of each entry."""
    group, x = SE(3), np.array([0.6, -0.48, 0.64, 0.3, -2.0, 0.7])
    x[:3] *= angle
    functions = group.exp_increment, lambda x: exponential_increment(group.hat(x))
    for of in (lambda f: f, jax.jacfwd, lambda f: jax.jacrev(jax.jacfwd(f))):
        ours, series = (np.asarray(jax.jit(of(f))(jnp.asarray(x))) for f in functions)
        assert np.abs(ours - series).max() <= 2e-15 * max(1.0, angle) ** 2 * np.abs(series).max()
    tiny = jax.jit(functions[0])(jnp.asarray(1e-12 * x))[:3, :3]
    assert np.abs(tiny - group.hat(1e-12 * x)[:3, :3]).max() <= 1e-24 * angle**2


@pytest.mark.profile("routes", keep=["1e-09-SE(3)", "3.1-SE(3)"])
@pytest.mark.parametrize("group", [SO(4), SO(6), SE(3), SE(4)], ids=str)
@pytest.mark.parametrize("angle", [1e-9, 0.5, 2.5, 3.1])
def test_traced_logarithm_of_large_turns(group: AbstractMatrixGroup, angle: float) -> None:
    """Accurate to rounding times the condition of I + W, which is 50 at angle 3.1, and relative near the identity."""
    x = vectors(group, 10)
    x = x * (angle / group.angle(x))[:, None]
    result = np.asarray(jax.jit(group.log)(jnp.asarray(group.exp(x))))
    assert np.abs(result - x).max() <= (2e-14 if angle < 3 else 1e-12) * np.abs(x).max()


@pytest.mark.profile("routes", keep=["forward-SO(3)", "reverse-ProductGroup*"])
@pytest.mark.parametrize(
    "group", [SO(2), SO(3), SO(4), SE(3), HEISENBERG, SL2, SL3, ProductGroup(SE(2), Translations(1))], ids=str
)
@pytest.mark.parametrize("derivative", [jax.jacfwd, jax.jacrev], ids=["forward", "reverse"])
def test_derivatives_at_the_identity(group: AbstractMatrixGroup, derivative: object) -> None:
    """log(exp(v)) and log(retract(v)) have the identity as derivative at zero, in both modes."""
    through = jax.jit(derivative(lambda v: (group.log(group.exp(v)), group.log(group.retract(v)))))(
        jnp.zeros(group.dim)
    )
    for result in through:
        assert close(np.asarray(result), np.eye(group.dim), 20)


@pytest.mark.profile("routes", keep=["SO(3)"])
@pytest.mark.parametrize("group", [SO(3), SE(2), SE(3), SO(4), SL2], ids=str)
def test_higher_derivatives_beside_the_identity(group: AbstractMatrixGroup) -> None:
    """The second and third derivative of log(exp(x)) are zero at the identity, and at every distance from it."""
    x, way = vectors(group, 2, 1.0)
    second = jax.jacfwd(jax.jacfwd(lambda t, x: group.log(group.exp(x + t * way))))
    both = jax.jit(lambda x: (second(0.0, x), jax.jacfwd(second)(0.0, x)))
    for size in (0.0, 1e-100, 1e-12, 1e-8, 1e-4, 0.01, 0.1):
        for order, result in zip((2, 3), both(size * x), strict=True):  # of quotients that lose digits
            assert np.abs(np.asarray(result)).max() < 1e-14 / max(size, 0.003) ** (order - 1)


@pytest.mark.profile("routes", keep=["SE(3)"])
@pytest.mark.parametrize("group", [SO(4), SE(3), SL2], ids=str)
def test_derivative_of_the_traced_logarithm(group: AbstractMatrixGroup) -> None:
    """Automatic differentiation of log at a general point is dexp^-1."""
    x = vectors(group, 1, 0.7)[0]
    g = jnp.asarray(group.exp(x))
    result = jax.jit(jax.jacfwd(lambda d: group.log(group.exp(d) @ g)))(jnp.zeros(group.dim))
    assert close(np.asarray(result), group.dexp_inverse(x), 1000)
