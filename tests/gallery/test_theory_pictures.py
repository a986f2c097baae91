"""The pictures of the theory pages: they are drawn, small, on their pages, and their numbers satisfy the theorems."""

from types import ModuleType

import numpy as np
import pytest
import scripts

import nonholo as nh

SCRIPT = "docs/gallery/theory_pictures.py"


@pytest.mark.parametrize(("name", "panels"), [("mirror", 1), ("fold", 2), ("deltoid", 1), ("substep", 1), ("kicks", 1)])
def test_pictures_are_drawn_and_small(script: ModuleType, name: str, panels: int) -> None:
    """Each is drawn, lies where a page shows it, and has less than 150 kB."""
    short = {"fold": lambda: script.draw_fold(6), "kicks": lambda: script.draw_kicks(2000)}
    figure = short.get(name, script.DRAWN[name])()
    assert len(figure.axes) == panels
    figure.canvas.draw()
    assert (script.PICTURES / f"{name}.png").stat().st_size < 150_000
    pages = "".join(page.read_text() for page in (scripts.ROOT / "docs" / "theory").glob("*.md"))
    assert f"../images/theory/{name}.png" in pages


def test_the_pages_quote_the_numbers(script: ModuleType) -> None:
    """What the captions say is what the script prints, rounded."""
    result = script.numbers()
    odd = ", ".join(f"{result[f'odd part, {k} component']:g}" for k in ("first", "second"))
    quoted = {
        "discrete-equations": [f"$s = {result['s at the fold']:.3f}$", f"{result['energy after the step']:.3f}"],
        "energy-theorem": [f"$F_o = ({odd})$"],
        "chaplygin-sleigh": [f"${result[f'angle {k}, degrees']:.1f}°$" for k in (1, 2, 3)],
    }
    for page, numbers in quoted.items():
        text = (scripts.ROOT / "docs" / "theory" / f"{page}.md").read_text()
        assert [number for number in numbers if number not in text] == []


def test_both_momenta_are_mirror_images(script: ModuleType) -> None:
    """In the metric of the energy the parts are orthogonal, and the step changes the sign of the even one."""
    before, after, odd = script.mirror()
    weights = np.linalg.inv(script.SLEIGH.system.constrained_inertia)
    assert abs(odd @ weights @ (before - odd)) < 1e-14
    assert np.allclose(after, 2 * odd - before, atol=1e-14)


def test_the_path_ends_on_the_curve_of_folds(script: ModuleType) -> None:
    """The end that branches find lies on the curve that the cubic of the theory page gives, and its r beyond."""
    end, curve = script.end_of_path(), script.first_folds(4000)
    assert np.min(np.linalg.norm(curve - end * script.LONG, axis=1)) < 2e-3
    assert nh.displacements_over(script.TOP, script.SHORT).principal is not None
    assert nh.displacements_over(script.TOP, script.LONG).principal is None


def test_the_three_angles_add_up_to_zero(script: ModuleType) -> None:
    """Inside the deltoid the roots are eigenvalue angles of a matrix of determinant one, and lie on its tangents."""
    t = script.tangents()
    assert abs(np.arctan(t).sum()) < 1e-14
    touch, phi = np.array(script.curve(t)).T, np.arctan(t)
    across = np.stack([np.cos(phi), -np.sin(phi)], axis=-1)
    assert np.allclose(np.sum(across * (touch - script.INSIDE), axis=-1), 0.0, atol=1e-14)


def test_page_is_drawn() -> None:
    """A coarse page has two panels in space and four in the plane, and renders."""
    figure = scripts.script("docs/gallery/loci.py").draw(resolution=6)
    assert [axes.name for axes in figure.axes] == ["3d", "3d"] + 4 * ["rectilinear"]
    figure.canvas.draw()
