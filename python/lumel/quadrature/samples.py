"""Samples of an integrand and of its densities, in batches that are independent replicas of each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import Problem, SettingsError

Array = NDArray[np.float64]
Function = Callable[[Array], ArrayLike]  # points (n,) or (n, d) -> (n,); an integrand may return (n, c)
Sampler = Callable[[np.random.Generator, int], ArrayLike]  # (rng, n) -> points (n,) or (n, d)

Shapes = tuple[tuple[int, ...], tuple[int, ...]]


@dataclass(frozen=True, eq=False)
class Draw:
    """Samples of one kind, `m` in each of B batches of c channels: points x (B, m) or (B, m, d) and the values there.

    f (B, m, c) is the integrand, g (B, m) the target density, p (B, m) and p_g (B, m) the densities of the two samplers.
    """

    x: Array
    f: Array
    g: Array
    p: Array
    p_g: Array

    def join(self, other: Draw) -> Draw:
        """The batches of both."""
        return Draw(*(np.concatenate([getattr(self, field.name), getattr(other, field.name)]) for field in fields(self)))


@dataclass(frozen=True, eq=False)
class Samples:
    """`shot` was drawn from p, `gathered` (or None) from p_g; `scalar` says that f came without channels."""

    shot: Draw
    gathered: Draw | None
    scalar: bool

    @property
    def batches(self) -> int:
        """How many independent replicas there are."""
        return self.shot.g.shape[0]

    @property
    def n(self) -> int:
        """How many samples were drawn from p."""
        return self.shot.g.size

    @property
    def n_g(self) -> int:
        """How many samples were drawn from p_g."""
        return self.gathered.g.size if self.gathered else 0

    def join(self, other: Samples) -> Samples:
        """The batches of both, in this order, as if they had been drawn together. Raises SettingsError where they do not match."""
        mine, theirs = (
            {name: draw.f.shape[1:] for name, draw in (("n", s.shot), ("n_g", s.gathered)) if draw} | {"f": s.scalar} for s in (self, other)
        )
        if mine != theirs:
            raise SettingsError(f"other: batches of {theirs}; allowed: batches of {mine}")
        gathered = self.gathered.join(other.gathered) if self.gathered and other.gathered else None
        return Samples(self.shot.join(other.shot), gathered, self.scalar)


def draw(
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
    first: int = 0,
) -> Samples:
    """Draw n samples of p and n_g samples of p_g (g where it is None) in equal batches, and evaluate f, g, p and p_g at them.

    Batches are numbered from `first`, and each has random streams of its own, keyed by (seed, number): the batches 0 to 7 joined
    with the batches 8 to 15 are the same bytes as 0 to 15 drawn at once. Points that depend on each other within one call of a
    sampler (stratified, quasi-random) are welcome, as batches stay independent. Raises SettingsError with all problems of a batch.
    """
    _check_counts(n, seed, sample_g, n_g, p_g, batches, first)
    target = p_g or g
    shot: list[Draw] = []
    gathered: list[Draw] = []
    shapes = set()  # of one point and of one value of f
    for batch in range(first, first + batches):
        problems: list[Problem] = []
        streams = (np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(batch, kind))) for kind in (0, 1))
        points = _points("sample_p", sample_p, next(streams), n // batches)
        values, shape = _evaluate(f, g, p, target, points, problems)
        _check_positive("p", "sample_p", values.p, points, problems)
        shot.append(values)
        shapes.add(shape)
        if sample_g and n_g:
            points = _points("sample_g", sample_g, next(streams), n_g // batches)
            values, shape = _evaluate(f, g, p, target, points, problems)
            _check_positive("p_g" if p_g else "g", "sample_g", values.p_g, points, problems)
            gathered.append(values)
            shapes.add(shape)
        if problems:
            raise SettingsError(problems)
    if len(shapes) > 1:
        pairs = ", ".join(f"{point} and {value}" for point, value in sorted(shapes))
        raise SettingsError(
            f"f, sample_p, sample_g: the shapes of a point and of a value of f differ between calls ({pairs}); allowed: the same"
        )
    return Samples(_stack(shot), _stack(gathered) if gathered else None, scalar=shapes == {(shot[0].x.shape[1:], ())})


def evaluate(name: str, function: Function, x: Array, problems: list[Problem], *, channels: bool = False) -> Array:
    """`function` at the points, float64 of shape (n,), or (n, c) with `channels`; adds what is wrong to the problems."""
    n = len(x)
    values = np.asarray(function(x))
    allowed = f"({n},)" + (f" or ({n}, c)" if channels else "")
    if values.shape != (n,) and not (channels and values.ndim == 2 and values.shape[0] == n and values.shape[1] > 0):
        problems.append(Problem(f"{name}: returned shape {values.shape} for {n} points; allowed: {allowed}"))
        return np.ones(n)
    if values.dtype.kind not in "buif":
        problems.append(Problem(f"{name}: returned values of type {values.dtype}; allowed: real numbers"))
        return np.ones(n)
    values = values.astype(np.float64)
    if not np.isfinite(values).all():
        _report(name, values, ~np.isfinite(values), x, "finite numbers", problems)
    elif not channels and (values < 0).any():
        _report(name, values, values < 0, x, "densities of 0 or more", problems)
    return values


def points_of(name: str, value: ArrayLike, n: int | None = None) -> Array:
    """Points as float64 of shape (n,) or (n, d), all finite. Raises SettingsError."""
    x = np.asarray(value)
    if x.ndim not in (1, 2) or x.size == 0 or (n is not None and len(x) != n):
        count = "n" if n is None else n
        raise SettingsError(f"{name}: shape {x.shape}; allowed: ({count},) or ({count}, d)")
    if x.dtype.kind not in "buif" or not np.isfinite(x).all():
        raise SettingsError(f"{name}: holds what is not a finite number; allowed: finite real numbers")
    return x.astype(np.float64)


def _points(name: str, sampler: Sampler, rng: np.random.Generator, n: int) -> Array:
    return points_of(name, sampler(rng, n), n)


def _evaluate(f: Function, g: Function, p: Function, p_g: Function, x: Array, problems: list[Problem]) -> tuple[Draw, Shapes]:
    """All functions at the points of one batch; says also of which shape one point and one value of f are."""
    integrand = evaluate("f", f, x, problems, channels=True)
    target = evaluate("g", g, x, problems)
    density = evaluate("p", p, x, problems)
    other = target if p_g is g else evaluate("p_g", p_g, x, problems)
    return Draw(x, integrand.reshape(len(x), -1), target, density, other), (x.shape[1:], integrand.shape[1:])


def _stack(parts: list[Draw]) -> Draw:
    return Draw(*(np.stack([getattr(part, field.name) for part in parts]) for field in fields(Draw)))


def _report(name: str, values: Array, wrong: NDArray[np.bool_], x: Array, allowed: str, problems: list[Problem]) -> None:
    """Add the first of the wrong values, and how many there are, to the problems."""
    first = tuple(int(i) for i in np.argwhere(wrong)[0])
    count = int(wrong.sum())
    message = f"{name}: {values[first]} at x = {x[first[0]].tolist()}, and {count - 1} more like it; allowed: {allowed}"
    problems.append(Problem(message))


def _check_positive(name: str, sampler: str, values: Array, x: Array, problems: list[Problem]) -> None:
    if (values == 0).any():
        _report(name, values, values == 0, x, f"more than 0 wherever {sampler} draws points", problems)


def check_whole(name: str, value: object, least: int) -> str:
    """What is wrong with a whole number, or nothing."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    return "" if whole and int(value) >= least else f"{name}: {value!r}; allowed: whole numbers of {least} or more"  # type: ignore[call-overload]


def _check_counts(n: int, seed: int, sample_g: Sampler | None, n_g: int, p_g: Function | None, batches: int, first: int) -> None:
    least = (("n", n, 4), ("seed", seed, 0), ("n_g", n_g, 0), ("batches", batches, 2), ("first", first, 0))
    texts = [text for name, value, low in least if (text := check_whole(name, value, low))]
    if not texts:
        for name, value in (("n", n), ("n_g", n_g)):
            if value % batches:
                below = max(value // batches, 1) * batches
                texts.append(f"{name}: {value} is no multiple of batches = {batches}; allowed: for example {below} or {below + batches}")
    if n_g and not sample_g:
        texts.append(f"n_g: {n_g} without sample_g; allowed: 0, or a sampler as sample_g")
    if p_g and not sample_g:
        texts.append("p_g: given without sample_g; allowed: None, or a sampler as sample_g")
    if texts:
        raise SettingsError([Problem(text) for text in texts])
