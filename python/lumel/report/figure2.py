"""Figure 2 of the paper: a glossy bust by ray shooting, without and with weighting, at equal time."""

from __future__ import annotations

from .. import gloss
from ..result import Result
from . import pictures, references
from .figure import Figure, Picture, Table, gain, times
from .lab import BUST, Lab
from .references import Reference, mean_time

WORKS = {"reference": 36.0, "figure2": 12.0}
ESTIMATORS = ("classical", "weighted", "auto")


def make(lab: Lab) -> Figure:
    """Pictures of all estimators beside the reference, their light in gloss magnified below."""
    reference = references.of_bust(lab)
    lab.begin("figure 2: equal time")
    each = lab.budget.take("figure2") / len(ESTIMATORS)
    runs = {name: lab.render(BUST, estimator=name, gather=0, time=each) for name in ESTIMATORS}
    error = {name: reference.error(run) for name, run in runs.items()}
    rows = [
        (name, float(str(run.stats["time"])), int(str(run.stats["rays"])), error[name], reference.ratio(run)) for name, run in runs.items()
    ]
    return Figure(
        title="Figure 2: classical against weighted shooting, at equal time",
        scene=lab.scene(BUST).source,
        shows=f"""Ray shooting alone, {mean_time(runs.values()):.1f} s each. Nothing is gathered: all samples are those that shooting
        happened to make. Above the pictures, below the light in gloss alone (layer `indirect.specular`), magnified. `auto` is ours. The
        reference is the mean of {reference.made}; its own noise, {reference.noise:.2g} as relMSE, is subtracted.""",
        claim="""Figure 2 of the paper sets plain and weighted shooting of a glossy bust side by side, at equal time. Shooting can
        follow the power of light, but not the BRDF at the surface in view; weighting takes that BRDF into account afterwards.""",
        found=_found(error),
        pictures=_pictures(runs, reference),
        columns=len(ESTIMATORS) + 1,
        tables=[Table("figure2", "Errors at equal time", ("estimator", "time, s", "rays", "relMSE of the gloss", "mean ratio"), rows)],
    )


def _found(error: dict[str, float]) -> list[str]:
    gains = {name: gain(error["classical"], error[name]) for name in ESTIMATORS[1:]}
    lines = [f"The relMSE of `classical` is {times(found)} that of `{name}`." for name, found in gains.items()]
    if gains["weighted"] < 1:
        lines.append(
            """Here the plain ratio loses: where hits are few, an area that was hit from a bright place alone takes its whole lobe to be as
            bright. `auto` looks at the areas around it before it divides."""
        )
    return lines


def _pictures(runs: dict[str, Result], reference: Reference) -> list[Picture]:
    exposure, bright = pictures.exposure_for(reference.image), pictures.exposure_for(reference.light)
    part = pictures.part_with_detail(reference.light)
    whole = {name: run.image() for name, run in runs.items()} | {"reference": reference.image}
    light = {name: run.layer(gloss.LAYER) for name, run in runs.items()} | {"reference": reference.light}
    labels = {name: f"{name}, {float(str(run.stats['time'])):.1f} s" for name, run in runs.items()} | {"reference": "reference"}
    return [
        *(pictures.shown(f"figure2.{name}", image, exposure, labels[name], f"the scene by rays, {name}") for name, image in whole.items()),
        *(pictures.magnified(f"figure2.{name}.gloss", image, part, bright, name) for name, image in light.items()),
    ]
