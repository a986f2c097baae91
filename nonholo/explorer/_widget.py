"""The live page as a widget of notebooks: the same file in a frame, which tells Python of its sliders."""

from pathlib import Path

import anywidget
import traitlets


class PageWidget(anywidget.AnyWidget):
    """A frame with a page in it; `state` follows its sliders."""

    _esm = Path(__file__).with_name("view") / "widget.mjs"
    text = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int().tag(sync=True)
    state = traitlets.Dict().tag(sync=True)
