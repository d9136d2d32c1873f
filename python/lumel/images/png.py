"""PNG files: a picture for the screen, with exposure and the sRGB transfer function (IEC 61966-2-1)."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image, PngImagePlugin

from ..scene import FloatArray
from .files import ImageError, write_pictures
from .picture import Picture


def to_srgb(linear: npt.ArrayLike) -> FloatArray:
    """Encode linear values for the screen: clipped to 0..1, NaN is black."""
    x = np.clip(np.nan_to_num(np.asarray(linear, dtype=np.float32), nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.power(x, 1 / 2.4) - 0.055).astype(np.float32)


def from_srgb(encoded: npt.ArrayLike) -> FloatArray:
    """Decode screen values 0..1 to linear ones."""
    y = np.asarray(encoded, dtype=np.float32)
    return np.where(y <= 0.04045, y / 12.92, np.power((y + 0.055) / 1.055, 2.4)).astype(np.float32)


def to_bytes(rgb: npt.ArrayLike, exposure: float = 0.0) -> npt.NDArray[np.uint8]:
    """8-bit sRGB of the linear picture `rgb` (h, w, 3) times 2^`exposure` (EV)."""
    with np.errstate(over="ignore"):  # what overflows is white anyway
        exposed = np.asarray(rgb, dtype=np.float32) * np.float32(2.0**exposure)
    pixels: npt.NDArray[np.uint8] = np.rint(to_srgb(exposed) * 255).astype(np.uint8)
    return pixels


def encode_png(rgb: npt.ArrayLike, metadata: Mapping[str, str] | None = None, *, exposure: float = 0.0) -> bytes:
    """The bytes of a PNG of `rgb` (h, w, 3), linear, times 2^`exposure`; `metadata` go into text chunks."""
    return encode_bytes(to_bytes(rgb, exposure), metadata)


def encode_bytes(pixels: npt.NDArray[np.uint8], metadata: Mapping[str, str] | None = None) -> bytes:
    """The bytes of a PNG of `pixels` (h, w, 3), which are sRGB already."""
    info = PngImagePlugin.PngInfo()
    info.add(b"sRGB", b"\x00")  # says which transfer function the values have
    for key, text in (metadata or {}).items():
        info.add_itxt(f"lumel.{key}", text.encode("utf-8", "replace").decode("utf-8"))
    buffer = io.BytesIO()
    Image.fromarray(pixels, "RGB").save(buffer, "png", pnginfo=info)
    return buffer.getvalue()


def write_png(path: str | Path, rgb: npt.ArrayLike, metadata: Mapping[str, str] | None = None, *, exposure: float = 0.0) -> None:
    """Write `rgb` to `path` in one step, as `encode_png` makes it. Raises OutputError; then nothing has been changed."""
    write_pictures({Path(path): encode_png(rgb, metadata, exposure=exposure)})


def read_png(path: str | Path) -> Picture:
    """Read `path` as a linear picture (layer `rgb`; alpha is dropped). Raises ImageError where it is missing or damaged."""
    try:
        with Image.open(path) as image:
            pixels = np.asarray(image.convert("RGB"), dtype=np.float32)
            metadata = {str(key).removeprefix("lumel."): text for key, text in image.info.items() if isinstance(text, str)}
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise ImageError(f"cannot read {path}: {error}") from error
    return Picture({"rgb": from_srgb(pixels / 255)}, metadata, linear=False)
