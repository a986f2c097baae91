"""Calls of groups and of their methods."""

import numpy as np
from fuzz.calls import Call, by_position, call
from fuzz.kinds import anything, array, count, thing

import nonholo as nh

_SL2 = np.array([[[1.0, 0], [0, -1]], [[0, 1.0], [0, 0]], [[0, 0], [1.0, 0]]])
_OF_VECTORS = ("hat", "exp", "cayley", "retract", "ad", "angle", "exp_increment", "cayley_increment")
_OF_VECTORS_TOO = ("retract_increment", "dexp_inverse")
_OF_MATRICES = ("log", "inverse", "adjoint", "residual", "pose_from_matrix")


def groups() -> dict[str, nh.groups.AbstractMatrixGroup]:
    """Return one group of each kind."""
    found = {f"SO({n})": nh.SO(n) for n in (2, 3, 4)} | {f"SE({n})": nh.SE(n) for n in (2, 3, 4)}
    product = nh.ProductGroup(nh.SE(2), nh.Translations(2))
    return {**found, "Translations(3)": nh.Translations(3), "MatrixGroup": nh.MatrixGroup(_SL2), "product": product}


def calls() -> list[Call]:
    """Return the calls of this file."""
    made = [
        call("SO", by_position(nh.SO), n=count(3)),
        call("SE", by_position(nh.SE), n=count(3)),
        call("Translations", by_position(nh.Translations), m=count(3)),
        call("MatrixGroup", by_position(nh.MatrixGroup), basis=array(_SL2, "any")),
        call("ProductGroup", by_position(nh.ProductGroup), one=thing(nh.SO(3)), other=thing(nh.SE(2))),
    ]
    return made + [each for name, group in groups().items() for each in _methods(name, group)]


def _methods(name: str, group: nh.groups.AbstractMatrixGroup) -> list[Call]:
    x = array(0.1 + 0.1 * np.arange(group.dim), "batch")
    g = array(group.exp(x.value), "batch")
    pose = array(group.pose_from_matrix(g.value), "batch")
    found = [call(f"{name}.{method}", getattr(group, method), x=x) for method in (*_OF_VECTORS, *_OF_VECTORS_TOO)]
    found += [
        call(f"{name}.{method}", getattr(group, method), g=g, infinite=(name, method) == ("MatrixGroup", "residual"))
        for method in _OF_MATRICES
    ]
    return [
        *found,
        call(f"{name}.vee", group.vee, X=array(group.hat(x.value), "batch", complex=True)),
        call(f"{name}.form_adjoint", group.form_adjoint, X=array(g.value, "batch", complex=True)),
        call(f"{name}.bracket", group.bracket, x=x, y=x),
        call(f"{name}.coad", group.coad, x=x, p=x),
        call(f"{name}.coadjoint", group.coadjoint, g=g, p=x),
        call(f"{name}.matrix_from_pose", group.matrix_from_pose, pose=pose),
        call(f"{name}.normalize_pose", group.normalize_pose, pose=pose),
        call(f"{name}.pose_product", group.pose_product, pose=pose, other=pose),
        call(f"{name}.pose_rate", group.pose_rate, pose=pose, x=x),
        call(f"{name}.leading_elements", group.leading_elements, g=array(g.value[None], "batch")),
        call(f"{name}.random", group.random, rng=anything(np.random.default_rng(0))),
    ]
