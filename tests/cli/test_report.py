"""How measured numbers are written on the screen."""

import pytest

from nonholo.cli.screen.report import duration


@pytest.mark.parametrize(
    ("seconds", "written"),
    [(83.0, "83 s"), (1.0, "1 s"), (0.25, "250 ms"), (1.5e-3, "1.5 ms"), (7e-6, "7 us"), (4.2e-8, "42 ns")],
)
def test_durations_have_a_unit_that_suits_them(seconds: float, written: str) -> None:
    """A duration is written in the largest unit that it fills, to three digits."""
    assert duration(seconds) == written
