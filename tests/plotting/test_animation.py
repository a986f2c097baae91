"""Animations: frames, times, and which part of an orbit is shown."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from plotting.runs import sleigh_run, top_run

import nonholo as nh
from nonholo.plotting.animation._animation import _shown_states
from nonholo.plotting.animation._scenes import _box, _face, _way_out


@pytest.mark.parametrize("kind", ["top_orbit", "sleigh_orbit"])
def test_number_and_time_of_frames(kind: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """A GIF has as many frames as asked for, all different, at the rate asked for, and progress is reported."""
    told = []
    path = nh.plot.animate(
        request.getfixturevalue(kind), tmp_path / "a.gif", frames=7, fps=20, progress=lambda *done: told.append(done)
    )
    with Image.open(path) as movie:
        assert movie.n_frames == 7
        assert movie.info["duration"] == 50
    assert told == [(k, 7) for k in range(1, 8)]


def test_frames_move(sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """The first and the last frame differ in many pixels."""
    with Image.open(nh.plot.animate(sleigh_orbit, tmp_path / "a.gif", frames=3)) as movie:
        first = np.asarray(movie.convert("RGB"), dtype=int)
        movie.seek(2)
        change = np.abs(np.asarray(movie.convert("RGB"), dtype=int) - first).sum(axis=-1)
    assert np.mean(change > 60) > 0.01


@pytest.mark.parametrize(
    "orbit", [top_run((0.0, 0.0, 0.0), steps=3), sleigh_run((0.0, 0.0, 0.0), steps=3)[:1]], ids=["rest", "one state"]
)
def test_no_more_frames_than_states(orbit: nh.Orbit, tmp_path: Path) -> None:
    """A body at rest still makes as many frames as there are states."""
    with Image.open(nh.plot.animate(orbit, tmp_path / "a.gif", frames=50)) as movie:
        assert movie.n_frames == len(orbit)


def test_long_orbits_show_the_transition() -> None:
    """A stretch about the fastest change is shown in steps that the eye can follow; short orbits are shown whole."""
    orbit = top_run((0.465, 0.75, 0.0), steps=20000)
    fastest = int(np.abs(np.diff(orbit.reduced_momentum, axis=0)).sum(axis=1).argmax())
    shown = _shown_states(orbit, 0.3, 100)
    assert len(shown) == 100
    assert set(np.diff(shown)) == {3}
    assert shown[0] < fastest < shown[-1]
    assert _shown_states(orbit[:51], 0.3, 26).tolist() == list(range(0, 51, 2))


def test_box_has_the_mass_tensor_of_the_body() -> None:
    """The drawn box has the principal axes of the mass tensor and sides as the roots of its moments."""
    tensor = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    half, principal = _box(tensor)
    scaled = principal @ np.diag(half**2) @ principal.T
    assert np.allclose(scaled / scaled[0, 0], tensor / tensor[0, 0])
    corners = np.concatenate([_face(half, normal) for normal in (*np.eye(3), *-np.eye(3))])
    assert np.allclose(np.abs(corners), half)
    assert _way_out(half, np.array([0.0, 0.0, 2.0])) == pytest.approx(half[2] / 2)


def test_refusals(top_orbit: nh.Orbit, tmp_path: Path) -> None:
    """Another suffix, no frames, and missing poses are refused in words."""
    with pytest.raises(ValueError, match=r"`animate\(path=...\)` must end in .gif"):
        nh.plot.animate(top_orbit, tmp_path / "a.mp4")
    with pytest.raises(ValueError, match=r"`animate\(frames=...\)` must be a positive integer. Got 0"):
        nh.plot.animate(top_orbit, tmp_path / "a.gif", frames=0)
    with pytest.raises(ValueError, match="must have poses"):
        nh.plot.animate(top_run((0.4, 0.9, 0.0), steps=3, reconstruct=False), tmp_path / "a.gif")
