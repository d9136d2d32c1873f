"""Gloss whose patches are finer than the pixels."""

from __future__ import annotations

import numpy as np
import pytest

import lumel


@pytest.mark.parametrize("areas", ["patches", "pixels"])
def test_fine_patches_keep_their_specular_light_in_a_thumbnail(areas: str) -> None:
    scene = lumel.load("lumel:demo")
    coarse, fine = (
        lumel.render(scene, size=(16, 12), rays=2_000_000, areas=areas, quality="draft", patches=patches).layer("indirect.specular")
        for patches in (20_000, 600_000)
    )
    # The means of two estimates of one picture; 10 % is more than the noise of either.
    np.testing.assert_allclose(fine.mean(axis=(0, 1)), coarse.mean(axis=(0, 1)), rtol=0.1)
