"""Where JAX keeps the programs that it compiles."""

from collections.abc import Iterator
from pathlib import Path

import pytest

jax = pytest.importorskip("jax")
from nonholo.base.numerics import double_precision, keep_programs  # noqa: E402

_FOLDER, _PATIENCE = "jax_compilation_cache_dir", "jax_persistent_cache_min_compile_time_secs"


@pytest.fixture(autouse=True)
def _nothing_named() -> Iterator[None]:
    named = {name: getattr(jax.config, name) for name in (_FOLDER, _PATIENCE)}
    jax.config.update(_FOLDER, None)
    keep_programs.cache_clear()
    yield
    for name, value in named.items():
        jax.config.update(name, value)


def test_programs_are_kept_in_the_users_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first call names a folder in the user's cache, and short programs are kept, too."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with double_precision():
        pass
    assert getattr(jax.config, _FOLDER) == str(tmp_path / "nonholo" / "jax")
    assert (tmp_path / "nonholo" / "jax").is_dir()
    assert getattr(jax.config, _PATIENCE) == 0.1


def test_a_users_choice_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder that the user has named stays, and so does what is kept in it."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    jax.config.update(_FOLDER, "/mine")
    jax.config.update(_PATIENCE, 3.0)
    keep_programs()
    assert (getattr(jax.config, _FOLDER), getattr(jax.config, _PATIENCE)) == ("/mine", 3.0)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("cache", ["/proc/nowhere", "~/.cache"], ids=["read-only", "no home"])
def test_where_there_is_no_place(cache: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is named, and no folder of the name ~ is made."""
    monkeypatch.setattr("nonholo.base.numerics._double_precision.cache_folder", lambda: Path(cache) / "nonholo")
    keep_programs()
    assert getattr(jax.config, _FOLDER) is None
    assert not Path("~").exists()
