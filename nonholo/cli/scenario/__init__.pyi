from . import bodies as bodies
from . import files as files
from . import sections as sections
