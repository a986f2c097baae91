"""Where the library of the kernels lies, by their text: for the build, too, which has nothing but Python's own."""

import functools
import hashlib
import os
import platform
from pathlib import Path

_PACKAGE = Path(__file__).parents[2]
_FOLDERS = ("kernels", "base/numerics", "base/compiled")


def place(name: str = "") -> Path | None:
    """Return the file of this machine's library, or another one, beside the kernels or in the user's cache, if any."""
    files = (folder / (name or name_of_library()) for folder in (_PACKAGE / "kernels", cache_folder()))
    return next((file for file in files if file.is_file()), None)


def cache_folder() -> Path:
    """Return the folder of the user where libraries are kept, by the text of their kernels."""
    return Path(os.path.expanduser(os.environ.get("XDG_CACHE_HOME") or "~/.cache")) / "nonholo"


def this_machine() -> str:
    """Return the name of the system and processor of this process."""
    return f"{platform.system()}-{platform.machine()}".lower()


def name_of_library(machine: str = "") -> str:
    """Return the name of the file with the compiled kernels of this text, for this machine or another one."""
    return f"{prefix()}{machine or this_machine()}.so"


def name_of_module(run: str) -> str:
    """Return the name of the file with a run as WebAssembly."""
    return f"{prefix()}{run}.wasm"


def prefix() -> str:
    """Return how all files of this text begin."""
    return f"kernels-{digest_of_kernels().hex()[:16]}-"


def digest_of_kernels() -> bytes:
    """Return a digest of the text of all kernels."""
    return digest_of(*_FOLDERS)


@functools.cache
def digest_of(*folders: str) -> bytes:
    """Return a digest of the text in folders of the package."""
    digest = hashlib.sha256()
    for folder in folders:
        for file in sorted((_PACKAGE / folder).rglob("*")):
            if file.suffix in (".py", ".ll", ".txt"):
                digest.update(file.read_bytes())
    return digest.digest()
