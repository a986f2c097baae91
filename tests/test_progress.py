"""The bar of progress: where it is written and what it says."""

import pytest

from nonholo._progress import progress_bar


@pytest.fixture(autouse=True)
def _terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let standard error pass for a terminal without colours."""
    for name, value in {"TERM": "xterm", "FORCE_COLOR": "1", "NO_COLOR": "1"}.items():
        monkeypatch.setenv(name, value)


def _shown(capsys: pytest.CaptureFixture[str], wanted: bool = True) -> tuple[str, str]:
    """Tell of half of a task, in two parts; return what is on standard output and on standard error."""
    with progress_bar("states", wanted) as report:
        report(10, 40)
        report(20, 40)
    written = capsys.readouterr()
    return written.out, written.err


def test_bar_leaves_the_results_alone(capsys: pytest.CaptureFixture[str]) -> None:
    """The bar is written to standard error, nothing of it to standard output."""
    out, err = _shown(capsys)
    assert not out
    assert "states" in err


def test_bar_shows_what_is_done_of_the_whole(capsys: pytest.CaptureFixture[str]) -> None:
    """Each report says how much is done so far, not how much more."""
    _, err = _shown(capsys)
    assert "50%" in err
    assert "75%" not in err


def test_no_bar_unless_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    """Where no bar is wanted reports are taken and nothing is written."""
    assert _shown(capsys, wanted=False) == ("", "")
