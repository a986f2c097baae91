"""Animations: frames, sizes, times, what is drawn of each kind of body, and which part of an orbit is shown."""

import json
import subprocess
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.animation import FFMpegWriter
from PIL import Image
from plot.runs import along, body_tensor, frames_of, run_of, sleigh_run, top_run

import nonholo as nh
from nonholo.analysis.bodies import box_in_space, box_in_sphere, plate
from nonholo.lagrange_dalembert import CoordinateOrbit, LagrangeDAlembert
from nonholo.plot.animation._scenes import part_of, part_of_flow, shown_states


@pytest.mark.profile("paper", keep=["sleigh_orbit"])
@pytest.mark.parametrize("kind", ["top_orbit", "sleigh_orbit"])
def test_number_and_time_of_frames(kind: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """A GIF has as many frames as asked for, all different, at the rate asked for, and progress is reported."""
    report = []
    path = nh.plot.animate(
        request.getfixturevalue(kind), tmp_path / "a.gif", frames=7, fps=20, progress=lambda *done: report.append(done)
    )
    with Image.open(path) as movie:
        assert movie.n_frames == 7
        assert movie.info["duration"] == 50
    assert report == [(k, 7) for k in range(1, 8)]


@pytest.mark.profile("paper", keep=["one state"])
@pytest.mark.parametrize(
    "orbit", [top_run((0.0, 0.0, 0.0), steps=3), sleigh_run((0.0, 0.0, 0.0), steps=3)[:1]], ids=["rest", "one state"]
)
def test_no_more_frames_than_states(orbit: nh.Orbit, tmp_path: Path) -> None:
    """A body at rest still makes as many frames as there are states."""
    assert len(frames_of(nh.plot.animate(orbit, tmp_path / "a.gif", frames=50))) == len(orbit)


def test_long_orbits_show_the_transition() -> None:
    """A stretch about the fastest change is shown in steps that the eye can follow; short orbits are shown whole."""
    orbit = top_run((0.465, 0.75, 0.0), steps=20000)
    fastest = int(np.abs(np.diff(orbit.reduced_momentum, axis=0)).sum(axis=1).argmax())
    states = shown_states(orbit, 0.3, 100)
    assert len(states) == 100
    assert set(np.diff(states)) == {3}
    assert states[0] < fastest < states[-1]
    assert shown_states(orbit[:51], 0.3, 26).tolist() == list(range(0, 51, 2))


def test_a_trail_ends_where_the_body_is(top_orbit: nh.Orbit) -> None:
    """The path of a frame ends at its state, also where the film begins late, and so does that of a flow."""
    orbit = part_of(top_orbit, np.array([3, 5, 9]))
    flow = nh.flow(top_orbit.system, momentum=top_orbit.restricted_momentum[0], times=top_orbit.time)
    for part in (orbit, part_of_flow(flow, orbit.frames.time)):
        np.testing.assert_array_equal(part.path.time[part.past - 1], top_orbit.time[[3, 5, 9]])


def test_box_of_a_top_has_its_mass_tensor(top_orbit: nh.Orbit) -> None:
    """The drawn box has the principal axes of the mass tensor and sides as the roots of its moments."""
    tensor, box = np.asarray(top_orbit.system.mass_tensor), box_in_sphere(top_orbit.system)
    scaled = box.axes @ np.diag(box.half**2) @ box.axes.T
    assert np.allclose(scaled / scaled[0, 0], tensor / tensor[0, 0])
    corners = box.corners(np.eye(3)).reshape(-1, 3) @ box.axes
    assert np.allclose(np.abs(corners), box.half)
    assert box.way_out(2 * box.axes[:, 2]) == pytest.approx(box.half[2] / 2)


def test_box_in_space_is_the_body() -> None:
    """A uniform box of the drawn sides, at the drawn center, has the inertia of the body on SE(3)."""
    mass, half, center = 2.5, np.array([0.3, 0.5, 0.8]), np.array([0.4, -0.2, 0.1])
    turn = nh.SO(3).exp(np.array([0.4, -0.7, 0.2]))
    inertia = turn @ np.diag(mass / 3 * (np.sum(half**2) - half**2)) @ turn.T
    body = nh.RigidBody.from_inertia(mass, inertia, center, nh.SE(3))
    box = box_in_space(body)
    assert np.allclose(np.sort(box.half), half)
    assert np.allclose(box.center, center)
    assert np.allclose(np.abs(box.axes.T @ turn), np.eye(3), atol=1e-7)


def test_ellipse_in_the_plane_is_the_body() -> None:
    """A uniform ellipse of the drawn half axes, at the drawn center, has the inertia of the sleigh."""
    body, center, blade = plate(nh.ChaplyginSleigh(mass=2.0, inertia=0.7, a=0.5, b=0.3))
    p, q = np.ptp(body, axis=0) / 2
    assert 2.0 * (p**2 + q**2) / 4 == pytest.approx(0.7, rel=1e-3)  # the polygon is within the ellipse
    assert np.allclose([part[:-1].mean(axis=0) for part in (body, center)], [0.5, 0.3])
    assert np.allclose(blade.mean(axis=0), 0.0)


def _coordinates(z: bool) -> CoordinateOrbit:
    """Return given poses: a curve in the plane with a heading, or a helix."""
    t = np.linspace(0.0, 1.0, 41)
    q = np.stack([np.cos(t), np.sin(t), t], axis=1)
    names = ("x", "y", "z") if z else ("x", "y", "a")
    heading = {} if z else {"heading": "a", "outline": [[(-0.1, -0.1), (0.2, 0.0), (-0.1, 0.1)]]}
    return along(LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=3, coordinates=names, **heading), q)


