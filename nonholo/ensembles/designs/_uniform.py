"""Random numbers by member: those of one member depend on the seed, the stream and its index, and on nothing else."""

import zlib

import numpy as np

from nonholo.base.types import Float

_WORDS = 4  # numbers for each value of Philox's counter


def uniform_numbers(seed: int, stream: str, first: int, count: int, width: int) -> Float[np.ndarray, "count width"]:
    """Return numbers in [0, 1) of the members `first` to `first + count - 1`, this many of each.

    The generator is Philox, whose counter is set to the first member, so nothing before it is drawn.

    Example:
        >>> several = uniform_numbers(7, "a", first=0, count=10, width=3)
        >>> bool((several[4:6] == uniform_numbers(7, "a", first=4, count=2, width=3)).all())
        True
    """
    rounds = -(-width // _WORDS)
    key = np.array([seed, zlib.crc32(stream.encode())], dtype=np.uint64)
    bits = np.random.Philox(key=key, counter=first * rounds)
    return np.random.Generator(bits).random((count, _WORDS * rounds))[:, :width]
