"""Pages as Python writes them: what is in them, how large they are, and what is refused."""

import base64
import hashlib
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refusals
from typer.testing import CliRunner

import nonholo as nh
from nonholo.analysis.bodies import plate
from nonholo.analysis.planar import blade_axes
from nonholo.cli._app import app
from nonholo.explorer._explore import simulate_state
from nonholo.lagrange_dalembert import CoordinateOrbit

TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
SLEIGH = nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.3)


def _data(text: str) -> dict[str, Any]:
    result = re.search(r'<script type="application/json" id="data">(.*?)</script>', text)
    assert result is not None
    return json.loads(result[1])


def _numbers(packed: dict[str, str], *names: str) -> list[np.ndarray]:
    """Return arrays of numbers that a page holds as texts; frames of four vectors in space."""
    arrays = {name: np.frombuffer(base64.b64decode(packed[name])) for name in names}
    return [x.reshape(-1, 4, 3) if name == "frames" else x for name, x in arrays.items()]


def _run(body: Any, velocity: tuple[float, ...], **options: Any) -> nh.Orbit:
    return nh.simulate(nh.discretize(body, 0.1), **{"restricted_velocity": velocity, "steps": 5, **options})


def test_data_of_a_page() -> None:
    """The state of a page is the first state of the orbit, in the canonical frame."""
    orbit = nh.simulate(nh.discretize(SLEIGH, 0.1), body_velocity=(0.3, -1.0, 0.0), steps=20, save_every=5)
    state = _data(nh.explore(orbit).text)["state"]
    assert state["parameters"] == {"mass": 1.0, "inertia": 1.0, "a": 0.5}
    assert state["momentum"] == orbit.reduced_momentum[0].tolist()
    assert state["pose"] == orbit.canonical_pose[0].tolist()
    assert (state["steps"], state["time_step"]) == (20, 0.1)


def test_data_of_a_top() -> None:
    """A top in other axes is shown in those of its canonical frame, and the page says so."""
    turned = nh.SuslovTop(TOP.mass_tensor, axis=(1.0, 0.0, 0.0))
    page = nh.explore(turned)
    p = _data(page.text)["state"]["parameters"]
    rows = [[p["J11"], p["J12"], p["J13"]], [p["J12"], p["J22"], p["J23"]], [p["J13"], p["J23"], p["J33"]]]
    np.testing.assert_array_equal(rows, turned.canonical.mass_tensor)
    assert "canonical body frame" in page.text
    assert "canonical body frame" not in nh.explore(TOP).text


def test_data_in_four_dimensions() -> None:
    """A top on SO(4) is shown in its principal axes; in these its page has the motion of Python to the last bit."""
    J = np.diag([1.0, 1.5, 2.0, 0.7])
    J[3, :3] = J[:3, 3] = 0.3, -0.2, 0.1
    start = {"momentum": (0.4, -0.5, 0.3), "configuration": nh.SO(4).exp(np.linspace(-0.5, 0.7, 6)), "steps": 60}
    for body in (nh.SuslovTop(J), nh.SuslovTop.arrowhead(np.diagonal(J), J[3, :3])):
        page, orbit = nh.explore(body), nh.simulate(nh.discretize(body, 0.1), **start)
        assert _data(page.text)["state"]["kind"] == "top4"
        assert _data(page.text)["kernels"].keys() == {"top4", "flow4"}
        assert "principal axes" not in page.text.partition("<script")[0]
        page = nh.explore(orbit)
        assert _data(page.text)["state"]["pose"] == orbit.canonical_pose[0].tolist()
        for name in ("reduced_momentum", "cayley"):
            np.testing.assert_array_equal(getattr(page.orbit(), name), getattr(orbit, name))
    turned = nh.simulate(nh.discretize(nh.SuslovTop(J + 0.2), 0.1), **start)
    page = nh.explore(turned)
    assert "principal axes" in page.text.partition("<script")[0]
    np.testing.assert_allclose(page.orbit().energy, turned.energy, rtol=1e-14)
    np.testing.assert_allclose(page.orbit().configuration[:, :, 3], turned.configuration[:, :, 3], atol=1e-13)


