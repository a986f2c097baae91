from . import pictures as pictures
from . import report as report
from . import tables as tables
