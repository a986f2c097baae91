"""The live page in Chromium: what it computes, shows, shares and refuses."""

import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import nonholo as nh
from nonholo import kernels

pytestmark = pytest.mark.profile("browser", instead="test_data_of_a_page")
TENSOR = [[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]]
BODIES = {"top": nh.SuslovTop(TENSOR), "sleigh": nh.ChaplyginSleigh(1.0, 1.0, 0.5)}
VELOCITY = {"top": (0.465, 0.75, 0.0), "sleigh": (0.05, -1.0, 0.0)}
FORCES = {"top": (nh.Gravity([0.2, 0.1, -0.7], [0.1, -0.2, 0.4]), nh.Friction([0.1, 0.3, 0.2]))}
FORCES["sleigh"] = (nh.Gravity([0.3, -0.2], [0.5, 0.1]), nh.Friction([0.2, 0.1, 0.4]))
FORCED = {f"forced_{name}": nh.Forced(BODIES[name], *FORCES[name]) for name in BODIES}
TABLE = np.random.default_rng(1).normal(size=(350, 3)).round(3) / 4
DRIVEN = {f"driven_{name}": nh.Forced(BODIES[name], w, (f, TABLE)) for name, (w, f) in FORCES.items()}
SENT = BODIES | FORCED | DRIVEN
FOUR = {"J11": 1.4, "J22": 1.0, "J33": 0.7, "J44": 0.9, "J14": 0.5, "J24": -0.3, "J34": 0.2}
START = {"momentum": (1.2, -0.5, 0.6), "configuration": nh.SO(4).exp(np.linspace(-0.4, 0.6, 6))}


