"""Systems in coordinates at the public doors: the same runs, and each bad argument refused by name."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from refusals import refusals

import nonholo as nh
from nonholo.base import progress


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


def test_integer_forms_are_forms() -> None:
    """A constant form may be written with integers; the particle then moves in the plane x = z."""
    plane = nh.LagrangeDAlembert(lagrangian, lambda q: jnp.array([[1, 0, -1]]), dimension=3)  # noqa: ARG005
    orbit = nh.simulate(nh.discretize(plane, 0.1), configuration=(0, 0, 0), body_velocity=(1, 2, 1), steps=10)
    assert np.abs(orbit.configuration[-1] - [1.0, 2.0, 1.0]).max() <= 1e-14


def test_coordinates_have_names() -> None:
    """Numbered ones by default, or words of the user's own."""
    assert SYSTEM.coordinates == ("q1", "q2", "q3")
    assert nh.LagrangeDAlembert(lagrangian, forms, dimension=3, coordinates=["x", "y", "z"]).coordinates == tuple("xyz")


# Too few, twice the same, a name of another column, no word, one text, numbers.
test_what_cannot_name_columns_is_refused = refusals(
    *(
        (names, "")
        for names in (tuple("xy"), tuple("xyx"), ("x", "y", "energy"), ("x", "y", "a b"), "xyz", (1, 2, 3), 5)
    ),
    ask=lambda names: nh.LagrangeDAlembert(lagrangian, forms, dimension=3, coordinates=names),
    begin=r"LagrangeDAlembert\(coordinates=...\)` must be 3 different names",
)
# An argument that a Lagrange-d'Alembert system does not have must keep its default.
test_arguments_of_other_systems_are_refused = refusals(
    (lambda: nh.discretize(SYSTEM, 0.1, difference="matrix"), r"discretize\(difference"),
    (lambda: nh.discretize(SYSTEM, 0.1, constraint=np.linalg.norm), r"discretize\(constraint"),
    (lambda: nh.discretize(SYSTEM, 0.1, order=4), r"discretize\(order"),
    (lambda: run(restricted_velocity=(1.0, 0.5)), r"simulate\(restricted_velocity"),
    (lambda: run(branch="largest"), r"simulate\(branch"),
    (lambda: run(reconstruct=False), r"simulate\(reconstruct"),
    (lambda: run(backend="numba"), r"simulate\(backend"),
    (lambda: blocks(branch="largest"), r"iterate\(branch"),
    (lambda: flow(method="closed_form"), r"flow\(method"),
    end=r"=\.\.\.\)` must keep its default .* Leave it out",
)


def system_of(**arguments: Any) -> nh.LagrangeDAlembert:
    """Return a particle in which something is another one."""
    return nh.LagrangeDAlembert(**{"lagrangian": lagrangian, "constraint_forms": forms, "dimension": 3} | arguments)


def started(system: nh.LagrangeDAlembert, v: Any = V, **how: Any) -> Any:
    """Return its first step, or its flow."""
    if "times" in how:
        return nh.flow(system, configuration=Q, body_velocity=v, **how)
    return nh.simulate(nh.discretize(system, 0.1), configuration=Q, body_velocity=v, steps=1)


def halved(x: jax.Array) -> jax.Array:
    """Return a function through which JAX has no derivative backwards."""
    return jax.lax.while_loop(lambda c: c[0] < 3.0, lambda c: (c[0] + 1.0, c[1] / 2), (jnp.zeros(()), x))[1]


