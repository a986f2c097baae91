"""Systems in coordinates from data: those of the literature whole, of others what was recorded beside the functions."""

import importlib
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, NonNegativeInt, ValidationError, model_validator

from nonholo.base.checks import error, names, needs

READY = "examples."
"""How stores call ready systems, before their names."""
_WHERE = "load_orbit(path=...)"


def restore_ready(name: str, parameters: dict[str, Any]) -> Any:
    """Make a ready system by the function of `nonholo.examples` that users call, which checks what it gets."""
    with needs("jax", f"load_orbit(...) of nonholo.examples.{name}"):
        ready = importlib.import_module("nonholo.examples")
    if name not in ready.__all__ or not name.islower():
        raise error(_WHERE, "hold a ready system of this version", repr(name), "Upgrade nonholo.")
    try:
        return getattr(ready, name)(**parameters).system
    except TypeError as failure:
        raise error(_WHERE, f"hold parameters of nonholo.examples.{name}", str(failure), "Upgrade nonholo.") from None


class _Recorded(BaseModel):
    """What a store knows of a system whose functions it does not hold."""

    name: str
    coordinates: Annotated[tuple[str, ...], AfterValidator(lambda several: several and names("coordinates", several))]
    orbits: Literal["CoordinateOrbit", "GroupOrbit"]
    shapes: tuple[tuple[NonNegativeInt, ...], tuple[NonNegativeInt]]
    constraints: NonNegativeInt
    is_driven: bool
    heading: str | None = None
    parameters: dict[str, Any] = {}

    @model_validator(mode="after")
    def _fit(self) -> "_Recorded":
        wanted = self.shapes[0] if self.orbits == "CoordinateOrbit" else (0,)
        if (len(self.coordinates),) != wanted or self.heading not in (None, *self.coordinates):
            raise ValueError(f"coordinates: must be {wanted[0]} names, the heading among them")
        return self


def recorded_system(kind: str, parameters: dict[str, Any], group: Any) -> Any:
    """Return what was recorded of a system, on a group if there is one, for orbits as they were computed."""
    try:
        known = _Recorded.model_validate(parameters).model_dump()
    except ValidationError as failure:
        problem = failure.errors()[0]
        got = f"{'.'.join(map(str, problem['loc']))}: {problem['msg'].removeprefix('Value error, ').rstrip('.')}"
        raise error(_WHERE, "hold what its system is", got, "It was edited: run it again.") from None
    with needs("jax", "load_orbit(...) of an orbit in coordinates"):
        room = importlib.import_module("nonholo.lagrange_dalembert")
    return room.RecordedSystem(known | ({} if group is None else {"group": group}), (kind, parameters))
