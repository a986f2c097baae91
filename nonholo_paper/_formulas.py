"""Text with formulas between dollar signs as HTML: the formulas become MathML, which browsers show without a script."""

import functools
import html
import re
import unicodedata

from latex2mathml.converter import convert

_PARTS = re.compile(r"(\$[^$]+\$|`[^`]+`)")
_STYLED = re.compile(r'<(m[ino]) mathvariant="(bold|fraktur|script|double-struck)">([^<]+)</\1>')

_FUNCTION = re.compile(r"(<mi>[a-z]{2,}</mi>)(?=<m[a-z])(?!<mo)")  # "dim g", not "dimg"
_BAR = '<mo lspace="0" rspace="0" stretchy="false">|</mo>'  # of an absolute value, not a relation


@functools.cache
def to_html(text: str) -> str:
    r"""Return a text with formulas between dollar signs and code between backticks as HTML.

    Raises:
        ValueError: A dollar sign is alone, or a command of a formula is not known.

    Example:
        >>> print(to_html("a < $b$ in `step`"))
        a &lt; <math ...><mrow><mi>b</mi></mrow></math> in <code>step</code>
    """
    return "".join(_part(part, text) for part in _PARTS.split(text))


def _part(part: str, text: str) -> str:
    if len(part) > 2 and part[0] == part[-1] == "`":
        return f"<code>{html.escape(part[1:-1])}</code>"
    if len(part) < 3 or part[0] != "$":
        if "$" in part:
            raise ValueError(f"A formula is not closed in {text!r}.")
        return html.escape(part, quote=False)
    formula = convert(part[1:-1])
    if "\\" in formula:
        raise ValueError(f"A command of the formula {part} is not known.")
    formula = _FUNCTION.sub(r'\1<mspace width="0.17em"/>', formula.replace("<mo>&#x0007C;</mo>", _BAR))
    return _STYLED.sub(lambda result: f"<{result[1]}>{_letters(result[2], result[3])}</{result[1]}>", formula)


def _letters(style: str, text: str) -> str:
    """Return letters of a style: browsers follow Unicode, not the attribute for it."""
    return "".join(_letter(style.upper(), character) for character in html.unescape(text))


def _letter(style: str, character: str) -> str:
    name = unicodedata.name(character).removeprefix("LATIN ").removeprefix("GREEK ").replace("LETTER ", "")
    for full in (f"MATHEMATICAL {style} {name}", f"{style.replace('FRAKTUR', 'BLACK-LETTER')} {name}"):
        try:
            return unicodedata.lookup(full)
        except KeyError:
            continue
    return character