# What is wrong with a system is said when it is made, or at its first step.
test_bad_systems_are_refused = refusals(
    (lambda: system_of(rule="simpson"), "'midpoint', 'trapezoidal'"),
    (lambda: system_of(lagrangian=lambda q, v: 1 / 0), "ZeroDivisionError"),  # noqa: ARG005
    (lambda: system_of(lagrangian=lambda q, v: v @ v if q[0] > 0 else 0.0), "jnp.where"),
    (lambda: system_of(lagrangian=lambda q, v: v), "return a scalar"),  # noqa: ARG005
    (lambda: system_of(lagrangian=lambda q, v: 1j * v @ q), "complex numbers"),
    (lambda: system_of(lagrangian=lambda q, v: 1), "an integer"),  # noqa: ARG005
    (lambda: system_of(lagrangian=None), r"lagrangian=.*function. Got None"),
    (lambda: system_of(constraint_forms=lambda q: [[q[0], 0, 1]]), "returned a list"),
    (lambda: system_of(constraint_forms=lambda q: q), r"shape \(s, 3\) with 0 < s < 3"),
    (lambda: system_of(lagrangian=lambda q, v: halved(v @ v)), r"lagrangian=...\)` must be traceable by .*while_loop"),  # noqa: ARG005
    (
        lambda: system_of(discrete_lagrangian=lambda q, p, h: halved((p - q) @ (p - q)) / h),
        r"discrete_lagrangian=...\)` must be traceable by .*while_loop",
    ),
    (lambda: system_of(constraint_forms=None, prescribed={2: halved}), r"prescribed=...\)` must be .*while_loop"),
    (lambda: system_of(constraint_forms=None, prescribed=[1, 2, 3]), r"prescribed=...\)` must be functions by index"),
    (
        lambda: system_of(constraint_forms=None, prescribed={"x": halved, 2: halved}),
        r"prescribed=...\)` must have indices",
    ),
    (lambda: nh.Forced(SYSTEM, lambda q: halved(q @ q)), r"potential=...\)` must be traceable by JAX .*while_loop"),
    (
        lambda: started(system_of(constraint_forms=lambda q: jnp.array([[1.0, 0, 0], [1.0, q[0], 0]])), (0, 1, 1)),
        r"independent rows\. Got rank 1 of 2 rows",
    ),
    (lambda: started(system_of(lagrangian=lambda q, v: v[0] ** 2), times=(0, 1)), "determine the accelerations"),  # noqa: ARG005
    (
        lambda: started(system_of(discrete_constraints=lambda q, r, h: jnp.ones(1) + 0 * q[:1] * r[0] * h)),
        "vanish for q_next = q",
    ),
    (lambda: started(system_of(discrete_constraints=lambda q, r, h: (r - q)[:1] / h)), "span the constraint forms"),
)


# Each refusal says what is wrong and what to pass.
test_bad_input_is_refused = refusals(
    (lambda: run(configuration=None), r"simulate\(configuration=.*Pass the 3 coordinates"),
    (lambda: flow(configuration=None), r"flow\(configuration=.*Pass the 3 coordinates"),
    (lambda: run(body_velocity=None), "exactly one of body_velocity, displacement, momentum. Got none"),
    (lambda: run(momentum=V), "Got body_velocity and momentum"),
    (lambda: flow(momentum=V), "Got body_velocity and momentum"),
    (lambda: run(configuration=(0.0, 1.0)), r"must have shape \(3,\). Got shape \(2,\)"),
    (lambda: run(configuration=(0.0, np.nan, 0.0)), r"must be finite. Got nan at index \(1,\)"),
    (lambda: run(body_velocity=(1.0, 1.0, 0.0)), r"Got residual \[-1.\]. The nearest admissible velocity"),
    (lambda: run(body_velocity=None, displacement=(1.0, 1.0, 0.0)), "nearest admissible displacement"),
    (lambda: run(steps=0), "must be a positive integer"),
    (lambda: run(save_every=1.5), "must be a positive integer"),
    (lambda: blocks(block_steps=0), r"iterate\(block_steps=...\)` must be a positive integer"),
    (lambda: blocks(block_steps=5, save_every=2), r"a multiple of save_every = 2. Got 5"),
    (lambda: flow(times=(0.0, 1.0, 1.0)), "strictly"),
    (lambda: nh.discretize(SYSTEM, -0.1), r"discretize\(time_step=...\)` must be positive"),
    (lambda: jax.jit(lambda h: nh.discretize(SYSTEM, h).time_step)(0.1), "outside jax.jit"),
    (lambda: nh.simulate(SYSTEM, steps=3), "Pass the result of `discretize`"),
)


def test_long_compiling_is_said_once(capsys, monkeypatch) -> None:  # noqa: ANN001
    """A line on standard error at the first call, none at the second."""
    monkeypatch.setattr(progress, "_PATIENCE", 0.0)
    system = nh.LagrangeDAlembert(lambda q, v: (v @ v - q @ q) / 2, None, dimension=1)
    system.regularity([0.0], [1.0])
    assert capsys.readouterr().err.startswith("compiling a system in coordinates, once")
    system.regularity([0.0], [2.0])
    assert capsys.readouterr().err == ""


def test_rounding_of_a_form_refuses_no_start() -> None:
    """Where all terms of a row vanish but for its rounding, a start counts; one that misses by more does not."""
    rounding = 0.1 + 0.2 - 0.3
    system = nh.LagrangeDAlembert(lambda _, v: v @ v / 2, lambda _: jnp.array([[rounding, 1.0]]), dimension=2)
    discrete = nh.discretize(system, 0.1)
    assert len(nh.simulate(discrete, configuration=(0.0, 0.0), body_velocity=(1.0, 0.0), steps=1)) == 2
    with pytest.raises(ValueError, match="nearest admissible"):
        nh.simulate(discrete, configuration=(0.0, 0.0), body_velocity=(1.0, 1e-14), steps=1)
