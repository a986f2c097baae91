"""Systems in coordinates at the public doors: the same runs, and each bad argument refused by name."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import nonholo as nh
from nonholo.lagrange_dalembert import _functions


def lagrangian(q, v):  # noqa: ANN001, ANN201, ARG001
    """Return the kinetic energy of a particle."""
    return v @ v / 2


def forms(q):  # noqa: ANN001, ANN201
    """Return the contact form dz - y dx."""
    return jnp.array([[-q[1], 0.0, 1.0]])


SYSTEM = nh.LagrangeDAlembert(lagrangian, forms, dimension=3)
Q, V = (0.0, 1.0, 0.0), (1.0, 0.5, 1.0)


def run(**changes) -> nh.lagrange_dalembert.CoordinateOrbit:  # noqa: ANN003
    """Return a short orbit."""
    return nh.simulate(nh.discretize(SYSTEM, 0.1), **({"configuration": Q, "body_velocity": V, "steps": 4} | changes))


def flow(**changes) -> nh.lagrange_dalembert.CoordinateOrbit:  # noqa: ANN003
    """Return a short flow."""
    return nh.flow(SYSTEM, **({"configuration": Q, "body_velocity": V, "times": (0.0, 1.0)} | changes))


def blocks(**changes) -> object:  # noqa: ANN003
    """Return the iterator over a short run; it checks its arguments before any block is asked for."""
    return nh.iterate(nh.discretize(SYSTEM, 0.1), **({"configuration": Q, "body_velocity": V, "steps": 4} | changes))


def test_former_methods_name_the_function() -> None:
    """A method of 0.2 raises an error that names the function in its place; any other name raises as always."""
    discrete = nh.discretize(SYSTEM, 0.1)
    for owner, names in ((SYSTEM, ("discretize", "flow")), (discrete, ("simulate", "iterate"))):
        for name in names:
            assert not hasattr(owner, name)
            with pytest.raises(AttributeError, match=rf"\.{name}` is now `nonholo\.{name}\(.*migration\.md"):
                getattr(owner, name)
        with pytest.raises(AttributeError, match="has no attribute 'fly'"):
            getattr(owner, "fly")  # noqa: B009


def test_a_flow_starts_from_a_momentum() -> None:
    """The velocity (1, 0.5, 1) has the momentum (1, 0.5, 1), and so has any multiple of the form added to it."""
    orbit = flow(body_velocity=None, momentum=np.array(V) + 3.0 * np.array([-1.0, 0.0, 1.0]))
    assert np.abs(orbit.configuration - flow().configuration).max() <= 1e-14


def test_integer_forms_are_forms() -> None:
    """A constant form may be written with integers; the particle then moves in the plane x = z."""
    plane = nh.LagrangeDAlembert(lagrangian, lambda q: jnp.array([[1, 0, -1]]), dimension=3)  # noqa: ARG005
    orbit = nh.simulate(nh.discretize(plane, 0.1), configuration=(0, 0, 0), body_velocity=(1, 2, 1), steps=10)
    assert np.abs(orbit.configuration[-1] - [1.0, 2.0, 1.0]).max() <= 1e-14


def test_coordinates_have_names() -> None:
    """Numbered ones by default, or words of the user's own."""
    assert SYSTEM.coordinates == ("q1", "q2", "q3")
    assert nh.LagrangeDAlembert(lagrangian, forms, dimension=3, coordinates=["x", "y", "z"]).coordinates == tuple("xyz")


@pytest.mark.parametrize(
    "names", [("x", "y"), ("x", "y", "x"), ("x", "y", "energy"), ("x", "y", "a b"), "xyz", (1, 2, 3), 5]
)
def test_what_cannot_name_columns_is_refused(names: object) -> None:
    """Too few, twice the same, a name of another column, no word, one text, numbers."""
    with pytest.raises(ValueError, match=r"LagrangeDAlembert\(coordinates=...\)` must be 3 different names"):
        nh.LagrangeDAlembert(lagrangian, forms, dimension=3, coordinates=names)


