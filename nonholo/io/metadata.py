"""The metadata of a store, checked as data when it is read: types, ranges, names, and a checksum of what it is."""

import errno
import hashlib
import json
import math
import unicodedata
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, Literal

import zarr
from pydantic import AfterValidator, BaseModel, Field, Json, NonNegativeInt, ValidationError, model_validator

from nonholo.base.checks import error, is_name, shown, within_memory
from nonholo.base.results import Outcome
from nonholo.io.places import FORMAT, SCHEMAS, SWEEP_FORMAT, WHERE, attribute_of, check_assertions
from nonholo.io.provenance import attributes_of_text, problems_in

_MOST, _MOST_CHUNKS, _HIGHEST = 2**53, 2**26, 9
TAKEN = frozenset({"run"})
"""Names in a store that no array has."""

Positive = Annotated[int, Field(gt=0, le=_MOST, strict=True)]


def _name(text: str) -> str:
    """Return what is a name, also of an array within a group of ours."""
    if not is_name(plain := text.removeprefix("canonical/")) or plain in TAKEN:
        raise ValueError(f"{shown(text)} is no name: a letter, then letters, digits and underscores, all ASCII")
    return text


Name = Annotated[str, AfterValidator(_name)]
"""A name that becomes a column, a dimension, a file or a variable; the classes ask `is_name` too."""
Shape = list[Annotated[NonNegativeInt, Field(le=_MOST)]]


class _About(BaseModel):
    format: str
    schema_: Annotated[int, Field(alias="schema", strict=True)]
    versions: Json[dict[str, str]]
    kernels: str | None = None
    made: str
    scenario: str | None = None
    scenario_sha256: str | None = None


class _Run(BaseModel):
    steps: Positive
    rows: Positive
    reconstruct: bool
    lead: Literal[0, 1]
    added: Positive | None = None


class OrbitMetadata(_About):
    """The attributes of the store of an orbit."""

    system: str
    parameters: Json[dict[str, Any]]
    motion: Json[dict[str, Any]]
    save_every: Positive
    arrays: Json[dict[Name, Annotated[Shape, Field(min_length=1)]]]
    branch: str
    precision: str
    conventions: str
    outcome: Literal[tuple(Outcome.__members__)] = None  # type: ignore[valid-type]
    run: Json[_Run] | None = None
    events: Json[list[dict[str, Any]]] | None = None
    crossings: Json[list[NonNegativeInt]] | None = None
    stopped_by: str | None = None

    @model_validator(mode="after")
    def _have_one_length(self) -> "OrbitMetadata":
        if "time" not in self.arrays or len({shape[0] for shape in self.arrays.values()}) != 1:
            raise ValueError("arrays: must have one length, that of time")
        if self.arrays.keys().isdisjoint(("canonical/reduced_momentum", "momentum")):
            raise ValueError("arrays: must have momenta")
        if "kind" not in self.motion:
            raise ValueError("motion: must have a kind")
        if self.run is None and self.outcome is None:
            raise ValueError("outcome: must stand in a store that was saved whole")
        return self


class _Sweep(BaseModel):
    task: dict[str, Any]
    design: dict[str, Any]
    layout: tuple[list[Positive], list[Positive]]
    outputs: dict[Name, tuple[list[Name], Shape, Annotated[str, Field(pattern=r"^[a-z]+[0-9]*$")], dict[str, Any]]]

    @model_validator(mode="after")
    def _is_cut_in_blocks(self) -> "_Sweep":
        sizes, chunk = self.layout
        if not sizes or len(sizes) != len(chunk) or any(map(int.__gt__, chunk, sizes)) or math.prod(sizes) > _MOST:
            raise ValueError("layout: must cut members into blocks")
        if self.design.get("members", math.prod(sizes)) != math.prod(sizes):
            raise ValueError(f"design.members: must be {math.prod(sizes)}, as in the layout")
        components = (attributes.get("components", ()) for *_, attributes in self.outputs.values())
        for name in (*self.design.get("axes", ()), *self.design.get("distributions", ()), *chain(*components)):
            _name(name)
        return self


class SweepMetadata(_About):
    """The attributes of the store of a sweep."""

    finished: bool
    sweep: Json[_Sweep]


_OURS = {field.alias or name for kind in (OrbitMetadata, SweepMetadata) for name, field in kind.model_fields.items()}


def checksum(attributes: dict[str, Any]) -> str:
    """Return the SHA-256 of all attributes that are ours; a writer of one of them writes it again."""
    ours = {name: value for name, value in attributes.items() if name in _OURS}
    return hashlib.sha256(json.dumps(ours, sort_keys=True).encode()).hexdigest()