BODIES = {
    "SO(3)": lambda: run_of(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0]))),
    "SE(2)": lambda: run_of(nh.LRSystem(nh.SE(2), body_tensor(2), [[1.0, 0, 0], [0, 1.0, 0]])),
    "SE(3)": lambda: run_of(nh.MultidimensionalSleigh(1.0, [0.5, 0.2, 0.1], body_tensor(3)[:3, :3])),
    "forced": lambda: run_of(nh.Forced(nh.ChaplyginSleigh(1.0, 1.0, 0.5), force=nh.Friction([0.1, 0.2, 0.0]))),
    "outline": lambda: _coordinates(z=False),
    "point in space": lambda: _coordinates(z=True),
}


@pytest.mark.profile("paper", keep=["SO(3)", "outline", "forced"])
@pytest.mark.parametrize("name", BODIES)
def test_every_kind_of_body_moves(name: str, tmp_path: Path) -> None:
    """Frames of any body have the size asked for and differ, and the motion beside it is drawn in its own color."""
    orbit = BODIES[name]()
    path = nh.plot.animate(
        orbit, tmp_path / "a.gif", frames=2, size=(3.2, 2.4), flow=orbit.chosen(slice(None, None, 2)), dark=True
    )
    frames = frames_of(path)
    assert frames[0].shape == (240, 320, 3)
    assert np.mean(np.abs(frames[0] - frames[1]).max(axis=-1) > 60) > 0.003
    assert np.sum(np.abs(frames[1] - np.array([0xE6, 0x9F, 0x00])).max(axis=-1) < 40) > 20


def test_a_flow_is_beside_at_equal_times(sleigh_orbit: nh.Orbit) -> None:
    """The states of a flow are those at the times of the frames; of one that knows its states alone, the nearest."""
    times = sleigh_orbit.time[[0, 50, 200]]
    flow = nh.flow(sleigh_orbit.system, body_velocity=(0.1, -1.0, 0.0), times=(0.0, 25.0))
    part = part_of_flow(flow, times)
    assert np.allclose(part.frames.time, times, atol=1e-12)
    assert np.allclose(part.path.time[part.past - 1], times, atol=1e-12)
    assert np.array_equal(part_of_flow(sleigh_orbit, times).frames.time, times)


def test_a_film_that_fails_leaves_nothing(sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """An older film stays as it was, and no part of the new one is left."""
    path = tmp_path / "a.gif"
    path.write_text("mine")

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt(done, total)

    with pytest.raises(KeyboardInterrupt):
        nh.plot.animate(sleigh_orbit, path, frames=3, progress=stop, overwrite=True)
    assert [file.read_text() for file in tmp_path.iterdir()] == ["mine"]


@pytest.mark.parametrize("suffix", ["mp4", "webm"])
def test_ffmpeg_is_asked_for_before_any_work(suffix: str, sleigh_orbit: nh.Orbit, tmp_path: Path) -> None:
    """Where there is no ffmpeg, its films are refused with the remedy."""
    refused = r"must end in .gif without the program ffmpeg. Got 'new.*'. Install it \(on Debian the package"
    with mpl.rc_context({"animation.ffmpeg_path": str(tmp_path / "none")}), pytest.raises(ValueError, match=refused):
        nh.plot.animate(sleigh_orbit, f"new.{suffix}")


@pytest.mark.profile("browser", instead="test_number_and_time_of_frames")
@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="ffmpeg, which writes these films, is not installed")
@pytest.mark.parametrize(("suffix", "codec"), [("mp4", "h264"), ("webm", "vp9")])
@pytest.mark.parametrize("kind", ["top_orbit", "sleigh_orbit"])
def test_films_of_ffmpeg(kind: str, suffix: str, codec: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    """A film has the frames, the rate and the size asked for, in pixels, and its frames differ."""
    orbit, path, done = request.getfixturevalue(kind), tmp_path / f"a.{suffix}", []
    nh.plot.animate(orbit, path, frames=9, fps=20, size=(6.4, 3.6), progress=lambda *count: done.append(count))
    entries = "stream=codec_name,width,height,r_frame_rate,nb_read_frames,pix_fmt"
    command = ["ffprobe", "-v", "error", "-count_frames", "-show_entries", entries, "-of", "json", str(path)]
    (stream,) = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["streams"]  # noqa: S603
    assert stream == {
        "codec_name": codec, "width": 640, "height": 360, "pix_fmt": "yuv420p", "r_frame_rate": "20/1",
        "nb_read_frames": "9",
    }  # fmt: skip
    raw = ["ffmpeg", "-v", "error", "-i", str(path), "-f", "rawvideo", "-pix_fmt", "gray", "-"]
    pixels = np.frombuffer(subprocess.run(raw, check=True, capture_output=True).stdout, np.uint8)  # noqa: S603
    frames = pixels.reshape(9, 360, 640).astype(int)
    assert np.all(np.mean(np.abs(np.diff(frames, axis=0)) > 40, axis=(1, 2)) > 0.002)
    assert done == [(k, 9) for k in range(1, 10)]
