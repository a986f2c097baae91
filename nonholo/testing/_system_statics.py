"""Measurements of what a system states: inertia, constraint, energy, canonical frame."""

import numpy as np

from nonholo.testing._measures import largest, relative
from nonholo.testing._report import Check, need
from nonholo.testing._system_samples import SystemSamples


def _sizes(s: SystemSamples) -> float:
    dim = s.group.dim
    shapes = [(s.S, (len(s.S), dim)), (s.A, (dim - len(s.S), dim)), (s.inertia, (dim, dim))]
    return sum(array.shape != shape for array, shape in shapes)


def _complementary(s: SystemSamples) -> float:
    rows = np.concatenate([s.S, s.A])
    return s.group.dim - np.linalg.matrix_rank(rows / np.linalg.norm(rows, axis=1)[:, None])


def _annihilator(s: SystemSamples) -> float:
    scale = np.linalg.norm(s.A, axis=1)[:, None] * np.linalg.norm(s.S, axis=1)
    return largest(s.A @ s.S.T / scale)


def _mass_tensor(s: SystemSamples) -> float:
    tensor = s.system.homogeneous_mass_tensor
    need(tensor is not None, "the kinetic energy comes from an inertia operator")
    E = s.group.basis
    form = np.eye(s.group.size) if s.group.form is None else s.group.form  # tr(E_i J E_j*)
    return relative(s.inertia, np.einsum("iab,bc,jdc,da->ij", E, np.asarray(tensor) @ np.linalg.inv(form), E, form))


def _symmetry(s: SystemSamples) -> float:
    return largest(s.inertia - s.inertia.T) / max(largest(s.inertia), np.finfo(float).tiny)


def _positive(s: SystemSamples) -> float:
    """Return the condition of the inertia along the constraint, infinite if an eigenvalue is not positive.

    On a group with a form they may be negative.
    """
    need_motion(s)
    Q = np.linalg.qr(s.S.T)[0]
    eigenvalues = np.linalg.eigvalsh(Q.T @ (s.inertia + s.inertia.T) @ Q / 2)
    if s.group.form is not None:
        eigenvalues = np.sort(np.abs(eigenvalues))
    return float(eigenvalues[-1] / eigenvalues[0]) if eigenvalues[0] > 0 else np.inf


def _constrained_inertia(s: SystemSamples) -> float:
    return relative(s.system.constrained_inertia, s.S @ s.inertia @ s.S.T)


def _restriction(s: SystemSamples) -> float:
    system = s.system
    if s.spatial:
        return relative(system.restrict_in_space(s.momentum, s.g), s.restricted)  # type: ignore[attr-defined]
    return relative(system.restrict(s.momentum), s.restricted)


def _velocity(s: SystemSamples) -> float:
    need_motion(s)
    return relative(s.full_momentum(s.restricted, s.g), s.momentum)


def _energy(s: SystemSamples) -> float:
    need_motion(s)
    kinetic = np.sum(s.momentum * s.body_velocity, axis=-1) / 2
    return relative(s.energy(s.restricted, s.g), kinetic)


def _full_energy(s: SystemSamples) -> float:
    need_motion(s)
    need(len(s.S) < s.group.dim, "nothing is forbidden: full momenta are restricted ones")
    return relative(s.energy(s.momentum, s.g), s.energy(s.restricted, s.g))


def _into_canonical(s: SystemSamples) -> np.ndarray:
    """Return the matrix of Ad of the frame; refuse where the frame is the user's own."""
    need(s.system.canonical is not s.system, "the canonical frame is the user's")
    return s.group.adjoint(np.asarray(s.system.frame))


def _frame_of_subspace(s: SystemSamples) -> float:
    into = _into_canonical(s)
    return largest(np.asarray(s.system.canonical.annihilator) @ np.linalg.solve(into, s.S.T))


def _frame_of_inertia(s: SystemSamples) -> float:
    into = _into_canonical(s)
    return relative(s.system.canonical.inertia_operator, into.T @ s.inertia @ into)


def _frame_of_momenta(s: SystemSamples) -> float:
    into = _into_canonical(s)
    return relative(s.restricted @ s.system.frame_map.T, s.system.canonical.restrict(s.momentum @ into))


def _frame_of_energy(s: SystemSamples) -> float:
    _into_canonical(s)
    found = s.system.canonical.constrained_energy(s.restricted @ s.system.frame_map.T)  # type: ignore[attr-defined]
    return relative(found, s.energy(s.restricted, s.g))


def need_motion(s: SystemSamples) -> None:
    need(len(s.S), "the constraint forbids all motion")


STATICS = (
    Check(
        "sizes", "constraint_subspace (k, dim), annihilator (dim - k, dim), inertia_operator (dim, dim)", 0.0, _sizes
    ),
    Check("complementary", "rows of constraint_subspace and annihilator together span the space", 0.0, _complementary),
    Check("annihilator", "annihilator @ constraint_subspace.T = 0", 1e-13, _annihilator),
    Check("inertia of the mass tensor", "inertia_operator[i, j] = tr(E_i J E_j*)", 1e-12, _mass_tensor),
    Check("inertia symmetric", "inertia_operator is symmetric", 1e-13, _symmetry),
    Check("inertia positive", "inertia along the constraint is positive, with a form invertible", 1e13, _positive),
    Check("constrained_inertia", "constrained_inertia = S I S^T", 1e-12, _constrained_inertia),
    Check("restriction", "restrict(p) = S p (in space: S coadjoint(g^-1, p))", 1e-12, _restriction),
    Check("restricted_velocity", "restricted_velocity inverts velocity -> momentum", 1e-11, _velocity),
    Check("energy", "constrained_energy = kinetic energy of the admissible velocity", 1e-11, _energy),
    Check("energy of full momenta", "constrained_energy(p) = constrained_energy(p along S)", 1e-11, _full_energy),
    Check("frame", "residual(frame) = 0", 1e-12, lambda s: largest(s.group.residual(np.asarray(s.system.frame)))),
    Check("frame and constraint", "Ad of frame^-1 maps d to the canonical d", 1e-12, _frame_of_subspace),
    Check("frame and inertia", "canonical inertia = Ad_T^T I Ad_T", 1e-11, _frame_of_inertia),
    Check("frame and momenta", "frame_map takes momenta along d to canonical ones", 1e-11, _frame_of_momenta),
    Check("frame and energy", "the canonical energy is the energy", 1e-11, _frame_of_energy),
)
"""In the order of the report; tolerances leave room for rounding at inertias of a few units."""
