"""The script of the gallery that a file of tests is about."""

from types import ModuleType

import pytest
from scripts import script


@pytest.fixture(scope="module", name="script")
def gallery_script(request: pytest.FixtureRequest) -> ModuleType:
    """Return the script as a module."""
    return script(request.module.SCRIPT)
