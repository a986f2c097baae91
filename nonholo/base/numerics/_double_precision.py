"""The scope in which the library computes with JAX."""

import contextlib
import os
import sys
from collections.abc import Iterator

_orphaned = False  # whether JAX was in use when this process was forked


def _note() -> None:
    global _orphaned
    _orphaned = bool(getattr(sys.modules.get("jax._src.xla_bridge"), "_backends", None))


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_note)


@contextlib.contextmanager
def double_precision() -> Iterator[None]:
    """Compute with JAX in 64 bits; JAX's global configuration stays as it is.

    Raises:
        RuntimeError: In a process that was forked from one that had used JAX: JAX would wait for threads that only the
            parent has, forever.

    Example:
        >>> with double_precision():
        ...     pass
    """
    import jax

    if _orphaned:
        raise RuntimeError(
            "`nonholo` must compute with JAX in a process that was not forked from one that had used JAX: it would "
            f"wait forever for threads of its parent. Got process {os.getpid()}, which was. "
            "Start processes by multiprocessing.get_context('spawn'), or fork before JAX is used."
        )
    with jax.enable_x64(True):
        yield
