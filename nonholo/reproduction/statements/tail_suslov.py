"""Notes behind the end of the document: the integral of the discrete top in its principal frame."""

from nonholo.reproduction import _suslov_twin as data
from nonholo.reproduction import _twin as twin
from nonholo.reproduction._finding import Measured, finding
from nonholo.reproduction._twin import ctx
from nonholo.reproduction.formulas import suslov_integrals as formulas


@finding(
    "principal-frame-integral",
    "equation",
    "Notes behind the end of the document",
    r"In the frame where $J$ is diagonal the integral (sus_int) is $(M, \hat\Lambda M)$ with the printed matrix, "
    r"$\gamma$ being the forbidden axis.",
    tolerance=1e-45,
)
def principal_frame() -> Measured:
    """Turn bodies and momenta from the principal frame to one whose third axis is the forbidden one."""
    missed = []
    for masses in data.MASSES:
        values = [ctx.mpf(x) for x in masses]
        for seed, M in ((1, [1, 0, 0]), (2, [0.3, -2, 1.1]), (3, [-1, 0.5, 4])):
            S = data.attitude(seed, 3)
            form = ctx.matrix(formulas.principal_frame_form(values, list(S[:, 2])))
            momentum = ctx.matrix(M)
            turned = S.T * momentum
            value = formulas.quadratic(S.T * ctx.diag(values) * S, list(turned))
            missed.append(value - (momentum.T * form * momentum)[0])
            missed += list(form * S[:, 2])
    return Measured(twin.worst(missed), note="three bodies, three axes and momenta")
