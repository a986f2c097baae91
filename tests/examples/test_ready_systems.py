"""What every ready system offers: a picture, tables, files, and a comparison with its flow."""

import functools

import numpy as np
import pytest

import nonholo as nh
from nonholo.base.numerics import double_precision
from nonholo.examples import Example
from nonholo.lagrange_dalembert import CoordinateOrbit

FORCED = {"heavy_suslov_top", "sleigh_in_a_well"}  # bodies, whose orbits are those of nh.Orbit: test_driven.py
NAMES = sorted(set(nh.examples.__all__) - {"Example"} - FORCED)
COORDINATES = [name for name in NAMES if name != "chaplygin_ball"]
HERE = pytest.mark.profile("routes", keep=["particle"])


@functools.cache
def ready(name: str) -> Example:
    """Return an example with its default parameters."""
    return getattr(nh.examples, name)()


@functools.cache
def run(name: str, steps: int = 40) -> CoordinateOrbit:
    """Return its discrete orbit up to time 4, or to 80 of its own steps."""
    start = {"configuration": ready(name).configuration, "body_velocity": ready(name).body_velocity}
    return nh.simulate(ready(name).discretize(80 * ready(name).time_step / steps), **start, steps=steps)


@functools.cache
def flow(name: str) -> CoordinateOrbit:
    """Return its flow at a few of the times of the runs."""
    start = {"configuration": ready(name).configuration, "body_velocity": ready(name).body_velocity}
    return nh.flow(
        ready(name).system, **start, times=80 * ready(name).time_step * np.linspace(0.0, 1.0, 9), rtol=1e-13, atol=1e-14
    )


@HERE
@pytest.mark.parametrize("name", COORDINATES)
def test_the_table_has_a_column_for_each_number(name: str, tmp_path) -> None:  # noqa: ANN001
    """Coordinates have their names, velocities and momenta too, in tables by time, CSV files and datasets."""
    orbit, names = run(name), ready(name).coordinates
    table = orbit.to_pandas()
    assert np.array_equal(table[list(names)].to_numpy(), orbit.configuration)
    assert np.array_equal(table[[f"momentum_{each}" for each in names]].to_numpy(), orbit.momentum)
    assert np.array_equal(table.index, orbit.time)
    assert np.isnan(table["multipliers_0"].iloc[-1])
    orbit.to_csv(tmp_path / "motion.csv")
    with (tmp_path / "motion.csv").open() as file:
        assert file.readline().strip().split(",") == ["t", *names]
    with pytest.raises(FileExistsError):
        orbit.to_csv(tmp_path / "motion.csv")
    last = orbit.to_dataset().configuration.sel(coordinate=names[-1])
    assert np.array_equal(last, orbit.configuration[:, -1])


@HERE
@pytest.mark.parametrize("name", NAMES)
def test_restricted_momenta_act_on_admissible_velocities_alone(name: str) -> None:
    """They agree with the momentum on every admissible velocity, and vanish across: they lie in their span."""
    orbit, system = run(name), ready(name).system
    forms = getattr(system, "plain", system).constraint_forms
    rounding = 1e-13 * max(1.0, np.abs(orbit.momentum).max() / 100)  # hundreds of a bicycle
    for k in (0, 17, 40):
        with double_precision():
            A = np.asarray(forms(orbit.configuration[k]))
        prescribed = [index for index, _ in getattr(system, "prescribed", ())]
        A = np.concatenate([A, np.eye(A.shape[1])[prescribed]])
        free = np.linalg.svd(A)[2][len(A) :]
        assert np.abs(free @ (orbit.restricted_momentum - orbit.momentum)[k]).max() <= rounding
        assert np.abs(A @ orbit.restricted_momentum[k]).max() <= rounding


def test_a_flow_has_a_picture_of_lines_and_may_be_drawn_over_a_run() -> None:
    """Alone it is a line in the colors of time; beside a run a second one in each panel."""
    alone = nh.plot.overview(flow("particle"))
    assert "continuous flow from time 0 to 4" in alone.texts[1].get_text()
    both = nh.plot.overview(run("particle"), flow=flow("particle"))
    assert "continuous" in [text.get_text() for text in both.axes[0].get_legend().get_texts()]
    with pytest.raises(ValueError, match=r"overview\(flow=...\)` must move in"):
        nh.plot.overview(
            run("particle"),
            flow=nh.flow(nh.ChaplyginSleigh(1.0, 1.0, 0.5), body_velocity=(1.0, 0.0, 0.0), times=(0.0, 1.0)),
        )
