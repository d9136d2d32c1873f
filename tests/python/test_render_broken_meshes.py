"""Bundles in meshes that are cracked, cross themselves or have numbers that are none: a picture, and a report of where the light went."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from lumel.images import read_picture
from lumel.readers.primitives import sphere
from lumel.readers.surface import Surface
from running import run

SCENE = """<scene version="3.0.0"><shape type="ply"><string name="filename" value="ball.ply"/>
<bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf></bsdf>
<emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>
<sensor type="perspective"><float name="fov" value="60"/><film type="hdrfilm"><integer name="width" value="8"/>
<integer name="height" value="8"/></film></sensor></scene>"""
FLAGS = [
    "--transport", "bundles", "--directions", "300", "--window", "128", "--no-first-shot", "--quality", "draft", "--explain", "--lenient",
]  # fmt: skip


def ply(surface: Surface) -> str:
    """The text of a PLY file."""
    points = [" ".join(map(str, point)) for point in surface.vertices.tolist()]
    faces = [" ".join(map(str, [3, *face])) for face in surface.triangles.tolist()]
    coordinates = [f"property float {axis}" for axis in "xyz"]
    head = ["ply", "format ascii 1.0", f"element vertex {len(points)}", *coordinates, f"element face {len(faces)}"]
    return "\n".join([*head, "property list uchar int vertex_indices", "end_header", *points, *faces, ""])


def ball() -> Surface:
    """A sphere that is seen from inside."""
    return sphere(2).flipped()


def cracked() -> Surface:
    """One triangle of ten is missing."""
    whole = ball()
    return Surface(whole.vertices, np.delete(whole.triangles, np.s_[::10], axis=0))


def crossing() -> Surface:
    """A part of the wall sticks out of the wall opposite."""
    points = ball().vertices.copy()
    points[points[:, 2] > 0.8, 2] -= 3
    return Surface(points, ball().triangles)


def broken() -> Surface:
    """Two corners are not numbers."""
    points = ball().vertices.copy()
    points[[20, 100], 1] = np.nan, np.inf
    return Surface(points, ball().triangles)


@dataclass(frozen=True)
class Report:
    """What `lumel render` said of its bundles: per cent of the light, and parity violations of a million lines."""

    out: str

    def number(self, after: str) -> float:
        found = re.search(rf"([\d.e+-]+)( k)?{after}", self.out)
        assert found, self.out
        return float(found[1]) * (1000 if found[2] else 1)


def report(surface: Surface, folder: Path) -> Report:
    """Render the light in a surface that shines and reflects alike everywhere."""
    (folder / "ball.ply").write_text(ply(surface))
    (folder / "ball.xml").write_text(SCENE)
    ran = run("render", "ball.xml", *FLAGS, "-o", "a.exr", cwd=folder)
    assert ran.code == 0, ran
    image = read_picture(folder / "a.exr").layers["rgb"]
    assert np.isfinite(image).all()
    assert image.min() >= 0
    return Report(ran.out)


@pytest.mark.parametrize("make", [ball, cracked, broken])
def test_holes_let_out_their_share_of_the_light(tmp_path: Path, make: Callable[[], Surface]) -> None:
    # What a sphere sends goes everywhere alike, so the closed form of what escapes is the share of the area that is missing.
    surface = make()
    finite = np.isfinite(surface.vertices[surface.triangles]).all(axis=(1, 2))
    left = Surface(surface.vertices, surface.triangles[finite])
    hole = 100 * (1 - left.area() / ball().area())
    said = report(surface, tmp_path)
    assert said.number("% escaped") == pytest.approx(hole, abs=0.3 if hole > 0 else 1e-3)
    assert said.number("% arrived") == pytest.approx(100 - hole, abs=0.3 if hole > 0 else 1e-3)
    assert said.number("% went between faces") == 0
    assert said.number(" parity violations") == 0
    assert ("2 of 162 vertices are NaN, infinite" in said.out) == (make is broken)


def test_meshes_that_cross_themselves_are_told(tmp_path: Path) -> None:
    said = report(crossing(), tmp_path)
    assert said.number(" parity violations") > 1000
    assert said.number("% went between faces") > 0.1
    assert said.number("% escaped") + said.number("% arrived") == pytest.approx(100, abs=0.01)
    assert "cross themselves" in said.out
