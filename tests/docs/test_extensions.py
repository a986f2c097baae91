"""What the site does with docstrings, and that it loads nothing from elsewhere."""

from pathlib import Path

import pytest
from scripts import script

restructured = script("docs/extensions/docstrings.py").restructured
loaded_from_elsewhere = script("docs/extensions/offline.py").loaded_from_elsewhere


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("`Event`s of $n$s, ($n$-dimensional)", r"`Event`\ s of :math:`n`\ s, (:math:`n`-dimensional)"),
        ("D > 2|c|^2 and Ad*_W, W_ too", r"D > 2\|c\|^2 and Ad\*_W, W\_ too"),
        ("mass: m.\n1. no list", "mass: \\m.\n\\1. no list"),
        (r"$|x|_*$ and `a|b`", r":math:`|x|_*` and `a|b`"),
        ("  $$ a\n  = b $$\n", "  \n\n  .. math::\n\n     a = b\n\n  \n"),
        (">>> x = a_ * |b|\nc_|\n\nd_\n", ">>> x = a_ * |b|\nc_|\n\nd\\_\n"),
    ],
)
def test_only_code_and_formulas_are_marked(text: str, expected: str) -> None:
    """Formulas become the markup of Sphinx; bars, stars and underscores beside them stay what they are."""
    assert restructured(text) == expected


@pytest.mark.parametrize(
    ("name", "text", "loads"),
    [
        ("a.html", '<script defer src="https://cdn.example/x.js"></script>', True),
        ("a.html", "<link rel='stylesheet'\n href='//fonts.example/x.css'>", True),
        ("a.html", '<img src="http://example.org/x.png">', True),
        ("a.html", '<a href="https://example.org">there</a> <script src="_static/x.js"></script>', False),
        ("a.css", '@import "https://example.org/x.css";', True),
        ("a.css", "b { src: url('//example.org/x.woff2') }", True),
        ("a.css", '@import "../basic.css"; b { src: url(data:font/woff2;base64,AA//BB) }', False),
    ],
)
def test_what_a_page_loads(tmp_path: Path, name: str, text: str, loads: bool) -> None:
    """Scripts, style sheets, pictures and fonts with an address on the net are named; links to follow are not."""
    (tmp_path / name).write_text(text)
    assert bool(loaded_from_elsewhere(tmp_path)) is loads
