"""What compilers make is kept on disk, and made once in a run, whichever of its processes needs it first."""

import contextlib
import fcntl
import functools
import hashlib
import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
_PATIENCE = 300.0  # seconds to wait for another process that compiles; then one compiles for itself
_held: set[Path] = set()


def use_caches() -> None:
    """Name the folders of the compilers' caches, before numba and JAX are imported; what the user has set stays.

    That of numba belongs to the text of the kernels: its own index does not notice that a callee has changed.
    """
    text = hashlib.sha256(os.environ.get("NUMBA_BOUNDSCHECK", "").encode())
    for room in ("continuous", "kernels", "base/numerics"):
        for file in sorted((ROOT / "nonholo" / room).rglob("*.py")):
            text.update(file.read_bytes())
    folder = ROOT / "build" / "tests"
    os.environ.setdefault("NUMBA_CACHE_DIR", str(folder / f"numba-{text.hexdigest()[:16]}"))
    os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(folder / "jax"))
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0")
    os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES", "-1")
    # each core has a process of its own; XLA takes two thirds of the time if its code need not be fast
    os.environ.setdefault("XLA_FLAGS", "--xla_cpu_parallel_codegen_split_count=1 --xla_backend_optimization_level=0")


def use_one_thread() -> None:
    """Let linear algebra run in one thread, before NumPy is imported: each core has a process of its own."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def release_programs() -> None:
    """Drop JAX's compiled programs: each holds memory maps, of which Linux lets a process have 65,530."""
    if "jax" in sys.modules:
        sys.modules["jax"].clear_caches()


def compile_once() -> None:
    """Let numba ask its cache again when another process has just compiled the same function."""
    from numba.core import dispatcher

    alone: Callable[..., Any] = dispatcher.Dispatcher.compile
    folder = Path(os.environ["NUMBA_CACHE_DIR"])
    folder.mkdir(parents=True, exist_ok=True)

    @functools.wraps(alone)
    def compiled(self: Any, signature: Any) -> Any:
        function = self.py_func
        if not function.__module__.startswith("nonholo."):
            return alone(self, signature)
        place = f"{function.__module__}.{function.__name__}.{function.__code__.co_firstlineno}"
        with _lock(folder / f"{place.replace('<', '').replace('>', '')}.lock"):
            return alone(self, signature)

    dispatcher.Dispatcher.compile = compiled


@contextlib.contextmanager
def _lock(path: Path) -> Iterator[None]:
    """Hold a lock on a file, once in a process, or continue without it after a long wait."""
    if path in _held:
        yield
        return
    with path.open("w") as file:
        end = time.monotonic() + _PATIENCE
        while not _locked(file.fileno()) and time.monotonic() < end:
            time.sleep(0.05)
        _held.add(path)
        try:
            yield
        finally:
            _held.discard(path)


def _locked(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
