"""The values over one restricted momentum from enclosures of all of them; python-flint is imported only here.

The enclosures come from `_certificate`, the values without them from `_branch_values`.
"""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from nonholo.base.checks import needs
from nonholo.base.types import Float
from nonholo.discrete._discretization import Discretization
from nonholo.discrete.branching._equations import Frame
from nonholo.discrete.branching._roots import Root, place
from nonholo.discrete.branching._values import Branches, Roots, branches_of, values_over


def certified_over(owner: str, discrete: Discretization, frame: Frame, r: Float[np.ndarray, "k"]) -> Branches:
    """Return all values over a restricted momentum, certified where that can be decided."""
    canonical = discrete.system.to_canonical(r)
    enclosed = _enclosures(owner)(discrete, canonical)
    if isinstance(enclosed, str):
        return dataclasses.replace(values_over(discrete, frame, r), uncertified=enclosed)
    system, facts = discrete.system, zip(enclosed.multiplicity, enclosed.is_real, strict=True)
    turned = system.group.inverse(system.frame) @ (enclosed.increment + system.group.identity) @ system.frame
    points = [frame.point(W.real if real else W) for W, real in zip(turned, enclosed.is_real, strict=True)]
    found = [Root(x if x[0].real >= 0 else -x, int(m), bool(real)) for x, (m, real) in zip(points, facts, strict=True)]
    order = sorted(range(len(found)), key=lambda i: place(found[i]))
    roots = Roots(frame.equations(discrete.time_step * canonical), [found[i] for i in order], enclosed.increment[order])
    values = branches_of(discrete, canonical, roots)
    return dataclasses.replace(values, certified=True, radius=enclosed.radius[order])


def _enclosures(owner: str) -> Callable[..., Any]:
    """Import the certificate, or name the extra that it needs."""
    with needs("certify", f"{owner}(certify=...)"):
        from nonholo.discrete.certificate import enclosures
    return enclosures
