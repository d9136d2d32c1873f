"""Figure 4 of the paper: the error over iterations, classical against weighted, of rays and of bundles."""

from __future__ import annotations

import numpy as np

from . import iterations, plots
from .areas import Doubles, Truth
from .figure import Curve, Figure, Table, gain, times
from .iterations import DIRECTIONS, ESTIMATORS, RAYS, SOLVE, TRANSPORTS, Iterations
from .lab import BOX, Lab

WORKS = iterations.WORKS


def make(lab: Lab) -> Figure:
    """Relative RMSE over iterations in a panel for each transport."""
    runs, truth = iterations.of_box(lab), lab.truth(BOX)
    error = {key: relative_rmse(truth, value) for key, value in runs.value.items()}
    last = {key: float(mean[-1]) for key, (mean, _) in error.items()}
    rows = [
        (transport, name, at, float(error[transport, name][0][i]), float(error[transport, name][1][i]))
        for transport, name in error
        for i, at in enumerate(runs.at)
    ]
    return Figure(
        title="Figure 4: error over iterations, classical against weighted, rays and bundles",
        scene=lab.scene(BOX).source,
        shows=f"""Root mean square error of the light in gloss over the {len(truth.index)} glossy patches in view, divided by their mean
        light, after so many iterations: {runs.said}. An iteration solves with {SOLVE:,} rays and shoots {RAYS:,} rays, or {DIRECTIONS}
        directions of bundles, from what it solved. Nothing is gathered. `auto`, ours, reads the very samples of `weighted`. The truth
        gathers many rays an area, with another seed; its noise is subtracted.""",
        claim="""Figure 4 of the paper plots the errors of plain and of weighted shooting over iterations. Each should fall with the
        square root of the iterations, as the dashed guide does, and the weighted one lie below where g is nearer to the integrand than
        p is ([WIS] section 2), for rays and for bundles.""",
        found=[_found(runs, last, transport) for transport in TRANSPORTS],
        curves=[Curve("figure4", "error over iterations by transport and estimator", _draw(runs, error))],
        tables=[Table("figure4", "Relative RMSE", ("transport", "estimator", "iterations", "relative RMSE", "standard error"), rows)],
    )


def relative_rmse(truth: Truth, value: Doubles) -> tuple[Doubles, Doubles]:
    """Root of the mean square error over areas, channels and runs, by iteration, over the mean of the truth; and its standard error."""
    squared = truth.error(value).mean(axis=-1) / truth.mean**2  # runs, iterations
    mean = np.maximum(squared.mean(axis=0), 0)
    spread = squared.std(axis=0, ddof=1) / np.sqrt(len(squared)) if len(squared) > 1 else np.zeros_like(mean)
    root = np.sqrt(mean)
    return root, np.divide(spread, 2 * root, out=np.zeros_like(root), where=root > 0)


def _found(runs: Iterations, last: dict[tuple[str, str], float], transport: str) -> str:
    gains = [times(gain(last[transport, "classical"] ** 2, last[transport, name] ** 2)) for name in ESTIMATORS[1:]]
    cost = runs.seconds[transport, "weighted"] / runs.seconds[transport, "classical"]
    return (
        f"{transport.capitalize()}, after {runs.at[-1]} iterations: the mean square error of `classical` is {gains[0]} that of "
        f"`weighted` and {gains[1]} that of `auto`; a weighted iteration takes {cost:.2f} times as long as a classical one."
    )


def _draw(runs: Iterations, error: dict[tuple[str, str], tuple[Doubles, Doubles]]) -> str:
    x = np.array(runs.at, np.float64)
    with plots.panels(TRANSPORTS, share_y=True) as (figure, axes):
        for panel, transport in zip(axes, TRANSPORTS, strict=True):
            for name in ESTIMATORS:
                mean, spread = error[transport, name]
                plots.line(panel, x, mean, name, error=spread)
            plots.slope(panel, x, 0.5 * float(error[transport, "weighted"][0][0]), -0.5, "n$^{-1/2}$")
            panel.set(xscale="log", xlabel="iterations")
            plots.logarithmic(panel)
            plots.plain_ticks(panel, [2.0**i for i in range(int(np.log2(x[-1])) + 1)])
        axes[0].set_ylabel("relative RMSE of the light in gloss")
        axes[0].legend()
        return plots.to_svg(figure, "figure4")
