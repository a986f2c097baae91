"""The page on custom systems says what is so: its code runs, its numbers and messages are right."""

import pathlib
import re
from typing import Any

import numpy as np
import pytest

import nonholo as nh
from nonholo.io.datasets import compact_names

pytestmark = pytest.mark.profile("paper", instead="test_the_blocks_run")

PAGE = (pathlib.Path(__file__).parents[2] / "docs" / "how-to" / "define-your-own-system.md").read_text()


@pytest.fixture(scope="module")
def page() -> dict[str, Any]:
    """Return the names that the Python blocks of the page leave behind, run one after another."""
    names: dict[str, Any] = {"__name__": "how_to"}
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(compile(block, "define-your-own-system.md", "exec"), names)  # noqa: S102
    return names


def test_defaults_and_what_is_kept(page: dict[str, Any]) -> None:
    """Defaults on a user's group are those of the table; group and constraint are kept, here energy too."""
    discrete, result = page["discrete"], nh.invariants(page["orbit"])
    assert (discrete.difference, discrete.constraint) == ("logarithmic", "exponential")
    assert not discrete.conserves_energy
    assert all(each < 1e-12 for each in (result.energy_drift, result.constraint_residual, result.group_residual))
    assert np.ptp(page["orbit"].momentum[:, 0]) > 0.1  # it does move
    assert page["report"].passed
    assert page["report"]["energy"].status == "reported"


def test_a_pose_that_is_no_matrix_has_no_names(page: dict[str, Any]) -> None:
    """Sweeps label the numbers of a compact pose only where they know them."""
    assert len(compact_names(page["group"])) == 9
    assert compact_names(page["heisenberg"]) == []


def test_both_groups_are_the_same(page: dict[str, Any]) -> None:
    """The formulas of the page are those of the group from the basis."""
    x = np.random.default_rng(0).normal(size=(5, 3))
    g = page["group"].exp(x)
    assert np.allclose(page["heisenberg"].exp(x), g, rtol=0, atol=1e-14)
    assert np.allclose(page["heisenberg"].adjoint(g), page["group"].adjoint(g), rtol=0, atol=1e-13)
    assert page["heisenberg"] == type(page["heisenberg"])()


def test_the_message_that_is_shown(page: dict[str, Any]) -> None:
    """A logarithm without its square gives the error of the page."""
    kind = page["Heisenberg"]
    wrong = type("Heisenberg", (kind,), {"log": lambda self, g: self.vee(g - self.identity)})()
    (text,) = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    with pytest.raises(AssertionError) as raised:
        nh.testing.check_group(wrong)
    for line in text.splitlines()[:-1]:
        assert re.search(re.escape(line).replace(re.escape("..."), ".*"), str(raised.value)), line
