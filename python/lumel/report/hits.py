"""What weighting is worth by how often an area of interest was hit."""

from __future__ import annotations

import numpy as np

from . import iterations, plots
from .areas import Doubles, Truth
from .figure import Curve, Figure, Table, gain, span
from .iterations import ESTIMATORS, Iterations
from .lab import BOX, Lab

WORKS = iterations.WORKS
TRANSPORT = "rays"
FEWEST = 50  # areas, over all iterations and runs, that a bin must hold


def make(lab: Lab) -> Figure:
    """Errors and gain by hits, over all areas, iterations and runs of figure 4."""
    runs, truth = iterations.of_box(lab), lab.truth(BOX)
    found = {name: by_hits(runs, truth, name) for name in ESTIMATORS}
    common = sorted(set.intersection(*(set(bins) for bins in found.values())))
    gains = {name: [gain(found["classical"][b] ** 2, found[name][b] ** 2) for b in common] for name in ESTIMATORS[1:]}
    rows = [(2**b, *(found[name][b] for name in ESTIMATORS), *(gains[name][i] for name in gains)) for i, b in enumerate(common)]
    return Figure(
        title="Gain by hits",
        scene=lab.scene(BOX).source,
        shows="""The areas of figure 4 (rays, nothing gathered), sorted by how many samples they should have got by then: as many of those
        of all iterations and runs as had been shot. (Sorted by what they had got, areas with few would be those too dark by chance.)
        Left: relative RMSE; right: how many times larger the mean square error of `classical` is.""",
        claim="""Not in the paper. With few hits a ratio has a bias of order 1/n, and may take one bright sample for the whole lobe;
        with many it keeps a constant gain, that of [WIS] equation 3.""",
        found=[f"From {2 ** min(common)} to {2 ** (max(common) + 1)} hits the gain of `{n}` is {span(gains[n])}." for n in gains if common],
        curves=[Curve("hits", "error and gain by hits", _draw(common, found, gains))],
        tables=[Table("hits", "By hits", ("hits, from", *(f"RMSE {n}" for n in ESTIMATORS), *(f"gain of {n}" for n in gains)), rows)],
    )


def expected_hits(runs: Iterations, estimator: str) -> Doubles:
    """(runs, k, areas): samples that an area should have after each iteration, as the last one of all runs tells."""
    hits = runs.hits[TRANSPORT, estimator]
    shares = np.array(runs.at)[:, None] / runs.at[-1]
    return np.broadcast_to(hits[:, -1].mean(axis=0) * shares, hits.shape)


def by_hits(runs: Iterations, truth: Truth, estimator: str) -> dict[int, float]:
    """Relative RMSE by the binary logarithm of hits, of the areas that should have so many up to twice as many."""
    value, hits = runs.value[TRANSPORT, estimator], expected_hits(runs, estimator)
    e = 0.01 * truth.mean**2
    squared: Doubles = truth.error(value) / (np.mean(truth.value**2, axis=-1) + e)
    bins = np.floor(np.log2(np.maximum(hits, 0.5))).astype(int)  # -1: none
    found = {int(b): float(squared[bins == b].mean()) for b in np.unique(bins[bins >= 0]) if (bins == b).sum() >= FEWEST}
    return {b: float(np.sqrt(mean)) for b, mean in found.items() if mean > 0}


def _draw(bins: list[int], found: dict[str, dict[int, float]], gains: dict[str, list[float]]) -> str:
    x = [2.0**b * np.sqrt(2) for b in bins]
    error = {name: [found[name][b] for b in bins] for name in ESTIMATORS}
    ticks = [4.0**i for i in range(1, 9) if min(x, default=1) <= 4.0**i <= max(x, default=1)]
    return plots.error_and_gain("hits", ("error", "gain over classical"), x, error, gains, xlabel="expected hits of the area", ticks=ticks)
