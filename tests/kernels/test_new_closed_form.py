"""A closed-form family is a kernel and an entry in the table of the route: all runs follow."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest


@pytest.mark.profile("routes", keep=["interpreted"])
@pytest.mark.parametrize("disabled", ["1", "0"], ids=["interpreted", "compiled"])
def test_a_family_is_added_by_its_kernel_and_one_entry(disabled: str, tmp_path: Path) -> None:
    """Runs, compositions, ensembles, also of members with masses of their own, and stores are those of the general top.

    A kernel of its own is run by all of them. Each of its numbers is that of the library to rounding.
    """
    variables = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "NUMBA_DISABLE_JIT": disabled}
    command = [sys.executable, str(Path(__file__).with_name("free_top.py"))]
    done = subprocess.run(command, env=variables, stdout=subprocess.PIPE, check=True)  # noqa: S603
    printed = json.loads(done.stdout)
    given, added = printed["given"], printed["added"]
    assert (given["body"], added["body"]) == ("SuslovBody", "FreeTopBody")
    assert added["is_scalar"]
    assert added["outcomes"] == given["outcomes"] == [0, 0, 1]
    assert added["reversal_defect"] < 1e-14
    for name in ("pose", "composed", "stored", "own"):
        assert np.allclose(added[name], given[name], rtol=0, atol=1e-14), name
    assert np.allclose(added["members"], given["members"], rtol=0, atol=1e-14, equal_nan=True)
    assert added["pose"] == added["stored"]
    assert added["own"][0] == added["members"][0] == added["pose"][-1]
