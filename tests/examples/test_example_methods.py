"""An example runs itself: its methods are the functions of the library, from its own start."""

from pathlib import Path

import numpy as np

import nonholo as nh


def test_methods_are_the_functions_of_the_library(tmp_path: Path) -> None:
    """Map, flow, picture and discretization of a system in coordinates and of one on a group."""
    for ready in (nh.examples.particle(), nh.examples.sleigh_in_a_well()):
        start = {"body_velocity": ready.body_velocity, "configuration": ready.configuration}
        discrete = ready.discretize(0.1)
        assert (discrete.system, float(discrete.time_step)) == (ready.system, 0.1)
        mine = ready.simulate(steps=10, time_step=0.1, save_every=2)
        theirs = nh.simulate(discrete, **start, steps=10, save_every=2)
        assert np.array_equal(mine.configuration, theirs.configuration)
        times = (0.0, 0.5)
        flow = nh.flow(ready.system, **start, times=times)
        assert np.array_equal(ready.flow(times=times).configuration, flow.configuration)
        ready.plot(str(tmp_path / f"{ready.name}.png"))
        assert (tmp_path / f"{ready.name}.png").stat().st_size > 10_000


def test_another_start_replaces_that_of_the_example() -> None:
    """Options of `simulate` pass, a start among them."""
    ready = nh.examples.sleigh_in_a_well()
    orbit = ready.simulate(steps=3, body_velocity=(0.5, 0.2, 0.0))
    assert np.allclose(orbit.body_velocity[0], (0.5, 0.2, 0.0))
