"""Wheels and blades of the ready examples as pictures draw them, against how the examples move."""

import functools
from collections.abc import Callable

import numpy as np
import pytest

import nonholo as nh
from nonholo.analysis.bodies import plate
from nonholo.analysis.planar import blade_axes
from nonholo.base.types import Array
from nonholo.examples import Example

ROLLING = {
    "bicycle": [3, 4],
    "driven_sleigh": [1],
    "kinematic_car": [2, 3, 4, 5],
    "knife_edge_on_incline": [0],
    "roller_racer": [2, 3, 6, 7],
    "rolling_disk": [0],
    "sleigh_in_a_well": [-1],
    "snake": [2, 3, 6, 7, 10, 11],
    "snakeboard": [3, 4, 6, 7],
    "tilting_disk": [1],
    "trailers": [2, 3, 7, 8, 12, 13, 17, 18],
    "twistcar": [2, 3, 6, 7],
    "two_wheeled_robot": [1, 2],
}
"""Which parts of the outline of an example are on the ground: blades, and wheels that roll along their first edge."""


@functools.cache
def ready(name: str) -> Example:
    """Return an example with its default parameters."""
    return getattr(nh.examples, name)()


def parts_in_space(name: str, x: float, y: float, heading: float, parts: list[Array]) -> list[tuple[Array, Array]]:
    """Return middle and axle, a unit vector, of each part of a body at a pose that is on the ground."""
    turn, found = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]]), []
    for part in (parts[k] @ turn for k in ROLLING[name]):
        ahead = (part[1] - part[0]) / np.linalg.norm(part[1] - part[0])
        found.append((part.mean(axis=0) + np.array([x, y]), np.array([-ahead[1], ahead[0]])))
    return found


def in_coordinates(name: str, q: Array, v: Array) -> Callable[[float], list[tuple[Array, Array]]]:
    """Return the parts at configurations along a velocity."""
    system = ready(name).system
    places = [system.coordinates.index(each) for each in ("x", "y", system.heading)]

    def at(s: float) -> list[tuple[Array, Array]]:
        return parts_in_space(name, *(q + s * v)[places], system.parts(q + s * v))

    return at


def on_group(name: str, g: Array, v: Array) -> Callable[[float], list[tuple[Array, Array]]]:
    """Return the parts at poses along a body velocity."""
    system = ready(name).system.system
    parts, axes = plate(system), blade_axes(system.inside)

    def at(s: float) -> list[tuple[Array, Array]]:
        pose = g @ system.group.exp(s * v) @ axes
        return parts_in_space(name, *pose[:2, 2], np.arctan2(pose[1, 0], pose[0, 0]), parts)

    return at


def test_every_outline_is_tested() -> None:
    """The table above names every example that pictures draw as a body on the ground."""
    drawn = {name for name in set(nh.examples.__all__) - {"Example"} if _is_drawn(ready(name).system)}
    assert drawn - {"rattleback"} == set(ROLLING)  # which has no wheel


def _is_drawn(system: object) -> bool:
    body = getattr(system, "system", None)
    return bool(getattr(system, "outline", ())) or (body is not None and body.group == nh.SE(2))


@pytest.mark.profile("routes", keep=["snakeboard", "rolling_disk", "s*well"])
@pytest.mark.parametrize("name", sorted(ROLLING))
def test_a_wheel_that_is_drawn_does_not_slip(name: str) -> None:
    """Along a run the middle of a drawn wheel or blade moves along it: across by the error of differences of 1e-5."""
    example, at = ready(name), on_group if name == "sleigh_in_a_well" else in_coordinates
    body = example.system.system if at is on_group else example.system  # without the spring, which compiles for long
    start = {"configuration": example.configuration, "body_velocity": example.body_velocity}
    orbit = nh.simulate(nh.discretize(body, 0.05), **start, steps=40)
    rows = orbit.configuration if at is on_group else orbit.configuration + orbit.displacement / 2
    fastest = 0.0
    for q, v in zip(rows[:-1:5], orbit.body_velocity[:-1:5], strict=True):
        parts = at(name, q, v)
        for (before, _), (_, axle), (after, _) in zip(parts(-1e-5), parts(0.0), parts(1e-5), strict=True):
            moved = (after - before) / 2e-5
            fastest = max(fastest, float(np.abs(moved).max()))
            assert abs(moved @ axle) < 1e-8 * (1 + np.linalg.norm(v))
    assert fastest > 0.05  # it moves at all
