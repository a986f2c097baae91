"""The one place that chooses between a disc and a strip."""

from typing import Any, cast

from nonholo.analysis.planar import planar_variety
from nonholo.plotting.sheets._base import AbstractSheet
from nonholo.plotting.sheets._blade import Blade
from nonholo.plotting.sheets._disc import DiscSheet
from nonholo.plotting.sheets._strip import StripSheet
from nonholo.systems import AbstractSystem


def sheet_of(system: AbstractSystem) -> AbstractSheet | None:
    """Return the sheet of a top in space or a sleigh in the plane, whatever its class; None for other systems."""
    variety = planar_variety(system)
    if variety is None:
        return None
    return (StripSheet if variety.form.is_sleigh else DiscSheet)(variety)


def blade_of_system(system: AbstractSystem) -> Blade | None:
    """Return the blade of a sleigh in the plane, whatever acts on it; None for other systems."""
    sheet = sheet_of(cast(Any, system).system if system.is_forced else system)
    return None if sheet is None else sheet.blade
