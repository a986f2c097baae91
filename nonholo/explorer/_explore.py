"""The doors of the live page: of a system, a discretization or an orbit.

One HTML file: the view, the kernels and the data of a motion, with a policy by which nothing else can run in it.
"""

import base64
import dataclasses
import functools
import gzip
import hashlib
import html
import json
import re
import tempfile
import webbrowser
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, Literal, TypeAlias, cast

import jinja2
import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from nonholo.analysis.bodies import box_in_space, box_in_sphere, plate
from nonholo.analysis.planar import blade_axes
from nonholo.base.checks import checked_path, error, flags, needs, number, printable, shown
from nonholo.base.compiled import library
from nonholo.base.memo import Keeper
from nonholo.base.results import Outcome
from nonholo.base.types import Array, Float, Int
from nonholo.discrete import Discretization, discretize
from nonholo.groups import SE, SO, matrix_from_quaternion
from nonholo.io.places import check_file, new_file
from nonholo.kernels import FLAT_RUNS
from nonholo.orbit import AbstractOrbit, Orbit, any_orbit
from nonholo.simulation import simulate
from nonholo.systems import AbstractSystem, ChaplyginSleigh, Forced, Friction, Gravity, NormalForm, SuslovTop

KINDS = tuple(FLAT_RUNS)
"""The runs of the bodies that have a kernel for the page; of a continuous motion where there is no closed form."""

_WIDE_KINDS = {"top4", "flow4"}  # which a page has alone; the others are of motions in the plane and in space


def kernel(body: str) -> bytes:
    r"""Return the WebAssembly module that runs a body, one of `KINDS`.

    Its only export is `run`, with the arguments that the functions of `nonholo.kernels.FLAT_RUNS` have; it imports a
    memory and the top of its stack.

    Raises:
        MissingExtraError: It was not compiled ahead, and the extra `compile` is not installed.

    Example:
        >>> kernel("sleigh")[:4]
        b'\x00asm'
    """
    if (file := library.place(library.name_of_module(body))) is not None:
        return file.read_bytes()
    with needs("compile", "nonholo.explore"):
        from nonholo.base.compiled import wasm
    return wasm.module(body)


MOST_STEPS = 20_000
"""Steps that the kernel of a page takes."""

MOST_STATES = 4_000
"""States that a page replays."""

_WIDE = ("J11", "J22", "J33", "J44", "J14", "J24", "J34")
_KERNELS = {("scalar", True, 1): "sleigh", ("scalar", False, 2): "top", ("secular", False, 3): "top4"}
_BEYOND = "the page takes no numbers beyond a million, and time steps from 0.000001 to 100"
_RECORDED = 100  # states that it replays where its kernel may not run: 17 kB

_TIME_STEP, _STEPS = 0.1, 400
_BODIES = {  # its numbers, those of forces, how many a momentum and a pose have, and how many of a pose have norm 1
    "top": ("J11 J12 J13 J22 J23 J33", "F1 F2 F3 x1 x2 x3 c1 c2", 2, 4, 4),
    "sleigh": ("mass inertia a", "F1 F2 x1 x2 c1 c2", 2, 4, 2),
    "top4": (" ".join(_WIDE), "", 3, 16, 0),
}
_Number = Annotated[float, Field(ge=-1e6, le=1e6)]


class _State(BaseModel):
    """The states that a page accepts, by the rules of `view/state.mjs`."""

    model_config = ConfigDict(extra="forbid", strict=True)
    kind: Literal["top", "sleigh", "forced_top", "forced_sleigh", "top4"]
    parameters: dict[str, _Number]
    momentum: list[_Number]
    pose: list[_Number]
    time_step: Annotated[float, Field(ge=1e-6, le=100.0)]
    steps: Annotated[int, Field(ge=1, le=MOST_STEPS)]
    table: str | None = None

    @model_validator(mode="after")
    def _is_one(self) -> "_State":
        own = self.kind.removeprefix("forced_")
        names, forces, numbers, entries, unit = _BODIES[own]
        keys, scale = (f"{names} {forces}", {"s"}) if own != self.kind else (names, set())
        if self.parameters.keys() - scale != {*keys.split()}:
            raise ValueError(f"parameters: must be {keys}")
        is_pose = len(self.pose) == entries and (not unit or abs(np.linalg.norm(self.pose[:unit]) - 1) <= 1e-9)
        if len(self.momentum) != numbers or not is_pose:
            raise ValueError(f"momentum must have {numbers} numbers, pose the {entries} of a pose")
        return self