def test_data_under_forces() -> None:
    """A page of a body under a weight and friction has their numbers, and starts from the momentum at the node."""
    body = nh.ChaplyginSleigh(1.0, 1.0, 0.5)
    forced = nh.Forced(body, nh.Gravity([0.3, -0.2], [0.5, 0.1]), nh.Friction([0.2, 0.1, 0.4]))
    orbit = nh.simulate(nh.discretize(forced, 0.1), body_velocity=(0.3, -1.0, 0.0), steps=20)
    page = nh.explore(orbit)
    state = _data(page.text)["state"]
    about = {"F1": 0.3, "F2": -0.2, "x1": 0.5, "x2": 0.1, "c1": 0.2, "c2": 0.1}
    assert (state["kind"], state["parameters"]) == ("forced_sleigh", {"mass": 1.0, "inertia": 1.0, "a": 0.5, **about})
    assert state["momentum"] == orbit.reduced_momentum[0].tolist()
    np.testing.assert_array_equal(page.orbit().reduced_momentum, orbit.reduced_momentum)
    top = nh.explore(nh.Forced(TOP, nh.Gravity([0.0, 0.0, -2.0], [0.1, 0.0, 0.3])))
    assert "Suslov top, under forces" in top.text
    assert top.orbit().system.gravity.point.tolist() == [0.1, 0.0, 0.3]


def test_data_of_a_table() -> None:
    """A page brings the rows from its first state on, and computes with them; later states of a run have later rows."""
    rows = np.random.default_rng(2).normal(size=(40, 3))
    discrete = nh.discretize(nh.Forced(TOP, force=(nh.Friction([0.1, 0.2, 0.0]), rows)), 0.1)
    orbit = nh.simulate(discrete, body_velocity=(0.3, -1.0, 0.0), steps=30)
    for sent, first in ((orbit, 0), (orbit.chosen(np.arange(10, 31)), 10)):
        page = nh.explore(sent)
        data = _data(page.text)
        assert data["state"]["table"] == data["table"]["name"]
        assert data["state"]["parameters"]["s"] == 1.0
        (packed,) = _numbers(data["table"], "rows")
        np.testing.assert_array_equal(packed.reshape(-1, 3), rows[first:])
        np.testing.assert_allclose(page.orbit().reduced_momentum, orbit.reduced_momentum[first:], atol=1e-13)
    for change in ({"steps": 10**12}, {"steps": "x"}, {"parameters": {**data["state"]["parameters"], "s": "x"}}):
        with pytest.raises(ValueError, match="a state that the page can show"):
            simulate_state("Page.orbit()", {**data["state"], **change}, data["table"])
    longer = simulate_state("Page.orbit()", {**data["state"], "steps": 60}, data["table"])
    assert (np.diff(longer.energy[31:]) < 0).all()  # friction alone, after the last row
    assert np.diff(longer.energy[:31]).max() > 0
    assert (nh.explore(discrete).orbit().time[-1], nh.explore(TOP).table) == (4.0, None)


@pytest.mark.parametrize(
    ("body", "force"),
    [
        (SLEIGH, nh.Friction([1.0, 1.0, 1.0])),
        (nh.SuslovTop(TOP.mass_tensor, axis=(1.0, 0.0, 0.0)), nh.Friction([1.0, 1.0, 1.0])),
        (TOP, nh.Friction(np.eye(3))),
        (TOP, lambda *numbers: -numbers[2]),
    ],
    ids=["b", "axis", "matrix", "function"],
)
def test_forces_without_sliders(body: Any, force: Any) -> None:
    """Forces of other kinds, or in other axes than those of the page, are replayed."""
    orbit = nh.simulate(nh.discretize(nh.Forced(body, force=force), 0.1), restricted_velocity=(0.3, 0.2), steps=9)
    text = nh.explore(orbit).text
    assert _data(text)["kind"] == "replay"
    assert "A replay of numbers from Python" in text


