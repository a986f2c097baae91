"""The live page of a top on SO(4) in Chromium."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nonholo as nh

pytestmark = pytest.mark.profile("browser", instead="test_data_in_four_dimensions")
PARAMETERS = {"J11": 1.4, "J22": 1.0, "J33": 0.7, "J44": 0.9, "J14": 0.5, "J24": -0.3, "J34": 0.2}
START = {"momentum": (1.2, -0.5, 0.6), "configuration": nh.SO(4).exp(np.linspace(-0.4, 0.6, 6))}


def _body(p: dict[str, float]) -> Any:
    return nh.SuslovTop.arrowhead([p[f"J{i}{i}"] for i in "1234"], [p[f"J{i}4"] for i in "123"])


ORBIT = nh.simulate(nh.discretize(_body(PARAMETERS), 0.1), **START, steps=300)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a top that began in some pose."""
    path = tmp_path_factory.mktemp("page") / "top4.html"
    ORBIT.to_html(path)
    return path


def _same(page: Any, orbit: nh.Orbit) -> None:
    """The page has the momenta, charts and poses of an orbit, to the last bit."""
    np.testing.assert_array_equal(page.numbers("g"), orbit.canonical_pose.ravel())
    _same_momenta(page, orbit)


def _same_momenta(page: Any, orbit: nh.Orbit) -> None:
    """Only its poses may differ by rounding: Python makes a rotation of the matrix from which it starts."""
    for name, rows in (("r", orbit.reduced_momentum), ("y", orbit.cayley)):
        np.testing.assert_array_equal(page.numbers(name), rows.ravel())
    np.testing.assert_allclose(page.numbers("g"), orbit.canonical_pose.ravel(), atol=1e-14)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)], ids=["desk", "phone"])
def test_opens_quietly(visit: Callable, file: Path, size: tuple[int, int], scheme: str) -> None:
    """No error, no request but the file, nothing wider than the screen, and no control of what it has not."""
    page = visit(file, viewport={"width": size[0], "height": size[1]}, color_scheme=scheme)
    page.settle()
    assert page.errors == []
    assert page.requests == [file.as_uri()]
    assert page.page.evaluate("document.documentElement.scrollWidth") <= size[0]
    assert not any(page.page.is_visible(f"#{name}") for name in ("values", "whole", "many", "copy-toml", "forces"))
    assert "300 steps computed here" in page.status


def test_same_numbers(visit: Callable, file: Path) -> None:
    """The motion as it was sent, and ten thousand steps of others, are those of Python to the last bit."""
    page, rng = visit(file), np.random.default_rng(5)
    _same(page, ORBIT)
    for _ in range(5):
        p = {key: round(float(x + rng.uniform(-0.2, 0.2)), 3) for key, x in PARAMETERS.items()}
        momentum, step = rng.normal(size=3).round(3).tolist(), round(float(rng.uniform(0.01, 0.2)), 4)
        numbers = "&".join(f"{key}={x!r}" for key, x in {**p, "h": step, "steps": 2_000}.items())
        link = f"kind=top4&{numbers}&r={'+'.join(map(repr, momentum))}"
        page.page.evaluate("(link) => { location.hash = link; }", link)
        page.until(f"nonholo.state.time_step === {step!r}")
        page.settle()
        _same(page, nh.simulate(nh.discretize(_body(p), step), momentum=momentum, steps=2_000))


def test_sliders(visit: Callable, file: Path) -> None:
    """Each slider changes its number, and the motion is then that of Python."""
    page, before = visit(file), None
    moved = {"J11": 1.7, "J22": 0.6, "J33": 1.1, "J44": 0.75, "J14": -0.15, "J24": 0.31, "J34": 0.12}
    for key, value in {**moved, "r1": 0.4, "r2": 0.9, "r3": -0.35, "time_step": 0.17, "steps": 120}.items():
        page.set(key, value)
        text = page.page.evaluate("JSON.stringify(nonholo.state)")
        assert text != before
        before, state = text, json.loads(text)
        discrete, start = nh.discretize(_body(state["parameters"]), state["time_step"]), {"momentum": state["momentum"]}
        _same_momenta(page, nh.simulate(discrete, **START | start, steps=state["steps"]))
    assert state["parameters"] == moved
    assert (state["momentum"], state["time_step"], state["steps"]) == ([0.4, 0.9, -0.35], 0.17, 120)
    assert page.errors == []


