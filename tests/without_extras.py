"""The package where no library of an extra can be imported: a program that prints which extra each thing asks for.

python without_extras.py calls quick|all     # of each public name without a home, and of each call of the fuzzers
python without_extras.py ways                # of each kind of motion, or how its kernels run
python without_extras.py numbers             # of members with numbers of their own
python without_extras.py command ARGUMENT... # run a command of `nonholo`
"""

import contextlib
import functools
import importlib.abc
import json
import os
import re
import shutil
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))

ABSENT = {
    *("anywidget", "casadi", "diffrax", "distributed", "equinox", "flint", "jax", "jaxlib", "latex2mathml", "lineax"),
    *("llvmlite", "mpmath", "numba", "optimistix"),
}
"""The libraries of the extras that users run, and what those bring."""


class _Absent(importlib.abc.MetaPathFinder):
    """What finds nothing under some names, and lets no one else look."""

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:  # noqa: ARG002
        """Refuse the libraries of extras."""
        if name.partition(".")[0] in ABSENT:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)


if __name__ == "__main__":  # not where pytest looks for examples
    sys.meta_path.insert(0, _Absent())

import numpy as np  # noqa: E402

import nonholo as nh  # noqa: E402
from nonholo.base.checks import MissingExtraError  # noqa: E402
from nonholo.base.compiled import Kernel  # noqa: E402


def extra_of(missing: MissingExtraError) -> str:
    """Return the extra that an error names, with how to install it."""
    (extra,) = set(re.findall(r"extra `(\w+)`", str(missing)))
    if f"pip install 'nonholo[{extra}]'" not in str(missing):
        raise AssertionError(f"no remedy in {missing}")
    return extra


def names() -> dict[str, str]:
    """Return the extras that public names ask for."""
    extras = {}
    for name in dir(nh):
        try:
            getattr(nh, name)
        except MissingExtraError as missing:
            extras[name] = extra_of(missing)
    return extras


def _home_of(name: str, *_: Any, **__: Any) -> Any:
    """Ask again for a public name that has no home."""
    vars(nh).pop(name, None)
    return getattr(nh, name)


def calls(which: str) -> list[dict[str, str]]:
    """Return the extras that public names ask for, and those that their calls do; the rest work."""
    from fuzz import calls_systems
    from fuzz.calls import all_calls

    homeless = names()
    for missing in homeless:  # the table names them when it is made
        vars(nh)[missing] = functools.partial(_home_of, missing)
    for group in ("_in_coordinates", "_locomotion", "_examples"):  # that cannot be made without an extra: see `names`
        try:
            getattr(calls_systems, group)()
        except (MissingExtraError, AttributeError):
            setattr(calls_systems, group, list)
    chosen = {name: call for name, call in all_calls().items() if which == "all" or not (call.slow or call.stores)}
    extras = {}
    with tempfile.TemporaryDirectory() as folder:
        shelf = Path(folder) / "shelf"
        shelf.mkdir()
        if which == "all":
            from fuzz.shelf import fill

            fill(shelf)
        for number, (name, call) in enumerate(chosen.items()):
            own = Path(folder) / str(number)
            (shutil.copytree if call.stores else lambda _, path: path.mkdir())(shelf, own)
            with contextlib.chdir(own):
                try:
                    call()
                except MissingExtraError as missing:
                    extras[name] = extra_of(missing)
    return [homeless, extras]


def ways() -> dict[str, list[str]]:
    """Return for each kind of motion how the kernels of each task run: all from the library, or some as Python."""
    from matrix.abilities import Case
    from matrix.kinds import KINDS, STEPS

    tasks = [
        lambda case: case.orbit,
        lambda case: case.flow,
        lambda case: nh.ensemble(case.discrete, **case.rows, **case.run, steps=STEPS),
    ]
    ran = _watched()
    report: dict[str, list[str]] = {}
    for kind in KINDS:
        report[kind] = []
        for task in tasks:
            ran.clear()
            try:
                task(Case(kind))
                report[kind].append(min(ran, default="no kernels"))  # "Python" comes first
            except MissingExtraError as missing:
                report[kind].append(f"extra `{extra_of(missing)}`")
            except ModuleNotFoundError as missing:  # of the user's own import
                report[kind].append(f"your own {missing.name}")
            except ValueError:  # see the table of what works with what
                report[kind].append("")
    return report


def numbers() -> list[str]:
    """Return how kernels run where members have numbers of their own: of a sleigh, of a top, or a time step."""
    tensor = np.array([[1.4, 0.2, 0.5], [0.2, 1.0, -0.3], [0.5, -0.3, 0.9]])
    ran, sleigh, top = _watched(), nh.ChaplyginSleigh(1.0, 1.0, 0.5, 0.1), nh.SuslovTop(tensor)
    cases: list[Any] = [(sleigh, {name: [0.2, 0.3]}) for name in ("mass", "inertia", "a", "b", "time_step")]
    cases += [(top, {"mass_tensor": [tensor, 2 * tensor]}), (top, {"time_step": [0.2, 0.3]})]
    for system, parameters in cases:
        nh.ensemble(nh.discretize(system, 0.1), restricted_velocity=(0.4, 0.9), parameters=parameters, steps=3)
    return sorted(ran)


def _watched() -> set[str]:
    """Return a set that gets the ways in which kernels run from now on."""
    run: Any = Kernel.__call__
    ran: set[str] = set()
    Kernel.__call__ = lambda kernel, *arguments: ran.add("library") or run(kernel, *arguments)
    Kernel.dispatcher = property(lambda kernel: ran.add("Python") or kernel.py_func)
    return ran


if __name__ == "__main__":
    kind, *arguments = sys.argv[1:]
    if kind == "command":
        from nonholo.cli import main

        sys.argv[1:] = arguments
        main()
    else:
        found = {"calls": calls, "ways": ways, "numbers": numbers}[kind](*arguments)
        sys.stdout.write(json.dumps(found))
        sys.stdout.flush()
        os._exit(0)
