"""The build hook: kernels that are compiled ahead go into wheels, and beside the kernels of a checkout."""

import contextlib
import os
import runpy
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from packaging.tags import platform_tags

_ROOT = Path(__file__).parent
# says where the library lies; the package is not there yet
_LIBRARY = SimpleNamespace(**runpy.run_path(str(_ROOT / "nonholo" / "base" / "compiled" / "library.py")))
_NEEDS = ["jaxtyping>=0.3", "lazy-loader>=0.4", "numba>=0.62", "numpy>=2.1", "rich>=14"]
_TAGS = {
    "linux-x86_64": "manylinux_2_17_x86_64",
    "linux-aarch64": "manylinux_2_17_aarch64",
    "darwin-arm64": "macosx_11_0_arm64",
    "windows-amd64": "win_amd64",
}


class KernelsHook(BuildHookInterface):  # pyright: ignore[reportMissingTypeArgument]
    """Compile the kernels once for each text of them; what was compiled is kept in the user's cache.

    The variable NONHOLO_MACHINE names the machine of a wheel, by default this one; `python` makes one of no machine,
    whose kernels run by numba or as Python.
    """

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Return what compiles: nothing where the library of this text is there."""
        library, machine = _LIBRARY, _machine()
        if not self._compiles(machine) or library.place(library.name_of_library(machine)):
            return []
        is_here = machine == library.this_machine() and machine.startswith("linux")
        return _NEEDS if is_here and any(map(shutil.which, ("ld", "ld.lld"))) else [*_NEEDS, "ziglang>=0.13"]

    def _compiles(self, machine: str) -> bool:
        return self.target_name == "wheel" and machine != "python"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Put the library beside the kernels, compiled now unless there is one."""
        library, machine = _LIBRARY, _machine()
        if not self._compiles(machine):
            return
        name = library.name_of_library(machine)
        folder, there = _ROOT / "nonholo" / "kernels", library.place(name)
        if there is None:
            command = [sys.executable, "-m", "nonholo.base.compiled.build", str(folder), machine]
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(_ROOT), *_places()])}
            subprocess.run(command, env=environment, check=True, cwd=_ROOT)  # noqa: S603
        elif there.parent != folder:
            _put(there.parent.glob(f"{library.prefix()}*"), folder)
        for file in folder.glob("kernels-*"):
            if not file.name.startswith(library.prefix()):
                file.unlink()
        with contextlib.suppress(OSError):  # a home that cannot be written
            _put(folder.glob("kernels-*"), library.cache_folder())
        if version != "editable":
            build_data["artifacts"] += [f"nonholo/kernels/{name}", "nonholo/kernels/kernels-*.wasm"]
            platform = _TAGS.get(machine) or next(platform_tags())
            build_data.update(pure_python=False, infer_tag=False, tag=f"py3-none-{platform}")


def _machine() -> str:
    return os.environ.get("NONHOLO_MACHINE") or _LIBRARY.this_machine()


def _places() -> list[str]:
    """Return where the build finds packages, without what pip runs at the start of its own process."""
    return [place for place in sys.path if place and not (Path(place) / "sitecustomize.py").exists()]


def _put(files: Iterable[Path], folder: Path) -> None:
    """Copy files into a folder, each in one go: what runs from an old one continues."""
    folder.mkdir(parents=True, exist_ok=True)
    for file in files:
        part = folder / f".{os.getpid()}.part"
        shutil.copy(file, part)
        part.replace(folder / file.name)
