"""The walk through the multivalued map: its scripts print what the page quotes, and the numbers are right."""

import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import scripts

import nonholo as nh

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"
PANELS = {  # of each picture, with the inset of the last one
    "multivalued_map_1_values": 3, "multivalued_map_2_folds": 3, "loci": 6, "multivalued_map_3_levels": 2,
    "multivalued_map_4_portraits": 3, "multivalued_map_5_rules": 3, "multivalued_map_6_tree": 4,
    "multivalued_map_7_limits": 3,
}  # fmt: skip


def script(name: str) -> ModuleType:
    """Return a script of the gallery as a module."""
    return scripts.script(f"docs/gallery/{name}.py")


@pytest.mark.profile("paper", cases=["loci", "*_5_*", "*_6_*"])
@pytest.mark.parametrize("name", PANELS)
def test_the_page_quotes_what_the_script_prints(name: str) -> None:
    """The block below the link to a script is its output, line by line."""
    page = (GALLERY / "multivalued-map.md").read_text()
    block = re.search(rf"\({name}\.py\):\n\n```text\n(.*?)```", page, re.DOTALL)
    assert block
    assert block.group(1).splitlines() == [f"{what}: {value:.8g}" for what, value in script(name).numbers().items()]


@pytest.mark.profile("paper", keep=["*_1_*", "*_2_*", "*_3_*", "*_7_*"])
@pytest.mark.parametrize("name", [name for name in PANELS if name != "loci"])
def test_pictures_are_drawn(name: str) -> None:
    """Each script draws its panels, and its picture lies where the page looks for it."""
    module = script(name)
    figure = module.draw(12) if name == "multivalued_map_2_folds" else module.draw()
    assert len(figure.axes) == PANELS[name]
    assert module.PICTURE.exists()
    assert module.PICTURE.name in (GALLERY / "multivalued-map.md").read_text()


def test_third_value_of_the_first_top() -> None:
    """Its step angle is 2 atan|y| of the 50-digit value y = (-3.81310876, -0.50880833)."""
    angle = script("multivalued_map_1_values").numbers()["step angle of its third value, degrees"]
    assert np.isclose(angle, 2 * np.degrees(np.arctan(np.hypot(3.81310876, 0.50880833))), atol=1e-6)


def test_folds_are_where_certified_counts_change() -> None:
    """A part in a million before and after each fold the exact number of real values is 2 and 4, 4 and 2, 2 and 0."""
    pytest.importorskip("flint")
    module = script("multivalued_map_2_folds")
    counts = []
    for size in module.numbers().values():
        sides = [nh.displacements_over(module.TOP, size * s * module.RAY, certify=True) for s in (1 - 1e-6, 1 + 1e-6)]
        counts.append([int(np.count_nonzero(result.is_real)) for result in sides])
    assert counts == [[2, 4], [4, 2], [2, 0]]


def test_folds_of_the_picture_separate_counts() -> None:
    """Two real values lie just inside the drawn oval, none just outside; four in the middle of the triangle."""
    module = script("multivalued_map_2_folds")
    oval, triangle = sorted(module.folds(60), key=lambda curve: -np.ptp(curve[0]))
    for r in oval.T[:: oval.shape[1] // 6]:
        counts = [np.count_nonzero(nh.displacements_over(module.TOP, s * r).is_real) for s in (0.99, 1.01)]
        assert counts == [2, 0]
    middle = (triangle.min(axis=1) + triangle.max(axis=1)) / 2
    assert np.count_nonzero(nh.displacements_over(module.TOP, middle).is_real) == 4


def test_portraits_print_closed_forms() -> None:
    """With J = m = 1, a = h = 1/2: E* = 2 m a^2 / h^2, a quarter of it in the paper, multiplier 9/11 at unit speed."""
    result = script("multivalued_map_4_portraits").numbers()
    assert np.isclose(result["the sleigh is single-valued below"], 2.0, rtol=1e-12)
    assert np.isclose(result["bound of the paper"], 0.5, rtol=1e-12)
    assert np.isclose(result["multiplier of the sleigh at energy 0.5"], 9 / 11, rtol=1e-12)


def test_turn_of_the_flow_is_one_turn() -> None:
    """J = 3 m a^2: the heading turns by 360 degrees; errors of the map fall fourfold with half the step."""
    result = script("multivalued_map_7_limits").numbers()
    assert np.isclose(result["turn of the flow, degrees"], 360.0, rtol=1e-12)
    assert abs(result["ratio of the errors of h = 0.05 and h = 0.025"] - 4.0) < 0.01
