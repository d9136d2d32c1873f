"""From the description of a scene to the arrays of the core, with every check that the core relies on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import Problem, SceneError, nearest
from .scene import Camera, Material, Mesh, Rgb, Scene

ROOM_FOR_ROUNDING = 1e-3  # of an albedo above 1
SMOOTHEST = 1e-3
MORE_PATCHES = 20_000  # than triangles, where no number is given
FARTHEST = 1e9  # m, as in the core
BRIGHTEST = 1e15  # W/(m2 sr) or W/sr: the square, a variance, must be a float too


def to_core(scene: Scene, patches: int | None = None, more: int = MORE_PATCHES) -> tuple[_core.Scene, tuple[str, ...]]:
    """Tessellate `scene` into about `patches` patches (None: so many `more` than there are triangles); also gives notes on what was left
    out.

    Raises SceneError with all that is wrong.
    """
    problems = list(find_problems(scene))
    if problems:
        raise SceneError(problems)
    names = list(scene.materials)
    materials = [_material(material) for material in scene.materials.values()]
    triangles = scene.triangle_count
    if too_bright := [p for m, core in zip(scene.materials.values(), materials, strict=True) if (p := _albedo_problem(scene, m, core))]:
        raise SceneError(too_bright)
    offsets = np.cumsum([0] + [len(mesh.vertices) for mesh in scene.meshes])
    try:
        core = _core.Scene.make(
            vertices=np.concatenate([_floats(mesh.vertices) for mesh in scene.meshes]),
            normals=np.concatenate([_normals(mesh) for mesh in scene.meshes]),
            triangles=np.concatenate([_indices(mesh, offset) for mesh, offset in zip(scene.meshes, offsets, strict=False)]),
            triangle_shape=np.repeat(np.arange(len(scene.meshes), dtype=np.uint32), [len(mesh.triangles) for mesh in scene.meshes]),
            shape_material=np.array([names.index(mesh.material) for mesh in scene.meshes], dtype=np.uint32),
            shape_emission=_floats([mesh.emission for mesh in scene.meshes]),
            materials=materials,
            point_positions=_floats([light.position for light in scene.lights]),
            point_intensities=_floats([light.intensity for light in scene.lights]),
            patches=wanted_patches(triangles, patches, more),
        )
    except ValueError as error:
        raise SceneError(Problem(f"{error}: {_counts(scene)}", scene.source or None)) from error
    if flat := [
        _at(scene, mesh.name, f"lamp '{mesh.name}' has no area, so its light cannot be defined")
        for mesh, area in zip(scene.meshes, core.lamp_areas, strict=True)
        if np.max(_floats(mesh.emission)) > 0 and not area > 0  # as a float, which the core takes
    ]:
        raise SceneError(flat)
    return core, tuple(_notes(core))


def wanted_patches(triangles: int, patches: int | None, more: int = MORE_PATCHES) -> int:
    """About how many patches a scene gets where so many are asked for (None: so many `more` than triangles)."""
    return triangles + more if patches is None else patches


def camera_to_core(camera: Camera) -> _core.Camera:
    """The camera as the core has it. Raises SceneError where it has no view."""
    left, up, forward, origin = np.asarray(camera.to_world, dtype=np.float64)[:3].T
    if not np.all(np.isfinite(camera.to_world)) or min(np.linalg.norm(axis) for axis in (left, up, forward)) <= 0:
        raise SceneError(f"camera '{camera.name}': its to_world is not a finite, invertible transform")
    if np.max(np.abs(origin)) > FARTHEST:
        raise SceneError(f"camera '{camera.name}' stands at {_triple(origin)}; allowed: up to {FARTHEST:g} m from the origin")
    if not 0 < camera.fov < 180:
        raise SceneError(f"camera '{camera.name}': fov is {camera.fov:g}; allowed: more than 0 and less than 180 degrees")
    tan_x, tan_y = camera.tan_half()
    right, up, forward = (_triple(axis / np.linalg.norm(axis)) for axis in (-left, up, forward))
    return _core.Camera.make(
        origin=_triple(origin),
        right=right,
        up=up,
        forward=forward,
        tan_x=tan_x,
        tan_y=tan_y,
        width=camera.width,
        height=camera.height,
    )


def find_problems(scene: Scene) -> Iterator[Problem]:
    """Everything in a scene that the core could not take."""
    if not scene.meshes:
        yield Problem("empty scene: it has no mesh", scene.source or None)
    for mesh in scene.meshes:
        yield from (_at(scene, mesh.name, f"mesh '{mesh.name}': {text}") for text in _mesh_problems(mesh, scene))
    for name, material in scene.materials.items():
        if name != material.name:
            yield _at(scene, name, f"material '{material.name}' is listed as '{name}'; allowed: its own name")
    for material in scene.materials.values():
        yield from (_at(scene, material.name, f"material '{material.name}': {text}") for text in _material_problems(material))
    for light in scene.lights:
        if not np.all(np.abs(light.position) <= FARTHEST):
            yield _at(
                scene, light.name, f"point light '{light.name}' stands at {light.position}; allowed: up to {FARTHEST:g} m from the origin"
            )
        if not _is_rgb(light.intensity, 0, BRIGHTEST):
            found = f"point light '{light.name}' has intensity {light.intensity}"
            yield _at(scene, light.name, f"{found}; allowed: three numbers from 0 to {BRIGHTEST:g}")


def _mesh_problems(mesh: Mesh, scene: Scene) -> Iterator[str]:
    vertices, triangles = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        yield f"vertices have shape {vertices.shape}; allowed: (n, 3)"
    if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
        yield f"triangles are {triangles.dtype} of shape {triangles.shape}; allowed: integers of shape (m, 3)"
    elif triangles.size and (int(triangles.min()) < 0 or int(triangles.max()) >= len(vertices)):
        bad = int(np.sum(np.any((triangles < 0) | (triangles >= len(vertices)), axis=1)))
        yield f"{bad:,} of {len(triangles):,} triangles name vertices that do not exist; allowed: 0 to {len(vertices) - 1}"
    if mesh.normals is not None and np.shape(mesh.normals) != vertices.shape:
        yield f"normals have shape {np.shape(mesh.normals)}; allowed: that of the vertices, {vertices.shape}"
    if mesh.material not in scene.materials:
        yield f"unknown material '{mesh.material}'; {nearest(mesh.material, scene.materials)}"
    if not _is_rgb(mesh.emission, 0, BRIGHTEST):
        yield f"emission is {mesh.emission}; allowed: three numbers from 0 to {BRIGHTEST:g}"


def _material_problems(material: Material) -> Iterator[str]:
    for share in ("diffuse", "specular", "mirror"):
        if not _is_rgb(getattr(material, share), 0, 1 + ROOM_FOR_ROUNDING):
            yield f"{share} albedo is {getattr(material, share)}; allowed: three numbers from 0 to 1"
    if not SMOOTHEST <= material.alpha <= 1:
        yield f"alpha is {material.alpha:g}; allowed: {SMOOTHEST:g} to 1 (use a mirror for perfectly smooth surfaces)"
    if material.eta is not None and not (_is_rgb(material.eta, 1e-3, 1e3) and _is_rgb(material.k, 0, 1e3)):
        yield f"index of refraction is {material.eta} + i {material.k}; allowed: eta from 0.001 to 1000, k from 0 to 1000"


def _albedo_problem(scene: Scene, material: Material, core: _core.Material) -> Problem | None:
    if core.max_albedo <= 1 + ROOM_FOR_ROUNDING:
        return None
    found = f"material '{material.name}' reflects {core.max_albedo:.4g} times the light that it gets"
    return _at(scene, material.name, f"{found}; allowed: diffuse + specular + mirror <= 1")


def _material(material: Material) -> _core.Material:
    return _core.Material.make(
        name=material.name,
        diffuse=material.diffuse,
        specular=material.specular,
        mirror=material.mirror,
        alpha=material.alpha,
        fresnel=material.eta is not None,
        eta=material.eta or (1.0, 1.0, 1.0),
        k=material.k,
        two_sided=material.two_sided,
    )


def _notes(core: _core.Scene) -> Iterator[str]:
    report = core.report
    words = {
        "nonfinite": "with coordinates that are not finite",
        "degenerate": "without area",
        "huge": "too large to trace",
        "duplicate": "in the place of another",
    }
    yield from (f"left out {report[key]:,} of {report['given']:,} triangles {text}" for key, text in words.items() if report[key])


def _counts(scene: Scene) -> str:
    """How many triangles there are and how far they reach, to say why none can be used."""
    count = f"{scene.triangle_count:,} triangles in {len(scene.meshes)} meshes were given"
    points = np.concatenate([np.asarray(mesh.vertices, np.float64)[np.unique(mesh.triangles)] for mesh in scene.meshes])
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return f"{count}, no coordinate of which is finite"
    size, far = float(np.max(np.ptp(points, axis=0))), float(np.max(np.abs(points)))
    return f"{count}, {size:.3g} m in size and up to {far:.3g} m from the origin, where they are without area or too large to trace"


def _at(scene: Scene, name: str, text: str) -> Problem:
    return Problem(text, scene.source or None, scene.lines.get(name))


def _is_rgb(value: Rgb, low: float, high: float) -> bool:
    array = np.asarray(value, dtype=np.float64)
    return array.shape == (3,) and bool(np.all(np.isfinite(array)) and np.all(array >= low) and np.all(array <= high))


def _floats(values: object) -> npt.NDArray[np.float32]:
    return np.ascontiguousarray(np.asarray(values, dtype=np.float32).reshape(-1, 3))


def _normals(mesh: Mesh) -> npt.NDArray[np.float32]:
    return np.zeros((len(mesh.vertices), 3), np.float32) if mesh.normals is None else _floats(mesh.normals)


def _indices(mesh: Mesh, offset: int) -> npt.NDArray[np.uint32]:
    return np.ascontiguousarray(np.asarray(mesh.triangles, dtype=np.int64) + offset, dtype=np.uint32)


def _triple(v: npt.NDArray[np.float64]) -> Rgb:
    return float(v[0]), float(v[1]), float(v[2])
