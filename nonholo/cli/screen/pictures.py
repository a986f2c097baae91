"""Pictures of a run or a sweep, drawn beside its store; a picture that fails never costs the result.

Pictures of a run are the functions of `nonholo.plot` that an orbit has every argument of.
"""

import contextlib
import functools
import inspect
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray

import nonholo
from nonholo.analysis.planar import blade_axes
from nonholo.base.progress import progress_bar
from nonholo.cli.scenario.files import parse_toml, table_in
from nonholo.cli.scenario.sweeps import library_name
from nonholo.cli.screen.errors import FAILED, USAGE, store_errors, warn
from nonholo.ensembles import component_name
from nonholo.io.metadata import read_attributes
from nonholo.io.places import SWEEP_FORMAT, complete_file
from nonholo.orbit import Orbit

OVERVIEW, ALL, FILM = "overview", "all", "film"
_MOST_TIMES = 20_000  # of the flow that is drawn along
_GENERATIONS = 4  # of a tree of branches
_GIVEN: dict[str, Callable[[Any], Any]] = {
    "orbit": lambda orbit: orbit,
    "system": lambda orbit: orbit.system,
    "discrete": lambda orbit: orbit.motion,
    "locus": lambda orbit: nonholo.momentum_locus(orbit.motion),
    "tree": lambda orbit: nonholo.branch_tree(orbit.motion, orbit.displacement[0], _GENERATIONS),
    "crossings": lambda orbit: orbit.events[0] if orbit.events else None,
    "displacement": lambda orbit: orbit.displacement[0],
    "flow": lambda orbit: _flow(orbit),
}
"""Arguments of pictures that an orbit gives, by their names."""
_ASKED = ("across", "up")  # arguments that the command line has


def kinds() -> dict[str, Callable[..., Any]]:
    """Return the pictures of a run, by the names of the command line, the overview first; --gif draws its film."""
    plot = nonholo.plot
    functions = {name: getattr(plot, name) for name in dir(plot) if name.islower() and name != "animate"}
    of_orbits = [name for name, make in functions.items() if _necessary(make) <= {*_GIVEN, *_ASKED}]
    return {name.replace("_", "-"): functions[name] for name in sorted(of_orbits, key=lambda name: name != OVERVIEW)}


def _necessary(make: Callable[..., Any]) -> set[str]:
    parameters = inspect.signature(make).parameters.values()
    return {each.name for each in parameters if each.default is each.empty and each.kind is not each.VAR_KEYWORD}


def figure_of(kind: str, orbit: Orbit, look: dict[str, Any], **names: str | None) -> Any:
    """Return the figure of one kind, of named quantities if it has any: with the orbit, and the flow beside it."""
    make = kinds()[kind]
    parameters = inspect.signature(make).parameters
    own = {name: _GIVEN[name](orbit) for name in parameters if name in _GIVEN}
    own |= {side: _quantity(side, names.get(side)) for side in _ASKED if side in parameters}
    picture = make(**own, **look)
    return picture if kind == OVERVIEW else (picture.axes if hasattr(picture, "axes") else picture.plane).figure


def _quantity(side: str, name: str | None) -> Callable[[Orbit], np.ndarray]:
    """Return what gives a number of each state: an array of orbits by its name, with the indices of one component."""
    attribute, *indices = (name or "").split(".")

    def quantity(states: Orbit) -> np.ndarray:
        values: Any = getattr(states, attribute, None)
        if not all(index.isdigit() for index in indices) or not hasattr(values, "shape"):
            raise ValueError(f"a section needs --x and --y like body_velocity.0. Got '{name}' to run {side}.")
        return values[(slice(None), *map(int, indices))]

    quantity.__name__ = name or side
    return quantity


def beside(store: Path, suffix: str) -> Path:
    """Return the path of a picture that belongs to a store."""
    place = store.resolve() if store.name in ("", "..") else store
    return place.parent / f"{place.name.removesuffix('.zarr')}.{suffix}"


@contextlib.contextmanager
def _at_no_cost() -> Iterator[None]:
    """Warn of a picture that fails, which never costs the result."""
    try:
        yield
    except Exception as failure:
        warn(f"no picture: {type(failure).__name__}: {failure}")


def _save(picture: Path, make: Callable[[], Any], dpi: float = 150, *, progress: bool, what: str = "drawing") -> str:
    """Save the figure that is made; the file appears when it is complete."""
    with complete_file(picture) as part, progress_bar(what, progress):
        make().savefig(part, dpi=dpi)
    return str(picture)