def _problem(state: Any) -> str | None:
    """Return in words why a page cannot show a state; None if it can."""
    try:
        _State.model_validate(state)
    except ValidationError as failure:
        first = failure.errors()[0]
        place = "".join(f"{part}: " for part in first["loc"])
        return printable(f"{place}{first['msg'].removeprefix('Value error, ')}")
    return None


Shown: TypeAlias = tuple[dict[str, Any], str, str]  # the data of a page, its title, and a note on what is shown


def shown_motion(where: str, value: Any) -> Shown:
    """Return what a page shows of a system, a discretization or an orbit."""
    if isinstance(value, AbstractSystem):
        value = discretize(cast(Any, value), _TIME_STEP)
    if isinstance(value, Discretization):
        return _of_discretization(where, value)
    orbit = any_orbit(where, value)
    if not orbit.has_poses or not len(orbit):
        got = "reconstruct=False" if len(orbit) else "no state"
        raise error(where, "have poses", got, "Run with reconstruct=True, from a start that has a real branch.")
    return (_live(orbit) if isinstance(orbit, Orbit) else None) or _replay(orbit)


def _of_discretization(where: str, discrete: Discretization) -> Shown:
    if (kind := _kind(discrete)) is None:
        demand = "be a top with n = 3 or 4 or a sleigh in the plane, of order 2"
        raise error(where, demand, shown(discrete.system), "Run it, and pass the orbit: a page replays any.")
    system = discrete.system
    lower = np.linalg.cholesky(system.canonical.constrained_inertia)
    table, momentum = _table(system, kind, 0), lower @ np.array([0.4, -0.9, 0.3])[: len(lower)] * lower[0, 0]
    steps = min(_STEPS, len(system.table)) if table else _STEPS  # type: ignore[union-attr]
    state = _state(discrete, kind, momentum, system.group.pose_from_matrix(system.group.identity), steps, table)
    if not len(orbit := _run(state, table)) and (problem := _problem(state)):
        raise error(where, "be a motion that the page can show", problem, "Run it, and pass the orbit.")
    return _shown_state(system, orbit, state, table)


def _live(orbit: Orbit) -> Shown | None:
    """Return the state that a kernel of the page starts from; None where there is no kernel for it."""
    discrete: Any = orbit.motion
    has_map = isinstance(discrete, Discretization) and orbit.branch == "principal" and not orbit.has_impacts.any()
    kind = _kind(discrete) if has_map else None
    if kind is None or orbit.canonical_pose is None or (step_count := int(orbit.step[-1] - orbit.step[0])) < 1:
        return None
    steps = min(step_count, MOST_STEPS)
    table = _table(orbit.system, kind, orbit.step[0])
    state = _state(discrete, kind, orbit.reduced_momentum[0], orbit.canonical_pose[0], steps, table)
    cut = f" The first {steps:,} of {step_count:,} steps." if steps < step_count else ""
    return _shown_state(orbit.system, orbit, state, table, cut)


def _shown_state(system: AbstractSystem, orbit: Orbit, state: dict[str, Any], table: Any, cut: str = "") -> Shown:
    """Return what a page runs from a state, or a replay where the numbers of the state are too large or too small."""
    if _problem(state):
        return _replay(orbit, _BEYOND)
    preview = replay(orbit, spread(orbit, _RECORDED))[0] if len(orbit) else None
    data = {"kind": state["kind"], "state": state, "recorded": preview, "table": table}
    return data, _name(system), _frame_note(system) + cut


