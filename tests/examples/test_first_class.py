"""Crossings of every ready system are steps of the map, as those of tops and sleighs are."""

import dataclasses

import numpy as np
import pytest

import nonholo as nh
from nonholo.examples import Example

NAMES = sorted(set(nh.examples.__all__) - {"Example"})
DRIVEN = {"driven_sleigh", "roller_racer", "twistcar", "ball_on_turntable"}
BODIES = {"heavy_suslov_top", "sleigh_in_a_well"}  # on groups, under potentials
STEPS = 30


def _profile(name: str) -> list[pytest.MarkDecorator]:
    """Return where a system runs: the particle by default; what takes half a minute and more before a release."""
    profile = "long" if name in {"chaplygin_ball", "bicycle", "rattleback"} else "routes"
    guard = "test_a_ready_system_is_first_class"
    return [] if name == "particle" else [pytest.mark.profile(profile, instead=guard)]


@pytest.mark.parametrize("name", [pytest.param(name, marks=_profile(name), id=name) for name in NAMES])
def test_a_ready_system_is_first_class(name: str) -> None:
    """The level lies between states 17 and 18: the crossing is what a step of that part of the length reaches."""
    ready: Example = getattr(nh.examples, name)()
    discrete = ready.discretize(2 * ready.time_step)
    start = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    orbit = nh.simulate(discrete, **start, steps=STEPS)
    flat = orbit.configuration.reshape(len(orbit), -1)
    place = int(np.argmax(np.ptp(flat, axis=0)))
    level = (flat[17, place] + flat[18, place]) / 2
    event = nh.Event(lambda states: states.configuration.reshape(len(states), -1)[:, place] - level, name="level")
    found = nh.simulate(discrete, **start, steps=STEPS, events=[event]).events["level"]
    at = int(np.flatnonzero(found.step == 17)[0])
    assert np.abs(event.function(found.states)).max() <= 4 * np.spacing(np.abs(flat[:, place]).max())
    if name not in DRIVEN:  # whose runs begin at time 0
        part = dataclasses.replace(discrete, time_step=found.fraction[at] * float(discrete.time_step))
        momentum = (orbit.restricted_momentum if name in BODIES else orbit.momentum)[17]
        reached = nh.simulate(part, configuration=orbit.configuration[17], momentum=momentum, steps=1)
        # starts from a momentum solve the same equations; their roots are exact to 1e-10 squared
        assert np.abs(found.states.configuration[at] - reached.configuration[1]).max() <= 1e-13
