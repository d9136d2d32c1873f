"""Student's t distribution for whole degrees of freedom, in closed form (Abramowitz and Stegun, 26.7.3 and 26.7.4)."""

from __future__ import annotations

import math
from functools import lru_cache

from ..errors import SettingsError


def t_probability(t: float, dof: int) -> float:
    """The probability that |T| <= t for Student's T with `dof` >= 1 degrees of freedom; t >= 0, infinity included."""
    if dof < 1:
        raise SettingsError(f"dof: {dof}; allowed: 1 or more")
    if not t >= 0:
        raise SettingsError(f"t: {t}; allowed: 0 or more")
    return _probability(math.atan2(t, math.sqrt(dof)) if math.isfinite(t) else math.pi / 2, dof)


@lru_cache(maxsize=256)
def t_quantile(level: float, dof: int) -> float:
    """The t for which |T| <= t has probability `level` (0 < level < 1), as 2.131 for level 0.95 and 15 degrees of freedom."""
    if not 0 < level < 1:
        raise SettingsError(f"level: {level}; allowed: between 0 and 1, both excluded")
    if dof < 1:
        raise SettingsError(f"dof: {dof}; allowed: 1 or more")
    # Bisect the angle, which is bounded where t is not.
    low, high = 0.0, math.pi / 2
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _probability(middle, dof) < level else (low, middle)
    return math.tan(0.5 * (low + high)) * math.sqrt(dof)


def _probability(angle: float, dof: int) -> float:
    """P(|T| <= sqrt(dof) tan(angle)): a finite series in the cosine."""
    cosine = math.cos(angle)
    if dof == 1:
        return 2 * angle / math.pi
    odd = dof % 2
    term = cosine if odd else 1.0
    total = term
    for k in range(2 + odd, dof, 2):
        term *= cosine * cosine * (k - 1) / k
        total += term
    total *= math.sin(angle)
    return min(1.0, 2 / math.pi * (angle + total) if odd else total)
