"""A plain call is short: how many files of the library a warm call enters, and how often it changes the room."""

import itertools
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import jax.numpy as jnp

import nonholo as nh
from nonholo.lagrange_dalembert import LagrangeDAlembert

_FILES, _CHANGES, _IN_COORDINATES, _SHARED = 16, 28, 17, 10
"""The first three may only fall."""
_LIBRARY = Path(nh.__file__).parent


def _entered(call: Callable[[], Any]) -> list[Path]:
    """Return the files of the library that a warm call enters, in order."""
    call()
    entered: list[Path] = []

    def look(frame: FrameType, event: str, _: Any) -> None:
        file = Path(frame.f_code.co_filename)
        if event == "call" and file.is_relative_to(_LIBRARY):
            entered.append(file.relative_to(_LIBRARY))

    before = sys.getprofile()
    sys.setprofile(look)
    try:
        call()
    finally:
        sys.setprofile(before)
    return entered


def _of_a_sleigh() -> list[Path]:
    discrete = nh.discretize(nh.ChaplyginSleigh(1.0, 1.0, 0.5), 0.1)
    return _entered(lambda: nh.simulate(discrete, restricted_velocity=(0.3, 0.4), steps=10))


def _forms(q: Any) -> Any:
    return jnp.array([[-jnp.sin(q[2]), jnp.cos(q[2]), 0.0]])


def test_a_call_for_a_body_is_short() -> None:
    """A room is the first folder of the library; every return to one counts."""
    entered = _of_a_sleigh()
    changes = sum(a.parts[0] != b.parts[0] for a, b in itertools.pairwise(entered))
    assert len(set(entered)) <= _FILES
    assert changes <= _CHANGES


def test_a_call_in_coordinates_shares_its_files() -> None:
    """The same run in coordinates is the same call, with other equations."""
    discrete = nh.discretize(LagrangeDAlembert(lambda _, v: v @ v / 2, _forms, dimension=3), 0.1)
    velocity: dict[str, Any] = {"configuration": (0.0, 0.0, 0.0), "body_velocity": (1.0, 0.0, 0.3)}
    entered = set(_entered(lambda: nh.simulate(discrete, steps=10, **velocity)))
    assert len(entered) <= _IN_COORDINATES
    assert len(entered & set(_of_a_sleigh())) >= _SHARED
