"""Motions in coordinates and on a group as stores keep them: what their orbits tell, and systems without functions."""

import dataclasses
from collections.abc import Mapping
from typing import Any, ClassVar

from nonholo.base.checks import error
from nonholo.lagrange_dalembert._orbit import AbstractCoordinateOrbit, CoordinateOrbit, GroupOrbit
from nonholo.lagrange_dalembert._room import room
from nonholo.systems import AbstractCoordinateSystem

ORBITS: dict[str, Any] = {orbit.__name__: orbit for orbit in (CoordinateOrbit, GroupOrbit)}


class CoordinateMotion:
    """A motion whose stores keep the numbers that its orbit tells."""

    system: Any
    time_step: float | None
    columns: ClassVar[tuple[str, ...]] = (
        *("time", "configuration", "displacement", "body_velocity"),
        *("momentum", "multipliers", "energy", "constraint_residual"),
    )

    def orbit(self, *, branch: str, **rows: Any) -> AbstractCoordinateOrbit:
        """Return the orbit of rows of the columns; those of multipliers that do not exist are left out.

        Raises:
            ValueError: Columns that are none of this system.
        """
        del branch
        system, last = self.system, None if self.time_step is None else -1
        if system.constraints:
            rows["multipliers"] = rows["multipliers"] if rows["multipliers"] is None else rows["multipliers"][:last]
        else:  # which is not stored
            rows["multipliers"] = rows["body_velocity"][:last, :0]
        shapes = {name: None if rows[name] is None else rows[name].shape[1:] for name in self.columns}
        if shapes != self._shapes():
            remedy = "The store was edited: copy it again from its source, or run it again."
            raise error("load_orbit(path=...)", f"hold the columns of {system.name!r}", f"shapes {shapes}", remedy)
        return ORBITS[system.orbits](**rows, system=system, time_step=self.time_step)

    def _shapes(self) -> dict[str, tuple[int, ...] | None]:
        q, v = self.system.shapes
        places = {"configuration": q, "displacement": None if self.time_step is None else q}
        rates = {"body_velocity": v, "momentum": v, "multipliers": (self.system.constraints,)}
        return {"time": (), **places, **rates, "energy": (), "constraint_residual": ()}


@dataclasses.dataclass(frozen=True, eq=False)
class CoordinateFlow(CoordinateMotion):
    """The flow of a system in coordinates or on a group, as the motion of its orbits.

    Attributes:
        system: What moves.

    Example:
        >>> from nonholo.lagrange_dalembert import CoordinateFlow
        >>> CoordinateFlow(nh.examples.particle().system).columns[:2]
        ('time', 'configuration')
    """

    system: Any
    time_step: ClassVar[None] = None
    route_name: ClassVar[None] = None


@dataclasses.dataclass(frozen=True, eq=False)
class RecordedSystem(AbstractCoordinateSystem):
    """What a store says of a system whose functions it does not hold: enough for pictures and tables.

    Attributes:
        known: Fields that could be restored, with what else was recorded.
        description: The class of the system and all of its fields, as in the store.

    Example:
        >>> from nonholo.lagrange_dalembert import RecordedSystem
        >>> system = RecordedSystem({"name": "Mine"}, ("LagrangeDAlembert", {"name": "Mine", "lagrangian": "callable"}))
        >>> system.name
        'Mine'
        >>> system.lagrangian
        Traceback (most recent call last):
        ValueError: `load_orbit(discrete=...)` must be the discretization. Got None: stores hold no functions. ...
    """

    has_functions: ClassVar[bool] = False
    known: Mapping[str, Any]
    description: tuple[str, dict[str, Any]]  # pyright: ignore[reportGeneralTypeIssues]

    def __getattr__(self, name: str) -> Any:
        """Return what was recorded; functions were not."""
        if name.startswith("__") or name == "known":  # asked by copies before there are fields
            raise AttributeError(name)
        if name not in self.known:
            remedy = "Pass the one that made the store to load_orbit, resume or extend: discrete=..."
            raise error("load_orbit(discrete=...)", "be the discretization", "None: stores hold no functions", remedy)
        return self.known[name]

    @property
    def parameters(self) -> Mapping[str, Any]:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Numbers that its functions take."""
        return self.known["parameters"]

    def parts(self, q: Any) -> tuple[()]:
        """Return no outline: it may be a function."""
        del q
        return ()

    def discretize(self, time_step: Any) -> Any:
        """Return the map of the store, which cannot run."""
        kind = "GroupDiscretization" if "group" in self.known else "CoordinateDiscretization"
        return getattr(room("_discretization"), kind)(self, time_step)

    def flow(self, **given: Any) -> Any:
        """Refuse: there are no functions."""
        del given
        return self.lagrangian
