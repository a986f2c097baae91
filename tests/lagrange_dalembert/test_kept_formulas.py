"""Compiled formulas stay on disk: a process that has them traces a system once, and its orbits have the same bits."""

import collections
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from formulas import forget

import nonholo as nh
from nonholo.lagrange_dalembert.compiled import _machine

START = {"configuration": (0.1, 0.0, 0.3), "body_velocity": (1.0, 0.5, 0.0)}


@pytest.fixture(name="folder", autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    forget()
    yield tmp_path / "nonholo" / "formulas"
    forget()


def _particle(slope: Any = 1.0, potential: Any = None) -> nh.LagrangeDAlembert:
    weights = np.array([slope, 0.0, 0.0])

    @jax.jit
    def forms(q: Any) -> Any:
        return jnp.stack([-q[1] * weights + jnp.array([0.0, 0.0, 1.0])])

    def energy(q: Any, v: Any) -> Any:
        return v @ v / 2 - (jnp.cos(q[0]) if potential is None else potential(q[0]))

    return nh.LagrangeDAlembert(energy, forms, dimension=3)


def _motions(system: nh.LagrangeDAlembert) -> list[np.ndarray]:
    orbit = nh.simulate(nh.discretize(system, 0.1), **START, steps=20)
    flow = nh.flow(system, **START, times=(0.0, 0.5, 1.0))
    return [orbit.configuration, orbit.multipliers, orbit.energy, flow.configuration, flow.momentum]


def test_a_second_process_translates_nothing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is compiled from the same functions, and the bits are those of before; a damaged file is made anew."""
    first = _motions(_particle())
    files = sorted(folder.iterdir())
    assert len(files) >= 4
    forget()
    with monkeypatch.context() as patch:
        patch.setattr(_machine, "object_of", lambda *_, **__: pytest.fail("compiled again"))
        assert all(map(np.array_equal, _motions(_particle()), first))
    for file, damage in zip(files, (b"", b"{}\n", b"[1]\n\xff", files[0].read_bytes()[:-1]), strict=False):
        file.write_bytes(damage)
    forget()
    assert all(map(np.array_equal, _motions(_particle()), first))
    assert sorted(folder.iterdir()) == files


@pytest.mark.parametrize("parameters", [{}, {"mass": 2.0}], ids=["none", "mass"])
def test_each_function_is_called_once(parameters: dict[str, float]) -> None:
    """From its check to the ends of a run and of a flow JAX traces a function of a user once, then its program."""
    calls = collections.Counter[str]()

    def noted(name: str, function: Any) -> Any:
        def call(*arguments: Any) -> Any:
            calls[name] += 1
            return function(*arguments)

        return call

    energy = noted("energy", lambda q, v, *p: v @ v / 2 * (p[0]["mass"] if p else 1.0) - jnp.cos(q[0]))
    forms = noted("forms", lambda q, *_: jnp.stack([jnp.stack([-q[1], 0.0 * q[0], 1.0 + 0.0 * q[0]])]))
    force = noted("force", lambda _time, _q, v, *_: -0.1 * v)
    _motions(nh.LagrangeDAlembert(energy, forms, dimension=3, force=force, parameters=parameters))
    assert calls == {"energy": 1, "forms": 1, "force": 1}


def test_numbers_within_functions_count(folder: Path) -> None:
    """A number that an inner compiled function captures is seen: another one has files of its own."""
    one, other = _motions(_particle(1.0)), _motions(_particle(2.0))
    assert not np.array_equal(one[0], other[0])
    count = len(list(folder.iterdir()))
    forget()
    assert all(map(np.array_equal, _motions(_particle(2.0)), other))
    assert len(list(folder.iterdir())) == count


@jax.custom_jvp
def _bent(x: Any) -> Any:
    return jnp.cos(x)


@_bent.defjvp
def _slope(primals: Any, tangents: Any) -> Any:
    return jnp.cos(primals[0]), -3.0 * jnp.sin(primals[0]) * tangents[0]


@pytest.mark.parametrize("potential", [_bent, lambda x: jax.lax.stop_gradient(x) * x], ids=["custom", "stopped"])
def test_derivatives_of_users_are_not_kept(folder: Path, potential: Any) -> None:
    """What the value of a function does not show leaves no file."""
    assert not np.array_equal(_motions(_particle(potential=potential))[0], _motions(_particle())[0])
    files = len(list(folder.iterdir()))
    forget()
    _motions(_particle(potential=potential))
    assert len(list(folder.iterdir())) == files


def test_parameters_share_a_file_and_old_files_go(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Systems that differ by parameters have the same files; of many files the oldest go."""

    def energy(q: Any, v: Any, p: Any) -> Any:
        return p["mass"] * v @ v / 2 - q[0] * 0.0

    for mass in (1.0, 2.0):
        system = nh.LagrangeDAlembert(energy, None, dimension=1, parameters={"mass": mass})
        orbit = nh.simulate(nh.discretize(system, 0.1), configuration=[0], body_velocity=[1], steps=3)
        assert orbit.momentum[0, 0] == mass
        count = len(list(folder.iterdir()))
        forget()
        if mass == 1.0:
            before = count
    assert count == before
    monkeypatch.setattr(_machine, "_MOST", 3)
    _motions(_particle())
    assert len(list(folder.iterdir())) == 3


def test_without_a_home_nothing_is_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A folder that cannot be made, or that is no absolute path, is no reason to fail."""
    file = tmp_path / "file"
    file.write_text("")
    for home in (str(file), "relative"):
        monkeypatch.setenv("XDG_CACHE_HOME", home)
        forget()
        assert len(_motions(_particle())) == 5
    assert not (Path.cwd() / "relative").exists()
