"""Mitsuba's perspective sensor as a camera."""

from __future__ import annotations

import math
from typing import cast, get_args

import numpy as np

from ..scene import Camera, FovAxis
from ..settings import LARGEST_PICTURE
from .findings import Findings
from .plugins import Plugin, check_attributes, is_supported
from .transforms import Matrix
from .tree import Node
from .values import number

_FILM_DIAGONAL = math.hypot(36, 24)  # mm, of the film that focal lengths refer to
_FOV_AXES: tuple[FovAxis, ...] = get_args(FovAxis)


def read_sensor(node: Node, name: str, findings: Findings) -> Camera | None:
    """The camera; None after a problem that leaves none, which is reported."""
    if not is_supported(node, ("perspective",), findings):
        return None
    plugin = Plugin(node, findings, f"sensor '{name}'")
    to_world = _placed(plugin)
    fov, axis = _field_of_view(plugin)
    plugin.skip("near_clip", "far_clip")
    for offset in ("principal_point_offset_x", "principal_point_offset_y"):
        if plugin.has(offset) and plugin.number(offset, 0.0) != 0:
            findings.unsupported(f"{plugin.label}: '{offset}' is not supported", node)
    width, height = _film(plugin)
    plugin.children("sampler")
    plugin.done()
    return Camera(name, to_world, fov, axis, width, height)


def _placed(plugin: Plugin) -> Matrix:
    matrix = plugin.transform("to_world")
    linear = matrix[:3, :3]
    if not np.allclose(linear.T @ linear, np.eye(3), atol=2e-3):
        plugin.findings.wrong(f"{plugin.label}: 'to_world' scales or shears, which a camera cannot", plugin.node)
        return np.eye(4)
    return matrix


def _field_of_view(plugin: Plugin) -> tuple[float, FovAxis]:
    """`fov` in degrees along `fov_axis`, or from `focal_length` (50 mm without either) for 36 x 24 mm film, along the diagonal."""
    if not plugin.has("fov"):
        text = plugin.text("focal_length", "50mm").strip().removesuffix("mm")
        return _from_focal_length(text, plugin), "diagonal"
    if plugin.has("focal_length"):
        plugin.findings.wrong(f"{plugin.label}: give either 'fov' or 'focal_length'", plugin.node)
        plugin.skip("focal_length")
    fov = plugin.number("fov", 60.0, 0, 180)
    if not 0 < fov < 180:
        plugin.findings.wrong(f"{plugin.label}: 'fov' is {fov:g}, it must be above 0 and below 180 degrees", plugin.node)
        fov = 60.0
    return fov, cast(FovAxis, plugin.choice("fov_axis", "x", _FOV_AXES))


def _from_focal_length(text: str, plugin: Plugin) -> float:
    try:
        length = number(text)
        if length > 0:
            return math.degrees(2 * math.atan(_FILM_DIAGONAL / (2 * length)))
        reason = "must be above 0"
    except ValueError as error:
        reason = str(error)
    plugin.findings.wrong(f"{plugin.label}: 'focal_length' {reason}, such as 50mm", plugin.node)
    return 60.0


def _film(sensor: Plugin) -> tuple[int, int]:
    """Width and height in pixels; Mitsuba's 768 x 576 without a film."""
    films = sensor.children("film")
    if not films:
        return 768, 576
    for extra in films[1:]:
        sensor.findings.wrong(f"{sensor.label}: has more than one film", extra)
    node = films[0]
    is_supported(node, ("hdrfilm",), sensor.findings, sensor.label)
    film = Plugin(node, sensor.findings, f"film of {sensor.label}")
    width = film.integer("width", 768, 1, LARGEST_PICTURE)
    height = film.integer("height", 576, 1, LARGEST_PICTURE)
    film.skip("pixel_format", "component_format", "file_format", "sample_border")
    for rfilter in film.children("rfilter"):
        check_attributes(rfilter, sensor.findings)
        if rfilter.type and rfilter.type != "box":
            sensor.findings.note(f"{sensor.label}: the box filter is used in place of rfilter '{rfilter.type}'", rfilter)
    film.done()
    return width, height
