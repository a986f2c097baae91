"""Write forced_flows.json: motions under forces by equations that SymPy derives with Kane's method.

Velocities, orientations (Euler angles) and places of a rigid body in space; reactions by auxiliary speeds along what
the constraint forbids. The equations are solved by DOP853 of SciPy. Run from the repository root with the extra
`bench`; nothing of the library is imported here.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import sympy
from scipy.integrate import solve_ivp
from sympy.physics import mechanics

TIME = sympy.Symbol("t")
TIMES = [0.0, 0.4, 0.8, 1.2]
POINT, WEIGHT, ANCHOR, STIFFNESS = [0.3, -0.2, 0.5], [0.4, -0.3, -2.0], [0.2, 0.5, 0.1], 3.0
FRICTION = 0.1 * np.eye(6) + 0.05 + 0.1 * (np.eye(6, k=1) - np.eye(6, k=-1))
TENSOR = [[1.9, -0.2, -0.5], [-0.2, 2.3, 0.3], [-0.5, 0.3, 2.4]]
AXIS = [0.6, 0.0, 0.8]
ROWS = np.eye(6).tolist()
TOP = {"mass": 0.0, "center": [0.0, 0.0, 0.0], "inertia": TENSOR, "fixed": True}
UPRIGHT = TOP | {"free": [ROWS[0], ROWS[1]], "held": [ROWS[2]]}
TILTED = TOP | {"free": [[0.8, 0, -0.6, 0, 0, 0], ROWS[1]], "held": [[*AXIS, 0.0, 0.0, 0.0]]}
SPINNING = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.8]]
SLEIGH = {"mass": 1.2, "center": [0.4, 0.25, 0.0], "inertia": SPINNING, "fixed": False}
SLEIGH |= {"free": [ROWS[2], ROWS[3]], "held": [ROWS[4]]}
IN_SPACE = {"mass": 1.3, "center": [0.3, 0.2, -0.1], "inertia": [[1.1, -0.1, 0.05], [-0.1, 1.0, 0.0], [0.05, 0.0, 1.2]]}
IN_SPACE |= {"fixed": False, "free": [ROWS[2], ROWS[1], ROWS[3]], "held": [ROWS[0], ROWS[4], ROWS[5]]}
CASES: dict[str, tuple[dict[str, Any], list[str], list[float]]] = {
    "heavy tilted top": (TILTED, ["weight"], [0.5, -0.3]),
    "top with friction, driven": (UPRIGHT, ["friction", "drive"], [0.5, -0.3]),
    "top on a spring": (UPRIGHT, ["spring"], [0.5, -0.3]),
    "sleigh on a slope with friction": (SLEIGH, ["weight", "friction"], [0.7, 0.6]),
    "sleigh on a spring, driven": (SLEIGH, ["spring", "drive"], [-0.4, 0.6]),
    "heavy sleigh in space with friction": (IN_SPACE, ["weight", "friction"], [0.4, 0.3, -0.6]),
}


def drive(w: Any, time: Any, cos: Any) -> list[Any]:
    """Return the covector of a force of time and body velocity (6)."""
    return [cos(3 * time + j) - 0.2 * w[j] * w[(j + 1) % 6] for j in range(6)]


def equations(body: dict[str, Any], acting: list[str]) -> tuple[Callable[..., Any], ...]:
    """Return rates, multipliers and poses as functions of (angles, place, speeds)."""
    dot, V = mechanics.dynamicsymbols._t, mechanics.Vector
    angles, places = mechanics.dynamicsymbols("a:3"), [] if body["fixed"] else mechanics.dynamicsymbols("x:3")
    speeds = mechanics.dynamicsymbols(f"u:{len(body['free'])}")
    spare, lam = mechanics.dynamicsymbols(f"h:{len(body['held'])}"), sympy.symbols(f"l:{len(body['held'])}")
    space, frame = mechanics.ReferenceFrame("N"), mechanics.ReferenceFrame("B")
    origin, place = mechanics.Point("O"), mechanics.Point("P")
    frame.orient_body_fixed(space, angles, "ZYX")

    def vector(numbers: Any, within: Any = frame) -> Any:
        return sum((n * e for n, e in zip(numbers, (within.x, within.y, within.z), strict=True)), V(0))

    moving = sympy.Matrix([speeds]) * sympy.Matrix(body["free"])
    aside = moving + sympy.Matrix([spare]) * sympy.Matrix(body["held"])
    (yaw, pitch, roll), (p, q, r) = angles, moving[:3]
    swing = q * sympy.sin(roll) + r * sympy.cos(roll)
    turns = swing / sympy.cos(pitch), q * sympy.cos(roll) - r * sympy.sin(roll), p + swing * sympy.tan(pitch)
    kinematics = [angle.diff(dot) - turn for angle, turn in zip((yaw, pitch, roll), turns, strict=True)]
    origin.set_vel(space, 0)
    place.set_pos(origin, vector(places, space) if places else V(0))
    rates = zip(places, (space.x, space.y, space.z), strict=False)
    kinematics += [x.diff(dot) - vector(moving[3:]).dot(e) for x, e in rates]
    place.set_vel(space, vector(aside[3:]) if places else V(0))
    frame.set_ang_vel(space, vector(aside[:3]))
    center, point = place.locatenew("G", vector(body["center"])), place.locatenew("Q", vector(POINT))
    for each in (center, point):
        each.v2pt_theory(place, space, frame)
    entries = (body["inertia"][i][j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)))
    rigid = mechanics.RigidBody("R", center, frame, body["mass"], (mechanics.inertia(frame, *entries), center))
    covector = sympy.Matrix([lam]) * sympy.Matrix(body["held"])
    spring = -STIFFNESS * (point.pos_from(origin) - vector(ANCHOR, space))
    forces = {"weight": vector(WEIGHT, space), "spring": spring}
    loads = [(point, force) for name, force in forces.items() if name in acting]
    if "friction" in acting:
        covector -= moving * sympy.Matrix(FRICTION.tolist()).T
    if "drive" in acting:
        covector += sympy.Matrix([drive(moving, TIME, sympy.cos)])
    loads += [(frame, vector(covector[:3])), (place, vector(covector[3:]))]
    coordinates = [*angles, *places]
    kane = mechanics.KanesMethod(space, coordinates, speeds, kd_eqs=kinematics, u_auxiliary=spare)
    kane.kanes_equations([rigid], loads)
    velocities, changes = kane.kindiffdict(), sympy.symbols(f"r:{len(speeds)}")
    names = sympy.symbols(f"s:{len(coordinates) + len(speeds)}")
    plain = dict(zip([*coordinates, *speeds], names, strict=True))
    reaction = kane.auxiliary_eqs.subs({u.diff(dot): r for u, r in zip(speeds, changes, strict=True)})
    moved = sympy.Matrix([velocities[x.diff(dot)] for x in coordinates])
    free = dict.fromkeys(lam, 0)
    matrices = moved, kane.mass_matrix, kane.forcing, reaction
    moved, mass, forcing, reaction = (each.subs(velocities).subs(plain) for each in matrices)
    field = sympy.lambdify([names, TIME], [moved, mass, forcing.subs(free)], cse=True)
    constraint = sympy.lambdify([names, changes, TIME], [reaction.jacobian(lam), reaction.subs(free)], cse=True)
    turned = sympy.lambdify([names], space.dcm(frame).subs(plain), cse=True)

    def rate(time: float, y: np.ndarray) -> np.ndarray:
        first, M, f = field(y, time)
        return np.concatenate([np.ravel(first), np.ravel(np.linalg.solve(M, f))])

    def multipliers(time: float, y: np.ndarray) -> np.ndarray:
        slope, rest = constraint(y, rate(time, y)[-len(speeds) :], time)
        return -np.ravel(np.linalg.solve(slope, rest))

    return rate, multipliers, turned


def solved(name: str) -> dict[str, Any]:
    """Return a case with its motion: body velocities and covectors of the reaction in se(3), rotations and places."""
    body, acting, velocity = CASES[name]
    rate, multipliers, turned = equations(body, acting)
    k, size = len(velocity), 3 if body["fixed"] else 6
    start = np.concatenate([np.zeros(size), velocity])
    result = solve_ivp(rate, (0.0, TIMES[-1]), start, "DOP853", TIMES, rtol=1e-13, atol=1e-15).y.T
    lam = [multipliers(time, y) for time, y in zip(TIMES, result, strict=True)]
    velocities, reactions = result[:, -k:] @ np.array(body["free"]), np.array(lam) @ np.array(body["held"])
    columns = {"body_velocities": velocities, "reactions": reactions}
    columns |= {"rotations": np.array([turned(y) for y in result]), "places": result[:, 3:size]}
    return {"name": name, "body": body, "acting": acting} | {key: rows.tolist() for key, rows in columns.items()}


def main() -> None:
    """Write the file beside this one."""
    forces = {"point": POINT, "weight": WEIGHT, "anchor": ANCHOR, "stiffness": STIFFNESS, "friction": FRICTION.tolist()}
    written = {"times": TIMES, "axis": AXIS, "forces": forces, "cases": [solved(name) for name in CASES]}
    Path(__file__).with_name("forced_flows.json").write_text(json.dumps(written, indent=1) + "\n")


if __name__ == "__main__":
    main()