def _kind(discrete: Discretization) -> str | None:
    """Return the kernel of a discretization, which runs in canonical axes, for n = 4 in principal ones; or None."""
    system, form = discrete.system, discrete.system.inside.normal_form
    if form is None or discrete.order != 2 or form.frame is not None or np.any(form.offset) or _forces(system) is None:
        return None
    if form.frame_map is not None and not form.is_sleigh:
        return None
    kind = "forced_" * system.is_forced + _KERNELS.get((discrete.route_name, form.is_sleigh, len(form.coupling)), "")
    return kind if kind in KINDS else None


def _forces(system: AbstractSystem) -> dict[str, float] | None:
    """Return the numbers of the forces, none of a free body; None where no page computes them."""
    return force_numbers(cast(Forced, system)) if system.is_forced else {}


def _table(system: Any, kind: str, first: int) -> dict[str, Any] | None:
    """Return the table of forces from a step on, with a name by which a state can call it; None without one."""
    if not system.is_forced or system.table is None:
        return None
    content = np.asarray(system.table)[first : first + MOST_STEPS + 1].astype("<f8").tobytes()
    name = hashlib.sha256(content).hexdigest()[:12]
    return {"body": kind.removeprefix("forced_"), "name": name, "rows": base64.b64encode(content).decode()}


def _parameters(system: AbstractSystem) -> dict[str, float]:
    form = cast(NormalForm, system.inside.normal_form)
    if form.is_sleigh:
        names = {"mass": form.mass, "inertia": form.stiffness[0, 0], "a": form.arm}
    elif not form.is_planar:
        axes = form.principal[1]
        across = form.across if axes is None else np.diag(axes.T @ form.across @ axes)
        names = dict(zip(_WIDE, (*across, form.along, *form.to_principal(form.coupling)), strict=True))
    else:
        A, d, c = np.asarray(form.across), form.along, form.coupling
        names = {"J11": A[0, 0], "J12": A[0, 1], "J22": A[1, 1], "J13": c[0], "J23": c[1], "J33": d}
    return {name: float(value) for name, value in (names | (_forces(system) or {})).items()}


def _state(discrete: Discretization, kind: str, momentum: Array, pose: Array, steps: int, table: Any) -> dict[str, Any]:
    form = cast(NormalForm, discrete.system.inside.normal_form)
    if kind == "top4" and form.principal[1] is not None:  # a matrix with rows of the pose turned, its last column stays
        momentum, g = form.to_principal(momentum), pose.reshape(4, 4)
        pose = np.column_stack([g[:, :3] @ form.principal[1], g[:, 3]]).ravel()
    numbers = {"momentum": [float(r) for r in momentum], "pose": [float(x) + 0.0 for x in pose]}
    run = {"time_step": float(discrete.time_step), "steps": steps} | ({} if table is None else {"table": table["name"]})
    return {"kind": kind, "parameters": _parameters(discrete.system), **numbers, **run}


def simulate_state(where: str, state: Any, table: dict[str, Any] | None = None) -> Orbit:
    """Return the motion of a state, which may come from a page and be anything, under the table of that page."""
    problem = "a replay" if state is None else _problem(state)
    if problem is None and (state or {}).get("table") not in (None, table and table["name"]):
        problem = "a motion under another table of forces"
    if problem:
        remedy = "Use the orbit you passed, or make the page again."
        raise error(where, "begin at a state that the page can show", problem, remedy)
    return _run(state, table)


def _run(state: Any, table: dict[str, Any] | None) -> Orbit:
    """Return the motion of a state."""
    steps, (body, pose) = state["steps"], _body_and_pose(state)
    rows = table_of(table, steps)
    body = under_forces(body, state["parameters"], rows) if state["kind"].startswith("forced") else body
    start = {"momentum": state["momentum"], "configuration": pose}
    return simulate(discretize(body, state["time_step"]), **start, steps=steps, throw=False)


