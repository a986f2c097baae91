"""No page of the site loads anything from elsewhere: a build that would is an error."""

import re
from pathlib import Path
from typing import Any

TAG = re.compile(
    r"<(?:script|link|img|iframe|source|video|audio|embed|object)\b[^>]*\s(?:src|srcset|href|data)=[\"']?(?:https?:)?//[^>]*>",
    re.I,
)
STYLE = re.compile(r"(?:@import\s+|url\()[\"']?\s*(?:url\()?[\"']?(?:https?:)?//[^;)]*", re.I)


def loaded_from_elsewhere(site: Path) -> list[str]:
    """Return what pages and style sheets of a site load by an address on the net."""
    return [
        f"{path.relative_to(site)}: {match}"
        for pattern, files in ((TAG, "*.html"), (STYLE, "*.css"))
        for path in sorted(site.rglob(files))
        for match in pattern.findall(path.read_text("utf-8"))
    ]


def _check(app: Any, exception: Exception | None) -> None:
    if exception is None and app.builder.format == "html" and (result := loaded_from_elsewhere(Path(app.outdir))):
        raise ValueError("The site must load nothing from elsewhere. Got\n" + "\n".join(result))


def setup(app: Any) -> dict[str, bool]:
    """Connect, after all files are written."""
    app.connect("build-finished", _check, priority=900)
    return {"parallel_read_safe": True}