def check_metadata(where: str, path: str, attributes: dict[str, Any], kind: type[BaseModel]) -> None:
    """Refuse attributes that a store of ours does not have; the message names each.

    Raises:
        ValueError: An attribute is missing, of another type or out of range; the checksum is another one; a text would
            control a terminal.
    """
    remedy = "The store is damaged or was edited: copy it again from its source, or run it again."
    try:
        about = kind.model_validate(attributes).model_dump()
        controls = [name for name, value in about.items() if _has_controls(value)]
        differs = attributes.get("checksum") != checksum(attributes)
    except (ValidationError, RecursionError, TypeError, AttributeError) as failure:
        raise error(where, "hold sound attributes", f"'{path}', in which {problems_in(failure)}", remedy) from None
    scenario = about["scenario"]
    if scenario is not None and attributes_of_text(scenario)["scenario_sha256"] != about["scenario_sha256"]:
        raise error(where, "hold the scenario that was run", f"'{path}', whose scenario_sha256 differs", remedy)
    if differs:
        raise error(where, "hold the attributes that it was made with", f"'{path}', whose checksum differs", remedy)
    if controls:
        got = f"'{path}', in which {controls[0]} has some"
        raise error(where, "hold texts without control characters", got, "Leave them out of names and texts.")


def _has_controls(value: Any) -> bool:
    """Return whether a text in nested data would control a terminal; lines and tabs do no harm."""
    if isinstance(value, str):
        return any(unicodedata.category(letter) == "Cc" and letter not in "\n\t" for letter in value)
    if isinstance(value, dict):
        return any(map(_has_controls, value.keys())) or any(map(_has_controls, value.values()))
    return isinstance(value, list | tuple) and any(map(_has_controls, value))


def require_identity(path: Path, identity: str) -> None:
    """Refuse to continue writing where another store has taken the place of the one that was opened.

    Raises:
        OSError: There is another store, or none.
    """
    if attribute_of(path, "made") != identity:
        reason = "Another store has taken the place of the one that was being written; nothing of it was changed"
        raise OSError(errno.ESTALE, reason, str(path))


def check_array(where: str, name: str, array: zarr.Array) -> None:
    """Refuse an array that is not cut as ours are, with chunks too large for memory, or with bytes in another order."""
    remedy, (sizes, chunks) = f"The array {name} is damaged or was edited.", (array.shape, array.chunks)
    is_ours = (len(sizes) == 2 and sizes[1] >= 2) if name.startswith("run/") else len(sizes) > 0
    is_ours = is_ours and min(chunks) >= 1  # the number of chunks of zarr itself is a float
    if not is_ours or math.prod(-(-size // chunk) for size, chunk in zip(sizes, chunks, strict=True)) > _MOST_CHUNKS:
        raise error(where, f"hold the array {name} in chunks", f"shape {sizes} in chunks of {chunks}", remedy)
    within_memory(where, 8.0 * min(math.prod(array.chunks), _MOST), remedy)
    codecs: Any = array.metadata.codecs  # type: ignore[union-attr]
    levels = [getattr(codec, "clevel", 0) for codec in codecs]
    if min(levels) < 0 or max(levels) > _HIGHEST:
        raise error(where, f"compress the array {name} by a level from 0 to {_HIGHEST}", f"{levels}", remedy)
    orders = {getattr(codec, "endian", None) for codec in codecs}
    if {getattr(order, "value", order) for order in orders} - {None, "little"}:  # an enumeration before zarr 3.4
        raise error(where, f"hold the array {name} in the order of bytes that is written", "another one", remedy)


_READERS = {FORMAT: WHERE, SWEEP_FORMAT: "load_sweep(store=...)"}
_KINDS = {FORMAT: "an orbit", SWEEP_FORMAT: "a sweep", "nonholo.ensemble": "an ensemble"}


def _another_schema(where: str, schema: int, number: Any, versions: Any) -> ValueError:
    """Return the error of a store that another version wrote."""
    got, remedy = f"schema {number}", f"Upgrade nonholo: {versions} wrote it."
    if isinstance(number, int) and number < schema:
        got += ", of before 0.3.0, from which on later versions read stores"
        remedy = f"Read it with the version that wrote it, {versions}, and save it as CSV, or repeat the run."
    return error(where, f"have schema {schema}, the one that this version reads", got, remedy)


def read_attributes(path: str | Path, format_name: str = FORMAT, where: str | None = None) -> dict[str, Any]:
    """Return the attributes of a store, after checking that they are of that format, in the schema that is read."""
    where = where or _READERS[format_name]
    check_assertions(where)
    kind = f"be a store of {_KINDS[format_name]}"
    if not Path(path).exists():
        raise FileNotFoundError(f"`{where}` must exist. Got '{path}'. Check the path; runs are kept under 'runs/'.")
    try:
        attributes = dict(zarr.open_group(Path(path), mode="r", use_consolidated=False).attrs)
    except Exception as failure:
        raise error(where, kind, f"'{path}'", f"Its metadata cannot be read: {failure}") from failure
    if attributes.get("format") != format_name:
        kind_of_store = _KINDS.get(str(attributes.get("format")))
        got = f"'{path}', " + (f"a store of {kind_of_store}" if kind_of_store else "made by another program")
        raise error(where, kind, got, "Pass a store of nonholo that is one.")
    if attributes.get("schema") != SCHEMAS[format_name]:
        raise _another_schema(where, SCHEMAS[format_name], attributes.get("schema"), attributes.get("versions"))
    check_metadata(where, str(path), attributes, OrbitMetadata if format_name == FORMAT else SweepMetadata)
    return attributes
