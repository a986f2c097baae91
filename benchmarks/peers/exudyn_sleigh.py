"""The sleigh in Exudyn: a plane rigid body with a disc of which only the sideways rolling constraint is active."""

from typing import Any

import numpy as np

from peers.problems import SLEIGH, Problem, planar_matrix


def model(problem: Problem, stored: bool) -> tuple[Any, Any, int]:
    """Return the module, the assembled system and the sensors' number; `stored` says whether all steps are kept."""
    import exudyn
    from exudyn import itemInterface as items  # noqa: N813

    m, J, a = (float(x) for x in (SLEIGH.mass, SLEIGH.inertia, SLEIGH.a))
    omega, v, _ = problem.velocity
    system = exudyn.SystemContainer().AddSystem()
    node = system.AddNode(items.NodeRigidBody2D(initialVelocities=[v, 0, omega]))
    body = items.ObjectRigidBody2D(mass=m, inertia=J + m * a * a, centerOfMass=[a, 0], nodeNumber=node)
    blade = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(body)))
    ground = system.AddMarker(items.MarkerBodyRigid(bodyNumber=system.AddObject(items.ObjectGround())))
    disc = items.ObjectJointRollingDisc(
        markerNumbers=[ground, blade], constrainedAxes=[1, 0, 0], discRadius=1.0, discAxis=[0, 1, 0]
    )
    system.AddObject(disc)
    first = -1
    if stored:
        kinds = (exudyn.OutputVariableType.Coordinates, exudyn.OutputVariableType.Coordinates_t)
        bodies = [
            system.AddSensor(
                items.SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=kind)
            )
            for kind in kinds
        ]
        first = bodies[0]
    system.Assemble()
    return exudyn, system, first


class ExudynSleigh:
    """One assembled model, run as often as asked from the same start."""

    def __init__(self, problem: Problem, h: float, steps: int, stored: bool) -> None:
        exudyn, self.system, self.sensor = model(problem, stored)
        self.settings = exudyn.SimulationSettings()
        integration = self.settings.timeIntegration
        integration.numberOfSteps, integration.endTime = steps, h * steps
        integration.verboseMode = 0
        integration.generalizedAlpha.spectralRadius = 1.0  # no numerical damping
        self.settings.solution.file.write = False
        self.settings.solution.sensors.writePeriod = h

    def run(self) -> None:
        """Solve."""
        self.system.SolveDynamic(self.settings)

    def states(self) -> tuple[np.ndarray, np.ndarray]:
        """Return body velocities and poses of all steps of the last run."""
        x, y, angle = self.system.GetSensorStoredData(self.sensor)[:, 1:4].T
        vx, vy, omega = self.system.GetSensorStoredData(self.sensor + 1)[:, 1:4].T
        cosine, sine = np.cos(angle), np.sin(angle)
        velocities = np.stack([omega, cosine * vx + sine * vy, -sine * vx + cosine * vy], axis=1)
        poses = np.array([planar_matrix(*row) for row in zip(cosine, sine, x, y, strict=True)])
        return velocities, poses