def _body_and_pose(state: dict[str, Any]) -> tuple[Any, Any]:
    """Return the body of a state, and its first pose as a matrix."""
    p, (w, *xyz) = state["parameters"], state["pose"]
    if state["kind"] == "top4":
        numbers = [p[name] for name in _WIDE]
        return SuslovTop.arrowhead(numbers[:4], numbers[4:]), np.reshape(state["pose"], (4, 4))
    if state["kind"].endswith("top"):
        rows = [[p[f"J{min(i, j)}{max(i, j)}"] for j in (1, 2, 3)] for i in (1, 2, 3)]
        return SuslovTop(rows), matrix_from_quaternion(np.array([w, *xyz]))
    sine, x, y = xyz
    return ChaplyginSleigh(p["mass"], p["inertia"], p["a"]), [[w, -sine, x], [sine, w, y], [0.0, 0.0, 1.0]]


def _name(system: AbstractSystem) -> str:
    if system.is_forced:
        return f"{_name(system.inside)}, under forces"
    words = re.findall("[A-Z][a-z]+|[A-Z]+(?![a-z])", type(system).__name__)
    name = " ".join([words[0], *(word.lower() for word in words[1:])])
    return name if system.normal_form is not None and system.normal_form.is_planar else f"{name}, {system.group}"


def _frame_note(system: AbstractSystem) -> str:
    is_turned = system.canonical is not system and np.any(system.frame != np.eye(len(system.frame)))
    form = system.inside.normal_form
    axes = None if form is None or form.is_planar else form.principal[1]
    if axes is not None and np.any(axes != np.eye(len(axes))):
        return "Shown in the principal axes of the constrained inertia, with the forbidden axis as the last one."
    return "Shown in the canonical body frame: its last axis is the forbidden one, or b = 0." if is_turned else ""


def _replay(orbit: AbstractOrbit, why: str = "there is no kernel in the page for this motion") -> Shown:
    states = spread(orbit, MOST_STATES)
    numbers, forces = replay(orbit, states)
    names = [f"p({name})" for name in orbit.coordinates[:2]] or ["r\u2081", "r\u2082"]
    data = {"kind": "replay", "replay": numbers, "momenta": names}
    part = f" {len(states):,} of {len(orbit):,} saved states." if len(states) < len(orbit) else ""
    note = f"A replay of numbers from Python: {why}.{part}{forces}"
    return data, _name(orbit.system) if isinstance(orbit, Orbit) else orbit.system.name, note


def force_numbers(forced: Forced) -> dict[str, float] | None:
    """Return F, the point x, the two coefficients c along the constraint and the scale s of a table.

    None of forces that no page computes.

    A page computes constant weights, and friction whose matrix is diagonal, in the user's own axes.
    """
    friction, n = forced.friction, forced.group.point_size
    gravity = forced.gravity or Gravity(np.zeros(n), np.zeros(n))
    coefficients = np.zeros(2) if friction is None else friction.coefficients
    if coefficients.ndim > 1 or not _is_plain(forced):
        return None
    rows = {"F": gravity.force, "x": gravity.point, "c": coefficients[:2]}
    numbers = {f"{name}{i}": float(x) for name, row in rows.items() for i, x in enumerate(row, 1)}
    return numbers if forced.table is None else {**numbers, "s": 1.0}


def _is_plain(forced: Forced) -> bool:
    """Return whether a weight is the only potential, no function acts, and the body has the canonical axes."""
    others = forced.scheme == "variational" or forced.slips or (forced.terms and forced.gravity is None)
    return not (forced.needs_function or others) and np.array_equal(forced.system.frame, forced.group.identity)


