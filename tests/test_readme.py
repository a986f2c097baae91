"""The README says what is so: its commands are the ones CI runs, its example runs, its links lead somewhere."""

import pathlib
import re

import pytest

ROOT = pathlib.Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()


def test_commands() -> None:
    """The two commands stand on lines of their own, where `.ci/run` finds them."""
    setup = "python3 -m venv .venv && .venv/bin/pip install -q -c constraints.txt -e"
    first, second = [line for line in README.splitlines() if line.startswith("python3")]
    assert first == f"{setup} . && .venv/bin/nonholo simulate suslov"
    assert second == f"{setup} '.[all,test]' && .venv/bin/python -m pytest -q"
    ci = (ROOT / ".ci" / "run").read_text()
    assert all(f"readme_command '{command}$'" in ci for command in ("nonholo simulate suslov", "python -m pytest -q"))


def test_example(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """The Python example runs, keeps energy as it claims, and leaves its files."""
    monkeypatch.chdir(tmp_path)
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    exec(example, {})  # noqa: S102
    assert float(capsys.readouterr().out.split()[0]) < 1e-15
    assert (tmp_path / "sleigh.png").stat().st_size > 10_000
    assert (tmp_path / "sleigh.zarr").is_dir()


@pytest.mark.parametrize("page", sorted(ROOT.glob("*.md")) + sorted(ROOT.glob("docs/**/*.md")), ids=lambda p: p.name)
def test_links(page: pathlib.Path) -> None:
    """Every relative link of every page leads to a file."""
    links = re.findall(r"\]\((?!https?:|#)([^)#]+)", page.read_text())
    assert [link for link in links if not (page.parent / link).exists()] == []
