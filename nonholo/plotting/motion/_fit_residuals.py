"""What measurements miss of a fitted motion, against time."""

from typing import TYPE_CHECKING, Any

from nonholo.plotting import theme

if TYPE_CHECKING:
    from nonholo.analysis.inverse import Fit

_UNITS = {"position": "position, length", "turn": "turn, rad", "rate": "angular velocity, rad / time"}


@theme.styled
def fit_residuals(fit: "Fit") -> Any:
    """Draw the residuals of a fit against time, a panel for each kind of number, with a band of two noise levels.

    Args:
        fit: What `nh.fit` returned.

    Returns:
        The matplotlib figure.
    """
    orbits = fit.orbit if isinstance(fit.orbit, tuple) else (fit.orbit,)
    figure = theme.new_figure((7.0, 2.2 * len(fit.noise) + 0.4))
    panels = figure.subplots(len(fit.noise), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (kind, level) in zip(panels, fit.noise.items(), strict=True):
        axes.axhspan(-2 * level, 2 * level, color=theme.LEVEL, alpha=0.4, lw=0)
        axes.axhline(0.0, color=theme.MUTED, lw=0.8)
        for orbit, residuals in zip(orbits, fit.residuals, strict=True):
            for column, color in zip(residuals[kind].T, theme.COMPONENTS, strict=False):
                axes.plot(orbit.time, column, ".", ms=4, color=color)
        axes.set_ylabel(_UNITS[kind])
    panels[0].set_title("measured minus fitted; the band is two noise levels")
    panels[-1].set_xlabel("time since the first sample")
    return figure
