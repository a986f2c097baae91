"""The live page: one file that runs the library's own kernel in the browser."""

from nonholo.explorer._explore import Page, explore, kernel, orbit_to_html
