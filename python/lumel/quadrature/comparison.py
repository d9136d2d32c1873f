"""All estimators on the same samples, side by side with what theory predicts for them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .estimates import Estimate, PerEstimator, Terms, estimate, no_overflow, shaped, standard_error, sum_of
from .samples import Array, Draw, Function, Sampler, Samples, draw
from .student import t_probability
from .theory import Conditions, Nodes, Prediction, predict_at

SIGNIFICANCE = 1e-3  # of the test of support: so often it fails where all is well
SAME = 1e-6  # E[G] this near to 1 is 1: densities may be computed in single precision


@dataclass(frozen=True, eq=False)
class Support:
    """Whether samples cover the target density: a t-test of E[G] = E[g/p] against 1, which is the integral of g.

    `mean` and `stderr` are those of G, `p_value` is that of the test. `holes` counts the samples of p_g at which p is 0, each a proof
    that p misses a part of p_g. `covered` is False where there is a hole, or G is off by more than chance explains (at 1e-3).
    Then F misses a part of f, and F/G converges to a wrong value; either g or p may also not be normalised.
    """

    mean: float
    stderr: float
    dof: int
    p_value: float
    holes: int
    covered: bool

    @property
    def missing(self) -> float:
        """The share of g that samples miss, by their own account: 1 - E[G]. Negative values are noise, or a g or p that is no density."""
        return 1 - self.mean

    def __str__(self) -> str:
        verdict = "covered" if self.covered else f"NOT covered: {self.missing:.3g} of g is missing"
        holes = f", p is 0 at {self.holes} samples of g" if self.holes else ""
        return f"E[g/p] = {self.mean:.6g} +- {self.stderr:.2g} (p-value {self.p_value:.2g}{holes}): {verdict}"


@dataclass(frozen=True, eq=False)
class Analysis(PerEstimator[Estimate]):
    """Estimates of the integral of f, and what is known about them.

    `predicted_mse` holds arrays () or (c,), computed from the samples themselves. `hits` counts samples with g > 0, `effective_hits` is
    (sum of weights)^2 / sum of their squares, and `largest_weight` the largest g/q, which G is the sum of (q = n p for shooting alone).
    """

    predicted_mse: PerEstimator[Array]
    support: Support
    hits: int
    effective_hits: float
    largest_weight: float


@dataclass(frozen=True, eq=False)
class Comparison(Analysis):
    """The outcome of `compare`: `classical`, `weighted` and `regression` from the n samples of p.

    `improvement` estimates the classical mean square error less the weighted one, equation (4) less (3) of [WIS], with an error of its
    own: its `sign()` says which wins. `conditions` are those of [WIS] section 2 at the samples. `mixed` (None without samples of g)
    uses the n_g samples of p_g as well, all weighed by q = n p + n_g p_g: its `classical` is sum f/q (the balance heuristic), its
    `weighted` is sum f/q / sum g/q.
    """

    improvement: Estimate
    conditions: Conditions
    mixed: Analysis | None
    n: int
    n_g: int
    batches: int

    def __str__(self) -> str:
        lines = [f"{self.n} samples in {self.batches} batches" + (f", and {self.n_g} samples of g" if self.mixed else "")]
        for title, part in (("", self), ("mixed ", self.mixed)):
            if part is None:
                continue
            for name in ("classical", "weighted", "regression"):
                rms = ", ".join(f"{e:.2g}" for e in np.sqrt(np.ravel(getattr(part.predicted_mse, name))))
                lines.append(f"  {title + name:<18} {getattr(part, name)}   predicted RMSE {rms}")
        words = {1: "weighted wins", -1: "classical wins", 0: "undecided"}
        verdict = ", ".join(words[int(sign)] for sign in np.ravel(self.improvement.sign()))
        lines.append(f"  improvement        {self.improvement}: {verdict}")
        lines.append(f"  support            {self.support}")
        return "\n".join(lines)


def compare(
    f: Function,
    g: Function,
    p: Function,
    sample_p: Sampler,
    *,
    n: int = 4096,
    seed: int = 0,
    sample_g: Sampler | None = None,
    n_g: int = 0,
    p_g: Function | None = None,
    batches: int = 16,
) -> Comparison:
    """Estimate the integral of f over the whole space in every way from n samples, a multiple of `batches`, and say which way is best.

    f: integrand, (n,) or (n, c) at points (n,) or (n, d). g: target density, known to integrate to 1, best close to f/F. p: density
    of `sample_p(rng, n)`, more than 0 wherever f or g is. Both densities are normalised. `sample_g` draws from the density p_g
    (g itself where that is None), n_g points in all, a multiple of `batches`; 0 switches mixing off.
    The same seed gives the same bytes. Raises SettingsError naming the argument and the first point at which it is wrong.
    """
    return analyse(draw(f, g, p, sample_p, n=n, seed=seed, sample_g=sample_g, n_g=n_g, p_g=p_g, batches=batches))


def analyse(samples: Samples) -> Comparison:
    """The comparison from samples that were drawn before, and perhaps joined."""
    with no_overflow():
        alone, prediction = _analyse([samples.shot], samples.n, 0, samples.batches, samples.scalar)
        mixed = None
        holes = 0
        if samples.gathered:
            mixed, _ = _analyse([samples.shot, samples.gathered], samples.n, samples.n_g, samples.batches, samples.scalar)
            holes = int((samples.gathered.p == 0).sum())
        support = replace(alone.support, holes=holes, covered=alone.support.covered and holes == 0)
        return Comparison(
            **vars(alone) | {"support": support},
            improvement=_improvement(samples),
            conditions=prediction.conditions,
            mixed=mixed,
            n=samples.n,
            n_g=samples.n_g,
            batches=samples.batches,
        )


def _analyse(kinds: Sequence[Draw], n: int, n_g: int, batches: int, scalar: bool) -> tuple[Analysis, Prediction]:
    """Estimates, prediction and support from samples of one kind or of both, each weighed by the same q."""
    qs = [n * kind.p + n_g * kind.p_g for kind in kinds]
    terms = [Terms(batches * kind.f / q[..., None], batches * kind.g / q) for kind, q in zip(kinds, qs, strict=True)]
    estimates = estimate(terms, scalar)

    def flat(name: str) -> Array:
        arrays = [getattr(kind, name) for kind in kinds]
        return np.concatenate([array.reshape(-1, *array.shape[2:]) for array in arrays])

    q = np.concatenate([q.ravel() for q in qs])
    nodes = Nodes(flat("x"), flat("f"), flat("g"), flat("p"), flat("p_g"), 1 / q)
    prediction = predict_at(nodes, n, n_g, scalar=scalar, sampled=True)
    weights = nodes.g / q
    largest = weights.max()
    relative = weights / largest if largest > 0 else weights
    analysis = Analysis(
        estimates.classical,
        estimates.weighted,
        estimates.regression,
        prediction.mse,
        _support(sum_of([kind.g.sum(1) for kind in terms])),
        int((nodes.g > 0).sum()),
        float(relative.sum() ** 2 / (relative**2).sum()) if largest > 0 else 0.0,
        float(largest),
    )
    return analysis, prediction


def _support(G_b: Array) -> Support:
    """Test the means of g/p of the batches against 1."""
    mean, error, dof = float(G_b.mean()), float(standard_error(G_b - G_b.mean())), len(G_b) - 1
    off = abs(mean - 1)
    t = off / error if off < error * 1e300 else np.inf
    p_value = 1 - t_probability(t, dof) if off > SAME else 1.0
    return Support(mean, error, dof, p_value, 0, p_value >= SIGNIFICANCE)


def _improvement(samples: Samples) -> Estimate:
    """[WIS] eq. 4 less eq. 3, (2 R Cov(f/p, g/p) - R^2 Var(g/p)) / n with R = F/G, with its delta-method error over batches."""
    p = samples.shot.p[..., None]
    f, g = samples.shot.f / p, samples.shot.g[..., None] / p
    unit = np.abs(f).max() or 1.0  # the error takes fourth powers: keep them in the range of floats
    f = f / unit
    F, G = f.mean((0, 1)), g.mean((0, 1))
    R = F / G if G[0] > 0 else F
    u, v = f - F, g - G
    covariance, variance = (u * v).mean((0, 1)), (v * v).mean((0, 1))
    # What one sample adds, by the moments and by way of R.
    term = 2 * R * u * v - R**2 * v * v
    slope = 2 * (covariance - R * variance)
    term = term + slope * (f - R * g) / (G if G[0] > 0 else 1.0)
    value = 2 * R * covariance - R**2 * variance
    value, error = (unit**2 * part / samples.n for part in (value, standard_error(term.mean(1) - value)))
    if int((samples.shot.g.sum(1) > 0).sum()) < 2:
        error = np.full_like(error, np.inf)
    return Estimate(shaped(value, samples.scalar), shaped(error, samples.scalar), samples.batches - 1)
