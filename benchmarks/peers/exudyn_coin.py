"""A coin that rolls and wobbles, of Exudyn's own tests (rollingCoinTest): a rigid body with a rolling disc joint."""

import warnings

import numpy as np


def contact(step: float, duration: float = 0.5) -> float:
    """Return x of the contact in the end, by the generalized-alpha method with the settings of the test."""
    import exudyn
    from exudyn.utilities import (
        MarkerBodyRigid,
        ObjectGround,
        ObjectJointRollingDisc,
        RigidBodyInertia,
        RotationMatrixY,
        Skew,
    )

    r, tilt, spin = 0.01, np.pi / 180, [0.0, 0.0, 10 * np.pi]
    system = exudyn.SystemContainer().AddSystem()
    body = system.CreateRigidBody(
        referencePosition=[r * np.sin(tilt), 0.0, r * np.cos(tilt)],
        referenceRotationMatrix=RotationMatrixY(tilt),
        initialVelocity=Skew(spin) @ RotationMatrixY(tilt) @ [0.0, 0.0, r],
        initialAngularVelocity=spin,
        inertia=RigidBodyInertia(mass=1.0, inertiaTensor=np.diag([0.5, 0.25, 0.25]) * r**2),
        gravity=[0.0, 0.0, -9.81],
        returnDict=True,
    )["bodyNumber"]
    ground = system.AddObject(ObjectGround())
    markers = [system.AddMarker(MarkerBodyRigid(bodyNumber=each, localPosition=[0.0] * 3)) for each in (ground, body)]
    disc = system.AddObject(ObjectJointRollingDisc(markerNumbers=markers, constrainedAxes=[1, 1, 1], discRadius=r))
    system.Assemble()
    settings = exudyn.SimulationSettings()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # names of settings change
        settings.solutionSettings.writeSolutionToFile = False
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime = round(duration / step), duration
    method = integration.generalizedAlpha
    method.useIndex2Constraints = method.useNewmark = method.computeInitialAccelerations = True
    method.spectralRadius = 0.5
    system.SolveDynamic(settings)
    return float(system.GetObjectOutput(disc, exudyn.OutputVariableType.Position)[0])
