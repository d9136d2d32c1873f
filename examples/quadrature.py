"""Where weighted importance sampling wins and where it loses, by theory and by experiment: writes quadrature.png.

python examples/quadrature.py [SEEDS]
"""

import sys
from functools import partial

import matplotlib.pyplot as plt
import numpy as np

from lumel import quadrature as qd

POINTS, WEIGHTS = qd.grid(0, 1, 10_000)
COUNTS = (64, 256, 1024)


def g(x: qd.Array) -> qd.Array:
    return np.asarray(5 * x**4)


def f(x: qd.Array, spot: float) -> qd.Array:  # the lobe g sees smooth light and, by that share, a bright spot far from its middle
    return np.asarray(g(x) * ((1 - spot) * (0.5 + 0.6 * x) + spot * 300 * (np.abs(x - 0.3) < 0.1)))


def main(seeds: str = "200") -> None:
    figure, axes = plt.subplots(2, 3, figsize=(15, 8), layout="constrained")
    for (top, bottom), spot, title in ((axes[:, 0], 0.0, "smooth light: weighted wins"), (axes[:, 1], 0.5, "bright spot: weighted loses")):
        light = partial(f, spot=spot)
        theory = [qd.predict(light, g, np.ones_like, POINTS, n=n, weights=WEIGHTS) for n in COUNTS]
        truth, where = theory[0].value, theory[0].conditions
        top.plot(POINTS, np.stack([light(POINTS) / truth, g(POINTS), np.ones_like(POINTS)], 1), label=["f/F", "g", "p"])
        top.fill_between(POINTS, 0, 10, where=where.above | where.below, alpha=0.2, label="conditions of section 2 hold")
        top.set(title=title, xlabel="x", ylim=(0, 10))
        runs = [qd.experiment(light, g, np.ones_like, np.random.Generator.random, truth=truth, n=n, seeds=int(seeds)) for n in COUNTS]
        for name in ("classical", "weighted", "regression"):
            line = bottom.loglog(COUNTS, [getattr(t.mse, name) for t in theory], label=f"{name}, predicted")[0]
            bottom.plot(COUNTS, [getattr(r, name).mse for r in runs], "o", color=line.get_color(), label="measured")
        bottom.set(xlabel="samples", ylabel="mean square error")
    shares = np.linspace(0, 0.5, 51)
    for panel, n_g in ((axes[0, 2], 0), (axes[1, 2], 64)):
        theory = [qd.predict(partial(f, spot=s), g, np.ones_like, POINTS, n=256, n_g=n_g, weights=WEIGHTS) for s in shares]
        for name in ("classical", "weighted", "regression"):
            panel.semilogy(shares, [np.sqrt(getattr(t.mse, name)) / t.value for t in theory], label=name)
        panel.set(title=f"256 samples of p and {n_g} of g", xlabel="share of the spot", ylabel="relative error", ylim=(3e-3, 0.3))
    for each in axes.flat:
        each.legend()
    figure.savefig("quadrature.png")


if __name__ == "__main__":
    main(*sys.argv[1:])