def test_continuous_motion(visit: Callable, file: Path) -> None:
    """The momenta of the continuous motion are those of `flow` to the last bit, for slow, fast and resting motions."""
    page = visit(file)
    for moved in ({}, {"r1": 2.5, "J11": 0.1, "time_step": 0.7, "steps": 900}, {"r1": 0.0, "r2": 0.0, "r3": 0.0}):
        for key, value in moved.items():
            page.set(key, value)
        state = page.page.evaluate("nonholo.state")
        body, times = _body(state["parameters"]), np.arange(state["steps"] + 1) * state["time_step"]
        motion = nh.flow(body, momentum=state["momentum"], times=times, reconstruct=False)
        np.testing.assert_array_equal(page.page.evaluate("nonholo.flow.rows"), motion.reduced_momentum)
    assert page.errors == []


def test_ready_motions(visit: Callable, file: Path) -> None:
    """Every ready motion is of a top on SO(4), and runs from the identity or says that it has no real branch."""
    page = visit(file)
    names = page.page.eval_on_selector_all("#preset option", "all => all.map((o) => [o.value, o.textContent])")
    assert len(names) > 4
    for value, label in names:
        page.page.select_option("#preset", value)
        page.settle()
        assert ("no real branch" in page.status) == (label == "No real branch"), label
        assert page.page.evaluate("nonholo.state.kind") == "top4"
    page.page.select_option("#preset", "own")
    page.settle()
    _same(page, ORBIT)
    assert page.errors == []


def test_start_by_hand(visit: Callable, file: Path) -> None:
    """Pressing on the phase portrait, or arrow keys there, change the first two momenta."""
    page = visit(file)
    box = page.page.locator("#phase-canvas").bounding_box()
    page.page.mouse.click(box["x"] + 0.6 * box["width"], box["y"] + 0.4 * box["height"])
    page.settle()
    r = page.page.evaluate("nonholo.state.momentum")
    assert r[0] > 0.1
    assert r[1] > 0.1
    assert r[2] == 0.6
    page.page.focus("#phase-canvas")
    page.page.keyboard.press("ArrowUp")
    page.settle()
    after = page.page.evaluate("nonholo.state.momentum")
    assert after[1] > r[1]
    assert (after[0], after[2]) == (r[0], 0.6)


def test_link_and_program(visit: Callable, file: Path) -> None:
    """A link opens the motion it was made of, with its pose, and the copied program gives its numbers."""
    page = visit(file)
    page.set("J34", 0.25)
    page.set("r3", 1.1)
    page.page.click("#share summary")
    page.page.click("#copy-link")
    link = page.page.input_value("#dialog-text")
    page.page.click("#dialog-close")
    again = visit(file, "#" + link.partition("#")[2])
    assert again.page.evaluate("JSON.stringify(nonholo.state)") == page.page.evaluate("JSON.stringify(nonholo.state)")
    page.page.click("#share summary")
    page.page.click("#copy-python")
    names: dict[str, Any] = {}
    exec(page.page.input_value("#dialog-text"), names)  # noqa: S102
    _same_momenta(page, names["orbit"])
    page.page.click("#dialog-close")
    page.page.select_option("#preset", "0")
    page.settle()
    page.page.click("#share summary")
    page.page.click("#copy-python")
    exec(page.page.input_value("#dialog-text"), names)  # noqa: S102
    _same(page, names["orbit"])


@pytest.mark.parametrize(
    "fragment",
    [
        "#kind=sleigh&mass=1&inertia=1&a=1&h=.1&steps=5&r=1+1",
        "#kind=top4&J11=1&J22=1&J33=1&J44=1&J14=0&J24=0&J34=0&h=.1&steps=5&r=1+1",
        "#kind=top4&J11=1&J22=1&J33=1&J44=1&J14=0&J24=0&J34=0&h=.1&steps=5&r=1+1+1&g=2",
        "#kind=top4&J11=1&J22=1&J33=1&J44=1&J14=0&J24=0&J34=0&h=.1&steps=5&r=1+1+1&g=-1",
    ],
    ids=["another body", "two momenta", "no turn", "a mirror"],
)
def test_bad_links(visit: Callable, file: Path, fragment: str) -> None:
    """What a link holds is read as data: the motion in the file stays, and the page says what is wrong."""
    page = visit(file, fragment)
    assert "This link could not be read" in page.status
    _same(page, ORBIT)
    assert page.errors == []
