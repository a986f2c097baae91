"""Every ready system has what tops and sleighs have: its crossings are steps of the map, members are runs alone."""

import dataclasses

import numpy as np
import pytest

import nonholo as nh
from nonholo.examples import Example

NAMES = sorted(set(nh.examples.__all__) - {"Example"})
DRIVEN = {"driven_sleigh": 0, "roller_racer": 0, "twistcar": 0, "ball_on_turntable": 2}
"""Their velocities are not to be scaled: some are prescribed. They are moved along a coordinate without influence."""
BODIES = {"heavy_suslov_top", "sleigh_in_a_well"}  # on groups, under potentials
STEPS, MEMBERS = 30, 1000
ROWS = ("time", "configuration", "displacement", "body_velocity", "momentum", "energy")


def _profile(name: str) -> list[pytest.MarkDecorator]:
    """Return where a system runs: the particle by default; what takes half a minute and more before a release."""
    profile = "long" if name in {"chaplygin_ball", "bicycle", "rattleback"} else "routes"
    guard = "test_a_ready_system_is_first_class"
    return [] if name == "particle" else [pytest.mark.profile(profile, instead=guard)]


@pytest.mark.parametrize("name", [pytest.param(name, marks=_profile(name), id=name) for name in NAMES])
def test_a_ready_system_is_first_class(name: str) -> None:
    """Its crossings are steps of the map, and members are runs alone; tests/matrix has pictures, tables and sweeps."""
    ready: Example = getattr(nh.examples, name)()
    discrete = ready.discretize(2 * ready.time_step)
    start = {"configuration": ready.configuration, "body_velocity": ready.body_velocity}
    _crosses_by_steps_of_the_map(nh.simulate(discrete, **start, steps=STEPS), discrete, start, name)
    _members_are_runs_alone(name, discrete, start)


def _crosses_by_steps_of_the_map(orbit, discrete, start, name: str) -> None:  # noqa: ANN001
    """The level lies between states 17 and 18: the crossing is what a step of that part of the length reaches."""
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


def _members_are_runs_alone(name: str, discrete, start: dict) -> None:  # noqa: ANN001
    along = np.linspace(0.5, 1.5, MEMBERS)
    if name in DRIVEN:
        rows = start | {"configuration": start["configuration"] + along[:, None] * np.eye(4)[DRIVEN[name]]}
    else:
        rows = start | {"body_velocity": along[:, None] * start["body_velocity"]}
    if name in BODIES:  # whose members start at the identity
        del rows["configuration"]
    batch = nh.ensemble(discrete, **rows, steps=4, save_every=2)
    assert batch.outcome.tolist() == [0] * MEMBERS
    assert batch.configuration.shape[:2] == batch.time.shape == (MEMBERS, 3)
    for member in (0, 500, MEMBERS - 1):
        own = {key: value[member] if len(value) == MEMBERS else value for key, value in rows.items()}
        alone = nh.simulate(discrete, **own, steps=4, save_every=2)
        for row in ROWS:
            if name not in BODIES:
                assert np.array_equal(getattr(batch, row)[member], getattr(alone, row)), row
        # bodies: starts of many are converted by other products of matrices (docs/conventions.md, "Bits")
        assert np.abs(batch.configuration[member] - alone.configuration).max() <= 1e-14
