"""The likelihood profile of a fitted number beside the parabola of the linearized model."""

from typing import TYPE_CHECKING, Any

import numpy as np

from nonholo.plotting import theme

if TYPE_CHECKING:
    from nonholo.analysis.inverse import Profile

_WIDE = 6.0  # standard deviations that are drawn of a side without bound


@theme.styled
def fit_profile(profile: "Profile") -> Any:
    r"""Draw $\tau^2$, the growth of the sum of squares in units of the noise, with the parabola, and the interval.

    Args:
        profile: What `Fit.profile` returned.

    Returns:
        The matplotlib figure.
    """
    from scipy.interpolate import PchipInterpolator

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
