"""Calls of groups and of their methods."""

import numpy as np
from fuzz.calls import Call, by_position, call
from fuzz.kinds import anything, array, count, thing

import nonholo as nh

_SL2 = np.array([[[1.0, 0], [0, -1]], [[0, 1.0], [0, 0]], [[0, 0], [1.0, 0]]])
_MAPS = ("exp", "cayley", "retract")
_OF_VECTORS = (*_MAPS, *(f"{name}_increment" for name in _MAPS), "hat", "ad", "angle", "dexp_inverse")
_OF_MATRICES = ("log", "inverse", "adjoint", "pose_from_matrix")


def groups() -> dict[str, nh.groups.AbstractMatrixGroup]:
    """Return one group of each kind."""
    result = {f"SO({n})": nh.SO(n) for n in (2, 3, 4)} | {f"SE({n})": nh.SE(n) for n in (2, 3, 4)}
    product = nh.ProductGroup(nh.SE(2), nh.Translations(2))
    return {**result, "Translations(3)": nh.Translations(3), "MatrixGroup": nh.MatrixGroup(_SL2), "product": product}


def calls() -> list[Call]:
    """Return the calls of this file."""
    things = [
        call("SO", by_position(nh.SO), n=count(3)),
        call("SE", by_position(nh.SE), n=count(3)),
        call("Translations", by_position(nh.Translations), m=count(3)),
        call("MatrixGroup", by_position(nh.MatrixGroup), basis=array(_SL2, "any")),
        call("ProductGroup", by_position(nh.ProductGroup), one=thing(nh.SO(3)), other=thing(nh.SE(2))),
    ]
    return things + [each for name, group in groups().items() for each in _methods(name, group)]


def _methods(name: str, group: nh.groups.AbstractMatrixGroup) -> list[Call]:
    x = array(0.1 + 0.1 * np.arange(group.dim), "batch")
    g = array(group.exp(x.value), "batch")
    pose = array(group.pose_from_matrix(g.value), "batch")
    arguments = {
        **{method: {"x": x} for method in _OF_VECTORS},
        **{method: {"g": g} for method in _OF_MATRICES},
        "residual": {"g": g, "infinite": name == "MatrixGroup"},
        "vee": {"X": array(group.hat(x.value), "batch", complex=True)},
        "form_adjoint": {"X": array(g.value, "batch", complex=True)},
        "bracket": {"x": x, "y": x},
        "coad": {"x": x, "p": x},
        "coadjoint": {"g": g, "p": x},
        "matrix_from_pose": {"pose": pose},
        "normalize_pose": {"pose": pose},
        "pose_product": {"pose": pose, "other": pose},
        "pose_rate": {"pose": pose, "x": x},
        "leading_elements": {"g": anything(g.value[None])},  # a pose that is NaN is no element
        "random": {"rng": anything(np.random.default_rng(0))},
    }
    return [call(f"{name}.{method}", getattr(group, method), **options) for method, options in arguments.items()]
