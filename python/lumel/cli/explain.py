"""`lumel render --explain`: tables for people, and a picture of the correction."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..scene import LUMINANCE
from . import text

if TYPE_CHECKING:
    from ..explanation import AreaStory, BundleStory, Explanation, Share
    from ..result import Result
    from ..scene import FloatArray

STRONGEST = 0.5  # correction over value that takes the full colour


def show(explanation: Explanation) -> None:
    """Print what happened to stdout."""
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False, soft_wrap=True)
    if explanation.lamps:
        table = Table("lamp", "power", "shines on", "lost", title="Lamps: where their light goes first", title_justify="left")
        for lamp in explanation.lamps:
            table.add_row(lamp.name, f"{lamp.share:.0%}", _shares(lamp.onto), f"{lamp.escaped:.0%}")
        console.print(table)
        if explanation.more_lamps:
            console.print(f"and {explanation.more_lamps} weaker lamps")
    work = text.count(explanation.work, explanation.unit)
    went = f"{work} of the transport `{explanation.transport}` arrived on: {_shares(explanation.landed)}"
    console.print(f"{went}; {explanation.escaped:.1%} left the scene")
    if explanation.bundles:
        console.print(*_lines(explanation.bundles), sep="\n")
    for areas in explanation.areas:
        console.print(*_story(areas, explanation.estimator), sep="\n")


def picture(result: Result, camera: str) -> bytes:
    """A PNG: what the estimator added to the mean of f/p (red) or took from it (blue), over the indirect specular light."""
    from matplotlib import colormaps
    from matplotlib.image import imsave

    light = result.layer("indirect.specular", camera) @ LUMINANCE.astype(np.float32)
    data = io.BytesIO()
    imsave(data, colormaps["coolwarm"](_shift(result.layer("correction", camera), light)), format="png")
    return data.getvalue()


def path_of_picture(output: Path) -> Path:
    """`a.exr` -> `a.explain.png`."""
    return output.with_name(f"{output.stem}.explain.png")


def _shift(correction: FloatArray, light: FloatArray) -> FloatArray:
    """0.5 where nothing was corrected, up to 0 or 1 where the correction is STRONGEST of the light."""
    relative = np.divide(correction, light, out=np.zeros_like(correction), where=light > 0)
    return np.clip(0.5 + 0.5 * relative / STRONGEST, 0, 1).astype(np.float32)


def _lines(bundles: BundleStory) -> Sequence[str]:
    directions = f"{text.count(bundles.directions, 'directions')}, {text.count(bundles.directions_per_s, 'directions/s')}"
    depth = f"mean depth complexity {bundles.mean_depth:.3g}"
    met = f"{text.count(bundles.fragments, 'fragments')}, {text.count(bundles.pairs, 'pairs')}, {depth}"
    parity = f"{text.si(bundles.parity_violations).strip()} parity violations per million lines"
    went = f"{bundles.received:.3%} arrived and {bundles.escaped:.3%} escaped (100 % and 0 % in a closed scene)"
    return (
        f"bundles: {directions}, window {bundles.window}, {met}, {parity}",
        f"  of the light that they carried {went}; {bundles.mispaired:.3%} went between faces of one closed mesh that look the same way",
    )


def _story(areas: AreaStory, estimator: str) -> Sequence[str]:
    if areas.count == 0:
        return (f"camera '{areas.camera}' sees no gloss that was measured",)
    low, middle, high = (f"{hits:.0f}" for hits in areas.hits)
    gain = f"{areas.gain:.2g} times" if math.isfinite(areas.gain) else "without bound"
    had = f"{middle} samples in the middle one (90 % of them: {low} to {high}), {areas.empty:.1%} had none and took their neighbours'"
    moved = f"{areas.filled:.0%} had too few samples in their lobe and were raised, {areas.lowered:.0%} had too many and were lowered"
    return (
        f"camera '{areas.camera}': {areas.count:,} glossy areas, {had}, {areas.flagged:.1%} flagged",
        f"  {estimator}: {moved}; the correction is {areas.correction:.1%} of the light, and worth {gain} the samples of `classical`",
    )


def _shares(shares: Sequence[Share]) -> str:
    return ", ".join(f"{share.name} {share.share:.0%}" for share in shares) or "nothing"