def _film(orbit: Any, path: Path, *, progress: bool, **look: Any) -> str:
    with progress_bar("frames", progress) as report:
        return str(nonholo.plot.animate(orbit, path, progress=report, overwrite=True, **look))


def draw(orbit: Any, store: Path, suffixes: list[str], *, progress: bool) -> dict[str, str | None]:
    """Draw the overview and the animation beside a store; return their paths, None for what is not drawn."""
    paths: dict[str, str | None] = {"picture": None, "animation": None}
    with _at_no_cost():
        if "png" in suffixes:
            paths["picture"] = _save(beside(store, "png"), lambda: figure_of(OVERVIEW, orbit, {}), progress=progress)
        if "gif" in suffixes:
            paths["animation"] = _film(orbit, beside(store, "gif"), progress=progress)
    return paths


def _draw_all(orbit: Any, picture: Path, look: dict[str, Any], dpi: float, *, progress: bool) -> Iterator[str]:
    """Draw every kind that this orbit has, each in a separate file; yield their paths, and warn of the others."""
    others = []
    for kind in kinds():
        path, figure = picture.with_stem(f"{picture.stem}-{kind}"), functools.partial(figure_of, kind, orbit, look)
        try:
            yield _save(path, figure, dpi, progress=progress, what=f"drawing {kind}")
        except ValueError:
            others.append(kind)
    if others:
        warn(f"of this run there is no {', '.join(others)}; --kind {others[0]} prints the reason.")


def warn_of_older(store: Path, paths: dict[str, str | None]) -> None:
    """Warn if a picture beside a store that was replaced still shows the run before."""
    for path in (beside(store, "png"), beside(store, "gif")):
        if path.exists() and str(path) not in paths.values():
            warn(f"'{path}' shows an older run. Remove it, or draw it again with: nonholo plot {store}")


def _flow(orbit: Any) -> Any:
    """Return the continuous motion from the same start where a closed form makes it cheap."""
    if blade_axes(orbit.system) is None or orbit.cayley is None or orbit.canonical_pose is None:
        return None
    times = orbit.time[:: max(1, len(orbit) // _MOST_TIMES)]
    start = {"momentum": orbit.restricted_momentum[0], "configuration": orbit.configuration[0]}
    try:
        return nonholo.flow(orbit.system, times=times, method="closed_form", **start)
    except Exception as failure:
        warn(f"the continuous motion is not drawn along: {type(failure).__name__}: {failure}")
        return None


def draw_sweep(sweep: xarray.Dataset, picture: Path, *names: str | None) -> str | None:
    """Draw a quantity of a sweep beside its store; return the path of the picture, None if there is none."""
    with _at_no_cost():
        return _map(sweep, picture, *names)
    return None


def _map(sweep: xarray.Dataset, picture: Path, *names: str | None, dpi: float = 150, **look: Any) -> str:
    """Draw a quantity over the design: the given quantities for color, x and y."""
    own: Any = [None if path is None else component_name(library_name(path)) for path in names]
    figure: Any = nonholo.plot.sweep_map(sweep, *own, **look).axes.figure
    return _save(picture, lambda: figure, dpi, progress=sys.stderr.isatty())


def draw_stored_run(store: Path, path: Path, look: dict[str, Any], kind: str, dpi: float, **names: Any) -> list[str]:
    """Draw a picture of a run, all of them or its animation, and return the paths of what was drawn."""
    with store_errors(USAGE):
        read_attributes(store)
    progress = sys.stderr.isatty()
    with store_errors(FAILED), progress_bar("reading", progress):
        orbit = nonholo.load_orbit(store)
    if kind == ALL:
        return list(_draw_all(orbit, path, look, dpi, progress=progress))
    with store_errors(FAILED):
        if kind == FILM:
            return [_film(orbit, path, progress=progress, **look)]
        return [_save(path, lambda: figure_of(kind, orbit, look, **names), dpi, progress=progress)]


def draw_stored_sweep(store: Path, picture: Path, *names: str | None, **options: Any) -> list[str]:
    """Draw the sweep of a store: the given quantities for color, x and y, or those of its scenario."""
    with store_errors(FAILED):
        result = nonholo.load_sweep(store)
        if not any(names):
            with contextlib.suppress(ValueError):  # a store may keep a text that is no scenario
                output = table_in(parse_toml(read_attributes(store, SWEEP_FORMAT).get("scenario", "")), "output")
                names = tuple(output.get(name) for name in ("color", "x", "y"))
        return [_map(result, picture, *names, **options)]
