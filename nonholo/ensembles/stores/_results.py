"""The result of a task, checked and named; a task that raises is asked again for halves, until who fails is known."""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from nonholo.base.checks import error
from nonholo.base.results import Outcome
from nonholo.ensembles._block import MemberBlock
from nonholo.ensembles._names import OUTCOME, array_name

ABSENT, RAISED = -128, 100
"""Outcomes of members that are not computed yet, and for which the task raised; the others are those of `Outcome`."""
_MOST_MESSAGES = 20  # failures of a block whose messages are kept
_PROBES = 8

Task: TypeAlias = Callable[[MemberBlock], Any]


@dataclasses.dataclass(frozen=True)
class Output:
    """One array of the result.

    Attributes:
        dimensions: Names of its axes but for those of the members.
        shape: Their lengths.
        dtype: Type of the numbers on disk.
        attributes: Its attributes in the store.
    """

    dimensions: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: str
    attributes: dict[str, Any]

    @property
    def fill(self) -> Any:
        """The entry where there is no number."""
        kind = np.dtype(self.dtype)
        return np.nan if kind.kind in "fc" else np.iinfo(kind).min if kind.kind == "i" else np.iinfo(kind).max


class Results(NamedTuple):
    """Arrays of a block by name, and the first few members for which the task raised, with the messages."""

    arrays: dict[str, np.ndarray]
    messages: list[tuple[int, str]]


def attempt(task: Task, block: MemberBlock, outputs: dict[str, Output]) -> Results:
    """Run a task; members for which it raises have no numbers and the outcome `RAISED`."""
    try:
        return Results(_check(_entries(task(block), block.count), outputs, block.count), [])
    except Exception as failure:
        if block.count == 1:
            return Results(_nothing(outputs), [(block.first, f"{type(failure).__name__}: {failure}")])
    middle = block.count // 2
    halves = [attempt(task, part, outputs) for part in (block.part(0, middle), block.part(middle, block.count))]
    arrays = {name: np.concatenate([half.arrays[name] for half in halves]) for name in outputs}
    return Results(arrays, (halves[0].messages + halves[1].messages)[:_MOST_MESSAGES])


def probe_outputs(task: Task, block_at: Callable[[int, int], MemberBlock], members: int) -> dict[str, Output]:
    """Return what a task returns, from a few members spread over the design: the first for which it does not raise.

    A task that takes two members and returns something else than two rows is refused.
    """
    first_failure = None
    for member in dict.fromkeys((members - 1) * probe // (_PROBES - 1) for probe in range(_PROBES)):
        try:
            outputs = _outputs(_entries(task(block_at(member, 1)), 1))
        except Exception as failure:
            first_failure = first_failure or failure
            continue
        _check_two(task, block_at(0, min(2, members)), outputs)
        return outputs
    got = f"{type(first_failure).__name__} for the first: {str(first_failure).rstrip('.')}"
    raise error("sweep(task=...)", "run for one of the members tried", got, "Mend the design.") from first_failure


def _check_two(task: Task, block: MemberBlock, outputs: dict[str, Output]) -> None:
    """Refuse a task that is wrong for blocks, which would be done member by member and take long."""
    try:
        own = task(block)
    except Exception:  # of some members: these are found when it runs
        return
    _check(_entries(own, block.count), outputs, block.count)


def _outputs(entries: dict[str, Any]) -> dict[str, Output]:
    outputs = {name: _output(*entry) for name, entry in entries.items()}
    labels = {"long_name": "how the member ended", **flags()}
    return {**outputs, OUTCOME: Output((), (), "int8", labels)}


def flags() -> dict[str, Any]:
    """Return the values of outcomes and what they mean, as CF conventions write flags."""
    meanings = {ABSENT: "absent", **{int(code): code.name for code in Outcome}, RAISED: "raised"}
    return {"flag_values": list(meanings), "flag_meanings": " ".join(meanings.values())}


def _output(dimensions: tuple[str, ...], rows: np.ndarray, attributes: dict[str, Any]) -> Output:
    return Output(dimensions, rows.shape[1:], _type_on_disk(rows), attributes)


def _type_on_disk(rows: np.ndarray) -> str:
    return {"b": "int8", "i": "int64", "u": "uint64", "c": "complex128"}.get(rows.dtype.kind, "float64")


def _entries(result: Any, count: int) -> dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, Any]]]:
    """Return dimensions, rows and attributes of all that a task returned, by name."""
    if not isinstance(result, Mapping):
        result = {"result": result}
    return {array_name("task(...)", name): _entry(name, value, count) for name, value in result.items()}