def test_what_a_page_replays_where_its_kernel_may_not_run() -> None:
    """A live page carries some states of its motion, the first and the last among them, with the bits of Python."""
    orbit = nh.simulate(nh.discretize(TOP, 0.1), body_velocity=(0.3, -1.0, 0.0), steps=500)
    for live, steps in ((orbit, 500), (TOP, 400)):
        page = nh.explore(live)
        recorded = _data(page.text)["recorded"]
        time, frames = _numbers(recorded, "time", "frames")
        assert len(time) == len(frames) == 100
        states = np.rint(time / 0.1).astype(int)
        assert (states[0], states[-1], recorded["outcome"]) == (0, steps, 0)
        poses = page.orbit().configuration[states]
        np.testing.assert_array_equal(frames[:, 1:], poses.transpose(0, 2, 1))


def test_size_and_policy() -> None:
    """A page without data is small, in ASCII, fetches nothing, and names the only script and style that may run."""
    for body in (nh.SuslovTop.arrowhead(np.ones(4), np.ones(3) / 4), TOP):
        text = nh.explore(body).text
        assert len(text) - len(json.dumps(_data(text)["recorded"])) <= 700_000
    assert text.isascii()
    assert "three.js authors\n\nPermission is hereby granted" in text
    script, style = (re.findall(f"<{tag}>(.*?)</{tag}>", text, re.DOTALL) for tag in ("script", "style"))
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', text)
    for (own,) in (script, style):
        digest = base64.b64encode(hashlib.sha256(own.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy.replace("&#39;", "'")
    assert policy.startswith("default-src 'none'")
    assert "unsafe-inline" not in policy
    assert "'unsafe-eval'" not in policy
    assert not re.search(r'(?:src|href)="(?!data:,)', text.replace(script[0], ""))


@pytest.mark.parametrize(
    "orbit",
    [
        lambda: _run(nh.SuslovTop(np.eye(5)), (1, 0.5, 0, 0)),
        lambda: nh.flow(SLEIGH, body_velocity=(1.0, 0.5, 0.0), times=np.linspace(0, 1, 10)),
        lambda: nh.simulate(nh.discretize(TOP, 0.1, order=4), restricted_velocity=(1.0, 0.5), steps=9),
        lambda: _run(nh.VeselovaTop(np.diag([1.0, 2.0, 3.0])), (0.5, 0.2)),
        lambda: _run(nh.RigidBody(np.diag([1.0, 2.0, 3.0, 4.0])), (1.0, 0.2, 0.0, 0.5, 0.1, 0.3)),
        lambda: _run(nh.MultidimensionalSleigh(1.0, (0.3, 0.1, 0.0), np.diag([1.0, 2.0, 3.0])), (0.5, 0.2, 1.0)),
    ],
    ids=["SO(5)", "flow", "composition", "SO(3)", "SO(4)", "SE(3)"],
)
def test_replays(orbit: Any) -> None:
    """What has no kernel in the page comes with its numbers: times, energies, places, and axes of the poses."""
    motion = orbit()
    text = nh.explore(motion).text
    data = _data(text)
    assert (data["kind"], data["kernels"]) == ("replay", {})
    assert "A replay of numbers from Python" in text
    time, energy, frames = _numbers(data["replay"], "time", "energy", "frames")
    np.testing.assert_array_equal(time, motion.time)
    np.testing.assert_array_equal(energy, motion.energy)
    g, group = motion.configuration, motion.system.group
    if group == nh.SE(2):
        np.testing.assert_array_equal(frames[:, 1, :2], g[:, :2, 0])
        return
    turns = g[:, :3, :3] if group == nh.SE(3) else g
    np.testing.assert_array_equal(frames[:, 1:], turns[:, :3, [0, 1, -1]].transpose(0, 2, 1))
    np.testing.assert_array_equal(frames[:, 0], motion.position if group == nh.SE(3) else np.zeros((len(g), 3)))


def _in_coordinates(names: tuple[str, ...], heading: str | None = None) -> CoordinateOrbit:
    """Return an orbit of given numbers."""
    t, n = np.linspace(0.0, 1.0, 6), len(names)
    q = np.cos(t[:, None] + np.arange(n))
    system = nh.LagrangeDAlembert(lambda _, v: v @ v / 2, None, dimension=n, coordinates=names, heading=heading)
    return CoordinateOrbit(t, q, q, q, q, q[:, :0], t + 1, 0 * t, system=system, time_step=0.2)


def test_replays_in_coordinates(monkeypatch: pytest.MonkeyPatch) -> None:
    """Place, and axes along the heading; the momenta are those along the coordinates; energy less work under forces."""
    orbit = _in_coordinates(("a", "y", "x"), "a")
    monkeypatch.setattr(CoordinateOrbit, "restricted_momentum", orbit.momentum)
    data = _data(nh.explore(orbit).text)
    energy, frames, momentum = _numbers(data["replay"], "energy", "frames", "momentum")
    a = orbit.configuration[:, 0]
    np.testing.assert_array_equal(frames[:, 0], orbit.configuration[:, [2, 1]] @ np.eye(2, 3))
    np.testing.assert_array_equal(frames[:, 1], np.stack([np.cos(a), np.sin(a), 0 * a], axis=1))
    np.testing.assert_array_equal(momentum.reshape(-1, 2), orbit.momentum[:, :2])
    np.testing.assert_array_equal(energy, orbit.energy)
    assert data["momenta"] == ["p(a)", "p(y)"]
    monkeypatch.setattr(CoordinateOrbit, "work", orbit.time**2)
    text = nh.explore(orbit.chosen(slice(None))).text  # which remembers nothing
    (curve,) = _numbers(_data(text)["replay"], "energy")
    np.testing.assert_allclose(curve / curve[0] - 1, (orbit.time - orbit.time**2) / 2, atol=1e-15)
    assert "less the work of forces" in text


@pytest.mark.parametrize(
    ("orbit", "drawing"),
    [
        (lambda: nh.examples.snakeboard().simulate(steps=3), [4, 2, 2, 4, 4, 2, 4, 4]),
        (lambda: nh.examples.rolling_disk().simulate(steps=3), [4]),
        (lambda: nh.examples.ball_on_turntable().simulate(steps=3), "ball"),
        (lambda: nh.examples.chaplygin_ball().simulate(steps=3), "ball"),
        (lambda: nh.examples.sleigh_in_a_well().simulate(steps=3), [121, 121, 4]),
        (lambda: nh.examples.heavy_suslov_top().simulate(steps=3), "box"),
        (lambda: nh.simulate(nh.discretize(nh.SuslovTop(np.eye(5)), 0.1), body_velocity=np.zeros(10), steps=3), None),
    ],
    ids=["outline that moves", "outline", "point", "ball", "sleigh", "box", "axes"],
)
def test_drawings(orbit: Callable[[], Any], drawing: Any) -> None:
    """A replay has the corners of outlines, of sleighs in the axes of the blade, or a box, a ball, or nothing."""
    motion = orbit()
    replay = _data(nh.explore(motion).text)["replay"]
    drawn = replay["drawing"]
    if not isinstance(drawing, list):
        assert list(drawn) == ([] if drawing is None else [drawing])
        return
    assert drawn["sizes"] == drawing
    corners = np.frombuffer(base64.b64decode(drawn["corners"]), "<f4").reshape(drawn["rows"], -1, 2)
    (frames,), system = _numbers(replay, "frames"), motion.system
    if motion.coordinates:
        expected = [np.concatenate(system.parts(q)) for q in motion.configuration]
        np.testing.assert_array_equal(replay["names"], motion.coordinates)
        (places,) = _numbers(replay, "coordinates")
        np.testing.assert_array_equal(places, motion.configuration.ravel())
    else:
        expected = [np.concatenate(plate(system))] * 4
        np.testing.assert_array_equal(frames[:, 0, :2], (motion.configuration @ blade_axes(system.inside))[:, :2, 2])
    np.testing.assert_allclose(np.broadcast_to(corners, (4, *corners.shape[1:])), expected, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("names", [("x", "u"), ("q",)], ids=["two", "one"])
def test_replays_without_a_place(names: tuple[str, ...]) -> None:
    """Where x and y are no coordinates the first two are the place, and one beside its rate."""
    orbit = _in_coordinates(names)
    replay = _data(nh.explore(orbit).text)["replay"]
    (frames,) = _numbers(replay, "frames")
    np.testing.assert_array_equal(frames[:, 0, :2], np.hstack([orbit.configuration, orbit.body_velocity])[:, :2])
    assert replay["drawing"] == {"ball": True}


def test_long_orbits_are_thinned() -> None:
    """A replay of many states has some of them, the first and the last too, and says how many."""
    orbit = nh.simulate(nh.discretize(TOP, 0.1, order=4), restricted_velocity=(1.0, 0.5), steps=10_000)
    text = nh.explore(orbit).text
    (time,) = _numbers(_data(text)["replay"], "time")
    assert (len(time), time[0], time[-1]) == (4000, 0.0, orbit.time[-1])
    assert "4,000 of 10,001 saved states" in text


# What cannot be shown is refused with a remedy.
test_refusals = refusals(
    (lambda: 3.0, "explore"),
    (lambda: nh.discretize(nh.RigidBody(np.eye(3)), 0.1), "be a top with n = 3"),
    (lambda: nh.SuslovTop(np.eye(5)), "be a top with n = 3 or 4"),
    (lambda: nh.Forced(nh.SuslovTop(np.eye(4)), force=nh.Friction(np.ones(6))), "be a top with n = 3 or 4"),
    (lambda: _run(TOP, (1.0, 0.5), reconstruct=False), "have poses"),
    (lambda: nh.simulate(nh.discretize(TOP, 2.0), momentum=(3.0, 3.0), steps=2, throw=False), "have poses"),
    ask=lambda make: nh.explore(make()),
    kind=(TypeError, ValueError),
)


def test_writing(tmp_path: Path) -> None:
    """A page is a new file, unless it may replace one."""
    orbit, path = _run(TOP, (1.0, 0.5)), tmp_path / "page.html"
    orbit.to_html(path)
    assert path.read_text("ascii") == nh.explore(orbit).text
    with pytest.raises(FileExistsError, match="to_html"):
        orbit.to_html(path)
    orbit.to_html(path, overwrite=True)


def test_command(tmp_path: Path) -> None:
    """`nonholo explore` writes the page of a scenario and of a store, and never over a page unless told to."""
    page, store = tmp_path / "page.html", str(tmp_path / "run.zarr")
    nh.save_orbit(_run(TOP, (1.0, 0.5), steps=11), store)

    def explore(*arguments: str) -> Any:
        return CliRunner().invoke(app, ["explore", *arguments, "-o", str(page), "--no-browser"])

    for arguments, steps in ((("sleigh", "--steps", "7"), 7), ((store, "--overwrite"), 11)):
        run = explore(*arguments)
        assert (run.exit_code, run.stdout.strip()) == (0, str(page))
        assert _data(page.read_text())["state"]["steps"] == steps
    assert [explore(name).exit_code for name in ("sleigh", "no such thing")] == [2, 2]
