"""Figure 5 of the paper: the estimate of one area of interest over iterations, classical against weighted."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..scene import LUMINANCE, Camera
from . import iterations, pictures, plots
from .areas import Doubles, Indices
from .figure import Curve, Figure, Picture, Table
from .iterations import ESTIMATORS, TRANSPORTS, Iterations
from .lab import BOX, Lab

WORKS = {**iterations.WORKS, "figure5": 3.0}
RING = 0.04  # radius of the mark, of the width of the picture
HIGHEST = 4.0  # times the truth that is drawn


def make(lab: Lab) -> Figure:
    """Estimates of the area in the middle of the picture."""
    runs, truth = iterations.of_box(lab), lab.truth(BOX)
    pixels = pixels_of(lab, truth.index)
    area = nearest_to_the_middle(pixels, lab.scene(BOX).cameras[0])
    T = float(truth.value[area] @ LUMINANCE)
    noise = float(np.sqrt(truth.variance[area] @ LUMINANCE**2))
    shown = {key: value[:, :, area] @ LUMINANCE for key, value in runs.value.items()}  # runs, iterations
    rows = [
        (transport, name, run, at, float(found[run, i]))
        for (transport, name), found in shown.items()
        for run in range(runs.runs)
        for i, at in enumerate(runs.at)
    ]
    return Figure(
        title="Figure 5: one area of interest over iterations",
        scene=lab.scene(BOX).source,
        shows=f"""The light that one glossy patch sends to the eye (luminance), as estimated after so many iterations of figure 4: the
        first run in full, others thin. The patch is the one nearest to the middle of the picture, ringed. The plain line is the truth,
        {T:.3g} W/(m² sr) with a standard error of {noise:.1g}.""",
        claim="""Figure 5 of the paper follows one area of interest. The classical estimate jumps whenever a sample with a large f/p
        lands there; the weighted one divides it by the g/p that came with it.""",
        found=[_found(runs, shown, transport, T) for transport in TRANSPORTS],
        pictures=[_where(lab, pixels[area])],
        columns=4,
        curves=[Curve("figure5", "estimates of one patch over iterations, by transport and estimator", _draw(runs, shown, T))],
        tables=[Table("figure5", "Luminance, W/(m² sr)", ("transport", "estimator", "run", "iterations", "estimate"), rows)],
    )


def nearest_to_the_middle(pixels: Doubles, camera: Camera) -> int:
    """The index of the one of `pixels` (n, 2) that is nearest to the middle of the picture."""
    distance = np.hypot(*(pixels - (camera.width / 2, camera.height / 2)).T)
    return int(np.argmin(np.where(np.isfinite(distance), distance, np.inf)))


def pixels_of(lab: Lab, index: Indices) -> Doubles:
    """Where the camera sees the centres of areas, (n, 2), in pixels from the upper left corner."""
    core, camera = lab.subject(BOX).core, lab.scene(BOX).cameras[0]
    return seen_at(camera, core.patch_geometry()[index % core.patches, 1:4])


def seen_at(camera: Camera, points: npt.ArrayLike) -> Doubles:
    """Where `camera` sees `points` (n, 3), as (n, 2) pixels from the upper left corner; nan behind it."""
    left, up, forward, origin = np.asarray(camera.to_world, np.float64)[:3].T
    there = np.asarray(points, np.float64) - origin
    depth = there @ forward / np.linalg.norm(forward)
    depth = np.where(depth > 0, depth, np.nan)
    offset = np.stack([-(there @ axis) / np.linalg.norm(axis) / depth for axis in (left, up)], axis=-1)
    return np.asarray((1 + offset / camera.tan_half()) / 2 * (camera.width, camera.height))


def _where(lab: Lab, pixel: Doubles) -> Picture:
    """The scene with a ring around `pixel`."""
    lab.begin("the patch of figure 5")
    image = lab.render(BOX, estimator="auto", time=lab.budget.take("figure5")).image()
    x, y = float(pixel[0]), float(pixel[1])
    return pictures.ringed("figure5", image, (x, y), RING, "the patch", "the scene, with a ring around the patch")


def _found(runs: Iterations, shown: dict[tuple[str, str], Doubles], transport: str, truth: float) -> str:
    def spread(name: str, i: int) -> str:
        return f"{np.sqrt(np.mean((shown[transport, name][:, i] - truth) ** 2)) / truth:.0%}"

    middle = len(runs.at) // 2
    return f"{transport.capitalize()}, RMSE of the runs over the truth: " + "; ".join(
        f"after {runs.at[i]} iterations {', '.join(f'{spread(name, i)} `{name}`' for name in ESTIMATORS)}" for i in (middle, -1)
    )


def _draw(runs: Iterations, shown: dict[tuple[str, str], Doubles], truth: float) -> str:
    with plots.panels(TRANSPORTS, share_y=True) as (figure, axes):
        for panel, transport in zip(axes, TRANSPORTS, strict=True):
            panel.axhline(truth, color=plots.INK, linewidth=1.2)
            for name in ESTIMATORS:
                first, *others = shown[transport, name]
                for other in others:
                    panel.plot(runs.at, other, color=plots.COLOURS[name], linewidth=0.7, alpha=0.35)
                plots.line(panel, runs.at, first, name)
            panel.set(xscale="log", xlabel="iterations")
            plots.plain_ticks(panel, [2.0**i for i in range(int(np.log2(runs.at[-1])) + 1)])
        axes[0].set_ylabel("radiance towards the eye, W/(m² sr)")
        highest = max(float(found.max()) for found in shown.values())
        axes[0].set_ylim(0, min(max(1.05 * highest, 1.5 * truth), HIGHEST * truth))
        axes[0].legend()
        return plots.to_svg(figure, "figure5")