def _top4(p: dict[str, float]) -> Any:
    return nh.SuslovTop.arrowhead([p[f"J{i}{i}"] for i in "1234"], [p[f"J{i}4"] for i in "123"])


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Pages of a top and a sleigh, free, under forces and a table; on SO(4); replayed: on SO(5), a snakeboard."""
    folder = tmp_path_factory.mktemp("pages")
    result = {name: folder / f"{name}.html" for name in (*SENT, "replay", "outline", "top4")}
    for name in (*SENT, "top4"):
        _sent(name).to_html(result[name])
    wide = nh.discretize(nh.SuslovTop(np.diag([1.0, 2.0, 3.0, 4.0, 5.0]) + 0.3), 0.1)
    nh.simulate(wide, restricted_velocity=(1.0, 0.5, 0.2, 0.1), steps=100).to_html(result["replay"])
    nh.examples.snakeboard().simulate(steps=50).to_html(result["outline"])
    return result


def _sent(name: str) -> nh.Orbit:
    """Return the motion of a file."""
    start = START if name == "top4" else {"body_velocity": VELOCITY[name.rpartition("_")[2]]}
    return nh.simulate(nh.discretize(SENT.get(name) or _top4(FOUR), 0.1), **start, steps=300)


def _same(page: Any, orbit: nh.Orbit, rounding: float = 0.0, poses: float = 0.0) -> None:
    """The page has the momenta, charts and poses of an orbit, to the last bit or to some rounding."""
    for name, rows in (("r", orbit.reduced_momentum), ("y", orbit.cayley)):
        np.testing.assert_allclose(page.numbers(name), rows.ravel(), rtol=0, atol=rounding)
    np.testing.assert_allclose(page.numbers("g"), orbit.canonical_pose.ravel(), rtol=0, atol=rounding + poses)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)], ids=["desk", "phone"])
@pytest.mark.parametrize("name", [*SENT, "replay", "outline", "top4"])
def test_opens_quietly(visit: Callable, files: dict, name: str, size: tuple[int, int], scheme: str) -> None:
    """No error, no request but the file, nothing wider than the screen, and pictures that are not empty."""
    look = {"viewport": {"width": size[0], "height": size[1]}, "color_scheme": scheme}
    page = visit(files[name], **look)
    page.settle()
    assert page.errors == []
    assert page.requests == [files[name].as_uri()]
    assert page.page.evaluate("document.documentElement.scrollWidth") <= size[0]
    dark = page.page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(20, 23, 28)"
    assert dark == (scheme == "dark")
    drawn = """(id) => {
        const canvas = document.getElementById(id), pen = canvas.getContext("2d");
        const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
        return new Set(new Uint32Array(data.buffer)).size;
    }"""
    canvases = ("phase-canvas", "energy-canvas")
    assert all(page.page.evaluate(drawn, name) > 20 for name in canvases)
    corner = "(id) => [...document.getElementById(id).getContext('2d').getImageData(1, 1, 1, 1).data].slice(0, 3)"
    card = page.page.evaluate("getComputedStyle(document.getElementById('phase')).backgroundColor")
    assert [f"rgb({', '.join(map(str, page.page.evaluate(corner, name)))})" for name in canvases] == [card] * 2


def test_requests_are_counted(visit: Callable, files: dict) -> None:
    """The counter of requests counts, and the policy of the page refuses what is asked for."""
    page = visit(files["top"])
    assert page.page.evaluate("fetch('https://example.org/').then(() => false, () => true)")
    assert any("Content Security Policy" in text for text in page.errors)
    page.page.route("**/*", lambda route: route.fulfill(body=""))
    page.page.goto("https://example.org/")
    assert len(page.requests) == 2


@pytest.mark.parametrize("name", [*BODIES, *FORCED, "top4"])
def test_same_numbers(visit: Callable, files: dict, name: str) -> None:
    """The motion as it was sent, and a hundred thousand steps of other bodies, are those of Python to the last bit."""
    page, rng = visit(files[name]), np.random.default_rng(5)
    _same(page, _sent(name))
    first = page.page.evaluate("nonholo.state")
    for _ in range(5):
        p = {key: round(x * rng.uniform(0.8, 1.2), 3) for key, x in first["parameters"].items()}
        momentum = rng.normal(size=len(first["momentum"])).round(3).tolist()
        step = round(float(rng.uniform(0.01, 0.2)), 4)
        numbers = "&".join(f"{key}={x!r}" for key, x in {**p, "h": step, "steps": 20_000}.items())
        link = f"kind={name}&{numbers}&r={'+'.join(map(repr, momentum))}"
        page.page.evaluate("(link) => { location.hash = link; }", link)
        page.until(f"nonholo.state.time_step === {step!r}")
        page.settle()
        _same(page, nh.simulate(nh.discretize(_made(name, p), step), momentum=momentum, steps=20_000))


SLIDERS = {
    "top": {"J11": 1.7, "J22": 1.3, "J33": 0.75, "J12": -0.15, "J13": 0.31, "J23": 0.12, "r1": 0.4, "r2": 0.9},
    "sleigh": {"mass": 1.35, "inertia": 0.8, "a": -0.3, "r1": 0.45, "r2": -0.6},
}
PUSHES = {"F1": 0.4, "F2": -0.8, "x1": -0.35, "x2": 0.15, "c1": 0.25, "c2": 0.65}
SLIDERS["forced_top"] = {**SLIDERS["top"], **PUSHES, "F3": -1.3, "x3": 0.55}
SLIDERS["forced_sleigh"] = {**SLIDERS["sleigh"], **PUSHES}
SLIDERS["top4"] = {"J11": 1.7, "J22": 0.6, "J33": 1.1, "J44": 0.75, "J14": -0.15, "J24": 0.31, "J34": 0.12}
SLIDERS["top4"] |= {"r1": 0.4, "r2": 0.9, "r3": -0.35}
RUN = {"time_step": 0.17, "steps": 120}


@pytest.mark.parametrize("name", [*BODIES, *FORCED, "top4"])
def test_sliders(visit: Callable, files: dict, name: str) -> None:
    """Each slider changes its number, and the motion is then that of Python, which makes a rotation of any matrix."""
    page, before, is_wide = visit(files[name]), None, name == "top4"
    for key, value in {**RUN, **SLIDERS[name]}.items():
        page.set(key, value)
        state = page.page.evaluate("JSON.stringify(nonholo.state)")
        assert state != before
        before, state = state, json.loads(state)
        p = state["parameters"]
        start = {**(START if is_wide else {}), "momentum": state["momentum"]}
        motion = nh.simulate(nh.discretize(_made(name, p), state["time_step"]), **start, steps=state["steps"])
        _same(page, motion, poses=1e-14 * is_wide)
    momentum = {f"r{number}": r for number, r in enumerate(state["momentum"], 1)}
    assert {**p, **RUN, **momentum} == {**SLIDERS[name], **RUN}
    assert page.errors == []


def _top(p: dict[str, float]) -> nh.SuslovTop:
    rows = [("J11", "J12", "J13"), ("J12", "J22", "J23"), ("J13", "J23", "J33")]
    return nh.SuslovTop([[p[name] for name in row] for row in rows])


BODY_OF = {"top": _top, "top4": _top4, "sleigh": lambda p: nh.ChaplyginSleigh(p["mass"], p["inertia"], p["a"])}


def _made(name: str, p: dict[str, float]) -> Any:
    """Return the body of the sliders of a page."""
    body = BODY_OF[name.rpartition("_")[2]](p)
    return _pushed(body, p) if name in FORCED else body


def _pushed(body: Any, p: dict[str, float]) -> nh.Forced:
    """Return a body under the forces of the sliders; one that is zero does not act."""
    F, x = ([p[name + i] for i in "123" if name + i in p] for name in "Fx")
    rub = nh.Friction([p["c1"], p["c2"], 0.0]) if p["c1"] or p["c2"] else None
    return nh.Forced(body, nh.Gravity(F, x) if any(F) else None, rub)


@pytest.mark.parametrize("name", list(FORCED))
def test_forces_at_zero(visit: Callable, files: dict, name: str) -> None:
    """Without a weight, without friction and without both the motion is that of Python; friction is not negative."""
    page = visit(files[name])
    for part in ("Fxx", "c", "Fc"):
        page.page.select_option("#preset", "own")
        page.settle()
        for key in [each for each in page.page.evaluate("nonholo.state.parameters") if each[0] in part]:
            page.set(key, 0.0)
        state = page.page.evaluate("nonholo.state")
        assert state["steps"] == 300
        body = _pushed(BODIES[name.removeprefix("forced_")], state["parameters"])
        orbit = nh.simulate(nh.discretize(body, 0.1), momentum=state["momentum"], steps=300)
        _same(page, orbit, 1e-12 if part == "Fc" else 0.0)  # the page solves the cubic, whose weight is zero
    page.page.fill("#number-c1", "-1")
    page.page.press("#number-c1", "Enter")
    page.settle()
    assert "Friction must not be negative" in page.status


@pytest.mark.parametrize("name", [*FORCED, *DRIVEN])
def test_balance_of_energy(visit: Callable, files: dict, name: str) -> None:
    """The page has energy, kinetic energy and work of Python, and says that they agree, not that energy is kept."""
    page, orbit = visit(files[name]), _sent(name)
    kinetic = BODIES[name.rpartition("_")[2]].constrained_energy(orbit.reduced_momentum)
    for key, values in (("energy", orbit.energy), ("work", orbit.work), ("kinetic", kinetic)):
        np.testing.assert_allclose(page.numbers(key), values, rtol=1e-12, atol=1e-12)
    assert "energy and work agree" in page.status
    assert page.page.text_content("#energy-title") == "Energy"
    assert not page.page.is_visible("#values")


def test_points_of_a_pushed_orbit(visit: Callable, files: dict) -> None:
    """An orbit under forces runs on the surface of momenta of displacements."""
    for name in FORCED:
        page, orbit = visit(files[name]), _sent(name)
        P = nh.discrete_legendre(nh.discretize(BODIES[name.removeprefix("forced_")], 0.1), orbit.displacement[7])
        assert np.abs(P[:2] - orbit.momentum[7, :2]).max() > 1e-4
        point = page.page.evaluate("nonholo.point(7)")
        if name == "forced_top":
            np.testing.assert_allclose(point, 0.1 * P, atol=1e-14)
        else:
            np.testing.assert_allclose(point[0], 0.5 * 0.1 * P[1] + 2 * 0.5**2, atol=1e-14)


TITLES = {"top": "Suslov top", "top4": "Arrowhead top, SO(4)"}


@pytest.mark.parametrize("name", TITLES)
def test_presets(visit: Callable, files: dict, name: str) -> None:
    """Every ready motion runs, or says that it has no real branch; a page in four dimensions has its own."""
    page = visit(files[name])
    names = page.page.eval_on_selector_all("#preset option", "all => all.map((o) => [o.value, o.textContent])")
    assert len(names) > 4
    for value, label in names:
        page.page.select_option("#preset", value)
        page.settle()
        assert ("no real branch" in page.status) == ("no real branch" in label.lower()), label
        forced = page.page.evaluate("nonholo.state.kind").startswith("forced")
        title = "Chaplygin sleigh" if "Sleigh" in label else TITLES[name]
        assert page.page.text_content("#title") == f"{title}{', under forces' * forced}"
    page.page.select_option("#preset", "own")
    page.settle()
    _same(page, _sent(name))
    assert page.errors == []


@pytest.mark.parametrize("name", list(BODIES))
@pytest.mark.parametrize("host", ["without WebAssembly", "with a policy"])
def test_where_the_kernel_may_not_run(visit: Callable, files: dict, tmp_path: Path, host: str, name: str) -> None:
    """The motion of the page is replayed, the page says why, and has no sliders that would do nothing."""
    path, is_policy = tmp_path / "page.html", host == "with a policy"
    text = files[name].read_text()
    path.write_text(text.replace(" 'wasm-unsafe-eval'", "") if is_policy else text)
    opened = visit(path, before="" if is_policy else "delete window.WebAssembly")
    assert "100 states replayed: WebAssembly is not allowed here" in opened.status
    assert opened.page.evaluate("nonholo.orbit.count") == 100
    assert not opened.page.is_visible("#parameters")
    assert opened.page.is_visible("#body-canvas")
    assert len(opened.requests) == 1
    assert all("Content Security Policy" in said for said in opened.errors)


def test_outlines_are_drawn(visit: Callable, files: dict) -> None:
    """A snakeboard is a blue board with black wheels on a floor, and its coordinates are read beside it."""
    page = visit(files["outline"])
    page.settle()
    picture = np.asarray(Image.open(io.BytesIO(page.page.locator("#body-canvas").screenshot())).convert("RGB"), int)
    red, blue, most = picture[..., 0], picture[..., 2], picture.max(axis=-1)
    assert min(np.sum(blue - red > 60), np.sum(most < 60)) > 100
    assert {"theta", "psi", "energy"} <= set(page.page.locator("#now dt").all_inner_texts())


def test_no_real_branch(visit: Callable, files: dict) -> None:
    """Where the map has no real value the page says so in words, and runs again when there is one."""
    page = visit(files["top"])
    page.set("time_step", 2.0)
    assert "cannot start: no real branch" in page.status
    assert page.page.is_visible("#stop")
    page.set("time_step", 0.1)
    assert page.page.is_hidden("#stop")
    assert "computed here" in page.status


def test_impossible_body(visit: Callable, files: dict) -> None:
    """A body that cannot be is refused in words."""
    page = visit(files["top"])
    page.page.fill("#number-J12", "5")
    page.page.keyboard.press("Enter")
    page.settle()
    assert "positive definite" in page.status


def test_drag_to_start(visit: Callable, files: dict) -> None:
    """Pressing on the phase portrait starts the motion there."""
    page = visit(files["sleigh"])
    before = page.page.evaluate("nonholo.state.momentum")
    box = page.page.locator("#phase-canvas").bounding_box()
    page.page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 0.5 * box["height"])
    page.settle()
    r1, r2 = page.page.evaluate("nonholo.state.momentum")
    assert [r1, r2] != before
    assert r1 > 0.2
    assert abs(r2) < 0.1 * r1


LINKED = [("sleigh", "a"), ("forced_top", "c2"), ("forced_sleigh", "F1"), ("top4", "J34")]


@pytest.mark.parametrize(("name", "key"), LINKED)
def test_link(visit: Callable, files: dict, name: str, key: str) -> None:
    """A link opens the motion it was made of, in any page of as many dimensions."""
    page = visit(files[name])
    page.set(key, 0.25)
    page.set("r1", 1.1)
    page.page.click("#share summary")
    page.page.click("#copy-link")
    link = page.page.input_value("#dialog-text")
    again = visit(files["top4" if name == "top4" else "sleigh"], "#" + link.partition("#")[2])
    assert again.page.evaluate("JSON.stringify(nonholo.state)") == page.page.evaluate("JSON.stringify(nonholo.state)")


_SLEIGH, _PUSHED = "kind=sleigh&mass=1&inertia=1&a=", "kind=forced_sleigh&mass=1&inertia=1&a=1&"
_FOUR = "kind=top4&J11=1&J22=1&J33=1&J44=1&J14=0&J24=0&J34=0&h=.1&steps=5&r=1+1"


@pytest.mark.parametrize(
    ("name", "fragment"),
    [
        ("sleigh", "kind=top&J11=1"),
        ("sleigh", "kind=%3Cscript%3E"),
        ("sleigh", "kind=__proto__"),
        ("sleigh", f"{_SLEIGH}alert(1)&h=.1&steps=5&r=1+1"),
        ("sleigh", f"{_SLEIGH}1&h=.1&steps=1e9&r=1+1"),
        ("sleigh", f"{_SLEIGH}1&h=NaN&steps=5&r=1+1"),
        ("sleigh", f"{_PUSHED}h=.1&steps=5&r=1+1"),
        ("sleigh", f"{_PUSHED}F1=1e7&F2=0&x1=0&x2=0&c1=0&c2=0&h=.1&steps=5&r=1+1"),
        ("sleigh", f"{_PUSHED}F1=alert(1)&F2=0&x1=0&x2=0&c1=0&c2=0&h=.1&steps=5&r=1+1"),
        ("top4", f"{_SLEIGH}1&h=.1&steps=5&r=1+1"),  # another body
        ("top4", _FOUR),  # two momenta
        ("top4", f"{_FOUR}+1&g=2"),  # no turn
        ("top4", f"{_FOUR}+1&g=-1"),  # a mirror
    ],
)
def test_bad_links(visit: Callable, files: dict, name: str, fragment: str) -> None:
    """What a link holds is read as data: the motion in the file stays, and the page says what is wrong."""
    page = visit(files[name], f"#{fragment}")
    assert "This link could not be read" in page.status
    _same(page, _sent(name))
    assert page.errors == []


@pytest.mark.parametrize("name", [*BODIES, *FORCED])
def test_ten_thousand(visit: Callable, files: dict, name: str) -> None:
    """Members of the crowd move by the same kernel: forwards, and after the time was set back."""
    page = visit(files[name])
    page.page.click("#play")
    page.page.click("#many")
    body = nh.discretize((BODIES | FORCED)[name], 0.1).route.body
    for step in (60, 17):
        page.page.fill("#scrub", str(step))
        for k in (0, 137, 9999):
            member = page.page.evaluate(f"nonholo.crowd.member({k})")
            code, state = kernels.runs_of(body).start(body, np.array(member["first"]), np.array([1.0, 0.0, 0.0, 0.0]))
            assert code == 0
            rows = np.empty((1, 2)), np.empty((1, 2)), np.empty((1, 4))
            kernels.runs_of(body).advance(body, state, step, step, rows)
            assert (member["now"], member["outcome"], member["step"]) == (rows[0][0].tolist(), 0, step)
    assert page.errors == []


@pytest.mark.parametrize("name", list(BODIES))
def test_all_values(visit: Callable, files: dict, name: str) -> None:
    """All values over a momentum, real and complex, are those of Python, and the count of real ones in the page too."""
    page = visit(files[name])
    page.page.click("#play")
    page.page.fill("#scrub", "0")
    page.page.click("#values")
    rng = np.random.default_rng(3)
    for momentum in rng.uniform(-3, 3, (12, 2)).round(2):
        page.set("time_step", 1.0)
        page.set("r1", float(momentum[0]))
        page.set("r2", float(momentum[1]))
        state, body = page.page.evaluate("nonholo.state"), BODIES[name]
        reference = nh.displacements_over(nh.discretize(body, 1.0), state["momentum"])
        y = np.array(page.page.evaluate("nonholo.values")) @ [1, 1j]
        expected = _chart_of(body, reference.displacement)
        assert len(y) == len(expected)
        for value in y:
            assert np.abs(expected - value).sum(axis=1).min() <= 1e-8 * (1 + np.abs(value).sum())
        real = np.count_nonzero(reference.is_real)
        assert page.page.evaluate("nonholo.count(nonholo.state.momentum)") == real
        assert f"{real} of {len(y)}" in page.page.inner_text("#now")
    assert page.errors == []


def _chart_of(body: Any, W: np.ndarray) -> np.ndarray:
    """Return the two Cayley coordinates of displacements, real or complex."""
    if body is BODIES["sleigh"]:
        t = (W[:, 1, 0] / (1 + W[:, 0, 0]))[:, None]
        x = W[:, 0, 2] + t[:, 0] * W[:, 1, 2]  # half the slide, over the cosine of half the angle
        return np.concatenate([t, x[:, None] / 2], axis=1)
    scale = 1 + np.trace(W, axis1=1, axis2=2)[:, None]
    return np.stack([W[:, 0, 2] - W[:, 2, 0], W[:, 1, 2] - W[:, 2, 1]], axis=1) / scale


def test_save_and_open(visit: Callable, files: dict, tmp_path: Path) -> None:
    """The saved page is a page: it opens with the motion that was saved, and as quietly."""
    page = visit(files["top"])
    page.set("J13", 0.2)
    page.page.click("#share summary")
    with page.page.expect_download() as saved:
        page.page.click("#save")
    saved.value.save_as(tmp_path / "saved.html")
    again = visit(tmp_path / "saved.html")
    assert again.errors == []
    assert again.page.evaluate("nonholo.state.parameters.J13") == 0.2
    assert again.numbers("r") == page.numbers("r")


@pytest.mark.parametrize("name", [*BODIES, "top4"])
def test_copied_programs(visit: Callable, files: dict, name: str, tmp_path: Path) -> None:
    """Copied Python and a copied scenario give the numbers of the page, from its pose and from the identity."""
    page = visit(files[name])
    page.set("r2", 0.35)
    _copies_repeat(page, tmp_path)
    page.page.select_option("#preset", "0")
    page.settle()
    _copies_repeat(page, tmp_path)


@pytest.mark.parametrize("key", ["F1", "c1"])
@pytest.mark.parametrize("name", list(FORCED))
def test_copied_forces(visit: Callable, files: dict, name: str, key: str, tmp_path: Path) -> None:
    """What is copied of a body under forces gives the numbers of the page, by a weight alone or friction alone."""
    page = visit(files[name])
    for other in [each for each in page.page.evaluate("nonholo.state.parameters") if each[0] in "Fc"]:
        page.set(other, 0.3 if other == key else 0.0)
    _copies_repeat(page, tmp_path)


@pytest.mark.parametrize("steps", [200, 300, 360])
@pytest.mark.parametrize("name", list(DRIVEN))
def test_table_of_forces(visit: Callable, files: dict, name: str, steps: int, tmp_path: Path) -> None:
    """A page scales the table that it brings along; before its end and after it the motion is that of Python."""
    page, body = visit(files[name]), name.rpartition("_")[2]
    _same(page, _sent(name))
    page.set("steps", steps)
    for scale in (-1.3, 0.7, 0.0):
        page.set("s", scale)
        state = page.page.evaluate("nonholo.state")
        assert bool(state.get("table")) == (scale != 0)
        rows = scale * np.pad(TABLE, ((0, 50), (0, 0)))
        forced = nh.Forced(BODIES[body], FORCES[body][0], (FORCES[body][1], rows))
        orbit = nh.simulate(nh.discretize(forced, 0.1), momentum=state["momentum"], steps=steps)
        _same(page, orbit)
        _copies_repeat(page, tmp_path)
    assert page.errors == []


def test_links_of_a_table(visit: Callable, files: dict) -> None:
    """A link to a motion under a table opens in pages with that table, and is refused in words by others."""
    page = visit(files["driven_top"])
    page.set("s", 0.4)
    page.page.click("#share summary")
    page.page.click("#copy-link")
    fragment = "#" + page.page.input_value("#dialog-text").partition("#")[2]
    again = visit(files["driven_top"], fragment)
    assert again.numbers("r") == page.numbers("r")
    assert "which this page does not have" in visit(files["forced_top"], fragment).status
    again.page.select_option("#preset", label="Top under its weight")
    again.settle()
    assert again.page.evaluate("[nonholo.state.table ?? null, nonholo.state.parameters.s]") == [None, 0]
    again.page.select_option("#preset", "own")
    again.settle()
    _same(again, _sent("driven_top"))


def _copies_repeat(page: Any, folder: Path) -> None:
    """Copied Python and a copied scenario, which no page in four dimensions has, give the numbers of the page."""
    from nonholo.cli.scenario.files import load_scenario

    is_wide, text = page.page.evaluate("nonholo.state.kind") == "top4", {}
    for kind in ("python", "toml")[: 1 if is_wide else 2]:
        page.page.click("#share summary")
        page.page.click(f"#copy-{kind}")
        text[kind] = page.page.input_value("#dialog-text")
        page.page.click("#dialog-close")
    names: dict[str, Any] = {}
    exec(text["python"], names)  # noqa: S102
    _same(page, names["orbit"], poses=1e-14 * is_wide)
    if not is_wide:
        (folder / "copied.toml").write_text(text["toml"])
        scenario = load_scenario(str(folder / "copied.toml"), []).scenario
        _same(page, nh.simulate(scenario.discretization(), **scenario.options()))


@pytest.mark.parametrize("view", ["body", "phase", "surface", "energy"])
def test_pictures(visit: Callable, files: dict, view: str) -> None:
    """Each view gives its picture as a PNG file."""
    page = visit(files["top"])
    with page.page.expect_download() as saved:
        page.page.click(f"#{view} .picture")
    assert Path(saved.value.path()).read_bytes().startswith(b"\x89PNG")


def test_film(visit: Callable, files: dict) -> None:
    """A film of the body is a WebM file of the motion from its start to its end."""
    page = visit(files["sleigh"])
    page.page.select_option("#speed", "4")
    with page.page.expect_download(timeout=60_000) as saved:
        page.page.click("#film")
    assert Path(saved.value.path()).read_bytes().startswith(b"\x1a\x45\xdf\xa3")
    assert page.page.text_content("#film") == "Film"
    assert page.errors == []


def test_time(visit: Callable, files: dict) -> None:
    """Play moves, pause holds, the space bar does both, and the scrub bar goes to a state."""
    page = visit(files["top"])
    page.until("Number(document.getElementById('scrub').value) > 3")
    page.page.keyboard.press("Space")
    page.settle()
    value = page.page.input_value("#scrub")
    page.page.wait_for_timeout(150)
    assert page.page.input_value("#scrub") == value
    page.page.focus("#scrub")
    page.page.keyboard.press("Home")
    page.page.keyboard.press("ArrowRight")
    assert page.page.text_content("#step") == "step 1"


def test_names_for_everybody(visit: Callable, files: dict) -> None:
    """Every control that can be reached has a name."""
    page = visit(files["top"])
    nameless = page.page.evaluate(
        """() => [...document.querySelectorAll("button, input, select, summary, textarea, canvas")].filter((e) =>
            !(e.getAttribute("aria-label") || e.textContent.trim() || e.labels?.length)).map((e) => e.outerHTML)"""
    )
    assert nameless == []


def test_explanations(visit: Callable, files: dict) -> None:
    """Each view says what it shows, with a formula that the browser sets."""
    page = visit(files["sleigh"])
    for view in ("body", "phase", "surface", "energy"):
        page.page.click(f"#{view} .about")
        assert page.page.locator(f"#{view}-words math").bounding_box()["width"] > 60
        page.page.click(f"#{view} .about")


def test_what_a_title_cannot_do(visit: Callable, tmp_path: Path) -> None:
    """Text that comes with a motion is text."""
    from nonholo.explorer._explore import page_text, shown_motion

    evil = "</script><script>document.title = 'run'</script><img src=x onerror=\"document.title='run'\">"
    data, _, _ = shown_motion("test", BODIES["sleigh"])
    (tmp_path / "evil.html").write_text(page_text(data, evil, evil, evil))
    page = visit(tmp_path / "evil.html")
    page.settle()
    assert page.page.title() != "run"
    assert page.page.text_content("#title") == evil
    assert len(page.requests) == 1


def test_in_a_notebook(visit: Callable, tmp_path: Path) -> None:
    """The frame that a notebook shows runs, though it may not touch the notebook."""
    text = nh.explore(BODIES["top"])._repr_html_()
    (tmp_path / "notebook.html").write_text(f"<!doctype html><p id=status>notebook</p>{text}")
    page = visit(tmp_path / "notebook.html")
    frame = page.page.frame_locator("iframe").locator("#status")
    frame.filter(has_text="computed here").wait_for(timeout=10_000)
    page.page.frame_locator("iframe").locator("#slide-J13").press("ArrowRight")
    page.page.wait_for_timeout(500)
    assert page.errors == []


def test_continuous_motion_in_four_dimensions(visit: Callable, files: dict) -> None:
    """The momenta of the continuous motion are those of `flow` to the last bit, for slow, fast and resting motions."""
    page = visit(files["top4"])
    assert not any(page.page.is_visible(f"#{name}") for name in ("values", "whole", "many", "copy-toml", "forces"))
    assert "300 steps computed here" in page.status
    for moved in ({}, {"r1": 2.5, "J11": 0.1, "time_step": 0.7, "steps": 900}, {"r1": 0.0, "r2": 0.0, "r3": 0.0}):
        for key, value in moved.items():
            page.set(key, value)
        state = page.page.evaluate("nonholo.state")
        body, times = _top4(state["parameters"]), np.arange(state["steps"] + 1) * state["time_step"]
        motion = nh.flow(body, momentum=state["momentum"], times=times, reconstruct=False)
        np.testing.assert_array_equal(page.page.evaluate("nonholo.flow.rows"), motion.reduced_momentum)
    assert page.errors == []


def test_start_by_hand_in_four_dimensions(visit: Callable, files: dict) -> None:
    """Pressing on the phase portrait, or arrow keys there, change the first two momenta."""
    page = visit(files["top4"])
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
