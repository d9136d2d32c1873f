"""Pictures as files: EXR with layers, PNG for the screen, and how far one picture is from another.

A picture is a mapping of layer names to float32 arrays, (h, w, 3) for colours and vectors or (h, w) for scalars; the layer `rgb`
is the picture proper, linear Rec.709. `exr` and `png` turn it into bytes and back, `files` puts bytes on the disk, all or none.
"""

from __future__ import annotations

from pathlib import Path

from .exr import read_exr
from .files import ImageError
from .picture import Picture
from .png import read_png

__all__ = ["ImageError", "Picture", "read_picture"]


def read_picture(path: str | Path) -> Picture:
    """Read `path`, an EXR or a PNG by what its first bytes say. Raises ImageError with what is wrong."""
    path = Path(path)
    try:
        with path.open("rb") as file:
            magic = file.read(8)
    except OSError as error:
        raise ImageError(f"cannot read {path}: {error.strerror}") from error
    if magic[:4] == b"\x76\x2f\x31\x01":
        return read_exr(path)
    if magic == b"\x89PNG\r\n\x1a\n":
        return read_png(path)
    raise ImageError(f"cannot read {path}: it is neither an EXR nor a PNG picture")
