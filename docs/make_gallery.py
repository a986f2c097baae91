"""Draw pictures of the gallery and write its page: `python docs/make_gallery.py [NAME ...]`; without names, all cards.

A card is a script with `draw()`, its picture, and `numbers()`: by name a value, what theory says, the tolerance. The
older walks and studies have their own way to draw themselves; their pictures are on the page too.
"""

import functools
import importlib
import io
import re
import sys
from pathlib import Path
from types import ModuleType

from PIL import Image

DOCS = Path(__file__).parent
PICTURES = DOCS / "images" / "gallery"
PAGE = DOCS / "gallery" / "README.md"
SECTIONS = {
    "Sleighs and tops": (
        "sleigh_cusp",
        "suslov_reversal",
        "gathering",
        "orders",
        "veselova_top",
        "sleigh_in_space",
        "tumbling_body",
        "twenty_dimensions",
        "hanging_with_friction",
        "sleigh_billiard",
        "drifting_sleigh",
    ),
    "Ready systems, one each": (
        "particle",
        "rolling_disk",
        "tilting_disk",
        "knife_edge_on_incline",
        "snakeboard",
        "kinematic_car",
        "two_wheeled_robot",
        "bicycle",
        "trailers",
        "snake",
        "roller_racer",
        "twistcar",
        "driven_sleigh",
        "chaplygin_ball",
        "ball_on_turntable",
        "ball_in_bowl",
        "rattleback",
        "heavy_suslov_top",
        "sleigh_in_a_well",
        "chaotic_quartic_oscillator",
        "non_reversible",
    ),
}
STUDIES = {  # each script and the page that tells about it
    "multivalued_map_1_values": "multivalued-map.md",
    "multivalued_map_2_folds": "multivalued-map.md",
    "loci": "multivalued-map.md",
    "multivalued_map_3_levels": "multivalued-map.md",
    "multivalued_map_4_portraits": "multivalued-map.md",
    "multivalued_map_5_rules": "multivalued-map.md",
    "multivalued_map_6_tree": "multivalued-map.md",
    "multivalued_map_7_limits": "multivalued-map.md",
    "compare_discretisations": "../how-to/choose-a-discretisation.md",
    "sleigh_turning": "../how-to/run-a-sweep.md",
    "lagrange_dalembert_examples": "../theory/lagrange-dalembert.md",
}
_COLUMNS = 2


@functools.cache
def load(name: str) -> ModuleType:
    """Return a script of the gallery as a module."""
    folder = str(PAGE.parent)
    if folder not in sys.path:
        sys.path.insert(0, folder)
    return importlib.import_module(name)


def save(name: str) -> None:
    """Draw a card, in a palette of 256 colors."""
    page = io.BytesIO()
    load(name).draw().savefig(page, dpi=90)
    image = Image.open(page).convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2)
    image.save(PICTURES / f"{name}.png", optimize=True)


def page() -> str:
    """Return the text of the page, from the first lines of the scripts; it runs none of them."""
    cards = "\n\n".join(f"## {title}\n\n{_grid([_card(name) for name in names])}" for title, names in SECTIONS.items())
    return _TEXT.format(cards=cards, studies=_grid([_study(*each) for each in STUDIES.items()]))


def _card(name: str) -> str:
    return f"[![{name}](../images/gallery/{name}.png)]({name}.py)<br>{_first_line(name)}"


def _study(name: str, link: str) -> str:
    return f"[![{name}](../images/gallery/{name}.png)]({link})<br>{_first_line(name)} [Script]({name}.py)"


def _first_line(name: str) -> str:
    text = (PAGE.parent / f"{name}.py").read_text("utf-8")
    match = re.match(r'r?"""(.*?)(?:"""|\n\n)', text, re.DOTALL)
    return " ".join(match[1].split()) if match else name


def _grid(cells: list[str]) -> str:
    filled = cells + [""] * (-len(cells) % _COLUMNS)
    rows = [filled[k : k + _COLUMNS] for k in range(0, len(filled), _COLUMNS)]
    lines = [" | ".join(row).join(["| ", " |"]) for row in rows]
    return "\n".join(["| " * _COLUMNS + "|", "|---" * _COLUMNS + "|", *lines])


_TEXT = """\
<!-- written by docs/make_gallery.py -->
# Gallery

Each picture is drawn by a script, which a click opens. Each script measures a number with a known theoretical value,
and tests compare the two. The same in a terminal: `python docs/make_gallery.py sleigh_cusp`.

{cards}

## Studies

A click opens the page that explains the picture.

{studies}

The pictures of the theory pages are drawn by [theory_pictures.py](theory_pictures.py).

```{{toctree}}
:hidden:

multivalued-map
```
"""


def main(names: list[str]) -> None:
    """Draw cards, print their numbers, and write the page."""
    for name in names or [name for section in SECTIONS.values() for name in section]:
        save(name)
        for what, (value, expected, tolerance) in load(name).numbers().items():
            sys.stdout.write(f"{name}: {what}: {value:.8g}, in theory {expected:.8g} +- {tolerance:.1g}\n")
    PAGE.write_text(page(), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
