"""A tractor with three trailers, turned at a constant rate: each axle ends on a circle of its own, a smaller one."""

from functools import cache

import numpy as np
from _card import Curve, card
from matplotlib.figure import Figure

import nonholo as nh
from nonholo.lagrange_dalembert import CoordinateOrbit

READY = nh.examples.trailers()


@cache
def run() -> CoordinateOrbit:
    """Return two turns."""
    return READY.simulate(steps=640)


def axles() -> list[np.ndarray]:
    """Return the places of the four axles as complex numbers."""
    place, *headings = run().configuration[:, 0] + 1j * run().configuration[:, 1], *run().configuration[:, 3:].T
    places = [place]
    for heading in headings:
        places.append(places[-1] - np.exp(1j * heading))
    return places


def numbers() -> dict[str, tuple[float, float, float]]:
    """Tangents of length one lead from circle to circle: r^2 loses 1 at each trailer; the rest of the start is 1e-3."""
    first, last = (np.abs(np.diff(place[-2:]))[0] / 0.02 for place in (axles()[0], axles()[-1]))  # turned by 0.4 h
    return {"lost square of the radius": (float(first**2 - last**2), 3.0, 2e-3)}


def draw() -> Figure:
    """Draw the tracks of the axles, and the angles between headings."""
    tracks = [Curve(each.real, each.imag, name) for each, name in zip(axles(), ("tractor", "1", "2", "3"), strict=True)]
    bends = np.diff(run().configuration[:, 2:], axis=1)
    names = ("tractor and 1", "1 and 2", "2 and 3")
    angles = [Curve(run().time, bend, name) for bend, name in zip(bends.T, names, strict=True)]
    return card("Trailers: axles", tracks, angles, axis=("time", "angle at the hitch"))
