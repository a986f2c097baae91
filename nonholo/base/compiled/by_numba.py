"""Kernels by numba, and their compiled code on disk.

numba's cache ends a program where no folder can be written, where a file is cut, and where the disk is full, and it
takes code as fresh whose callees in other files have changed. Here a file that is not whole, or not of this text of the
kernels, is as good as none; what cannot be written stays in memory.
"""

import contextlib
import functools
import hashlib
import os
import pickle
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import llvmlite
import numba
from numba.core import caching, config, serialize, types
from numba.extending import typeof_impl

from nonholo.base import compiled
from nonholo.base.compiled import library, say_once

_DIGEST = 32
_REMEDY = "Set NUMBA_CACHE_DIR to a folder that can be written."


def dispatcher_of(function: Callable[..., Any], options: dict[str, Any]) -> Any:
    """Compile a kernel when it is first called, and keep the code on disk where that is possible."""
    dispatcher: Any = numba.njit(**options, no_cfunc_wrapper=True)(function)  # pyright: ignore  # nothing calls it from C
    try:
        dispatcher._cache = _Cache(function)  # pyright: ignore
    except RuntimeError:  # numba has tried all places
        say_once(f"Compiled code is not kept on disk: each process compiles for itself. {_REMEDY}")
    return dispatcher


@functools.cache
def text_of_kernels() -> bytes:
    """Return a digest of all that compiled code depends on beside the types of its arguments and the processor."""
    of_numba = f"{numba.__version__} {config.BOUNDSCHECK}".encode()  # pyright: ignore
    return hashlib.sha256(library.digest_of_kernels() + of_numba).digest()


class _OfUser(caching.UserWideCacheLocator):
    """The user's cache; none where there is no home, since a folder of the name `~` would be made."""

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> Any:
        path = cls(py_func, py_file).get_cache_path()
        return super().from_function(py_func, py_file) if os.path.isabs(path) else None


class _Private(caching.InTreeCacheLocator):
    """A folder of this user alone below the temporary one, the last resort."""

    def __init__(self, py_func: Callable[..., Any], py_file: str) -> None:
        super().__init__(py_func, py_file)
        self._cache_path = str(private_folder() / self.get_suitable_cache_subpath(py_file))

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> Any:
        try:
            return super().from_function(py_func, py_file)
        except OSError:
            return None


def private_folder() -> Path:
    """Return a folder below the temporary one that nobody else can write to, since what lies in it is run.

    Raises:
        OSError: There is none, or what has its name is another user's, or open to others.
    """
    if not hasattr(os, "geteuid"):  # Windows has a cache for each user
        raise PermissionError
    path = Path(tempfile.gettempdir()) / f"nonholo-{os.geteuid()}"
    with contextlib.suppress(FileExistsError):
        path.mkdir(mode=0o700)
    about = path.lstat()
    if not stat.S_ISDIR(about.st_mode) or about.st_uid != os.geteuid() or about.st_mode & 0o077:
        raise PermissionError
    return path


class _Places(caching.CompileResultCacheImpl):
    _locator_classes = [  # noqa: RUF012  # numba's name for where it looks, one after another
        caching.UserProvidedCacheLocator,
        caching.InTreeCacheLocator,
        _OfUser,
        caching.ZipCacheLocator,
        _Private,
    ]


class _Cache(caching.FunctionCache):
    _impl_class = _Places

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        if isinstance(self._impl.locator, _Private):
            say_once(f"Compiled code is kept in {private_folder()}, as there is no other place for it. {_REMEDY}")
        self._cache_file = _Files(self.cache_path, self._impl.filename_base, text_of_kernels())

    def save_overload(self, sig: Any, data: Any) -> None:
        with contextlib.suppress(OSError):  # a full disk
            super().save_overload(sig, data)


def kept_bytes(function: Callable[..., Any], name: str, make: Callable[[], bytes]) -> bytes:
    """Return what `make` compiles of a function for another machine, kept beside its other code under a name."""
    try:
        file = _Cache(function)._cache_file
    except RuntimeError:
        return make()
    key = (name, llvmlite.__version__)
    code = file.load(key)
    if code is None:
        code = make()
        with contextlib.suppress(OSError):
            file.save(key, code)
    return code


class _Files(caching.IndexDataCacheFile):
    """A file for each signature of a function: a digest, then the signature with the code."""

    def load(self, key: Any) -> Any:
        """Return what was saved under a key; None if there is nothing that is whole, and of this text."""
        try:
            content = Path(self._path(key)).read_bytes()
        except OSError:
            return None
        digest, payload = content[:_DIGEST], content[_DIGEST:]
        if digest != self._digest(payload):
            return None
        of, data = pickle.loads(payload)  # noqa: S301  # a digest of ours, in a folder that the user chose or owns
        return data if of == key else None

    def save(self, key: Any, data: Any) -> None:
        """Save something under a key."""
        payload = serialize.dumps((key, data))
        with self._open_for_write(self._path(key)) as file:
            file.write(self._digest(payload) + payload)

    def flush(self) -> None:
        """Delete what was saved."""
        for file in Path(self._cache_path).glob(f"{Path(self._index_path).stem}.*.nbc"):
            file.unlink(missing_ok=True)

    def _path(self, key: Any) -> str:
        name = hashlib.sha256(repr(key[:2]).encode()).hexdigest()[:16]
        return self._index_path.removesuffix("nbi") + f"{name}.nbc"

    def _digest(self, payload: bytes) -> bytes:
        return hashlib.sha256(self._source_stamp + payload).digest()


@typeof_impl.register(compiled.Kernel)
def _type_of_kernel(kernel: compiled.Kernel, _: Any) -> types.Dispatcher:
    """Let compiled code call a kernel as it calls functions of numba's own decorator."""
    return types.Dispatcher(kernel.dispatcher)


compiled.tell_numba()