def under_forces(system: AbstractSystem, numbers: Mapping[str, float], rows: Float[np.ndarray, "K dim"]) -> Forced:
    """Return the system under the forces of a page, which acts without those that are zero; rows: its table."""
    F, x, c = ([numbers[f"{name}{i}"] for i in (1, 2, 3) if f"{name}{i}" in numbers] for name in "Fxc")
    weight, scale = Gravity(F, x) if any(F) else None, number("Page.orbit()", numbers.get("s", 0.0))
    forces = [Friction([*c, 0.0])] * any(c) + [scale * rows] * bool(scale)
    return Forced(system, weight, forces[0] if len(forces) == 1 else tuple(forces) or None)


def table_of(table: dict[str, Any] | None, least: int) -> Float[np.ndarray, "K dim"]:
    """Return the rows of a page's table, and after the last one as many that are zero as are missing from a number."""
    rows = np.zeros((0, 3)) if table is None else np.frombuffer(base64.b64decode(table["rows"]), "<f8").reshape(-1, 3)
    return np.concatenate([rows, np.zeros((max(0, least - len(rows)), 3))])


_BALL = {"ball": True}


def spread(orbit: AbstractOrbit, most: int) -> Int[np.ndarray, "L"]:
    """Return at most this many states, evenly over an orbit."""
    return np.unique(np.linspace(0, len(orbit) - 1, min(len(orbit), most)).round().astype(np.int64))


def replay(orbit: AbstractOrbit, states: Int[np.ndarray, "L"]) -> tuple[dict[str, Any], str]:
    """Return what a page replays of some states, and a note on their energy."""
    part = orbit.chosen(states) if len(states) < len(orbit) else orbit
    energy, forces = _energy(orbit)
    momenta = np.pad(part.restricted_momentum, ((0, 0), (0, 2)))[:, :2]
    arrays = {"time": part.time, "energy": energy[states], "frames": _frames(part), "momentum": momenta}
    if orbit.coordinates:
        arrays["coordinates"] = part.configuration
    numbers = {name: _base64(each, "<f8") for name, each in arrays.items()}
    return {**numbers, "names": orbit.coordinates, "drawing": _drawing(part), "outcome": int(orbit.outcome)}, forces


def _base64(numbers: Any, kind: str) -> str:
    return base64.b64encode(np.asarray(numbers).astype(kind).tobytes()).decode()


def _energy(orbit: AbstractOrbit) -> tuple[Float[np.ndarray, "K"], str]:
    """Return the energy, under forces less their work and from its largest value on, and a note on that."""
    if not (work := np.nan_to_num(orbit.known_work)).any():
        return orbit.energy, ""
    left = orbit.energy - orbit.energy[0] - work
    return np.abs(orbit.energy).max() + left, " The energy is shown less the work of forces, from its largest value on."


def _drawing(orbit: AbstractOrbit) -> dict[str, Any]:
    """Return what is drawn at each pose: the corners of flat parts in body axes, a box, a ball; nothing but axes else.

    Corners that are the same in all states are there once.
    """
    if orbit.coordinates:
        return _outlines([orbit.system.parts(q) for q in orbit.configuration] if orbit.system.heading else [()])
    if not isinstance(orbit, Orbit):
        return _BALL if orbit.space.is_affine else {}
    if orbit.space == SE(2):
        return _outlines([plate(orbit.system)])
    boxes: dict[Any, Any] = {SO(3): box_in_sphere, SE(3): box_in_space}
    body = boxes[orbit.space](orbit.system)._asdict() if orbit.space in boxes else {"half": np.array(np.inf)}
    return {"box": {name: x.tolist() for name, x in body.items()}} if np.isfinite(body["half"]).all() else {}


def _outlines(bodies: list[Any]) -> dict[str, Any]:
    sizes = [len(part) for part in bodies[0]]
    if not sizes or any([len(part) for part in parts] != sizes for parts in bodies):
        return _BALL
    rows = np.array([np.concatenate(parts) for parts in bodies])
    rows = rows[:1] if (rows == rows[0]).all() else rows
    return {"sizes": sizes, "rows": len(rows), "corners": _base64(rows, "<f4")}


