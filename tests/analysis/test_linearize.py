"""Linear equations beside steady motions, against closed forms, differences of the equations, and one another."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from analysis.equations import G, hoop
from comparisons import derivatives
from refusals import refusals

import nonholo as nh
from nonholo.analysis._linearize import Linearization, Local, reduced
from nonholo.base.types import Array

M, R, AXIS, DIAMETER = 1.3, 0.4, 0.12, 0.07  # of a disk


def leaning_disk() -> nh.LagrangeDAlembert:
    """Return a disk that rolls and may lean: center (x, y), yaw, lean and roll."""

    def lagrangian(q: Array, v: Array) -> Array:
        lean, (x, y, yaw, leaning, roll) = q[3], v
        height = -R * jnp.sin(lean) * leaning
        turning = DIAMETER * (leaning**2 + (yaw * jnp.cos(lean)) ** 2) + AXIS * (roll + yaw * jnp.sin(lean)) ** 2
        return (M * (x**2 + y**2 + height**2) + turning) / 2 - M * G * R * jnp.cos(lean)

    def forms(q: Array) -> Array:
        c, s, lean = jnp.cos(q[2]), jnp.sin(q[2]), q[3]
        along, across = R * jnp.sin(lean), R * jnp.cos(lean)
        return jnp.array([[1, 0, -along * c, -across * s, -R * c], [0, 1, -along * s, across * c, -R * s]])

    return nh.LagrangeDAlembert(lagrangian, forms, dimension=5, coordinates=("x", "y", "yaw", "lean", "roll"))


DISK = leaning_disk()


def rolling(lean: float, yaw: float, roll: float, heading: float = 0.3) -> dict[str, np.ndarray]:
    """Return a state of the disk that does not lean further."""
    ahead = R * (roll + yaw * np.sin(lean))
    velocity = np.array([ahead * np.cos(heading), ahead * np.sin(heading), yaw, 0.0, roll])
    return {"configuration": np.array([0.2, -0.1, heading, lean, 0.5]), "body_velocity": velocity}


def steady_roll(lean: float, yaw: float) -> float:
    """Return the roll rate of a disk that leans steadily, from the equation of the lean."""
    c, s = np.cos(lean), np.sin(lean)
    # (C + m R^2) yaw c (roll + yaw s) - A yaw^2 c s + m g R s = 0: moments about the contact
    return (DIAMETER * yaw**2 * c * s - M * G * R * s) / ((AXIS + M * R**2) * yaw * c) - yaw * s


@pytest.mark.parametrize("roll", [0.5, 3.0, 12.0])
def test_an_upright_disk_is_stable_above_its_critical_speed(roll: float) -> None:
    r"""$\lambda^2 (A + mR^2) = mgR - C(C + mR^2)\Omega^2/A$: the thin disk of textbooks, $\Omega^2 > g/3R$."""
    result = nh.linearize(DISK, **rolling(0.0, 0.0, roll))
    square = (M * G * R - AXIS * (AXIS + M * R**2) * roll**2 / DIAMETER) / (DIAMETER + M * R**2)
    assert result.names == ("lean", "yaw'", "lean'", "roll'")
    assert result.ignorable == ("x", "y", "yaw", "roll")
    wanted = np.array([np.sqrt(square + 0j), 0, 0, -np.sqrt(square + 0j)])
    distances = np.abs(result.eigenvalues[:, None] - wanted)
    assert max(distances.min(axis=0).max(), distances.min(axis=1).max()) < 1e-12  # a difference of 22 and 22 at 3


CASES = {
    "upright disk": (DISK, rolling(0.0, 0.0, 3.0)),
    "disk on a circle": (DISK, rolling(0.4, 1.5, steady_roll(0.4, 1.5))),
    "snakeboard on a circle": (
        nh.examples.snakeboard().system,
        {"configuration": [0, 0, 0.7, 0, 0.4], "body_velocity": [np.cos(0.7), np.sin(0.7), np.tan(0.4), 0.3, 0.0]},
    ),
    "oscillators": (
        nh.examples.chaotic_quartic_oscillator().system,
        {"configuration": np.zeros(7), "body_velocity": np.zeros(7)},
    ),
}


Reader = Callable[[np.ndarray, np.ndarray], np.ndarray]


def states_near(
    system: Any, names: tuple[str, ...], q: np.ndarray, v: np.ndarray, ahead: float = 0.0
) -> tuple[Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], Reader]:
    """Return the place and the velocity as a function of the states of a linearization, and what reads these off.

    Other velocities are found from the constraint at a place ahead, which a midpoint is.
    """
    columns = [system.coordinates.index(name) for name in names if not name.endswith("'")]
    free = [system.coordinates.index(name[:-1]) for name in names if name.endswith("'")]
    tied = np.setdiff1d(np.arange(system.dimension), free)

    def varied(z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        at, moving = q.copy(), v.copy()
        at[columns], moving[free] = z[: len(columns)], z[len(columns) :]
        for _ in range(30 if ahead else 1):  # the midpoint depends on what is found
            with jax.enable_x64(True):
                rows = np.asarray(system.plain.constraint_forms(jnp.asarray(at + ahead * moving)))
            moving[tied] = -np.linalg.solve(rows[:, tied], rows[:, free] @ moving[free])
        return at, moving

    return varied, lambda at, moving: np.concatenate([at[columns], moving[free]])


@pytest.mark.profile("routes", keep=["upright disk", "disk on a circle"])
@pytest.mark.parametrize(("system", "start"), CASES.values(), ids=CASES)
def test_the_matrix_is_that_of_differences_of_the_equations(system: Any, start: dict[str, Any]) -> None:
    """From the definition: vary kept states, find the other velocities from the constraint, difference the rates."""
    result, field = nh.linearize(system, **start), nh.vector_field(system)
    q, v = (np.asarray(start[name], float) for name in ("configuration", "body_velocity"))
    varied, read = states_near(system, result.names, q, v)

    def rates(z: np.ndarray) -> np.ndarray:
        return read(*np.split(field(0.0, np.concatenate(varied(z))), 2))

    np.testing.assert_allclose(result.matrix, derivatives(rates, read(q, v), 8e-3), rtol=0, atol=1e-9)


@pytest.mark.profile("routes", instead="test_multipliers_tend_to_rates")
@pytest.mark.parametrize("name", ["upright disk", "snakeboard on a circle", "oscillators"])
def test_the_matrix_of_a_map_is_that_of_differences_of_steps(name: str) -> None:
    """From the definition: vary kept states, find displacements on the discrete constraint, difference a step."""
    (system, start), h = CASES[name], 0.05
    discrete = nh.discretize(system, h)
    result, first = nh.linearize(discrete, **start), nh.simulate(discrete, steps=1, **start)
    q, v = first.configuration[0], first.body_velocity[0]
    varied, read = states_near(system, result.names, q, v, h / 2)

    def after(z: np.ndarray) -> np.ndarray:
        at, moving = varied(z)
        orbit = nh.simulate(discrete, configuration=at, displacement=h * moving, steps=1)
        return read(orbit.configuration[1], orbit.body_velocity[1])

    np.testing.assert_allclose(result.matrix, derivatives(after, read(q, v), 8e-3), rtol=0, atol=1e-9)


def test_multipliers_tend_to_rates() -> None:
    """The logarithm of a multiplier over the step is the rate, with an error that falls by four with half the step."""
    start = rolling(0.0, 0.0, 12.0)
    rate = nh.linearize(DISK, **start).eigenvalues[0]
    errors = [
        abs(np.log(nh.linearize(nh.discretize(DISK, h), **start).eigenvalues.astype(complex)) / h - rate).min()
        for h in (0.02, 0.01)
    ]
    assert abs(errors[0] / errors[1] - 4) < 0.1


def test_a_map_has_steady_motions_of_its_own() -> None:
    """A disk on a circle leans as it did after 50 steps; its roll is that of the flow up to the step squared."""
    start, moved = CASES["disk on a circle"][1], []
    for h in (0.06, 0.03):
        discrete = nh.discretize(DISK, h)
        result = nh.equilibria(discrete, **start)
        there = {"configuration": result.configuration, "body_velocity": result.body_velocity}
        orbit = nh.simulate(discrete, **there, steps=50)
        assert np.ptp(orbit.configuration[:, 3]) <= 1e-13
        assert np.ptp(orbit.body_velocity[:, 2:], axis=0).max() <= 1e-12
        moved.append(result.body_velocity[4] - steady_roll(result.configuration[3], result.body_velocity[2]))
    assert abs(moved[0]) > 1e-4
    assert abs(moved[0] / moved[1] - 4) < 0.1


@pytest.mark.profile("routes", instead="test_a_sleeping_top")
def test_transverse_rates_of_tops_of_any_dimension() -> None:
    """Eigenvalues beside an equilibrium of a top on SO(4) are the rates and multipliers of `equilibria`, and a zero."""
    top = nh.SuslovTop(np.diag([1.0, 2.0, 1.5, 1.0]) + 0.1)
    for subject in (top, nh.discretize(top, 0.2)):
        states = nh.equilibria(subject, energy=0.7)
        result = nh.linearize(subject, body_velocity=states.velocity).eigenvalues
        reference, still = (states.rates, 0.0) if states.multipliers is None else (states.multipliers, 1.0)
        np.testing.assert_allclose(np.sort(np.real(result)), np.sort(np.append(reference, still)), rtol=0, atol=1e-12)


@pytest.mark.parametrize("spin", [3.0, 3.7, 5.0])
def test_a_sleeping_top(spin: float) -> None:
    r"""A top that spins upright: $A s^2 - C\Omega s + mgl = 0$, seen from the body $\lambda = i(s - \Omega)$."""
    A, C, weight = 1.2, 1.0, 2.943
    top = nh.Forced(nh.RigidBody(np.diag([0.5, 0.5, 0.7])), nh.Gravity([0.0, 0.0, -9.81], [0.0, 0.0, 0.3]))
    s = np.roots([A, -C * spin, weight])
    result = nh.linearize(top, body_velocity=(0.0, 0.0, spin))
    assert result.names == ("xi1", "xi2", "xi3", "r1", "r2", "r3")
    for wanted in np.concatenate([1j * (s - spin), -1j * (np.conj(s) - spin), [0]]):
        assert np.abs(result.eigenvalues - wanted).min() < 1e-12
    assert bool(np.real(result.eigenvalues[0]) > 0.1) == bool((C * spin) ** 2 < 4 * A * weight)


@pytest.mark.profile("routes", instead="test_a_sleeping_top")
def test_functions_of_users_are_differenced() -> None:
    """A weight as a function of the pose gives the matrix of `Gravity`, of the flow and of the map."""
    weight, point = np.array([0.0, 0.0, -9.81]), np.array([0.1, 0.0, 0.3])
    top = nh.SuslovTop(np.diag([1.0, 1.2, 0.6]))
    exact, own = (nh.Forced(top, load) for load in (nh.Gravity(weight, point), lambda g: float(-weight @ g @ point)))
    pose = {"configuration": nh.SO(3).exp([0.0, np.arctan2(-0.1, 0.3), 0.0])}
    for one, other in ((exact, own), (nh.discretize(exact, 0.05), nh.discretize(own, 0.05))):
        first, second = nh.linearize(one, **pose), nh.linearize(other, **pose)
        assert first.names == second.names
        np.testing.assert_allclose(first.matrix, second.matrix, rtol=0, atol=1e-10)


def test_a_bead_on_a_turning_hoop() -> None:
    r"""At the bottom $\lambda^2 = \Omega^2 - g$, beside it $-\Omega^2\sin^2\theta$: a driven system may be steady."""
    speed = 4.0
    system, still = hoop(lambda t: speed * t), np.array([0.0, speed])
    bottom = nh.linearize(system, configuration=(0.0, 0.0), body_velocity=still)
    assert bottom.names == ("bead", "bead'")
    np.testing.assert_allclose(bottom.eigenvalues[0] ** 2, speed**2 - G, rtol=1e-13)
    aside = np.arccos(G / speed**2)
    result = nh.linearize(system, configuration=(aside, 0.0), body_velocity=still).eigenvalues
    np.testing.assert_allclose(result[0] ** 2, -((speed * np.sin(aside)) ** 2), rtol=1e-12)
    with pytest.raises(ValueError, match=r"must be that of a steady motion\. Got rates .*time: 1"):
        nh.linearize(hoop(jnp.sin), configuration=(0.0, 0.0), body_velocity=(0.0, 1.0))


def test_modes_and_the_table() -> None:
    """Modes have length one and are multiplied by their eigenvalues; the table has them by name, by their growth."""
    result = nh.linearize(DISK, **rolling(0.0, 0.0, 0.5))
    np.testing.assert_allclose(result.matrix @ result.modes, result.modes * result.eigenvalues, rtol=0, atol=1e-13)
    np.testing.assert_allclose(np.linalg.norm(result.modes, axis=0), 1, rtol=1e-14)
    assert np.all(np.diff(np.real(result.eigenvalues)) <= 0)
    table = result.to_pandas()
    assert tuple(table.columns) == ("eigenvalue", *result.names)
    np.testing.assert_array_equal(table["lean"], result.modes[0])
    step = nh.linearize(nh.discretize(DISK, 0.05), **rolling(0.0, 0.0, 0.5))
    assert np.all(np.diff(np.abs(step.eigenvalues)) <= 0)
    assert (result.time_step, step.time_step) == (None, 0.05)


TOP = nh.SuslovTop(np.diag([1.0, 1.2, 0.6]))
EDGE = nh.examples.knife_edge_on_incline()
SLIDING = {"configuration": EDGE.configuration, "body_velocity": EDGE.body_velocity}
HEAVY = nh.Forced(TOP, nh.Gravity([0.0, 0.0, -1.0], [0.0, 0.0, 1.0]))
DRIVEN = nh.Forced(TOP, force=lambda t, *_: np.array([np.sin(t), 0, 0]))
LATER = nh.discretize(nh.Forced(TOP, force=lambda t, *_: np.array([0.0, float(t > 0.1), 0.0])), 0.05)
WIDE = nh.SuslovTop.arrowhead(np.linspace(1, 2, 3000), np.full(2999, 0.01))

# What is not steady is refused with its rates, what has no linearization with the reason.
test_refusals = pytest.mark.profile("routes", cases=["steady motion", "must be that of a steady motion"])(
    refusals(
        (DISK, rolling(0.4, 1.5, 1.0), "must be that of a steady motion. Got rates lean: 0"),
        (EDGE.system, SLIDING, "must be that of a steady motion"),
        (nh.RigidBody(np.diag([1.0, 2.0, 3.0])), {"body_velocity": (1.0, 1.0, 0.0)}, "a steady motion"),
        (nh.discretize(HEAVY, 0.1), {"configuration": nh.SO(3).exp([0.3, 0.0, 0.0])}, "steady motion"),
        (DRIVEN, {}, "be that of a steady motion"),
        (LATER, {}, "that of a steady motion"),
        (DISK, rolling(0.0, 0.0, 1.0) | {"body_velocity": np.ones(5)}, "satisfy the constraint"),
        (DISK, {}, r"`linearize\(configuration=...\)` must be given"),
        (nh.Forced(TOP, force=np.zeros((3, 3))), {}, "must have forces that do not depend on time"),
        (DISK.forced(None, np.zeros((3, 5))), rolling(0.0, 0.0, 1.0), "must have forces at times"),
        (WIDE, {}, "at most 100000 components"),
        (nh.examples.particle(), {}, "must be a system or its map"),
        ask=lambda subject, state: nh.linearize(subject, **state),
    )
)


@pytest.mark.profile("routes", instead="nonholo.analysis._linearize.critical_values")
def test_critical_values_of_a_disk_and_a_bead() -> None:
    """Where eigenvalues meet on the axis, and where one crosses it: a bead on a hoop with friction, and its map."""
    disk = nh.critical_values(lambda roll: nh.linearize(DISK, **rolling(0.0, 0.0, roll)), (0.5, 6.0), samples=4)
    assert np.abs(disk - np.sqrt(M * G * R * DIAMETER / (AXIS * (AXIS + M * R**2)))).max() < 1e-9
    hoop = nh.LagrangeDAlembert(
        lambda q, v, p: (v @ v + p["spin"] ** 2 * jnp.sin(q[0]) ** 2) / 2 + jnp.cos(q[0]),
        None,
        dimension=1,
        force=nh.Friction([0.3]),
        parameters={"spin": 1.0},
    )
    for family, error in ((lambda system: system, 1e-12), (lambda system: nh.discretize(system, 0.01), 1e-9)):
        result = nh.critical_values(
            lambda spin, family=family: nh.linearize(family(hoop.with_parameters(spin=spin)), configuration=[0.0]),
            (0.5, 1.6),
            samples=3,
        )
        assert np.abs(result - 1.0).max() < error


# Neither needs a system.
test_bad_arguments_of_critical_values_are_refused = refusals(
    (lambda: nh.critical_values("abc", (0.0, 1.0)), r"critical_values\(linearization=...\)` must be a function"),
    (lambda: nh.critical_values(lambda spin: spin, (0.0, 1.0)), "return a Linearization"),
    (lambda: nh.critical_values(lambda spin: spin, (1.0, 1.0)), "must have its lower end first"),
)


def test_a_multiple_eigenvalue_that_changes_its_sign_is_seen() -> None:
    """One of a Jordan block, whose condition number is infinite; where it is zero the states may be ignorable."""
    block, names = np.eye(3) - np.eye(3, k=1), ("a", "b", "c")

    def at(speed: float) -> Linearization:
        return Linearization(speed * block if speed else np.zeros((0, 0)), names if speed else (), (), None)

    for samples, error in ((12, 1e-12), (34, 1e-6)):  # then one is at zero, and what is neutral hides it
        assert nh.critical_values(at, (-1.3, 2.1), samples=samples) == pytest.approx([0.0], abs=error)


@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e12])
@pytest.mark.parametrize("states", [1, 2])
def test_a_critical_value_does_not_depend_on_the_unit_of_the_parameter(unit: float, states: int) -> None:
    """Where one eigenvalue crosses the axis, and where two meet on it and part: to rounding, however small."""

    def at(value: float) -> Linearization:
        x = value / unit - 0.37
        matrix = np.array([[np.expm1(3 * x)]]) if states == 1 else np.array([[0.0, 1.0], [x, 0.0]])
        return Linearization(matrix, tuple("ab"[:states]), (), None)

    assert nh.critical_values(at, (-0.2 * unit, unit), samples=4) == pytest.approx([0.37 * unit], rel=1e-12, abs=0.0)


def test_eigenvalues_that_are_rounding_alone_never_grow() -> None:
    """Of a car that turns: no change comes back to itself, so only the largest derivative tells what is small."""

    def at(speed: float) -> Linearization:
        noise = 1e-17 * np.sin(40 * speed)
        matrix = np.array([[0.0, 0.0, 1.0], [10 * noise, noise, 0.3 * speed], [0.0, 0.0, 0.0]])
        return Linearization(matrix, ("phi", "psi'", "phi'"), (), None, rate=1.0)

    assert len(nh.critical_values(at, (-1.3, 2.1), samples=12)) == 0


def test_eigenvalues_that_are_zero_twice_never_grow() -> None:
    """Of a snakeboard on circles all are zero: rounding, which parts double ones by its root, is no growth."""
    board = nh.examples.snakeboard()

    def on_a_circle(rate: float) -> Any:
        velocity = rate * np.asarray(board.body_velocity)
        return nh.equilibria(board.system, configuration=board.configuration, body_velocity=velocity).linearization

    assert len(nh.critical_values(on_a_circle, (0.5, 2.0))) == 0


def test_the_nearest_of_a_family_of_steady_motions_is_found() -> None:
    """A bent trailer that turns is straightened where it is, not turned about and stopped, as by undamped steps."""
    bent = nh.examples.trailers(hitches=(1.0,), angles=(0.4, 0.35), speed=0.6, turning=0.1)
    steady = nh.equilibria(bent.system, configuration=bent.configuration, body_velocity=bent.body_velocity)
    assert np.abs(steady.configuration - bent.configuration).max() < 0.05
    assert np.linalg.norm(steady.body_velocity[:2]) == pytest.approx(0.6, abs=0.02)


def test_what_depends_on_what_does_not_depend_on_units() -> None:
    """Equations of a blade, with lengths and times as other numbers, which may be large."""
    rng, results = np.random.default_rng(0), []
    slope = rng.normal(size=(4, 6, 6))
    for length, time in ((1.0, 1.0), (1e3, 1.0), (1.0, 3.0), (1e3, 1e8)):
        places = np.array([length, length, 1.0])
        units, both = places / time, np.append(places, places / time)
        rows = np.tile(np.append(np.zeros(3), 1 / units), (4, 1, 1))
        state, still = np.zeros(6), np.zeros((4, 6))
        names = tuple("xyzuvw")
        scaled = slope * both[:, None] / both / time
        result = reduced(Local(names, 3, state, still, scaled, rows, np.zeros(1), units, False))
        results.append((result.states, result.matrix / both[result.states][:, None] * both[result.states] * time))
    for states, matrix in results[1:]:
        np.testing.assert_array_equal(states, results[0][0])
        np.testing.assert_allclose(matrix, results[0][1], 1e-12)
