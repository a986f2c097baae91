"""What must work: every cell but those of a few rules, each with its reason and the words of its refusal."""

import dataclasses
import fnmatch

import matrix.questions  # noqa: F401
from matrix.abilities import ABILITIES
from matrix.kinds import KINDS, Kind
from matrix.ready import ALL, READY


@dataclasses.dataclass(frozen=True)
class Rule:
    """Cells that do not work, and why.

    Attributes:
        abilities: A pattern of abilities, with | between several.
        kinds: A trait, or the names of kinds with | between.
        reason: Why, for people.
        refusal: A pattern of the words of the library.
        is_broken: Whether it should work.
    """

    abilities: str
    kinds: str
    reason: str
    refusal: str
    is_broken: bool = False

    def holds(self, kind: str, ability: str) -> bool:
        """Tell whether a cell is one of the rule."""
        is_one = bool({*ALL[kind].traits, kind} & set(self.kinds.split("|")))
        return is_one and any(fnmatch.fnmatchcase(ability, each) for each in self.abilities.split("|"))


RULES: tuple[Rule, ...] = (
    Rule(
        "multipliers",
        "composition",
        "A composition has no multipliers: the impulses of its substeps act at places between its states.",
        "multipliers",
    ),
    Rule(
        "flow*|vector field",
        "table",
        "A table has a force for each step; between steps there is none, so there is no flow.",
        "one force for each step",
    ),
    Rule(
        "gradient",
        "force in Python|force in numba",
        "No derivative goes through a force that is a Python or compiled function.",
        "forces that are numbers",
    ),
    Rule(
        "multipliers|checks|page|gradient",
        "wide",
        "SO(300) has 44,850 dimensions: its basis takes 32 GB, the complement of the constraint 16 GB.",
        "must fit into memory",
    ),
    Rule("vector field", "wide", "Flows in hundreds of dimensions are those of momenta alone.", "needs poses"),
    Rule("scenario file", "wide", "Scenario files hold matrices.", "cannot be run"),
    Rule(
        "events|events in *|crossings|ensemble with events|impacts",
        "rule",
        "A step to a value that is not the principal one has no parts that begin at its state: Proposition 13.3.",
        "parts? of a step",
    ),
    Rule("impacts", "wide", "The normal of a gap is taken along a basis of 44,850 dimensions.", "have a normal"),
    Rule(
        "impacts",
        "friction, table|force in Python|force in numba",
        "The impulses of a force of the time are those of nodes, where no step after an impact begins.",
        "a force of the time",
    ),
    Rule(
        "ensemble of time steps|sweep",
        "own difference",
        "A discrete Lagrangian of the user's own includes its time step.",
        "includes its time step",
    ),
    Rule("scenario file", "function", "A file holds numbers, not the functions of a user.", "cannot be run"),
    Rule(
        "linearize*|equilibria|critical values",
        "driven",
        "What a prescribed motion drives has no steady motion: its equations contain the time.",
        "steady motion",
    ),
    Rule("fit", "particle", "A free motion does not determine the unit of mass, its only parameter.", "unit"),
)


def rule_of(kind: str, ability: str) -> Rule | None:
    """Return the rule by which a cell does not work; None where it works."""
    return next((rule for rule in RULES if rule.holds(kind, ability)), None)


_ALSO = ("compare", "events", "ensemble of parameters", "sweep", "store", "flow at other times")
QUESTIONS = [name for name, check in ABILITIES.items() if check.__module__ == "matrix.questions"]
TABLES: tuple[tuple[dict[str, Kind], list[str]], ...] = (
    (KINDS, [*(name for name in ABILITIES if name not in QUESTIONS), "vector field"]),
    (READY, [*QUESTIONS, *_ALSO]),
)
CELLS = {
    (kind, ability): rule_of(kind, ability) for kinds, abilities in TABLES for kind in kinds for ability in abilities
}
