"""The scope in which the library computes with JAX."""

import contextlib
import functools
import os
import sys
from collections.abc import Iterator

from nonholo.base.compiled.library import cache_folder

_is_orphan = False  # whether JAX was in use when this process was forked


def _note() -> None:
    global _is_orphan
    _is_orphan = bool(getattr(sys.modules.get("jax._src.xla_bridge"), "_backends", None))


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_note)


@functools.cache
def keep_programs() -> None:
    """Let JAX keep what it compiles in the user's cache, where there is one; a folder that the user has named stays."""
    import jax

    folder = cache_folder() / "jax"
    own_folder = getattr(jax.config, "jax_compilation_cache_dir", None)
    if own_folder is not None or not folder.is_absolute():  # there is no home
        return
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    if os.access(folder, os.W_OK | os.X_OK):
        jax.config.update("jax_compilation_cache_dir", str(folder))
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.1)


@contextlib.contextmanager
def double_precision() -> Iterator[None]:
    """Compute with JAX in 64 bits; JAX's global configuration stays as it is, but for where programs are kept.

    Raises:
        RuntimeError: In a process that was forked from one that had used JAX: JAX would wait for threads that only the
            parent has, forever.

    Example:
        >>> with double_precision():
        ...     pass
    """
    import jax

    if _is_orphan:
        raise RuntimeError(
            "`nonholo` must compute with JAX in a process that was not forked from one that had used JAX: it would "
            f"wait forever for threads of its parent. Got process {os.getpid()}, which was. "
            "Start processes by multiprocessing.get_context('spawn'), or fork before JAX is used."
        )
    keep_programs()
    with jax.enable_x64(True):
        yield