def _frames(orbit: AbstractOrbit) -> Float[np.ndarray, "K 12"]:
    """Return for each state an origin and three axes in space, of which those that are not known are zero.

    In coordinates: the place, or the first two of them, one with its rate; axes along the heading. On a group: of the
    pose, of a sleigh of its blade, the first two axes and the last, in three coordinates.
    """
    frames = np.zeros((len(orbit), 4, 3))
    (_set_coordinates if orbit.coordinates else _set_poses)(frames, orbit)
    return frames.reshape(len(orbit), 12)


def _set_poses(frames: Float[np.ndarray, "K 4 3"], orbit: AbstractOrbit) -> None:
    g, group = orbit.configuration, orbit.space
    if group == SE(2) and isinstance(orbit, Orbit) and (blade := blade_axes(orbit.system.inside)) is not None:
        g = g @ blade
    n = group.point_size
    axes = g[:, :n, :n].transpose(0, 2, 1)[:, [0, 1, n - 1] if n > 2 else list(range(n)), :3]
    frames[:, 1 : 1 + axes.shape[1], : axes.shape[2]] = axes
    places = g[:, :n, n:].transpose(0, 2, 1)[..., :3]  # none where matrices do not move a point of their own
    frames[:, : places.shape[1], : places.shape[2]] = places
    if n == 2:
        frames[:, 3, 2] = 1.0


def _set_coordinates(frames: Float[np.ndarray, "K 4 3"], orbit: AbstractOrbit) -> None:
    names, q = orbit.coordinates, orbit.configuration
    places = [name for name in "xyz" if name in names]
    if places[:2] == ["x", "y"]:
        frames[:, 0, : len(places)] = q[:, [names.index(name) for name in places]]
    else:
        frames[:, 0, :2] = np.hstack([q, orbit.body_velocity])[:, :2]
    if orbit.system.heading is not None:
        heading = q[:, names.index(orbit.system.heading)]
        frames[:, 1, 0] = frames[:, 2, 1] = np.cos(heading)
        frames[:, 1, 1], frames[:, 2, 0] = np.sin(heading), -np.sin(heading)
        frames[:, 3, 2] = 1.0


_HEIGHT = 760  # pixels in a notebook


