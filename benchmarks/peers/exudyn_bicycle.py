"""The benchmark bicycle in Exudyn: four rigid bodies, three hinges and two rolling discs, by the implicit trapezoid.

Parameters and settings are those of Exudyn's example `bicycleIftommBenchmark`; axes are x ahead, y left, z up.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np

REAR, FRONT = (0.0, 0.3, 2.0, 0.0603, 0.12), (1.02, 0.35, 3.0, 0.1405, 0.28)
"""Of wheels: place, radius, mass, moments of inertia across and along the axle."""
FRAME = (0.3, 0.9, 85.0, [[9.2, 0.0, -2.4], [0.0, 11.0, 0.0], [-2.4, 0.0, 2.8]])
FORK = (0.9, 0.7, 4.0, [[0.05892, 0.0, 0.00756], [0.0, 0.06, 0.0], [0.00756, 0.0, 0.00708]])
"""Of frames: place and height of the center of mass, mass, inertia."""
HINGE, TILT, GRAVITY = (0.82188470506, 0.0, 0.85595086466), np.pi / 10, np.array([0.0, 0.0, -9.81])
STEERING = np.array([-np.sin(TILT), 0.0, np.cos(TILT)])
"""The axis of the hinge between the frames, upright."""


class ExudynBicycle:
    """One assembled model, run as often as asked from the same start, upright with a speed and a rate of lean.

    Args:
        speed: v.
        lean_rate: About the line through the contacts.
        step: h.
        duration: T.
        stored: Whether motions of the bodies are kept.
    """

    def __init__(self, speed: float, lean_rate: float, step: float, duration: float, *, stored: bool) -> None:
        import exudyn
        from exudyn import utilities as items

        self.exudyn, self.system, self.start = exudyn, exudyn.SystemContainer().AddSystem(), (speed, lean_rate)
        wheels = [self._wheel(*wheel) for wheel in (REAR, FRONT)]
        frames = [self._body((x, 0.0, z), mass, inertia) for x, z, mass, inertia in (FRAME, FORK)]
        axles = [((x, 0.0, radius), (0.0, 1.0, 0.0)) for x, radius, *_ in (REAR, FRONT)]
        joints = [([w, f], *axle) for w, f, axle in zip(wheels, frames, axles, strict=True)]
        for bodies, place, axis in (*joints, (frames, HINGE, STEERING)):
            self.system.CreateRevoluteJoint(bodyNumbers=bodies, position=list(place), axis=list(axis))
        ground = self._marker(items, self.system.CreateGround())
        for body, (_, radius, *_) in zip(wheels, (REAR, FRONT), strict=True):
            markers = [ground, self._marker(items, body)]
            self.system.AddObject(items.ObjectJointRollingDisc(markerNumbers=markers, discRadius=radius))
        self.bodies, self.sensors = [*frames, *wheels], dict[tuple[int, str], Any]()
        for body in self.bodies if stored else ():
            for what in ("Position", "Velocity", "AngularVelocityLocal", "RotationMatrix"):
                how = {"storeInternal": True, "writeToFile": False}
                kind = getattr(exudyn.OutputVariableType, what)
                sensor = items.SensorBody(bodyNumber=body, outputVariableType=kind, **how)
                self.sensors[body, what] = self.system.AddSensor(sensor)
        self.system.Assemble()
        self.settings = _settings(exudyn, step, duration)

    def _marker(self, items: Any, body: Any) -> Any:
        return self.system.AddMarker(items.MarkerBodyRigid(bodyNumber=body))

    def _wheel(self, x: float, radius: float, mass: float, across: float, along: float) -> Any:
        turned = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # the axle of a disc is its x axis
        return self._body((x, 0.0, radius), mass, np.diag([along, across, across]), turned, self.start[0] / radius)

    def _body(self, place: Iterable[float], mass: float, inertia: Any, axes: Any = None, rolling: float = 0.0) -> Any:
        from exudyn.utilities import RigidBodyInertia

        (speed, lean), at = self.start, np.array(place)
        return self.system.CreateRigidBody(
            referencePosition=list(at),
            referenceRotationMatrix=np.eye(3) if axes is None else axes,
            initialVelocity=[speed, -lean * at[2], 0.0],
            initialAngularVelocity=[lean, rolling, 0.0],
            inertia=RigidBodyInertia(mass=mass, inertiaTensor=np.array(inertia)),
            gravity=list(GRAVITY),
        )

    def run(self) -> None:
        """Solve."""
        self.system.SolveDynamic(self.settings, solverType=self.exudyn.DynamicSolverType.TrapezoidalIndex2)

    def rows(self, body: int, what: str) -> np.ndarray:
        """Return times and what was kept of a body of `bodies`, after a run."""
        return self.system.GetSensorStoredData(self.sensors[self.bodies[body], what])

    def axes(self) -> tuple[np.ndarray, np.ndarray]:
        """Return times, and the axes of rear frame and fork as matrices, (K, 2, 3, 3)."""
        both = [self.rows(body, "RotationMatrix") for body in (0, 1)]
        return both[0][:, 0], np.stack([rows[:, 1:].reshape(-1, 3, 3) for rows in both], axis=1)

    def energy(self) -> np.ndarray:
        """Return the energies, seen from the ground."""
        total = np.zeros(1)
        inertias = [(m, np.array(tensor)) for *_, m, tensor in (FRAME, FORK)]
        inertias += [(m, np.diag([along, across, across])) for _, _, m, across, along in (REAR, FRONT)]
        names = ("Position", "Velocity", "AngularVelocityLocal")
        for body, (mass, inertia) in enumerate(inertias):
            place, velocity, omega = (self.rows(body, name)[:, 1:] for name in names)
            total = total + (mass * (velocity**2).sum(axis=1) + ((omega @ inertia) * omega).sum(axis=1)) / 2
            total -= mass * place @ GRAVITY
        return total


def _settings(exudyn: Any, step: float, duration: float) -> Any:
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = int(duration / step + 1e-9), duration
    integration.verboseMode = 0
    integration.generalizedAlpha.spectralRadius = 0.7
    integration.generalizedAlpha.computeInitialAccelerations = True
    integration.newton.useModifiedNewton = True
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = step
    return settings
