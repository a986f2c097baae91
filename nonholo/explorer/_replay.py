"""Motions that a page replays from numbers: poses, what is drawn at each, momenta, energies."""

import base64
from typing import Any

import numpy as np

from nonholo.analysis.bodies import Box, blade_axes, box_in_space, box_in_sphere, plate
from nonholo.base.types import Float, Int
from nonholo.groups import SE, SO
from nonholo.orbit import AbstractOrbit, Orbit

_BALL = {"ball": True}


def spread(orbit: AbstractOrbit, most: int) -> Int[np.ndarray, "L"]:
    """Return at most this many states, evenly over an orbit."""
    return np.unique(np.linspace(0, len(orbit) - 1, min(len(orbit), most)).round().astype(np.int64))


def replay(orbit: AbstractOrbit, states: Int[np.ndarray, "L"]) -> tuple[dict[str, Any], str]:
    """Return what a page replays of some states, and a note on their energy."""
    part = orbit.chosen(states) if len(states) < len(orbit) else orbit
    energy, forces = _energy(orbit)
    momenta = np.pad(part.restricted_momentum, ((0, 0), (0, 2)))[:, :2]
    arrays = {"time": part.time, "energy": energy[states], "frames": _frames(part), "momentum": momenta}
    if orbit.coordinates:
        arrays["coordinates"] = part.configuration
    numbers = {name: _base64(each, "<f8") for name, each in arrays.items()}
    return {**numbers, "names": orbit.coordinates, "drawing": _drawing(part), "outcome": int(orbit.outcome)}, forces


def _base64(numbers: Any, kind: str) -> str:
    return base64.b64encode(np.asarray(numbers).astype(kind).tobytes()).decode()


def _energy(orbit: AbstractOrbit) -> tuple[Float[np.ndarray, "K"], str]:
    """Return the energy, under forces less their work and from its largest value on, and a note on that."""
    work = np.nan_to_num(orbit.known_work)
    if not work.any():
        return orbit.energy, ""
    left = orbit.energy - orbit.energy[0] - work
    return np.abs(orbit.energy).max() + left, " The energy is shown less the work of forces, from its largest value on."


def _drawing(orbit: AbstractOrbit) -> dict[str, Any]:
    """Return what is drawn at each pose: the corners of flat parts in body axes, a box, a ball; nothing but axes else.

    Corners that are the same in all states are there once.
    """
    if orbit.coordinates:
        return _outlines([orbit.system.parts(q) for q in orbit.configuration] if orbit.system.heading else [()])
    if not isinstance(orbit, Orbit):
        return _BALL if orbit.space.is_affine else {}
    if orbit.space == SE(2):
        return _outlines([plate(orbit.system)])
    boxes: dict[Any, Any] = {SO(3): box_in_sphere, SE(3): box_in_space}
    body = boxes[orbit.space](orbit.system) if orbit.space in boxes else None
    return {} if body is None or not np.isfinite(body.half).all() else {"box": _lists(body)}


def _lists(body: Box) -> dict[str, Any]:
    return {name: each.tolist() for name, each in body._asdict().items()}


def _outlines(bodies: list[Any]) -> dict[str, Any]:
    sizes = [len(part) for part in bodies[0]]
    if not sizes or any([len(part) for part in parts] != sizes for parts in bodies):
        return _BALL
    rows = np.array([np.concatenate(parts) for parts in bodies])
    rows = rows[:1] if (rows == rows[0]).all() else rows
    return {"sizes": sizes, "rows": len(rows), "corners": _base64(rows, "<f4")}


def _frames(orbit: AbstractOrbit) -> Float[np.ndarray, "K 12"]:
    """Return for each state an origin and three axes in space, of which those that are not known are zero.

    In coordinates: the place, or the first two of them, one with its rate; axes along the heading. On a group: of the
    pose, of a sleigh of its blade, the first two axes and the last, in three coordinates.
    """
    frames = np.zeros((len(orbit), 4, 3))
    (_set_coordinates if orbit.coordinates else _set_poses)(frames, orbit)
    return frames.reshape(len(orbit), 12)


def _set_poses(frames: Float[np.ndarray, "K 4 3"], orbit: AbstractOrbit) -> None:
    g, group = orbit.configuration, orbit.space
    if group == SE(2) and isinstance(orbit, Orbit) and (blade := blade_axes(orbit.system)) is not None:
        g = g @ blade
    turns = g[:, :-1, :-1] if group.is_affine else g
    n = turns.shape[1]
    axes = turns.transpose(0, 2, 1)[:, [0, 1, n - 1] if n > 2 else list(range(n)), :3]
    frames[:, 1 : 1 + axes.shape[1], : axes.shape[2]] = axes
    if group.is_affine:
        places = g[:, :-1, -1][:, :3]
        frames[:, 0, : places.shape[1]] = places
    if n == 2:
        frames[:, 3, 2] = 1.0


def _set_coordinates(frames: Float[np.ndarray, "K 4 3"], orbit: AbstractOrbit) -> None:
    names, q = orbit.coordinates, orbit.configuration
    places = [name for name in "xyz" if name in names]
    if places[:2] == ["x", "y"]:
        frames[:, 0, : len(places)] = q[:, [names.index(name) for name in places]]
    else:
        frames[:, 0, :2] = np.hstack([q, orbit.body_velocity])[:, :2]
    if orbit.system.heading is not None:
        heading = q[:, names.index(orbit.system.heading)]
        frames[:, 1, 0] = frames[:, 2, 1] = np.cos(heading)
        frames[:, 1, 1], frames[:, 2, 0] = np.sin(heading), -np.sin(heading)
        frames[:, 3, 2] = 1.0