@dataclasses.dataclass(frozen=True, repr=False)
class Page(Keeper):
    """A live page; in a notebook it shows itself, and with anywidget its sliders are heard in Python.

    Attributes:
        text: The whole of it, HTML in ASCII.
        first_state: Body, start and time step with which it opens; None for a replay.
        table: The table of forces that it carries, as in its data; None without one.
    """

    text: str
    first_state: dict[str, Any] | None = None
    table: dict[str, Any] | None = None

    def __repr__(self) -> str:
        return f"<Page of {len(self.text) / 1e3:.0f} kB>"

    def _repr_html_(self) -> str:
        permissions = "allow-scripts allow-downloads allow-modals"
        look = f"width:100%;height:{_HEIGHT}px;border:0"
        about = f'sandbox="{permissions}" style="{look}" title="The live page of nonholo"'
        return f'<iframe {about} srcdoc="{html.escape(self.text, quote=True)}"></iframe>'

    def _repr_mimebundle_(self, **_: Any) -> Any:
        if self.widget is None:
            return {}
        data, about = self.widget._repr_mimebundle_()
        return {**data, "text/plain": repr(self)}, about

    @functools.cached_property
    def widget(self) -> Any:
        """The page as a widget, as `mo.ui.anywidget(page.widget)` takes it in marimo; None without anywidget."""
        try:
            from nonholo.explorer._widget import PageWidget
        except ModuleNotFoundError:  # without anywidget
            return None
        return PageWidget(text=self.text, height=_HEIGHT, state=self.first_state or {})

    @property
    def state(self) -> dict[str, Any] | None:
        """Body, start and time step that the page shows now: the last that its sliders in a notebook said."""
        widget = vars(self).get("widget")  # there is one when a notebook has shown the page
        return self.first_state if widget is None or self.first_state is None else dict(widget.state)

    def orbit(self) -> Orbit:
        """Return the motion that the page shows now, computed here: in a notebook that of its sliders.

        Raises:
            ValueError: A replay, whose orbit was passed to `explore`; a state that is no body's.

        Example:
            >>> nh.explore(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5)).orbit()
            <Orbit of ChaplyginSleigh: 401 states, time 0 to 40, successful>
        """
        return simulate_state("Page.orbit()", self.state, self.table)

    def save(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write the page to a new file.

        Raises:
            FileExistsError: The path exists, and is not to be replaced.
        """
        where = "Page.save(path=...)"
        flags("Page.save", overwrite=overwrite)
        target = checked_path(where, path)
        check_file(target, overwrite=overwrite, where=where)
        with new_file(target, overwrite=overwrite) as file:
            file.write(self.text)

    def open(self) -> Path:
        """Write the page to a temporary file, open it in the browser, and return the file."""
        path = Path(tempfile.mkdtemp(prefix="nonholo-")) / "page.html"
        self.save(path)
        webbrowser.open(path.as_uri())
        return path


def explore(value: Any) -> Page:
    """Return the live page of a motion: one file that runs the library's own kernel in the browser.

    Tops with n = 3 and sleighs in the plane, also under `Gravity`, `Friction` and a table of forces, and tops with
    n = 4 run there with the very numbers of `nh.simulate`; sliders change the body, the forces, the start and the time
    step. Any other orbit is replayed from its numbers, and the page names this. It fetches nothing, and its content
    security policy lets nothing run in it but its own view.

    Args:
        value: A system, what `discretize` returned, or an orbit with poses.

    Raises:
        ValueError: Something else, an orbit without poses, a system without a kernel for the page.

    Example:
        >>> page = explore(nh.ChaplyginSleigh(mass=1.0, inertia=1.0, a=0.5))
        >>> page.save("sleigh.html")  # doctest: +SKIP
        >>> page.text.count("<script")
        2
    """
    data, title, note = shown_motion("explore(value=...)", value)
    return Page(page_text(data, title, note, version("nonholo")), data.get("state"), data.get("table"))


def orbit_to_html(orbit: Any, path: str | Path, *, overwrite: bool = False) -> None:
    """Write the live page of an orbit to a new file; see `explore`."""
    where = "Orbit.to_html(path=...)"
    check_file(checked_path(where, path), overwrite=overwrite, where=where)
    explore(orbit).save(path, overwrite=overwrite)


def page_text(data: dict[str, Any], title: str, note: str, version: str) -> str:
    """Return the text of a page, in ASCII; what it is given is escaped, and data cannot end their element."""
    outcomes = {int(outcome): (outcome.name, outcome.message) for outcome in Outcome}
    beside = [kind for kind in KINDS if (kind in _WIDE_KINDS) == (data["kind"] in _WIDE_KINDS)]
    modules = {} if "replay" in data else {kind: kernel(kind) for kind in beside}
    kernels = {kind: base64.b64encode(gzip.compress(each, mtime=0)).decode() for kind, each in modules.items()}
    content = {**data, "title": title, "library": version, "outcomes": outcomes, "kernels": kernels}
    text = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    script, style = _text("view.js"), _text("style.css")
    parts = {"data": text, "licence": _text("three-LICENSE.txt"), "note": note, "title": title, "version": version}
    parts |= {"script": script, "script_hash": _hash(script), "style": style, "style_hash": _hash(style)}
    whole = jinja2.Environment(autoescape=True).from_string(_text("page.html")).render(parts)
    return whole.encode("ascii", "xmlcharrefreplace").decode()


@functools.cache
def _text(name: str) -> str:
    return (Path(__file__).with_name("view") / name).read_text("utf-8")


def _hash(text: str) -> str:
    """Return how a content security policy names a text."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"
