"""Scenes made by code for measuring, each hard in one way; written as Mitsuba XML with rectangles, cubes, balls and columns, so that both
renderers read the same file.

python benchmarks/generated.py FOLDER writes them all.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

Rgb = tuple[float, float, float]
Point = tuple[float, float, float]
SIZE = (192, 144)  # pixels


class Writer:
    """The XML of a scene under way. Rectangles and cubes have centre, half extents and turns in degrees about x, then y."""

    def __init__(self) -> None:
        self.lines = ['<scene version="3.0.0">', '  <integrator type="path"><integer name="max_depth" value="-1"/></integrator>']

    def matt(self, name: str, albedo: Rgb) -> str:
        """A diffuse material; gives its name."""
        self.lines.append(f'  <bsdf type="twosided" id="{name}"><bsdf type="diffuse">{_rgb("reflectance", albedo)}</bsdf></bsdf>')
        return name

    def gloss(self, name: str, albedo: Rgb, alpha: float, share: float, tint: Rgb = (1, 1, 1)) -> str:
        """`share` of GGX of roughness alpha over a diffuse rest."""
        self.lines.append(
            f'  <bsdf type="twosided" id="{name}"><bsdf type="blendbsdf"><float name="weight" value="{share}"/>'
            f'<bsdf type="diffuse">{_rgb("reflectance", albedo)}</bsdf>'
            '<bsdf type="roughconductor"><string name="material" value="none"/><string name="distribution" value="ggx"/>'
            f'<float name="alpha" value="{alpha}"/>{_rgb("specular_reflectance", tint)}</bsdf></bsdf></bsdf>'
        )
        return name

    def shape(
        self, kind: str, material: str, centre: Point, half: Point, turn: tuple[float, float] = (0, 0), emission: Rgb | None = None
    ) -> None:
        """A `rectangle` (in x and y, facing +z before it is turned) or a `cube`."""
        lamp = f'<emitter type="area">{_rgb("radiance", emission)}</emitter>' if emission else ""
        self.lines.append(
            f'  <shape type="{kind}"><transform name="to_world"><scale x="{half[0]}" y="{half[1]}" z="{half[2]}"/>'
            f'<rotate x="1" angle="{turn[0]}"/><rotate y="1" angle="{turn[1]}"/>'
            f'<translate x="{centre[0]}" y="{centre[1]}" z="{centre[2]}"/></transform><ref id="{material}"/>{lamp}</shape>'
        )

    def ball(self, material: str, centre: Point, radius: float, emission: Rgb | None = None) -> None:
        """A sphere."""
        lamp = f'<emitter type="area">{_rgb("radiance", emission)}</emitter>' if emission else ""
        self.lines.append(
            f'  <shape type="sphere">{_point("center", centre)}<float name="radius" value="{radius}"/><ref id="{material}"/>{lamp}</shape>'
        )

    def column(self, material: str, foot: Point, height: float, radius: float) -> None:
        """An upright cylinder without ends."""
        top = (foot[0], foot[1] + height, foot[2])
        self.lines.append(
            f'  <shape type="cylinder">{_point("p0", foot)}{_point("p1", top)}<float name="radius" value="{radius}"/>'
            f'<ref id="{material}"/></shape>'
        )

    def mirror(self, name: str, tint: float) -> str:
        """A perfect mirror; gives its name."""
        self.lines.append(
            f'  <bsdf type="twosided" id="{name}"><bsdf type="conductor"><string name="material" value="none"/>'
            f"{_rgb('specular_reflectance', (tint, tint, tint))}</bsdf></bsdf>"
        )
        return name

    def room(self, size: Point, materials: Sequence[str | None]) -> None:
        """A room over [-x, x] x [0, y] x [-z, z]; materials of floor, ceiling, left, right, back, front, None for an open side."""
        x, y, z = size[0], size[1] / 2, size[2]
        sides = (
            ((0, 0, 0), (x, z, 1), (-90, 0)),
            ((0, 2 * y, 0), (x, z, 1), (90, 0)),
            ((-x, y, 0), (z, y, 1), (0, 90)),
            ((x, y, 0), (z, y, 1), (0, -90)),
            ((0, y, -z), (x, y, 1), (0, 0)),
            ((0, y, z), (x, y, 1), (0, 180)),
        )
        for (centre, half, turn), material in zip(sides, materials, strict=True):
            if material:
                self.shape("rectangle", material, centre, half, turn)

    def lamp(self, centre: Point, half: tuple[float, float], radiance: Rgb, turn: tuple[float, float] = (90, 0)) -> None:
        """A black rectangle that emits; it faces down unless it is turned."""
        self.shape("rectangle", "black", centre, (*half, 1), turn, radiance)

    def camera(self, origin: Point, target: Point, fov: float = 70) -> None:
        """A pinhole camera."""
        place = f'<lookat origin="{_list(origin)}" target="{_list(target)}" up="0,1,0"/>'
        self.lines.append(
            f'  <sensor type="perspective" id="main"><string name="fov_axis" value="x"/><float name="fov" value="{fov}"/>'
            f'<transform name="to_world">{place}</transform><film type="hdrfilm"><integer name="width" value="{SIZE[0]}"/>'
            f'<integer name="height" value="{SIZE[1]}"/><rfilter type="box"/><string name="pixel_format" value="rgb"/></film>'
            '<sampler type="independent"/></sensor>'
        )

    def text(self) -> str:
        """The whole file."""
        return "\n".join([*self.lines, "</scene>", ""])


def _list(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


def _point(name: str, values: Point) -> str:
    return '<point name="{}" x="{:g}" y="{:g}" z="{:g}"/>'.format(name, *values)


def _rgb(name: str, values: Rgb) -> str:
    return f'<rgb name="{name}" value="{_list(values)}"/>'


def start() -> tuple[Writer, str, str, str]:
    """A writer, and the names of a white, a red and a glossy material; `black` is there too."""
    w = Writer()
    w.matt("black", (0, 0, 0))
    white, red = w.matt("white", (0.72, 0.72, 0.7)), w.matt("red", (0.6, 0.15, 0.1))
    return w, white, red, w.gloss("gloss", (0.4, 0.38, 0.35), 0.15, 0.4)


def lamps() -> Writer:
    """Many small lamps of different strength over a glossy floor, boxes between them."""
    w, white, red, gloss = start()
    w.room((2, 2, 2), (gloss, white, red, white, white, white))
    for i in range(12):
        for j in range(12):
            power = 30.0 * (1 + (7 * i + 5 * j) % 11)
            w.lamp((-1.8 + 3.6 * i / 11, 1.99, -1.8 + 3.6 * j / 11), (0.01, 0.01), (power, power * 0.9, power * 0.7))
    for i in range(3):
        w.shape("cube", white if i % 2 else red, (-1 + i, 0.4, -0.5 + 0.4 * (i % 2)), (0.25, 0.4, 0.25), (0, 20 * i))
    w.camera((0, 1.2, 1.9), (0, 0.6, -0.5))
    return w


def indirect() -> Writer:
    """A lamp in a trough that lights the ceiling alone: all else is indirect."""
    w, white, red, gloss = start()
    w.room((1.5, 2.5, 1.5), (gloss, white, red, white, white, white))
    w.shape("cube", white, (0, 1.7, -1.35), (1.2, 0.02, 0.15))
    w.shape("cube", white, (0, 1.82, -1.2), (1.2, 0.14, 0.01))
    w.lamp((0, 1.74, -1.36), (1.1, 0.05), (25, 22, 18), (-90, 0))
    w.shape("cube", white, (-0.5, 0.35, -0.3), (0.3, 0.35, 0.3), (0, 25))
    w.shape("cube", gloss, (0.6, 0.2, 0.2), (0.25, 0.2, 0.25), (0, -15))
    w.camera((0.3, 1.3, 1.45), (0, 0.9, -0.6))
    return w


def corridor() -> Writer:
    """A long corridor with a turn; the lamp is behind the corner."""
    w, white, red, gloss = start()
    w.room((4, 2.2, 4), (gloss, white, white, red, white, white))
    w.shape("cube", white, (-0.8, 1.1, 0.8), (3.19, 1.1, 3.19))
    w.lamp((-3.0, 2.19, -3.2), (0.4, 0.4), (40, 36, 30))
    w.camera((3.2, 1.3, 3.8), (3.1, 1.0, -4))
    return w


def screens() -> Writer:
    """Thin slats before a lamp: narrow shadows, light on both sides of thin walls."""
    w, white, red, gloss = start()
    w.room((1.5, 2, 1.5), (gloss, white, red, white, white, white))
    for i in range(14):
        w.shape("cube", white, (-1.3 + 0.2 * i, 1.0, -0.4), (0.05, 0.8, 0.004), (0, 35))
    w.lamp((0, 1.2, -1.45), (0.5, 0.3), (20, 18, 14), (0, 0))
    w.lamp((0.9, 1.99, 0.9), (0.1, 0.1), (20, 20, 22))
    w.camera((-0.6, 1.2, 1.45), (0.1, 0.8, -0.6))
    return w


def porch() -> Writer:
    """Open to the black sky: a roof on posts, a lamp under it, one in the open."""
    w, white, red, gloss = start()
    w.room((2.5, 2, 2.5), (gloss, None, None, None, white, None))
    w.shape("cube", red, (0, 1.95, -1.3), (1.6, 0.05, 1.2))
    for x in (-1.4, -0.5, 0.5, 1.4):
        w.shape("cube", white, (x, 0.95, -0.2), (0.06, 0.95, 0.06))
    w.lamp((0, 1.88, -1.4), (0.2, 0.2), (30, 28, 24))
    w.lamp((2, 1.5, 1), (0.1, 0.1), (60, 60, 70), (0, -100))
    w.shape("cube", gloss, (0.2, 0.3, 0.6), (0.3, 0.3, 0.3), (0, 30))
    w.camera((-1.2, 1.3, 3.2), (0.1, 0.7, -0.6), 60)
    return w


def sharp() -> Writer:
    """Sharp gloss, alpha 0.02 to 0.1, and contacts on it."""
    w, white, red, _ = start()
    floor = w.gloss("floor", (0.3, 0.3, 0.3), 0.05, 0.5)
    back = w.gloss("back", (0.5, 0.45, 0.4), 0.02, 0.4)
    bronze = w.gloss("bronze", (0.3, 0.2, 0.1), 0.1, 0.7, (0.95, 0.75, 0.5))
    w.room((1.5, 2, 1.5), (floor, white, red, white, back, white))
    w.shape("cube", bronze, (-0.5, 0.4, -0.4), (0.3, 0.4, 0.3), (0, 25))
    w.shape("cube", white, (0.5, 0.25, 0.1), (0.25, 0.25, 0.25), (0, -20))
    w.shape("cube", red, (0.1, 0.05, 0.7), (0.4, 0.05, 0.1), (0, 10))
    w.lamp((0.3, 1.99, 0.2), (0.35, 0.25), (14, 13, 11))
    w.camera((0, 1.1, 1.45), (0, 0.6, -0.6))
    return w


def bulbs() -> Writer:
    """Small bright balls as lamps; round things, matt and glossy."""
    w, white, red, gloss = start()
    w.room((2, 2.4, 1.6), (gloss, white, red, white, white, white))
    for i, centre in enumerate(((-1.2, 1.9, -0.8), (0.3, 2.0, 0.2), (1.3, 1.7, -0.9), (-0.4, 1.5, -1.2))):
        w.ball("black", centre, 0.03, (120.0 * (i + 1), 100.0 * (i + 1), 70.0 * (i + 1)))
    w.ball(gloss, (-0.6, 0.4, -0.4), 0.4)
    w.ball(white, (0.5, 0.25, 0.1), 0.25)
    w.shape("cube", red, (1.2, 0.5, -0.8), (0.3, 0.5, 0.2), (0, 33))
    w.camera((0, 1.2, 1.55), (0, 0.8, -0.5))
    return w


def hall() -> Writer:
    """A long hall with piers that stand in its walls, lit at the far end: hundreds of times darker where the camera is."""
    w, white, red, gloss = start()
    w.room((0.9, 2.3, 8), (gloss, white, white, white, white, red))
    for i in range(5):
        z = -6.0 + 3 * i
        w.shape("cube", white, (-0.85, 1.15, z), (0.1, 1.15, 0.15))
        w.shape("cube", red, (0.85, 1.15, z), (0.1, 1.15, 0.15))
    w.lamp((0, 2.28, -7), (0.4, 0.2), (30, 27, 22))
    w.lamp((0.3, 2.28, -1), (0.05, 0.05), (60, 50, 40))
    w.camera((0.1, 1.5, 7.8), (0, 1.1, -4), 60)
    return w


def veranda() -> Writer:
    """Open to the black sky: boards on columns, and a strong lamp above."""
    w, white, red, gloss = start()
    w.room((3, 2.5, 2), (gloss, None, None, None, red, None))
    for i in range(12):
        w.shape("cube", white, (-1.9 + 0.34 * i, 2.2, -0.6), (0.13, 0.02, 1.4))
    for x in (-1.9, 0.0, 1.9):
        w.column(white, (x, 0, 0.6), 2.2, 0.07)
    w.lamp((0.6, 4.5, 1.5), (0.4, 0.4), (80, 75, 60), (110, 0))
    w.shape("cube", white, (0.5, 0.25, -0.8), (0.6, 0.25, 0.3), (0, 10))
    w.ball(gloss, (-0.9, 0.35, -0.2), 0.35)
    w.camera((-1.5, 1.5, 4), (0, 0.9, -0.5), 60)
    return w


def mirrors() -> Writer:
    """A wall and a ball that are mirrors, and gloss of alpha 0.03 and 0.07."""
    w, white, red, _ = start()
    mirror = w.mirror("mirror", 0.9)
    floor = w.gloss("floor", (0.4, 0.4, 0.42), 0.03, 0.5)
    gold = w.gloss("gold", (0.3, 0.2, 0.1), 0.07, 0.8, (0.9, 0.7, 0.4))
    w.room((1.6, 2.2, 1.8), (floor, white, mirror, red, white, white))
    w.ball(mirror, (0.6, 0.4, -0.7), 0.4)
    w.ball(gold, (-0.4, 0.35, -0.3), 0.35)
    w.shape("cube", gold, (0.9, 0.3, 0.3), (0.2, 0.3, 0.2), (0, 22))
    w.lamp((-0.2, 2.19, -0.3), (0.3, 0.2), (16, 15, 13))
    w.camera((0.5, 1.2, 1.75), (-0.1, 0.7, -0.7))
    return w


def table() -> Writer:
    """Small things on a table, each of them finely divided, and their contacts."""
    w, white, red, gloss = start()
    w.room((1.5, 2, 1.5), (white, white, red, white, white, white))
    w.shape("cube", gloss, (0, 0.7, -0.3), (0.8, 0.02, 0.5))
    for x in (-0.75, 0.75):
        for z in (-0.75, 0.15):
            w.shape("cube", red, (x, 0.34, z), (0.03, 0.34, 0.03))
    for i in range(5):
        for j in range(4):
            radius = 0.03 + 0.0015 * ((7 * i + 11 * j) % 20)
            w.ball((white, red, gloss)[(i + j) % 3], (-0.6 + 0.3 * i, 0.72 + radius, -0.65 + 0.23 * j), radius)
    for i in range(6):
        w.shape("cube", white, (-0.9 + 0.36 * i, 0.03, 0.6), (0.03, 0.03, 0.03), (0, 13 * i))
    w.lamp((0.1, 1.98, -0.1), (0.25, 0.25), (18, 17, 14))
    w.camera((0.1, 1.3, 1.4), (0, 0.6, -0.4), 60)
    return w


def plaza() -> Writer:
    """Boxes on an open plain, some of which cross, under one far lamp."""
    w, white, red, gloss = start()
    w.shape("rectangle", gloss, (0, 0, 0), (6, 6, 1), (-90, 0))
    for i in range(12):
        height = 0.3 + 0.1 * ((5 * i) % 12)
        x, z = -2.9 + 0.53 * ((7 * i) % 12), -2.8 + 0.4 * ((5 * i + i // 3) % 12)
        w.shape("cube", red if i % 2 else white, (x, height, z), (0.25, height, 0.25), (0, 29 * i))
    w.shape("cube", red, (0.3, 0.8, 0.4), (0.3, 0.8, 0.2), (0, 20))
    w.shape("cube", white, (0.6, 0.5, 0.5), (0.3, 0.5, 0.2), (0, 65))
    w.lamp((3, 7, 3), (0.6, 0.6), (90, 85, 70), (115, 45))
    w.camera((0, 2.5, 6), (0, 0.6, -0.5), 60)
    return w


def orchard() -> Writer:
    """Two hundred small balls on an open plain under one large lamp: many triangles, nearly all light direct."""
    w, white, red, gloss = start()
    w.shape("rectangle", white, (0, 0, 0), (6, 6, 1), (-90, 0))
    for i in range(16):
        for j in range(12):
            radius = 0.1 + 0.01 * ((7 * i + 5 * j) % 8)
            w.ball((white, red, gloss)[(i + j) % 3], (-3.4 + 0.45 * i, radius, -3.2 + 0.45 * j), radius)
    w.lamp((1, 5, 1), (1.5, 1.5), (16, 15, 13), (95, 10))
    w.camera((0.3, 2.2, 4.5), (0, 0.2, -0.6), 60)
    return w


def shelf() -> Writer:
    """A shelf of narrow boards with balls and boxes on them, lit from the side; gloss of alpha 0.1."""
    w, white, red, _ = start()
    lacquer = w.gloss("lacquer", (0.35, 0.3, 0.25), 0.1, 0.5)
    w.room((1.4, 2.2, 1.4), (white, white, white, red, white, white))
    for i in range(5):
        w.shape("cube", lacquer, (0, 0.2 + 0.42 * i, -1.2), (0.9, 0.015, 0.2))
        for j in range(5):
            if (i + j) % 2:
                w.ball((red, lacquer)[j % 2], (-0.7 + 0.35 * j, 0.315 + 0.42 * i, -1.15), 0.1)
            else:
                w.shape("cube", white, (-0.7 + 0.35 * j, 0.315 + 0.42 * i, -1.2), (0.06, 0.1, 0.06), (0, 17 * j))
    for x in (-0.92, 0.92):
        w.shape("cube", lacquer, (x, 1.0, -1.2), (0.015, 1.0, 0.2))
    w.lamp((-1.38, 1.4, 0.4), (0.4, 0.4), (12, 11, 10), (0, 90))
    w.camera((0.4, 1.2, 1.3), (0, 0.95, -1.2))
    return w


def arcade() -> Writer:
    """Columns before an open side, light from without: the hall is lit by the floor alone."""
    w, white, red, gloss = start()
    w.room((3, 2.6, 1.6), (gloss, white, red, white, white, None))
    w.shape("rectangle", white, (0, -0.01, 4), (5, 3, 1), (-90, 0))
    for i in range(7):
        w.column(white, (-2.7 + 0.9 * i, 0, 1.4), 2.6, 0.12)
    w.shape("cube", red, (-1, 0.3, -0.6), (0.4, 0.3, 0.2), (0, 12))
    w.ball(gloss, (0.6, 0.35, -0.4), 0.35)
    w.lamp((1, 7, 7), (0.8, 0.8), (110, 105, 90), (130, 0))
    w.camera((2.4, 1.5, 1.1), (-0.8, 0.9, -0.9), 75)
    return w


def ceiling() -> Writer:
    """A luminous ceiling of panels: large lamps, soft light everywhere."""
    w, white, red, gloss = start()
    w.room((2, 2.4, 2), (gloss, white, red, white, white, white))
    for i in range(4):
        for j in range(4):
            w.lamp((-1.5 + i, 2.38, -1.5 + j), (0.4, 0.4), (2.2, 2.1, 2.0))
    for i in range(4):
        w.shape("cube", (white, red)[i % 2], (-1.2 + 0.8 * i, 0.37, -0.6 + 0.3 * (i % 3)), (0.3, 0.02, 0.2), (0, 11 * i))
        w.column(white, (-1.2 + 0.8 * i, 0, -0.6 + 0.3 * (i % 3)), 0.36, 0.03)
    w.ball(gloss, (0.3, 0.3, 0.7), 0.3)
    w.camera((-0.9, 1.3, 1.9), (0.2, 0.6, -0.6))
    return w


SCENES: dict[str, Callable[[], Writer]] = {
    f.__name__: f
    for f in (
        lamps,
        indirect,
        corridor,
        screens,
        porch,
        sharp,
        bulbs,
        hall,
        veranda,
        mirrors,
        table,
        plaza,
        orchard,
        shelf,
        arcade,
        ceiling,
    )
}


def write(name: str, folder: Path) -> Path:
    """Write a scene; gives its file."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{name}.xml"
    file.write_text(SCENES[name]().text(), encoding="utf-8")
    return file


if __name__ == "__main__":
    for scene in SCENES:
        print(write(scene, Path(sys.argv[1])))
