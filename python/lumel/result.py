"""What a render gives: pictures with layers for every camera, the radiosity of the patches, and how they were made."""

from __future__ import annotations

import base64
import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from .errors import OutputError, Problem, SettingsError, nearest
from .scene import FloatArray

if TYPE_CHECKING:
    from .explanation import Explanation

LAYERS: Mapping[str, str] = {
    "emission": "light that the surface in view emits itself",
    "direct": "light of the lamps reflected once, diffuse and specular",
    "indirect.diffuse": "light that came over other surfaces, reflected by the diffuse part",
    "indirect.specular": "light that came over other surfaces, reflected by the specular part",
    "albedo": "share of white light that the surface in view reflects",
    "normal": "shading normal in world space, towards the eye",
    "depth": "distance from the eye along the ray, in metres",
    "stderr": "standard error of the picture",
}
"""The layers of a picture beside `rgb`, written unless others are asked for.

emission + direct + indirect.diffuse + indirect.specular = rgb.
"""


DIAGNOSTICS: Mapping[str, str] = {
    "weight": "mean of g/p of the specular estimate: 1 where the sampling density covers what the lobe sees",
    "hits": "samples of the specular estimate",
    "correction": "what the estimator added to the mean of f/p, as luminance",
    "flag": "1 where the density misses 2 % of what the lobe sees or `weight` is 4 standard errors from 1: ratios are off",
}
"""Layers that tell how far the specular estimate can be trusted; 0 where nothing glossy is seen directly."""


@dataclass(frozen=True, eq=False)
class Patches:
    """The solution on the P patches: [:, 0] is the front face, [:, 1] the back.

    `radiosity`, `irradiance` and the standard error of the radiosity, `stderr`: (P, 2, 3) float32, W/m2.
    `area` (P,) in m2, `centroid` (P, 3) in metres, `normal` (P, 3) of the front. `replicas`: independent
    solves that `stderr` is the spread of.
    """

    radiosity: FloatArray
    irradiance: FloatArray
    stderr: FloatArray
    area: FloatArray
    centroid: FloatArray
    normal: FloatArray
    replicas: int = 0

    def interval(self, level: float = 0.95) -> FloatArray:
        """Half widths of the intervals around `radiosity` that hold its expectation with probability `level`, (P, 2, 3) W/m2.

        Student's t of the replicas times `stderr`. Raises SettingsError for a level outside 0..1 or fewer than two replicas.
        """
        return half_width(self.stderr, level, self.replicas)


