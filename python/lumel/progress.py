"""What a render tells while it runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Phase = Literal["solve", "shoot", "eye"]


@dataclass(frozen=True)
class Progress:
    """A snapshot of a running render; nan stands for what is not known (yet).

    `phase`: `solve` finds the radiosity of the patches, `shoot` shoots from it, `eye` makes the pictures. `fraction` (0..1) is the share
    of the whole that is done, `rays` counts shooting rays, or directions of bundles as `unit` says, `error` is the relative error of
    the picture, `elapsed` and `remaining` are seconds.
    """

    phase: Phase
    fraction: float
    rays: int
    rays_per_s: float
    error: float
    elapsed: float
    remaining: float
    unit: Literal["rays", "directions"] = "rays"
