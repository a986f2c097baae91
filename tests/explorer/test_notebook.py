"""The live page and pictures in notebooks: what sliders say in Python, notebooks that run, a real JupyterLab."""

import math
import os
import re
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nonholo as nh
from nonholo.explorer._explore import shown_motion, simulate_state

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs/notebooks").glob("*.ipynb"))
SLEIGH = nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)
TOP = nh.SuslovTop([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])


@pytest.mark.parametrize("body", [TOP, SLEIGH])
def test_orbit_of_a_page(body: Any) -> None:
    """A page computes in Python the orbit it shows, from its pose too."""
    orbit = nh.simulate(nh.discretize(body, 0.2), restricted_velocity=(0.3, -1.0), steps=30)
    again = nh.explore(orbit).orbit()
    np.testing.assert_array_equal(again.restricted_momentum, orbit.restricted_momentum)
    np.testing.assert_allclose(again.configuration, orbit.configuration, rtol=0, atol=1e-15)


def test_replay_has_no_state() -> None:
    """A body without a kernel has an orbit of its own, and the page says where it is."""
    space = nh.RigidBody(np.diag([1.0, 2.0, 3.0]))
    page = nh.explore(nh.simulate(nh.discretize(space, 0.1), body_velocity=(1, 0.2, 0), steps=3))
    assert page.state is None
    with pytest.raises(ValueError, match=r"Page\.orbit.* Use the orbit you passed"):
        page.orbit()


def test_state_follows_the_widget() -> None:
    """What the frame says of its sliders is the state of the page, and its orbit is of that."""
    pytest.importorskip("anywidget")
    page = nh.explore(SLEIGH)
    data, _ = page._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    page.widget.state = {**page.first_state, "time_step": 0.5, "steps": 7}  # type: ignore[dict-item]
    assert page.state["time_step"] == 0.5  # type: ignore[index]
    assert page.orbit().time[-1] == 3.5


FIRST_STATE: dict[str, Any] = shown_motion("explore(value=...)", SLEIGH)[0]["state"]
ODD: dict[str, Any] = {
    "nothing": {},
    "a list": [],
    "a text": "top",
    "evil": {"kind": "evil"},
    "ends in top": {"kind": "desktop"},
    "forced by a letter": {"kind": "forced_x"},
    "no kind": {"kind": None},
    "continuous": {"kind": "flow4"},
    "of another body": {"kind": "top"},
    "under forces without numbers": {"kind": "forced_sleigh"},
    "foreign key": {"program": "x"},
    "parameter missing": {"parameters": {"mass": 1.0, "inertia": 1.0}},
    "foreign parameter": {"parameters": {"mass": 1.0, "inertia": 1.0, "a": 0.5, "J11": 1.0}},
    "parameter of text": {"parameters": {"mass": "1", "inertia": 1.0, "a": 0.5}},
    "parameters of a list": {"parameters": [1.0, 1.0, 0.5]},
    "large": {"parameters": {"mass": 1e7, "inertia": 1.0, "a": 0.5}},
    "not finite": {"parameters": {"mass": math.nan, "inertia": 1.0, "a": 0.5}},
    "no mass": {"parameters": {"mass": -1.0, "inertia": 1.0, "a": 0.5}},
    "one momentum": {"momentum": [1.0]},
    "momentum of text": {"momentum": ["x", 1.0]},
    "momentum of truth": {"momentum": [True, 1.0]},
    "no pose": {"pose": []},
    "pose of another size": {"pose": [1.0, 1.0, 0.0, 0.0]},
    "no time": {"time_step": 0.0},
    "steps of a fraction": {"steps": 3.5},
    "many steps": {"steps": 10**12},
    "table of another page": {"table": "0123456789ab"},
}


@pytest.mark.parametrize("odd", ODD)
def test_odd_states_are_refused(odd: str) -> None:
    """A frame may say anything: it is data, and refused in a sentence by the rules of the page itself."""
    change = ODD[odd]
    state = {**FIRST_STATE, **change} if isinstance(change, dict) and change else change
    with pytest.raises(ValueError, match=r"^`[^`]+` must .+ Got .+\."):
        simulate_state("Page.orbit()", state)


@pytest.mark.parametrize("missing", ["kind", "parameters", "momentum", "pose", "time_step", "steps"])
def test_states_with_gaps_are_refused(missing: str) -> None:
    """Every entry has to be there."""
    state = {name: value for name, value in FIRST_STATE.items() if name != missing}
    with pytest.raises(ValueError, match=f"Got {missing}: Field required"):
        simulate_state("Page.orbit()", state)


EXTREME = {
    "heavy": nh.ChaplyginSleigh(1e8, 1.0, 0.5),
    "hasty": nh.discretize(SLEIGH, 1e-7),
    "heavy top": nh.SuslovTop(1e7 * np.eye(3)),
}


def test_page_that_can_show_nothing_is_refused() -> None:
    """A time step beyond those of the page, at which no step is left to replay, has no page."""
    with pytest.raises(ValueError, match="be a motion that the page can show"):
        nh.explore(nh.discretize(SLEIGH, 1e3))


