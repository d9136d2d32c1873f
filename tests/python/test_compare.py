"""The errors of a picture against its reference, by closed forms and by other people's code."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import flip_evaluator
import numpy as np
import pytest

from lumel.images import ImageError, read_picture
from lumel.images.compare import compare
from lumel.images.flip import exposures, flip_map
from lumel.images.png import to_srgb
from lumel.scene import FloatArray


def noise(*shape: int, seed: int = 0) -> FloatArray:
    """Normal deviates."""
    return np.random.default_rng(seed).normal(size=shape).astype(np.float32)


def flat(value: float | tuple[float, float, float], height: int = 24, width: int = 40) -> FloatArray:
    """A picture of one colour."""
    return np.broadcast_to(np.asarray(value, dtype=np.float32), (height, width, 3)).copy()


def test_equal_pictures_have_no_error() -> None:
    picture = np.abs(noise(24, 40, 3))
    found = compare(picture, picture)
    assert (found.relmse, found.relmse_8x8, found.rmse, found.flip) == (0, 0, 0, 0)
    assert found.mean_ratio == 1
    assert found.mean_ratio_rgb == pytest.approx((1, 1, 1))
    assert (found.width, found.height) == (40, 24)
    assert found.reference_noise is None
    assert found.relmse_without_noise is None


@pytest.mark.parametrize("brightness", [1e-4, 0.3, 50.0])
def test_constant_pictures_have_the_error_of_the_formula(brightness: float) -> None:
    found = compare(flat(1.1 * brightness), flat(brightness))
    assert found.relmse == pytest.approx(0.01 / 1.01, rel=1e-5)
    assert found.relmse_8x8 == pytest.approx(0.01 / 1.01, rel=1e-5)
    assert found.rmse == pytest.approx(0.1 * brightness, rel=1e-5)
    assert found.mean_ratio == pytest.approx(1.1, rel=1e-6)


def test_two_tones_by_hand() -> None:
    # Half the pixels are 1, half 3: mean 2, e = 0.04. Everything is 0.5 too bright.
    reference = flat(1.0)
    reference[:, 20:] = 3
    found = compare(reference + 0.5, reference)
    assert found.relmse == pytest.approx((0.25 / 1.04 + 0.25 / 9.04) / 2, rel=1e-6)
    # Blocks of 8 columns: two of 1, one of both (mean 2), two of 3.
    assert found.relmse_8x8 == pytest.approx((2 * 0.25 / 1.04 + 0.25 / 4.04 + 2 * 0.25 / 9.04) / 5, rel=1e-6)


def test_channels_have_their_own_ratio() -> None:
    found = compare(flat((2.0, 1.0, 0.5)), flat((1.0, 1.0, 2.0)))
    assert found.mean_ratio_rgb == pytest.approx((2, 1, 0.25))
    assert found.mean_ratio == pytest.approx(3.5 / 4)


def test_noise_explains_itself() -> None:
    truth, stderr = flat((0.5, 1.0, 2.0), 160, 200), flat(0.01, 160, 200)
    reference = truth + stderr * noise(160, 200, 3)
    found = compare(truth, reference, reference_stderr=stderr)
    assert found.reference_noise is not None
    assert found.relmse == pytest.approx(found.reference_noise, rel=0.03)
    assert abs(found.relmse_without_noise or 0) < 0.03 * found.reference_noise
    # In means of 64 independent pixels the variance is 64 times lower.
    assert found.reference_noise_8x8 == pytest.approx(found.reference_noise / 64, rel=0.03)
    assert found.relmse_8x8 == pytest.approx(found.reference_noise_8x8, rel=0.15)


def test_bias_stays_in_block_means_and_noise_does_not() -> None:
    reference = flat(1.0, 160, 160)
    found = compare(reference * 1.05 + 0.2 * noise(160, 160, 3), reference, image_stderr=flat(0.2, 160, 160))
    assert found.relmse == pytest.approx((0.05**2 + 0.2**2) / 1.01, rel=0.03)
    assert found.relmse_8x8 == pytest.approx((0.05**2 + 0.2**2 / 64) / 1.01, rel=0.1)
    assert found.image_noise == pytest.approx(0.2**2 / 1.01, rel=1e-6)


@pytest.mark.parametrize("size", [(1, 1), (3, 100), (9, 17), (8, 16)])
def test_any_size_is_compared_whole(size: tuple[int, int]) -> None:
    reference = flat(1.0, *size)
    image = reference.copy()
    image[-1, -1] = 2.0
    found = compare(image, reference, reference_stderr=0.1 * reference)
    assert found.relmse == pytest.approx(1 / 1.01 / (size[0] * size[1]), rel=1e-6)
    assert found.relmse_8x8 > 0
    height, width = (side % 8 or 8 if side > 8 else side for side in size)
    blocks = math.ceil(size[0] / 8) * math.ceil(size[1] / 8)
    assert found.relmse_8x8 == pytest.approx((1 / (height * width)) ** 2 / 1.01 / blocks, rel=1e-6)


def test_pixels_that_are_not_finite_are_counted_and_left_out() -> None:
    image, reference = flat(1.1), flat(1.0)
    image[0, 0, 1] = np.nan
    image[3, 4] = np.inf
    reference[3, 4, 0] = np.nan
    reference[7, 7] = -np.inf
    found = compare(image, reference, reference_stderr=np.where(np.isfinite(reference), 0.1, np.nan))
    assert (found.nonfinite_image, found.nonfinite_reference) == (2, 2)
    assert found.relmse == pytest.approx(0.01 / 1.01, rel=1e-5)
    assert found.relmse_8x8 == pytest.approx(0.01 / 1.01, rel=1e-5)
    assert found.reference_noise == pytest.approx(0.01 / 1.01, rel=1e-5)
    assert all(math.isfinite(value) for value in (found.flip, found.rmse, found.mean_ratio))


def test_what_cannot_be_compared_is_said() -> None:
    with pytest.raises(ImageError, match=r"40x24.*10x20"):
        compare(flat(1.0), flat(1.0, 20, 10))
    with pytest.raises(ImageError, match=r"\(24, 40\)"):
        compare(flat(1.0)[..., 0], flat(1.0))
    with pytest.raises(ImageError, match="stderr"):
        compare(flat(1.0), flat(1.0), reference_stderr=flat(1.0, 3, 3))
    with pytest.raises(ImageError, match="no pixel is finite"):
        compare(flat(math.nan), flat(1.0))


def test_black_reference_leaves_ratios_undefined_but_not_the_rest() -> None:
    found = compare(flat(0.5), flat(0.0), reference_stderr=flat(0.0))
    assert math.isnan(found.relmse)
    assert math.isnan(found.mean_ratio)
    assert found.rmse == pytest.approx(0.5)
    assert 0 < found.flip <= 1
    assert compare(flat(0.0), flat(0.0)).flip == 0


def test_names_of_the_numbers() -> None:
    found = compare(flat(1.0), flat(1.0))
    assert set(found.to_dict()) == {field.name for field in dataclasses.fields(found)} - {"flip_map"}


def test_flip_is_that_of_its_authors_where_theirs_is_defined() -> None:
    # An even count of lit pixels would let the two medians differ by half a step.
    reference = np.exp(noise(31, 41, 3))
    image = reference * np.exp(0.3 * noise(31, 41, 3, seed=1))
    theirs, mean, settings = flip_evaluator.evaluate(reference, image, "HDR", applyMagma=False)
    assert exposures(reference) == pytest.approx((settings["startExposure"], settings["stopExposure"]), abs=1e-3)
    np.testing.assert_allclose(flip_map(image, reference), theirs[..., 0], atol=1e-3)
    assert compare(image, reference).flip == pytest.approx(mean, abs=1e-3)
    shown = [to_srgb(picture) for picture in (reference, image)]
    mean = flip_evaluator.evaluate(*shown, "LDR", applyMagma=False)[1]
    assert compare(image, reference, linear=False).flip == pytest.approx(mean, abs=1e-6)


@pytest.mark.parametrize("lit", [0.0, 0.02, 0.4])
def test_flip_stands_pictures_that_are_mostly_black(lit: float) -> None:
    reference = np.where(np.random.default_rng(1).random((40, 50, 1)) < lit, np.exp(5 * noise(40, 50, 3)), 0).astype(np.float32)
    flips = flip_map(reference + np.float32(0.1), reference)
    assert flips.shape == (40, 50)
    assert np.all((flips >= 0) & (flips <= 1))
    assert flips.mean() > 0


def test_references_carry_the_noise_that_they_claim(shared: Path) -> None:
    for path in sorted((shared / "scenes" / "reference").glob("*.exr")):
        layers = read_picture(path).layers
        R, stderr = (layers[name].astype(np.float64) for name in ("rgb", "stderr"))
        found = compare(R + stderr * noise(*R.shape), R, reference_stderr=stderr)
        weight = R**2 + 0.01 * R.mean() ** 2
        assert found.reference_noise == pytest.approx(np.mean(stderr**2 / weight), rel=1e-9)
        # One more draw of the same noise has that error, but for the few pixels that dominate a heavy tail.
        assert found.relmse == pytest.approx(found.reference_noise, rel=0.25)
        assert found.nonfinite_reference == 0