@dataclass(frozen=True, eq=False)
class Result:
    """`pictures`: camera -> layer -> float32 (h, w, 3), or (h, w) for scalars.

    The layer `rgb` is the picture itself, W/(m2 sr), linear Rec.709. `metadata` is text that goes into files, `stats` the same and
    more as plain numbers (`rays`, `rays_per_s`, `time` in s, `error`, `interrupted`), `notes` what the user should know
    (what was ignored or assumed), `explanation` where it was asked for.
    """

    pictures: Mapping[str, Mapping[str, FloatArray]]
    patches: Patches
    metadata: Mapping[str, str] = field(default_factory=dict)
    stats: Mapping[str, object] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    explanation: Explanation | None = None

    @property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras, the default one first."""
        return tuple(self.pictures)

    def image(self, camera: str | None = None) -> FloatArray:
        """The picture of `camera` (None: the first), (h, w, 3). Raises SettingsError for an unknown name."""
        return self.layer("rgb", camera)

    def stderr(self, camera: str | None = None) -> FloatArray:
        """Standard error of every pixel and channel of `image`, (h, w, 3)."""
        return self.layer("stderr", camera)

    def interval(self, level: float = 0.95, camera: str | None = None) -> FloatArray:
        """Half widths of the intervals around `image` that hold its expectation with probability `level`, (h, w, 3).

        `stderr` is one standard error, from few replicas of the solve; the intervals are Student's t of so many times that. Raises
        SettingsError for a level outside 0..1, an unknown camera, or a result of fewer than two replicas.
        """
        return half_width(self.stderr(camera), level, self.patches.replicas)

    def layer(self, name: str, camera: str | None = None) -> FloatArray:
        """One layer by name, (h, w, 3) or (h, w). Raises SettingsError for an unknown name."""
        layers = self._picture(camera)
        if name not in layers:
            raise SettingsError(f"unknown layer '{name}'; {nearest(name, layers)}")
        return layers[name]

    def write(
        self,
        path: str | Path,
        *,
        camera: str | None = None,
        layers: Sequence[str] | Literal["all"] | None = None,
        exposure: float = 0.0,
        half: bool = False,
    ) -> None:
        """Write the picture of `camera` to `path`, by its ending as EXR (with layers) or PNG (sRGB, times 2^`exposure`).

        `layers`: None writes those of LAYERS, "all" every one there is, or their names. `half` stores float16 in EXR. Raises
        OutputError (ending, folder, permission, disk full), and then nothing has been changed, or SettingsError.
        """
        from .images.files import write_pictures

        path = Path(path)
        write_pictures({path: self.encode(path, camera=camera, layers=layers, exposure=exposure, half=half)})

    def encode(
        self,
        path: Path,
        *,
        camera: str | None = None,
        layers: Sequence[str] | Literal["all"] | None = None,
        exposure: float = 0.0,
        half: bool = False,
    ) -> bytes:
        """The bytes that `write` would write to `path`."""
        from .images.exr import encode_exr
        from .images.files import wrong_ending
        from .images.png import encode_png

        match path.suffix.lower():
            case ".exr":
                return encode_exr(self._selected(layers, camera), self.metadata, half=half)
            case ".png":
                return encode_png(self.image(camera), self.metadata, exposure=exposure)
            case _:
                raise OutputError(wrong_ending(path))

    def _picture(self, camera: str | None) -> Mapping[str, FloatArray]:
        if camera is None:
            return next(iter(self.pictures.values()))
        if camera not in self.pictures:
            raise SettingsError(f"unknown camera '{camera}'; {nearest(camera, self.pictures)}")
        return self.pictures[camera]

    def _selected(self, layers: Sequence[str] | Literal["all"] | None, camera: str | None) -> dict[str, FloatArray]:
        """The layers to write, `rgb` always among them."""
        there = self._picture(camera)
        if layers is None:
            wanted = [name for name in LAYERS if name in there]
        elif layers == "all":
            wanted = list(there)
        else:
            wanted = [layers] if isinstance(layers, str) else list(layers)
        if unknown := [Problem(f"unknown layer '{name}'; {nearest(name, there)}") for name in wanted if name not in there]:
            raise SettingsError(unknown)
        return {name: there[name] for name in dict.fromkeys(["rgb", *wanted])}

    def _repr_html_(self) -> str:
        """The pictures of all cameras, for a notebook."""
        from .images.png import encode_png

        return "".join(
            f'<figure style="display:inline-block;margin:4px"><img alt="{html.escape(name)}" src="data:image/png;base64,'
            f'{base64.b64encode(encode_png(layers["rgb"])).decode()}"><figcaption>{html.escape(name)}</figcaption></figure>'
            for name, layers in self.pictures.items()
        )


def half_width(stderr: FloatArray, level: float, replicas: int) -> FloatArray:
    """Half widths of intervals from standard errors that are the spread of so many replicas, with the shape of `stderr`."""
    from .quadrature.student import t_quantile

    if replicas < 2:
        raise SettingsError(f"the result is made of {replicas} replicas; intervals need 2 or more")
    return np.asarray(stderr * np.float32(t_quantile(level, replicas - 1)))


def path_of_camera(path: Path, camera: str) -> Path:
    """`OUT.CAMERA.exr` for `OUT.exr`; what could not stand in a file name becomes `_`."""
    safe = "".join(letter if letter.isalnum() or letter in "-_." else "_" for letter in camera)
    return path.with_name(f"{path.stem}.{safe}{path.suffix}")
