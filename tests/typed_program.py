"""A program with a call of each kind, which `pyright` reads in its strict mode, with the types of results."""

from collections.abc import Mapping
from typing import Any, assert_type

import numpy as np

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateDiscretization, CoordinateOrbit, GroupDiscretization, GroupOrbit


def kinetic(q: Any, v: Any, p: Mapping[str, Any]) -> Any:
    """Return a Lagrangian."""
    del q
    return p["mass"] * (v @ v) / 2


top = nh.SuslovTop(np.diag([1.0, 2.0, 3.0]))
heavy = nh.Forced(top, potential=nh.Gravity(force=[0.0, 0.0, -9.81], point=[0.0, 0.0, 0.3]))
discrete = nh.discretize(top, 0.1)
assert_type(discrete, nh.Discretization)
assert_type(nh.discretize(heavy, 0.1), nh.Discretization)
assert_type(nh.simulate(discrete, body_velocity=(0.4, 0.9, 0.0), steps=10), nh.Orbit)
assert_type(nh.flow(top, body_velocity=(0.4, 0.9, 0.0), times=(0.0, 1.0)), nh.Orbit)
for block in nh.iterate(discrete, body_velocity=(0.4, 0.9, 0.0), steps=10):
    assert_type(block, nh.Orbit)
batch = nh.ensemble(discrete, restricted_velocity=[[0.1, 0.2]], steps=10)
compared = nh.compare(
    nh.simulate(discrete, momentum=(0.1, 0.2), steps=10), nh.flow(top, momentum=(0.1, 0.2), times=(0.0, 1.0))
)
equations, report = nh.vector_field(top), nh.testing.check_system(top)
assert_type(nh.flow(nh.VeselovaTop(np.eye(3)), momentum=(0.1, 0.2), times=(0.0, 1.0)), nh.Orbit)

particle = nh.LagrangeDAlembert(kinetic, None, dimension=2, parameters={"mass": 1.0})
assert_type(particle.with_parameters(mass=2.0), nh.LagrangeDAlembert)
assert_type(nh.discretize(particle, 0.1), CoordinateDiscretization)
assert_type(
    nh.simulate(nh.discretize(particle, 0.1), configuration=(0, 0), body_velocity=(1, 0), steps=3), CoordinateOrbit
)
assert_type(nh.flow(particle, configuration=(0, 0), body_velocity=(1, 0), times=(0, 1)), CoordinateOrbit)
body = nh.GroupLagrangeDAlembert(nh.SO(3), nh.mass_tensor_lagrangian(nh.SO(3), np.eye(3)), None)
assert_type(nh.discretize(body, 0.1), GroupDiscretization)
assert_type(nh.simulate(nh.discretize(body, 0.1), body_velocity=(1, 0, 0), steps=3), GroupOrbit)
states, members = nh.rollout(discrete, steps=3, momentum=(0.1, 0.2)), nh.ensemble(body, times=(0.0, 1.0))
assert_type(nh.examples.particle(mass=2.0), nh.examples.Example)

task = nh.EnsembleTask(discrete, steps=10, restricted_velocity=(0.1, 0.2))
swept = nh.sweep(task, nh.Grid({"time_step": [0.1, 0.2]}), "run.zarr")
drawn = nh.sweep(nh.FamilyTask(nh.examples.particle, 0.1, 10), nh.RandomDesign(3, {"mass": nh.Uniform(1, 2)}), "b.zarr")
nh.plot.overview(batch.orbit(0), title="A top", dark=True)
nh.save_orbit(batch.orbit(0), "a.zarr")