@pytest.mark.parametrize("body", EXTREME)
def test_extreme_bodies_are_replayed(body: str) -> None:
    """A page whose own check would refuse its first state is none that begins: it shows numbers, and says why."""
    page = nh.explore(EXTREME[body])
    assert page.first_state is None
    assert '"replay":' in page.text
    assert "no numbers beyond a million" in page.text


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (TOP, ["SuslovTop", "1.4", "SO(3)"]),
        (nh.SuslovTop.arrowhead([1.0] * 100_000, [0.1] * 99_999), ["n=100000"]),
        (nh.simulate(nh.discretize(SLEIGH, 0.2), body_velocity=(0.3, -1, 0), steps=5), ["0 to 1", "6", "successful"]),
        (nh.displacements_over(nh.discretize(TOP, 0.2), [0.3, 0.4]), ["0, principal", "4 values, 2 real"]),
    ],
    ids=["top", "wide", "orbit", "branches"],
)
def test_values_show_themselves(value: Any, words: list[str]) -> None:
    """Systems, orbits and values of the map are tables in a notebook."""
    text = value._repr_html_()
    assert text.startswith("<table>")
    for word in words:
        assert word in text


def test_pictures_show_themselves() -> None:
    """A figure has the bytes of a PNG for a notebook."""
    figure: Any = nh.simulate(nh.discretize(SLEIGH, 0.2), restricted_velocity=(0.3, -1.0), steps=5).plot()
    assert figure._repr_png_().startswith(b"\x89PNG")


@pytest.mark.profile("browser", instead="test_state_follows_the_widget")
@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_run(notebook: Path) -> None:
    """Every cell of the notebooks runs, and every picture in them shows itself."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    cells = nbclient.NotebookClient(nbformat.read(notebook, 4), timeout=300).execute().cells
    data = [output["data"] for cell in cells for output in cell.get("outputs", ()) if "data" in output]
    pictures = sum(bool(re.search(r"\.plot\(\)|nh\.plot\.", cell["source"])) for cell in cells)
    assert sum("image/png" in each for each in data) == pictures > 0


@pytest.fixture
def laboratory(tmp_path: Path) -> Iterator[tuple[str, Path]]:
    """A JupyterLab of its own: its address and its folder."""
    pytest.importorskip("jupyterlab")
    words = ["--no-browser", "--allow-root", "--ServerApp.port=0", "--ServerApp.token=", "--ServerApp.password="]
    home = {"JUPYTER_CONFIG_DIR": str(tmp_path / "config"), "JUPYTER_DATA_DIR": str(tmp_path / "data")}
    (tmp_path / "work").mkdir()
    command = [sys.executable, "-m", "jupyterlab", *words, f"--ServerApp.root_dir={tmp_path / 'work'}"]
    log = tmp_path / "log"
    environment = {**os.environ, **home}
    with log.open("w") as out, subprocess.Popen(command, stderr=out, stdout=out, env=environment) as server:  # noqa: S603
        try:
            yield _address(log, server), tmp_path / "work"
        finally:
            server.terminate()


def _address(log: Path, server: subprocess.Popen) -> str:
    for _ in range(600):
        result = re.search(r"http://(?:localhost|127\.0\.0\.1):(\d+)/lab", log.read_text())
        if result:
            address = f"http://127.0.0.1:{result[1]}"
            urllib.request.urlopen(f"{address}/api").read()  # noqa: S310
            return address
        assert server.poll() is None, log.read_text()
        time.sleep(0.1)
    raise TimeoutError(log.read_text())


@pytest.mark.profile("browser", instead="test_state_follows_the_widget")
def test_widget_in_jupyterlab(browser: Any, laboratory: tuple[str, Path]) -> None:
    """In a real JupyterLab the page is live, and Python hears of a slider that was moved there."""
    address, folder = laboratory
    source = next(path for path in NOTEBOOKS if path.stem == "the-live-page")
    (folder / "page.ipynb").write_text(source.read_text())
    page = browser.new_context(viewport={"width": 1280, "height": 1000}).new_page()
    page.goto(f"{address}/lab/tree/page.ipynb?reset")
    page.locator(".jp-Notebook .jp-CodeCell").first.wait_for(timeout=60_000)
    page.get_by_text("(ipykernel) | Idle").wait_for(timeout=60_000)
    page.locator(".jp-Notebook .jp-CodeCell").first.click()
    page.keyboard.press("Shift+Enter")
    frame = page.frame_locator(".jp-OutputArea iframe").first
    frame.locator("#status:not(:text('Starting'))").wait_for(timeout=60_000)
    frame.locator("#number-time_step").fill("0.25")
    frame.locator("#number-time_step").press("Enter")
    page.wait_for_timeout(1000)  # the frame tells of a state that stays
    page.locator(".jp-CodeCell:has-text('page.state')").first.click()
    page.keyboard.press("Shift+Enter")
    page.locator(".jp-OutputArea-output:has-text(\"'time_step': 0.25\")").first.wait_for(timeout=30_000)
