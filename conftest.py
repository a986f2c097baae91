"""Names that doctests use, and no deadlines for drawn examples: the first one compiles."""

import sys
from collections.abc import Iterator

import hypothesis
import numpy as np
import pytest

import nonholo as nh

collect_ignore_glob = ["tests/golden/*"]  # programs that write references, not tests

hypothesis.settings.register_profile("nonholo", deadline=None)
hypothesis.settings.load_profile("nonholo")


@pytest.fixture(autouse=True)
def _doctest_names(doctest_namespace: dict[str, object]) -> None:
    doctest_namespace.update({"np": np, "nh": nh} | {name: getattr(nh, name) for name in dir(nh)})


@pytest.fixture(autouse=True, scope="module")
def _release_programs() -> Iterator[None]:
    """Drop compiled JAX programs after each file: each holds memory maps, of which a process may have only so many."""
    yield
    if "jax" in sys.modules:
        sys.modules["jax"].clear_caches()
