"""A car parked sideways with least effort, opty's example `plot_parallel_park`: there, and for `nonholo.steer`.

A car of mass m turns its front wheels; thrust F acts along it at the rear axle, the torque T on its steering. From rest
to rest in thirty seconds, two meters to the left, it is to take the least integral of F^2 + T^2.
"""

import tempfile
from typing import Any

import numpy as np

import nonholo as nh

DURATION, ASIDE = 30.0, 2.0
MASS, INERTIA, AXLE = 1200.0, 1300.0, 1.5  # of the car; from its middle to both axles
WHEELS = 1 / 6, 1 / 32  # mass and inertia of the front wheels, in parts of those of the car
THRUST, TORQUE, TURN = 300.0, 50.0, np.pi / 4  # at most


def by_opty(nodes: int) -> float:
    """Return the least effort, by backward Euler and IPOPT from the guess of the example."""
    import sympy
    from opty import Problem, create_objective_function

    equations, states, (torque, thrust), numbers, t = _by_kane()
    h, effort = DURATION / (nodes - 1), sympy.Integral(thrust**2 + torque**2, t)
    objective = create_objective_function(effort, states, (torque, thrust), (), nodes, h, time_symbol=t)
    ends = [state.func(time) for time in (0.0, DURATION) for state in states]
    ends[len(states) + 1] -= ASIDE
    limits = {states[3]: (-TURN, TURN), torque: (-TORQUE, TORQUE), thrust: (-THRUST, THRUST)}
    with tempfile.TemporaryDirectory() as folder:  # of code that opty compiles
        options: dict[str, Any] = {"known_parameter_map": numbers, "bounds": limits, "tmp_dir": folder}
        options |= {"instance_constraints": tuple(ends), "time_symbol": t}
        problem = Problem(*objective, equations, states, nodes, h, **options)
        problem.add_option("nlp_scaling_method", "gradient-based")
        problem.add_option("print_level", 0)
        guess = np.ones(problem.num_free)
        guess[: 2 * nodes] = _path(nodes).T.ravel()
        return float(problem.solve(guess)[1]["obj_val"])


def _by_kane() -> tuple[Any, ...]:
    """Return equations of motion, states, torque and thrust, parameters and the time."""
    import sympy
    from sympy.physics import mechanics as kane

    m, inertia, a = sympy.symbols("m I a", real=True)
    coordinates, speeds = kane.dynamicsymbols("x y theta delta"), kane.dynamicsymbols("vx vy omega beta")
    (x, y, theta, delta), (vx, vy, omega, beta), (torque, thrust) = coordinates, speeds, kane.dynamicsymbols("T F")
    ground, car, wheels = (kane.ReferenceFrame(name) for name in ("N", "A", "B"))
    car.orient_axis(ground, theta, ground.z)
    wheels.orient_axis(car, delta, car.z)
    origin = kane.Point("O")
    middle = origin.locatenew("C", x * ground.x + y * ground.y)
    rear, front = middle.locatenew("R", -a * car.x), middle.locatenew("P", a * car.x)
    slide = (x.diff() * ground.x + y.diff() * ground.y).dot
    kinematic = [vx - slide(car.x), vy - slide(car.y), omega - theta.diff(), beta - delta.diff()]
    car.set_ang_vel(ground, omega * car.z)
    origin.set_vel(ground, 0)
    middle.set_vel(ground, vx * car.x + vy * car.y)
    for axle in (rear, front):
        axle.v2pt_theory(middle, ground, car)
    rolling = [rear.vel(ground).dot(car.y), front.vel(ground).dot(wheels.y)]
    turning = [kane.inertia(frame, 0, 0, inertia * part) for frame, part in ((car, 1), (wheels, WHEELS[1]))]
    bodies = [kane.RigidBody("car", middle, car, m, (turning[0], middle))]
    bodies += [kane.RigidBody("wheels", front, wheels, m * WHEELS[0], (turning[1], front))]
    loads = [(rear, thrust * car.x), (car, -torque * wheels.z), (wheels, torque * wheels.z)]
    dependent = {"u_dependent": [vy, omega], "velocity_constraints": rolling}
    method = kane.KanesMethod(ground, coordinates, [vx, beta], kd_eqs=kinematic, **dependent)
    forces, inertial = method.kanes_equations(bodies, loads)
    equations = sympy.Matrix([*(forces + inertial), *rolling, *kinematic])
    numbers = {inertia: INERTIA, m: MASS, a: AXLE}
    return equations, (*coordinates, *speeds), (torque, thrust), numbers, kane.dynamicsymbols._t


def by_steps(steps: int) -> Any:
    """Return the controls that `nonholo.steer` finds: F acts on the distance s that the rear axle rolls."""
    import jax.numpy as jnp

    def lagrangian(q: Any, v: Any) -> Any:
        turned = AXLE * v[2] * jnp.stack([-jnp.sin(q[2]), jnp.cos(q[2])])
        front = v[:2] + turned
        car = MASS * (v[0] ** 2 + v[1] ** 2) + INERTIA * v[2] ** 2
        return (car + WHEELS[0] * MASS * front @ front + WHEELS[1] * INERTIA * (v[2] + v[3]) ** 2) / 2

    def rolling(q: Any) -> Any:
        cos, sin, ahead, left = jnp.cos(q[2]), jnp.sin(q[2]), jnp.cos(q[2] + q[3]), jnp.sin(q[2] + q[3])
        rear, front = [-sin, cos, -AXLE, 0.0, 0.0], [-left, ahead, AXLE * jnp.cos(q[3]), 0.0, 0.0]
        return jnp.array([rear, front, [cos, sin, 0.0, 0.0, -1.0]])

    names, most = ("x", "y", "theta", "delta", "s"), np.array([0.0, 0.0, 0.0, TORQUE, THRUST])
    car = nh.LagrangeDAlembert(lagrangian, rolling, dimension=5, coordinates=names)
    rest = {"configuration": np.zeros(5), "body_velocity": np.zeros(5)}
    goal = rest | {"configuration": {"x": 0.0, "y": ASIDE, "theta": 0.0, "delta": 0.0}}
    how: dict[str, Any] = {"bounds": (-most, most), "state_bounds": {"delta": (-TURN, TURN)}, "guess": _path(steps + 1)}
    return nh.steer(nh.discretize(car, DURATION / steps), rest, goal, steps=steps, method="ipopt", **how)


def _path(nodes: int) -> np.ndarray:
    """Return three meters ahead and back again, and to the left."""
    part = np.linspace(0.0, 1.0, nodes)
    return np.stack([6.0 * np.minimum(part, 1.0 - part), ASIDE * part], axis=1)
