"""The site of the documentation: `sphinx-build -W docs build/site`. Nothing of it is loaded from elsewhere."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

import nonholo as nh

project = "nonholo"
author = copyright = "The nonholo developers"  # noqa: A001 (Sphinx reads this name)
version = release = nh.__version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx-mathjax-offline",
    "docstrings",
    "live",
    "offline",
]
exclude_patterns = ["templates"]
nitpicky = True
nitpick_ignore_regex = [
    ("py:obj", ".*"),  # the default role of docstrings: a link where there is something to link to
    ("py:.*", r"(?!nonholo\b).*"),  # types of other libraries, whose inventories are elsewhere
    (
        "py:class",
        r"nonholo\.((\w+\.)*_.*|(base\.memo|ensembles\.distributions|plot\.sphere)\..*)",
    ),  # that no room names
]

html_theme = "pydata_sphinx_theme"
html_title = f"nonholo {release}"
html_copy_source = False
html_extra_path = ["../LICENSE"]  # Apache-2.0: ours, and that of MathJax, of which the site has a copy
html_static_path = ["static"]
html_css_files = ["wide.css"]
html_sidebars = {page: [] for page in ("index", "paper", "errata", "api/index", "gallery/README")}
html_theme_options = {"header_links_before_dropdown": 8}

myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath"]
myst_heading_anchors = 4
nb_execution_mode = "auto"  # notebooks and tutorials; blocks of other pages are run by the tests
nb_execution_excludepatterns = [
    "*the-live-page*",  # a widget, for which a page would load scripts from elsewhere
    *(
        f"*notebooks/{name}*" for name in ("differentiate-and-fit", "gaits", "steer")
    ),  # JAX compiles: the tests run them
]
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_execution_timeout = 120

default_role = "py:obj"
autodoc_default_options = {"members": True, "member-order": "bysource"}
autosummary_generate = False
napoleon_numpy_docstring = False
napoleon_custom_sections = [("Attributes", "params_style")]
python_maximum_signature_line_length = 100
