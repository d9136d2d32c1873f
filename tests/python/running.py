"""Renders for the tests: the true command line in a process of its own or in this one, and small scenes as text."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import lumel
from lumel.quadrature.student import t_quantile
from lumel.scene import FloatArray

SMALL = ("--rays", "4000", "--patches", "200", "--size", "16x12", "--quality", "draft")
"""Flags of a render that takes a moment."""

LIMIT = 20.0  # seconds that no small render may take

CAMERA = """<sensor type="perspective" id="{name}"><float name="fov" value="60"/>
  <transform name="to_world"><lookat origin="{origin}" target="0,0,0" up="0,1,0"/></transform>
  <film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="12"/></film></sensor>"""
LAMP = """<shape type="rectangle" id="lamp"><transform name="to_world"><rotate x="1" angle="90"/><translate y="2"/></transform>
  <emitter type="area"><rgb name="radiance" value="{radiance}"/></emitter></shape>"""
FLOOR = """<shape type="rectangle" id="floor"><transform name="to_world"><rotate x="1" angle="-90"/><translate y="-1"/></transform>
  <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="{albedo}"/></bsdf></bsdf></shape>"""
BALL = """<shape type="sphere" id="ball"><float name="radius" value="0.7"/>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.6"/></bsdf></shape>"""


def camera(name: str = "main", origin: str = "0,0.5,4", width: int = 16) -> str:
    """A camera that looks at the origin."""
    return CAMERA.format(name=name, origin=origin, width=width)


def floor(albedo: str = "0.5") -> str:
    """A square of 2 m at y = -1, its front up."""
    return FLOOR.format(albedo=albedo)


def lamp(radiance: str = "5") -> str:
    """A square of 2 m at y = 2, its front down."""
    return LAMP.format(radiance=radiance)


def scene(*parts: str) -> str:
    """A scene file, each part on a line of its own from line 2 on (parts may have several)."""
    return "\n".join(['<scene version="3.0.0">', *parts, "</scene>\n"])


ROOM = scene(floor(), BALL, lamp(), camera())


@dataclass(frozen=True)
class Ran:
    """What a command left: exit code, stdout, stderr without progress lines."""

    code: int
    out: str
    err: str


def run(*args: object, cwd: Path, before: Callable[[], None] | None = None) -> Ran:
    """The command line in a process of its own; `before` is called in it first. Fails after LIMIT seconds."""
    line = [sys.executable, "-m", "lumel", *(str(arg) for arg in args)]
    done = subprocess.run(line, cwd=cwd, capture_output=True, text=True, timeout=LIMIT, check=False, preexec_fn=before)
    return Ran(done.returncode, done.stdout, done.stderr)


def budget(transport: str, rays: int) -> dict[str, Any]:
    """The transport with a budget for work that takes about as long as `rays` rays."""
    return {"transport": transport, **({"directions": max(1, rays // 500)} if transport == "bundles" else {"rays": rays})}


def render(scene: lumel.Scene, *, limit: float = LIMIT, **settings: Any) -> lumel.Result:
    """`lumel.render` that fails where it does not end by itself within `limit` seconds."""
    end = time.monotonic() + limit
    result = lumel.render(scene, **settings, interrupted=lambda: time.monotonic() > end)
    assert not result.stats["interrupted"], f"the render did not end within {limit} s"
    return result


def quad(name: str, corners: Sequence[Sequence[float]], material: str, emission: float = 0.0) -> lumel.Mesh:
    """Four corners, counter-clockwise seen from the front."""
    vertices = np.array(corners, np.float32)
    return lumel.Mesh(name, vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32), material, emission=(emission,) * 3)


def tiles(image: FloatArray, size: int = 8) -> FloatArray:
    """Means over tiles of `size` x `size` pixels, (h / size, w / size, 3); sizes must fit."""
    h, w, _ = image.shape
    return np.asarray(image.reshape(h // size, size, w // size, size, 3).mean(axis=(1, 3)), dtype=np.float32)


def assert_same_mean(a: Sequence[FloatArray], b: Sequence[FloatArray], *, slack: float = 0.0, significance: float = 1e-3) -> None:
    """Welch's test on every element of two sets of independent arrays, Bonferroni-corrected; `slack` is a relative bias that is allowed."""
    x, y = np.asarray(a, np.float64), np.asarray(b, np.float64)
    difference = np.abs(x.mean(axis=0) - y.mean(axis=0))
    error = np.sqrt(x.var(axis=0, ddof=1) / len(x) + y.var(axis=0, ddof=1) / len(y))
    # Fewer degrees of freedom than Welch's formula would give: on the safe side.
    quantile = t_quantile(1 - significance / difference.size, min(len(x), len(y)) - 1)
    allowed = quantile * error + slack * np.maximum(np.abs(y.mean(axis=0)), np.abs(x.mean(axis=0))) + 1e-7
    worst = np.unravel_index(np.argmax(difference - allowed), difference.shape)
    assert np.all(difference <= allowed), f"at {worst}: {x.mean(axis=0)[worst]} and {y.mean(axis=0)[worst]}, allowed {allowed[worst]}"


def environment() -> dict[str, str]:
    """The environment of this process, with a terminal that has no colours."""
    return {**os.environ, "NO_COLOR": "1", "TERM": "dumb"}
