"""The compiled loops of `nonholo.kernels` for the page, as WebAssembly: compiled ahead, or now."""

from nonholo.base.checks import needs
from nonholo.base.compiled import library
from nonholo.kernels import FLAT_RUNS

KINDS = tuple(FLAT_RUNS)
"""The runs of the bodies that have a kernel for the page; of a continuous motion where there is no closed form."""

_WIDE = {"top4", "flow4"}


def kinds_beside(kind: str) -> list[str]:
    """Return the kinds of one page, and of its ready motions: those in the plane and in space, or the others."""
    return [each for each in KINDS if (each in _WIDE) == (kind in _WIDE)]


def kernel(body: str) -> bytes:
    r"""Return the WebAssembly module that runs a body, one of `KINDS`.

    Its only export is `run`, with the arguments that the functions of `nonholo.kernels.FLAT_RUNS` have; it imports a
    memory and the top of its stack.

    Raises:
        MissingExtraError: It was not compiled ahead, and the extra `compile` is not installed.

    Example:
        >>> kernel("sleigh")[:4]
        b'\x00asm'
    """
    file = library.place(library.name_of_module(body))
    if file is not None:
        return file.read_bytes()
    with needs("compile", "nonholo.explore"):
        from nonholo.base.compiled import wasm
    return wasm.module(body)