def _entry(name: str, value: Any, count: int) -> tuple[tuple[str, ...], np.ndarray, dict[str, Any]]:
    dimensions, value, *rest = value if isinstance(value, tuple) else (None, value)
    rows = _rows(name, value, count)
    if dimensions is None:
        dimensions = [f"{name}_{axis}" for axis in range(1, rows.ndim)]
    if len(dimensions) != rows.ndim - 1:
        got = f"{len(dimensions)} dimensions for shape {rows.shape}"
        raise error(f"task(...)[{name!r}]", "name each axis but the first", got, "Name them.")
    return tuple(dimensions), rows, dict(rest[0]) if rest else {}


def _rows(name: str, value: Any, count: int) -> np.ndarray:
    """Return one row for each member."""
    rows = np.asarray(value)
    if rows.dtype.kind not in "biufc":
        remedy = "Return numbers."
        raise error(f"task(...)[{name!r}]", "be an array of numbers", f"dtype {rows.dtype}", remedy)
    if rows.ndim == 0 or len(rows) != count:
        got = f"shape {rows.shape} for {count} members"
        raise error(f"task(...)[{name!r}]", "have a leading member axis", got, "Keep that axis.")
    if name == OUTCOME:
        rows = _codes(rows)
    if 0 in rows.shape[1:]:
        raise error(f"task(...)[{name!r}]", "hold numbers", f"shape {rows.shape}", "Leave it out.")
    return rows


def _codes(rows: np.ndarray) -> np.ndarray:
    """Return the outcomes that a task gives its members."""
    if rows.ndim != 1 or rows.dtype.kind not in "biu" or not ((rows > ABSENT) & (rows < -ABSENT)).all():
        got = f"{rows.dtype} of shape {rows.shape}, such as {rows.flat[0]}"
        raise error(f"task(...)[{OUTCOME!r}]", "be a number from -127 to 127 of each member", got, "Number them so.")
    return rows.astype(np.int8)


def _check(entries: dict[str, Any], outputs: dict[str, Output], count: int) -> dict[str, np.ndarray]:
    """Return the rows of a block as they are written, refused if they are not what the first members had."""
    rows_by_name = {name: rows for name, (_, rows, _) in entries.items()}
    rows_by_name.setdefault(OUTCOME, np.zeros(count, dtype=np.int8))
    if rows_by_name.keys() != outputs.keys():
        got = f"{sorted(rows_by_name)} instead of {sorted(outputs)}"
        raise error("task(...)", "return the same names for all members", got, "Return them always.")
    for name, rows in rows_by_name.items():
        if rows.shape[1:] != outputs[name].shape:
            got = f"{rows.shape[1:]} instead of {outputs[name].shape}"
            raise error(f"task(...)[{name!r}]", "have one shape for all members", got, "Pad it with NaN.")
        if not (name == OUTCOME or np.can_cast(_type_on_disk(rows), outputs[name].dtype)):
            got = f"{rows.dtype} after {outputs[name].dtype}"
            raise error(f"task(...)[{name!r}]", "have one type for all members", got, "Return floats always.")
    return {name: rows_by_name[name].astype(output.dtype) for name, output in outputs.items()}


def _nothing(outputs: dict[str, Output]) -> dict[str, np.ndarray]:
    arrays = {name: np.full((1, *output.shape), output.fill, output.dtype) for name, output in outputs.items()}
    arrays[OUTCOME][:] = RAISED
    return arrays