FOREIGN = {
    "difference": (lambda: nh.discretize(SYSTEM, 0.1, difference="matrix"), r"discretize\(difference"),
    "constraint": (lambda: nh.discretize(SYSTEM, 0.1, constraint=np.linalg.norm), r"discretize\(constraint"),
    "order": (lambda: nh.discretize(SYSTEM, 0.1, order=4), r"discretize\(order"),
    "restricted_velocity": (lambda: run(restricted_velocity=(1.0, 0.5)), r"simulate\(restricted_velocity"),
    "branch": (lambda: run(branch="largest"), r"simulate\(branch"),
    "reconstruct": (lambda: run(reconstruct=False), r"simulate\(reconstruct"),
    "backend": (lambda: run(backend="numba"), r"simulate\(backend"),
    "branch of blocks": (lambda: blocks(branch="largest"), r"iterate\(branch"),
    "method": (lambda: flow(method="closed_form"), r"flow\(method"),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_arguments_of_other_systems_are_refused(name: str) -> None:
    """What a Lagrange-d'Alembert system does not have must keep its default."""
    call, words = FOREIGN[name]
    with pytest.raises(ValueError, match=words + r"=\.\.\.\)` must keep its default .* Leave it out"):
        call()


BAD = {
    "no configuration": (lambda: run(configuration=None), r"simulate\(configuration=.*Pass the 3 coordinates"),
    "no configuration of a flow": (lambda: flow(configuration=None), r"flow\(configuration=.*Pass the 3 coordinates"),
    "no start": (lambda: run(body_velocity=None), "exactly one of body_velocity, displacement, momentum. Got none"),
    "two starts": (lambda: run(momentum=V), "Got body_velocity and momentum"),
    "two starts of a flow": (lambda: flow(momentum=V), "Got body_velocity and momentum"),
    "shape": (lambda: run(configuration=(0.0, 1.0)), r"must have shape \(3,\). Got shape \(2,\)"),
    "nan": (lambda: run(configuration=(0.0, np.nan, 0.0)), r"must be finite. Got nan at index \(1,\)"),
    "velocity": (lambda: run(body_velocity=(1.0, 1.0, 0.0)), r"Got residual \[-1.\]. The nearest admissible velocity"),
    "displacement": (lambda: run(body_velocity=None, displacement=(1.0, 1.0, 0.0)), "nearest admissible displacement"),
    "steps": (lambda: run(steps=0), "must be a positive integer"),
    "save_every": (lambda: run(save_every=1.5), "must be a positive integer"),
    "block of no steps": (lambda: blocks(block_steps=0), r"iterate\(block_steps=...\)` must be a positive integer"),
    "block": (lambda: blocks(block_steps=5, save_every=2), r"a multiple of save_every = 2. Got 5"),
    "times": (lambda: flow(times=(0.0, 1.0, 1.0)), "strictly"),
    "time step": (lambda: nh.discretize(SYSTEM, -0.1), r"discretize\(time_step=...\)` must be positive"),
    "traced": (lambda: jax.jit(lambda h: nh.discretize(SYSTEM, h).time_step)(0.1), "outside jax.jit"),
    "not discretized": (lambda: nh.simulate(SYSTEM, steps=3), "Pass the result of `discretize`"),
    "rule": (lambda: nh.LagrangeDAlembert(lagrangian, forms, dimension=3, rule="simpson"), "'midpoint', 'trapezoidal'"),
    "raises": (lambda: nh.LagrangeDAlembert(lambda q, v: 1 / 0, forms, dimension=3), "ZeroDivisionError"),  # noqa: ARG005
    "branches": (
        lambda: nh.LagrangeDAlembert(lambda q, v: v @ v if q[0] > 0 else 0.0, forms, dimension=3),
        "jnp.where",
    ),
    "vector": (lambda: nh.LagrangeDAlembert(lambda q, v: v, forms, dimension=3), "return a scalar"),  # noqa: ARG005
    "complex": (lambda: nh.LagrangeDAlembert(lambda q, v: 1j * v @ q, forms, dimension=3), "complex numbers"),
    "constant": (lambda: nh.LagrangeDAlembert(lambda q, v: 1, forms, dimension=3), "an integer"),  # noqa: ARG005
    "no lagrangian": (lambda: nh.LagrangeDAlembert(None, forms, dimension=3), r"lagrangian=.*function. Got None"),
    "list": (lambda: nh.LagrangeDAlembert(lagrangian, lambda q: [[q[0], 0, 1]], dimension=3), "returned a list"),
    "form": (lambda: nh.LagrangeDAlembert(lagrangian, lambda q: q, dimension=3), r"shape \(s, 3\) with 0 < s < 3"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_refused(name: str) -> None:
    """Each refusal says what is wrong and what to pass."""
    call, words = BAD[name]
    with pytest.raises(ValueError, match=words):
        call()


def test_dependent_forms_are_refused_where_they_are() -> None:
    """Two forms that agree at the start have rank 1 there."""
    crossing = nh.LagrangeDAlembert(lagrangian, lambda q: jnp.array([[1.0, 0.0, 0.0], [1.0, q[1], 0.0]]), dimension=3)
    with pytest.raises(ValueError, match=r"independent rows\. Got rank 1 of 2 rows"):
        nh.simulate(nh.discretize(crossing, 0.1), configuration=(0, 0, 0), body_velocity=(0, 1, 1), steps=1)


def test_a_lagrangian_without_inertia_is_refused() -> None:
    """Admissible directions without kinetic energy leave the acceleration undetermined."""
    flat = nh.LagrangeDAlembert(lambda q, v: v[0] ** 2, forms, dimension=3)  # noqa: ARG005
    with pytest.raises(ValueError, match="determine the accelerations"):
        nh.flow(flat, configuration=Q, body_velocity=V, times=(0.0, 1.0))


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda q, r, h: jnp.ones(1) + 0 * q[:1] * r[0] * h, "vanish for q_next = q"),
        (lambda q, r, h: (r - q)[:1] / h, "span the constraint forms"),
    ],
    ids=["value", "direction"],
)
def test_discrete_constraints_must_fit_the_forms(function: object, words: str) -> None:
    """A discrete constraint vanishes at rest, and short steps along the forms satisfy it."""
    other = nh.LagrangeDAlembert(lagrangian, forms, dimension=3, discrete_constraints=function)
    with pytest.raises(ValueError, match=words):
        nh.simulate(nh.discretize(other, 0.1), configuration=Q, body_velocity=V, steps=1)


