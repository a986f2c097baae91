"""The whole site, built, served and visited: its links lead somewhere, and it asks for nothing from elsewhere."""

import functools
import json
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest
from links import Links

from nonholo import explorer

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built strictly."""
    pytest.importorskip("myst_nb")
    built = tmp_path_factory.mktemp("site")
    subprocess.run([sys.executable, "-m", "sphinx", "-q", "-W", "-n", DOCS, built], check=True, timeout=900)  # noqa: S603
    return built


@pytest.fixture
def address(site: Path) -> Iterator[str]:
    """Where the site is served."""

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            """Print nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=str(site))) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def _pages(site: Path) -> list[Path]:
    """Return all pages; templates of the theme are none."""
    return [path for path in sorted(site.rglob("*.html")) if path.parent.name != "_static"]


@pytest.mark.profile("site", instead="test_links")
def test_every_link_leads_somewhere(site: Path) -> None:
    """Of links, pictures, scripts and frames within the site each file is there, and so is the place in it."""
    pages = {path: Links(path.read_text("utf-8")) for path in _pages(site)}
    lost = []
    for page, links in pages.items():
        for link in links.referred:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            reference = {"", "top", *pages[target].places} if target in pages else {"", unquote(parts.fragment)}
            if not target.exists() or unquote(parts.fragment) not in reference:
                lost.append((str(page.relative_to(site)), link))
    assert len(pages) > 60
    assert lost == []


@pytest.mark.profile("site", instead="test_what_a_page_loads")
def test_nothing_is_asked_of_elsewhere(site: Path, address: str, browser: Any) -> None:
    """Every page of the site, open in Chromium, asks its own server alone; so does the live page of the first one."""
    page, requests = browser.new_page(), set()
    page.on("request", lambda request: requests.add(request.url))
    for path in _pages(site):
        page.goto(address + path.relative_to(site).as_posix(), wait_until="load")
    page.goto(address)
    page.locator("iframe.live").scroll_into_view_if_needed()
    page.frame_locator("iframe.live").get_by_text("energy kept to").wait_for()
    page.close()
    assert address + "live/sleigh.html" in requests
    assert {url for url in requests if not url.startswith((address, "data:", "blob:", "about:"))} == set()


VIEW = Path(explorer.__file__).with_name("view")


@pytest.mark.profile("browser", instead="test_versions_are_exact")
def test_bundle_is_that_of_its_sources(tmp_path: Path) -> None:
    """Packages of the named versions make the bundle again, byte for byte, and three.js its licence."""
    npm = shutil.which("npm")
    if npm is None:
        pytest.skip("there is no npm")
    shutil.copytree(VIEW, folder := tmp_path / "view")
    (folder / "view.js").unlink()
    for command in (["install", "--no-audit", "--no-fund", "--no-package-lock"], ["run", "bundle"]):
        subprocess.run([npm, *command], cwd=folder, check=True, capture_output=True)  # noqa: S603
    assert (folder / "view.js").read_bytes() == (VIEW / "view.js").read_bytes()
    assert (folder / "node_modules/three/LICENSE").read_bytes() == (VIEW / "three-LICENSE.txt").read_bytes()


def test_versions_are_exact() -> None:
    """What the bundle is made of is named by exact versions, and no addresses are kept."""
    package = json.loads((VIEW / "package.json").read_text())
    for version in (package["dependencies"] | package["devDependencies"]).values():
        assert version.replace(".", "").isdigit()
    assert not (VIEW / "package-lock.json").exists()
    assert (VIEW / "view.js").stat().st_size < 665_000
