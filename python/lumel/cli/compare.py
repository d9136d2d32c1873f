"""`lumel compare`: how far a picture is from its reference."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import OutputError, nearest
from . import options, text
from .errors import reporting

if TYPE_CHECKING:
    from ..images.compare import Comparison
    from ..images.picture import Picture
    from ..scene import FloatArray


def compare(
    image: Annotated[Path, typer.Argument(metavar="IMAGE", help="EXR or PNG.")],
    reference: Annotated[Path, typer.Argument(metavar="REFERENCE", help="EXR or PNG.")],
    output: Annotated[Path | None, typer.Option("--output", "-o", metavar="DIFF.png", help="Where to write the map of FLIP.")] = None,
    layer: Annotated[str, typer.Option("--layer", metavar="NAME", help="The layer to compare.")] = "rgb",
    as_json: options.Json = False,
) -> None:
    """Compare IMAGE with REFERENCE: relMSE, RMSE, FLIP, mean ratio and the noise of the reference itself."""
    from ..images import read_picture
    from ..images.compare import compare as compare_arrays

    with reporting():
        if output:
            _check_output(output)
        I, R = read_picture(image), read_picture(reference)  # noqa: E741
        found = compare_arrays(
            _layer(I, layer, image), _layer(R, layer, reference), *(_stderr(p, layer) for p in (I, R)), linear=I.linear and R.linear
        )
        print(text.to_json(found.to_dict(), indent=2) if as_json else describe(found))
        if output:
            _write_map(output, found.flip_map)


def describe(found: Comparison) -> str:
    """The numbers as aligned lines."""
    rows = [
        ("size", f"{found.width}x{found.height}"),
        ("relMSE", _number(found.relmse)),
        ("  noise of the reference", _number(found.reference_noise)),
        ("  without that noise", _number(found.relmse_without_noise)),
        ("  noise of the image", _number(found.image_noise)),
        ("relMSE of 8x8 means", _number(found.relmse_8x8)),
        ("  noise of the reference", _number(found.reference_noise_8x8)),
        ("  without that noise", _number(found.relmse_8x8_without_noise)),
        ("RMSE", _number(found.rmse)),
        ("FLIP", _number(found.flip)),
        ("mean ratio", _number(found.mean_ratio)),
        *((f"  {channel}", _number(ratio)) for channel, ratio in zip("RGB", found.mean_ratio_rgb, strict=True)),
    ]
    if found.nonfinite_image or found.nonfinite_reference:
        rows.append(("pixels not finite", f"{found.nonfinite_image} in the image, {found.nonfinite_reference} in the reference; left out"))
    return "\n".join(f"{name:26}  {value}" for name, value in rows)


def _number(value: float | None) -> str:
    if value is None:
        return "unknown (no stderr layer)"
    return f"{value:.5g}" if math.isfinite(value) else "undefined (the reference is black)"


def _check_output(path: Path) -> None:
    from ..images.files import problems_with

    if path.suffix.lower() != ".png":
        raise OutputError(f"cannot write '{path}': the map of differences is a PNG, allowed: .png")
    if problems := problems_with([path]):
        raise OutputError(problems)


def _layer(picture: Picture, name: str, path: Path) -> FloatArray:
    from ..images import ImageError

    if name not in picture.layers:
        raise ImageError(f"{path} has no layer '{name}'; {nearest(name, picture.layers)}")
    return picture.layers[name]


def _stderr(picture: Picture, layer: str) -> FloatArray | None:
    """Standard errors are those of the picture proper."""
    return picture.layers.get("stderr") if layer == "rgb" else None


def _write_map(path: Path, flips: FloatArray) -> None:
    """FLIP from 0 (black) over purple and orange to 1 (pale yellow)."""
    from matplotlib import colormaps

    from ..images.files import write_pictures
    from ..images.png import encode_bytes

    write_pictures({path: encode_bytes(colormaps["magma"](flips, bytes=True)[..., :3])})
