"""Systems some of whose constraint forms may yield: without some of them, and while all hold."""

import dataclasses
import functools
from typing import Any

import numpy as np

from nonholo import systems
from nonholo.base.checks import error
from nonholo.lagrange_dalembert.functions._traced import rows_of


class AbstractYieldingSystem(systems.AbstractCoordinateSystem[systems.DiscretizationT, systems.OrbitT]):
    """A system with forms that may yield, where its force has contacts."""

    force: Any

    @functools.cached_property
    def slips(self) -> tuple[Any, ...]:
        """The contacts whose forms may yield."""
        return systems.slips_of(systems.parts_of(self.force))

    @functools.cached_property
    def holding(self: Any) -> Any:
        """The system while the forms that may yield hold; itself if none may."""
        parts = systems.without_slips(systems.parts_of(self.force))
        return dataclasses.replace(self, force=systems.force_of(parts)) if self.slips else self

    @functools.cached_property
    def free(self) -> Any:
        """The system without the forms that may yield; itself if none may."""
        return self.without(self.slips)

    def without(self: Any, contacts: Any) -> Any:
        """Return the system that holds, without the forms of some contacts."""
        if not contacts:
            return self.holding
        rows = np.flatnonzero(~np.concatenate([each.rows for each in contacts]).any(axis=0))
        forms = rows_of(self.constraint_forms, rows) if len(rows) else None
        moves = self.constraint_velocities
        velocities = {"constraint_velocities": rows_of(moves, rows)} if moves else {}  # of no rows: time stays
        return dataclasses.replace(self.holding, constraint_forms=forms, **velocities)

    def _check_slips(self: Any, *others: Any) -> None:
        """Refuse slips beside own discrete functions, of rows that mix forms, and of one form for two contacts."""
        where, forms = f"{type(self).__name__}(force=...)", self.velocity_constraints
        rows = [each.rows for each in self.slips]
        have = [{*np.flatnonzero(each.any(axis=0))} for each in rows]
        fits = [each.shape[1] == forms and len(each) == len(own) for each, own in zip(rows, have, strict=True)]
        if not all(fits) or len(set().union(*have)) < sum(map(len, have)):
            demand = f"have Slips with rows of {forms} numbers, one for each form that may yield, each form in one Slip"
            got, remedy = f"{[each.tolist() for each in rows]}", "Pass rows=[[0.0, 1.0]] for the second of two forms."
            raise error(where, demand, got, remedy)
        if rows and any(others):
            raise error(where, "have no Slip beside own discrete functions", "both", "Leave the functions out.")

    def _refuse_slips(self) -> None:
        if self.slips:
            remedy = "Run it by `simulate` or `iterate` of what `discretize` returned, or leave the slip out."
            raise error(f"{type(self).__name__}(force=...)", "have forms that never yield", "a Slip", remedy)
