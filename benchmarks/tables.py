"""The library beside everything else a user could pick: prints tables as Markdown, for docs/project/figures.md.

    python benchmarks/tables.py [--tables equal precision stored] [--skip exudyn heyoka diffrax pydy scipy] [--rounds 9]
    python benchmarks/tables.py --smoke

Peers that are not installed are skipped with a line that says so. `pip install -e '.[bench]'` installs them.
"""

import warnings
from collections.abc import Iterable

from _command import machine, options, small
from peers import equal_step, stored, work_precision
from peers.problems import PROBLEMS

TABLES = {
    "equal": (equal_step, lambda _: f"{equal_step.STEPS} equal steps to time {equal_step.END:g}"),
    "precision": (work_precision, lambda p: f"milliseconds to time {p.end:g} for an error at most"),
    "stored": (stored, lambda p: f"{stored.STATES} states with pose to time {p.end:g}"),
}


def markdown(title: str, header: Iterable[str], rows: list[tuple], left_out: list[str]) -> str:
    """Return a table."""
    header = tuple(header)
    lines = [f"### {title}", "", _line(header), _line(["---"] + ["---:"] * (len(header) - 1))]
    lines += [_line(row) for row in rows]
    return "\n".join([*lines, "", *left_out, ""])


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Print the tables."""
    parser = options(__doc__)
    parser.add_argument("--tables", nargs="+", choices=TABLES, default=list(TABLES))
    parser.add_argument("--skip", nargs="+", default=(), help="peers to leave out")
    parser.add_argument("--rounds", type=int, default=small(9, 1), help="repetitions, of which medians are taken")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")  # solvers complain at tolerances near rounding; their errors are measured
    print(machine(), end="\n\n", flush=True)
    skip = set(arguments.skip)
    for table in arguments.tables:
        room, title = TABLES[table]
        for problem in PROBLEMS:
            rows, left_out = room.rows(problem, skip, arguments.rounds)
            print(markdown(f"{problem.name}: {title(problem)}", room.HEADER, rows, left_out), flush=True)


if __name__ == "__main__":
    main()
