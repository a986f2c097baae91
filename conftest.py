"""Names that doctests use."""

import numpy as np
import pytest

import nonholo as nh


@pytest.fixture(autouse=True)
def _doctest_names(doctest_namespace: dict[str, object]) -> None:
    doctest_namespace.update({"np": np, "nh": nh} | {name: getattr(nh, name) for name in dir(nh) if name != "plot"})
