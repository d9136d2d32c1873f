"""Figure 6 of the paper: ray bundles, without and with weighting, at equal directions."""

from __future__ import annotations

import time
from typing import Any

from .. import gloss
from ..result import Result
from . import pictures, references
from .figure import Figure, Picture, Table
from .lab import BUST, LEAST_TIME, Lab
from .references import Reference

WORKS = {"figure6 reference": 34.0, "figure6": 34.0}
SIZE = (800, 800)  # of the paper
ESTIMATORS = ("classical", "weighted")
PILOT = 0.15  # share of the time that goes into learning how many directions there are time for
ROUND = 10  # directions


def make(lab: Lab) -> Figure:
    """Pictures of both at the size of the paper, beside a reference."""
    size = lab.size or SIZE
    common: dict[str, Any] = {"transport": "bundles", "areas": "pixels", "size": size}
    lab.begin("figure 6: reference")
    reference = references.make(lab, BUST, lab.budget.take("figure6 reference"), **common)
    lab.begin("figure 6: bundles at equal directions")
    directions = _affordable(lab, common)
    runs, seconds = {}, {}
    for name in ESTIMATORS:
        before = time.process_time()
        runs[name] = lab.render(BUST, estimator=name, gather=0, directions=directions, quality="draft", **common)
        seconds[name] = time.process_time() - before
    error = {name: reference.error(run) for name, run in runs.items()}
    rows = [
        (name, directions, float(str(run.stats["time"])), seconds[name], error[name], reference.ratio(run)) for name, run in runs.items()
    ]
    head = ("estimator", "directions", "time, s", "processor time, s", "relMSE of the gloss", "mean ratio")
    return Figure(
        title=f"Figure 6: ray bundles at {size[0]}x{size[1]}, without and with weighting, at equal directions",
        scene=lab.scene(BUST).source,
        shows=f"""{directions} directions of bundles each, the light in gloss measured in pixels, nothing gathered, first shot
        included. Above the pictures, below the light in gloss alone, magnified. The reference is the mean of {reference.made}; its
        own noise, {reference.noise:.2g} as relMSE, is subtracted.""",
        claim="""Figure 6 of the paper shows 800x800 pixels by ray bundles, without and with weighting, after 28 s on one core of
        1.4 GHz, first shot included. A bundle sees the whole hemisphere, so that a ratio needs no defensive part.""",
        found=[
            f"The relMSE of `classical` is {error['classical'] / error['weighted']:.3g} times that of `weighted`.",
            f"Processor time: {seconds['classical']:.1f} s `classical`, {seconds['weighted']:.1f} s `weighted`.",
        ],
        pictures=_pictures(runs, reference, directions),
        columns=len(ESTIMATORS) + 1,
        tables=[Table("figure6", "Errors at equal directions", head, rows)],
    )


def _affordable(lab: Lab, common: dict[str, Any]) -> int:
    """Directions that there is time for, from a short run."""
    seconds = lab.budget.take("figure6")
    pilot = lab.render(BUST, estimator="classical", gather=0, time=max(LEAST_TIME, PILOT * seconds), **common)
    speed = int(str(pilot.stats["directions"])) / float(str(pilot.stats["time"]))
    wanted = speed * seconds * (1 - PILOT) / len(ESTIMATORS)
    return max(ROUND, round(wanted / ROUND) * ROUND)


def _pictures(runs: dict[str, Result], reference: Reference, directions: int) -> list[Picture]:
    exposure, bright = pictures.exposure_for(reference.image), pictures.exposure_for(reference.light)
    part = pictures.part_with_detail(reference.light)
    whole = {name: run.image() for name, run in runs.items()} | {"reference": reference.image}
    light = {name: run.layer(gloss.LAYER) for name, run in runs.items()} | {"reference": reference.light}
    labels = {name: f"{name}, {directions} directions" for name in runs} | {"reference": "reference"}
    return [
        *(
            pictures.shown(f"figure6.{name}", image, exposure, labels[name], f"the scene by bundles, {name}")
            for name, image in whole.items()
        ),
        *(pictures.magnified(f"figure6.{name}.gloss", image, part, bright, name) for name, image in light.items()),
    ]
