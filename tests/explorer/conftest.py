"""Pages in a real browser: Chromium, with what it says and what it asks for."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
_FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium without a screen, and without a graphics card."""
    sync_api = pytest.importorskip("playwright.sync_api")
    program = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        pytest.skip("there is no Chromium")
    with sync_api.sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=_FLAGS)
        yield running
        running.close()


class Visit:
    """A page that is open, with the errors and requests that it made."""

    def __init__(self, browser: Any, path: Path, fragment: str, before: str, **look: Any) -> None:
        self.context = browser.new_context(**{"viewport": {"width": 1280, "height": 800}, **look})
        self.page = self.context.new_page()
        self.page.add_init_script(before)
        self.errors: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda said: self.errors.append(said.text) if said.type == "error" else None)
        self.page.on("pageerror", lambda failure: self.errors.append(str(failure)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri() + fragment)
        self.until("document.getElementById('status').textContent !== 'Starting …'")

    def until(self, condition: str) -> None:
        """Wait until an expression is true: asked again and again from here, as the page may evaluate no text."""
        for _ in range(200):
            if self.page.evaluate(condition):
                return
            self.page.wait_for_timeout(50)
        raise TimeoutError(condition)

    def settle(self) -> None:
        """Wait until what was changed is drawn."""
        self.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def set(self, key: str, value: float) -> None:
        """Move a slider, as its user's arrow keys do."""
        self.page.evaluate(
            """([id, value]) => {
                const slider = document.getElementById(id);
                slider.value = value;
                slider.dispatchEvent(new Event("input", { bubbles: true }));
            }""",
            [f"slide-{key}", value],
        )
        self.settle()

    def numbers(self, name: str) -> list[float]:
        """Return an array of the orbit in the page, all digits."""
        return self.page.evaluate(f"Array.from(nonholo.orbit.{name})")

    @property
    def status(self) -> str:
        """What the page says of the motion."""
        return self.page.text_content("#status")


@pytest.fixture
def visit(browser: Any) -> Iterator[Callable[..., Visit]]:
    """Open files, and close them at the end of the test."""
    visits = []

    def open_file(path: Path, fragment: str = "", before: str = "", **look: Any) -> Visit:
        visits.append(Visit(browser, path, fragment, before, **look))
        return visits[-1]

    yield open_file
    for each in visits:
        each.context.close()
