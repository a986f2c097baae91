"""The cards of the gallery: each has its picture, its number is that of theory, and every ready system has one."""

import pytest
from matplotlib.figure import Figure
from scripts import script

import nonholo as nh

GALLERY = script("docs/make_gallery.py")
CARDS = [name for names in GALLERY.SECTIONS.values() for name in names]
QUICK = ["sleigh_cusp", "gathering", "tumbling_body"]


@pytest.mark.profile("paper", keep=QUICK)
@pytest.mark.parametrize("name", CARDS)
def test_numbers_are_those_of_theory(name: str) -> None:
    """What a card measures is within its tolerance of what is known."""
    found = GALLERY.load(name).numbers()
    assert found
    assert {what: value for what, (value, known, allowed) in found.items() if not abs(value - known) <= allowed} == {}


@pytest.mark.profile("paper", keep=QUICK)
@pytest.mark.parametrize("name", CARDS)
def test_it_is_drawn(name: str) -> None:
    """A card is a figure with something in each of its axes."""
    figure = GALLERY.load(name).draw()
    assert isinstance(figure, Figure)
    assert all(axes.has_data() for axes in figure.axes)
    figure.canvas.draw()


def test_the_page_is_up_to_date() -> None:
    """The page in the repository is the one that the script writes, and every picture on it is there."""
    assert GALLERY.PAGE.read_text("utf-8") == GALLERY.page()
    assert [name for name in (*CARDS, *GALLERY.STUDIES) if not (GALLERY.PICTURES / f"{name}.png").exists()] == []


def test_every_ready_system_and_script_has_its_place() -> None:
    """No ready system, and no script, is left out; there are 25 or more."""
    scripts = {path.stem for path in GALLERY.PAGE.parent.glob("[a-z]*.py")} - {"theory_pictures"}
    assert scripts == {*CARDS, *GALLERY.STUDIES}
    assert {*nh.examples.__all__} - {"Example"} <= set(CARDS)
    assert len(scripts) >= 25
