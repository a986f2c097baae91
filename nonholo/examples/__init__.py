"""Ready systems of the literature, each with a start and with what is known about its motion.

Names load on first use, as `__init__.pyi` lists them.
"""

import lazy_loader

from nonholo.base.checks import needs

with needs("jax", "nonholo.examples"):
    import jax as _

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
