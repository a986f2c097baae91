"""The Python blocks of the pages run: their assertions are the statements of the text around them."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (
    "theory/groups-and-systems.md",
    "theory/right-invariant.md",
    "how-to/choose-a-branch-rule.md",
    "how-to/choose-a-discretisation.md",
    "how-to/differentiate-and-fit.md",
    "how-to/run-an-ensemble.md",
)


@pytest.mark.profile("paper", keep=["theory/*", "how-to/run-an-ensemble.md", "how-to/choose-a-branch-rule.md"])
@pytest.mark.parametrize("page", PAGES)
def test_the_blocks_run(page: str) -> None:
    """The blocks of a page, one after another in one namespace, raise nothing."""
    blocks = re.findall(r"```python\n(.*?)```", (DOCS / page).read_text(), re.DOTALL)
    names: dict[str, object] = {}
    assert blocks
    for block in blocks:
        exec(compile(block, page, "exec"), names)  # noqa: S102
