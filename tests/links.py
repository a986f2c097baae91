"""What a page of HTML refers to, and whether its tags close in order."""

from html.parser import HTMLParser

VOID = {"br", "img", "input", "link", "meta"}


class Links(HTMLParser):
    """The places of a page that others may refer to, its references, and the tags that are still open."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.places: list[str] = []
        self.referred: list[str] = []
        self.open: list[str] = []
        self.in_order = True
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep names, links, scripts, pictures and frames."""
        self.open += [tag] * (tag not in VOID)
        self.places += [value or "" for name, value in attrs if name in ("id", "name")]
        self.referred += [value or "" for name, value in attrs if name == ("href" if tag in ("a", "link") else "src")]

    def handle_endtag(self, tag: str) -> None:
        """Close the last tag, and note if that is another one."""
        self.in_order &= tag in VOID or (bool(self.open) and self.open.pop() == tag)
