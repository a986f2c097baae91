"""The live page: one file that runs the library's own kernel in the browser."""

from nonholo.explorer._explore import Page, explore, orbit_to_html
from nonholo.explorer._motion import kernel
