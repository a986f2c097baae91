"""The bundle of the page is what npm and esbuild make of its sources."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from nonholo import explorer

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
