"""EXR files: the picture in R,G,B, every layer beside it, and text about how it was made.

| layer              | channels                                        |
|--------------------|-------------------------------------------------|
| `rgb`              | `R`, `G`, `B`                                   |
| a colour `NAME`    | `NAME.R`, `NAME.G`, `NAME.B`                    |
| `normal`           | `normal.X`, `normal.Y`, `normal.Z`              |
| `depth`            | `depth.Z`                                       |
| a scalar `NAME`    | `NAME.Y` (a viewer shows it in grey)            |

Metadata are text attributes named `lumel.KEY`; the plain names would collide with attributes of the format (`version`, `type`).
"""

from __future__ import annotations

import io
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import OpenEXR

from ..scene import FloatArray
from .files import ImageError, write_pictures
from .picture import Picture

PREFIX = "lumel."
HALF_MAX = float(np.finfo(np.float16).max)
_TRIPLES = ("RGB", "XYZ")


def write_exr(
    path: str | Path, layers: Mapping[str, npt.ArrayLike], metadata: Mapping[str, str] | None = None, *, half: bool = False
) -> None:
    """Write `layers` to `path` in one step, as `encode_exr` makes them. Raises OutputError; then nothing has been changed."""
    write_pictures({Path(path): encode_exr(layers, metadata, half=half)})


def encode_exr(layers: Mapping[str, npt.ArrayLike], metadata: Mapping[str, str] | None = None, *, half: bool = False) -> bytes:
    """The bytes of an EXR file (ZIP) with `layers`, arrays (h, w, 3) or (h, w) of one common size, stored as float32.

    With `half`, colours and vectors become float16, but a layer that has a value beyond its range (65504) stays
    float32, as scalars do: nothing is clipped. Raises ValueError where shapes differ or are neither.
    """
    channels: dict[str, npt.NDArray[Any]] = {}
    for name, values in layers.items():
        array = np.asarray(values, dtype=np.float32)
        if half and array.ndim == 3 and not np.any(np.abs(array[np.isfinite(array)]) > HALF_MAX):
            channels.update(_channels(name, array.astype(np.float16)))
        else:
            channels.update(_channels(name, array))
    if len({channel.shape for channel in channels.values()}) != 1:
        shapes = {name: np.shape(values) for name, values in layers.items()}
        raise ValueError(f"layers must have one common size, found {shapes}")
    header: dict[str, Any] = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    for key, text in (metadata or {}).items():
        header[PREFIX + key] = text.encode("utf-8", "replace").decode("utf-8")
    buffer = io.BytesIO()
    with OpenEXR.File(header, channels) as file:
        file.write(buffer)
    return buffer.getvalue()


def read_exr(path: str | Path) -> Picture:
    """Read all channels of the first part of `path`, grouped into layers as in the table above; other channels keep their full name.

    Raises ImageError where the file is missing, damaged or not an EXR picture.
    """
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = {name: np.array(channel.pixels, dtype=np.float32) for name, channel in file.channels().items()}
            header = dict(file.header())
    except (RuntimeError, ValueError, TypeError) as error:
        raise ImageError(f"cannot read {path}: it is damaged, incomplete or not a plain picture ({error})") from error
    metadata = {key.removeprefix(PREFIX): text for key, text in header.items() if isinstance(text, str)}
    return Picture(_layers(channels), metadata)


def _channels(name: str, array: npt.NDArray[Any]) -> dict[str, npt.NDArray[Any]]:
    """Split one layer into its channels, by name."""
    if array.ndim == 2:
        return {f"{name}.{'Z' if name == 'depth' else 'Y'}": np.ascontiguousarray(array)}
    if array.ndim != 3 or array.shape[2] != 3:
        raise ValueError(f"layer '{name}' must be (h, w, 3) or (h, w), found {array.shape}")
    prefix = "" if name == "rgb" else f"{name}."
    letters = "XYZ" if name == "normal" else "RGB"
    return {prefix + letter: np.ascontiguousarray(array[..., i]) for i, letter in enumerate(letters)}


def _layers(channels: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    """Put channels together again: triples to (h, w, 3), single ones to (h, w)."""
    groups: dict[str, dict[str, FloatArray]] = defaultdict(dict)
    for name, channel in channels.items():
        prefix, _, letter = name.rpartition(".")
        groups[prefix][letter] = channel
    layers: dict[str, FloatArray] = {}
    for prefix, group in groups.items():
        for triple in _TRIPLES:
            if all(letter in group for letter in triple):
                layers[prefix or "rgb"] = np.stack([group.pop(letter) for letter in triple], axis=-1)
                break
        else:
            if prefix and len(group) == 1:
                layers[prefix] = group.popitem()[1]
        layers.update({f"{prefix}.{letter}" if prefix else letter: channel for letter, channel in group.items()})
    return layers
