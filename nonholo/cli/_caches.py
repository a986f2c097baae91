"""The place where JAX keeps compiled code between commands, so that only the first one has to wait for it."""

import functools
import os
from collections.abc import Callable


def with_cache_folder(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that gives JAX its folder first."""

    @functools.wraps(command)
    def run(**options: object) -> None:
        use_cache_folder()
        command(**options)

    return run


def use_cache_folder() -> None:
    """Give JAX a folder in the user's cache, if there is one that can be written.

    To be called before JAX is imported. What the user has set stays. Kernels have their own rule, whoever runs them.
    """
    import platformdirs

    folder = platformdirs.user_cache_path("nonholo") / "jax"
    if not folder.is_absolute():  # no home
        return
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return
    if os.access(folder, os.W_OK | os.X_OK):
        os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(folder))
        os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.1")
