"""About how much memory a render takes, known before it starts. The numbers were measured: docs/results.md, "How work grows"."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .core import MORE_PATCHES, wanted_patches
from .pace import RAYS_PER_STEP
from .scene import Mesh, Scene
from .settings import BYTES_PER_PATCH, BYTES_PER_PIXEL, Settings
from .work import FEWEST_REPLICAS

PROGRAM = 65 << 20  # bytes of Python, numpy and the core
BYTES_PER_TRIANGLE = 235  # those of the reader among them
BYTES_PER_GLOSSY_PATCH, BYTES_PER_GLOSSY_PATCH_AND_CAMERA = 2000, 380
BYTES_PER_RAY = 45  # of a step
BYTES_PER_PATCH_AND_BUNDLE, LEAST_BUNDLES, MOST_BUNDLES, BUNDLES = 28, 8, 64, 256 << 20  # of a batch, as in the core; bytes of all


def expected(scene: Scene, settings: Settings) -> int:
    """Bytes that a render of `scene` takes at most, within a quarter or so."""
    triangles = scene.triangle_count
    patches = max(triangles, wanted_patches(triangles, settings.patches, settings.more_patches(triangles)))
    cameras = settings.cameras(scene)
    glossy = [mesh for mesh in scene.meshes if mesh.material in scene.materials and max(scene.materials[mesh.material].specular) > 0]
    glossy_patches = float(sum(len(mesh.triangles) for mesh in glossy))
    if glossy:
        # Where there are many more patches than triangles, these go by area.
        by_area = patches > 1.1 * triangles
        glossy_patches += (patches - triangles) * (_area(glossy) / _area(scene.meshes) if by_area else 1.0)
    bundle = patches * BYTES_PER_PATCH_AND_BUNDLE
    # A trial of bundles casts few at once. Long renders may go on with them.
    may_be_bundles = settings.first_transport == "bundles" or (settings.is_free and settings.more_patches(triangles) > MORE_PATCHES)
    step = RAYS_PER_STEP if settings.rays is None else min(RAYS_PER_STEP, settings.rays // FEWEST_REPLICAS)
    return int(
        PROGRAM
        + step * BYTES_PER_RAY
        + triangles * BYTES_PER_TRIANGLE
        + patches * BYTES_PER_PATCH
        + glossy_patches * (BYTES_PER_GLOSSY_PATCH + len(cameras) * BYTES_PER_GLOSSY_PATCH_AND_CAMERA)
        + (max(min(BUNDLES, MOST_BUNDLES * bundle), LEAST_BUNDLES * bundle) if may_be_bundles else 0)
        + sum(camera.width * camera.height for camera in cameras) * BYTES_PER_PIXEL
    )


def _area(meshes: Sequence[Mesh]) -> float:
    """m2, of the triangles that are sound; more than 0."""
    sum_ = 0.0
    for mesh in meshes:
        if len(mesh.vertices) > 0:
            a, b, c = np.take(np.asarray(mesh.vertices, np.float64), np.asarray(mesh.triangles).T, axis=0, mode="clip")
            areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
            sum_ += float(areas[np.isfinite(areas)].sum())
    return max(sum_, 1e-300)
