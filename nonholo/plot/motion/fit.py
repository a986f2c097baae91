"""The likelihood profile of a fitted number beside the parabola of the linearized model.

Deviations of measurements from a fitted motion, against time.
"""

from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from nonholo.analysis.inverse import Fit, Profile
from nonholo.plot import theme

_WIDE = 6.0  # standard deviations that are drawn of a side without bound


@theme.in_style
def fit_profile(profile: Profile) -> Any:
    r"""Draw $\tau^2$, the growth of the sum of squares in units of the noise, with the parabola, and the interval.

    Args:
        profile: The result of `Fit.profile`.

    Returns:
        The matplotlib figure.
    """
    half, wide = profile.cut * profile.error, _WIDE * profile.error
    ends = np.array(profile.interval) - profile.value
    low, high = np.where(np.isfinite(ends), ends, (-wide, wide))
    across = profile.value + 1.15 * np.linspace(min(low, -half), max(high, half), 400)
    within = across[(across >= profile.values[0]) & (across <= profile.values[-1])]
    tau = PchipInterpolator(profile.values, profile.statistic)(within)
    figure = theme.new_figure((7.0, 4.0))
    axes = figure.subplots()
    axes.axvspan(*np.clip(profile.interval, across[0], across[-1]), color=theme.INSIDE, lw=0)
    axes.axhline(profile.cut**2, color=theme.MUTED, lw=0.8)
    axes.plot(across, ((across - profile.value) / profile.error) ** 2, "--", color=theme.MUTED, label="linearized")
    axes.plot(within, tau**2, color=theme.DISCRETE, label="profile")
    axes.set(xlim=across[[0, -1]], ylim=(0, 1.6 * profile.cut**2), xlabel=profile.name)
    axes.set_ylabel(r"growth of the sum of squares, $\tau^2$")
    words = " and ".join(f"{end:.3g}".replace("inf", "$\\infty$").replace("-", "\u2212") for end in profile.interval)
    axes.set_title(f"{profile.name}: {100 * profile.level:g} % between {words}")
    axes.legend(frameon=False)
    return figure


_UNITS = {"position": "position, length", "turn": "turn, rad", "rate": "angular velocity, rad / time"}


@theme.in_style
def fit_residuals(fit: Fit) -> Any:
    """Draw the residuals of a fit against time, a panel for each kind of number, with a band of two noise levels.

    Args:
        fit: The result of `nh.fit`.

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
