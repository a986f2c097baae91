"""The look of pictures."""

from nonholo.plot import theme


def test_former_names() -> None:
    """Functions of colors still answer to the names that they had."""
    assert theme.component_colours is theme.component_colors
    assert theme.end_colours is theme.end_colors
