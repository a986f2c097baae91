"""Orbits as labeled data and as stores on disk: complete or absent, checked when read, with full provenance.

Names load on first use, as `__init__.pyi` lists them: what makes datasets and stores loads xarray and zarr, which a run
without them does not need.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
