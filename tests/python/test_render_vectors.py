"""The BRDF of the core against the shared vectors."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from lumel import _core

TABLE_ERROR = 2e-4  # of the tabulated albedo


@cache
def glossy(alpha: float) -> _core.Material:
    """A white GGX lobe alone."""
    zero, one = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    return _core.Material.make(
        name="glossy", diffuse=zero, specular=one, mirror=zero, alpha=alpha, fresnel=False, eta=one, k=zero, two_sided=True
    )


def test_scatter_is_that_of_the_vectors(shared: Path) -> None:
    rows = np.genfromtxt(shared / "vectors/ggx_eval.csv", delimiter=",", names=True)
    for row in rows:
        wi, wo = ([float(row[f"{w}{axis}"]) for axis in "xyz"] for w in ("wi", "wo"))
        found = glossy(float(row["alpha"])).scatter_s(wi, wo)
        # Directions have 7 digits, which a sharp lobe turns into errors near its edge.
        assert found == pytest.approx([float(row["f_cos"])] * 3, rel=2e-4, abs=1e-7), row


def test_albedo_is_that_of_the_vectors(shared: Path) -> None:
    rows = np.genfromtxt(shared / "vectors/ggx_albedo.csv", delimiter=",", names=True)
    for row in rows:
        found = glossy(float(row["alpha"])).albedo_s(float(row["cos_theta"]))
        assert found == pytest.approx([float(row["albedo"])] * 3, abs=4 * float(row["stderr"]) + TABLE_ERROR), row


def test_albedo_of_the_roughest_lobe_is_known() -> None:
    assert glossy(1.0).albedo_s(1.0) == pytest.approx([1 - math.log(2)] * 3, abs=TABLE_ERROR)
