"""What a store says of itself, checked as data when it is read: types, ranges, names, and a checksum of what it is."""

import errno
import hashlib
import json
import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    Json,
    NonNegativeInt,
    ValidationError,
    model_validator,
)

from nonholo._checks import error, printable
from nonholo._limits import within_memory
from nonholo._results import Outcome

_DESCRIBED = ("system", "parameters", "motion", "save_every", "branch", "precision", "events", "sweep")
_MOST = 2**53
TAKEN = ("run", "zarr.json")
"""Names in a store that no array has."""

Positive = Annotated[int, Field(gt=0, le=_MOST, strict=True)]
Text = Annotated[str, AfterValidator(printable)]


def is_array_name(name: str) -> bool:
    """Tell whether an array of a store can be called so: by a file in it, and by none that has another use."""
    return bool(name) and not set("/\\\0") & set(name) and not name.startswith((".", "_")) and name not in TAKEN


def _name(text: str) -> str:
    """Return the name of an array: one that no file outside the store has."""
    if not is_array_name(text.removeprefix("canonical/")):
        raise ValueError(f"{text!r} is no name of an array")
    return text


Name = Annotated[str, AfterValidator(_name)]
Shape = list[Annotated[NonNegativeInt, Field(le=_MOST)]]


class _Data(BaseModel):
    model_config = ConfigDict(extra="ignore")


class _Run(_Data):
    steps: Positive
    rows: Positive
    reconstruct: bool


class OrbitMetadata(_Data):
    """The attributes of the store of an orbit."""

    system: str
    parameters: Json[dict[str, Any]]
    motion: Json[dict[str, Any]]
    save_every: Positive
    arrays: Json[dict[Name, Annotated[Shape, Field(min_length=1)]]]
    versions: Json[dict[str, Text]]
    branch: str = "principal"
    outcome: Literal[tuple(Outcome.__members__)] | None = None  # type: ignore[valid-type]
    run: Json[_Run] | None = None
    events: Json[list[dict[str, Any]]] | None = None
    crossings: Json[list[NonNegativeInt]] | None = None

    @model_validator(mode="after")
    def _have_one_length(self) -> "OrbitMetadata":
        if "time" not in self.arrays or len({shape[0] for shape in self.arrays.values()}) != 1:
            raise ValueError("arrays: must have one length, that of time")
        if not any("kind" in described for described in (self.motion,)):
            raise ValueError("motion: must have a kind")
        return self


class _Sweep(_Data):
    task: dict[str, Any]
    design: dict[str, Any]
    layout: tuple[list[Positive], list[Positive]]
    outputs: dict[Name, tuple[list[str], Shape, Annotated[str, Field(pattern=r"^[a-z]+[0-9]*$")], dict[str, Any]]]

    @model_validator(mode="after")
    def _is_cut_in_blocks(self) -> "_Sweep":
        sizes, chunk = self.layout
        if not sizes or len(sizes) != len(chunk) or any(map(int.__gt__, chunk, sizes)) or math.prod(sizes) > _MOST:
            raise ValueError("layout: must cut members into blocks")
        members = self.design.get("members", math.prod(sizes))
        if members != math.prod(sizes):
            raise ValueError(f"design.members: must be {math.prod(sizes)}, as in the layout")
        for name in (*self.design.get("axes", ()), *self.design.get("distributions", ())):
            _name(name)
        return self


class SweepMetadata(_Data):
    """The attributes of the store of a sweep."""

    made: str
    finished: bool
    sweep: Json[_Sweep]
    versions: Json[dict[str, Text]]


def checksum(stored: dict[str, Any]) -> str:
    """Return the SHA-256 of what is moved and how: all that another body, motion or task would change."""
    described = {name: stored[name] for name in _DESCRIBED if name in stored}
    run = json.loads(stored.get("run", "{}"))
    described["run"] = {name: run[name] for name in ("rows", "reconstruct") if name in run}
    return hashlib.sha256(json.dumps(described, sort_keys=True).encode()).hexdigest()


def check_metadata(where: str, path: str, stored: dict[str, Any], kind: type[BaseModel]) -> None:
    """Refuse attributes that a store of ours does not have; the message names each.

    Raises:
        ValueError: An attribute is missing, of another type or out of range; the checksum is another one; a chunk of an
            array would not fit into memory.
    """
    remedy = "The store is damaged or was edited: copy it again from its source, or run it again."
    try:
        kind.model_validate(stored)
        differs = stored.get("checksum", checksum(stored)) != checksum(stored)
    except (ValidationError, RecursionError, TypeError, AttributeError) as failure:
        raise error(where, "hold sound attributes", f"'{path}', in which {_problems(failure)}", remedy) from None
    scenario = stored.get("scenario")
    if scenario is not None and hashlib.sha256(str(scenario).encode()).hexdigest() != stored.get("scenario_sha256"):
        raise error(where, "hold the scenario that was run", f"'{path}', whose scenario_sha256 differs", remedy)
    if differs:
        raise error(where, "hold the motion that it was made with", f"'{path}', whose checksum differs", remedy)


def require_identity(path: Path, made: str | None) -> None:
    """Refuse to go on writing where another store has taken the place of the one that was opened.

    Raises:
        OSError: There is another store, or none.
    """
    try:
        found = json.loads((path / "zarr.json").read_text())["attributes"].get("made")
    except (OSError, ValueError, KeyError, AttributeError):
        found = "none"
    if found != made:
        reason = "Another store has taken the place of the one that was being written; nothing of it was changed"
        raise OSError(errno.ESTALE, reason, str(path))


def check_chunk(where: str, name: str, chunk: tuple[int, ...]) -> None:
    """Refuse an array of which a chunk does not fit into memory."""
    within_memory(where, 8.0 * math.prod(map(float, chunk)), f"The array {name} is damaged or was edited.")


def _problems(failure: Exception) -> str:
    if not isinstance(failure, ValidationError):
        return printable(str(failure))
    problems = failure.errors()[:5]
    places = [".".join(map(str, problem["loc"])) or "they" for problem in problems]
    reasons = [problem["msg"].removeprefix("Value error, ") for problem in problems]
    return printable("; ".join(f"{place}: {reason}" for place, reason in zip(places, reasons, strict=True)))
