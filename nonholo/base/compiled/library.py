"""Where the library of the kernels lies, by their text: for the build, too, which has nothing but Python's own."""

import functools
import hashlib
import itertools
import os
import platform
from pathlib import Path

_PACKAGE = Path(__file__).parents[2]
_FOLDERS = ("kernels", "base/numerics", "base/compiled")


def place() -> Path | None:
    """Return the file of this machine's library: beside the kernels, or in the user's cache; None if there is none."""
    files = (folder / name_of_library() for folder in (_PACKAGE / "kernels", cache_folder()))
    return next((file for file in files if file.is_file()), None)


def cache_folder() -> Path:
    """Return the folder of the user where libraries are kept, by the text of their kernels."""
    return Path(os.path.expanduser(os.environ.get("XDG_CACHE_HOME") or "~/.cache")) / "nonholo"


def name_of_library() -> str:
    """Return the name of the file with the compiled kernels of this text, for this machine."""
    machine = f"{platform.system()}-{platform.machine()}".lower()
    return f"kernels-{digest_of_kernels().hex()[:16]}-{machine}.so"


@functools.cache
def digest_of_kernels() -> bytes:
    """Return a digest of the text of all kernels."""
    digest = hashlib.sha256()
    files = (sorted((_PACKAGE / folder).rglob("*.py")) for folder in _FOLDERS)
    for file in itertools.chain(*files, [_PACKAGE / "kernels" / "ahead.txt", Path(__file__).with_name("runtime.ll")]):
        digest.update(file.read_bytes())
    return digest.digest()
