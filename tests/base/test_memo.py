"""What is computed once, of systems and of orbits, and how results are printed."""

import copy
import pickle

import numpy as np
import pytest

import nonholo as nh


def test_arrays_are_handed_out_as_copies() -> None:
    """Who changes one changes nothing else, nor does a pickled or copied system."""
    system = nh.ChaplyginSleigh(1.0, 2.0, 0.5, 0.1)
    first = system.inertia_operator
    wanted = first.copy()
    first[:] = 7.0
    for same in (system, copy.deepcopy(system), pickle.loads(pickle.dumps(system))):  # noqa: S301
        assert np.array_equal(same.inertia_operator, wanted)
    assert not np.array_equal(nh.ChaplyginSleigh(1.5, 2.0, 0.5, 0.1).inertia_operator, wanted)


def test_large_arrays_are_not_kept() -> None:
    """An inertia operator on SO(14) takes 66 kB: it is computed each time; its group is kept."""
    system = nh.RigidBody(np.diag(np.arange(1.0, 15.0)))
    assert system.inertia_operator.nbytes > 1 << 15
    assert not any(isinstance(value, np.ndarray) and value.nbytes > 1 << 15 for value in vars(system).values())
    top = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))
    assert top.group is top.group


def test_what_is_traced_is_not_kept() -> None:
    """A value of one trace must not reach another."""
    import jax

    records = []

    def energy(a: jax.Array) -> jax.Array:
        system = nh.ChaplyginSleigh(1.0, 2.0, a)
        value = system.inertia_operator.sum()
        records.append(vars(system))
        return value

    assert jax.grad(energy)(0.5) == 3.0
    assert all(set(rows) == {"mass", "inertia", "a", "b"} for rows in records)


READINGS = [
    *("body_velocity", "chart", "configuration", "displacement", "dissipation", "energy", "heading", "momentum"),
    *("multipliers", "pose", "position", "restricted_momentum", "spatial_displacement", "spatial_momentum"),
    *("tangent", "work"),
]


@pytest.mark.parametrize("name", READINGS)
def test_an_orbit_remembers_what_was_read(name: str) -> None:
    """A second reading is the same array, which nobody can write to; the columns of the orbit stay as they were."""
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 2.0, 0.5), 0.1), momentum=(0.5, 1.0), steps=5)
    first = getattr(orbit, name)
    assert getattr(orbit, name) is first
    with pytest.raises(ValueError, match="read-only"):
        first[...] = 0.0
    assert all(rows.flags.writeable for rows in orbit.rows().values())
    assert len(getattr(orbit[1:3], name)) in {1, 2}  # parts remember nothing of the whole


def test_what_an_orbit_remembers_is_its_own() -> None:
    """Copies and pickles are as small as before the reading, and a dataset can be written to."""
    orbit = nh.simulate(nh.discretize(nh.ChaplyginSleigh(1.0, 2.0, 0.5), 0.1), momentum=(0.5, 1.0), steps=5)
    size = len(pickle.dumps(orbit))
    dataset, energy = orbit.to_dataset(decoded=True), orbit.energy.copy()
    assert {*READINGS} & {*vars(orbit)}
    assert len(pickle.dumps(orbit)) == size
    assert not {*READINGS} & {*vars(copy.copy(orbit))}
    for variable in dataset.data_vars.values():
        variable.values[...] = 0.0
    dataset["time"].values[...] = 0.0
    assert np.array_equal(orbit.energy, energy)
    assert orbit.time[-1] == 5 * 0.1


TOP = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]) + 0.1)
DISCRETE = nh.discretize(TOP, 0.1)
ORBIT = nh.simulate(DISCRETE, restricted_velocity=[0.3, 0.4], steps=20)
BOARD = nh.examples.snakeboard()
RESULTS = {
    "steps: 20": lambda: nh.invariants(ORBIT),
    "outcome: successful": lambda: nh.invariants(ORBIT),
    "points: 5 of CriticalPoint": lambda: nh.critical_energies(DISCRETE),
    "energy: 0.3": lambda: nh.invariant_curve(DISCRETE, 0.3),
    "points: shape (80, 161, 3)": lambda: nh.momentum_locus(DISCRETE),
    "spatial: []": lambda: nh.conserved_momenta(TOP),
    "growth: (3, 4, 5)": lambda: nh.accessibility(BOARD.system, BOARD.configuration),
    "motion: Discretization(system=SuslovTop(axis=[0.0, 0.0, 1.0],": lambda: nh.invariant_measure(DISCRETE),
    "attracting: [ 0.1 -0.1 -0. ]": TOP.equilibria,
    "certified: False": lambda: nh.branch_growth(nh.discretize(nh.ChaplyginSleigh(1, 0.5, 0.3), 0.1)),
}


@pytest.mark.parametrize("line", RESULTS)
def test_a_result_is_printed_as_a_short_table(line: str) -> None:
    """Its name, and a line for each value."""
    result = RESULTS[line]()
    lines = repr(result).splitlines()
    assert lines[0] == type(result).__name__
    assert any(each.strip().startswith(line) for each in lines)
    assert len(lines) < 25
    assert all(len(each) <= 140 for each in lines)