def test_long_compiling_is_said_once(capsys, monkeypatch) -> None:  # noqa: ANN001
    """A line on standard error at the first call, none at the second."""
    monkeypatch.setattr(_functions, "_PATIENCE", 0.0)
    system = nh.LagrangeDAlembert(lambda q, v: (v @ v - q @ q) / 2, None, dimension=1)
    system.regularity([0.0], [1.0])
    assert capsys.readouterr().err.startswith("compiling a system in coordinates, once")
    system.regularity([0.0], [2.0])
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("argument", ["lagrangian", "discrete_lagrangian", "prescribed", "potential"])
def test_what_has_no_derivative_in_jax_is_refused_at_the_door(argument: str) -> None:
    """JAX differentiates no `while_loop` backwards: that is said when the system is made, not at its first step."""

    def halved(x: jax.Array) -> jax.Array:
        return jax.lax.while_loop(lambda c: c[0] < 3.0, lambda c: (c[0] + 1.0, c[1] / 2), (jnp.zeros(()), x))[1]

    given = {
        "lagrangian": lambda q, v: halved(v @ v),  # noqa: ARG005
        "discrete_lagrangian": lambda q, p, h: halved((p - q) @ (p - q)) / h,
        "prescribed": {2: halved},
        "potential": lambda q: halved(q @ q),
    }[argument]
    free: dict[str, Any] = {"lagrangian": lagrangian, "constraint_forms": None, "dimension": 3}

    def made(given: Any) -> Any:
        if argument == "potential":
            return nh.Forced(nh.LagrangeDAlembert(**free), given)
        return nh.LagrangeDAlembert(**{**free, argument: given})

    with pytest.raises(ValueError, match=rf"{argument}=...\)` must be traceable by JAX .*while_loop"):
        made(given)


def test_rounding_of_a_form_refuses_no_start() -> None:
    """Where all terms of a row vanish but for its rounding, a start counts; one that misses by more does not."""
    rounding = 0.1 + 0.2 - 0.3
    system = nh.LagrangeDAlembert(lambda _, v: v @ v / 2, lambda _: jnp.array([[rounding, 1.0]]), dimension=2)
    discrete = nh.discretize(system, 0.1)
    assert len(nh.simulate(discrete, configuration=(0.0, 0.0), body_velocity=(1.0, 0.0), steps=1)) == 2
    with pytest.raises(ValueError, match="nearest admissible"):
        nh.simulate(discrete, configuration=(0.0, 0.0), body_velocity=(1.0, 1e-14), steps=1)
