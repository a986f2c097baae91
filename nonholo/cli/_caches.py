"""Where compiled code is kept between commands, so that only the first one has to wait for the compilers."""

import atexit
import os
import shutil
import tempfile
from pathlib import Path


def use_cache_folders() -> None:
    """Give JAX, and numba where the package folder is read-only, a folder in the user's cache.

    To be called before either is imported. What the user has set stays.
    """
    import platformdirs

    folder = platformdirs.user_cache_path("nonholo")
    kept = _can_write(folder)
    if kept:
        os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(folder / "jax"))
        os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.1")
    if "NUMBA_CACHE_DIR" in os.environ or _can_write(Path(__file__).parents[1] / "kernels" / "__pycache__"):
        return
    os.environ["NUMBA_CACHE_DIR"] = str(folder / "numba") if kept else _passing_folder()


def _can_write(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK | os.X_OK)


def _passing_folder() -> str:
    """Return a private folder for this command alone: without any, numba would refuse to load the kernels."""
    folder = tempfile.mkdtemp(prefix="nonholo-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder
