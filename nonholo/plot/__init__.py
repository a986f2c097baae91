"""Pictures for papers and slides (matplotlib): momenta, tracks in space, energy errors, overviews, animations.

[fedorov-zenkov-2004], figures suslov, mom_dynamics and chsleigh. Nothing is simulated here.

Names load on first use, as `__init__.pyi` lists them.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
