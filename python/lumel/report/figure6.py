"""Figure 6 of the paper: ray bundles, without and with weighting, at equal directions."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from .. import _core, gloss
from ..scene import FloatArray
from . import pictures, references
from .areas import Subject
from .budget import until
from .figure import Figure, Picture, Table, gain, times
from .lab import BUST, Lab
from .references import Reference

WORKS = {"figure6 reference": 44.0, "figure6": 16.0}
SIZE = (800, 800)  # of the paper
BUNDLES = {"transport": "bundles", "areas": "pixels"}
GATHERED = 512.0  # gathering rays of the reference, a pixel and 1024 directions
ESTIMATORS = ("classical", "weighted")
SOLVE, DIRECTIONS = 1 << 18, 16  # of a replica
MOST = 8  # replicas: with more, noise is hard to see
SHOOTING = 0.6  # share of the time; the rest is for the eye
EYE_SAMPLES = 4  # a pixel and pass
EYE_PASSES = 2
LIT = ("emission", "direct", "indirect.diffuse", gloss.LAYER)  # layers that make up a picture


@dataclass
class Shot:
    """A session with its processor time, s."""

    session: _core.Session
    shooting: float = 0.0
    seeing: float = 0.0

    def replica(self, subject: Subject) -> None:
        """Cast DIRECTIONS more."""
        before = time.process_time()
        subject.replica(self.session, SOLVE, DIRECTIONS)
        self.shooting += time.process_time() - before

    def see(self) -> None:
        """Make the picture."""
        before = time.process_time()
        self.session.reconstruct()
        for _ in range(EYE_PASSES):
            self.session.eye_pass(0, EYE_SAMPLES)
        self.seeing = time.process_time() - before


def make(lab: Lab) -> Figure:
    """Pictures of both at the size of the paper, beside a reference."""
    size = lab.size or SIZE
    lab.begin("figure 6: reference")
    reference = references.make(lab, BUST, lab.budget.take("figure6 reference"), size=size, gather=GATHERED, **BUNDLES)
    lab.begin("figure 6: bundles at equal directions")
    shots = _shots(lab, size, lab.budget.take("figure6"))
    directions = shots[ESTIMATORS[0]].session.directions
    layers = {name: shot.session.layers(0) for name, shot in shots.items()}
    error = {name: reference.error_of_light(found[gloss.LAYER]) for name, found in layers.items()}
    ratio = {name: float(found[gloss.LAYER].mean(dtype=np.float64) / reference.light.mean()) for name, found in layers.items()}
    rows = [(name, shot.session.directions, shot.shooting, shot.seeing, error[name], ratio[name]) for name, shot in shots.items()]
    head = ("estimator", "directions", "processor time of shooting, s", "of the eye, s", "relMSE of the gloss", "mean ratio")
    return Figure(
        title=f"Figure 6: ray bundles at {size[0]}x{size[1]}, without and with weighting, at equal directions",
        scene=lab.scene(BUST).source,
        shows=f"""{directions} directions of bundles each, the light in gloss measured in pixels, nothing gathered, first shot included.
        Above the pictures, below the light in gloss alone, magnified. The reference is the mean of {reference.made}; its own noise,
        {reference.noise:.2g} as relMSE, is subtracted.""",
        claim="""Figure 6 of the paper shows 800x800 pixels by ray bundles, without and with weighting, after 28 s on one core of 1.4
        GHz, first shot included. A bundle sees the whole hemisphere, so that a ratio needs no defensive part.""",
        found=[
            f"The relMSE of `classical` is {times(gain(error['classical'], error['weighted']))} that of `weighted`.",
            "Processor time: "
            + ", ".join(f"{s.shooting:.1f} s shooting and {s.seeing:.1f} s seeing `{n}`" for n, s in shots.items())
            + ".",
        ],
        pictures=_pictures(layers, reference, directions),
        columns=len(ESTIMATORS) + 1,
        tables=[Table("figure6", "Errors at equal directions", head, rows)],
    )


def _shots(lab: Lab, size: tuple[int, int], seconds: float) -> dict[str, Shot]:
    """Both estimators, replica by replica in turns, until the time for shooting is over; then their pictures."""
    scene = lab.scene(BUST)
    subject = replace(lab.subject(BUST), scene=replace(scene, cameras=(scene.cameras[0].with_size(*size),)))
    shots = {name: Shot(subject.session(0, estimator=name, **BUNDLES)) for name in ESTIMATORS}
    more = until(SHOOTING * seconds)
    for done in range(MOST):
        if done > 0 and not more():
            break
        for shot in shots.values():
            shot.replica(subject)
            lab.tell()
    for shot in shots.values():
        shot.see()
        lab.tell()
    return shots


def _pictures(layers: Mapping[str, Mapping[str, FloatArray]], reference: Reference, directions: int) -> list[Picture]:
    exposure, bright = pictures.exposure_for(reference.image), pictures.exposure_for(reference.light)
    part = pictures.part_with_detail(reference.light)
    whole = {name: np.sum([found[layer] for layer in LIT], axis=0) for name, found in layers.items()} | {"reference": reference.image}
    light = {name: found[gloss.LAYER] for name, found in layers.items()} | {"reference": reference.light}
    labels = {name: f"{name}, {directions} directions" for name in layers} | {"reference": "reference"}
    return [
        *(
            pictures.shown(f"figure6.{name}", image, exposure, labels[name], f"the scene by bundles, {name}")
            for name, image in whole.items()
        ),
        *(pictures.magnified(f"figure6.{name}.gloss", image, part, bright, name) for name, image in light.items()),
    ]
